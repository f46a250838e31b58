//! Information in a record's folder and file names: manoeuvre, validation, condition.

use gdcm_model::dataset::condition::RecordKind;
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::names::channel_alias::folded_name;
use gdcm_model::names::name_pattern::{NamePattern, read_name};

use super::record_table::RecordTable;

/// Information from a record's folder and file names.
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

/// Manoeuvres with the name parts that denote them.
const MANOEUVRES: [(RecordKind, &[&str]); 3] = [
    (RecordKind::Sweep, &["sweep", "chirp", "swp"]),
    (RecordKind::Multisine, &["multisine", "schroeder", "msine"]),
    (
        RecordKind::ThreeTwoOneOne,
        &["3211", "doublet", "dblt", "step"],
    ),
];
/// Name parts that denote validation records.
const VALIDATION: [&str; 5] = [
    "validation",
    "validate",
    "verification",
    "holdout",
    "heldout",
];
/// Further words for validation, matched as whole words only, because other words contain them
/// ("value", "testbed").
const VALIDATION_WORDS: [&str; 4] = ["val", "valid", "check", "verif"];

impl RecordGuess {
    /// Derives the information from the record's name, its file's name, and its variable's name or
    /// its file's name in an archive.
    pub fn from_table(table: &RecordTable, patterns: &[NamePattern]) -> Self {
        let mut names = vec![table.source.file.as_str()];
        names.extend(table.source.variable.as_deref());
        names.push(&table.name);
        Self::from_name(&names.join("/"), patterns)
    }

    /// Derives the information from a name such as "c03_045kt/sweep_LON_1.csv" by these patterns.
    pub fn from_name(name: &str, patterns: &[NamePattern]) -> Self {
        // "3-2-1-1" and "hold_out" become "3211" and "holdout".
        let joined = folded_name(name);
        let facts = read_name(name, patterns);
        Self {
            kind: manoeuvre(&joined),
            held_out: contains_any(&joined, &VALIDATION) || has_validation_word(name),
            condition: facts.condition,
            airspeed_kt: facts.airspeed_kt,
        }
    }

    /// Returns the condition in the name; `None` if the name has none, or if `dataset` lacks it.
    pub fn condition_of(&self, dataset: &Dataset) -> Option<ConditionId> {
        let condition = dataset.condition(ConditionId(self.condition?))?;
        Some(condition.id())
    }
}

/// Returns the first manoeuvre in [`MANOEUVRES`] that a folded name contains; else `Other`.
fn manoeuvre(folded: &str) -> RecordKind {
    for (kind, parts) in MANOEUVRES {
        if contains_any(folded, parts) {
            return kind;
        }
    }
    RecordKind::Other
}

fn contains_any(name: &str, parts: &[&str]) -> bool {
    parts.iter().any(|part| name.contains(part))
}

fn has_validation_word(name: &str) -> bool {
    name.to_lowercase()
        .split(|c: char| !c.is_alphabetic())
        .any(|word| VALIDATION_WORDS.contains(&word))
}

#[cfg(test)]
mod tests {
    use gdcm_model::names::standard_patterns;

    use super::*;

    fn guess(
        kind: RecordKind,
        held_out: bool,
        condition: Option<i64>,
        airspeed_kt: Option<f64>,
    ) -> RecordGuess {
        RecordGuess {
            kind,
            held_out,
            condition,
            airspeed_kt,
        }
    }

    #[test]
    fn a_name_gives_manoeuvre_condition_and_validation() {
        use RecordKind::{Multisine, Other, Sweep, ThreeTwoOneOne};
        for (name, expected) in [
            ("cond01_sweep_LON_1.csv", guess(Sweep, false, Some(1), None)),
            ("cond11_validation.csv", guess(Other, true, Some(11), None)),
            (
                "c03_045kt/LatChirp2.mat",
                guess(Sweep, false, Some(3), Some(45.0)),
            ),
            (
                "fc-7/3-2-1-1 ped.txt",
                guess(ThreeTwoOneOne, false, Some(7), None),
            ),
            ("doublet_val_2.csv", guess(ThreeTwoOneOne, true, None, None)),
            ("multi_sine_1_hold-out", guess(Multisine, true, None, None)),
            ("values.csv", guess(Other, false, None, None)),
        ] {
            assert_eq!(
                RecordGuess::from_name(name, standard_patterns()),
                expected,
                "{name}"
            );
        }
    }
}
