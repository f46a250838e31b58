//! Curves over frequency in the displayed condition, with their options and their source.

use std::sync::Arc;

use gdcm_model::dataset::{BundleKind, Pair};
use gdcm_plot::figure::ConditionSource;
use gdcm_plot::figure::bode::BodeOptions;

use super::variant_analyses::overlaid_analysis;
use crate::gui::plot::{BodeCurve, CurveId};
use crate::gui::state::window_state::State;

/// Returns the data from which all curves in the displayed condition are made; `None` until its
/// responses are available.
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
        curves: state.curves()?,
        variant,
    })
}

/// Returns the curve options, which are the same in the window and on paper.
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

/// Returns all curves for a response in the displayed condition, from a cache for each response
/// that lasts as long as the responses are the same; empty until they are available.
pub(in crate::gui) fn bode_curves(state: &mut State, pair: Pair) -> Vec<BodeCurve> {
    let shown = state.curves().map(Arc::clone);
    state.display.frequency.keep_shapes_of(shown.as_ref());
    let mut cache = state
        .display
        .frequency
        .shapes
        .remove(&pair)
        .unwrap_or_default();
    let options = bode_options(state);
    let curves = match condition_source(state) {
        Some(source) => source.response_curves(pair, &options, &mut cache),
        None => Vec::new(),
    };
    let drawn = with_interaction(state, curves, None);
    state.display.frequency.shapes.insert(pair, cache);
    drawn
}

/// Returns all curves for a response in the displayed condition with unwrapped phases, whatever the
/// engineer has hidden, isolated or shifted: for comparison with an identification from records.
/// Empty until its responses are available.
pub(super) fn plain_curves(state: &mut State, pair: Pair) -> Vec<BodeCurve> {
    let mut cache = state
        .display
        .frequency
        .shapes
        .remove(&pair)
        .unwrap_or_default();
    let curves = match condition_source(state) {
        Some(source) => source.response_curves(pair, &BodeOptions::default(), &mut cache),
        None => Vec::new(),
    };
    state.display.frequency.shapes.insert(pair, cache);
    curves
}

/// Returns a response's error curves in the displayed condition, as used by the axis fit; empty
/// until the responses are available.
pub(super) fn error_curves(state: &mut State, pair: Pair, options: &BodeOptions) -> Vec<BodeCurve> {
    let mut cache = std::mem::take(&mut state.display.frequency.errors);
    let curves = match condition_source(state) {
        Some(source) => source.error_curves(pair, options, &mut cache),
        None => Vec::new(),
    };
    let reference = error_reference(&curves);
    let drawn = with_interaction(state, curves, reference.as_ref());
    state.display.frequency.errors = cache;
    drawn
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

/// Emphasises the models under the pointer and in the selection box, tells in each model's
/// description what a click does, and marks a scheduled curve from older settings. `reference` is
/// the model with which error curves are compared: it cannot be rejected.
fn with_interaction(
    state: &State,
    mut curves: Vec<BodeCurve>,
    reference: Option<&CurveId>,
) -> Vec<BodeCurve> {
    for curve in &mut curves {
        if curve.id == CurveId::Scheduled && state.others_are_older() {
            curve.label.push_str(" from older settings");
        }
        let CurveId::Model(id) = &curve.id else {
            continue;
        };
        let is_reference = reference == Some(&curve.id);
        let is_hovered = state.display.selection.hovered.as_ref() == Some(id);
        let is_selected = state.display.curves.selected.contains(id);
        // The selection is for rejecting models, so the reference is not highlighted as selected.
        curve.highlighted = is_hovered || (is_selected && !is_reference);
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
    curves
}
