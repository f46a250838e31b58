//! A model's source: file, variable, flight records, and notes on its import.

use super::channel::ChannelSide;

/// A model's source, as far as its author gives it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Path relative to the dataset's file.
    pub file: Option<String>,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: Option<String>,
    /// Variable in the file, or flight record.
    pub variable: Option<String>,
    /// Creation date, in any format.
    pub made: Option<String>,
    /// Notes on reading, unit conversion and joining, separated by semicolons.
    pub note: Option<String>,
    /// Flight records from which an identified model was estimated, by name; empty if unknown.
    pub records: Vec<String>,
    /// Unused variables in the file; listed only in each file's first model.
    pub unused: Vec<String>,
    /// Sides (inputs, outputs) whose channels have no names in the file and were matched by
    /// position; a caution states them, not [`Self::words`].
    pub by_position: Vec<ChannelSide>,
}

impl Provenance {
    /// Describes the provenance: "models/roll+5.mat, variable sys, made 2026-03-01".
    pub fn words(&self) -> String {
        let mut parts: Vec<String> = Vec::new();
        parts.extend(self.file.clone());
        parts.extend(
            self.variable
                .as_ref()
                .map(|name| format!("variable {name}")),
        );
        parts.extend(self.made.as_ref().map(|date| format!("made {date}")));
        parts.extend(self.sha256.as_ref().map(|hash| format!("SHA-256 {hash}")));
        match self.records.as_slice() {
            [] => {}
            [record] => parts.push(format!("from the record {record}")),
            records => parts.push(format!("from the records {}", records.join(", "))),
        }
        parts.extend(self.note.clone());
        if !self.unused.is_empty() {
            parts.push(format!("unused variables: {}", self.unused.join(", ")));
        }
        parts.join(", ")
    }

    /// Returns the provenance with its preposition: "from models/roll+5.mat, variable sys", "from
    /// the record sweep_1".
    pub fn origin_words(&self) -> String {
        let words = self.words();
        if self.file.is_none() && words.starts_with("from ") {
            words
        } else {
            format!("from {words}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_origin_has_one_preposition() {
        let file = Provenance {
            file: Some("roll.mat".to_owned()),
            ..Provenance::default()
        };
        assert_eq!(file.origin_words(), "from roll.mat");
        let records = Provenance {
            records: vec!["sweep_1".to_owned()],
            ..Provenance::default()
        };
        assert_eq!(records.origin_words(), "from the record sweep_1");
    }
}
