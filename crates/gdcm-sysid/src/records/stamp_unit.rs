//! Determines the unit of a record's stamps: from the file, the column's name, or the step size.

use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit};

use super::layout_note::TimeUnitReason;
use super::record_table::RecordColumn;
use super::sample_step::{LONGEST_STEP_S, median_step};

/// Shortest plausible time between two samples in a flight recorder \[s\].
const SHORTEST_STEP_S: f64 = 5e-5;
/// Shortest step accepted for a guessed unit \[s\].
const SHORTEST_GUESSED_STEP_S: f64 = 2e-4;
const SECONDS_A_DAY: f64 = 86_400.0;

/// A stamp column's unit.
pub(super) struct StampUnit {
    pub(super) name: &'static str,
    /// Seconds per unit.
    pub(super) seconds: f64,
    pub(super) reason: TimeUnitReason,
}

impl StampUnit {
    /// Units shorter than a second, tried in this order until the median step is plausible.
    const SHORT: [(&str, f64); 3] = [("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)];

    /// Determines the unit: the one in the file, else the last word in the column's name
    /// (`time_ms`), else seconds, unless the median step is implausible in seconds and plausible in
    /// another unit.
    pub(super) fn new(stamps: &RecordColumn) -> Self {
        if let Some(unit) = stamps.unit.as_deref().and_then(Self::from_name) {
            return unit;
        }
        if let Some(unit) = last_word(&stamps.name).and_then(Self::from_name) {
            return unit;
        }
        let step = median_step(&stamps.values).unwrap_or(f64::NAN);
        if step > LONGEST_STEP_S {
            for (name, seconds) in Self::SHORT {
                if is_plausible_step(step * seconds) {
                    return Self::from_steps(name, seconds, step);
                }
            }
            return Self::seconds(TimeUnitReason::NoPlausibleUnit);
        }
        if step > 0.0 && step < SHORTEST_STEP_S && is_plausible_step(step * SECONDS_A_DAY) {
            return Self::from_steps("days", SECONDS_A_DAY, step);
        }
        Self::seconds(TimeUnitReason::NotStated)
    }

    /// Returns the time unit with this name, in its usual spelling; `None` if the name is not a
    /// time unit.
    fn from_name(name: &str) -> Option<Self> {
        let unit = PhysicalUnit::parse(name)?;
        if unit.dimension != Dimension::Time {
            return None;
        }
        Some(Self {
            name: unit.name,
            seconds: unit.size,
            reason: TimeUnitReason::Given,
        })
    }

    /// Returns a unit that was chosen because the median step `step`, taken in seconds, is
    /// implausible: over [`LONGEST_STEP_S`] or below [`SHORTEST_STEP_S`].
    fn from_steps(name: &'static str, seconds: f64, step: f64) -> Self {
        Self {
            name,
            seconds,
            reason: TimeUnitReason::Steps { step },
        }
    }

    fn seconds(reason: TimeUnitReason) -> Self {
        Self {
            name: "s",
            seconds: 1.0,
            reason,
        }
    }
}

/// Returns a name's last word; `None` if the name is a single word.
fn last_word(name: &str) -> Option<&str> {
    name.rsplit(|c: char| !c.is_alphanumeric())
        .next()
        .filter(|word| *word != name)
}

fn is_plausible_step(step_s: f64) -> bool {
    (SHORTEST_GUESSED_STEP_S..=LONGEST_STEP_S).contains(&step_s)
}
