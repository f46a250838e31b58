//! The couplings of the physics models: what they mean, are worth and cost (M16).

use gdcm_core::study::{Analysis, Cancelled, Engine, Progress};

use crate::figure::{FrequencyUnit, couplings_figure};

use super::Unobtrusive;
use super::page::Page;

/// Columns of a matrix that fit a sheet.
const COLUMNS: usize = 8;

/// The analysis with what its couplings are worth, where it has any.
///
/// # Errors
/// [`Cancelled`] soon after `progress` says so.
pub(super) fn with_couplings(
    analysis: Analysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<Analysis, Cancelled> {
    if analysis.coupling_assessment.is_some() || analysis.fitted_couplings().is_none() {
        return Ok(analysis);
    }
    let study = &analysis.study;
    let assessed = engine.assess_couplings(study, study.settings.couplings, &Unobtrusive(progress))?;
    Ok(Analysis { coupling_assessment: assessed.and_then(Result::ok), ..analysis })
}

/// Adds the section, where couplings are asked for.
pub(super) fn add_couplings(page: &mut Page, analysis: &Analysis) {
    if analysis.couplings.is_none() {
        return;
    }
    page.section("Couplings");
    page.paragraph(
        "One mixing of the inputs and, where asked for, one feedback of outputs to inputs, the same for all conditions, stand before the \
         corrections of the channels: what representatives, G, D, gains, delays, leads and J of this report are found on is the physics \
         model with them. Which model represents its bundle, and which is suspected, is decided without them.",
    );
    page.list(analysis.coupling_remarks().into_iter().map(|remark| remark.text));
    let Some(assessment) = &analysis.coupling_assessment else { return };
    page.paragraph(&format!("{}.", super::assessment::capital(&assessment.heading())));
    page.table(&assessment.cost_table());
    assessment.matrix_tables(&analysis.study.dataset).iter().for_each(|table| page.wide_table(table, COLUMNS));
    page.table(&assessment.pole_table());
    if let Some(figure) = couplings_figure(assessment, None, FrequencyUnit::default()) {
        let caption = "The least singular value of I \u{2212} K H at the sticks, of each condition: 1 is no loop, under 0.5 the loop is close \
                       to ringing. Poles of the condition that is nearest to it.";
        page.figure(&figure, &figure.title, caption);
    }
}
