//! A model's role in its condition: nominal, perturbed or identified.

use serde::{Deserialize, Serialize};

/// A model's role in its condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RowRole {
    /// The physics model at the condition's trim.
    Nominal,
    /// A physics model at a perturbed trim.
    Perturbed,
    /// A model identified from flight tests, or a measured response.
    Identified,
}

impl RowRole {
    pub const ALL: [Self; 3] = [Self::Nominal, Self::Perturbed, Self::Identified];

    /// Returns the role's keyword in files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Perturbed => "perturbed",
            Self::Identified => "identified",
        }
    }

    /// Parses a role keyword; `None` for an unknown word.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.word() == word)
    }
}
