//! Plots of a condition in the report.

use std::collections::BTreeSet;

use gdcm_model::dataset::Pair;
use gdcm_model::progress::{Cancelled, Progress, Unobserved};
use gdcm_plot::figure::bode::{BodeOptions, bode_figure, overview_figure};
use gdcm_plot::figure::error::error_figure;
use gdcm_plot::figure::poles::{PoleContents, poles_figure};
use gdcm_plot::figure::{ConditionSource, Figure, Mark, Role};
use gdcm_study::jobs::curve_jobs::ConditionModes;
use gdcm_study::stages::condition_curves::{CURVE_POINTS, curves_band};
use gdcm_study::{Analysis, ConditionAnalysis, Engine};

use super::limits::PAIRS_DRAWN;
use super::page::Page;
use super::shown_models::models_hidden;

/// Computes the curves of a condition and adds its plots.
pub(super) fn add_condition_plots(
    page: &mut Page,
    analysis: &Analysis,
    result: &ConditionAnalysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<(), Cancelled> {
    let study = &analysis.study;
    let grid = (curves_band(&study.settings), CURVE_POINTS);
    let curves = engine.curves(&study.dataset, result.condition.id(), grid, progress)?;
    if let Some(curves) = curves {
        let source = ConditionSource {
            study,
            analysis: Some(result),
            schedule: analysis.schedule.as_ref().ok(),
            curves: &curves,
            variant: None,
        };
        add_plots(page, result, &source);
    }
    Ok(())
}

/// Maximum number of responses in a figure, in at most two rows.
const PAIRS_IN_A_FIGURE: usize = 10;
/// Maximum number of responses in the overview, which shows magnitudes alone.
const PAIRS_IN_OVERVIEW: usize = 6 * PAIRS_IN_A_FIGURE;

/// Adds the plots of a condition: the responses in the objective, their ratios and phase
/// differences, an overview of all responses, and the poles.
fn add_plots(page: &mut Page, result: &ConditionAnalysis, source: &ConditionSource<'_>) {
    let options = BodeOptions {
        hidden_models: models_hidden(source.study, result),
        ..BodeOptions::default()
    };
    add_response_plots(page, source, &options);
    add_overview(page, source, &options);
    add_poles(page, source, &options);
}

/// Adds Bode plots of the responses in the objective (on-axis; all if none is on-axis), and plots
/// of ratio and phase difference between the identified representative and the physics models.
fn add_response_plots(page: &mut Page, source: &ConditionSource<'_>, options: &BodeOptions) {
    let id = source.curves.condition.id();
    let measuring: Vec<Pair> = source.study.dataset.measuring_pairs().marked().collect();
    let drawn = &measuring[..measuring.len().min(PAIRS_DRAWN)];
    for pairs in drawn.chunks(PAIRS_IN_A_FIGURE) {
        let title = format!("Condition {id}, responses{}", on_axis_words(source));
        let caption = "Magnitude and phase of every model, and of the representative under its own and under the scheduled \
                       correction.";
        page.figure(&bode_figure(source, pairs, options), &title, caption);
        let title = format!("Condition {id}, difference between identified and physics models");
        let caption = "Ratio and phase difference of the identified representative and each kept physics model, with G, D, the \
                       bounds and the quantiles.";
        let figure = without_values(error_figure(source, pairs, options));
        page.figure(&figure, &title, caption);
    }
    if drawn.len() < measuring.len() {
        page.paragraph(&format!(
            "{} of {} responses in the objective are drawn.",
            drawn.len(),
            measuring.len()
        ));
    }
}

/// Adds a plot of the magnitudes of all responses, unless there are too many for a figure.
fn add_overview(page: &mut Page, source: &ConditionSource<'_>, options: &BodeOptions) {
    let without_bundles = BodeOptions {
        hidden: BTreeSet::from([Role::Perturbed, Role::Identified, Role::Rejected]),
        ..options.clone()
    };
    let overview = overview_figure(source, &without_bundles);
    if overview.plots.len() <= PAIRS_IN_OVERVIEW {
        let id = source.curves.condition.id();
        page.figure(
            &overview,
            &format!("Condition {id}, magnitude of every response"),
            "With J before and after the correction; * marks held responses.",
        );
    }
}

/// Adds a plot of the model poles, with their shifts due to couplings.
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
        "Physics models ×, identified models +; rays of equal damping ratio. Corrections of \
        channels do not move poles; couplings do.",
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

/// Returns " on axis" if the dataset marks on-axis responses. Otherwise all responses enter the
/// objective, and the words are empty.
fn on_axis_words(source: &ConditionSource<'_>) -> &'static str {
    if source.study.dataset.on_axis().marked().next().is_some() {
        " on axis"
    } else {
        ""
    }
}
