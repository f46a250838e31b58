//! Finds the remarks on couplings: diagnosis, benefit and cost, cautions (M16.4).
//!
//! 1. Diagnosis: the largest entries of mixing and feedback that exceed their error bars
//!    (`diagnosis`).
//! 2. Benefit: J without and with couplings, and whether they are worthwhile (`verdict`).
//! 3. Cost: the largest change above the band, and the pole that moves farthest
//!    (`largest_change_above_band`, `farthest_pole`).
//! 4. Cautions: poles, loops, and entries that the data do not determine (`coupling_cautions`).
//!
//! Couplings are a mixing of the inputs and a feedback from outputs to inputs (M16); J is the cost
//! of a response's mismatch (M4). The *share* of a mixing entry is the fraction of one input that
//! another receives; that of a feedback entry is the largest movement of its input per unit of
//! movement of the stick.

use gdcm_method::couplings::coupling_shares::{
    FeedbackShare, cyclic_inputs, feedback_shares, mixing_shares,
};
use gdcm_method::couplings::{LEAST_CONDITIONS, LoopMargin};
use gdcm_model::dataset::{Channel, ConditionId, Dataset, Pair};
use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit};

use super::analysis::Analysis;
use super::correction_costs::CorrectionCost;
use super::coupling_remark::{CostSource, CouplingRemark, FeedbackMeaning, OffAxisBenefit};
use super::couplings_assessment::{CouplingsAssessment, UnstablePole};
use crate::decisions::settings::CouplingCorrection;

/// Maximum number of entries reported per matrix; the largest come first.
const MOST_REPORTED: usize = 3;
/// Minimum magnitude of a share \[-\] that is reported (`MixingShare::share`,
/// `FeedbackShare::share`).
const LEAST_SHARE: f64 = 0.005;

/// Returns the remarks on an analysis's couplings: the reason why requested couplings are
/// unavailable, or the remarks from [`coupling_remarks`]; empty if none were requested, or until
/// they are assessed.
pub fn analysis_coupling_remarks(analysis: &Analysis) -> Vec<CouplingRemark> {
    match (&analysis.couplings, &analysis.coupling_assessment) {
        (Some(Err(error)), _) => vec![CouplingRemark::Unavailable(error.clone())],
        (Some(Ok(_)), Some(assessment)) => coupling_remarks(assessment, &analysis.study.dataset),
        _ => Vec::new(),
    }
}

/// Returns the largest entries, then the remarks from [`coupling_consequences`].
pub fn coupling_remarks(
    assessment: &CouplingsAssessment,
    dataset: &Dataset,
) -> Vec<CouplingRemark> {
    let mut remarks = diagnosis(assessment, dataset);
    remarks.extend(coupling_consequences(assessment, dataset));
    remarks
}

/// Returns remarks on the benefit and cost of the couplings, and cautions about them.
pub fn coupling_consequences(
    assessment: &CouplingsAssessment,
    dataset: &Dataset,
) -> Vec<CouplingRemark> {
    let mut remarks = verdict(assessment);
    remarks.extend(largest_change_above_band(assessment, dataset));
    remarks.extend(farthest_pole(assessment));
    remarks.push(CouplingRemark::BarsKeepCouplings);
    remarks.extend(coupling_cautions(assessment));
    remarks
}

/// Returns the largest entries outside their error bars: mixing entries, then feedback entries.
fn diagnosis(assessment: &CouplingsAssessment, dataset: &Dataset) -> Vec<CouplingRemark> {
    let airspeed_kt = assessment.mean_airspeed_kt();
    let matrices = assessment.fitted.matrices();
    let mixing = assessment.mixing(airspeed_kt);
    let cyclic = cyclic_inputs(dataset.on_axis(), |output| {
        is_rate(&dataset.outputs()[output])
    });
    let mixed = mixing_shares(&matrices.normalised_mixing(airspeed_kt), cyclic)
        .into_iter()
        .filter(|share| {
            !mixing[(share.to, share.from)].may_be_zero && share.share.abs() >= LEAST_SHARE
        })
        .take(MOST_REPORTED);
    let mut remarks: Vec<CouplingRemark> = mixed.map(CouplingRemark::Mixing).collect();
    let feedback = assessment.feedback();
    let fed = feedback_shares(&assessment.fitted.problem, matrices)
        .into_iter()
        .filter(|share| {
            !feedback[(share.input, share.output)].may_be_zero && share.share >= LEAST_SHARE
        })
        .take(MOST_REPORTED);
    for share in fed {
        remarks.push(CouplingRemark::Feedback {
            share,
            meaning: feedback_meaning(dataset, &share),
        });
    }
    remarks
}

/// Derives a feedback entry's physical meaning from its output's unit: for an on-axis output, an
/// acceleration is a directional stiffness if the input also commands a rate, and a rate is a
/// damping; anything else is a coupling.
fn feedback_meaning(dataset: &Dataset, feedback: &FeedbackShare) -> FeedbackMeaning {
    let is_on_axis = |output: usize| dataset.on_axis()[Pair::new(output, feedback.input)];
    if !is_on_axis(feedback.output) {
        return FeedbackMeaning::Coupling;
    }
    let output = &dataset.outputs()[feedback.output];
    let input_has_rate = dataset
        .outputs()
        .iter()
        .enumerate()
        .any(|(index, output)| is_on_axis(index) && is_rate(output));
    if input_has_rate && is_acceleration(output) {
        FeedbackMeaning::DirectionalStiffness
    } else if is_rate(output) {
        FeedbackMeaning::Damping
    } else {
        FeedbackMeaning::Coupling
    }
}

/// Returns whether the channel's unit is an angular rate of a body (not of a shaft, rpm).
pub(super) fn is_rate(channel: &Channel) -> bool {
    PhysicalUnit::parse(&channel.unit).is_some_and(|unit| ["deg/s", "rad/s"].contains(&unit.name))
}

/// Returns whether the channel's unit is an acceleration.
fn is_acceleration(channel: &Channel) -> bool {
    PhysicalUnit::parse(&channel.unit).is_some_and(|unit| unit.dimension == Dimension::Acceleration)
}

/// Compares J without and with couplings, for conditions left out of the fit or, if none was left
/// out, under the schedule. Adds a caution if the couplings are not worthwhile.
fn verdict(assessment: &CouplingsAssessment) -> Vec<CouplingRemark> {
    let couplings = assessment.couplings;
    let source = if assessment.costs.left_out.is_some() {
        CostSource::LeftOut
    } else {
        CostSource::Schedule
    };
    let cost = assessment.deciding_cost();
    let Some(benefit) = OffAxisBenefit::new(couplings, source, cost) else {
        return Vec::new();
    };
    let mut remarks = vec![CouplingRemark::Costs(benefit)];
    if !cost.is_worth_it() {
        remarks.push(CouplingRemark::NotWorthwhile { couplings, source });
    }
    remarks
}

/// Returns the hint that recommends these couplings to a study that does not use them; `None` if
/// they are not worthwhile, or if no condition was left out.
pub fn coupling_offer(assessment: &CouplingsAssessment) -> Option<CouplingRemark> {
    let cost = assessment
        .costs
        .left_out
        .filter(CorrectionCost::is_worth_it)?;
    Some(CouplingRemark::Offered {
        couplings: assessment.couplings,
        without: cost.without.others?,
        with: cost.with.others?,
    })
}

/// Returns the largest change in an on-axis response above the band; `None` if it is unknown or not
/// finite.
fn largest_change_above_band(
    assessment: &CouplingsAssessment,
    dataset: &Dataset,
) -> Option<CouplingRemark> {
    let changes = assessment.conditions.iter().filter_map(|(id, condition)| {
        let (pair, change_db) = condition.most_changed_above_band(dataset.on_axis())?;
        Some((*id, pair, change_db))
    });
    let (condition, pair, change_db) = changes.max_by(|a, b| a.2.total_cmp(&b.2))?;
    if !change_db.is_finite() {
        return None;
    }
    Some(CouplingRemark::ChangeAboveBand {
        condition,
        pair,
        change_db,
        omega_rad_s: assessment.omega.last().copied().unwrap_or_default(),
    })
}

/// Returns the pole in the band with the largest shift; `None` if no pole moves.
fn farthest_pole(assessment: &CouplingsAssessment) -> Option<CouplingRemark> {
    let band = assessment.band.min()..=assessment.band.max();
    let mut farthest = None;
    let mut farthest_rad_s = 0.0;
    for (&condition, effect) in &assessment.conditions {
        for shift in effect.poles.iter().flatten() {
            let (Some(before), Some(distance_rad_s)) = (shift.before, shift.distance_rad_s())
            else {
                continue;
            };
            if !band.contains(&before.norm()) {
                continue;
            }
            if farthest.is_none() || distance_rad_s.total_cmp(&farthest_rad_s).is_ge() {
                farthest_rad_s = distance_rad_s;
                farthest = Some(CouplingRemark::PolesMoved {
                    condition,
                    before,
                    after: shift.after,
                    distance_rad_s,
                });
            }
        }
    }
    if farthest_rad_s > 0.0 { farthest } else { None }
}

/// Returns the cautions to consider before couplings are used, in this order: newly unstable poles;
/// a loop close to ringing; feedback that stands in for leads; too few conditions; outputs that are
/// not fed back; entries that the data do not determine; poles and models without a result;
/// incomplete fits for left-out conditions.
pub fn coupling_cautions(assessment: &CouplingsAssessment) -> Vec<CouplingRemark> {
    let mut remarks = newly_unstable(assessment);
    remarks.extend(close_to_ringing(assessment));
    let has_feedback = assessment.couplings == CouplingCorrection::MixingAndFeedback;
    if assessment.unused_lead_offers > 0 && has_feedback {
        remarks.push(CouplingRemark::FeedbackAsLead {
            conditions: assessment.unused_lead_offers,
        });
    }
    let conditions = assessment.fitted.problem.conditions.len();
    if conditions < LEAST_CONDITIONS {
        remarks.push(CouplingRemark::FewConditions { conditions });
    }
    let fit = &assessment.fitted.fit;
    if !fit.not_fed_back.is_empty() {
        remarks.push(CouplingRemark::NotFedBack {
            outputs: fit.not_fed_back.clone(),
        });
    }
    if !fit.undetermined.is_empty() {
        remarks.push(CouplingRemark::EntriesUndetermined(
            fit.undetermined.clone(),
        ));
    }
    remarks.extend(unknown_poles(assessment));
    let fits = assessment.left_out_fits.len();
    if conditions >= LEAST_CONDITIONS && fits < conditions {
        remarks.push(CouplingRemark::PartlyLeftOut { fits, conditions });
    }
    remarks
}

/// Returns a caution for each condition whose poles could not be computed, then a caution for each
/// model to which the couplings cannot be applied.
fn unknown_poles(assessment: &CouplingsAssessment) -> Vec<CouplingRemark> {
    let mut remarks = Vec::new();
    for (&condition, effect) in &assessment.conditions {
        if let Err(why) = &effect.poles {
            remarks.push(CouplingRemark::PolesUnknown {
                condition,
                why: why.clone(),
            });
        }
    }
    for (&condition, effect) in &assessment.conditions {
        for refused in &effect.refused {
            remarks.push(CouplingRemark::ModelRefused {
                condition,
                model: refused.model.clone(),
                why: refused.why.clone(),
            });
        }
    }
    remarks
}

/// Returns a remark on newly unstable poles in the physics representatives, then one on those in
/// the other kept physics models.
fn newly_unstable(assessment: &CouplingsAssessment) -> Vec<CouplingRemark> {
    let mut remarks = Vec::new();
    for is_representative in [true, false] {
        let poles: Vec<UnstablePole> = assessment
            .unstable
            .iter()
            .filter(|pole| pole.is_representative == is_representative)
            .cloned()
            .collect();
        if !poles.is_empty() {
            remarks.push(CouplingRemark::NewlyUnstable {
                is_representative,
                poles,
            });
        }
    }
    remarks
}

/// Returns the loop's minimum singular value over all conditions; `None` unless it is close to
/// ringing.
fn close_to_ringing(assessment: &CouplingsAssessment) -> Option<CouplingRemark> {
    let margins = assessment
        .conditions
        .iter()
        .filter_map(|(id, condition)| Some((*id, condition.margin?)));
    let (condition, margin): (ConditionId, LoopMargin) =
        margins.min_by(|a, b| a.1.least.total_cmp(&b.1.least))?;
    if !margin.is_close_to_ringing() {
        return None;
    }
    Some(CouplingRemark::CloseToRinging { condition, margin })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_and_accelerations_are_recognised_in_every_spelling_of_their_units() {
        for unit in ["deg/s", "deg/sec", "dps", "°/s", "rad/s"] {
            assert!(is_rate(&Channel::new("Q", unit)), "{unit}");
        }
        for unit in ["g", "m/s^2", "m/s²", "ft/s2", "ft/sec^2"] {
            assert!(is_acceleration(&Channel::new("NY", unit)), "{unit}");
        }
        for unit in ["rpm", "deg", "%", ""] {
            let channel = Channel::new("X", unit);
            assert!(!is_rate(&channel) && !is_acceleration(&channel), "{unit}");
        }
    }
}
