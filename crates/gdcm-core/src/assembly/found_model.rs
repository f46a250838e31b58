//! A model as some file gave it.

use crate::dataset::{ConditionRecord, ModelDraft, ResponseDraft};

/// What a file says of one channel.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelLabel {
    /// Its name; none where the file has none.
    pub name: Option<String>,
    /// Its unit; none where the file has none.
    pub unit: Option<String>,
}

impl ChannelLabel {
    /// A channel of this name, without a unit.
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: Some(name.into()), unit: None }
    }
}

/// What a file says about the flight condition of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    /// Number of the condition.
    pub condition: Option<i64>,
    /// True airspeed \[kt\].
    pub airspeed_kt: Option<f64>,
    /// Altitude \[ft\].
    pub altitude_ft: Option<f64>,
    /// Mass \[kg\].
    pub mass_kg: Option<f64>,
    /// Its flight records, their files relative to what was asked for.
    pub records: Vec<ConditionRecord>,
}

/// A model as some file gave it: its channels are the file's, in the file's order and units.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundModel {
    /// Its numbers, timing, states and provenance. Its name is the variable's; its origin says nothing yet.
    pub draft: ModelDraft,
    /// Its inputs.
    pub inputs: Vec<ChannelLabel>,
    /// Its outputs.
    pub outputs: Vec<ChannelLabel>,
    /// What the file says about its flight condition.
    pub facts: Facts,
    /// How it was recognised, and what was left out, in words.
    pub notes: Vec<String>,
}

impl FoundModel {
    /// The file that it comes from; empty where it comes from none.
    pub fn file(&self) -> &str {
        self.draft.source.as_ref().and_then(|source| source.file.as_deref()).unwrap_or_default()
    }

    /// The variable in the file; empty where the file holds one model without a name.
    pub fn variable(&self) -> &str {
        self.draft.source.as_ref().and_then(|source| source.variable.as_deref()).unwrap_or_default()
    }

    /// What it is called in messages and in rules: "c03/roll+5.mat#sys".
    pub fn key(&self) -> String {
        match self.variable() {
            "" => self.file().to_owned(),
            variable => format!("{}#{variable}", self.file()),
        }
    }

    /// The measured response, where it is one.
    pub fn response(&self) -> Option<&ResponseDraft> {
        self.draft.response.as_ref()
    }

    /// "39 states, 4 x 6", "measured, 120 frequencies, 1 x 1".
    pub fn words(&self) -> String {
        let channels = format!("{} in, {} out", self.inputs.len(), self.outputs.len());
        let timing = self.draft.timing.words();
        let timing = if timing.is_empty() { timing } else { format!(", {timing}") };
        match (&self.draft.response, &self.draft.matrices[0]) {
            (Some(response), _) => format!("measured at {} frequencies, {channels}", response.omega.len()),
            (None, Some(a)) => format!("{} states, {channels}{timing}", a.nrows()),
            (None, None) => channels,
        }
    }
}
