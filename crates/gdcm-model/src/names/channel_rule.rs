//! A dataset channel and its names in files.

use serde::{Deserialize, Serialize};

/// A dataset channel, with its names and its default unit in files.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub struct ChannelRule {
    pub name: String,
    /// Unit in the dataset; empty if unknown.
    #[serde(default)]
    pub unit: String,
    /// Further names in files; a leading minus marks the opposite sign.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub aliases: Vec<String>,
    /// Unit in files that give none; `None` if unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit_in_files: Option<String>,
}

impl ChannelRule {
    /// Creates a channel with an unknown unit and without aliases.
    pub fn named(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..Self::default()
        }
    }
}
