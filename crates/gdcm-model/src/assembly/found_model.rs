//! A model as read from a file.

use std::path::Path;

use crate::dataset::condition::ConditionRecord;
use crate::dataset::unchecked_dataset::{ModelDraft, ResponseDraft};
use crate::names::response_name::ResponseNameError;
use crate::names::{KnownChannels, ResponseName};

/// Name and unit of a channel in a file; `None` where the file gives none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelLabel {
    pub name: Option<String>,
    pub unit: Option<String>,
}

impl ChannelLabel {
    /// Returns a label with this name and no unit.
    pub fn named(name: impl Into<String>) -> Self {
        Self {
            name: Some(name.into()),
            unit: None,
        }
    }
}

/// Facts that a file gives about the flight condition of its model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    pub condition: Option<i64>,
    /// True airspeed \[kt\].
    pub airspeed_kt: Option<f64>,
    /// Altitude \[ft\].
    pub altitude_ft: Option<f64>,
    /// Mass \[kg\].
    pub mass_kg: Option<f64>,
    pub name: Option<String>,
    /// Whether the file is a dataset written by this program: names of files and folders are then
    /// ignored.
    pub is_of_dataset: bool,
    /// Flight records, with file paths relative to the requested path.
    pub records: Vec<ConditionRecord>,
}

/// A model as read from a file, with channels in the file's order and units.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundModel {
    /// Matrices or response, timing, states and source. The name is that of the variable; the
    /// origin may still change.
    pub draft: ModelDraft,
    pub inputs: Vec<ChannelLabel>,
    pub outputs: Vec<ChannelLabel>,
    pub facts: Facts,
    /// Notes on how the model was recognised and which parts were skipped.
    pub notes: Vec<String>,
}

impl FoundModel {
    /// Returns the source file; empty where there is none.
    pub fn file(&self) -> &str {
        self.draft
            .source
            .as_ref()
            .and_then(|source| source.file.as_deref())
            .unwrap_or_default()
    }

    /// Returns the variable in the file; empty where the file holds one unnamed model.
    pub fn variable(&self) -> &str {
        self.draft
            .source
            .as_ref()
            .and_then(|source| source.variable.as_deref())
            .unwrap_or_default()
    }

    /// Returns the key for messages and rules: "c03/roll+5.mat#sys".
    pub fn key(&self) -> String {
        match self.variable() {
            "" => self.file().to_owned(),
            variable => format!("{}#{variable}", self.file()),
        }
    }

    /// Returns the channel names. For a single measured response without names in the file, they
    /// come from the variable, or else from the file name, where these contain known channel names.
    pub fn labels_with_name(&self, known: KnownChannels<'_>) -> NamedLabels {
        let mut named = NamedLabels {
            labels: [self.inputs.clone(), self.outputs.clone()],
            ambiguous: None,
        };
        if self.response().is_none() || self.inputs.len() != 1 || self.outputs.len() != 1 {
            return named;
        }
        let path = path_without_extension(self.file());
        let stem = path.rsplit('/').next().unwrap_or_default();
        for text in [self.variable(), stem] {
            if named.are_complete() {
                break;
            }
            match ResponseName::find(text, known) {
                Ok(found) => named.fill(found, text),
                Err(error) => {
                    let name = text.to_owned();
                    let ambiguous = AmbiguousName { name, error };
                    named.ambiguous.get_or_insert(ambiguous);
                }
            }
        }
        if named.are_complete() {
            named.ambiguous = None;
        }
        named
    }

    /// Returns the model with channel names from the alias table, taken from the file name where
    /// nothing else names them.
    pub fn with_names_of_file(mut self) -> Self {
        [self.inputs, self.outputs] = self.labels_with_name(KnownChannels::Field).labels;
        self
    }

    /// Returns the measured response, if there is one.
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
        let mut words = format!("{} states, {channels}", a.nrows());
        let timing = self.draft.timing.words();
        if !timing.is_empty() {
            words.push_str(", ");
            words.push_str(&timing);
        }
        words
    }
}

/// Channel names of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedLabels {
    /// Inputs and outputs.
    pub labels: [Vec<ChannelLabel>; 2],
    /// File or variable name that leaves missing channel names ambiguous.
    pub ambiguous: Option<AmbiguousName>,
}

/// A file or variable name that is ambiguous about the channels of a response.
#[derive(Clone, Debug, PartialEq)]
pub struct AmbiguousName {
    pub name: String,
    pub error: ResponseNameError,
}

impl NamedLabels {
    fn are_complete(&self) -> bool {
        self.labels.iter().all(|labels| labels[0].name.is_some())
    }

    /// Names the channels that have no name yet. A channel that the alias table knows but the
    /// dataset lacks keeps its name from the text, so that no other channel replaces it.
    fn fill(&mut self, found: ResponseName, text: &str) {
        let aliased = ResponseName::find(text, KnownChannels::Field).unwrap_or_default();
        let input = found.input.or(aliased.input);
        let output = found.output.or(aliased.output);
        for (labels, name) in self.labels.iter_mut().zip([input, output]) {
            if labels[0].name.is_none() {
                labels[0].name = name;
            }
        }
    }
}

/// Returns a path with forward slashes and without its extension, ".gz" included.
pub(super) fn path_without_extension(file: &str) -> String {
    let file = file.replace('\\', "/");
    let file = file.strip_suffix(".gz").unwrap_or(&file);
    Path::new(file)
        .with_extension("")
        .to_string_lossy()
        .into_owned()
}
