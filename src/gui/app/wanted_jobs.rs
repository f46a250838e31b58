//! Jobs that the current display needs: for the visible views, and to complete the displayed
//! results.

use std::sync::Arc;

use gdcm_method::correction::Outcome;
use gdcm_study::jobs::analysis_jobs::{ProofJob, TogglesJob, UncertaintyJob};
use gdcm_study::jobs::curve_jobs::CurvesJob;
use gdcm_study::jobs::job::Job;
use gdcm_study::jobs::trade_off_job::TradeOffJob;
use gdcm_study::stages::condition_curves::{CURVE_POINTS, curves_band};

use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::need::Need;
use crate::gui::views::{couplings_job, must_assess_couplings, overlay_job, view_content};

/// Returns the jobs needed by the visible views, by the overlaid variant, and to assess the
/// couplings.
pub(super) fn needs(state: &State) -> Vec<Need> {
    let mut needs = Vec::new();
    for view in View::ALL {
        if state.display.layout.arrangement.is_shown(view) {
            needs.extend((view_content(view).needs)(state));
        }
    }
    needs.extend(overlay_job(state).map(Need::Variant));
    if must_assess_couplings(state) {
        needs.push(Need::Couplings(couplings_job(state)));
    }
    needs
}

/// Returns the job that computes the displayed condition's frequency responses.
pub(super) fn curves_job(state: &State) -> CurvesJob {
    CurvesJob {
        dataset: Arc::clone(&state.study.dataset).into(),
        condition: state.condition().id(),
        grid: (curves_band(&state.study.settings), CURVE_POINTS),
    }
}

/// Returns the job that computes the trade-off over α, the weight of the output gains' deviation
/// from 1, in the displayed condition; `None` without an analysis, and while the settings, which
/// show it, are closed.
pub(super) fn trade_off_job(state: &State) -> Option<TradeOffJob> {
    state.settings_session.as_ref()?;
    TradeOffJob::new(state.analysis()?, state.condition().id())
}

/// Returns the job that computes the cost of constraining or releasing each response in the
/// displayed condition; `None` without a result, and while a setting is dragged, since the next
/// value would outdate it.
pub(super) fn toggles_job(state: &State) -> Option<TogglesJob> {
    if state.is_setting_dragged() {
        return None;
    }
    let condition = state.analysis()?.condition(state.condition().id())?.clone();
    Some(TogglesJob { condition })
}

/// Returns the jobs that prove the gains optimal where the analysis ended without a proof, the
/// displayed condition first; none while a setting is dragged.
pub(super) fn proof_jobs(state: &State) -> Vec<ProofJob> {
    let Some(analysis) = state.analysis() else {
        return Vec::new();
    };
    if state.is_setting_dragged() {
        return Vec::new();
    }
    let shown = analysis.condition(state.condition().id());
    let others = analysis.conditions.values().flatten();
    let mut jobs: Vec<ProofJob> = Vec::new();
    for condition in shown.into_iter().chain(others) {
        let job = ProofJob {
            problem: Arc::clone(&condition.gain_problem),
        };
        if matches!(condition.gains.proof.outcome, Outcome::NotProven { .. })
            && !jobs.contains(&job)
        {
            jobs.push(job);
        }
    }
    jobs
}

/// Returns the job that computes the error bars; `None` while a setting is dragged, and while the
/// results are being recomputed or are not yet drawn, so that the live analysis can use all cores.
pub(super) fn uncertainty_job(state: &State) -> Option<UncertaintyJob> {
    let results = &state.results;
    state.analysis()?;
    let is_drawn = results.is_painted || results.uncertainty.is_some();
    if results.is_behind() || !is_drawn || state.is_setting_dragged() {
        return None;
    }
    let analysis = results.analysis.clone()?.into();
    Some(UncertaintyJob { analysis })
}

/// Drops the outputs of jobs that are not in `jobs`.
pub(super) fn keep_wanted<J: Job>(kept: &mut Vec<(J, J::Output)>, jobs: &[J]) {
    kept.retain(|(known, _)| jobs.contains(known));
}
