//! A dataset that is to be made of records, as typed.

use std::collections::BTreeSet;

use gdcm_core::dataset::{Band, ChannelSide};
use gdcm_core::records::{ChannelList, RecordChannels, RecordColumn, RecordTable, ResamplingWish, SaidChannel};
use gdcm_core::units::number;

use super::ConditionRecords;
use crate::view::typed_number;

/// A dataset that is to be made of records, as typed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WantedDataset {
    /// Inputs, as [`ChannelList`] reads them.
    pub inputs: String,
    /// Outputs, in the same way.
    pub outputs: String,
    /// Lower and upper end of the band \[rad/s\].
    pub band: [String; 2],
    /// Path of the dataset.
    pub path: String,
    /// The columns of the records, in words.
    pub columns: Vec<String>,
    /// Why it could not be made, in words.
    pub problems: Vec<String>,
}

impl WantedDataset {
    /// What is proposed for the records of a condition: the channels that the documentation of a system knows; others are to be
    /// typed.
    pub fn proposed(records: &ConditionRecords, band: Band, path: String) -> Self {
        let tables = || records.rows.iter().map(|row| row.table.as_ref());
        let known = |inputs: bool| {
            let of_side = |column: &&RecordColumn| match (column.side, column.meaning) {
                (Some(side), _) => (side == ChannelSide::Input) == inputs,
                (None, Some(meaning)) => ["LON", "LAT", "PED", "COL"].contains(&meaning) == inputs && meaning != "TARG",
                (None, None) => false,
            };
            let name = |column: &RecordColumn| column.meaning.unwrap_or(&column.name).to_owned();
            let mut names: Vec<String> = tables().flat_map(|table| &table.columns).filter(of_side).map(name).collect();
            let mut seen = BTreeSet::new();
            names.retain(|name| seen.insert(name.clone()));
            names.join(", ")
        };
        // Topics that no channel has joined yet are records of their own, under the names of their variables.
        let words = |table: &RecordTable, column: &RecordColumn| {
            let topic = table.source.variable.as_ref().map_or(String::new(), |variable| format!("{variable}."));
            let unit = column.unit.as_ref().map_or(String::new(), |unit| format!(" [{unit}]"));
            format!("{topic}{}{unit}", column.name)
        };
        let columns: BTreeSet<String> =
            tables().flat_map(|table| table.columns.iter().map(move |column| words(table, column))).collect();
        Self {
            inputs: known(true),
            outputs: known(false),
            band: [band.min(), band.max()].map(number),
            path,
            columns: columns.into_iter().collect(),
            problems: Vec::new(),
        }
    }

    /// The channels and the band that are asked for.
    ///
    /// # Errors
    /// In words, what is no channel or no band.
    pub fn channels(&self) -> Result<(RecordChannels, Band), String> {
        let rules = |side: &str, text: &str| {
            let list: ChannelList = text.parse().map_err(|error| format!("{side}: {error}"))?;
            Ok::<_, String>(list.channels.iter().map(SaidChannel::rule).collect())
        };
        let (inputs, outputs) = (rules("inputs", &self.inputs)?, rules("outputs", &self.outputs)?);
        let end = |text: &String| typed_number(text).ok().flatten().unwrap_or(f64::NAN);
        let band = Band::new(end(&self.band[0]), end(&self.band[1])).map_err(|error| error.to_string())?;
        let resampling = ResamplingWish { band_end: Some(band.max()), ..ResamplingWish::default() };
        Ok((RecordChannels { inputs, outputs, resampling, ..RecordChannels::default() }, band))
    }
}
