//! The plots of one condition.

use std::collections::BTreeSet;

use crate::figure::{
    BodeOptions, ConditionSource, Figure, Mark, Role, bode_figure, error_figure, overview_figure, poles_figure,
};
use gdcm_core::dataset::Pair;
use gdcm_core::study::ConditionAnalysis;

use super::extent::{PAIRS_DRAWN, models_hidden};
use super::page::Page;

/// Responses side by side in one figure, in two rows at most.
const IN_A_FIGURE: usize = 10;

/// Adds the responses that matter, what the fit sees of them, every response, and the poles.
pub(super) fn add_plots(page: &mut Page, result: &ConditionAnalysis, source: &ConditionSource<'_>) {
    let id = source.curves.condition.id();
    let measuring: Vec<Pair> = source.study.dataset.measuring_pairs().marked().collect();
    let drawn = &measuring[..measuring.len().min(PAIRS_DRAWN)];
    let options = BodeOptions { hidden_models: models_hidden(source.study, result), ..BodeOptions::default() };
    for pairs in drawn.chunks(IN_A_FIGURE) {
        let title = format!("Condition {id}, responses{}", on_axis_words(source));
        let caption = "Magnitude and phase of every model, and of the representative under its own and under the scheduled \
                       correction.";
        page.figure(&bode_figure(source, pairs, &options), &title, caption);
        let title = format!("Condition {id}, what the fit sees of them");
        let caption = "Ratio and phase difference of the identified representative and each kept physics model, with G, D, the \
                       bounds and the quantiles.";
        page.figure(&without_values(error_figure(source, pairs, &options)), &title, caption);
    }
    if drawn.len() < measuring.len() {
        page.paragraph(&format!("{} of {} responses that measure a model are drawn.", drawn.len(), measuring.len()));
    }
    let few = BTreeSet::from([Role::Perturbed, Role::Identified, Role::Rejected]);
    let overview = overview_figure(source, &BodeOptions { hidden: few, ..options.clone() });
    if overview.plots.len() <= 6 * IN_A_FIGURE {
        let title = format!("Condition {id}, magnitude of every response");
        page.figure(&overview, &title, "With J before and after the correction; * is held exactly.");
    }
    if let Some(poles) = poles_figure(source, &options) {
        let title = format!("Condition {id}, poles of its models");
        page.figure(
            &poles,
            &title,
            "Physics models ×, identified ones +; rays of equal damping ratio. A correction moves no pole.",
        );
    }
}

/// Lines across narrow frames with their names alone ("G", "UB"): what they are at stands in the tables.
fn without_values(mut figure: Figure) -> Figure {
    let panels = figure.plots.iter_mut().flat_map(|plot| &mut plot.panels);
    for mark in panels.flat_map(|panel| &mut panel.marks) {
        if let Mark::Rule(rule) = mark {
            rule.label = rule.label.split(' ').next().unwrap_or_default().to_owned();
        }
    }
    figure
}

/// " on axis" where some responses are; all of them measure a model otherwise.
fn on_axis_words(source: &ConditionSource<'_>) -> &'static str {
    if source.study.dataset.on_axis().marked().next().is_some() { " on axis" } else { "" }
}
