//! The correction scheduled with airspeed (M11).

use crate::correction::ChannelCorrection;

use super::regression::{Airspeeds, Regression};

/// Highest degree of a polynomial schedule (M11).
pub const HIGHEST_DEGREE: usize = 3;

/// The form of the schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScheduleKind {
    /// A polynomial of least squares.
    Polynomial {
        /// Degree, 0 to [`HIGHEST_DEGREE`].
        degree: usize,
    },
    /// A lookup table: the mean at each distinct airspeed, linear between.
    Table,
}

/// What is regressed on airspeed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScheduledQuantity {
    /// `ln k`: the product of two channels' regressions is the regression of their product.
    LnGain,
    /// `k` itself.
    Gain,
}

/// How channel gains are scheduled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ScheduleSettings {
    /// The form.
    pub kind: ScheduleKind,
    /// What is regressed.
    pub quantity: ScheduledQuantity,
    /// Whether delays are scheduled too.
    pub delays: bool,
}

impl Default for ScheduleSettings {
    fn default() -> Self {
        Self { kind: ScheduleKind::Polynomial { degree: 2 }, quantity: ScheduledQuantity::LnGain, delays: false }
    }
}

/// One condition's optimum, as the schedule takes it.
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduledPoint<'a> {
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// The condition's own correction.
    pub correction: &'a ChannelCorrection,
}

/// Every channel's gain (and delay, where asked for) as a function of airspeed.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// How it was made.
    pub settings: ScheduleSettings,
    /// The airspeeds it was made from.
    pub airspeeds: Airspeeds,
    /// Regression of each input's gain, or of its logarithm.
    pub inputs: Vec<Regression>,
    /// Regression of each output's gain, or of its logarithm.
    pub outputs: Vec<Regression>,
    /// Regression of each input's and each output's delay \[s\], where delays are scheduled.
    pub delays: Option<(Vec<Regression>, Vec<Regression>)>,
}

/// Why there is no schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScheduleError {
    /// No condition was chosen, or none could be solved.
    #[error("no schedule: no condition that could be solved is chosen for it")]
    NoCondition,
}

impl Schedule {
    /// The schedule of these conditions' corrections.
    pub fn of(points: &[ScheduledPoint<'_>], settings: ScheduleSettings) -> Result<Self, ScheduleError> {
        let airspeeds = Airspeeds::new(points.iter().map(|point| point.airspeed_kt).collect());
        let airspeeds = airspeeds.ok_or(ScheduleError::NoCondition)?;
        let fit = |figures: &[f64]| match settings.kind {
            ScheduleKind::Polynomial { degree } => Regression::polynomial(&airspeeds, figures, degree),
            ScheduleKind::Table => Regression::table(&airspeeds, figures),
        };
        let quantity = |gain: f64| match settings.quantity {
            ScheduledQuantity::LnGain => gain.ln(),
            ScheduledQuantity::Gain => gain,
        };
        let fit_channels = |of: fn(&ChannelCorrection) -> &[f64], transform: &dyn Fn(f64) -> f64| -> Vec<Regression> {
            (0..of(points[0].correction).len())
                .map(|channel| {
                    let figures: Vec<f64> =
                        points.iter().map(|point| transform(of(point.correction)[channel])).collect();
                    fit(&figures)
                })
                .collect()
        };
        let inputs = fit_channels(|correction| &correction.input_gains, &quantity);
        let outputs = fit_channels(|correction| &correction.output_gains, &quantity);
        let delays = settings.delays.then(|| {
            let same = |delay: f64| delay;
            let inputs = fit_channels(|correction| &correction.input_delays_s, &same);
            (inputs, fit_channels(|correction| &correction.output_delays_s, &same))
        });
        Ok(Self { settings, airspeeds, inputs, outputs, delays })
    }

    /// The scheduled correction at an airspeed \[kt\]; outside the conditions' range the end value holds.
    ///
    /// A scheduled delay below zero, which a polynomial can give between its points, counts as zero.
    pub fn at(&self, airspeed_kt: f64) -> ChannelCorrection {
        let gain = |regression: &Regression| {
            let value = regression.at(&self.airspeeds, airspeed_kt);
            match self.settings.quantity {
                ScheduledQuantity::LnGain => value.exp(),
                ScheduledQuantity::Gain => value,
            }
        };
        let delay = |regression: &Regression| regression.at(&self.airspeeds, airspeed_kt).max(0.0);
        let (input_delays_s, output_delays_s) = match &self.delays {
            Some((inputs, outputs)) => (inputs.iter().map(delay).collect(), outputs.iter().map(delay).collect()),
            None => (vec![0.0; self.inputs.len()], vec![0.0; self.outputs.len()]),
        };
        ChannelCorrection {
            input_gains: self.inputs.iter().map(gain).collect(),
            output_gains: self.outputs.iter().map(gain).collect(),
            input_delays_s,
            output_delays_s,
        }
    }

    /// Whether a gain is not positive somewhere in the range, which only a regression of `k` itself can give.
    pub fn has_non_positive_gain(&self) -> bool {
        const STEPS: u32 = 200;
        let span = self.airspeeds.max_kt - self.airspeeds.min_kt;
        (0..=STEPS).any(|step| {
            let correction = self.at(self.airspeeds.min_kt + span * f64::from(step) / f64::from(STEPS));
            correction.input_gains.iter().chain(&correction.output_gains).any(|gain| *gain <= 0.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Pair;

    fn correction(gain: f64) -> ChannelCorrection {
        ChannelCorrection {
            input_gains: vec![gain],
            output_gains: vec![gain * gain],
            input_delays_s: vec![0.01],
            output_delays_s: vec![0.0],
        }
    }

    #[test]
    fn regressing_the_logarithm_makes_the_product_the_regression_of_the_product() {
        let corrections: Vec<_> = [0.8, 1.1, 0.9, 1.3].into_iter().map(correction).collect();
        let airspeeds = [40.0, 70.0, 100.0, 140.0];
        let points: Vec<_> = corrections
            .iter()
            .zip(airspeeds)
            .map(|(correction, airspeed_kt)| ScheduledPoint { airspeed_kt, correction })
            .collect();
        let schedule = Schedule::of(&points, ScheduleSettings::default()).unwrap();
        let products: Vec<f64> = corrections.iter().map(|c| c.net_gain(Pair::new(0, 0)).value().ln()).collect();
        let direct = Regression::polynomial(&schedule.airspeeds, &products, 2);
        for airspeed in [40.0, 88.0, 140.0] {
            let product = schedule.at(airspeed).net_gain(Pair::new(0, 0)).value();
            // Linear least squares in different order of rounding.
            assert!((product / direct.at(&schedule.airspeeds, airspeed).exp() - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn without_a_condition_there_is_no_schedule() {
        assert_eq!(Schedule::of(&[], ScheduleSettings::default()), Err(ScheduleError::NoCondition));
    }

    #[test]
    fn delays_are_scheduled_only_where_asked_for() {
        let own = correction(1.0);
        let points = [ScheduledPoint { airspeed_kt: 60.0, correction: &own }];
        assert_eq!(Schedule::of(&points, ScheduleSettings::default()).unwrap().at(60.0).input_delays_s, [0.0]);
        let settings = ScheduleSettings { delays: true, ..ScheduleSettings::default() };
        assert_eq!(Schedule::of(&points, settings).unwrap().at(60.0).input_delays_s, [0.01]);
    }
}
