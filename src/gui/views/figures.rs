//! Figures of the views for paper.

use std::sync::Arc;

use gdcm_plot::figure::bode::BodeOptions;
use gdcm_plot::figure::{Figure, FigureKind, FigureRequest, all_channels};
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_study::results::requirements::Requirements;

use super::frequency::{bode_options, condition_source};
use super::over_time::shown_over_time;
use super::view_content;
use crate::gui::plot::BodeView;
use crate::gui::plot::drawn_curves::PANES;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;

/// Returns the figure of a view; `None` until its results are available.
pub fn figure_of(state: &State, view: View) -> Option<Figure> {
    let bars = !state.display.gains.hide_bars || view.figure().is_some_and(FigureKind::needs_bars);
    let with_bars = if bars {
        state.analysis_with_bars()
    } else {
        state.analysis().cloned()
    };
    // The live answer does not depend on the inputs of the requirements and may be older than
    // these.
    let with_bars = with_bars.map(|analysis| analysis.asked_with(&state.study.requirements));
    let analysis = with_bars.as_ref();
    let source = condition_source(state);
    request(state, view)?.figure(analysis, source.as_ref())
}

/// Returns a file name for a view's figure: `bode-10-LON-Q`.
pub fn figure_name(state: &State, view: View) -> String {
    let kind = view.figure();
    let mut parts: Vec<String> = kind.iter().map(|kind| kind.name().to_owned()).collect();
    if kind.is_some_and(FigureKind::is_of_condition) {
        parts.push(state.condition().id().to_string());
    }
    if matches!(view, View::Bode | View::Error | View::Across | View::Leads) {
        let (output, input) = state.dataset().channel_names(state.display.selection.pair);
        parts.extend([input, output]);
    }
    let is_plain = |letter: char| letter.is_alphanumeric() || letter == '-';
    parts
        .join("-")
        .chars()
        .map(|letter| if is_plain(letter) { letter } else { '_' })
        .collect()
}

/// Returns the figure request of a view, the same as of the command `gdcm figure`.
pub fn request(state: &State, view: View) -> Option<FigureRequest> {
    let kind = view.figure()?;
    let pairs = view_content(view).figure_pairs;
    let display = &state.display;
    let (measure, across) = display.gains.channel_values;
    let plot = match view {
        View::Bode => Some(&display.frequency.bode),
        View::Error => Some(&display.frequency.error),
        View::Across => Some(&display.frequency.across),
        _ => None,
    };
    // Axis ranges chosen by the engineer.
    let values = PANES.map(|pane| plot.and_then(|plot| plot.chosen_values(pane)));
    let bode = BodeOptions {
        omega: plot.and_then(BodeView::chosen_omega),
        values,
        ..bode_options(state)
    };
    let assessed = Some(state.assessment_choice());
    let usual = FigureRequest::new(kind, pairs(state), all_channels(state.dataset()));
    let requirements = shown_requirements(state, kind);
    let over_time = shown_over_time(state, kind);
    let couplings = shown_couplings(state).filter(|_| view == View::Couplings);
    Some(FigureRequest {
        measure,
        across,
        assessed,
        across_role: display.frequency.across_role,
        bode,
        couplings,
        requirements,
        over_time,
        ..usual
    })
}

/// Returns the assessment shown by the view.
pub fn shown_couplings(state: &State) -> Option<Arc<CouplingsAssessment>> {
    state.couplings()?.as_ref().ok().cloned()
}

/// Returns the requirements for a figure.
pub fn shown_requirements(state: &State, kind: FigureKind) -> Option<Arc<Requirements>> {
    state
        .requirements()
        .filter(|_| kind == FigureKind::Requirements)
        .cloned()
}
