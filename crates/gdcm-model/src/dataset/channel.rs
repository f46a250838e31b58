//! Inputs and outputs of an aircraft.

use std::fmt;

use serde::{Deserialize, Serialize};

/// An input (a control position) or an output (a measured motion).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Short name, unique among the inputs or among the outputs ("LON", "NY").
    pub name: String,
    /// Unit in the dataset's spelling ("%", "deg/s").
    pub unit: String,
    /// Meaning and positive direction.
    pub description: String,
}

impl Channel {
    /// Creates a channel with a name and a unit, and no description.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            description: String::new(),
        }
    }
}

/// Whether a channel is an aircraft input or output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ChannelSide {
    /// A control position, such as stick or pedal.
    Input,
    /// A measured motion, such as a rate or an acceleration.
    Output,
}

impl ChannelSide {
    /// Returns `inputs` or `outputs`, whichever belongs to this side.
    pub fn pick<T>(self, inputs: T, outputs: T) -> T {
        match self {
            Self::Input => inputs,
            Self::Output => outputs,
        }
    }
}

impl fmt::Display for ChannelSide {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.pick("input", "output"))
    }
}
