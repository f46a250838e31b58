//! Assesses physics parameters: analyses the study without and with them, and with the values fitted
//! to the other conditions, for each condition in turn (M18.5).
//!
//! ```text
//! 1  analysis without the parameters, and with them, which fits them
//! 2  each condition of the fit: values and schedule fitted to the other conditions; J of the condition
//! 3  J without and with the parameters, and with them but without gains and delays  (`correction_costs`)
//! 4  reruns against the prediction                                      (`rerun_checks`)
//! ```
//!
//! A parameter is a quantity of the physics model, such as an inertia; its value is found from
//! *runs*, which are models linearised again with one parameter moved. A *rerun* is a model with
//! several moved, to check the values (M18.6). J is the mismatch cost (M4). The schedule gives
//! gains and delays over airspeed. *Without* and *with* refer to the parameters.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::couplings::{LEAST_CONDITIONS, PoleShift};
use gdcm_method::fidelity::CostAverage;
use gdcm_model::dataset::{BundleKind, ConditionId};
use gdcm_model::executor::{Sequential, each};
use gdcm_model::progress::{Cancelled, Portion, Progress, Shares};
use gdcm_model::response::{FrequencyGrid, PreparedModel};

use super::condition_stages::SWAP_PROOF;
use super::correction_costs::{LeftOutCost, correction_costs, uncorrected_cost};
use super::engine::Engine;
use super::rerun_checks::check_reruns;
use crate::decisions::edit::Edit;
use crate::decisions::physics_settings::PhysicsCorrection;
use crate::decisions::study::Study;
use crate::results::analysis::{Analysis, ConditionAnalysis};
use crate::results::applied_physics::AppliedPhysics;
use crate::results::couplings_assessment::NoPoles;
use crate::results::physics_assessment::{AssessedPhysics, ConditionPhysics, PhysicsAssessment};
use crate::results::response_shapes::{ResponseShapes, ShapeSources};
use crate::results::without_and_with::WithoutAndWith;

/// Step name in progress reports.
const LEAVING_OUT: &str = "test of the physics parameters on left-out conditions";

/// Share of the analysis without the parameters in the reported progress; all shares sum to 1.
const WITHOUT_SHARE: f64 = 0.1;

/// Progress share of the fit and of the analysis with the parameters.
const WITH_SHARE: f64 = 0.3;

/// Progress share of the analyses without each condition in turn.
const LEFT_OUT_SHARE: f64 = 0.6;

impl Engine {
    /// Diagnoses a study's physics parameters and assesses those that `physics` selects; `None` for
    /// [`PhysicsCorrection::Off`].
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn assess_physics(
        &mut self,
        study: &Study,
        physics: PhysicsCorrection,
        progress: &dyn Progress,
    ) -> Result<Option<AssessedPhysics>, Cancelled> {
        let shares = Shares::new(progress);
        // Step 1.
        let portion = Portion::new(&shares, WITHOUT_SHARE, LEAVING_OUT);
        let without = self.analyze(&with_physics(study, PhysicsCorrection::Off), &portion)?;
        portion.finish()?;
        let portion = Portion::new(&shares, WITH_SHARE, LEAVING_OUT);
        let with = self.analyze(&with_physics(study, physics), &portion)?;
        portion.finish()?;
        let applied = match &with.physics {
            None => return Ok(None),
            Some(Err(failure)) => return Ok(Some(Err(failure.clone()))),
            Some(Ok(applied)) => Arc::clone(applied),
        };
        // Step 2.
        let left_out = self.leave_out_values(&without, &applied, &shares)?;
        let costs_left_out: Vec<&LeftOutCost> = left_out.iter().collect();
        // Step 3.
        let costs = correction_costs(&without, &with, &costs_left_out);
        let moved_uncorrected = uncorrected_cost(&with);
        let conditions = condition_effects(&without, &with, &left_out);
        // Step 4.
        let grid = FrequencyGrid::logarithmic(study.settings.band, study.settings.points);
        let reruns = check_reruns(study, &grid);
        Ok(Some(Ok(Arc::new(PhysicsAssessment {
            correction: physics,
            level: study.settings.uncertainty.level,
            band: study.settings.band,
            costs,
            moved_uncorrected,
            conditions,
            omega: Arc::clone(&with.omega),
            couplings_without: without.fitted_couplings().cloned(),
            couplings_with: with.fitted_couplings().cloned(),
            reruns,
            applied,
        }))))
    }

    /// Assesses each fitted condition with the values found without it, and the schedule fitted to
    /// the other conditions; empty with fewer than three conditions, and where no parameter is
    /// moved.
    fn leave_out_values(
        &self,
        without: &Analysis,
        applied: &AppliedPhysics,
        shares: &Shares<'_>,
    ) -> Result<Vec<LeftOutCost>, Cancelled> {
        let mut ids: Vec<ConditionId> = Vec::new();
        if let Some(diagnosis) = applied.diagnosis() {
            ids.extend(diagnosis.conditions.iter().map(|condition| condition.id));
        }
        if ids.len() < LEAST_CONDITIONS || applied.values.is_empty() {
            return Ok(Vec::new());
        }
        let share = LEFT_OUT_SHARE / ids.len() as f64;
        let costs = each(self.executor(), ids, |condition| {
            let Some(study) = study_leaving_out(&without.study, applied, condition) else {
                return Ok(None);
            };
            // As after a model swap: the gains are proven, but no other minima are listed.
            let mut engine = self
                .fork(Box::new(Sequential))
                .with_proofs_within(SWAP_PROOF);
            let portion = Portion::new(shares, share, LEAVING_OUT);
            let analysis = engine.analyze(&study, &portion)?;
            portion.finish()?;
            Ok(LeftOutCost::new(condition, without, &analysis))
        });
        costs.into_iter().filter_map(Result::transpose).collect()
    }
}

/// Returns the study with a condition held out, and the values fitted to the other conditions set by
/// hand: they replace every decision about single parameters. `None` if the condition cannot be held
/// out.
fn study_leaving_out(
    study: &Study,
    applied: &AppliedPhysics,
    condition: ConditionId,
) -> Option<Study> {
    let mut study = with_physics(study, PhysicsCorrection::ByHand);
    let settings = &mut study.settings.physics_parameters;
    settings.by_hand.clear();
    settings.off.clear();
    for value in applied.values_without(condition) {
        let change = value.change();
        settings.by_hand.insert(value.parameter.name, change);
    }
    let held_out = Edit::SetHeldOut {
        condition,
        held_out: true,
    };
    match study.apply(&held_out) {
        Ok(()) => Some(study),
        Err(_) => None,
    }
}

/// Collects the effect on each condition that has a result without and with the parameters.
fn condition_effects(
    without: &Analysis,
    with: &Analysis,
    left_out: &[LeftOutCost],
) -> BTreeMap<ConditionId, ConditionPhysics> {
    let mut effects = BTreeMap::new();
    for (id, result) in &with.conditions {
        let (Ok(result), Some(before)) = (result, without.condition(*id)) else {
            continue;
        };
        let cost = left_out.iter().find(|left_out| left_out.condition == *id);
        effects.insert(
            *id,
            ConditionPhysics {
                airspeed_kt: result.condition.flight_state().airspeed_kt,
                delays_s: WithoutAndWith {
                    without: before.correction.signed_delays_s(),
                    with: result.correction.signed_delays_s(),
                },
                poles: representative_poles(result),
                responses: response_shapes(result, &with.omega, with.study.settings.cost_average),
                left_out: cost.map(|left_out| left_out.cost),
            },
        );
    }
    effects
}

/// Returns the physics representative's poles without and with the parameters, both before
/// couplings: `file_condition` has the models of the dataset, `condition` the moved ones.
fn representative_poles(result: &ConditionAnalysis) -> Result<Vec<PoleShift>, NoPoles> {
    let index = result.comparison.physics.model;
    let before = &result.file_condition().bundle(BundleKind::Physics)[index];
    let after = result.representative_model(BundleKind::Physics);
    match (before.state_space(), after.state_space()) {
        (Some(before), Some(after)) => PoleShift::between(before, after).map_err(NoPoles::Failed),
        _ => Err(NoPoles::Measured),
    }
}

/// Returns the physics representative's responses without and with the parameters, both before
/// couplings; empty if the parameters do not move it.
fn response_shapes(
    result: &ConditionAnalysis,
    omega: &Arc<[f64]>,
    average: CostAverage,
) -> Vec<ResponseShapes> {
    let Some(moved) = &result.moved else {
        return Vec::new();
    };
    let identified = &result.representative_model(BundleKind::Identified).dynamics;
    let grid = FrequencyGrid::at(omega.to_vec());
    let sources = ShapeSources {
        omega,
        identified: &PreparedModel::new(identified).response(&grid),
        without: &moved.before,
        with: result.before_couplings(),
        average,
    };
    sources.responses()
}

/// Returns the study with other physics parameters applied.
pub(crate) fn with_physics(study: &Study, physics: PhysicsCorrection) -> Study {
    let mut study = study.clone();
    study.settings.physics = physics;
    study
}
