//! Report section on the benefit of the scheduled correction.
//!
//! J (M4) is the mismatch between a physics model and the identified representative, averaged over
//! frequency. The assessed model is the *nominal* one, at the condition's own trim; each
//! condition's other physics models are at perturbed trims. The *measuring* responses are the
//! on-axis responses, or all responses if none is on-axis.

use gdcm_method::fidelity::ACCEPTABLE;
use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::number_format::decimals;
use gdcm_model::units::signed;
use gdcm_plot::figure::assessment::{
    ChangeColumn, ChangeTable, assessment_figure, average_word, usual_choice,
};
use gdcm_study::results::analysis::Analysis;
use gdcm_study::results::assessment_table::AssessmentTable;
use gdcm_words::assessment::{missing_cost_text, not_assessed_text, summary_text};
use gdcm_words::table::Table;

use super::limits::{CONDITIONS_DRAWN, PAIRS_DRAWN};
use super::page::Page;
use super::wording::capital;

/// Maximum number of responses per figure, in two rows.
const PAIRS_IN_A_FIGURE: usize = 12;
/// Maximum number of plots per figure row.
const PLOTS_IN_A_ROW: usize = 6;
/// Maximum number of conditions side by side in a table that fits on a page.
const CONDITIONS_SIDE_BY_SIDE: usize = 12;

/// Adds the section on the change in J due to the scheduled correction.
pub(super) fn add_assessment(page: &mut Page, analysis: &Analysis) {
    page.section("Assessment");
    let choice = usual_choice(analysis);
    let table = AssessmentTable::assess(analysis, choice);
    page.paragraph(&format!(
        "Change in J of each condition's nominal model due to the scheduled correction; J is the \
        deviation from the identified representative, so negative changes are improvements. \
        J is based on {} over frequency; J up to {ACCEPTABLE} is acceptable, and J up to 50 is nearly \
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
    let has_on_axis = analysis.study.dataset.on_axis().marked().next().is_some();
    let noun = if has_on_axis {
        "on-axis responses"
    } else {
        "responses"
    };
    let measuring: Vec<Pair> = analysis.study.dataset.measuring_pairs().marked().collect();
    if !measuring.is_empty() {
        add_responses(page, analysis, &table, &measuring, noun);
    }
}

/// Adds the appendix with J in parts for the measuring responses, and with the off-axis responses.
pub(super) fn add_assessment_details(page: &mut Page, analysis: &Analysis) {
    page.appendix("Details of the assessment");
    let table = AssessmentTable::assess(analysis, usual_choice(analysis));
    let measuring = analysis.study.dataset.measuring_pairs();
    let marked: Vec<Pair> = measuring.marked().collect();
    let off_axis: Vec<Pair> = measuring.pairs().filter(|pair| !measuring[*pair]).collect();
    page.table(&parts_table(analysis, &table, &marked));
    if !off_axis.is_empty() {
        add_responses(page, analysis, &table, &off_axis, "off-axis responses");
    }
}

/// Adds the changes in J for the responses `pairs`, which the titles call `noun`: a summary,
/// figures and tables.
fn add_responses(
    page: &mut Page,
    analysis: &Analysis,
    table: &AssessmentTable,
    pairs: &[Pair],
    noun: &str,
) {
    let measuring = analysis.study.dataset.measuring_pairs();
    let summarised = PairTable::from_fn(measuring.outputs(), measuring.inputs(), |pair| {
        pairs.contains(&pair)
    });
    let summary = summary_text(&table.summary(&summarised), &analysis.study.dataset);
    page.paragraph(&format!("{}: {summary}.", capital(noun)));
    add_figures(page, analysis, pairs, noun);
    add_tables(page, analysis, table, pairs, noun);
}

/// Plots the changes in J for the responses `pairs`, which the titles call `noun`.
fn add_figures(page: &mut Page, analysis: &Analysis, pairs: &[Pair], noun: &str) {
    let drawn = &pairs[..pairs.len().min(PAIRS_DRAWN)];
    for pairs in drawn.chunks(PAIRS_IN_A_FIGURE) {
        let figure = assessment_figure(analysis, pairs, usual_choice(analysis));
        let figure = figure.columns(PLOTS_IN_A_ROW);
        page.figure(
            &figure,
            &format!("Change of J of {noun}"),
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

/// Tabulates ΔJ for the responses `pairs` in the first [`CONDITIONS_DRAWN`] conditions, with as
/// many conditions side by side as fit on a page, and lists the reasons for missing values; the
/// titles call the responses `noun`.
fn add_tables(
    page: &mut Page,
    analysis: &Analysis,
    assessment: &AssessmentTable,
    pairs: &[Pair],
    noun: &str,
) {
    let dataset = &*analysis.study.dataset;
    let shown = &assessment.conditions[..assessment.conditions.len().min(CONDITIONS_DRAWN)];
    let mut columns: Vec<ChangeColumn> = Vec::with_capacity(shown.len());
    for assessed in shown {
        columns.push(ChangeColumn {
            condition: assessed.condition,
            heading: format!("cond. {}", assessed.condition),
        });
    }
    let contents = ChangeTable {
        dataset,
        assessment,
        pairs,
        columns: &columns,
        part: CostChange::total,
    };
    page.wide_table(
        &contents.table(format!("ΔJ of {noun}")),
        CONDITIONS_SIDE_BY_SIDE,
    );
    let more = assessment.conditions.len() - shown.len();
    if more > 0 {
        page.paragraph(&format!(
            "Conditions not in this table: {more}; gdcm analyze writes all of them to \
            assessment.csv."
        ));
    }
    let mut missing = Vec::new();
    for assessed in shown {
        for (pair, why) in &assessed.missing {
            if pairs.contains(pair) {
                missing.push(format!(
                    "Condition {}: no ΔJ for {}: {}.",
                    assessed.condition,
                    dataset.pair_name(*pair),
                    missing_cost_text(*why)
                ));
            }
        }
    }
    page.list(missing);
}

/// Tabulates J before and after, and its change in parts, for every assessed condition and those
/// responses in `pairs` that have a value.
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
