//! Remarks on the displayed result, for the reasons, their count in the verdict, and the couplings
//! in use.

use gdcm_study::ConditionAnalysis;
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::coupling_remark::CouplingRemark;
use gdcm_study::results::coupling_remark_search::coupling_consequences;
use gdcm_study::results::remark::Remark;

use super::used_couplings;
use crate::gui::state::window_state::State;

/// Returns the remarks on the displayed result, on the schedule, and on the couplings in use.
pub fn remarks_shown(state: &State, shown: &ConditionAnalysis) -> Vec<Remark> {
    let schedule = state
        .analysis()
        .and_then(|analysis| analysis.schedule.as_ref().ok());
    let mut remarks = condition_remarks(&state.study, shown, schedule);
    for remark in used_coupling_remarks(state) {
        remarks.push(Remark::Coupling(remark));
    }
    remarks
}

/// Returns the benefit and cost of the couplings in use, or the reason for their absence; empty if
/// none are requested, and until the benefit is computed.
pub fn used_coupling_remarks(state: &State) -> Vec<CouplingRemark> {
    let Some(analysis) = state.analysis() else {
        return Vec::new();
    };
    match &analysis.couplings {
        Some(Err(error)) => vec![CouplingRemark::Unavailable(error.clone())],
        None => Vec::new(),
        Some(Ok(_)) => match used_couplings(state) {
            Some(assessment) => coupling_consequences(assessment, state.dataset()),
            None => Vec::new(),
        },
    }
}
