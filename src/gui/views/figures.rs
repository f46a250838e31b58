//! The views' figures, for the screen and for export: request, figure, and file name.
//!
//! A figure request holds what a figure shows: its kind, responses, channels and options. The
//! drawing crate makes the figure from the request and the analysis.

use std::sync::Arc;

use gdcm_plot::figure::bode::BodeOptions;
use gdcm_plot::figure::{Figure, FigureKind, FigureRequest, all_channels};
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_study::results::physics_assessment::PhysicsAssessment;
use gdcm_study::results::requirements::Requirements;

use super::frequency_curves::{bode_options, condition_source};
use super::requirement_history_jobs::shown_over_time;
use super::view_content;
use crate::gui::plot::BodeView;
use crate::gui::plot::drawn_curves::PANES;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;

/// Returns a view's figure; `None` for a view without one, or until its results are available.
/// Error bars are omitted only if the engineer has hidden them and the figure does not need them.
pub fn figure_of(state: &State, view: View) -> Option<Figure> {
    let needs_bars = match view.figure() {
        Some(kind) => kind.needs_bars(),
        None => false,
    };
    let analysis = if needs_bars || !state.display.gains.hide_bars {
        state.analysis_with_error_bars()
    } else {
        state.analysis().cloned()
    };
    // The study's requirements may be newer than the analysis, which does not depend on them.
    let analysis = analysis.map(|analysis| analysis.with_requirements(&state.study.requirements));
    let source = condition_source(state);
    figure_request(state, view)?.figure(analysis.as_ref(), source.as_ref())
}

/// Returns a file name without extension for a view's figure: `bode-10-LON-Q`. Characters other
/// than letters, digits and hyphens become `_`.
pub fn figure_name(state: &State, view: View) -> String {
    let mut parts = Vec::new();
    if let Some(kind) = view.figure() {
        parts.push(kind.name().to_owned());
        if kind.is_of_condition() {
            parts.push(state.condition().id().to_string());
        }
    }
    // These views always show the response in focus and no other, so its channels are in the name.
    if matches!(
        view,
        View::Bode | View::Error | View::Across | View::Leads | View::ScheduleCost
    ) {
        let (output, input) = state
            .dataset()
            .output_and_input_name(state.display.selection.pair);
        parts.push(input);
        parts.push(output);
    }
    let mut name = String::new();
    for letter in parts.join("-").chars() {
        let is_plain = letter.is_alphanumeric() || letter == '-';
        name.push(if is_plain { letter } else { '_' });
    }
    name
}

/// Returns the request for a view's figure with the displayed options; `None` for a view without a
/// figure. The command `gdcm figure` makes the same kind of request.
pub fn figure_request(state: &State, view: View) -> Option<FigureRequest> {
    let kind = view.figure()?;
    let pairs = (view_content(view).figure_pairs)(state);
    let display = &state.display;
    // Quantity drawn for each channel (gain or delay), and its horizontal axis (airspeed or
    // conditions).
    let (measure, across) = display.gains.channel_values;
    let across_display = &display.frequency.across_display;
    let couplings = if view == View::Couplings {
        shown_couplings(state)
    } else {
        None
    };
    Some(FigureRequest {
        measure,
        across,
        assessed: Some(state.assessment_choice()),
        across_roles: across_display.roles.clone(),
        across_conditions: across_display.conditions.of_study(&state.study),
        bode: bode_options_with_ranges(state, view),
        couplings,
        physics: shown_physics(state, kind),
        parameter: display.physics.selected.clone(),
        requirements: shown_requirements(state, kind),
        over_time: shown_over_time(state, kind),
        ..FigureRequest::new(kind, pairs, all_channels(state.dataset()))
    })
}

/// Returns the engineer's choices for the curves, with the axis ranges that the engineer has chosen
/// by zooming, panning or typing in a view over frequency; other ranges are fitted to the curves.
fn bode_options_with_ranges(state: &State, view: View) -> BodeOptions {
    let plots = &state.display.frequency;
    let plot = match view {
        View::Bode => Some(&plots.bode),
        View::Error => Some(&plots.error),
        View::Across => Some(&plots.across),
        _ => None,
    };
    BodeOptions {
        omega: plot.and_then(BodeView::chosen_omega),
        values: PANES.map(|pane| plot.and_then(|plot| plot.chosen_values(pane))),
        ..bode_options(state)
    }
}

/// Returns the assessed couplings; `None` until they are available, or if the assessment failed.
pub fn shown_couplings(state: &State) -> Option<Arc<CouplingsAssessment>> {
    state.couplings()?.as_ref().ok().cloned()
}

/// Returns the physics parameters' diagnosis for their figure; `None` for other figures, until it
/// is available, if the study selects no parameters, or if it failed.
fn shown_physics(state: &State, kind: FigureKind) -> Option<Arc<PhysicsAssessment>> {
    if kind != FigureKind::Physics {
        return None;
    }
    state.physics()?.as_ref()?.as_ref().ok().cloned()
}

/// Returns the requirements for their figure; `None` for other figures, or until they are
/// available.
pub fn shown_requirements(state: &State, kind: FigureKind) -> Option<Arc<Requirements>> {
    if kind == FigureKind::Requirements {
        state.requirements().cloned()
    } else {
        None
    }
}
