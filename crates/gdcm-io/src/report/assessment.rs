//! Report sections on the benefit of the scheduled correction, on the uncertainty of the results
//! (M13), and on the meaning, benefit and cost of couplings in the physics models (M16).

use std::sync::Arc;

use gdcm_method::fidelity::ACCEPTABLE;
use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::{ConditionId, Pair, PairTable};
use gdcm_model::number_format::decimals;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::units::signed;
use gdcm_plot::figure::assessment::{
    assessment_figure, average_word, change_table, evidence_figure, usual_choice,
};
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::poles::couplings_figure;
use gdcm_study::results::analysis::Analysis;
use gdcm_study::results::assessment_table::AssessmentTable;
use gdcm_study::results::coupling_remarks::analysis_coupling_remarks;
use gdcm_study::stages::engine::Engine;
use gdcm_words::assessment::{
    held_out_verdict, missing_cost_text, not_assessed_text, summary_text,
};
use gdcm_words::coupling_remark::coupling_remark_text;
use gdcm_words::couplings::{
    coupling_cost_table, coupling_matrix_tables, couplings_heading, pole_table,
};
use gdcm_words::table::Table;
use gdcm_words::uncertainty::{
    bar_table, difference_table, difference_text, differences_summary, scatter_table,
    second_variable_table,
};

use super::Unobtrusive;
use super::page::{CONDITIONS_DRAWN, PAIRS_DRAWN, Page};

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
        None => Arc::new(engine.uncertainty(analysis, &Unobtrusive(progress))?),
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

/// Maximum number of responses in a figure, in four rows.
const IN_A_FIGURE: usize = 12;
/// Maximum number of conditions side by side in a table that fits on a page.
const CONDITIONS: usize = 12;

/// Adds the section on the change of J due to the scheduled correction.
pub(super) fn add_assessment(page: &mut Page, analysis: &Analysis) {
    page.section("Assessment");
    let choice = usual_choice(analysis);
    let table = AssessmentTable::of(analysis, choice);
    page.paragraph(&format!(
        "Change in J of the nominal model of each condition due to the scheduled correction; J is \
        the deviation from the identified representative, so negative changes are improvements. \
        J takes {} over frequency; J up to {ACCEPTABLE} is acceptable, and J up to 50 is nearly \
        indistinguishable from flight.",
        average_word(choice.average)
    ));
    let mut left_out = Vec::new();
    for condition in &table.left_out {
        left_out.push(format!(
            "Condition {} is left out: {}.",
            condition.condition,
            not_assessed_text(&condition.why, &analysis.study.dataset)
        ));
    }
    page.list(left_out);
    let measuring = analysis.study.dataset.measuring_pairs();
    let has_on_axis = analysis.study.dataset.on_axis().marked().next().is_some();
    let on_axis: Vec<Pair> = measuring.marked().collect();
    let off_axis: Vec<Pair> = measuring.pairs().filter(|pair| !measuring[*pair]).collect();
    let on_axis_name = if has_on_axis {
        "on-axis responses"
    } else {
        "responses"
    };
    if !on_axis.is_empty() {
        add_responses(page, analysis, &table, &on_axis, on_axis_name);
        page.table(&parts_table(analysis, &table, &on_axis));
    }
    if !off_axis.is_empty() {
        add_responses(page, analysis, &table, &off_axis, "off-axis responses");
    }
}

/// Adds the changes in J of the responses `pairs` under the title `name`: a summary, figures and
/// tables.
fn add_responses(
    page: &mut Page,
    analysis: &Analysis,
    table: &AssessmentTable,
    pairs: &[Pair],
    name: &str,
) {
    page.subsection(&capital(name));
    let measuring = analysis.study.dataset.measuring_pairs();
    let marked = PairTable::from_fn(measuring.outputs(), measuring.inputs(), |pair| {
        pairs.contains(&pair)
    });
    let summary = summary_text(&table.summary(&marked), &analysis.study.dataset);
    page.paragraph(&format!("{}.", capital(&summary)));
    add_figures(page, analysis, pairs, name);
    add_tables(page, analysis, table, pairs, name);
}

/// Capitalises the first letter; a leading symbol is unchanged ("α of the gains").
pub(super) fn capital(words: &str) -> String {
    let mut capital = words.to_owned();
    if let Some(first) = capital.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    capital
}

/// Adds figures of the changes in J of the responses `pairs` under the title `name`.
fn add_figures(page: &mut Page, analysis: &Analysis, pairs: &[Pair], name: &str) {
    let drawn = &pairs[..pairs.len().min(PAIRS_DRAWN)];
    for pairs in drawn.chunks(IN_A_FIGURE) {
        let figure = assessment_figure(analysis, pairs, usual_choice(analysis));
        page.figure(
            &figure,
            &format!("Change of J of {name}"),
            "Total change, and its magnitude and phase parts.",
        );
    }
    if drawn.len() < pairs.len() {
        page.paragraph(&format!(
            "{} of {} responses are drawn.",
            drawn.len(),
            pairs.len()
        ));
    }
}

/// Adds tables of ΔJ of the responses `pairs` at every condition, with as many conditions side by
/// side as fit on a page; `name` is part of the titles.
fn add_tables(
    page: &mut Page,
    analysis: &Analysis,
    assessment: &AssessmentTable,
    pairs: &[Pair],
    name: &str,
) {
    let dataset = &*analysis.study.dataset;
    let shown = &assessment.conditions[..assessment.conditions.len().min(CONDITIONS_DRAWN)];
    let mut conditions: Vec<(ConditionId, String)> = Vec::with_capacity(shown.len());
    for assessed in shown {
        conditions.push((assessed.condition, format!("cond. {}", assessed.condition)));
    }
    let table = change_table(
        format!("ΔJ of {name}"),
        (dataset, assessment),
        pairs,
        &conditions,
        CostChange::total,
    );
    page.wide_table(&table, CONDITIONS);
    let more = assessment.conditions.len() - shown.len();
    if more > 0 {
        page.paragraph(&format!(
            "{more} more conditions were assessed; gdcm analyze writes all of them to \
            assessment.csv."
        ));
    }
    let mut missing = Vec::new();
    for assessed in shown {
        for (pair, why) in &assessed.missing {
            if pairs.contains(pair) {
                missing.push(format!(
                    "Condition {}: no ΔJ of {}: {}.",
                    assessed.condition,
                    dataset.pair_name(*pair),
                    missing_cost_text(*why)
                ));
            }
        }
    }
    page.list(missing);
}

/// Tabulates J before and after, and its change in parts, for every condition and response.
fn parts_table(analysis: &Analysis, assessment: &AssessmentTable, pairs: &[Pair]) -> Table {
    let columns = [
        "condition",
        "model",
        "response",
        "J before",
        "J after",
        "ΔJ",
        "ΔJ magnitude",
        "ΔJ phase",
    ];
    let mut table = Table::new(
        "J of the nominal models without and with the schedule",
        columns,
    );
    for assessed in &assessment.conditions {
        for pair in pairs {
            let Some(change) = assessed.changes[*pair] else {
                continue;
            };
            table.row([
                assessed.condition.to_string(),
                assessed.model.clone(),
                analysis.study.dataset.pair_name(*pair),
                decimals(change.uncorrected.total(), 1),
                decimals(change.corrected.total(), 1),
                signed(change.total(), 1),
                signed(change.magnitude(), 1),
                signed(change.phase(), 1),
            ]);
        }
    }
    table
}

/// Maximum number of matrix columns that fit on a page.
const MATRIX_COLUMNS: usize = 8;

/// Returns the analysis with the assessment of its couplings, which is computed if missing;
/// unchanged if no couplings were fitted.
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
        engine.assess_couplings(study, study.settings.couplings, &Unobtrusive(progress))?;
    Ok(Analysis {
        coupling_assessment: assessed.and_then(Result::ok),
        ..analysis
    })
}

/// Adds the section on couplings, if they are requested.
pub(super) fn add_couplings(page: &mut Page, analysis: &Analysis) {
    if analysis.couplings.is_none() {
        return;
    }
    page.section("Couplings");
    page.paragraph(
        "A mixing of the inputs and, if requested, a feedback of outputs to inputs, common to all \
        conditions, precede the corrections of the channels. The representatives, G, D, gains, \
        delays, leads and J in this report are based on the physics models with these couplings. \
        The choice of the representative of a bundle and the suspected models are determined \
        without them.",
    );
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
        let caption = "Minimum singular value of I \u{2212} K H at the sticks in each condition: \
            1 means that there is no loop; below 0.5 the loop is close to ringing. Poles of the \
            condition with the smallest value.";
        page.figure(&figure, &figure.title, caption);
    }
}
