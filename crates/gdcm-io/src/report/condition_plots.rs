//! A condition's plots in the report. Its *representatives*, one physics and one identified model,
//! are compared (M5); the corrected responses are those of the physics representative. G and D are
//! the gain and the delay that a response needs (M6). The *measuring* responses are the on-axis
//! responses, or all responses if none is on-axis.

use std::collections::BTreeSet;
use std::sync::Arc;

use gdcm_model::dataset::Pair;
use gdcm_model::progress::{Cancelled, Progress, Unobserved};
use gdcm_plot::figure::bode::{BodeOptions, bode_figure, overview_figure};
use gdcm_plot::figure::caption_words::condition_words;
use gdcm_plot::figure::error::error_figure;
use gdcm_plot::figure::poles::{PoleContents, poles_figure};
use gdcm_plot::figure::{ConditionSource, Figure, Mark, Role};
use gdcm_study::jobs::curve_jobs::ConditionModes;
use gdcm_study::stages::condition_curves::{CURVE_POINTS, ConditionCurves, curves_band};
use gdcm_study::{Analysis, ConditionAnalysis, Engine};

use super::limits::PAIRS_DRAWN;
use super::page::Page;
use super::shown_models::models_hidden;

/// Maximum number of responses per figure, in one row.
const PAIRS_IN_A_FIGURE: usize = 6;
/// Maximum number of plots per figure row.
const PLOTS_IN_A_ROW: usize = PAIRS_IN_A_FIGURE;
/// Maximum number of responses in the overview, which shows only magnitudes.
const PAIRS_IN_OVERVIEW: usize = 60;
/// Maximum number of plots per row of the overview; a row shows whole outputs, at least one.
const OVERVIEW_PLOTS_IN_A_ROW: usize = 10;

/// Adds Bode plots for the measuring responses.
pub(super) fn add_response_plots(
    page: &mut Page,
    analysis: &Analysis,
    result: &ConditionAnalysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<(), Cancelled> {
    if let Some(curves) = curves(analysis, result, engine, progress)? {
        let source = source(analysis, result, &curves);
        let options = options(&source, result);
        let title = condition_words(result.condition.flight_state());
        for pairs in drawn_pairs(&source).chunks(PAIRS_IN_A_FIGURE) {
            let figure = bode_figure(&source, pairs, &options);
            page.figure(&figure.columns(PLOTS_IN_A_ROW), &title, "");
        }
        add_number_drawn(page, &source);
    }
    Ok(())
}

/// Computes a condition's curves and adds its other plots: ratios and phase differences for the
/// measuring responses, an overview of all responses, and the poles.
pub(super) fn add_condition_plots(
    page: &mut Page,
    analysis: &Analysis,
    result: &ConditionAnalysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<(), Cancelled> {
    if let Some(curves) = curves(analysis, result, engine, progress)? {
        let source = source(analysis, result, &curves);
        let options = options(&source, result);
        add_error_plots(page, &source, &options);
        add_overview(page, &source, &options);
        add_poles(page, &source, &options);
    }
    Ok(())
}

/// Computes a condition's curves; `None` if the dataset lacks the condition.
fn curves(
    analysis: &Analysis,
    result: &ConditionAnalysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<Option<Arc<ConditionCurves>>, Cancelled> {
    let study = &analysis.study;
    let grid = (curves_band(&study.settings), CURVE_POINTS);
    engine.curves(&study.dataset, result.condition.id(), grid, progress)
}

fn source<'a>(
    analysis: &'a Analysis,
    result: &'a ConditionAnalysis,
    curves: &'a Arc<ConditionCurves>,
) -> ConditionSource<'a> {
    ConditionSource {
        study: &analysis.study,
        analysis: Some(result),
        schedule: analysis.schedule.as_ref().ok(),
        curves,
        variant: None,
    }
}

fn options(source: &ConditionSource<'_>, result: &ConditionAnalysis) -> BodeOptions {
    BodeOptions {
        hidden_models: models_hidden(source.study, result),
        ..BodeOptions::default()
    }
}

/// Returns the measuring responses, at most [`PAIRS_DRAWN`].
fn drawn_pairs(source: &ConditionSource<'_>) -> Vec<Pair> {
    let measuring = source.study.dataset.measuring_pairs();
    measuring.marked().take(PAIRS_DRAWN).collect()
}

/// Adds a sentence if there are more measuring responses than are drawn.
fn add_number_drawn(page: &mut Page, source: &ConditionSource<'_>) {
    let measuring = source.study.dataset.measuring_pairs().marked().count();
    if measuring > PAIRS_DRAWN {
        let has_on_axis = source.study.dataset.on_axis().marked().next().is_some();
        let noun = if has_on_axis {
            "on-axis responses"
        } else {
            "responses"
        };
        page.paragraph(&format!("{PAIRS_DRAWN} of {measuring} {noun} are drawn."));
    }
}

/// Plots ratio and phase difference between the identified representative and the physics models,
/// for the measuring responses.
fn add_error_plots(page: &mut Page, source: &ConditionSource<'_>, options: &BodeOptions) {
    let id = source.curves.condition.id();
    for pairs in drawn_pairs(source).chunks(PAIRS_IN_A_FIGURE) {
        let title = format!("Condition {id}, difference between identified and physics models");
        let caption = "Identified representative against the listed physics models, with G, D, \
            bounds and quantiles.";
        let figure = without_values(error_figure(source, pairs, options));
        page.figure(&figure.columns(PLOTS_IN_A_ROW), &title, caption);
    }
}

/// Plots the magnitudes of all responses, unless there are too many for a figure.
fn add_overview(page: &mut Page, source: &ConditionSource<'_>, options: &BodeOptions) {
    let without_bundles = BodeOptions {
        hidden: BTreeSet::from([Role::Perturbed, Role::Identified, Role::Rejected]),
        ..options.clone()
    };
    let inputs = source.study.dataset.inputs().len().max(1);
    let outputs_in_a_row = (OVERVIEW_PLOTS_IN_A_ROW / inputs).max(1);
    let overview = overview_figure(source, &without_bundles).columns(inputs * outputs_in_a_row);
    if overview.plots.len() <= PAIRS_IN_OVERVIEW {
        let id = source.curves.condition.id();
        page.figure(
            &overview,
            &format!("Condition {id}, magnitude of every response"),
            "With J before and after the correction; * marks held responses.",
        );
    }
}

/// Plots the model poles, with their shifts due to couplings; nothing if the poles cannot be
/// computed.
fn add_poles(page: &mut Page, source: &ConditionSource<'_>, options: &BodeOptions) {
    let Ok(modes) = ConditionModes::compute(&source.curves.condition, &Unobserved) else {
        return;
    };
    let shifts = match source.analysis {
        Some(result) => result.pole_shifts(),
        None => Default::default(),
    };
    let contents = PoleContents {
        modes: &modes,
        zeros_of: &|_| Vec::new(),
        shifts: &shifts,
    };
    let id = source.curves.condition.id();
    page.figure(
        &poles_figure(source, contents, options),
        &format!("Condition {id}, poles of its models"),
        "Physics models ×, identified models +; rays of equal damping ratio. Couplings move \
        poles, corrections of channels do not.",
    );
}

/// Reduces line labels to their names ("G", "UB") for narrow frames: the tables give the values.
fn without_values(mut figure: Figure) -> Figure {
    let panels = figure.plots.iter_mut().flat_map(|plot| &mut plot.panels);
    for mark in panels.flat_map(|panel| &mut panel.marks) {
        if let Mark::Rule(rule) = mark {
            rule.label = rule.label.split(' ').next().unwrap_or_default().to_owned();
        }
    }
    figure
}
