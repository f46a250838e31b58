//! Assesses couplings: analyses the study without and with them, and without each condition in turn
//! (M16.4).
//!
//! ```text
//! 1  analysis without couplings, and with them
//! 2  fit and schedule without each condition in turn: J of the condition left out
//! 3  each condition: moved poles, singular values, change above the band   (`coupling_effects`)
//! 4  J without and with couplings                                          (`correction_costs`)
//! ```
//!
//! Couplings are a mixing of the inputs and a feedback from outputs to inputs, fitted to all
//! conditions (M16). J is the mismatch cost (M4). A condition left out shows whether they hold for
//! a condition to which they are not fitted.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::couplings::LEAST_CONDITIONS;
use gdcm_model::dataset::ConditionId;
use gdcm_model::executor::{Sequential, each};
use gdcm_model::progress::{Cancelled, Portion, Progress, Shares};

use super::condition_stages::SWAP_PROOF;
use super::correction_costs::{LeftOutCondition, LeftOutCost, correction_costs};
use super::coupling_effects::{condition_effect, margin_grid};
use super::engine::Engine;
use crate::decisions::edit::Edit;
use crate::decisions::settings::CouplingCorrection;
use crate::decisions::study::Study;
use crate::results::analysis::{Analysis, ConditionAnalysis};
use crate::results::couplings_assessment::{AssessedCouplings, CouplingsAssessment};
use crate::results::fitted_couplings::FittedCouplings;

/// Step name in progress reports.
const LEAVING_OUT: &str = "test of the couplings on left-out conditions";

/// Share of each of the two analyses in the reported progress; all shares sum to 1.
const ANALYSIS_SHARE: f64 = 0.1;

/// Progress share of the fits without each condition in turn.
const LEFT_OUT_SHARE: f64 = 0.6;

/// Progress share of the effects on the conditions.
const EFFECTS_SHARE: f64 = 0.2;

impl Engine {
    /// Assesses `couplings` for a study, whose own coupling setting is ignored; `None` for
    /// [`CouplingCorrection::None`].
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
        // Step 1.
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
        // Step 2.
        let left_out = self.leave_out_each(&without, &with, &fitted, &shares)?;
        // Step 3.
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
                .map(|left_out| left_out.cost.cost);
            conditions.insert(id, effect.couplings);
            unstable.extend(effect.unstable);
        }
        let unused_lead_offers = without
            .conditions
            .values()
            .flatten()
            .filter(|result| result.offer.is_some())
            .count();
        let costs_left_out: Vec<&LeftOutCost> =
            left_out.iter().map(|left_out| &left_out.cost).collect();
        Ok(Some(Ok(Arc::new(CouplingsAssessment {
            couplings,
            fitted,
            level: study.settings.uncertainty.level,
            band: study.settings.band,
            // Step 4.
            costs: correction_costs(&without, &with, &costs_left_out),
            omega: grid.omega().into(),
            conditions,
            unstable,
            unused_lead_offers,
            left_out_fits: left_out.into_iter().map(|left_out| left_out.fit).collect(),
        }))))
    }

    /// Repeats the fit and the schedule without each condition in turn; conditions for which that
    /// is impossible are omitted. Empty with fewer than three conditions.
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
        let results = each(self.executor(), ids, |condition| {
            let held_out = Edit::SetHeldOut {
                condition,
                held_out: true,
            };
            let mut study = with.study.clone();
            if study.apply(&held_out).is_err() {
                return Ok(None);
            }
            // As after a model swap: the gains are proven, but no other minima are listed.
            let mut engine = self
                .fork(Box::new(Sequential))
                .with_proofs_within(SWAP_PROOF);
            let portion = Portion::new(shares, share, LEAVING_OUT);
            let analysis = engine.analyze(&study, &portion)?;
            portion.finish()?;
            Ok(LeftOutCondition::new(condition, without, &analysis))
        });
        results.into_iter().filter_map(Result::transpose).collect()
    }
}

/// Returns the study with other couplings.
pub(crate) fn with_couplings(study: &Study, couplings: CouplingCorrection) -> Study {
    let mut study = study.clone();
    study.settings.couplings = couplings;
    study
}
