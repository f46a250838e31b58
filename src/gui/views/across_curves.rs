//! Curves in the plots across conditions: the job that computes the responses, the curves of the
//! response in focus, and when the value axes are fitted to them.
//!
//! A *role* says which of a condition's models a curve shows: nominal, identified, scheduled and so
//! on.

use gdcm_plot::figure::responses::{AirspeedCurves, AirspeedResponse};
use gdcm_study::jobs::across_job::AcrossJob;
use gdcm_study::stages::condition_curves::display_band;

use crate::gui::plot::CurveId;
use crate::gui::state::across_display::AcrossFit;
use crate::gui::state::window_state::State;

/// Number of frequencies on each curve.
const POINTS: usize = 300;

/// Returns the job that computes the models' responses in each condition.
pub fn across_job(state: &State) -> AcrossJob {
    let grid = (display_band(state.study.settings.band), POINTS);
    AcrossJob::for_conditions(&state.study.dataset, state.analysis(), grid)
}

/// Returns the curves for the response in focus in each shown condition, those of the displayed
/// condition and of the one under the pointer highlighted; empty until the responses are available.
pub(super) fn across_curves(state: &mut State) -> AirspeedCurves {
    let Some(responses) = state.across().cloned() else {
        return AirspeedCurves::default();
    };
    let mut cached = std::mem::take(&mut state.display.frequency.across_shapes);
    let display = &state.display.frequency.across_display;
    let response = AirspeedResponse {
        dataset: state.dataset(),
        analysis: state.analysis(),
        roles: &display.roles,
        conditions: &display.conditions.of_study(&state.study),
        pair: state.display.selection.pair,
        band: state.study.settings.band,
        responses: &responses,
    };
    let mut drawn = response.curves(&mut cached);
    let selected = state.condition().id();
    let hovered = state.display.selection.hovered_condition;
    for curve in drawn.responses.iter_mut().chain(&mut drawn.errors) {
        if let CurveId::OfCondition(id, _) = curve.id {
            curve.highlighted = id == selected || Some(id) == hovered;
        }
        curve.detail.push_str(" · click to show the condition");
    }
    state.display.frequency.across_shapes = cached;
    drawn
}

/// Fits the value axes after another response, condition, set of roles or of conditions has been
/// selected: in each frame, until its curves are available.
pub(super) fn fit_across(state: &mut State) {
    let display = &state.display.frequency.across_display;
    let content = AcrossFit {
        pair: state.display.selection.pair,
        condition: state.condition().id(),
        roles: display.roles.clone(),
        conditions: display.conditions,
    };
    if state.display.frequency.across_fitted.as_ref() == Some(&content) {
        return;
    }
    state.display.frequency.across.request_refit();
    state.display.frequency.across_error.request_refit();
    // Until the new curves are available, the previous curves are drawn, and the fit must be
    // repeated.
    if let Some((job, _)) = &state.results.across
        && job.models == across_job(state).models
    {
        state.display.frequency.across_fitted = Some(content);
    }
}
