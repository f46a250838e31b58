//! A variable besides airspeed, and its contribution to a schedule (M11 with one more column,
//! M13.7).

use std::fmt;

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use gdcm_model::dataset::condition::FlightState;

use super::ScheduleError;
use crate::correction::Channels;

/// Relative residual of a column after projection on the others below which it counts as their
/// linear combination.
const DEPENDENT: f64 = 1e-9;

/// A variable besides airspeed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SecondVariable {
    /// Altitude \[ft\].
    Altitude,
    /// Mass \[kg\].
    Mass,
}

impl SecondVariable {
    /// Both, in the order of presentation.
    pub const BOTH: [Self; 2] = [Self::Altitude, Self::Mass];

    /// "altitude", "mass".
    pub fn name(self) -> &'static str {
        match self {
            Self::Altitude => "altitude",
            Self::Mass => "mass",
        }
    }

    /// "ft", "kg".
    pub fn unit(self) -> &'static str {
        match self {
            Self::Altitude => "ft",
            Self::Mass => "kg",
        }
    }

    /// Value in a condition: altitude \[ft\] or mass \[kg\].
    pub fn value(self, state: &FlightState) -> Option<f64> {
        match self {
            Self::Altitude => state.altitude_ft,
            Self::Mass => state.mass_kg,
        }
    }

    fn label(self, state: &FlightState) -> Option<&str> {
        match self {
            Self::Altitude => state.altitude.as_deref(),
            Self::Mass => state.weight.as_deref(),
        }
    }

    /// One number for each condition: the values, or -1 and 1 for two different labels; `None`
    /// where the conditions have neither.
    pub fn values(self, states: &[&FlightState]) -> Option<Vec<f64>> {
        let numbers: Option<Vec<f64>> = states.iter().map(|state| self.value(state)).collect();
        numbers.or_else(|| {
            let labels: Vec<&str> = states
                .iter()
                .map(|state| self.label(state))
                .collect::<Option<_>>()?;
            let mut distinct = labels.clone();
            distinct.sort_unstable();
            distinct.dedup();
            let number = |label: &&str| if *label == distinct[0] { -1.0 } else { 1.0 };
            (distinct.len() == 2).then(|| labels.iter().map(number).collect())
        })
    }
}

impl fmt::Display for SecondVariable {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// Contribution of a second variable `z`, scaled to -1 to 1 over its range, to the value of each
/// channel: `gamma z`.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondTerm {
    pub variable: SecondVariable,
    /// Least and greatest value over the conditions.
    pub range: [f64; 2],
    /// Scaled value of each condition.
    pub scaled: Vec<f64>,
    /// `gamma` for each channel's gain, or for its logarithm.
    pub slopes: Channels<f64>,
}

impl SecondTerm {
    /// Fits the term to these values, one for each condition, besides the columns of airspeed:
    /// least squares coefficients of the values of each channel.
    ///
    /// # Errors
    /// [`ScheduleError::NotToldApart`] where the values are a linear combination of those columns.
    pub(super) fn of(
        variable: SecondVariable,
        values: Vec<f64>,
        rows: &[Vec<f64>],
        figures: &Channels<Vec<f64>>,
    ) -> Result<Self, ScheduleError> {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let scaled: Vec<f64> = values
            .iter()
            .map(|value| scaled(*value, [least, greatest]))
            .collect();
        let columns = rows.first().map_or(0, Vec::len);
        let q = DMatrix::from_fn(rows.len(), columns, |row, column| rows[row][column])
            .qr()
            .q();
        let whole = DVector::from_column_slice(&scaled);
        // Residual of the scaled values after projection on the columns of airspeed.
        let beside = &whole - &q * (q.transpose() * &whole);
        if greatest <= least || beside.norm() <= DEPENDENT * whole.norm() {
            return Err(ScheduleError::NotToldApart(variable));
        }
        let square = beside.norm_squared();
        let slopes =
            figures.map(|_, figures| beside.dot(&DVector::from_column_slice(figures)) / square);
        Ok(Self {
            variable,
            range: [least, greatest],
            scaled,
            slopes,
        })
    }

    /// Scales a value of the variable to -1 to 1; beyond the conditions' range the end applies.
    pub fn scale(&self, value: f64) -> f64 {
        scaled(value.clamp(self.range[0], self.range[1]), self.range)
    }

    /// Middle of the range of the conditions' values.
    pub fn middle(&self) -> f64 {
        0.5 * (self.range[0] + self.range[1])
    }

    /// Half of the range of the conditions' values.
    pub fn half_range(&self) -> f64 {
        0.5 * (self.range[1] - self.range[0])
    }
}

fn scaled(value: f64, [least, greatest]: [f64; 2]) -> f64 {
    (2.0 * value - least - greatest) / (greatest - least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correction::ChannelCorrection;
    use crate::schedule::{Schedule, ScheduleKind, ScheduleSettings, ScheduledPoint};

    fn corrections(gains: &[f64]) -> Vec<ChannelCorrection> {
        let of = |gain: &f64| ChannelCorrection {
            input_gains: vec![*gain],
            output_gains: vec![1.0],
            input_delays_s: vec![0.0],
            output_delays_s: vec![0.0],
            leads: None,
        };
        gains.iter().map(of).collect()
    }

    /// The schedule with altitude of conditions at these airspeeds \[kt\] and altitudes \[ft\].
    fn schedule(
        kind: ScheduleKind,
        flown: &[(f64, Option<f64>)],
        gain: impl Fn(f64, f64) -> f64,
    ) -> Result<Schedule, ScheduleError> {
        let gains: Vec<f64> = flown
            .iter()
            .map(|(kt, feet)| gain(*kt, feet.unwrap_or_default()))
            .collect();
        let corrections = corrections(&gains);
        let points = flown
            .iter()
            .zip(&corrections)
            .map(|(&(airspeed_kt, second), correction)| ScheduledPoint {
                airspeed_kt,
                correction,
                delay_upper_s: 0.0,
                second,
            });
        let settings = ScheduleSettings {
            kind,
            second: Some(SecondVariable::Altitude),
            ..ScheduleSettings::default()
        };
        Schedule::of(&points.collect::<Vec<_>>(), settings)
    }

    const FLOWN: [(f64, Option<f64>); 5] = [
        (60.0, Some(2e3)),
        (60.0, Some(8e3)),
        (90.0, Some(2e3)),
        (120.0, Some(8e3)),
        (120.0, Some(2e3)),
    ];

    #[test]
    fn the_effects_of_airspeed_and_altitude_are_found_apart() {
        let gain = |kt: f64, feet: f64| (0.002 * kt - 2e-5 * feet).exp();
        for kind in [ScheduleKind::Polynomial { degree: 1 }, ScheduleKind::Table] {
            let schedule = schedule(kind, &FLOWN, gain).unwrap();
            for (kt, feet) in [(60.0, 8e3), (75.0, 5e3), (120.0, 2e3)] {
                let found = schedule.evaluate(kt, Some(feet)).input_gains[0];
                // Least squares with a condition number of about 5.
                assert!(
                    (found / gain(kt, feet) - 1.0).abs() < 1e-13,
                    "{kind:?} at {kt} kt, {feet} ft: {found}"
                );
            }
            let beyond = schedule.evaluate(90.0, Some(20e3)).input_gains[0];
            assert!(
                (beyond / gain(90.0, 8e3) - 1.0).abs() < 1e-13,
                "the end value holds"
            );
            assert_eq!(
                schedule.at(90.0),
                schedule.evaluate(90.0, Some(5e3)),
                "the middle, where nothing is said"
            );
        }
    }

    #[test]
    fn conditions_that_cannot_tell_two_variables_apart_are_refused() {
        let climbing: Vec<_> = [60.0, 90.0, 120.0]
            .map(|kt| (kt, Some(100.0 * kt)))
            .to_vec();
        let refusal = schedule(ScheduleKind::Polynomial { degree: 1 }, &climbing, |_, _| {
            1.0
        })
        .unwrap_err();
        assert_eq!(
            refusal,
            ScheduleError::NotToldApart(SecondVariable::Altitude)
        );
        let level: Vec<_> = FLOWN.map(|(kt, _)| (kt, Some(2e3))).to_vec();
        let refusal = schedule(ScheduleKind::Table, &level, |_, _| 1.0).unwrap_err();
        assert_eq!(
            refusal,
            ScheduleError::NotToldApart(SecondVariable::Altitude)
        );
        let silent: Vec<_> = FLOWN
            .map(|(kt, feet)| (kt, feet.filter(|_| kt > 60.0)))
            .to_vec();
        let refusal = schedule(ScheduleKind::Table, &silent, |_, _| 1.0).unwrap_err();
        assert_eq!(
            refusal,
            ScheduleError::NoSecondValue(SecondVariable::Altitude)
        );
    }
}
