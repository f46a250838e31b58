//! Choice whether a schedule includes delays (M11).

use std::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// Net delay \[s\] in a constrained response above which delays are scheduled automatically (M11).
pub const NOTABLE_DELAY_S: f64 = 5e-4;

/// Choice whether the schedule includes delays besides gains (M11).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DelayScheduling {
    /// Delays are scheduled if a constrained response has a net delay above [`NOTABLE_DELAY_S`] in
    /// a scheduled condition.
    #[default]
    Automatic,
    Always,
    Never,
}

impl From<bool> for DelayScheduling {
    /// Converts the flag that older program versions wrote.
    fn from(flag: bool) -> Self {
        if flag { Self::Always } else { Self::Never }
    }
}

impl<'de> Deserialize<'de> for DelayScheduling {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(DelaySchedulingVisitor)
    }
}

/// Reads a word, or the flag that older program versions wrote.
struct DelaySchedulingVisitor;

impl Visitor<'_> for DelaySchedulingVisitor {
    type Value = DelayScheduling;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("\"automatic\", \"always\" or \"never\"")
    }

    fn visit_bool<E: Error>(self, flag: bool) -> Result<DelayScheduling, E> {
        Ok(flag.into())
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<DelayScheduling, E> {
        match word {
            "automatic" => Ok(DelayScheduling::Automatic),
            "always" => Ok(DelayScheduling::Always),
            "never" => Ok(DelayScheduling::Never),
            _ => Err(E::unknown_variant(word, &["automatic", "always", "never"])),
        }
    }
}
