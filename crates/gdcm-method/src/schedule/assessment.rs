//! Assessment of the forms and degrees of a schedule: residuals and leave-one-condition-out errors
//! (M11, M15.5); and the benefit of a correction, J before and after (M12).

use gdcm_model::dataset::{Pair, PairTable};

use super::{
    HIGHEST_DEGREE, Schedule, ScheduleError, ScheduleKind, ScheduleSettings, ScheduledPoint,
};
use crate::correction::ChannelCorrection;
use crate::fidelity::{Cost, CostAverage, Mismatch};

/// All forms of a schedule: polynomials from the mean to the cubic, and the table.
pub const SCHEDULE_KINDS: [ScheduleKind; 5] = [
    ScheduleKind::Polynomial { degree: 0 },
    ScheduleKind::Polynomial { degree: 1 },
    ScheduleKind::Polynomial { degree: 2 },
    ScheduleKind::Polynomial { degree: 3 },
    ScheduleKind::Table,
];

/// Distance of a condition's own gain from the scheduled gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// `ln k - ln k_scheduled`.
    pub ln: f64,
    /// `100 (k / k_scheduled - 1)`, in percent of the scheduled gain.
    pub percent: f64,
}

impl Residual {
    /// Residual of a gain; `None` where the scheduled gain is not positive.
    fn of(own: f64, scheduled: f64) -> Option<Self> {
        (scheduled > 0.0).then(|| {
            let ln = (own / scheduled).ln();
            Self {
                ln,
                percent: 100.0 * ln.exp_m1(),
            }
        })
    }
}

/// Residuals of one gain under one form of the schedule. The lists are in the order of the
/// conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct FitResiduals {
    /// Residual of each condition; `None` where the scheduled gain is not positive.
    pub residuals: Vec<Option<Residual>>,
    /// Residual against the schedule made without that condition; `None` for the only condition.
    pub left_out: Vec<Option<Residual>>,
}

impl FitResiduals {
    /// Root mean square residual of `ln k`; `None` where a residual is missing.
    pub fn rms_ln(&self) -> Option<f64> {
        rms(&self.residuals)
    }

    /// Leave-one-condition-out error: root mean square over the schedules made without the
    /// condition.
    pub fn left_out_rms_ln(&self) -> Option<f64> {
        rms(&self.left_out)
    }
}

fn rms(residuals: &[Option<Residual>]) -> Option<f64> {
    let squares = residuals
        .iter()
        .map(|residual| residual.map(|residual| residual.ln * residual.ln));
    let sum: f64 = squares.sum::<Option<f64>>()?;
    (!residuals.is_empty()).then(|| (sum / residuals.len() as f64).sqrt())
}

/// Residuals of every response under one form of the schedule.
#[derive(Clone, Debug, PartialEq)]
pub struct FormFit {
    pub kind: ScheduleKind,
    /// Degree of the polynomial, possibly less than requested (M11b); `None` for a table.
    pub degree: Option<usize>,
    /// Residuals of each response's net gain, `k_o k_i`.
    pub pairs: PairTable<FitResiduals>,
}

impl FormFit {
    /// Leave-one-condition-out error of `ln k_o k_i`, root mean square over these responses; `None`
    /// where one is missing.
    pub fn left_out_rms_ln(&self, pairs: impl IntoIterator<Item = Pair>) -> Option<f64> {
        let squares = pairs
            .into_iter()
            .map(|pair| self.pairs[pair].left_out_rms_ln().map(|rms| rms * rms));
        let squares: Vec<f64> = squares.collect::<Option<_>>()?;
        (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
    }
}

/// Fit of every form of a schedule.
#[derive(Clone, Debug, PartialEq)]
pub struct FormComparison {
    /// Airspeed of each condition \[kt\], in the order of the lists of residuals.
    pub airspeeds_kt: Vec<f64>,
    /// Fits in the order of [`SCHEDULE_KINDS`].
    pub kinds: Vec<FormFit>,
}

impl FormComparison {
    /// Fit of one form.
    pub fn of(&self, kind: ScheduleKind) -> Option<&FormFit> {
        self.kinds.iter().find(|form| form.kind == kind)
    }
}

/// Computes residuals and leave-one-condition-out errors (M11) of every form of the schedule of
/// these conditions; `settings` gives the regressed quantity and the tolerance of the airspeed
/// clusters.
///
/// Conditions are left out one at a time: the schedule of the others, evaluated at the omitted
/// airspeed (beyond their range the end value), is compared with the condition's own gain.
///
/// # Errors
/// [`ScheduleError::NoCondition`] where there is no condition.
pub fn compare_forms(
    points: &[ScheduledPoint<'_>],
    settings: ScheduleSettings,
) -> Result<FormComparison, ScheduleError> {
    let of_kind = |kind| {
        let Predicted {
            degree,
            scheduled,
            unseen,
        } = Predicted::of(
            points,
            ScheduleSettings {
                kind,
                delays: false,
                ..settings
            },
        )?;
        let residual = |pair: Pair, point: &ScheduledPoint<'_>, predicted: &ChannelCorrection| {
            Residual::of(point.correction.net_gain(pair), predicted.net_gain(pair))
        };
        let first = points[0].correction;
        let pairs = PairTable::from_fn(first.output_gains.len(), first.input_gains.len(), |pair| {
            FitResiduals {
                residuals: points
                    .iter()
                    .zip(&scheduled)
                    .map(|(point, said)| residual(pair, point, said))
                    .collect(),
                left_out: points
                    .iter()
                    .zip(&unseen)
                    .map(|(point, said)| residual(pair, point, said.as_ref()?))
                    .collect(),
            }
        });
        Ok(FormFit {
            kind,
            degree,
            pairs,
        })
    };
    let kinds = SCHEDULE_KINDS
        .into_iter()
        .map(of_kind)
        .collect::<Result<Vec<_>, _>>()?;
    Ok(FormComparison {
        airspeeds_kt: points.iter().map(|point| point.airspeed_kt).collect(),
        kinds,
    })
}

/// Values of the schedule at each condition, and values there of the schedule made from the other
/// conditions.
struct Predicted {
    degree: Option<usize>,
    scheduled: Vec<ChannelCorrection>,
    unseen: Vec<Option<ChannelCorrection>>,
}

impl Predicted {
    fn of(
        points: &[ScheduledPoint<'_>],
        settings: ScheduleSettings,
    ) -> Result<Self, ScheduleError> {
        let schedule = Schedule::fitted(points, settings)?;
        let at = |schedule: &Schedule, point: &ScheduledPoint<'_>| {
            schedule.evaluate(point.airspeed_kt, point.second)
        };
        let unseen = (0..points.len()).map(|left_out| {
            let others = [&points[..left_out], &points[left_out + 1..]].concat();
            Schedule::fitted(&others, settings)
                .ok()
                .map(|schedule| at(&schedule, &points[left_out]))
        });
        Ok(Self {
            degree: schedule.degree(),
            scheduled: points.iter().map(|point| at(&schedule, point)).collect(),
            unseen: unseen.collect(),
        })
    }
}

/// Distance of a schedule of signed delays from the conditions' own: root mean squares \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadFit {
    /// Over all conditions.
    pub rms_s: f64,
    /// Over the predictions for each condition by the schedule of the others; `None` where there
    /// are no others.
    pub left_out_rms_s: Option<f64>,
}

/// Fit of the signed delays by one degree.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadDegreeFit {
    /// Degree of the polynomial in airspeed.
    pub degree: usize,
    /// Fit of the net signed delay of each response.
    pub pairs: PairTable<LeadFit>,
}

/// Computes the fit of each degree, from 0 to [`HIGHEST_DEGREE`]; empty where the conditions'
/// corrections have no leads.
pub fn compare_lead_degrees(
    points: &[ScheduledPoint<'_>],
    settings: ScheduleSettings,
) -> Vec<LeadDegreeFit> {
    if points.iter().any(|point| point.correction.leads.is_none()) {
        return Vec::new();
    }
    let of_degree = |tau_degree| {
        // The signed delays depend on airspeed alone, whatever the form of the gains.
        let kind = ScheduleKind::Polynomial { degree: 0 };
        let settings = ScheduleSettings {
            kind,
            tau_degree,
            second: None,
            ..settings
        };
        let Predicted {
            scheduled, unseen, ..
        } = Predicted::of(points, settings).ok()?;
        let unseen: Option<Vec<ChannelCorrection>> = unseen.into_iter().collect();
        let fit = |pair: Pair| {
            let rms_s = |said: &[ChannelCorrection]| {
                let both = points.iter().zip(said);
                let misses_s = both
                    .map(|(own, said)| own.correction.net_delay_s(pair) - said.net_delay_s(pair));
                (misses_s.map(|miss_s| miss_s.powi(2)).sum::<f64>() / points.len() as f64).sqrt()
            };
            LeadFit {
                rms_s: rms_s(&scheduled),
                left_out_rms_s: unseen.as_deref().map(rms_s),
            }
        };
        let first = points[0].correction;
        let pairs = PairTable::from_fn(first.output_gains.len(), first.input_gains.len(), fit);
        Some(LeadDegreeFit {
            degree: tau_degree,
            pairs,
        })
    };
    (0..=HIGHEST_DEGREE).filter_map(of_degree).collect()
}

/// J of one response before and after a correction; a negative change is an improvement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostChange {
    /// J of the physics model without correction.
    pub uncorrected: Cost,
    /// J of the corrected physics model.
    pub corrected: Cost,
}

impl CostChange {
    /// `Delta J = J(corrected) - J(uncorrected)`.
    pub fn total(self) -> f64 {
        self.corrected.total() - self.uncorrected.total()
    }

    /// `Delta J_mag`.
    pub fn magnitude(self) -> f64 {
        self.corrected.magnitude - self.uncorrected.magnitude
    }

    /// `Delta J_phase`.
    pub fn phase(self) -> f64 {
        self.corrected.phase - self.uncorrected.phase
    }
}

/// Computes J of every response of a model before and after `correction`, against the model it was
/// compared with in `mismatch`.
///
/// `None` where a response is not defined, or where its net gain is not positive (possible in a
/// schedule of `k` itself).
pub fn assess(
    mismatch: &PairTable<Option<Mismatch>>,
    uncorrected: &PairTable<Option<Cost>>,
    correction: &ChannelCorrection,
    omega: &[f64],
    average: CostAverage,
) -> PairTable<Option<CostChange>> {
    let corrected = corrected_cost(mismatch, correction, omega, average);
    corrected.map(|pair, corrected| {
        Some(CostChange {
            uncorrected: uncorrected[pair]?,
            corrected: (*corrected)?,
        })
    })
}

/// Computes J of every response of a model after `correction`, against the model it was compared
/// with in `mismatch`; `None` in the same cases as [`assess`].
pub fn corrected_cost(
    mismatch: &PairTable<Option<Mismatch>>,
    correction: &ChannelCorrection,
    omega: &[f64],
    average: CostAverage,
) -> PairTable<Option<Cost>> {
    mismatch.map(|pair, mismatch| {
        corrected_cost_on(mismatch.as_ref()?, correction, pair, omega, average)
    })
}

/// Computes J of one response of a model after `correction`; `None` where its net gain is not
/// positive.
pub fn corrected_cost_on(
    mismatch: &Mismatch,
    correction: &ChannelCorrection,
    pair: Pair,
    omega: &[f64],
    average: CostAverage,
) -> Option<Cost> {
    let led = correction
        .leads
        .as_ref()
        .and_then(|leads| leads.curve(pair));
    let led = led.map(|lead| mismatch.multiplied(&lead.magnitude_db, &lead.phase));
    Some(
        led.as_ref()
            .unwrap_or(mismatch)
            .cost(omega, correction.without_leads_on(pair)?, average),
    )
}

#[cfg(test)]
mod tests {
    use super::super::tests::points;
    use super::*;

    fn corrections(gains: &[f64]) -> Vec<ChannelCorrection> {
        let of = |gain: &f64| ChannelCorrection {
            input_gains: vec![*gain],
            output_gains: vec![2.0 / gain, 1.0],
            input_delays_s: vec![0.0],
            output_delays_s: vec![0.0; 2],
            leads: None,
        };
        gains.iter().map(of).collect()
    }

    #[test]
    fn the_degree_that_made_the_gains_leaves_nothing_and_foresees_what_it_has_not_seen() {
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
        let of =
            |degree| &found.of(ScheduleKind::Polynomial { degree }).unwrap().pairs[Pair::new(1, 0)];
        // Least squares of five points, condition number below 5.
        assert!(of(2).rms_ln().unwrap() < 1e-14 && of(3).rms_ln().unwrap() < 1e-14);
        assert!(
            of(1).rms_ln().unwrap() > 0.01 && of(0).rms_ln().unwrap() > of(1).rms_ln().unwrap()
        );
        // Inside the range; beyond the range of the others the end value applies, whatever the
        // degree.
        assert!(of(2).left_out[2].unwrap().ln.abs() < 1e-14);
        let step = gains[4] / gains[3];
        assert!((of(2).left_out[4].unwrap().ln - step.ln()).abs() < 1e-14);
        assert!((of(2).left_out[4].unwrap().percent - 100.0 * (step - 1.0)).abs() < 1e-11);
        let table = found.of(ScheduleKind::Table).unwrap();
        assert_eq!(
            (table.degree, table.pairs[Pair::new(1, 0)].rms_ln()),
            (None, Some(0.0)),
            "a table goes through its points"
        );
        assert!(table.pairs[Pair::new(1, 0)].left_out_rms_ln() > of(2).left_out_rms_ln());
    }

    #[test]
    fn a_response_whose_net_gain_never_changes_is_left_no_residual() {
        let corrections = corrections(&[1.0, 1.2, 0.9, 1.4]);
        let found = compare_forms(
            &points(&[50.0, 80.0, 110.0, 140.0], &corrections, 0.0),
            ScheduleSettings::default(),
        )
        .unwrap();
        for kind in &found.kinds {
            for condition in 0..4 {
                // k_0 k_i = 2 in every condition.
                assert!(
                    kind.pairs[Pair::new(0, 0)].residuals[condition]
                        .unwrap()
                        .ln
                        .abs()
                        < 1e-14
                );
            }
            let both = kind
                .left_out_rms_ln([Pair::new(0, 0), Pair::new(1, 0)])
                .unwrap();
            let one = kind.pairs[Pair::new(1, 0)].left_out_rms_ln().unwrap();
            assert!((both - one / 2.0_f64.sqrt()).abs() < 1e-14);
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
}

#[cfg(test)]
mod lead_tests {
    use super::super::tests::points;
    use super::*;
    use crate::correction::leads::{ChannelLeads, LeadDesign, LeadSettings};
    use crate::correction::{ChannelCorrection, Channels};

    #[test]
    fn a_mean_leaves_out_worse_than_it_fits_by_the_number_of_conditions() {
        let design = std::sync::Arc::new(LeadDesign::new(
            LeadSettings::default(),
            [0.5, 3.0, 12.0].into(),
        ));
        let taus_s = [-0.02, -0.03, -0.05];
        let corrections = taus_s.map(|tau_s| ChannelCorrection {
            input_gains: vec![1.0],
            output_gains: vec![1.0],
            input_delays_s: vec![0.0],
            output_delays_s: vec![0.0],
            leads: Some(ChannelLeads::new(
                std::sync::Arc::clone(&design),
                Channels {
                    inputs: vec![tau_s],
                    outputs: vec![0.01],
                },
            )),
        });
        let points = points(&[60.0, 90.0, 120.0], &corrections, 0.02);
        let found = compare_lead_degrees(&points, ScheduleSettings::default());
        assert_eq!(found.len(), 1 + HIGHEST_DEGREE);
        // The mean of the others misses by 3/2 of the residual from the mean of all.
        let mean = &found[0].pairs[Pair::new(0, 0)];
        assert!((mean.left_out_rms_s.unwrap() / mean.rms_s - 1.5).abs() < 1e-12);
        // The output's signed delay is the same everywhere, so that the sum is missed like the
        // input's: sqrt((40^2 + 10^2 + 50^2) / 3) / 3 ms.
        assert!((mean.rms_s - 0.0042_f64.sqrt() / 3.0 / 3_f64.sqrt()).abs() < 1e-12);
        assert!(
            found[2].pairs[Pair::new(0, 0)].rms_s < 1e-15,
            "a parabola goes through three points"
        );
        assert!(compare_lead_degrees(&[], ScheduleSettings::default()).is_empty());
    }
}
