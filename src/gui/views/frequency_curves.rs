//! Curves over frequency in the displayed condition: their data (`condition_source`), the
//! engineer's choices (`bode_options`), and the additions for the window alone
//! (`with_interaction`): the highlight under the pointer, the effect of a click, and a label on
//! results from older settings.
//!
//! Computing a curve's shape (magnitude and continuous phase) costs most of the time, and does not
//! depend on the options. The shapes are therefore cached: for each response in
//! `FrequencyPlots::shapes`, for the error plot in `FrequencyPlots::errors`. A cache that is used
//! checks for itself whether its shapes belong to the given responses, and recomputes them if not.

use std::mem;
use std::sync::Arc;

use gdcm_model::dataset::{BundleKind, ModelId, Pair};
use gdcm_plot::figure::ConditionSource;
use gdcm_plot::figure::bode::BodeOptions;

use super::variant_analyses::overlaid_analysis;
use crate::gui::plot::{BodeCurve, CurveId};
use crate::gui::state::frequency_plots::FrequencyPlots;
use crate::gui::state::window_state::State;

/// Returns the data for all curves in the displayed condition: the study, the condition's result,
/// the schedule, the models' responses and the overlaid variant's result, if any. `None` until the
/// responses are available.
///
/// The schedule comes from the analysis of all conditions (`State::analysis`). The condition's own
/// result (`State::shown`) is complete earlier, and may then belong to newer settings than the
/// schedule; [`with_interaction`] labels the scheduled curve accordingly.
pub(in crate::gui) fn condition_source(state: &State) -> Option<ConditionSource<'_>> {
    let mut schedule = None;
    if let Some(analysis) = state.analysis() {
        schedule = analysis.schedule.as_ref().ok();
    }
    let mut variant = None;
    if let Some((name, analysis)) = overlaid_analysis(state)
        && let Some(result) = analysis.condition(state.condition().id())
    {
        variant = Some((name, result));
    }
    Some(ConditionSource {
        study: &state.study,
        analysis: state.shown(),
        schedule,
        curves: state.responses()?,
        variant,
    })
}

/// Returns the engineer's choices for the curves, which are the same in the window and in figures
/// on paper. Options without a choice in the window keep their defaults.
pub(in crate::gui) fn bode_options(state: &State) -> BodeOptions {
    let display = &state.display;
    let curves = &display.curves;
    let isolated = match &display.selection.isolated {
        Some(model) if model.condition == state.condition().id() => Some(model.clone()),
        _ => None,
    };
    let zeros_of = if display.poles.show_zeros {
        Some(display.selection.pair)
    } else {
        None
    };
    BodeOptions {
        unit: curves.unit,
        magnitude: curves.magnitude,
        phase: curves.phase,
        phase_error: curves.phase_error,
        turns: curves.turns.clone(),
        shows_muad: curves.shows_muad,
        crossings: curves.crossings.clone(),
        zeros_of,
        hidden: curves.hidden_roles.clone(),
        hidden_models: curves.hidden_models.clone(),
        isolated,
        ..BodeOptions::default()
    }
}

/// Returns all curves for a response in the displayed condition, with the engineer's options; empty
/// until the responses are available.
///
/// Every cache keeps the responses of its condition in memory, and is checked only when its own
/// curves are drawn. The caches for all pairs are therefore dropped here if they belong to other
/// responses than the displayed condition's. [`plain_curves`] leaves this to the next Bode plot;
/// [`error_curves`] has a single cache for all pairs.
pub(in crate::gui) fn bode_curves(state: &mut State, pair: Pair) -> Vec<BodeCurve> {
    let responses = state.responses().map(Arc::clone);
    state.display.frequency.keep_shapes_of(responses.as_ref());
    let options = bode_options(state);
    let curves = response_curves(state, pair, &options);
    with_interaction(state, curves, None)
}

/// Returns all curves for a response in the displayed condition with continuous phases, whatever
/// the engineer has hidden, isolated or shifted: for comparison with an identification from
/// records. Empty until the responses are available.
pub(super) fn plain_curves(state: &mut State, pair: Pair) -> Vec<BodeCurve> {
    response_curves(state, pair, &BodeOptions::default())
}

/// Returns a response's curves, made with the cached shapes for that response.
fn response_curves(state: &mut State, pair: Pair, options: &BodeOptions) -> Vec<BodeCurve> {
    with_cache(
        state,
        |plots| plots.shapes.entry(pair).or_default(),
        |source, cache| source.response_curves(pair, options, cache),
    )
}

/// Returns a response's error curves in the displayed condition, for drawing and for fitting the
/// axes; empty until the responses are available.
pub(super) fn error_curves(state: &mut State, pair: Pair, options: &BodeOptions) -> Vec<BodeCurve> {
    let curves = with_cache(
        state,
        |plots| &mut plots.errors,
        |source, cache| source.error_curves(pair, options, cache),
    );
    let reference = error_reference(&curves);
    with_interaction(state, curves, reference.as_ref())
}

/// Makes curves from the displayed condition's data, with a cache in the frequency plots; empty
/// until the responses are available.
fn with_cache<C: Default>(
    state: &mut State,
    cache_in: impl Fn(&mut FrequencyPlots) -> &mut C,
    curves_from: impl FnOnce(&ConditionSource<'_>, &mut C) -> Vec<BodeCurve>,
) -> Vec<BodeCurve> {
    // The source borrows the whole state: the cache is taken out of it, and put back afterwards.
    let mut cache = mem::take(cache_in(&mut state.display.frequency));
    let curves = match condition_source(state) {
        Some(source) => curves_from(&source, &mut cache),
        None => Vec::new(),
    };
    *cache_in(&mut state.display.frequency) = cache;
    curves
}

/// Returns the identified model among the error curves: its error is zero everywhere, and the other
/// curves are compared with it.
pub(super) fn error_reference(curves: &[BodeCurve]) -> Option<CurveId> {
    for curve in curves {
        if let CurveId::Model(id) = &curve.id
            && id.bundle == BundleKind::Identified
        {
            return Some(curve.id.clone());
        }
    }
    None
}

/// Adds the parts that depend on the pointer and on running computations: for each model its
/// highlight and the effect of a click on it; for the scheduled curve a label, if the schedule
/// belongs to older settings than the condition's result. `reference` is the model with which error
/// curves are compared; it cannot be rejected.
fn with_interaction(
    state: &State,
    mut curves: Vec<BodeCurve>,
    reference: Option<&CurveId>,
) -> Vec<BodeCurve> {
    for curve in &mut curves {
        if curve.id == CurveId::Scheduled && state.others_are_older() {
            curve.label.push_str(" from older settings");
        }
        if let CurveId::Model(id) = curve.id.clone() {
            let is_reference = reference == Some(&curve.id);
            curve.highlighted = is_highlighted(state, &id, is_reference);
            add_click_note(curve, is_reference);
        }
    }
    curves
}

/// Returns whether a model is under the pointer or in the selection box. The selection is for
/// rejecting models, so the reference is never highlighted as selected.
fn is_highlighted(state: &State, id: &ModelId, is_reference: bool) -> bool {
    let is_hovered = state.display.selection.hovered.as_ref() == Some(id);
    let is_selected = state.display.curves.selected.contains(id);
    is_hovered || (is_selected && !is_reference)
}

/// Adds the effect of a click to a model's description; for the reference, its role instead.
fn add_click_note(curve: &mut BodeCurve, is_reference: bool) {
    let note = if is_reference {
        "reference for the errors"
    } else if curve.rejected {
        "click to restore"
    } else {
        "click to reject"
    };
    if !curve.detail.is_empty() {
        curve.detail.push_str(" · ");
    }
    curve.detail.push_str(note);
}
