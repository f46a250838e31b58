//! The physics representatives' J without and with a *model correction*, which is couplings or
//! physics parameters, averaged over the conditions (M16.4, M18.5).
//!
//! A *channel correction* gives each input and output channel a gain and a delay. J without and
//! with the model correction is compared under the same kind of channel correction:
//!
//! ```text
//! none                   the representatives as they are
//! own                    each condition's optimal channel correction
//! scheduled              the schedule: channel correction as a function of airspeed (M11)
//! left out               model correction and schedule fitted to the other conditions
//! ```
//!
//! J measures the mismatch between the physics and the identified representative, smaller is better
//! (M4). On-axis and off-axis responses are averaged separately. In names, `without` and `with`
//! refer to the model correction.

use gdcm_method::couplings::LeftOutFit;
use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::{ConditionId, Pair, PairTable};

use crate::results::analysis::Analysis;
use crate::results::assessment_table::{
    AssessedCorrection, AssessedModel, AssessmentChoice, assessed,
};
use crate::results::correction_costs::{AxisCost, CorrectionCost, CorrectionCosts};

/// Couplings fitted without a condition, and their J in this condition.
pub(super) struct LeftOutCondition {
    pub(super) fit: LeftOutFit,
    pub(super) cost: LeftOutCost,
}

/// J in a condition, with model correction and schedule fitted to the other conditions.
pub(super) struct LeftOutCost {
    pub(super) condition: ConditionId,
    pub(super) cost: CorrectionCost,
    /// J without the model correction, response by response.
    without: PairTable<Option<CostChange>>,
    /// J with the model correction, response by response.
    with: PairTable<Option<CostChange>>,
}

impl LeftOutCondition {
    /// Collects the condition's results from the analysis `without` couplings, and from that `with`
    /// couplings and the condition held out. `None` where couplings or schedule cannot be fitted to
    /// the other conditions, or the condition cannot be assessed.
    pub(super) fn new(
        condition: ConditionId,
        without: &Analysis,
        with_held_out: &Analysis,
    ) -> Option<Self> {
        let fit = LeftOutFit {
            condition,
            fit: with_held_out.fitted_couplings()?.fit.clone(),
        };
        Some(Self {
            fit,
            cost: LeftOutCost::new(condition, without, with_held_out)?,
        })
    }
}

impl LeftOutCost {
    /// Computes J in the condition under the schedule fitted to the others: from the analysis
    /// `without` the model correction, whose schedule is fitted again, and from that with it and
    /// the condition held out, whose schedule is already the others'. `None` where the schedule
    /// cannot be fitted to the other conditions, or the condition cannot be assessed.
    pub(super) fn new(
        condition: ConditionId,
        without: &Analysis,
        with_held_out: &Analysis,
    ) -> Option<Self> {
        let costs_without =
            response_costs(without, condition, AssessedCorrection::ScheduleOfOthers)?;
        let costs_with = response_costs(with_held_out, condition, AssessedCorrection::Scheduled)?;
        let mut sums = CostSums::new(without.study.dataset.on_axis());
        sums.add(&costs_without, &costs_with);
        Some(Self {
            condition,
            cost: sums.channel_corrected(),
            without: costs_without,
            with: costs_with,
        })
    }
}

/// Returns the physics representative's J in each response, before and after a channel correction;
/// `None` if the condition cannot be assessed.
fn response_costs(
    analysis: &Analysis,
    condition: ConditionId,
    channel_correction: AssessedCorrection,
) -> Option<PairTable<Option<CostChange>>> {
    let choice = AssessmentChoice {
        model: AssessedModel::Representative,
        correction: channel_correction,
        average: analysis.study.settings.cost_average,
    };
    Some(assessed(analysis, condition, choice).ok()?.changes)
}

/// Averages J over the conditions, from the analyses without and with the model correction.
pub(super) fn correction_costs(
    without: &Analysis,
    with: &Analysis,
    left_out: &[&LeftOutCost],
) -> CorrectionCosts {
    let own = cost_sums(without, with, AssessedCorrection::Own);
    let scheduled = cost_sums(without, with, AssessedCorrection::Scheduled);
    let mut left_out_sums = CostSums::new(without.study.dataset.on_axis());
    for condition in left_out {
        left_out_sums.add(&condition.without, &condition.with);
    }
    CorrectionCosts {
        uncorrected: own.uncorrected(),
        own: own.channel_corrected(),
        scheduled: scheduled.channel_corrected(),
        left_out: if left_out.is_empty() {
            None
        } else {
            Some(left_out_sums.channel_corrected())
        },
    }
}

/// Averages J over an analysis's physics representatives before any channel correction.
pub(super) fn uncorrected_cost(analysis: &Analysis) -> AxisCost {
    // The sums are for two analyses; both are this one.
    cost_sums(analysis, analysis, AssessedCorrection::Own).uncorrected()
}

/// Sums J under a channel correction over the conditions that can be assessed both without and with
/// the model correction.
fn cost_sums<'a>(
    without: &'a Analysis,
    with: &Analysis,
    channel_correction: AssessedCorrection,
) -> CostSums<'a> {
    let mut sums = CostSums::new(without.study.dataset.on_axis());
    for &id in without.conditions.keys() {
        let costs_without = response_costs(without, id, channel_correction);
        let costs_with = response_costs(with, id, channel_correction);
        if let (Some(costs_without), Some(costs_with)) = (costs_without, costs_with) {
            sums.add(&costs_without, &costs_with);
        }
    }
    sums
}

/// Sums of J over responses.
#[derive(Clone, Copy, Default)]
struct CostSum {
    count: usize,
    /// Without model and channel correction.
    uncorrected: f64,
    /// Under the channel correction, without the model correction.
    without: f64,
    /// Under the channel correction, with the model correction.
    with: f64,
}

impl CostSum {
    fn add(&mut self, without: &CostChange, with: &CostChange) {
        self.count += 1;
        self.uncorrected += without.uncorrected.total();
        self.without += without.corrected.total();
        self.with += with.corrected.total();
    }

    /// Returns the mean over the counted responses; `None` if none was counted.
    fn mean(&self, sum: f64) -> Option<f64> {
        if self.count > 0 {
            Some(sum / self.count as f64)
        } else {
            None
        }
    }
}

/// Sums of J over the responses of several conditions.
struct CostSums<'a> {
    is_on_axis: &'a PairTable<bool>,
    on_axis: CostSum,
    others: CostSum,
}

impl<'a> CostSums<'a> {
    fn new(is_on_axis: &'a PairTable<bool>) -> Self {
        Self {
            is_on_axis,
            on_axis: CostSum::default(),
            others: CostSum::default(),
        }
    }

    /// Adds a condition's responses that can be compared without and with the model correction.
    fn add(
        &mut self,
        without: &PairTable<Option<CostChange>>,
        with: &PairTable<Option<CostChange>>,
    ) {
        for (pair, without) in without.iter() {
            if let (Some(without), Some(with)) = (without, &with[pair]) {
                self.sum(pair).add(without, with);
            }
        }
    }

    /// Returns the sum for a response: on-axis or off-axis.
    fn sum(&mut self, pair: Pair) -> &mut CostSum {
        if self.is_on_axis[pair] {
            &mut self.on_axis
        } else {
            &mut self.others
        }
    }

    /// Returns the on-axis and the off-axis mean.
    fn means(&self, sum: fn(&CostSum) -> f64) -> AxisCost {
        AxisCost {
            on_axis: self.on_axis.mean(sum(&self.on_axis)),
            others: self.others.mean(sum(&self.others)),
        }
    }

    /// Returns the mean J without model and channel correction.
    fn uncorrected(&self) -> AxisCost {
        self.means(|sum| sum.uncorrected)
    }

    /// Returns the mean J under the channel correction, without and with the model correction.
    fn channel_corrected(&self) -> CorrectionCost {
        CorrectionCost {
            without: self.means(|sum| sum.without),
            with: self.means(|sum| sum.with),
        }
    }
}

#[cfg(test)]
mod tests {
    use gdcm_method::fidelity::Cost;

    use super::*;

    fn change(uncorrected: f64, corrected: f64) -> Option<CostChange> {
        let cost = |magnitude| Cost {
            magnitude,
            phase: 0.0,
        };
        Some(CostChange {
            uncorrected: cost(uncorrected),
            corrected: cost(corrected),
        })
    }

    #[test]
    fn only_responses_that_can_be_compared_both_times_count() {
        let on_axis = PairTable::from_fn(2, 1, |pair| pair.output == 0);
        let mut sums = CostSums::new(&on_axis);
        let table =
            |values: [Option<CostChange>; 2]| PairTable::from_fn(2, 1, |pair| values[pair.output]);
        sums.add(
            &table([change(9.0, 4.0), change(50.0, 40.0)]),
            &table([change(9.0, 2.0), None]),
        );
        sums.add(
            &table([change(5.0, 2.0), change(70.0, 20.0)]),
            &table([change(5.0, 2.0), change(70.0, 18.0)]),
        );
        assert_eq!(
            sums.uncorrected(),
            AxisCost {
                on_axis: Some(7.0),
                others: Some(70.0)
            }
        );
        let found = sums.channel_corrected();
        assert_eq!(
            found.without,
            AxisCost {
                on_axis: Some(3.0),
                others: Some(20.0)
            }
        );
        assert_eq!(
            found.with,
            AxisCost {
                on_axis: Some(2.0),
                others: Some(18.0)
            }
        );
        assert!(found.is_worth_it(), "a tenth less");
        assert!(!CorrectionCost::default().is_worth_it());
    }
}
