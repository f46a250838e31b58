//! How sure the figures are (M13).

use std::sync::Arc;

use crate::figure::evidence_figure;
use gdcm_core::dataset::Pair;
use gdcm_core::study::{
    Analysis, Cancelled, Engine, Progress, bar_table, difference_table, held_out_verdict, scatter_table,
    second_variable_table,
};

use super::assessment::usual_choice;
use super::extent::PAIRS_DRAWN;
use super::page::Page;

/// The analysis with how sure its figures are.
///
/// # Errors
/// [`Cancelled`] soon after `progress` says so.
pub(super) fn with_bars(
    analysis: &Analysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<Analysis, Cancelled> {
    let uncertainty = match &analysis.uncertainty {
        Some(uncertainty) => Arc::clone(uncertainty),
        None => Arc::new(engine.uncertainty(analysis, &OnlyStops(progress))?),
    };
    Ok(Analysis { uncertainty: Some(uncertainty), ..analysis.clone() })
}

/// Adds the section, where bars are there.
pub(super) fn add(page: &mut Page, analysis: &Analysis) {
    let Some(uncertainty) = &analysis.uncertainty else { return };
    let dataset = &analysis.study.dataset;
    page.section("How sure each number is");
    page.paragraph(
        "Each figure is computed again with every other kept physics model, then with every other identified model, in place of the \
         representative. The rms change of the first is its trim part, of the second, averaged with that of the other conditions, its \
         identification part; the bar is Student's t times the root of the sum of squares (M13). What neither bundle makes is rest: \
         real, or model form. An error common to all identified models is not seen, and a bar is not a bound.",
    );
    let beyond: Vec<_> = uncertainty.differences.iter().filter(|of| of.is_significant(uncertainty.level)).collect();
    page.paragraph(&uncertainty.differences_in_words());
    page.list(beyond.iter().map(|of| format!("{}: {}.", dataset.pair_name(of.pair), of.words(uncertainty.level))));
    let pairs: Vec<Pair> = dataset.measuring_pairs().marked().take(PAIRS_DRAWN).collect();
    if let Some(figure) = evidence_figure(analysis, &pairs) {
        let caption = "Shares of the variance, and standard deviations of ln k_o k_i, about the mean of each airspeed and about the \
                       schedule; above the bars, scatter, times what the bundles explain.";
        page.figure(&figure, &figure.title, caption);
    }
    page.table(&scatter_table(dataset, uncertainty));
    page.table(&difference_table(dataset, uncertainty).0);
    page.table(&second_variable_table(dataset, uncertainty));
    page.table(&bar_table(analysis, uncertainty));
    if let Some(words) = held_out_verdict(analysis, usual_choice(analysis)) {
        page.paragraph(&format!("Conditions {words}."));
    }
}

/// Tells only whether the report is still wanted: its steps are the conditions drawn.
struct OnlyStops<'a>(&'a dyn Progress);

impl Progress for OnlyStops<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }

    fn advanced(&self, _done: usize, _total: usize) {}
}
