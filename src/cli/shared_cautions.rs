//! Cautions about all conditions, for the summary: texts ([`cautions_section`]) and codes
//! ([`coded_cautions`]).
//!
//! A caution is a [`Remark`] with the kind [`RemarkKind::Caution`]. It is *recurring*
//! ([`Remark::is_recurring`]) if it usually concerns many conditions at once, and is then listed in
//! a table (`recurring_cautions`); the others are printed as lines, merged over the conditions with
//! equal text.

use gdcm_model::dataset::ConditionId;
use gdcm_model::message_text::sanitized;
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::coupling_remark_search::analysis_coupling_remarks;
use gdcm_study::results::remark::Remark;
use gdcm_study::results::remark_kind::RemarkKind;
use gdcm_study::{Analysis, ConditionAnalysis};
use gdcm_words::leads::lead_limit_words;
use gdcm_words::remark::remark_text;

use super::condition_messages::{ConditionMessage, shared_messages};
use super::evidence_summary::{UNNEEDED_VARIABLE, unneeded_second_variable};
use super::physics_summary::physics_caution_codes;
use super::printed_lines::line;
use super::recurring_cautions::{RecurringRow, recurring_table};
use super::terminal::keep_caution;

/// Returns the recurring cautions as a table, and each other caution once with its conditions; also
/// adds them to the JSON object.
///
/// 1. Sorts each condition's cautions into recurring ones, a row for each condition, and others;
///    the limit of the leads is one of the others.
/// 2. If there is only one recurring caution, it becomes one of the others; otherwise the rows
///    become a table.
/// 3. Merges the others with equal text.
pub(super) fn cautions_section(analysis: &Analysis) -> String {
    let mut rows: Vec<RecurringRow> = Vec::new();
    let mut others: Vec<ConditionMessage> = Vec::new();
    let dataset = &analysis.study.dataset;
    // Step 1.
    for condition in dataset.conditions() {
        let Some(result) = analysis.condition(condition.id()) else {
            continue;
        };
        let mut row = RecurringRow {
            condition: result.condition.id(),
            cautions: Vec::new(),
        };
        for caution in condition_cautions(analysis, result) {
            if caution.is_recurring() {
                row.cautions.push(caution);
            } else {
                let text = remark_text(&caution, dataset);
                others.push(ConditionMessage::new(row.condition, caution.code(), text));
            }
        }
        if let Some(words) = lead_limit_words(result) {
            others.push(ConditionMessage::new(row.condition, "lead-limit", words));
        }
        if !row.cautions.is_empty() {
            rows.push(row);
        }
    }
    let mut text = String::new();
    // Step 2.
    if let [row] = &rows[..]
        && let [alone] = &row.cautions[..]
    {
        // A single caution about a single condition needs no table.
        let words = remark_text(alone, dataset);
        let message = ConditionMessage::new(row.condition, alone.code(), words);
        others.insert(0, message);
    } else if !rows.is_empty() {
        text += &recurring_table(dataset, &rows);
    }
    // Step 3.
    for shared in shared_messages(others) {
        keep_caution(
            shared.message.code,
            &shared.conditions,
            &shared.message.text,
        );
        text += &line("Caution", &sanitized(&shared.words()));
    }
    text
}

/// A caution's code, with the conditions that it is about; without conditions, it is about the
/// whole study.
pub(super) struct CodedCaution {
    pub(super) code: &'static str,
    pub(super) conditions: Vec<ConditionId>,
}

/// Collects all caution codes, in this order: doubts about signs and units, conditions, physics
/// parameters, couplings, the schedule and its second variable. A coupling remark with good news is
/// no caution.
pub(super) fn coded_cautions(analysis: &Analysis) -> Vec<CodedCaution> {
    let mut coded = Vec::new();
    for doubt in &analysis.doubts {
        for id in &doubt.conditions {
            add_code(&mut coded, "convention-doubt", Some(*id));
        }
    }
    for result in analysis.conditions.values().flatten() {
        let id = Some(result.condition.id());
        for caution in condition_cautions(analysis, result) {
            add_code(&mut coded, caution.code(), id);
        }
        if lead_limit_words(result).is_some() {
            add_code(&mut coded, "lead-limit", id);
        }
    }
    for code in physics_caution_codes(analysis) {
        add_code(&mut coded, code, None);
    }
    for remark in analysis_coupling_remarks(analysis) {
        if remark.kind() != RemarkKind::Good {
            add_code(&mut coded, remark.code(), None);
        }
    }
    if let Ok(schedule) = &analysis.schedule {
        for caution in &schedule.cautions {
            add_code(&mut coded, caution.code(), caution.condition());
        }
    }
    if unneeded_second_variable(analysis).is_some() {
        add_code(&mut coded, UNNEEDED_VARIABLE, None);
    }
    coded
}

/// Adds a condition to the entry for a code; the first occurrence of a code adds the entry.
fn add_code(coded: &mut Vec<CodedCaution>, code: &'static str, id: Option<ConditionId>) {
    let place = match coded.iter().position(|known| known.code == code) {
        Some(place) => place,
        None => {
            coded.push(CodedCaution {
                code,
                conditions: Vec::new(),
            });
            coded.len() - 1
        }
    };
    if let Some(id) = id
        && !coded[place].conditions.contains(&id)
    {
        coded[place].conditions.push(id);
    }
}

/// Returns the cautions about a condition, without the doubts about signs and units, which are
/// printed before all conditions.
fn condition_cautions(analysis: &Analysis, result: &ConditionAnalysis) -> Vec<Remark> {
    condition_remarks(&analysis.study, result, None)
        .into_iter()
        .filter(|remark| remark.kind() == RemarkKind::Caution)
        .filter(|remark| !matches!(remark, Remark::ConventionDoubt(_)))
        .collect()
}
