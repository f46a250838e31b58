//! Every channel's gain (and delay, where requested) as a function of airspeed (M11, M13.7, M15.5):
//! fitted and evaluated.
//!
//! ```text
//! 1  cluster the conditions' airspeeds; v = (V - mean V) / (half the range of V)
//! 2  ln k (or k) by channel and condition
//! 3  contribution gamma z from the second variable, if any, subtracted from these values
//! 4  the remainder regressed on v: polynomial by least squares, or means by cluster
//! 5  the signed delays regressed if the corrections have leads; otherwise the delays, if requested
//! 6  checks between the conditions (interpolation_check)
//! ```
//!
//! A *cluster* holds conditions at nearly equal airspeeds, which count as one airspeed. `V` is the
//! airspeed, `k` a channel's gain, `z` the second variable scaled to -1 to 1, and `gamma` its
//! coefficient.

use gdcm_model::dataset::condition::FlightState;

use super::airspeeds::Airspeeds;
use super::caution::ScheduleCaution;
use super::delay_schedule::DelaySchedule;
use super::error::ScheduleError;
use super::lead_schedule::LeadSchedule;
use super::regression::{Regression, design, interpolation_weights, powers};
use super::scheduled_point::ScheduledPoint;
use super::second_term::SecondTerm;
use super::settings::{ScheduleKind, ScheduleSettings, ScheduledQuantity};
use crate::correction::{ChannelCorrection, Channels, LeadPrice};

/// Number of steps over the airspeed range, or between two clusters, at which a schedule is
/// inspected; fine enough to find the extremes of polynomials of degree 3.
pub(super) const STEPS: u32 = 100;

/// Every channel's gain (and delay, where requested) as a function of airspeed.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    pub settings: ScheduleSettings,
    pub airspeeds: Airspeeds,
    /// Each channel's gain, or its logarithm; with a second variable, at its mid-range value.
    pub gains: Channels<Regression>,
    /// The contribution of the second variable (altitude or mass) to each regression, if any.
    pub second: Option<SecondTerm>,
    /// Delays over airspeed; `None` if they are not scheduled.
    pub delays: Option<DelaySchedule>,
    /// Signed delays over airspeed; `None` unless the conditions' corrections have leads (M15).
    pub leads: Option<LeadSchedule>,
    pub cautions: Vec<ScheduleCaution>,
}

impl Schedule {
    /// Fits the schedule to the conditions' corrections and checks it between the conditions.
    ///
    /// # Errors
    /// [`ScheduleError`] without conditions, if a condition lacks the second variable, or if the
    /// second variable's effect cannot be separated from the airspeed's.
    pub fn fit(
        points: &[ScheduledPoint<'_>],
        settings: ScheduleSettings,
    ) -> Result<Self, ScheduleError> {
        let mut schedule = Self::fit_unchecked(points, settings)?;
        // Step 6
        schedule.cautions = schedule.find_cautions(points);
        Ok(schedule)
    }

    /// Fits the schedule, without cautions (steps 1 to 5).
    ///
    /// # Errors
    /// The same as for [`Schedule::fit`].
    pub(super) fn fit_unchecked(
        points: &[ScheduledPoint<'_>],
        settings: ScheduleSettings,
    ) -> Result<Self, ScheduleError> {
        // Step 1
        let Some(airspeeds) = Airspeeds::new(
            points.iter().map(|point| point.airspeed_kt).collect(),
            settings.airspeed_tolerance_kt,
        ) else {
            return Err(ScheduleError::NoCondition);
        };
        // Step 2
        let values = regressed_values(points, settings.quantity);
        // Steps 3 and 4
        let second_term = fit_second_term(points, &airspeeds, settings, &values)?;
        let gains = values.map(|channel, values| match &second_term {
            Some(SecondTerm { scaled, slopes, .. }) => {
                let remainder: Vec<f64> = values
                    .iter()
                    .zip(scaled)
                    .map(|(value, scaled)| value - slopes[channel] * scaled)
                    .collect();
                Regression::fit(&airspeeds, &remainder, settings.kind)
            }
            None => Regression::fit(&airspeeds, values, settings.kind),
        });
        // Step 5
        let leads = LeadSchedule::fit(points, &airspeeds, settings.tau_degree);
        let delays = if settings.delays && leads.is_none() {
            Some(DelaySchedule::fit(points, &airspeeds, settings.kind))
        } else {
            None
        };
        Ok(Self {
            settings,
            airspeeds,
            gains,
            second: second_term,
            delays,
            leads,
            cautions: Vec::new(),
        })
    }

    /// Returns whether delays or signed delays are scheduled.
    pub fn has_delays(&self) -> bool {
        self.delays.is_some() || self.leads.is_some()
    }

    /// Returns the gain that the scheduled lead filters add above the band: for each channel the
    /// maximum over the airspeeds. `None` for a schedule without lead filters.
    pub fn lead_price(&self) -> Option<LeadPrice> {
        let leads = self.leads.as_ref()?;
        let steps = if leads.degree() == 0 { 0 } else { STEPS };
        let mut highest: Option<LeadPrice> = None;
        for step in 0..=steps {
            let leads = leads.at(&self.airspeeds, self.step_kt(step));
            let Some(price) = LeadPrice::new(&leads) else {
                continue;
            };
            highest = Some(match highest {
                Some(highest) => highest.or_more(&price),
                None => price,
            });
        }
        highest
    }

    /// Returns the airspeed \[kt\] at an inspection step between the minimum and the maximum.
    pub(super) fn step_kt(&self, step: u32) -> f64 {
        let fraction = f64::from(step) / f64::from(STEPS);
        self.airspeeds.min_kt + fraction * (self.airspeeds.max_kt - self.airspeeds.min_kt)
    }

    /// Returns the polynomial degree, possibly less than requested; `None` for a table.
    pub fn degree(&self) -> Option<usize> {
        match self.settings.kind {
            ScheduleKind::Polynomial { degree } => Some(self.airspeeds.attainable_degree(degree)),
            ScheduleKind::Table => None,
        }
    }

    /// Evaluates the scheduled correction at an airspeed \[kt\]; outside the conditions' range the
    /// end value applies.
    ///
    /// Scheduled delays are limited to their bounds: from zero to the conditions' upper bounds,
    /// interpolated linearly; signed delays to the conditions' widest bounds. A second variable is
    /// set to its mid-range value.
    pub fn at(&self, airspeed_kt: f64) -> ChannelCorrection {
        self.evaluate(airspeed_kt, None)
    }

    /// Evaluates the scheduled correction at a condition's airspeed and second variable; if the
    /// condition does not give this variable, at its mid-range value.
    pub fn at_state(&self, state: &FlightState) -> ChannelCorrection {
        let second_value = self
            .settings
            .second
            .and_then(|variable| variable.value(state));
        self.evaluate(state.airspeed_kt, second_value)
    }

    /// Evaluates the scheduled correction like [`Schedule::at`], but with the second variable at
    /// `second_value`, if given; beyond the conditions' range the end value applies.
    pub fn evaluate(&self, airspeed_kt: f64, second_value: Option<f64>) -> ChannelCorrection {
        let gains = self.gains.map(|channel, regression| {
            let contribution = match (&self.second, second_value) {
                (Some(term), Some(value)) => term.slopes[channel] * term.scale(value),
                _ => 0.0,
            };
            let value = regression.at(&self.airspeeds, airspeed_kt) + contribution;
            match self.settings.quantity {
                ScheduledQuantity::LnGain => value.exp(),
                ScheduledQuantity::Gain => value,
            }
        });
        if let Some(leads) = &self.leads {
            return ChannelCorrection::of_leads(gains, leads.at(&self.airspeeds, airspeed_kt));
        }
        let delays_s = match &self.delays {
            Some(delays) => delays.at(&self.airspeeds, airspeed_kt),
            None => gains.map(|_, _| 0.0),
        };
        ChannelCorrection::of_delays(gains, delays_s)
    }

    /// Returns the regression's design matrix `X`: a row for each condition, with the second
    /// variable, if any, in the last column.
    pub fn design(&self) -> Vec<Vec<f64>> {
        let mut rows = self.airspeed_design();
        if let Some(term) = &self.second {
            for (row, scaled) in rows.iter_mut().zip(&term.scaled) {
                row.push(*scaled);
            }
        }
        rows
    }

    /// Returns the design matrix columns that depend on airspeed: powers of `v`, or cluster
    /// indicators.
    pub fn airspeed_design(&self) -> Vec<Vec<f64>> {
        design(&self.airspeeds, self.settings.kind)
    }

    /// Returns the design row for an airspeed \[kt\], limited to the conditions' range. A second
    /// variable is set to its mid-range value.
    pub fn design_row(&self, airspeed_kt: f64) -> Vec<f64> {
        let mut row = match self.degree() {
            Some(degree) => powers(self.airspeeds.scaled(airspeed_kt), degree),
            None => interpolation_weights(&self.airspeeds.clusters_kt(), airspeed_kt),
        };
        if self.second.is_some() {
            row.push(0.0);
        }
        row
    }
}

/// Returns the values to regress, by channel and condition (step 2); needs at least one condition.
fn regressed_values(
    points: &[ScheduledPoint<'_>],
    quantity: ScheduledQuantity,
) -> Channels<Vec<f64>> {
    points[0].correction.channels(|channel| {
        points
            .iter()
            .map(|point| {
                let gain = point.correction.gain(channel);
                match quantity {
                    ScheduledQuantity::LnGain => gain.ln(),
                    ScheduledQuantity::Gain => gain,
                }
            })
            .collect()
    })
}

/// Fits the second variable's contribution, if requested (step 3).
fn fit_second_term(
    points: &[ScheduledPoint<'_>],
    airspeeds: &Airspeeds,
    settings: ScheduleSettings,
    values: &Channels<Vec<f64>>,
) -> Result<Option<SecondTerm>, ScheduleError> {
    let Some(variable) = settings.second else {
        return Ok(None);
    };
    let mut second_values = Vec::new();
    for point in points {
        second_values.push(point.second.ok_or(ScheduleError::NoSecondValue(variable))?);
    }
    let airspeed_design = design(airspeeds, settings.kind);
    SecondTerm::fit(variable, second_values, &airspeed_design, values).map(Some)
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::Pair;

    use super::*;
    use crate::schedule::test_points::{correction, points};

    #[test]
    fn regressing_the_logarithm_makes_the_product_the_regression_of_the_product() {
        let corrections = [0.8, 1.1, 0.9, 1.3].map(|gain| correction(gain, gain * gain));
        let airspeeds_kt = [40.0, 70.0, 100.0, 140.0];
        let points = points(&airspeeds_kt, &corrections, 1.0);
        let schedule = Schedule::fit(&points, ScheduleSettings::default()).unwrap();
        let products: Vec<f64> = corrections
            .iter()
            .map(|c| c.net_gain(Pair::new(0, 0)).ln())
            .collect();
        let direct = Regression::polynomial(&schedule.airspeeds, &products, 2);
        for airspeed in [40.0, 88.0, 140.0] {
            let product = schedule.at(airspeed).net_gain(Pair::new(0, 0));
            // The same least-squares problem, rounded in another order.
            assert!((product / direct.at(&schedule.airspeeds, airspeed).exp() - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn without_conditions_there_is_no_schedule() {
        assert_eq!(
            Schedule::fit(&[], ScheduleSettings::default()),
            Err(ScheduleError::NoCondition)
        );
    }

    #[test]
    fn delays_are_scheduled_only_if_requested() {
        let own = correction(1.0, 1.0);
        let points = [ScheduledPoint {
            airspeed_kt: 60.0,
            correction: &own,
            delay_upper_s: 1.0,
            second: None,
        }];
        assert_eq!(
            Schedule::fit(&points, ScheduleSettings::default())
                .unwrap()
                .at(60.0)
                .input_delays_s,
            [0.0]
        );
        let settings = ScheduleSettings {
            delays: true,
            ..ScheduleSettings::default()
        };
        assert_eq!(
            Schedule::fit(&points, settings)
                .unwrap()
                .at(60.0)
                .input_delays_s,
            [0.01]
        );
    }

    #[test]
    fn a_scheduled_delay_stays_within_the_bounds_of_the_conditions() {
        // A cubic through 0, 0, 30 and 30 ms leaves that range on both sides. Bounds: 10, 20, 30
        // and 30 ms.
        let delays_s = [0.0, 0.0, 0.03, 0.03];
        let corrections = delays_s.map(|delay| ChannelCorrection {
            input_delays_s: vec![delay],
            ..correction(1.0, 1.0)
        });
        let mut points = points(&[60.0, 80.0, 100.0, 120.0], &corrections, 0.03);
        points[0].delay_upper_s = 0.01;
        points[1].delay_upper_s = 0.02;
        let settings = ScheduleSettings {
            kind: ScheduleKind::Polynomial { degree: 3 },
            delays: true,
            ..ScheduleSettings::default()
        };
        let schedule = Schedule::fit(&points, settings).unwrap();
        let [at_70, at_90, at_110] =
            [70.0, 90.0, 110.0].map(|kt| schedule.at(kt).input_delays_s[0]);
        assert_eq!(
            [at_70, at_110],
            [0.0, 0.03],
            "limited to 0 and to the bound"
        );
        assert!((at_90 - 0.015).abs() < 1e-15, "half way, by symmetry");
        let uncut =
            schedule.delays.as_ref().unwrap().taus_s.inputs[0].at(&schedule.airspeeds, 70.0);
        assert!(uncut < -0.001, "{uncut}");
    }
}
