//! Assesses couplings: analyses the study without and with them, and without each condition in turn
//! (M16.4).
//!
//! ```text
//! 1  analysis without couplings, and with them
//! 2  fit and schedule without each condition in turn: J of the condition left out
//! 3  J without and with couplings: own corrections, schedule, conditions left out
//! 4  each condition: moved poles, minimum singular value of I - K H, change above the band
//! ```

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::correction::Pade;
use gdcm_method::correction::lead_price::ABOVE_BAND;
use gdcm_method::couplings::response_change::relative_change_db;
use gdcm_method::couplings::{LEAST_CONDITIONS, LeftOutFit, LoopMargin, PoleShift};
use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::{Band, BundleKind, ConditionId, Model, Pair, PairTable};
use gdcm_model::executor::{Sequential, each};
use gdcm_model::progress::{Cancelled, Portion, Progress, Shares};
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::response::{FrequencyGrid, PreparedModel};

use super::condition_stages::SUBSTITUTION_PROOF;
use super::engine::Engine;
use crate::decisions::edit::Edit;
use crate::decisions::settings::CouplingCorrection;
use crate::decisions::study::Study;
use crate::results::analysis::{Analysis, ConditionAnalysis};
use crate::results::assessment_table::{
    AssessedCorrection, AssessedModel, AssessmentChoice, assessed,
};
use crate::results::couplings_assessment::{
    AssessedCouplings, AxisCost, ConditionCouplings, CouplingCost, CouplingCosts,
    CouplingsAssessment, NoPoles, RefusedModel, UnstablePole,
};
use crate::results::fitted_couplings::{CoupledCondition, FittedCouplings};

/// Name of the step in progress reports.
const LEAVING_OUT: &str = "couplings without each condition";
/// Shares of the work in progress reports; together 1. Each of the two analyses.
const ANALYSIS_SHARE: f64 = 0.1;
/// Fits without each condition in turn.
const LEFT_OUT_SHARE: f64 = 0.6;
/// Effects on the conditions.
const EFFECTS_SHARE: f64 = 0.2;

/// Numbers of frequencies of the singular values: below the band, and from its lower end to ten
/// times its upper end (2 % apart for the band of the example).
const MARGIN_POINTS: [usize; 2] = [60, 300];

impl Engine {
    /// Assesses a study's couplings; `None` where it requests none.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn assess_couplings(
        &mut self,
        study: &Study,
        couplings: CouplingCorrection,
        progress: &dyn Progress,
    ) -> Result<Option<AssessedCouplings>, Cancelled> {
        let shares = Shares::new(progress);
        let portion = Portion::new(&shares, ANALYSIS_SHARE, LEAVING_OUT);
        let without = self.analyze(&with_couplings(study, CouplingCorrection::None), &portion)?;
        portion.finish()?;
        let portion = Portion::new(&shares, ANALYSIS_SHARE, LEAVING_OUT);
        let with = self.analyze(&with_couplings(study, couplings), &portion)?;
        portion.finish()?;
        let fitted = match &with.couplings {
            None => return Ok(None),
            Some(Err(error)) => return Ok(Some(Err(error.clone()))),
            Some(Ok(fitted)) => Arc::clone(fitted),
        };
        let left_out = self.leave_out_each(&without, &with, &fitted, &shares)?;
        let grid = margin_grid(study.settings.band);
        let results: Vec<&ConditionAnalysis> = with.conditions.values().flatten().collect();
        let share = EFFECTS_SHARE / results.len().max(1) as f64;
        let effects = each(self.executor(), &results, |result| {
            let effect = condition_effect(&with.study, result, &grid, progress)?;
            shares.advance(share, LEAVING_OUT)?;
            Ok::<_, Cancelled>(effect)
        });
        let mut conditions = BTreeMap::new();
        let mut unstable = Vec::new();
        for (result, effect) in results.iter().zip(effects) {
            let mut effect = effect?;
            let id = result.condition.id();
            effect.couplings.left_out = left_out
                .iter()
                .find(|left_out| left_out.fit.condition == id)
                .map(|left_out| left_out.cost);
            conditions.insert(id, effect.couplings);
            unstable.extend(effect.unstable);
        }
        let want_leads = without
            .conditions
            .values()
            .flatten()
            .filter(|result| result.offer.is_some())
            .count();
        Ok(Some(Ok(Arc::new(CouplingsAssessment {
            couplings,
            fitted,
            level: study.settings.uncertainty.level,
            band: study.settings.band,
            costs: coupling_costs(&without, &with, &left_out),
            omega: grid.omega().into(),
            conditions,
            unstable,
            want_leads,
            left_out_fits: left_out.into_iter().map(|left_out| left_out.fit).collect(),
        }))))
    }

    /// Repeats the fit and the schedule without each condition in turn; empty with fewer than three
    /// conditions.
    fn leave_out_each(
        &self,
        without: &Analysis,
        with: &Analysis,
        fitted: &FittedCouplings,
        shares: &Shares<'_>,
    ) -> Result<Vec<LeftOutCondition>, Cancelled> {
        let ids: Vec<ConditionId> = fitted
            .problem
            .conditions
            .iter()
            .map(|condition| condition.id)
            .collect();
        if ids.len() < LEAST_CONDITIONS {
            return Ok(Vec::new());
        }
        let share = LEFT_OUT_SHARE / ids.len() as f64;
        let found = each(self.executor(), ids, |condition| {
            let held_out = Edit::SetHeldOut {
                condition,
                held_out: true,
            };
            let mut study = with.study.clone();
            if study.apply(&held_out).is_err() {
                return Ok(None);
            }
            let mut engine = self
                .fork(Box::new(Sequential))
                .with_proofs_within(SUBSTITUTION_PROOF);
            let portion = Portion::new(shares, share, LEAVING_OUT);
            let analysis = engine.analyze(&study, &portion)?;
            portion.finish()?;
            Ok(LeftOutCondition::new(condition, without, &analysis))
        });
        found.into_iter().filter_map(Result::transpose).collect()
    }
}

/// Returns the study with other couplings.
pub(crate) fn with_couplings(study: &Study, couplings: CouplingCorrection) -> Study {
    let mut study = study.clone();
    study.settings.couplings = couplings;
    study
}

/// Results of a condition that is left out of the fit and the schedule.
struct LeftOutCondition {
    fit: LeftOutFit,
    cost: CouplingCost,
    /// J without couplings, response by response.
    without: PairTable<Option<CostChange>>,
    /// J with couplings, response by response.
    with: PairTable<Option<CostChange>>,
}

impl LeftOutCondition {
    /// Collects the results of the condition; `None` where couplings or schedule cannot be fitted
    /// to the other conditions, or the condition cannot be assessed.
    fn new(condition: ConditionId, without: &Analysis, held_out: &Analysis) -> Option<Self> {
        let fit = LeftOutFit {
            condition,
            fit: held_out.fitted_couplings()?.fit.clone(),
        };
        let without_changes = changes(without, condition, AssessedCorrection::ScheduleOfOthers)?;
        let with_changes = changes(held_out, condition, AssessedCorrection::Scheduled)?;
        let mut sums = CostSums::new(without.study.dataset.on_axis());
        sums.add(&without_changes, &with_changes);
        Some(Self {
            fit,
            cost: sums.corrected(),
            without: without_changes,
            with: with_changes,
        })
    }
}

/// Returns J of the representative before and after a correction.
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

/// Averages J over the conditions, without and with couplings.
fn coupling_costs(
    without: &Analysis,
    with: &Analysis,
    left_out: &[LeftOutCondition],
) -> CouplingCosts {
    let own = cost_sums(without, with, AssessedCorrection::Own);
    let scheduled = cost_sums(without, with, AssessedCorrection::Scheduled);
    let mut unseen = CostSums::new(without.study.dataset.on_axis());
    for condition in left_out {
        unseen.add(&condition.without, &condition.with);
    }
    CouplingCosts {
        uncorrected: own.uncorrected(),
        own: own.corrected(),
        scheduled: scheduled.corrected(),
        left_out: if left_out.is_empty() {
            None
        } else {
            Some(unseen.corrected())
        },
    }
}

/// Sums J under a correction over the conditions that can be assessed both without and with
/// couplings.
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

/// Returns the grid from a tenth of the band's lower end to ten times its upper end; the lower end
/// itself is a grid point.
fn margin_grid(band: Band) -> FrequencyGrid {
    let [below, above] = MARGIN_POINTS;
    let mut omega = log_spaced(band.min() / ABOVE_BAND, band.min(), below);
    omega.pop();
    omega.extend(log_spaced(band.min(), ABOVE_BAND * band.max(), above));
    FrequencyGrid::at(omega)
}

/// Effect of the couplings on a condition, and its newly unstable poles.
struct ConditionEffect {
    couplings: ConditionCouplings,
    unstable: Vec<UnstablePole>,
}

/// Computes the effect of the couplings on a condition.
fn condition_effect(
    study: &Study,
    result: &ConditionAnalysis,
    grid: &FrequencyGrid,
    progress: &dyn Progress,
) -> Result<ConditionEffect, Cancelled> {
    let Some(coupled) = &result.coupled else {
        return Err(Cancelled);
    };
    let representative = result.representative_model(BundleKind::Physics);
    let response = PreparedModel::new(&representative.dynamics).response(grid);
    let singular_values = coupled.fitted.matrices().least_singular_values(&response);
    let from_band = grid
        .omega()
        .partition_point(|omega| *omega < study.settings.band.min());
    let above_band_db = relative_change_db(
        &response,
        &result.coupled_response(&response),
        grid.len() - 1,
    );
    let poles = condition_poles(study, result, coupled, progress)?;
    let margin = LoopMargin::find(&singular_values[from_band..], &grid.omega()[from_band..]);
    Ok(ConditionEffect {
        couplings: ConditionCouplings {
            airspeed_kt: result.condition.flight_state().airspeed_kt,
            poles: poles.representative,
            singular_values,
            margin,
            above_band_db,
            left_out: None,
            refused: poles.refused,
        },
        unstable: poles.unstable,
    })
}

/// Poles of a condition's kept physics models, without and with couplings.
struct ConditionPoles {
    /// Poles of the representative, or why they are unavailable.
    representative: Result<Vec<PoleShift>, NoPoles>,
    /// Newly unstable poles of every kept model.
    unstable: Vec<UnstablePole>,
    /// The other kept models with matrices for which the feedback loop cannot be closed.
    refused: Vec<RefusedModel>,
}

/// Computes the poles of the kept physics models.
fn condition_poles(
    study: &Study,
    result: &ConditionAnalysis,
    coupled: &CoupledCondition,
    progress: &dyn Progress,
) -> Result<ConditionPoles, Cancelled> {
    let id = result.condition.id();
    let band = study.settings.band;
    let rejected = &study.choice(id).physics.rejected;
    let mut poles = ConditionPoles {
        representative: Ok(Vec::new()),
        unstable: Vec::new(),
        refused: Vec::new(),
    };
    let models = result.condition.bundle(BundleKind::Physics);
    for (index, model) in models.iter().enumerate() {
        if progress.cancelled() {
            return Err(Cancelled);
        }
        let is_representative = index == result.comparison.physics.model;
        if rejected.contains(&model.name) && !is_representative {
            continue;
        }
        let shifts = pole_shifts(result, coupled, model);
        for shift in shifts.iter().flatten() {
            if shift.is_newly_unstable() {
                poles.unstable.push(UnstablePole {
                    condition: id,
                    model: model.name.clone(),
                    is_representative,
                    pole: shift.after,
                    is_in_band: (band.min()..=band.max()).contains(&shift.after.norm()),
                });
            }
        }
        if is_representative {
            poles.representative = shifts;
        } else if let Err(why) = shifts
            && model.state_space().is_some()
        {
            poles.refused.push(RefusedModel {
                model: model.name.clone(),
                why,
            });
        }
    }
    Ok(poles)
}

/// Returns the poles of a model without and with couplings, or why they cannot be computed.
fn pole_shifts(
    result: &ConditionAnalysis,
    coupled: &CoupledCondition,
    model: &Model,
) -> Result<Vec<PoleShift>, NoPoles> {
    let matrices = model.state_space().ok_or(NoPoles::Measured)?;
    let airspeed_kt = result.condition.flight_state().airspeed_kt;
    coupled
        .fitted
        .matrices()
        .pole_shifts(matrices, airspeed_kt, Pade::default())
        .map_err(NoPoles::Failed)
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

    /// Adds the responses of a condition that can be compared both without and with couplings.
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

    /// Returns the mean J without and with couplings.
    fn corrected(&self) -> CouplingCost {
        CouplingCost {
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
        assert!(!CouplingCost::default().is_worth_it());
    }
}
