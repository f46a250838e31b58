//! User-defined tolerances on modes (M17.3): how far a model's mode may be from the *flown* mode,
//! the mode of the model identified from flight.
//!
//! The default table follows 14 CFR part 60, appendix C, table C2A, 2.c.3.a and 2.d.3.a.

use serde::{Deserialize, Serialize};

use gdcm_model::message_text::quoted;
use gdcm_model::units::number;

use super::mode_name::ModeName;
use super::mode_values::ModeValues;
use super::positive_number::{NamedLimit, WrongLimit, first_not_positive};

/// A row: a tolerance on the period, and alternative tolerances on amplitude and damping.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModeTolerance {
    /// Name in the source ("long term").
    pub response: String,
    /// Modes to which the row applies.
    pub modes: Vec<ModeName>,
    /// Tolerance on the period, relative to the flown period.
    pub period: f64,
    /// Absolute tolerance on the period \[s\], used if wider than the relative tolerance; `None` if
    /// only the latter applies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
    /// Tolerance on the time to half or double amplitude ([`ModeValues::time_to_half_s`]), relative
    /// to the flown time.
    pub amplitude_time: f64,
    /// Absolute tolerance on the damping ratio.
    pub damping_ratio: f64,
    /// Entry in the source ("2.c.3.a").
    #[serde(default)]
    pub entry: String,
}

/// The mode tolerances; each row is checked on reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<ModeTolerance>")]
pub struct ModeToleranceTable(Vec<ModeTolerance>);

/// A tolerance that is not finite, or not above zero.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("mode tolerance {row}, {}: expected {name} above zero, found {}", quoted(response), number(*found))]
pub struct ModeToleranceError {
    /// Row number, counted from 1.
    pub row: usize,
    pub response: String,
    /// `period`, `period_s`, `amplitude_time` or `damping_ratio`.
    pub name: &'static str,
    pub found: f64,
}

impl ModeTolerance {
    /// Returns the tolerance \[s\] around a flown period.
    pub fn period_tolerance_s(&self, period_s: f64) -> f64 {
        (self.period * period_s).max(self.period_s.unwrap_or(0.0))
    }

    /// Returns whether `model` is within the tolerance around `flown`: the period, and either the
    /// time to half or double amplitude or the damping ratio. A value that either mode lacks is
    /// outside.
    pub fn contains(&self, flown: &ModeValues, model: &ModeValues) -> bool {
        self.contains_period(flown.period_s, model.period_s)
            && (self.contains_time_to_half(flown.time_to_half_s, model.time_to_half_s)
                || self.contains_damping(flown.damping_ratio, model.damping_ratio))
    }

    fn contains_period(&self, flown_s: Option<f64>, model_s: Option<f64>) -> bool {
        match (flown_s, model_s) {
            (Some(flown_s), Some(model_s)) => {
                (model_s - flown_s).abs() <= self.period_tolerance_s(flown_s.abs())
            }
            _ => false,
        }
    }

    fn contains_time_to_half(&self, flown_s: Option<f64>, model_s: Option<f64>) -> bool {
        match (flown_s, model_s) {
            (Some(flown_s), Some(model_s)) => {
                (model_s - flown_s).abs() <= self.amplitude_time * flown_s.abs()
            }
            _ => false,
        }
    }

    fn contains_damping(&self, flown: Option<f64>, model: Option<f64>) -> bool {
        match (flown, model) {
            (Some(flown), Some(model)) => (model - flown).abs() <= self.damping_ratio,
            _ => false,
        }
    }

    /// Returns whether flight determines the mode to within the tolerance: the period's standard
    /// deviation is within its tolerance, and so is that of the time to half amplitude or the
    /// damping ratio. A value that the flown mode lacks is not determined.
    pub fn covers_deviation(&self, flown: &ModeValues, deviation: &ModeValues) -> bool {
        let period_tolerance_s = match flown.period_s {
            Some(period_s) => self.period_tolerance_s(period_s),
            None => 0.0,
        };
        let time_tolerance_s = match flown.time_to_half_s {
            Some(time_s) => self.amplitude_time * time_s.abs(),
            None => 0.0,
        };
        is_at_most(deviation.period_s, period_tolerance_s)
            && (is_at_most(deviation.time_to_half_s, time_tolerance_s)
                || is_at_most(deviation.damping_ratio, self.damping_ratio))
    }

    /// Checks the tolerances; `row` counts from 1.
    fn check(&self, row: usize) -> Result<(), ModeToleranceError> {
        let limits = [
            NamedLimit {
                name: "period",
                value: Some(self.period),
            },
            NamedLimit {
                name: "period_s",
                value: self.period_s,
            },
            NamedLimit {
                name: "amplitude_time",
                value: Some(self.amplitude_time),
            },
            NamedLimit {
                name: "damping_ratio",
                value: Some(self.damping_ratio),
            },
        ];
        match first_not_positive(&limits) {
            Some(WrongLimit { name, value: found }) => Err(ModeToleranceError {
                row,
                response: self.response.clone(),
                name,
                found,
            }),
            None => Ok(()),
        }
    }
}

fn is_at_most(deviation: Option<f64>, limit: f64) -> bool {
    deviation.is_some_and(|deviation| deviation <= limit)
}

impl ModeToleranceTable {
    /// Returns the rows in file order.
    pub fn rows(&self) -> &[ModeTolerance] {
        &self.0
    }

    /// Returns the row for a mode, if any.
    pub fn row_for(&self, mode: ModeName) -> Option<&ModeTolerance> {
        self.0.iter().find(|row| row.modes.contains(&mode))
    }
}

impl TryFrom<Vec<ModeTolerance>> for ModeToleranceTable {
    type Error = ModeToleranceError;

    fn try_from(rows: Vec<ModeTolerance>) -> Result<Self, ModeToleranceError> {
        for (index, row) in rows.iter().enumerate() {
            row.check(index + 1)?;
        }
        Ok(Self(rows))
    }
}

impl Default for ModeToleranceTable {
    /// Returns the tolerances from 14 CFR part 60, appendix C, table C2A, 2.c.3.a (long-term
    /// response) and 2.d.3.a (lateral-directional oscillations).
    fn default() -> Self {
        Self(vec![
            ModeTolerance {
                response: "long term".to_owned(),
                modes: vec![ModeName::Phugoid],
                period: 0.1,
                period_s: None,
                amplitude_time: 0.1,
                damping_ratio: 0.02,
                entry: "2.c.3.a".to_owned(),
            },
            ModeTolerance {
                response: "lateral-directional oscillation".to_owned(),
                modes: vec![ModeName::DutchRoll],
                period: 0.1,
                period_s: Some(0.5),
                amplitude_time: 0.1,
                damping_ratio: 0.02,
                entry: "2.d.3.a".to_owned(),
            },
        ])
    }
}
