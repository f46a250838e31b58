//! The physics representatives' J without and with a correction to the physics models (couplings or
//! physics parameters), averaged over the conditions (M16.4, M18.5).
//!
//! Both are compared under the same kinds of channel correction: none; each condition's own; the
//! schedule; and, for conditions left out, the correction and the schedule fitted to the others.
//! On-axis and off-axis responses are averaged separately.
//!
//! J measures the mismatch between the physics and the identified representative, smaller is better
//! (M4). A channel correction gives each channel a gain and a delay; the schedule is this
//! correction as a function of airspeed (M11).

use gdcm_method::couplings::LeftOutFit;
use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::{ConditionId, Pair, PairTable};

use crate::results::analysis::Analysis;
use crate::results::assessment_table::{
    AssessedCorrection, AssessedModel, AssessmentChoice, assessed,
};
use crate::results::correction_costs::{AxisCost, CorrectionCost, CorrectionCosts};

/// Results for a condition, with couplings and schedule fitted to the others.
pub(super) struct LeftOutCondition {
    pub(super) fit: LeftOutFit,
    pub(super) cost: LeftOutCost,
}

/// A condition's J, with the assessed correction and the schedule fitted to the other conditions.
pub(super) struct LeftOutCost {
    pub(super) condition: ConditionId,
    pub(super) cost: CorrectionCost,
    /// J without the assessed correction, response by response.
    without: PairTable<Option<CostChange>>,
    /// J with the assessed correction, response by response.
    with: PairTable<Option<CostChange>>,
}

impl LeftOutCondition {
    /// Collects the condition's results; `None` where couplings or schedule cannot be fitted to the
    /// other conditions, or the condition cannot be assessed.
    pub(super) fn new(
        condition: ConditionId,
        without: &Analysis,
        held_out: &Analysis,
    ) -> Option<Self> {
        let fit = LeftOutFit {
            condition,
            fit: held_out.fitted_couplings()?.fit.clone(),
        };
        Some(Self {
            fit,
            cost: LeftOutCost::new(condition, without, held_out)?,
        })
    }
}

impl LeftOutCost {
    /// Computes the condition's J under the schedule fitted to the others, without and with the
    /// assessed correction; `held_out` is the analysis with the correction and the condition held
    /// out. `None` where the schedule cannot be fitted to the other conditions, or the condition
    /// cannot be assessed.
    pub(super) fn new(
        condition: ConditionId,
        without: &Analysis,
        held_out: &Analysis,
    ) -> Option<Self> {
        let without_changes = changes(without, condition, AssessedCorrection::ScheduleOfOthers)?;
        let with_changes = changes(held_out, condition, AssessedCorrection::Scheduled)?;
        let mut sums = CostSums::new(without.study.dataset.on_axis());
        sums.add(&without_changes, &with_changes);
        Some(Self {
            condition,
            cost: sums.corrected(),
            without: without_changes,
            with: with_changes,
        })
    }
}

/// Returns the representative's J before and after a correction; `None` if the condition cannot be
/// assessed.
fn changes(
    analysis: &Analysis,
    condition: ConditionId,
    correction: AssessedCorrection,
) -> Option<PairTable<Option<CostChange>>> {
    let choice = AssessmentChoice {
        model: AssessedModel::Representative,
        correction,
        average: analysis.study.settings.cost_average,
    };
    Some(assessed(analysis, condition, choice).ok()?.changes)
}

/// Averages J over the conditions, without and with the assessed correction.
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
        own: own.corrected(),
        scheduled: scheduled.corrected(),
        left_out: if left_out.is_empty() {
            None
        } else {
            Some(left_out_sums.corrected())
        },
    }
}

/// Averages J for an analysis's uncorrected physics representatives.
pub(super) fn uncorrected_cost(analysis: &Analysis) -> AxisCost {
    cost_sums(analysis, analysis, AssessedCorrection::Own).uncorrected()
}

/// Sums J under a channel correction over the conditions that can be assessed both without and with
/// the correction to the physics models.
fn cost_sums<'a>(
    without: &'a Analysis,
    with: &Analysis,
    correction: AssessedCorrection,
) -> CostSums<'a> {
    let mut sums = CostSums::new(without.study.dataset.on_axis());
    for &id in without.conditions.keys() {
        let without = changes(without, id, correction);
        let with = changes(with, id, correction);
        if let (Some(without), Some(with)) = (without, with) {
            sums.add(&without, &with);
        }
    }
    sums
}

/// Sum of J over responses.
#[derive(Clone, Copy, Default)]
struct CostSum {
    count: usize,
    uncorrected: f64,
    without: f64,
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

    /// Adds a condition's responses that can be compared both without and with the correction.
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

    /// Returns the mean J before any correction.
    fn uncorrected(&self) -> AxisCost {
        self.means(|sum| sum.uncorrected)
    }

    /// Returns the mean J without and with the correction.
    fn corrected(&self) -> CorrectionCost {
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
        let found = sums.corrected();
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
