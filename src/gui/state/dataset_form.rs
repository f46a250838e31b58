//! Form for a dataset made from records.
//!
//! A column's meaning is the channel, such as "P" or "LON", that the logging system's documentation
//! gives it.

use std::collections::BTreeSet;

use gdcm_model::dataset::Band;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::ChannelRule;
use gdcm_model::units::number;
use gdcm_sysid::records::channel_list::{ChannelList, RequestedChannel};
use gdcm_sysid::records::record_channels::ResamplingSettings;
use gdcm_sysid::records::{LaidOutRecord, RecordChannels, RecordColumn, RecordTable};

use crate::gui::widgets::number_entry::typed_number;
use crate::message::Message;

/// Column meanings that are pilot controls.
const CONTROLS: [&str; 4] = ["LON", "LAT", "PED", "COL"];
/// Column meaning of a recorded reference, which is neither an input nor an output.
const TARGET: &str = "TARG";

/// Form for a dataset made from records, as typed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DatasetForm {
    /// Inputs, in [`ChannelList`] syntax.
    pub inputs: String,
    /// Outputs, in the same syntax.
    pub outputs: String,
    /// Lower and upper band limit \[rad/s\].
    pub band: [String; 2],
    pub path: String,
    /// Record columns, each as "topic.column \[unit\]".
    pub columns: Vec<String>,
    /// Reasons why the dataset could not be made.
    pub problems: Vec<Message>,
}

impl DatasetForm {
    /// Creates a proposal from records. It contains the channels that the file, or else the logging
    /// system's documentation, states to be inputs or outputs; others must be typed.
    pub fn proposed<'r>(
        records: impl IntoIterator<Item = &'r LaidOutRecord>,
        band: Band,
        path: String,
    ) -> Self {
        let mut inputs = Vec::new();
        let mut outputs = Vec::new();
        let mut columns = BTreeSet::new();
        for row in records {
            for column in &row.table.columns {
                columns.insert(column_description(&row.table, column));
                match known_side(column) {
                    Some(ChannelSide::Input) => add_name(&mut inputs, column),
                    Some(ChannelSide::Output) => add_name(&mut outputs, column),
                    None => {}
                }
            }
        }
        Self {
            inputs: inputs.join(", "),
            outputs: outputs.join(", "),
            band: [band.min(), band.max()].map(number),
            path,
            columns: columns.into_iter().collect(),
            problems: Vec::new(),
        }
    }

    /// Parses the requested channels and the band.
    ///
    /// # Errors
    /// A message about the first invalid list of channels, or about an invalid band.
    pub fn channels(&self) -> Result<(RecordChannels, Band), Message> {
        let inputs = parse_rules("inputs", &self.inputs)?;
        let outputs = parse_rules("outputs", &self.outputs)?;
        let [min, max] = &self.band;
        let band = Band::new(parse_end(min), parse_end(max))
            .map_err(|error| Message::new("wrong-band", error.to_string()))?;
        let channels = RecordChannels {
            inputs,
            outputs,
            resampling: ResamplingSettings {
                band_end: Some(band.max()),
                ..ResamplingSettings::default()
            },
            ..RecordChannels::default()
        };
        Ok((channels, band))
    }
}

/// Returns whether a column is an input or an output: as stated in the file; otherwise, by its
/// meaning, an input for a pilot control and an output for anything but a reference. `None` for a
/// reference, or if neither is stated.
fn known_side(column: &RecordColumn) -> Option<ChannelSide> {
    if column.side.is_some() {
        return column.side;
    }
    let meaning = column.meaning?;
    if CONTROLS.contains(&meaning) {
        Some(ChannelSide::Input)
    } else if meaning != TARGET {
        Some(ChannelSide::Output)
    } else {
        None
    }
}

/// Adds a column's channel name, unless the list contains it.
fn add_name(names: &mut Vec<String>, column: &RecordColumn) {
    let name = column.meaning.unwrap_or(&column.name);
    if !names.iter().any(|known| known == name) {
        names.push(name.to_owned());
    }
}

/// Formats "topic.column \[unit\]". A topic not yet joined to others is a record by itself, and the
/// record's variable names it.
fn column_description(table: &RecordTable, column: &RecordColumn) -> String {
    let mut description = String::new();
    if let Some(variable) = &table.source.variable {
        description.push_str(&format!("{variable}."));
    }
    description.push_str(&column.name);
    if let Some(unit) = &column.unit {
        description.push_str(&format!(" [{unit}]"));
    }
    description
}

/// Parses a channel list; `side` names the list in an error message.
fn parse_rules(side: &str, text: &str) -> Result<Vec<ChannelRule>, Message> {
    let list: ChannelList = match text.parse() {
        Ok(list) => list,
        Err(error) => {
            return Err(Message::new("wrong-channels", format!("{side}: {error}")));
        }
    };
    Ok(list.channels.iter().map(RequestedChannel::rule).collect())
}

/// Parses a band limit \[rad/s\]; NaN, which no band accepts, if the text is not a number.
fn parse_end(text: &str) -> f64 {
    typed_number(text).ok().flatten().unwrap_or(f64::NAN)
}
