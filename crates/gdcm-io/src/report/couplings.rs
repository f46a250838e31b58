//! Report section on the meaning, benefit and cost of couplings in the physics models (M16).

use gdcm_model::progress::{Cancelled, Progress};
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::poles::couplings_figure;
use gdcm_study::results::analysis::Analysis;
use gdcm_study::results::coupling_remark_search::analysis_coupling_remarks;
use gdcm_study::stages::engine::Engine;
use gdcm_words::coupling_remark::coupling_remark_text;
use gdcm_words::couplings::{
    coupling_cost_table, coupling_matrix_tables, couplings_heading, pole_table,
};

use super::CancellationOnly;
use super::page::Page;
use super::wording::capital;

/// Maximum number of matrix columns that fit on a page.
const MATRIX_COLUMNS: usize = 8;

/// Returns the analysis with its couplings assessed, computing the assessment if missing; unchanged
/// if no couplings were fitted.
///
/// # Errors
/// [`Cancelled`] soon after `progress` requests it.
pub(super) fn with_couplings(
    analysis: Analysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<Analysis, Cancelled> {
    if analysis.coupling_assessment.is_some() || analysis.fitted_couplings().is_none() {
        return Ok(analysis);
    }
    let study = &analysis.study;
    let assessed =
        engine.assess_couplings(study, study.settings.couplings, &CancellationOnly(progress))?;
    Ok(Analysis {
        coupling_assessment: assessed.and_then(Result::ok),
        ..analysis
    })
}

/// Adds the section on couplings, if they are requested; only the reason if they are unavailable.
pub(super) fn add_couplings(page: &mut Page, analysis: &Analysis) {
    if analysis.couplings.is_none() {
        return;
    }
    page.section("Couplings");
    if analysis.fitted_couplings().is_some() {
        page.paragraph(
            "A mixing of the inputs and, if requested, a feedback of outputs to inputs, common to \
            all conditions, correct each physics model before the channels are corrected. The \
            representatives, G, D, gains, delays, leads and J in this report are based on the \
            physics models with these couplings. The choice of the representative of a bundle and \
            the suggested outliers are determined without them.",
        );
    }
    let remarks = analysis_coupling_remarks(analysis).into_iter();
    page.list(remarks.map(|remark| coupling_remark_text(&remark, &analysis.study.dataset)));
    let Some(assessment) = &analysis.coupling_assessment else {
        return;
    };
    page.paragraph(&format!("{}.", capital(&couplings_heading(assessment))));
    page.table(&coupling_cost_table(assessment));
    for table in coupling_matrix_tables(assessment, &analysis.study.dataset) {
        page.wide_table(&table, MATRIX_COLUMNS);
    }
    page.table(&pole_table(assessment));
    if let Some(figure) = couplings_figure(assessment, None, FrequencyUnit::default()) {
        let caption = "Minimum singular value of I \u{2212} K H at the sticks in each condition (K: feedback, \
        H: physics representative): \
            1 means that there is no loop; below 0.5 the loop is close to ringing. Poles of the \
            condition with the smallest value.";
        page.figure(&figure, &figure.title, caption);
    }
}
