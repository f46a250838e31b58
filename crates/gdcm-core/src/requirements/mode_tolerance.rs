//! How far the modes of a model may be from those flown: a table in the engineer's hands (M17.3).

use serde::{Deserialize, Serialize};

use super::{ModeName, ModeValues};
use crate::message_text::quoted;
use crate::units::number;

/// One row of the table: the period, and of amplitude and damping one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModeTolerance {
    /// What the source calls it ("long term").
    pub response: String,
    /// The modes that it is of.
    pub modes: Vec<ModeName>,
    /// Part of the flown period.
    pub period: f64,
    /// The same in seconds, the wider of the two; none where only the part holds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
    /// Part of the flown time to half or double amplitude.
    pub amplitude_time: f64,
    /// Difference of the damping ratio.
    pub damping_ratio: f64,
    /// Entry of the source ("2.c.3.a").
    #[serde(default)]
    pub entry: String,
}

/// The table of tolerances of modes; each row is checked as it is read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<ModeTolerance>", into = "Vec<ModeTolerance>")]
pub struct ModeToleranceTable(Vec<ModeTolerance>);

/// A tolerance that is not above zero.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("tolerance of modes {row}, {}: expected {name} above zero, found {}", quoted(response), number(*found))]
pub struct ModeToleranceError {
    /// Which row, counted from 1.
    pub row: usize,
    /// What it is of.
    pub response: String,
    /// `period`, `period_s`, `amplitude_time` or `damping_ratio`.
    pub name: &'static str,
    /// What stands there.
    pub found: f64,
}

impl ModeTolerance {
    /// The tolerance of the period \[s\] about a flown one.
    pub fn of_period_s(&self, period_s: f64) -> f64 {
        (self.period * period_s).max(self.period_s.unwrap_or(0.0))
    }

    /// Whether `model` is within the tolerance about `flown`: period, and time to half or double amplitude or damping ratio.
    pub fn holds(&self, flown: &ModeValues, model: &ModeValues) -> bool {
        let differs = |of: fn(&ModeValues) -> Option<f64>| Some(((of(model)? - of(flown)?).abs(), of(flown)?.abs()));
        let period = differs(|values| values.period_s).is_some_and(|(by, of)| by <= self.of_period_s(of));
        let amplitude = differs(|values| values.time_to_half_s).is_some_and(|(by, of)| by <= self.amplitude_time * of);
        let damping = differs(|values| values.damping_ratio).is_some_and(|(by, _)| by <= self.damping_ratio);
        period && (amplitude || damping)
    }

    /// Whether the flown mode is known to within the tolerance itself.
    pub fn is_known(&self, flown: &ModeValues, deviation: &ModeValues) -> bool {
        let within = |of: fn(&ModeValues) -> Option<f64>, most: f64| of(deviation).is_some_and(|sd| sd <= most);
        let period_s = flown.period_s.map_or(0.0, |period_s| self.of_period_s(period_s));
        let amplitude_s = flown.time_to_half_s.map_or(0.0, |time_s| self.amplitude_time * time_s.abs());
        let amplitude = within(|values| values.time_to_half_s, amplitude_s);
        within(|values| values.period_s, period_s)
            && (amplitude || within(|values| values.damping_ratio, self.damping_ratio))
    }

    fn check(&self, row: usize) -> Result<(), ModeToleranceError> {
        let values = [
            ("period", Some(self.period)),
            ("period_s", self.period_s),
            ("amplitude_time", Some(self.amplitude_time)),
            ("damping_ratio", Some(self.damping_ratio)),
        ];
        let wrong = values.into_iter().find_map(|(name, value)| {
            value.filter(|value| !value.is_finite() || *value <= 0.0).map(|found| (name, found))
        });
        wrong.map_or(Ok(()), |(name, found)| {
            Err(ModeToleranceError { row, response: self.response.clone(), name, found })
        })
    }
}

impl ModeToleranceTable {
    /// Its rows.
    pub fn rows(&self) -> &[ModeTolerance] {
        &self.0
    }

    /// The row of a mode, where it has one.
    pub fn of(&self, mode: ModeName) -> Option<&ModeTolerance> {
        self.0.iter().find(|row| row.modes.contains(&mode))
    }
}

impl TryFrom<Vec<ModeTolerance>> for ModeToleranceTable {
    type Error = ModeToleranceError;

    fn try_from(rows: Vec<ModeTolerance>) -> Result<Self, ModeToleranceError> {
        rows.iter().enumerate().try_for_each(|(index, row)| row.check(index + 1))?;
        Ok(Self(rows))
    }
}

impl From<ModeToleranceTable> for Vec<ModeTolerance> {
    fn from(table: ModeToleranceTable) -> Self {
        table.0
    }
}

impl Default for ModeToleranceTable {
    /// 14 CFR part 60, appendix C, table C2A, 2.c.3.a (long-term response) and 2.d.3.a (lateral-directional oscillations).
    fn default() -> Self {
        let row = |response: &str, mode, period_s, entry: &str| ModeTolerance {
            response: response.to_owned(),
            modes: vec![mode],
            period: 0.1,
            period_s,
            amplitude_time: 0.1,
            damping_ratio: 0.02,
            entry: entry.to_owned(),
        };
        Self(vec![
            row("long term", ModeName::Phugoid, None, "2.c.3.a"),
            row("lateral-directional oscillation", ModeName::DutchRoll, Some(0.5), "2.d.3.a"),
        ])
    }
}
