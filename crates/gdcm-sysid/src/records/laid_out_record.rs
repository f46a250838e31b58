//! A record with the columns of its channels, and the information in its name.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::DMatrix;

use gdcm_model::dataset::condition::{ChannelRemedy, ConditionRecord, RecordKind};
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::names::channel_alias::folded_name;
use gdcm_model::names::name_pattern::read_name;
use gdcm_model::names::{NamePattern, standard_patterns};
use gdcm_model::simulation::FlightRecord;

use super::layout_problem::{LayoutCaution, LayoutProblem};
use super::layout_proposal::{LayoutProposal, TimeWish};
use super::record_channels::RecordChannels;
use super::record_layout::RecordLayout;
use super::record_table::{RecordColumn, RecordTable, TimeBase};
use crate::identification::preparation::RecordUse;

/// Information from the folder and file names of a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordGuess {
    /// The manoeuvre.
    pub kind: RecordKind,
    /// Whether the record is reserved for validation.
    pub held_out: bool,
    pub condition: Option<i64>,
    /// True airspeed \[kt\].
    pub airspeed_kt: Option<f64>,
}

/// Parts of the names of manoeuvres and of validation records.
const MANOEUVRES: [(RecordKind, &[&str]); 3] = [
    (RecordKind::Sweep, &["sweep", "chirp", "swp"]),
    (RecordKind::Multisine, &["multisine", "schroeder", "msine"]),
    (
        RecordKind::ThreeTwoOneOne,
        &["3211", "doublet", "dblt", "step"],
    ),
];
const VALIDATION: [&str; 5] = [
    "validation",
    "validate",
    "verification",
    "holdout",
    "heldout",
];
/// Further words for validation, matched as whole words only, because others contain them ("value",
/// "testbed").
const VALIDATION_WORDS: [&str; 4] = ["val", "valid", "check", "verif"];

/// Endings of the names of recorded references: pilot and position references, setpoints, injected
/// signals; endings of up to two letters must be whole words.
const REFERENCES: &str =
    "ref reference cmd command sp setpoint des desired targ target chirp excitation x0";

/// Whether a word in a name marks a recorded reference: "pos_ref", "RATE.RDes", "SIDD.Targ".
fn names_reference(name: &str) -> bool {
    let lower = name.to_lowercase();
    let mut words = lower.split(|letter: char| !letter.is_alphanumeric());
    words.any(|word| {
        REFERENCES
            .split(' ')
            .any(|end| word == end || end.len() > 2 && word.ends_with(end))
    })
}

impl RecordGuess {
    /// Reads the names of a record, of its file, and of its variable or file in an archive.
    pub fn of_table(table: &RecordTable, patterns: &[NamePattern]) -> Self {
        let source = &table.source;
        let names = [
            Some(source.file.as_str()),
            source.variable.as_deref(),
            Some(table.name.as_str()),
        ];
        Self::of(
            &names.into_iter().flatten().collect::<Vec<_>>().join("/"),
            patterns,
        )
    }

    /// Returns the condition in the name; `None` if the name has none, or `dataset` does not have
    /// it.
    pub fn condition_of(&self, dataset: &Dataset) -> Option<ConditionId> {
        let said = ConditionId(self.condition?);
        dataset.condition(said).map(|condition| condition.id())
    }

    /// Reads a name such as "c03_045kt/sweep_LON_1.csv" by these patterns.
    pub fn of(name: &str, patterns: &[NamePattern]) -> Self {
        let lower = name.to_lowercase();
        // "3-2-1-1" and "hold_out" become "3211" and "holdout".
        let joined = folded_name(name);
        let holds = |words: &[&str]| words.iter().any(|word| joined.contains(word));
        let kind = MANOEUVRES
            .into_iter()
            .find(|(_, words)| holds(words))
            .map_or(RecordKind::Other, |(kind, _)| kind);
        let mut words = lower.split(|c: char| !c.is_alphabetic());
        let held_out = holds(&VALIDATION) || words.any(|word| VALIDATION_WORDS.contains(&word));
        let facts = read_name(name, patterns);
        Self {
            kind,
            held_out,
            condition: facts.condition,
            airspeed_kt: facts.airspeed_kt,
        }
    }
}

/// A record as it was read, with the columns of its channels.
#[derive(Clone, Debug)]
pub struct LaidOutRecord {
    /// The contents of its file.
    pub table: Arc<RecordTable>,
    pub layout: RecordLayout,
    /// Information from its name, or from the user instead.
    pub guess: RecordGuess,
    pub used: bool,
    /// Problems that prevent its use.
    pub problems: Vec<LayoutProblem>,
    /// Unusual features that may be correct.
    pub cautions: Vec<LayoutCaution>,
    /// Samples in the units of the channels; `None` while there are problems.
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
        let guess = RecordGuess::of_table(&table, standard_patterns());
        let flight = layout.flight_record(&table, channels).ok().map(Arc::new);
        (
            Self {
                table: Arc::new(table),
                layout,
                guess,
                used: true,
                problems,
                cautions,
                flight,
            },
            notes,
        )
    }

    /// Creates a record with its channels. A record named by the dataset follows the dataset: in
    /// its units if the file gives none, with the factors and delays stored there. A user-defined
    /// conversion of a channel replaces the stored factor.
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
        for (name, remedy) in &entry.remedies {
            let factor = if channels.said.contains_key(name) {
                1.0
            } else {
                remedy.factor
            };
            let kept = ChannelRemedy { factor, ..*remedy };
            if kept != ChannelRemedy::NONE {
                let times = kept.factor;
                let less_s = kept.delay_s;
                notes.push(format!("{name}: times {times}, {less_s} s taken out, as the dataset says of this record"));
                remedies.insert(name.clone(), kept);
            }
        }
        let entry = ConditionRecord {
            remedies,
            ..entry.clone()
        };
        (record.as_said(&entry, &channels), notes)
    }

    /// Returns the first and last time \[s\] of its samples, on its own clock; `None` while there
    /// are problems, or if no stamp is a number.
    pub fn span_s(&self) -> Option<[f64; 2]> {
        let mut stamps = self
            .flight
            .as_ref()?
            .time_s
            .iter()
            .copied()
            .filter(|time_s| time_s.is_finite());
        let first_s = stamps.next()?;
        Some([first_s, stamps.next_back().unwrap_or(first_s)])
    }

    /// Returns the same record with other columns for its channels.
    #[must_use]
    pub fn laid_out(&self, layout: RecordLayout, channels: &RecordChannels) -> Self {
        Self {
            used: self.used,
            ..Self::new(
                Arc::clone(&self.table),
                layout,
                self.guess.clone(),
                channels,
            )
        }
    }

    /// Applies the dataset entry of the record: its remedies, whether it is reserved for
    /// validation, and whether it is used.
    #[must_use]
    pub fn as_said(self, entry: &ConditionRecord, channels: &RecordChannels) -> Self {
        let record = if entry.remedies.is_empty() {
            self
        } else {
            let mut layout = self.layout.clone();
            layout.put_right(&entry.remedies, channels);
            self.laid_out(layout, channels)
        };
        let guess = RecordGuess {
            kind: entry.kind,
            held_out: entry.held_out,
            ..record.guess
        };
        Self {
            used: entry.used,
            guess,
            ..record
        }
    }

    /// Returns the varying columns that are neither the time nor a channel and may have driven a
    /// loop from outside (M14.15), each with a flag for a reference name; flagged columns first.
    pub fn possible_references(&self) -> Vec<(&str, bool)> {
        let RecordLayout {
            time,
            inputs,
            outputs,
        } = &self.layout;
        let channels = inputs
            .iter()
            .chain(outputs)
            .flatten()
            .map(|used| used.column);
        let time = time.and_then(|time| {
            if let TimeBase::Column { column, .. } = time {
                Some(column)
            } else {
                None
            }
        });
        let taken: Vec<usize> = channels.chain(time).collect();
        let columns = self
            .table
            .columns
            .iter()
            .enumerate()
            .filter(|(index, _)| !taken.contains(index));
        let moves =
            |column: &RecordColumn| column.range().is_some_and(|(least, most)| least < most);
        // A column that the system's documentation identifies as a signal of the aircraft is not a
        // reference.
        let is_free =
            |column: &RecordColumn| column.meaning.is_none_or(|meaning| meaning == "TARG");
        let mut found: Vec<(&str, bool)> = columns
            .filter(|(_, column)| moves(column))
            .map(|(_, column)| {
                (
                    column.name.as_str(),
                    is_free(column) && names_reference(&column.name),
                )
            })
            .collect();
        found.sort_by_key(|(_, is_named)| !is_named);
        found
    }

    /// Returns its samples if it is used.
    pub fn used_flight(&self) -> Option<&Arc<FlightRecord>> {
        self.flight.as_ref().filter(|_| self.used)
    }

    /// Creates the dataset entry: the location, the information in its name, and the intervals used
    /// by an identification.
    pub fn entry(&self, found: &RecordUse, channels: &RecordChannels) -> ConditionRecord {
        let used_s = self
            .flight
            .as_ref()
            .map_or_else(Vec::new, |flight| found.spans(flight));
        ConditionRecord {
            used_s,
            ..self
                .layout
                .condition_record(&self.table, &self.guess, channels)
        }
    }
}

/// Excludes each record whose samples repeat an earlier one, with a caution: evidence counts once,
/// however often and under whatever names it is given. A user decision on a copy that was already
/// reported is kept.
pub fn leave_out_copies(records: &mut [LaidOutRecord]) {
    for index in 1..records.len() {
        let (before, from) = records.split_at_mut(index);
        let record = &mut from[0];
        let Some(flight) = record.used_flight() else {
            continue;
        };
        let is_it = |other: &&LaidOutRecord| {
            other
                .used_flight()
                .is_some_and(|other| is_copy(other, flight))
        };
        let Some(first) = before.iter().find(is_it) else {
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

/// Whether all samples agree to the last bit; the clocks may differ.
fn is_copy(a: &FlightRecord, b: &FlightRecord) -> bool {
    let same = |a: &DMatrix<f64>, b: &DMatrix<f64>| {
        a.shape() == b.shape()
            && a.iter()
                .zip(b.iter())
                .all(|(a, b)| a.to_bits() == b.to_bits())
    };
    same(&a.inputs, &b.inputs) && same(&a.outputs, &b.outputs)
}

#[cfg(test)]
mod tests {
    use gdcm_model::names::ChannelRule;

    use super::*;

    #[test]
    fn columns_that_may_have_driven_the_loop_are_named_those_first_whose_names_say_so() {
        let moving =
            |name: &str| RecordColumn::new(name, (0..60).map(|k| f64::from(k) * 0.02).collect());
        let known = |name: &str, meaning| RecordColumn {
            meaning: Some(meaning),
            ..moving(name)
        };
        let still = RecordColumn::new("yaw_ref", vec![1.0; 60]);
        let columns = ["t", "M", "q", "theta", "x0", "RATE.RDes"]
            .map(moving)
            .to_vec();
        let more = vec![
            known("SIDD.Targ", "TARG"),
            known("torque_setpoint", "LAT"),
            still,
        ];
        let table = RecordTable::new("log", [columns, more].concat());
        let rules = |name: &str| vec![ChannelRule::named(name)];
        let channels = RecordChannels {
            inputs: rules("M"),
            outputs: rules("q"),
            ..RecordChannels::default()
        };
        let (record, _) = LaidOutRecord::proposed(table, &channels, &TimeWish::default());
        let named = [("x0", true), ("RATE.RDes", true), ("SIDD.Targ", true)];
        assert_eq!(
            record.possible_references(),
            [&named[..], &[("theta", false), ("torque_setpoint", false)]].concat()
        );
    }

    #[test]
    fn a_name_says_manoeuvre_condition_and_validation() {
        let patterns = standard_patterns();
        let guess = |name: &str| {
            let guess = RecordGuess::of(name, patterns);
            (
                guess.kind,
                guess.held_out,
                guess.condition,
                guess.airspeed_kt,
            )
        };
        assert_eq!(
            guess("cond01_sweep_LON_1.csv"),
            (RecordKind::Sweep, false, Some(1), None)
        );
        assert_eq!(
            guess("cond11_validation.csv"),
            (RecordKind::Other, true, Some(11), None)
        );
        assert_eq!(
            guess("c03_045kt/LatChirp2.mat"),
            (RecordKind::Sweep, false, Some(3), Some(45.0))
        );
        assert_eq!(
            guess("fc-7/3-2-1-1 ped.txt"),
            (RecordKind::ThreeTwoOneOne, false, Some(7), None)
        );
        assert_eq!(
            guess("doublet_val_2.csv"),
            (RecordKind::ThreeTwoOneOne, true, None, None)
        );
        assert_eq!(
            guess("multi_sine_1_hold-out"),
            (RecordKind::Multisine, true, None, None)
        );
        assert_eq!(guess("values.csv"), (RecordKind::Other, false, None, None));
    }
}
