//! A record with its channels' columns, and the information in its name.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::DMatrix;

use gdcm_model::dataset::Dataset;
use gdcm_model::dataset::condition::{ChannelRemedy, ConditionRecord};
use gdcm_model::names::name_pattern::standard_patterns;
use gdcm_model::simulation::FlightRecord;

use super::layout_problem::{LayoutCaution, LayoutProblem};
use super::layout_proposal::{LayoutProposal, TimeWish};
use super::record_channels::RecordChannels;
use super::record_guess::RecordGuess;
use super::record_layout::RecordLayout;
use super::record_table::RecordTable;
use crate::spectra::record_use::RecordUse;

/// Name endings for recorded references: pilot and position references, setpoints, injected
/// signals. Endings up to two letters long must be whole words.
const REFERENCES: &str =
    "ref reference cmd command sp setpoint des desired targ target chirp excitation x0";

/// A record as it was read, with its channels' columns.
#[derive(Clone, Debug)]
pub struct LaidOutRecord {
    /// Columns of the file.
    pub table: Arc<RecordTable>,
    pub layout: RecordLayout,
    /// Information from the record's name, or given by the user instead.
    pub guess: RecordGuess,
    pub used: bool,
    /// Problems that prevent the use of the record.
    pub problems: Vec<LayoutProblem>,
    /// Unusual features that may be correct.
    pub cautions: Vec<LayoutCaution>,
    /// Samples in channel units; `None` while there are problems.
    pub flight: Option<Arc<FlightRecord>>,
}

impl LaidOutRecord {
    /// Creates a record with these columns for its channels.
    pub fn new(
        table: Arc<RecordTable>,
        layout: RecordLayout,
        guess: RecordGuess,
        channels: &RecordChannels,
    ) -> Self {
        let problems = layout.problems(&table, channels);
        let cautions = layout.cautions(&table, channels);
        let flight = layout.flight_record(&table, channels).ok().map(Arc::new);
        Self {
            table,
            layout,
            guess,
            used: true,
            problems,
            cautions,
            flight,
        }
    }

    /// Creates a record with proposed columns, and returns a note for each choice.
    pub fn proposed(
        table: RecordTable,
        channels: &RecordChannels,
        time: &TimeWish,
    ) -> (Self, Vec<String>) {
        let LayoutProposal {
            layout,
            notes,
            problems,
            cautions,
        } = RecordLayout::proposed(&table, channels, time);
        let guess = RecordGuess::from_table(&table, standard_patterns());
        let flight = layout.flight_record(&table, channels).ok().map(Arc::new);
        let record = Self {
            table: Arc::new(table),
            layout,
            guess,
            used: true,
            problems,
            cautions,
            flight,
        };
        (record, notes)
    }

    /// Creates a record with its channels. A record named by the dataset is read with the factors
    /// and delays stored there, and in the dataset's units if the file gives none. A user-defined
    /// conversion replaces the stored factor.
    pub fn as_dataset_says(
        table: RecordTable,
        channels: &RecordChannels,
        dataset: &Dataset,
        time: &TimeWish,
    ) -> (Self, Vec<String>) {
        let Some((_, entry)) = table.entry_of_dataset(dataset) else {
            return Self::proposed(table, channels, time);
        };
        let channels = channels.clone().of_named_records();
        let (record, mut notes) = Self::proposed(table, &channels, time);
        let mut remedies = BTreeMap::new();
        for (name, stored) in &entry.remedies {
            let mut remedy = *stored;
            if channels.said.contains_key(name) {
                remedy.factor = 1.0;
            }
            if remedy != ChannelRemedy::NONE {
                notes.push(format!(
                    "{name}: multiplied by {}, delay of {} s removed, as stored in the dataset",
                    remedy.factor, remedy.delay_s
                ));
                remedies.insert(name.clone(), remedy);
            }
        }
        let entry = ConditionRecord {
            remedies,
            ..entry.clone()
        };
        (record.as_said(&entry, &channels), notes)
    }

    /// Returns the first and the last time of the record \[s\], on the record's clock; `None` while
    /// there are problems, or without finite stamps.
    pub fn span_s(&self) -> Option<[f64; 2]> {
        let flight = self.flight.as_ref()?;
        let mut stamps = flight.time_s.iter().filter(|time_s| time_s.is_finite());
        let first_s = stamps.next()?;
        let last_s = stamps.next_back().unwrap_or(first_s);
        Some([*first_s, *last_s])
    }

    /// Returns the record with other columns for its channels.
    #[must_use]
    pub fn laid_out(&self, layout: RecordLayout, channels: &RecordChannels) -> Self {
        let table = Arc::clone(&self.table);
        Self {
            used: self.used,
            ..Self::new(table, layout, self.guess.clone(), channels)
        }
    }

    /// Applies the record's dataset entry: its remedies, whether it is reserved for
    /// validation, and whether it is used.
    #[must_use]
    pub fn as_said(self, entry: &ConditionRecord, channels: &RecordChannels) -> Self {
        let mut record = self;
        if !entry.remedies.is_empty() {
            let mut layout = record.layout.clone();
            layout.put_right(&entry.remedies, channels);
            record = record.laid_out(layout, channels);
        }
        record.guess.kind = entry.kind;
        record.guess.held_out = entry.held_out;
        record.used = entry.used;
        record
    }

    /// Returns the varying columns that are neither the time nor a channel: these may have driven
    /// the loop from outside (M14.15). The flag states whether the column is named like a
    /// reference; flagged columns come first.
    pub fn possible_references(&self) -> Vec<(&str, bool)> {
        let mut taken = Vec::new();
        taken.extend(self.layout.time_column());
        for used in self.layout.inputs.iter().chain(&self.layout.outputs) {
            taken.extend(used.map(|used| used.column));
        }
        let mut found = Vec::new();
        for (index, column) in self.table.columns.iter().enumerate() {
            if taken.contains(&index) || !column.varies() {
                continue;
            }
            // A column that the documentation of the logging system identifies as an aircraft
            // signal is not a reference.
            let may_be_reference = column.meaning.is_none_or(|meaning| meaning == "TARG");
            let is_reference = may_be_reference && is_reference_name(&column.name);
            found.push((column.name.as_str(), is_reference));
        }
        found.sort_by_key(|(_, is_reference)| !is_reference);
        found
    }

    /// Returns the samples of the record if it is used.
    pub fn used_flight(&self) -> Option<&Arc<FlightRecord>> {
        if self.used {
            self.flight.as_ref()
        } else {
            None
        }
    }

    /// Creates the dataset entry: the location, the information in the record's name, and the
    /// intervals used by an identification.
    pub fn entry(&self, found: &RecordUse, channels: &RecordChannels) -> ConditionRecord {
        let mut entry = self
            .layout
            .condition_record(&self.table, &self.guess, channels);
        if let Some(flight) = &self.flight {
            entry.used_s = found.spans(flight);
        }
        entry
    }
}

/// Returns whether a word in a name marks a recorded reference: "pos_ref", "RATE.RDes",
/// "SIDD.Targ".
fn is_reference_name(name: &str) -> bool {
    name.to_lowercase()
        .split(|letter: char| !letter.is_alphanumeric())
        .any(ends_as_reference)
}

fn ends_as_reference(word: &str) -> bool {
    REFERENCES
        .split(' ')
        .any(|end| word == end || (end.len() > 2 && word.ends_with(end)))
}

/// Excludes each record whose samples repeat an earlier record, with a caution: each measurement
/// counts once, however often and under whatever names it is read. A user decision on a copy that
/// was already reported is kept.
pub fn leave_out_copies(records: &mut [LaidOutRecord]) {
    for index in 1..records.len() {
        let (earlier, rest) = records.split_at_mut(index);
        let record = &mut rest[0];
        let Some(first) = original_of(record, earlier) else {
            continue;
        };
        let caution = LayoutCaution::Copy {
            first: first.table.name.clone(),
        };
        if !record.cautions.contains(&caution) {
            record.used = false;
            record.cautions.push(caution);
        }
    }
}

/// Returns the first used record with the same samples.
fn original_of<'r>(
    record: &LaidOutRecord,
    earlier: &'r [LaidOutRecord],
) -> Option<&'r LaidOutRecord> {
    let flight = record.used_flight()?;
    earlier.iter().find(|other| match other.used_flight() {
        Some(other) => is_copy(other, flight),
        None => false,
    })
}

/// Returns whether all samples agree to the last bit; the clocks may differ.
fn is_copy(a: &FlightRecord, b: &FlightRecord) -> bool {
    has_same_bits(&a.inputs, &b.inputs) && has_same_bits(&a.outputs, &b.outputs)
}

fn has_same_bits(a: &DMatrix<f64>, b: &DMatrix<f64>) -> bool {
    a.shape() == b.shape()
        && a.iter()
            .zip(b.iter())
            .all(|(a, b)| a.to_bits() == b.to_bits())
}

#[cfg(test)]
mod tests {
    use gdcm_model::names::ChannelRule;

    use super::*;
    use crate::records::record_table::RecordColumn;

    fn moving(name: &str) -> RecordColumn {
        RecordColumn::new(name, (0..60).map(|k| f64::from(k) * 0.02).collect())
    }

    fn documented(name: &str, meaning: &'static str) -> RecordColumn {
        RecordColumn {
            meaning: Some(meaning),
            ..moving(name)
        }
    }

    #[test]
    fn possible_references_are_varying_columns_and_those_with_reference_names_come_first() {
        let columns = vec![
            moving("t"),
            moving("M"),
            moving("q"),
            moving("theta"),
            moving("x0"),
            moving("RATE.RDes"),
            documented("SIDD.Targ", "TARG"),
            documented("torque_setpoint", "LAT"),
            RecordColumn::new("yaw_ref", vec![1.0; 60]),
        ];
        let table = RecordTable::new("log", columns);
        let channels = RecordChannels {
            inputs: vec![ChannelRule::named("M")],
            outputs: vec![ChannelRule::named("q")],
            ..RecordChannels::default()
        };
        let (record, _) = LaidOutRecord::proposed(table, &channels, &TimeWish::default());
        assert_eq!(
            record.possible_references(),
            [
                ("x0", true),
                ("RATE.RDes", true),
                ("SIDD.Targ", true),
                ("theta", false),
                ("torque_setpoint", false),
            ]
        );
    }
}
