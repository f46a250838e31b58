//! Compares schedule forms by the gains' residuals and leave-one-condition-out errors (M11).
//!
//! ```text
//! for each form (polynomials of each degree, table):
//! 1  residual of condition c: ln k_c - ln k(V_c), with the schedule k(V) of all conditions
//! 2  leave-one-out error of condition c: the same with the schedule of the other conditions
//! ```
//!
//! A *form* ([`ScheduleKind`]) is the kind of function of airspeed that is fitted. `k` is a
//! response's net gain `k_o k_i`, `V` the airspeed.

use gdcm_model::dataset::{Pair, PairTable};

use super::error::ScheduleError;
use super::predictions::Predictions;
use super::scheduled_point::ScheduledPoint;
use super::settings::{ScheduleKind, ScheduleSettings};

/// All schedule forms: polynomials from the mean to the cubic, and the table.
pub const SCHEDULE_KINDS: [ScheduleKind; 5] = [
    ScheduleKind::Polynomial { degree: 0 },
    ScheduleKind::Polynomial { degree: 1 },
    ScheduleKind::Polynomial { degree: 2 },
    ScheduleKind::Polynomial { degree: 3 },
    ScheduleKind::Table,
];

/// Computes residuals and leave-one-condition-out errors (M11) for every schedule form; `settings`
/// gives the regressed quantity, the cluster tolerance and the second variable.
///
/// Each condition is left out in turn. The schedule fitted to the others, evaluated at the omitted
/// airspeed (beyond their range, its end value), is compared with the condition's own gain.
///
/// # Errors
/// [`ScheduleError`] if no schedule can be fitted to all conditions.
pub fn compare_forms(
    points: &[ScheduledPoint<'_>],
    settings: ScheduleSettings,
) -> Result<FormComparison, ScheduleError> {
    let mut fits = Vec::with_capacity(SCHEDULE_KINDS.len());
    for kind in SCHEDULE_KINDS {
        let settings = ScheduleSettings {
            kind,
            delays: false,
            ..settings
        };
        let predictions = Predictions::new(points, settings)?;
        fits.push(FormFit {
            kind,
            degree: predictions.degree,
            pairs: predictions.by_pair(|pair| gain_residuals(points, &predictions, pair)),
        });
    }
    Ok(FormComparison {
        airspeeds_kt: points.iter().map(|point| point.airspeed_kt).collect(),
        fits,
    })
}

/// Returns a response's net gain residuals.
fn gain_residuals(
    points: &[ScheduledPoint<'_>],
    predictions: &Predictions,
    pair: Pair,
) -> FitResiduals {
    let mut residuals = Vec::with_capacity(points.len());
    let mut left_out = Vec::with_capacity(points.len());
    for (condition, point) in points.iter().enumerate() {
        let own = point.correction.net_gain(pair);
        let scheduled = &predictions.scheduled[condition];
        // Step 1
        residuals.push(Residual::new(own, scheduled.net_gain(pair)));
        // Step 2
        left_out.push(match &predictions.left_out[condition] {
            Some(prediction) => Residual::new(own, prediction.net_gain(pair)),
            None => None,
        });
    }
    FitResiduals {
        residuals,
        left_out,
    }
}

/// Fits with all schedule forms.
#[derive(Clone, Debug, PartialEq)]
pub struct FormComparison {
    /// Airspeed by condition \[kt\], ordered as the residuals.
    pub airspeeds_kt: Vec<f64>,
    /// Fits ordered as [`SCHEDULE_KINDS`].
    pub fits: Vec<FormFit>,
}

impl FormComparison {
    /// Returns the fit with the form `kind`; `None` if it was not fitted.
    pub fn form(&self, kind: ScheduleKind) -> Option<&FormFit> {
        self.fits.iter().find(|fit| fit.kind == kind)
    }
}

/// Residuals by response under one schedule form.
#[derive(Clone, Debug, PartialEq)]
pub struct FormFit {
    /// The form.
    pub kind: ScheduleKind,
    /// Polynomial degree, possibly less than requested (M11b); `None` for a table.
    pub degree: Option<usize>,
    /// Residuals in the net gain `k_o k_i`.
    pub pairs: PairTable<FitResiduals>,
}

impl FormFit {
    /// Returns the leave-one-condition-out error in `ln k_o k_i`, root mean square over these
    /// responses; `None` if a residual is missing, or without responses.
    pub fn left_out_rms_ln(&self, pairs: impl IntoIterator<Item = Pair>) -> Option<f64> {
        let mut squares = Vec::new();
        for pair in pairs {
            let rms = self.pairs[pair].left_out_rms_ln()?;
            squares.push(rms * rms);
        }
        root_mean(&squares)
    }
}

/// A gain's residuals under one schedule form, by condition.
#[derive(Clone, Debug, PartialEq)]
pub struct FitResiduals {
    /// Each condition's residual; `None` if the scheduled gain is not positive.
    pub residuals: Vec<Option<Residual>>,
    /// Each condition's residual against the schedule fitted without that condition; `None` if that
    /// schedule does not exist, as for the only condition, or gives no positive gain.
    pub left_out: Vec<Option<Residual>>,
}

impl FitResiduals {
    /// Returns the root mean square residual in `ln k`; `None` if a residual is missing.
    pub fn rms_ln(&self) -> Option<f64> {
        rms(&self.residuals)
    }

    /// Returns the leave-one-condition-out error in `ln k`, root mean square; `None` if a residual
    /// is missing.
    pub fn left_out_rms_ln(&self) -> Option<f64> {
        rms(&self.left_out)
    }
}

/// Difference between a condition's own gain and the scheduled gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// `ln k - ln k_scheduled`.
    pub ln: f64,
    /// `100 (k / k_scheduled - 1)`, relative to the scheduled gain \[%\].
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

/// Returns the root mean square `ln` residual; `None` if any is missing, or without residuals.
fn rms(residuals: &[Option<Residual>]) -> Option<f64> {
    let mut squares = Vec::with_capacity(residuals.len());
    for residual in residuals {
        let ln = (*residual)?.ln;
        squares.push(ln * ln);
    }
    root_mean(&squares)
}

/// Returns the square root of the mean; `None` without values.
fn root_mean(squares: &[f64]) -> Option<f64> {
    if squares.is_empty() {
        return None;
    }
    Some((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correction::ChannelCorrection;
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
        for fit in &found.fits {
            // k_0 k_i = 2 in every condition.
            for residual in &fit.pairs[Pair::new(0, 0)].residuals {
                assert!(residual.unwrap().ln.abs() < 1e-14);
            }
            let both = fit
                .left_out_rms_ln([Pair::new(0, 0), Pair::new(1, 0)])
                .unwrap();
            let single = fit.pairs[Pair::new(1, 0)].left_out_rms_ln().unwrap();
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
        let fit = &found.fits[0].pairs[Pair::new(1, 0)];
        assert_eq!(
            (fit.rms_ln(), fit.left_out_rms_ln(), fit.left_out.as_slice()),
            (Some(0.0), None, &[None][..])
        );
        assert_eq!(
            compare_forms(&[], ScheduleSettings::default()),
            Err(ScheduleError::NoCondition)
        );
    }
}
