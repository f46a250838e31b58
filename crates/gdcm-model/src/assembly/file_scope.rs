//! Scope of a declaration: all models, the models with a role, or the models in certain files.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::found_model::FoundModel;
use super::path_pattern::matches_path;
use crate::names::RowRole;

/// Models to which a declaration applies, as written in rules and on the command line.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(from = "String", into = "String")]
pub enum FileScope {
    /// `all`: every model.
    All,
    /// `physics`: nominal and perturbed models.
    Physics,
    /// `identified`: identified models and measured responses.
    Identified,
    /// One file, one model in a file (`file#variable`), or a pattern: `flight_*`, `c03/*`.
    Files(String),
}

impl From<String> for FileScope {
    fn from(text: String) -> Self {
        match text.as_str() {
            "all" => Self::All,
            "physics" => Self::Physics,
            "identified" => Self::Identified,
            _ => Self::Files(text),
        }
    }
}

impl From<FileScope> for String {
    fn from(scope: FileScope) -> Self {
        scope.to_string()
    }
}

impl fmt::Display for FileScope {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::All => "all",
            Self::Physics => "physics",
            Self::Identified => "identified",
            Self::Files(pattern) => pattern,
        })
    }
}

impl FileScope {
    /// Returns the scope that includes all models with a role.
    pub fn of_role(role: RowRole) -> Self {
        match role {
            RowRole::Nominal | RowRole::Perturbed => Self::Physics,
            RowRole::Identified => Self::Identified,
        }
    }

    /// Returns the precedence, from 0 for all models to 3 for a single file or model; a scope with
    /// a higher precedence overrides one with a lower.
    pub(super) fn rank(&self, found: &FoundModel) -> u8 {
        match self {
            Self::All => 0,
            Self::Physics | Self::Identified => 1,
            Self::Files(pattern) if *pattern == found.key() || *pattern == found.file() => 3,
            Self::Files(_) => 2,
        }
    }

    /// Returns whether the scope includes a model; `role` is `None` if the model has no role yet.
    pub fn holds(&self, found: &FoundModel, role: Option<RowRole>) -> bool {
        match self {
            Self::All => true,
            Self::Physics | Self::Identified => role.map(Self::of_role).as_ref() == Some(self),
            Self::Files(pattern) => *pattern == found.key() || matches_path(pattern, found.file()),
        }
    }
}
