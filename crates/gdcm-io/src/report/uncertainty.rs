//! Report section on the uncertainty of the results (M13).
//!
//! A *bar* is a result's confidence interval, from the spread over the kept physics models (trim)
//! and over the identified models (identification). The *evidence* is how much of the scatter of
//! net gains between conditions both components explain.

use std::sync::Arc;

use gdcm_model::dataset::Pair;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_plot::figure::assessment::{evidence_figure, usual_choice};
use gdcm_study::results::analysis::Analysis;
use gdcm_study::stages::engine::Engine;
use gdcm_words::assessment::held_out_verdict;
use gdcm_words::uncertainty::{
    bar_table, difference_table, difference_text, differences_summary, scatter_table,
    second_variable_table,
};

use super::CancellationOnly;
use super::limits::PAIRS_DRAWN;
use super::page::Page;

/// Maximum number of responses per row in the evidence figure.
const EVIDENCE_COLUMNS: usize = 8;

/// Returns the analysis with confidence intervals, which are computed if missing.
///
/// # Errors
/// [`Cancelled`] soon after `progress` requests it.
pub(super) fn with_bars(
    analysis: &Analysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<Analysis, Cancelled> {
    let uncertainty = match &analysis.uncertainty {
        Some(uncertainty) => Arc::clone(uncertainty),
        None => Arc::new(engine.uncertainty(analysis, &CancellationOnly(progress))?),
    };
    Ok(Analysis {
        uncertainty: Some(uncertainty),
        ..analysis.clone()
    })
}

/// Adds the section on uncertainty; nothing if confidence intervals are not available.
pub(super) fn add_uncertainty(page: &mut Page, analysis: &Analysis) {
    let Some(uncertainty) = &analysis.uncertainty else {
        return;
    };
    let dataset = &analysis.study.dataset;
    page.section("Uncertainty");
    page.paragraph(
        "Each result is computed again with every other kept physics model, then with every other \
        identified model, instead of the representative. The rms change due to the physics \
        models is the trim uncertainty; the rms change due to the identified models, averaged \
        with the other conditions, is the identification uncertainty. The half-width of a bar is \
        Student's t times the root of the sum of their squares (M13). Differences that neither \
        of them explains are a physical effect or a model-form error. An error common to all \
        identified models is not detected, and a bar is not a bound.",
    );
    page.paragraph(&differences_summary(uncertainty));
    let mut significant = Vec::new();
    for difference in &uncertainty.differences {
        if difference.is_significant(uncertainty.level) {
            significant.push(format!(
                "{}: {}.",
                dataset.pair_name(difference.pair),
                difference_text(difference, uncertainty.level)
            ));
        }
    }
    page.list(significant);
    let pairs: Vec<Pair> = dataset
        .measuring_pairs()
        .marked()
        .take(PAIRS_DRAWN)
        .collect();
    if let Some(figure) = evidence_figure(analysis, &pairs) {
        let caption = "Shares of the variance, and standard deviations of ln k_o k_i, about the \
            mean of each airspeed and about the schedule; above the bars, the ratio of the \
            scatter to the expected scatter.";
        let columns = figure.plots.len().min(EVIDENCE_COLUMNS);
        let title = figure.title.clone();
        page.figure(&figure.columns(columns), &title, caption);
    }
    page.table(&scatter_table(dataset, uncertainty));
    if let Some(words) = held_out_verdict(analysis, usual_choice(analysis)) {
        page.paragraph(&format!("Conditions {words}."));
    }
}

/// Adds the appendix with the differences at equal airspeed, the need for a second variable, and
/// every condition's error bars; nothing if confidence intervals are not available.
pub(super) fn add_uncertainty_details(page: &mut Page, analysis: &Analysis) {
    let Some(uncertainty) = &analysis.uncertainty else {
        return;
    };
    let dataset = &analysis.study.dataset;
    page.appendix("Details of the uncertainty");
    let (differences, _) = difference_table(dataset, uncertainty);
    page.table(&differences);
    page.table(&second_variable_table(dataset, uncertainty));
    page.table(&bar_table(analysis, uncertainty));
}
