//! Assessment of the schedule, as printed, with each condition in turn left out of the fit. J is
//! the mismatch cost (M4), the schedule the correction as a function of airspeed (M11).

use gdcm_model::message_text::sanitized;
use gdcm_study::results::assessment_table::{AssessedModel, AssessmentChoice};
use gdcm_study::{Analysis, AssessedCorrection, AssessmentTable};
use gdcm_words::Table;
use gdcm_words::assessment::not_assessed_text;

use super::printed_lines::{detail, fixed_digits, indented, line};

/// Returns, for each condition's nominal model, the mean change in J over the on-axis responses
/// (over all if none is on-axis): with the schedule fitted to all conditions, and fitted to the
/// other conditions only. Below, the conditions that cannot be assessed, and notes that parameters
/// and couplings are fitted to all conditions, if there are any.
pub(super) fn leave_one_out_section(analysis: &Analysis) -> String {
    let fitted_to_all = assessment(analysis, AssessedCorrection::Scheduled);
    let fitted_to_others = assessment(analysis, AssessedCorrection::ScheduleOfOthers);
    let mut text = line(
        "Left out",
        "on-axis mean of the change of J, under the schedule fitted to all conditions or to all others:",
    );
    let mut table = Table::new(
        "",
        ["condition", "kt", "fitted to all", "fitted to the others"],
    );
    for condition in &fitted_to_others.conditions {
        let id = condition.condition;
        let mean_change = |table: &AssessmentTable| {
            let mut changes: Vec<f64> = Vec::new();
            for pair in analysis.study.dataset.measuring_pairs().marked() {
                changes.extend(table.change(id, pair).map(|change| change.total()));
            }
            mean(&changes)
        };
        table.row([
            id.to_string(),
            fixed_digits(Some(condition.airspeed_kt), 0),
            fixed_digits(mean_change(&fitted_to_all), 1),
            fixed_digits(mean_change(&fitted_to_others), 1),
        ]);
    }
    text += &indented(&table, 2);
    for left_out in &fitted_to_others.left_out {
        let why = sanitized(&not_assessed_text(&left_out.why, &analysis.study.dataset));
        text += &detail("", &format!("condition {}: {why}", left_out.condition));
    }
    let are_parameters_moved = analysis
        .applied_physics()
        .is_some_and(|applied| !applied.values.is_empty());
    if are_parameters_moved {
        let words = "these physics parameters are fitted to all conditions; for J with parameters \
            fitted without each condition, see Physics";
        text += &detail("", words);
    }
    if analysis.fitted_couplings().is_some() {
        let words = "these couplings are fitted to all conditions; for J with couplings fitted \
            without each condition, see Couplings";
        text += &detail("", words);
    }
    text
}

/// Returns the default choice for assessing a correction: the nominal models, with J averaged as
/// the study sets.
pub(super) fn nominal_choice(
    analysis: &Analysis,
    correction: AssessedCorrection,
) -> AssessmentChoice {
    AssessmentChoice {
        model: AssessedModel::Nominal,
        correction,
        average: analysis.study.settings.cost_average,
    }
}

fn assessment(analysis: &Analysis, correction: AssessedCorrection) -> AssessmentTable {
    AssessmentTable::assess(analysis, nominal_choice(analysis, correction))
}

/// Averages some values; `None` if there are none.
fn mean(values: &[f64]) -> Option<f64> {
    if values.is_empty() {
        None
    } else {
        Some(values.iter().sum::<f64>() / values.len() as f64)
    }
}
