//! A model as read from a file.

use std::path::Path;

use crate::dataset::condition::ConditionRecord;
use crate::dataset::dataset_draft::{ModelDraft, ResponseDraft};
use crate::number_format::counted;

/// A channel's name and unit in a file; `None` if the file does not give them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelLabel {
    pub name: Option<String>,
    pub unit: Option<String>,
}

impl ChannelLabel {
    /// Creates a label with a name and no unit.
    pub fn named(name: impl Into<String>) -> Self {
        Self {
            name: Some(name.into()),
            unit: None,
        }
    }
}

/// Facts about a model that its file states: flight condition, model name and flight records.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    pub condition: Option<i64>,
    /// True airspeed \[kt\].
    pub airspeed_kt: Option<f64>,
    pub altitude_ft: Option<f64>,
    pub mass_kg: Option<f64>,
    pub name: Option<String>,
    /// Whether the file is a dataset written by this program. Its contents are then not compared
    /// with the names of the file and its folders, and the origin "perturbed" counts as stated, not
    /// as the default.
    pub is_of_dataset: bool,
    /// Flight records; file paths are relative to the requested path, the file or folder to be
    /// imported.
    pub records: Vec<ConditionRecord>,
}

/// A model as read from a file, with channels in the file's order and units.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundModel {
    /// Matrices or response, timing, states and source. Its name is the variable name; its origin
    /// is provisional.
    pub draft: ModelDraft,
    pub inputs: Vec<ChannelLabel>,
    pub outputs: Vec<ChannelLabel>,
    pub facts: Facts,
    /// Notes on how the model was recognised, and on skipped parts in the file.
    pub notes: Vec<String>,
}

impl FoundModel {
    /// Returns the source file's path; empty if the model has no source file.
    pub fn file(&self) -> &str {
        self.draft
            .source
            .as_ref()
            .and_then(|source| source.file.as_deref())
            .unwrap_or_default()
    }

    /// Returns the variable's name in the file; empty if the file contains a single unnamed model.
    pub fn variable(&self) -> &str {
        self.draft
            .source
            .as_ref()
            .and_then(|source| source.variable.as_deref())
            .unwrap_or_default()
    }

    /// Returns the key that identifies the model in messages and rules: "c03/roll+5.mat#sys".
    pub fn key(&self) -> String {
        match self.variable() {
            "" => self.file().to_owned(),
            variable => format!("{}#{variable}", self.file()),
        }
    }

    /// Returns the measured response; `None` for a model given by matrices.
    pub fn response(&self) -> Option<&ResponseDraft> {
        self.draft.response.as_ref()
    }

    /// Describes the model: "39 states, 4 in, 6 out", "measured at 120 frequencies, 1 in, 1 out".
    pub fn words(&self) -> String {
        let channels = format!("{} in, {} out", self.inputs.len(), self.outputs.len());
        if let Some(response) = &self.draft.response {
            let count = response.omega.len();
            return format!("measured at {count} frequencies, {channels}");
        }
        let Some(a) = &self.draft.matrices[0] else {
            return channels;
        };
        let mut words = format!("{}, {channels}", counted(a.nrows(), "state"));
        let timing = self.draft.timing.words();
        if !timing.is_empty() {
            words.push_str(", ");
            words.push_str(&timing);
        }
        words
    }
}

/// Returns the path with forward slashes and without its extension; for "x.mat.gz", both extensions
/// are removed.
pub(super) fn path_without_extension(file: &str) -> String {
    let file = file.replace('\\', "/");
    let file = file.strip_suffix(".gz").unwrap_or(&file);
    Path::new(file)
        .with_extension("")
        .to_string_lossy()
        .into_owned()
}
