//! Determines whether couplings are in use, assessed, or offered because they are worthwhile.
//! Couplings add constant shares of inputs (mixing) and outputs (feedback) to each input (M16:
//! docs/couplings.md).

use std::sync::Arc;

use gdcm_method::couplings::LEAST_CONDITIONS;
use gdcm_study::jobs::analysis_jobs::CouplingsJob;
use gdcm_study::results::correction_costs::CorrectionCost;
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_study::{CouplingCorrection, PhaseCorrection};

use crate::gui::state::window_state::State;

/// Returns the job that assesses the requested couplings; if none are requested, mixing and
/// feedback.
pub fn couplings_job(state: &State) -> CouplingsJob {
    CouplingsJob {
        study: state.study.clone(),
        couplings: state.assessed_couplings(),
    }
}

/// Returns whether the couplings are assessed even while their view is hidden.
///
/// Never without a current analysis. Couplings in use are assessed for their cost, others if they
/// may be worthwhile: the phase is corrected (by delays that are matched in all conditions, or by
/// leads), and at least [`LEAST_CONDITIONS`] conditions have results.
pub fn must_assess_couplings(state: &State) -> bool {
    let settings = &state.study.settings;
    let Some(analysis) = state.analysis() else {
        return false;
    };
    if state.results.is_behind() {
        return false;
    }
    if settings.couplings != CouplingCorrection::None {
        return true;
    }
    let mut results = 0;
    let mut are_delays_matched = true;
    for result in analysis.conditions.values().flatten() {
        results += 1;
        are_delays_matched &= result.delays.matched;
    }
    let is_phase_corrected = match settings.phase {
        PhaseCorrection::None => false,
        PhaseCorrection::Delay => are_delays_matched,
        PhaseCorrection::Lead => true,
    };
    is_phase_corrected && results >= LEAST_CONDITIONS
}

/// Returns the assessment of unused couplings and J in left-out conditions without and with them,
/// if this J shows them to be worthwhile.
pub fn offered_couplings(state: &State) -> Option<(&Arc<CouplingsAssessment>, CorrectionCost)> {
    if are_couplings_used(state) || !must_assess_couplings(state) {
        return None;
    }
    let assessment = state.couplings()?.as_ref().ok()?;
    let cost = assessment.costs.left_out?;
    if cost.is_worth_it() {
        Some((assessment, cost))
    } else {
        None
    }
}

/// Returns the assessment of the couplings in use; `None` if none are in use, until it is
/// available, or if it has failed.
pub fn used_couplings(state: &State) -> Option<&Arc<CouplingsAssessment>> {
    if are_couplings_used(state) {
        state.couplings()?.as_ref().ok()
    } else {
        None
    }
}

/// Returns whether the study uses mixing, or mixing and feedback.
pub(super) fn are_couplings_used(state: &State) -> bool {
    state.study.settings.couplings != CouplingCorrection::None
}
