//! A second variable's contribution to a schedule (M11 with another column, M13.7).
//!
//! ```text
//! y(V, z) = f(V) + gamma z,   gamma = z_r' y / z_r' z_r,   z_r = z - Q Q' z
//! ```
//!
//! `y` is a channel's regressed value, `z` the variable scaled to -1 to 1 over the conditions, `f`
//! the function of airspeed, and `Q` an orthonormal basis for its design columns. By the
//! Frisch-Waugh-Lovell theorem this `gamma` is the coefficient of `z` in the common least-squares
//! fit.

use nalgebra::{DMatrix, DVector};

use super::error::ScheduleError;
use super::second_variable::SecondVariable;
use crate::correction::Channels;

/// A column counts as linearly dependent if its residual after projection on the others is below
/// this, relative to its norm.
const DEPENDENT: f64 = 1e-9;

/// A second variable's contribution `gamma z` to each channel's value; `z` is the variable scaled
/// to -1 to 1 over its range.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondTerm {
    pub variable: SecondVariable,
    /// Minimum and maximum value over the conditions.
    pub range: [f64; 2],
    /// `z` by condition.
    pub scaled: Vec<f64>,
    /// `gamma` for each channel's gain, or for its logarithm.
    pub slopes: Channels<f64>,
}

impl SecondTerm {
    /// Fits `gamma` by least squares.
    ///
    /// `values` has each condition's second variable, `airspeed_design` the other design columns (a
    /// row for each condition), `regressed` the values by channel and condition.
    ///
    /// # Errors
    /// [`ScheduleError::NotToldApart`] if the second variable depends linearly on those columns.
    pub(super) fn fit(
        variable: SecondVariable,
        values: Vec<f64>,
        airspeed_design: &[Vec<f64>],
        regressed: &Channels<Vec<f64>>,
    ) -> Result<Self, ScheduleError> {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let scaled: Vec<f64> = values
            .iter()
            .map(|value| scale_to_unit(*value, [least, greatest]))
            .collect();
        let rows = airspeed_design.len();
        let columns = airspeed_design.first().map_or(0, Vec::len);
        let q = DMatrix::from_fn(rows, columns, |row, column| airspeed_design[row][column])
            .qr()
            .q();
        let z = DVector::from_column_slice(&scaled);
        // `z_r`.
        let residual = &z - &q * (q.transpose() * &z);
        // Without a range `z` is NaN, which the first comparison covers.
        if greatest <= least || residual.norm() <= DEPENDENT * z.norm() {
            return Err(ScheduleError::NotToldApart(variable));
        }
        let square = residual.norm_squared();
        let slopes =
            regressed.map(|_, values| residual.dot(&DVector::from_column_slice(values)) / square);
        Ok(Self {
            variable,
            range: [least, greatest],
            scaled,
            slopes,
        })
    }

    /// Scales a value to -1 to 1; beyond the conditions' range the scaled value is -1 or 1.
    pub fn scale(&self, value: f64) -> f64 {
        scale_to_unit(value.clamp(self.range[0], self.range[1]), self.range)
    }

    /// Returns the middle of the conditions' range.
    pub fn middle(&self) -> f64 {
        0.5 * (self.range[0] + self.range[1])
    }

    /// Returns half the width of the conditions' range.
    pub fn half_range(&self) -> f64 {
        0.5 * (self.range[1] - self.range[0])
    }
}

/// Maps `value` linearly, so that the range becomes -1 to 1.
fn scale_to_unit(value: f64, [least, greatest]: [f64; 2]) -> f64 {
    (2.0 * value - least - greatest) / (greatest - least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correction::ChannelCorrection;
    use crate::schedule::test_points::correction;
    use crate::schedule::{Schedule, ScheduleKind, ScheduleSettings, ScheduledPoint};

    /// An airspeed \[kt\] and an altitude \[ft\].
    type Flown = (f64, Option<f64>);

    /// The schedule over airspeed and altitude for conditions with these gains.
    fn schedule(
        kind: ScheduleKind,
        flown: &[Flown],
        gain: impl Fn(f64, f64) -> f64,
    ) -> Result<Schedule, ScheduleError> {
        let corrections: Vec<ChannelCorrection> = flown
            .iter()
            .map(|(kt, feet)| correction(gain(*kt, feet.unwrap_or_default()), 1.0))
            .collect();
        let mut points = Vec::new();
        for (&(airspeed_kt, second), correction) in flown.iter().zip(&corrections) {
            points.push(ScheduledPoint {
                airspeed_kt,
                correction,
                delay_upper_s: 0.0,
                second,
            });
        }
        let settings = ScheduleSettings {
            kind,
            second: Some(SecondVariable::Altitude),
            ..ScheduleSettings::default()
        };
        Schedule::fit(&points, settings)
    }

    fn exponential(kt: f64, feet: f64) -> f64 {
        (0.002 * kt - 2e-5 * feet).exp()
    }

    const FLOWN: [Flown; 5] = [
        (60.0, Some(2e3)),
        (60.0, Some(8e3)),
        (90.0, Some(2e3)),
        (120.0, Some(8e3)),
        (120.0, Some(2e3)),
    ];

    #[test]
    fn the_effects_of_airspeed_and_altitude_are_separated() {
        for kind in [ScheduleKind::Polynomial { degree: 1 }, ScheduleKind::Table] {
            let schedule = schedule(kind, &FLOWN, exponential).unwrap();
            for (kt, feet) in [(60.0, 8e3), (75.0, 5e3), (120.0, 2e3)] {
                let found = schedule.evaluate(kt, Some(feet)).input_gains[0];
                // Least squares with a condition number of about 5.
                assert!(
                    (found / exponential(kt, feet) - 1.0).abs() < 1e-13,
                    "{kind:?} at {kt} kt, {feet} ft: {found}"
                );
            }
            let beyond = schedule.evaluate(90.0, Some(20e3)).input_gains[0];
            assert!(
                (beyond / exponential(90.0, 8e3) - 1.0).abs() < 1e-13,
                "the end value applies"
            );
            assert_eq!(
                schedule.at(90.0),
                schedule.evaluate(90.0, Some(5e3)),
                "the middle of the range without a value"
            );
        }
    }

    #[test]
    fn conditions_that_do_not_separate_two_variables_are_refused() {
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
        let mut incomplete = FLOWN;
        incomplete[0].1 = None;
        let refusal = schedule(ScheduleKind::Table, &incomplete, |_, _| 1.0).unwrap_err();
        assert_eq!(
            refusal,
            ScheduleError::NoSecondValue(SecondVariable::Altitude)
        );
    }
}
