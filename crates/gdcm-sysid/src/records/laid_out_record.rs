//! A record with its channels' columns, and the information in its name: as proposed, as stored in
//! a dataset, or as edited by the user.
//!
//! A *layout* assigns a record's columns to its time and channels ([`RecordLayout`]). A *remedy*
//! ([`ChannelRemedy`]) is a factor on a channel's samples and a delay to remove, in one record. The
//! dataset stores remedies, but no layout, in the record's *entry* ([`ConditionRecord`]).

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_model::dataset::Dataset;
use gdcm_model::dataset::condition::{ChannelRemedy, ConditionRecord};
use gdcm_model::names::standard_patterns;
use gdcm_model::simulation::FlightRecord;

use super::layout_problem::{LayoutCaution, LayoutProblem};
use super::layout_proposal::{LayoutProposal, TimeSettings, has_sign_mark};
use super::record_channels::RecordChannels;
use super::record_guess::RecordGuess;
use super::record_layout::RecordLayout;
use super::record_table::RecordTable;
use crate::spectra::record_use::RecordUse;

/// A record as it was read, with its channels' columns.
#[derive(Clone, Debug)]
pub struct LaidOutRecord {
    /// The file's columns.
    pub table: Arc<RecordTable>,
    pub layout: RecordLayout,
    /// Information from the record's name, or given by the user instead.
    pub guess: RecordGuess,
    /// Whether the record is used by an identification.
    pub used: bool,
    /// Problems that prevent using the record.
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
        time: &TimeSettings,
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
        let notes = notes.iter().map(ToString::to_string).collect();
        (record, notes)
    }

    /// Creates a record with proposed columns, and returns a note for each choice. If the dataset
    /// names the record, its entry is applied (`with_entry`), and samples without a unit in the
    /// file are taken to be in the dataset's units. A user-defined conversion replaces the stored
    /// factor, and an alias with a sign mark the factor's sign.
    pub fn proposed_for_dataset(
        table: RecordTable,
        channels: &RecordChannels,
        dataset: &Dataset,
        time: &TimeSettings,
    ) -> (Self, Vec<String>) {
        let Some((_, entry)) = table.entry_of_dataset(dataset) else {
            return Self::proposed(table, channels, time);
        };
        let channels = channels.clone().of_named_records();
        let (record, mut notes) = Self::proposed(table, &channels, time);
        let mut remedies = BTreeMap::new();
        for (name, stored) in &entry.remedies {
            let remedy = remaining_remedy(*stored, name, &channels);
            if remedy != ChannelRemedy::NONE {
                let mut changes = Vec::new();
                if remedy.factor != 1.0 {
                    changes.push(format!("multiplied by {}", remedy.factor));
                }
                if remedy.delay_s != 0.0 {
                    changes.push(format!("delay of {} s removed", remedy.delay_s));
                }
                let changes = changes.join(", ");
                notes.push(format!("{name}: {changes}, as stored in the dataset"));
                remedies.insert(name.clone(), remedy);
            }
        }
        let entry = ConditionRecord {
            remedies,
            ..entry.clone()
        };
        (record.with_entry(&entry, &channels), notes)
    }

    /// Returns the record's first and last time \[s\], on its own clock; `None` while there are
    /// problems, or without finite stamps.
    pub fn span_s(&self) -> Option<[f64; 2]> {
        let flight = self.flight.as_ref()?;
        let mut stamps = flight.time_s.iter().filter(|time_s| time_s.is_finite());
        let first_s = stamps.next()?;
        let last_s = stamps.next_back().unwrap_or(first_s);
        Some([*first_s, *last_s])
    }

    /// Returns the record with other columns for its channels, and with problems, cautions and
    /// samples for these.
    #[must_use]
    pub fn laid_out(&self, layout: RecordLayout, channels: &RecordChannels) -> Self {
        let table = Arc::clone(&self.table);
        Self {
            used: self.used,
            ..Self::new(table, layout, self.guess.clone(), channels)
        }
    }

    /// Applies the record's dataset entry: its remedies, its manoeuvre, whether it is reserved for
    /// validation, and whether it is used.
    #[must_use]
    pub fn with_entry(self, entry: &ConditionRecord, channels: &RecordChannels) -> Self {
        let mut record = self;
        if !entry.remedies.is_empty() {
            let mut layout = record.layout.clone();
            layout.add_remedies(&entry.remedies, channels);
            record = record.laid_out(layout, channels);
        }
        record.guess.kind = entry.kind;
        record.guess.held_out = entry.held_out;
        record.used = entry.used;
        record
    }

    /// Returns the record's samples if it is used and has no problems.
    pub fn used_flight(&self) -> Option<&Arc<FlightRecord>> {
        if self.used {
            self.flight.as_ref()
        } else {
            None
        }
    }

    /// Creates the dataset entry: the location, the remedies, the information in the record's name,
    /// and the intervals used by an identification.
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

/// Returns what remains of a stored remedy beside the user's decisions about the channel, which
/// replace a part of it:
///
/// 1. with a user-defined factor or unit: the delay
/// 2. with an alias that has a sign mark, such as "-az": the delay and the factor's magnitude
/// 3. else: all of it
fn remaining_remedy(stored: ChannelRemedy, name: &str, channels: &RecordChannels) -> ChannelRemedy {
    let mut remedy = stored;
    let is_marked = channels
        .inputs
        .iter()
        .chain(&channels.outputs)
        .filter(|rule| rule.name == name)
        .any(|rule| rule.aliases.iter().any(|alias| has_sign_mark(alias)));
    if channels.declared.contains_key(name) {
        remedy.factor = 1.0;
    } else if is_marked {
        remedy.factor = remedy.factor.abs();
    }
    remedy
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::record_channels::DeclaredConversion;
    use gdcm_model::names::ChannelRule;

    /// The sign that an alias gives is not applied a second time from the dataset.
    #[test]
    fn user_decisions_replace_the_factor_of_a_stored_remedy_or_its_sign() {
        let stored = ChannelRemedy {
            factor: -0.5,
            delay_s: 0.02,
        };
        let mut channels = RecordChannels::default();
        channels.outputs.push(ChannelRule {
            name: "NZ".to_owned(),
            ..ChannelRule::default()
        });
        assert_eq!(remaining_remedy(stored, "NZ", &channels), stored);

        channels.outputs[0].aliases = vec!["acc_z".to_owned()];
        assert_eq!(remaining_remedy(stored, "NZ", &channels), stored);

        channels.outputs[0].aliases = vec!["-acc_z".to_owned()];
        let expected = ChannelRemedy {
            factor: 0.5,
            ..stored
        };
        assert_eq!(remaining_remedy(stored, "NZ", &channels), expected);

        channels
            .declared
            .insert("NZ".to_owned(), DeclaredConversion::Factor(-2.0));
        let expected = ChannelRemedy {
            factor: 1.0,
            ..stored
        };
        assert_eq!(remaining_remedy(stored, "NZ", &channels), expected);
    }
}
