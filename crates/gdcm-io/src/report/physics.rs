//! Report section on the named physics parameters: verdict, table, benefit (M18).
//!
//! The *diagnosis* names the parameters that are wrong, with their probable changes; the section
//! then gives the changes applied in this report, and their benefit in J. A *rerun* is a physics
//! model with several parameters moved together, which checks the predicted effect.

use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::results::analysis::Analysis;
use gdcm_study::stages::engine::Engine;
use gdcm_words::physics::{
    BARS_KEEP_VALUES, applied_value_list, channel_delay_table, diagnosis_cautions, left_out_lines,
    parameter_table, physics_cost_table, rerun_text, verdict_text,
};

use super::CancellationOnly;
use super::page::Page;
use super::wording::capital;

/// Maximum number of columns of the parameter table that fit on a page.
const TABLE_COLUMNS: usize = 8;

/// Returns the analysis with its physics parameters assessed, computing the assessment if missing;
/// unchanged if none are applied.
///
/// # Errors
/// [`Cancelled`] soon after `progress` requests it.
pub(super) fn with_physics(
    analysis: Analysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<Analysis, Cancelled> {
    if analysis.physics_assessment.is_some() || analysis.applied_physics().is_none() {
        return Ok(analysis);
    }
    let study = &analysis.study;
    let assessed =
        engine.assess_physics(study, study.settings.physics, &CancellationOnly(progress))?;
    Ok(Analysis {
        physics_assessment: assessed.and_then(Result::ok),
        ..analysis
    })
}

/// Adds the section on physics parameters, if they are requested.
pub(super) fn add_physics(page: &mut Page, analysis: &Analysis) {
    let applied = match &analysis.physics {
        None => return,
        Some(Err(failure)) => {
            page.section("Physics parameters");
            page.paragraph(&format!("{}.", capital(&failure.to_string())));
            if let Some(left_out) = failure.left_out() {
                page.list(left_out_lines(left_out));
            }
            return;
        }
        Some(Ok(applied)) => applied,
    };
    page.section("Physics parameters");
    if let Some(findings) = &applied.findings {
        page.paragraph(&verdict_text(findings));
        let level = analysis.study.settings.uncertainty.level;
        page.wide_table(&parameter_table(findings, level), TABLE_COLUMNS);
        let mut lines = diagnosis_cautions(findings);
        lines.extend(left_out_lines(&findings.left_out));
        page.list(lines);
    }
    let values = applied_value_list(applied);
    if values.is_empty() {
        page.paragraph("No parameter is changed: the physics models are those of the dataset.");
    } else {
        page.paragraph(&format!(
            "In this report the physics models have these parameter changes: {}. Couplings, G, D, gains, \
            delays, leads and J are based on the changed models. The choice of the representative of a bundle and the suggested \
            outliers are determined without them. {}.",
            values.join(", "),
            capital(BARS_KEEP_VALUES)
        ));
    }
    let Some(assessment) = &analysis.physics_assessment else {
        return;
    };
    page.table(&physics_cost_table(assessment));
    let (inputs, outputs) = analysis.study.dataset.input_and_output_names();
    page.table(&channel_delay_table(assessment, &inputs, &outputs));
    page.list(assessment.reruns.iter().map(rerun_text));
}
