//! Sentences about assessments: a correction's effect, its origin, and why a condition or response
//! is left out (M12).
//!
//! An assessment compares J, the cost of a response's mismatch to the identified representative,
//! before and after a correction: the optimum of each condition, or the schedule over airspeed. A
//! held-out condition is excluded from the fit of the schedule.

use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::units::{number, signed};
use gdcm_study::results::analysis::NotAssessed;
use gdcm_study::results::assessment_table::{AssessmentChoice, AssessmentSummary, MissingCost};
use gdcm_study::{Analysis, AssessedCorrection, AssessmentTable};

use crate::caution::{failure_text, undefined_text};

/// Describes the origin of an assessed correction.
pub(crate) fn correction_source(correction: AssessedCorrection, airspeed_kt: f64) -> String {
    let at = format!("at {} kt", number(airspeed_kt));
    match correction {
        AssessedCorrection::Own => "the condition's own optimum".to_owned(),
        AssessedCorrection::Scheduled => format!("the schedule {at}"),
        AssessedCorrection::ScheduledWithoutLeads => {
            format!("the schedule {at}, without its leads")
        }
        AssessedCorrection::ScheduleOfOthers => {
            format!("the schedule of the other conditions {at}")
        }
    }
}

/// Returns why an assessment leaves a condition out.
pub fn not_assessed_text(why: &NotAssessed, dataset: &Dataset) -> String {
    match why {
        NotAssessed::NotAnalysed => "the condition was not analysed".to_owned(),
        NotAssessed::NominalRejected => "the nominal model is rejected".to_owned(),
        NotAssessed::NoResult(failure) => failure_text(failure, dataset),
        NotAssessed::NoSchedule(error) => error.to_string(),
    }
}

/// Returns why a response has no J.
pub fn missing_cost_text(why: MissingCost) -> String {
    match why {
        MissingCost::NetGainNotPositive => "the scheduled net gain is not positive".to_owned(),
        MissingCost::Undefined(why) => undefined_text(why),
        MissingCost::NominalUndefined => {
            "the nominal model's response is zero, numerically zero or not finite somewhere in \
            the band"
                .to_owned()
        }
    }
}

/// Returns the summary in words: "better in 41 of 50 responses; worst ΔJ +12.3 (PED → NY in
/// condition 5)"; "nothing to assess" without responses.
pub fn summary_text(summary: &AssessmentSummary, dataset: &Dataset) -> String {
    let Some((condition, pair, change)) = summary.worst else {
        return "nothing to assess".to_owned();
    };
    format!(
        "better in {} of {} responses; worst ΔJ {} ({} in condition {condition})",
        summary.better,
        summary.compared,
        signed(change, 1),
        dataset.pair_name(pair)
    )
}

/// Compares the assessment of the held-out conditions with that of the others: "held out (3, 8):
/// better in 9 of 10 responses, mean ΔJ −12.3; the others: better in 40 of 45 responses, mean ΔJ
/// −15.0". `None` where no condition is held out.
pub fn held_out_verdict(analysis: &Analysis, assessment: AssessmentChoice) -> Option<String> {
    let study = &analysis.study;
    let held_out: Vec<String> = study
        .dataset
        .ids()
        .filter(|id| study.choice(*id).held_out)
        .map(|id| id.to_string())
        .collect();
    if held_out.is_empty() {
        return None;
    }
    let table = AssessmentTable::assess(analysis, assessment);
    let of_held_out = change_words(analysis, &table, |id| study.choice(id).held_out);
    let of_others = change_words(analysis, &table, |id| !study.choice(id).held_out);
    Some(format!(
        "held out ({}): {of_held_out}; the others: {of_others}",
        held_out.join(", ")
    ))
}

/// Describes the change in J over the on-axis responses (over all, if none is on-axis) of the
/// selected conditions.
fn change_words(
    analysis: &Analysis,
    table: &AssessmentTable,
    is_selected: impl Fn(ConditionId) -> bool,
) -> String {
    let measuring_pairs = analysis.study.dataset.measuring_pairs();
    let mut changes = Vec::new();
    for assessed in &table.conditions {
        if !is_selected(assessed.condition) {
            continue;
        }
        for pair in measuring_pairs.marked() {
            if let Some(change) = assessed.changes[pair] {
                changes.push(change.total());
            }
        }
    }
    if changes.is_empty() {
        return "nothing to assess".to_owned();
    }
    let better = changes.iter().filter(|change| **change < 0.0).count();
    let mean = changes.iter().sum::<f64>() / changes.len() as f64;
    format!(
        "better in {better} of {} responses, mean ΔJ {}",
        changes.len(),
        signed(mean, 1)
    )
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::ConditionId;

    use super::*;
    use crate::reference_tests::reference_dataset;

    #[test]
    fn a_sentence_sums_an_assessment_up() {
        let dataset = reference_dataset();
        let pair = dataset.find_pair("Q", "LON").unwrap();
        let mut summary = AssessmentSummary {
            better: 48,
            compared: 50,
            worst: Some((ConditionId(3), pair, 0.26)),
        };
        assert_eq!(
            summary_text(&summary, &dataset),
            "better in 48 of 50 responses; worst ΔJ +0.3 (LON → Q in condition 3)"
        );
        summary.worst = None;
        assert_eq!(summary_text(&summary, &dataset), "nothing to assess");
    }
}
