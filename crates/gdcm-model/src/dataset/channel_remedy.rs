//! Correction to a channel in a single flight record.

use serde::{Deserialize, Serialize};

/// Correction to a channel in a record that is inconsistent with the other records (M14.16).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChannelRemedy {
    /// Extra logging delay \[s\] relative to the other records; the correction removes it.
    pub delay_s: f64,
    /// Factor on the channel's samples, in addition to the unit conversion.
    pub factor: f64,
}

impl ChannelRemedy {
    /// No correction: no delay, factor 1.
    pub const NONE: Self = Self {
        delay_s: 0.0,
        factor: 1.0,
    };

    /// Returns the correction that applies `self`, then `next`.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        Self {
            delay_s: self.delay_s + next.delay_s,
            factor: self.factor * next.factor,
        }
    }
}

impl Default for ChannelRemedy {
    fn default() -> Self {
        Self::NONE
    }
}
