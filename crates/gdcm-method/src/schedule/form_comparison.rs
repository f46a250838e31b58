//! Comparison of forms and degrees: residuals and leave-one-condition-out errors (M11, M15.5).

use gdcm_model::dataset::{Pair, PairTable};

use super::channel_schedule::Schedule;
use super::error::ScheduleError;
use super::scheduled_point::ScheduledPoint;
use super::settings::{HIGHEST_DEGREE, ScheduleKind, ScheduleSettings};
use crate::correction::ChannelCorrection;

/// All forms of a schedule: polynomials from the mean to the cubic, and the table.
pub const SCHEDULE_KINDS: [ScheduleKind; 5] = [
    ScheduleKind::Polynomial { degree: 0 },
    ScheduleKind::Polynomial { degree: 1 },
    ScheduleKind::Polynomial { degree: 2 },
    ScheduleKind::Polynomial { degree: 3 },
    ScheduleKind::Table,
];

/// Difference between a condition's own gain and the scheduled gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// `ln k - ln k_scheduled`.
    pub ln: f64,
    /// `100 (k / k_scheduled - 1)`, in percent of the scheduled gain.
    pub percent: f64,
}

impl Residual {
    /// Computes a gain's residual; `None` if the scheduled gain is not positive.
    fn new(own: f64, scheduled: f64) -> Option<Self> {
        if scheduled > 0.0 {
            let ln = (own / scheduled).ln();
            Some(Self {
                ln,
                percent: 100.0 * ln.exp_m1(),
            })
        } else {
            None
        }
    }
}

/// A gain's residuals under a form of the schedule, by condition.
#[derive(Clone, Debug, PartialEq)]
pub struct FitResiduals {
    /// Residual of each condition; `None` if the scheduled gain is not positive.
    pub residuals: Vec<Option<Residual>>,
    /// Residual of each condition against the schedule fitted without that condition; `None` for
    /// the only condition.
    pub left_out: Vec<Option<Residual>>,
}

impl FitResiduals {
    /// Returns the root mean square residual of `ln k`; `None` if a residual is missing.
    pub fn rms_ln(&self) -> Option<f64> {
        rms(&self.residuals)
    }

    /// Returns the leave-one-condition-out error of `ln k`, root mean square; `None` if a residual
    /// is missing.
    pub fn left_out_rms_ln(&self) -> Option<f64> {
        rms(&self.left_out)
    }
}

/// Returns the root mean square `ln` residual; `None` if any is missing, or without residuals.
fn rms(residuals: &[Option<Residual>]) -> Option<f64> {
    let mut squares = Vec::with_capacity(residuals.len());
    for residual in residuals {
        let ln = (*residual)?.ln;
        squares.push(ln * ln);
    }
    root_mean(&squares)
}

fn root_mean(squares: &[f64]) -> Option<f64> {
    if squares.is_empty() {
        return None;
    }
    Some((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// Residuals by response under a form of the schedule.
#[derive(Clone, Debug, PartialEq)]
pub struct FormFit {
    pub kind: ScheduleKind,
    /// Polynomial degree, possibly less than requested (M11b); `None` for a table.
    pub degree: Option<usize>,
    /// Net gain residuals, `k_o k_i`.
    pub pairs: PairTable<FitResiduals>,
}

impl FormFit {
    /// Returns the leave-one-condition-out error of `ln k_o k_i`, root mean square over these
    /// responses; `None` if a residual is missing.
    pub fn left_out_rms_ln(&self, pairs: impl IntoIterator<Item = Pair>) -> Option<f64> {
        let mut squares = Vec::new();
        for pair in pairs {
            let rms = self.pairs[pair].left_out_rms_ln()?;
            squares.push(rms * rms);
        }
        root_mean(&squares)
    }
}

/// Fits of all forms of the schedule.
#[derive(Clone, Debug, PartialEq)]
pub struct FormComparison {
    /// Airspeed by condition \[kt\], in the order of the residuals.
    pub airspeeds_kt: Vec<f64>,
    /// Fits in the order of [`SCHEDULE_KINDS`].
    pub kinds: Vec<FormFit>,
}

impl FormComparison {
    /// Returns the fit of a form; `None` if the form was not fitted.
    pub fn form(&self, kind: ScheduleKind) -> Option<&FormFit> {
        self.kinds.iter().find(|form| form.kind == kind)
    }
}

/// Computes residuals and leave-one-condition-out errors (M11) for every form of the schedule;
/// `settings` gives the regressed quantity and the cluster tolerance.
///
/// Each condition is left out in turn. The schedule of the others, evaluated at the omitted
/// airspeed (beyond their range, its end value), is compared with the condition's own gain.
///
/// # Errors
/// [`ScheduleError`] if no schedule can be fitted to all conditions.
pub fn compare_forms(
    points: &[ScheduledPoint<'_>],
    settings: ScheduleSettings,
) -> Result<FormComparison, ScheduleError> {
    let mut kinds = Vec::with_capacity(SCHEDULE_KINDS.len());
    for kind in SCHEDULE_KINDS {
        let settings = ScheduleSettings {
            kind,
            delays: false,
            ..settings
        };
        let predictions = Predictions::new(points, settings)?;
        kinds.push(FormFit {
            kind,
            degree: predictions.degree,
            pairs: pair_table(points, |pair| predictions.gain_residuals(points, pair)),
        });
    }
    Ok(FormComparison {
        airspeeds_kt: points.iter().map(|point| point.airspeed_kt).collect(),
        kinds,
    })
}

/// Fills a table by response; needs at least one condition.
fn pair_table<T>(points: &[ScheduledPoint<'_>], value: impl FnMut(Pair) -> T) -> PairTable<T> {
    let first = points[0].correction;
    PairTable::from_fn(first.output_gains.len(), first.input_gains.len(), value)
}

/// Scheduled corrections at the conditions.
struct Predictions {
    degree: Option<usize>,
    /// Corrections by the schedule of all conditions.
    scheduled: Vec<ChannelCorrection>,
    /// Correction of each condition by the schedule of the other conditions; `None` if that
    /// schedule does not exist.
    unseen: Vec<Option<ChannelCorrection>>,
}

impl Predictions {
    fn new(
        points: &[ScheduledPoint<'_>],
        settings: ScheduleSettings,
    ) -> Result<Self, ScheduleError> {
        let schedule = Schedule::fit(points, settings)?;
        let scheduled = points
            .iter()
            .map(|point| schedule.evaluate(point.airspeed_kt, point.second))
            .collect();
        let mut unseen = Vec::with_capacity(points.len());
        for (left_out, point) in points.iter().enumerate() {
            let others = [&points[..left_out], &points[left_out + 1..]].concat();
            let prediction = match Schedule::fit(&others, settings) {
                Ok(schedule) => Some(schedule.evaluate(point.airspeed_kt, point.second)),
                Err(_) => None,
            };
            unseen.push(prediction);
        }
        Ok(Self {
            degree: schedule.degree(),
            scheduled,
            unseen,
        })
    }

    /// Returns a response's net gain residuals.
    fn gain_residuals(&self, points: &[ScheduledPoint<'_>], pair: Pair) -> FitResiduals {
        let mut residuals = Vec::with_capacity(points.len());
        let mut left_out = Vec::with_capacity(points.len());
        for (condition, point) in points.iter().enumerate() {
            let own = point.correction.net_gain(pair);
            residuals.push(Residual::new(own, self.scheduled[condition].net_gain(pair)));
            left_out.push(match &self.unseen[condition] {
                Some(prediction) => Residual::new(own, prediction.net_gain(pair)),
                None => None,
            });
        }
        FitResiduals {
            residuals,
            left_out,
        }
    }

    /// Returns the fit of a response's net signed delay.
    fn lead_fit(&self, points: &[ScheduledPoint<'_>], pair: Pair) -> LeadFit {
        let unseen: Option<Vec<&ChannelCorrection>> =
            self.unseen.iter().map(Option::as_ref).collect();
        LeadFit {
            rms_s: delay_rms_s(points, &self.scheduled, pair),
            left_out_rms_s: unseen.map(|unseen| delay_rms_s(points, unseen, pair)),
        }
    }
}

/// Returns the root mean square difference \[s\] between the conditions' own net signed delays and
/// the predicted delays.
fn delay_rms_s<'a>(
    points: &[ScheduledPoint<'_>],
    predictions: impl IntoIterator<Item = &'a ChannelCorrection>,
    pair: Pair,
) -> f64 {
    let sum = points
        .iter()
        .zip(predictions)
        .map(|(point, prediction)| {
            let error_s = point.correction.net_delay_s(pair) - prediction.net_delay_s(pair);
            error_s.powi(2)
        })
        .sum::<f64>();
    (sum / points.len() as f64).sqrt()
}

/// Root mean square differences \[s\] between the conditions' own signed delays and the scheduled
/// ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadFit {
    /// With the schedule of all conditions.
    pub rms_s: f64,
    /// With predictions from the schedule of the other conditions; `None` for the only condition.
    pub left_out_rms_s: Option<f64>,
}

/// Fit of the signed delays by polynomials of one degree.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadDegreeFit {
    pub degree: usize,
    /// Fit of each response's net signed delay.
    pub pairs: PairTable<LeadFit>,
}

/// Computes the fit of the signed delays for each degree from 0 to [`HIGHEST_DEGREE`]; empty if a
/// condition's correction has no leads.
pub fn compare_lead_degrees(
    points: &[ScheduledPoint<'_>],
    settings: ScheduleSettings,
) -> Vec<LeadDegreeFit> {
    let mut fits = Vec::new();
    if points.iter().any(|point| point.correction.leads.is_none()) {
        return fits;
    }
    for degree in 0..=HIGHEST_DEGREE {
        let settings = ScheduleSettings {
            // Signed delays depend on airspeed only, whatever the form of the gains.
            kind: ScheduleKind::Polynomial { degree: 0 },
            tau_degree: degree,
            second: None,
            ..settings
        };
        let Ok(predictions) = Predictions::new(points, settings) else {
            continue;
        };
        fits.push(LeadDegreeFit {
            degree,
            pairs: pair_table(points, |pair| predictions.lead_fit(points, pair)),
        });
    }
    fits
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::correction::Channels;
    use crate::correction::leads::{ChannelLeads, LeadDesign, LeadSettings};
    use crate::schedule::test_points::{correction, points};

    /// Corrections with these input gains and two output gains: 2 divided by the input gain, and 1.
    fn corrections(gains: &[f64]) -> Vec<ChannelCorrection> {
        gains
            .iter()
            .map(|gain| ChannelCorrection {
                output_gains: vec![2.0 / gain, 1.0],
                output_delays_s: vec![0.0; 2],
                ..correction(*gain, 1.0)
            })
            .collect()
    }

    #[test]
    fn the_true_degree_leaves_no_residual_and_predicts_a_left_out_condition() {
        // ln k = 0.1 v + 0.05 v^2 over 60 to 120 kt.
        let airspeeds = [60.0, 75.0, 90.0, 105.0, 120.0];
        let gains = airspeeds.map(|airspeed: f64| {
            let v = (airspeed - 90.0) / 30.0;
            (0.1 * v + 0.05 * v * v).exp()
        });
        let corrections = corrections(&gains);
        let found = compare_forms(
            &points(&airspeeds, &corrections, 0.0),
            ScheduleSettings::default(),
        )
        .unwrap();
        let [mean, line, parabola, cubic, table] =
            SCHEDULE_KINDS.map(|kind| &found.form(kind).unwrap().pairs[Pair::new(1, 0)]);
        // Least squares over five points with a condition number below 5.
        assert!(parabola.rms_ln().unwrap() < 1e-14 && cubic.rms_ln().unwrap() < 1e-14);
        assert!(line.rms_ln().unwrap() > 0.01);
        assert!(mean.rms_ln().unwrap() > line.rms_ln().unwrap());
        // Condition 2 is inside the range of the others. Beyond that range the end value applies,
        // with any degree.
        assert!(parabola.left_out[2].unwrap().ln.abs() < 1e-14);
        let step = gains[4] / gains[3];
        let last = parabola.left_out[4].unwrap();
        assert!((last.ln - step.ln()).abs() < 1e-14);
        assert!((last.percent - 100.0 * (step - 1.0)).abs() < 1e-11);
        assert_eq!(
            (
                found.form(ScheduleKind::Table).unwrap().degree,
                table.rms_ln()
            ),
            (None, Some(0.0)),
            "a table goes through its points"
        );
        assert!(table.left_out_rms_ln() > parabola.left_out_rms_ln());
    }

    #[test]
    fn a_constant_net_gain_leaves_no_residual() {
        let corrections = corrections(&[1.0, 1.2, 0.9, 1.4]);
        let found = compare_forms(
            &points(&[50.0, 80.0, 110.0, 140.0], &corrections, 0.0),
            ScheduleSettings::default(),
        )
        .unwrap();
        for kind in &found.kinds {
            // k_0 k_i = 2 in every condition.
            for residual in &kind.pairs[Pair::new(0, 0)].residuals {
                assert!(residual.unwrap().ln.abs() < 1e-14);
            }
            let both = kind
                .left_out_rms_ln([Pair::new(0, 0), Pair::new(1, 0)])
                .unwrap();
            let single = kind.pairs[Pair::new(1, 0)].left_out_rms_ln().unwrap();
            assert!((both - single / 2.0_f64.sqrt()).abs() < 1e-14);
        }
    }

    #[test]
    fn a_single_condition_cannot_be_left_out() {
        let corrections = corrections(&[1.3]);
        let found = compare_forms(
            &points(&[80.0], &corrections, 0.0),
            ScheduleSettings::default(),
        )
        .unwrap();
        let fit = &found.kinds[0].pairs[Pair::new(1, 0)];
        assert_eq!(
            (fit.rms_ln(), fit.left_out_rms_ln(), fit.left_out.as_slice()),
            (Some(0.0), None, &[None][..])
        );
        assert_eq!(
            compare_forms(&[], ScheduleSettings::default()),
            Err(ScheduleError::NoCondition)
        );
    }

    #[test]
    fn a_mean_predicts_left_out_delays_worse_than_it_fits() {
        let design = Arc::new(LeadDesign::new(
            LeadSettings::default(),
            [0.5, 3.0, 12.0].into(),
        ));
        let taus_s = [-0.02, -0.03, -0.05];
        let corrections = taus_s.map(|tau_s| ChannelCorrection {
            input_delays_s: vec![0.0],
            leads: Some(ChannelLeads::new(
                Arc::clone(&design),
                Channels {
                    inputs: vec![tau_s],
                    outputs: vec![0.01],
                },
            )),
            ..correction(1.0, 1.0)
        });
        let points = points(&[60.0, 90.0, 120.0], &corrections, 0.02);
        let found = compare_lead_degrees(&points, ScheduleSettings::default());
        assert_eq!(found.len(), 1 + HIGHEST_DEGREE);
        // The distance from the mean of the others is 3/2 times the distance from the mean of all.
        let mean = &found[0].pairs[Pair::new(0, 0)];
        assert!((mean.left_out_rms_s.unwrap() / mean.rms_s - 1.5).abs() < 1e-12);
        // The output's signed delay is constant, so the sum has the input's residuals:
        // sqrt((40^2 + 10^2 + 50^2) / 3) / 3 ms.
        assert!((mean.rms_s - 0.0042_f64.sqrt() / 3.0 / 3_f64.sqrt()).abs() < 1e-12);
        assert!(
            found[2].pairs[Pair::new(0, 0)].rms_s < 1e-15,
            "a parabola goes through three points"
        );
        assert!(compare_lead_degrees(&[], ScheduleSettings::default()).is_empty());
    }
}
