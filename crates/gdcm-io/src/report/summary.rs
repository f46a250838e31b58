//! Report section with the summary of the results.

use gdcm_model::dataset::{BundleKind, Condition};
use gdcm_model::units::number;
use gdcm_plot::figure::assessment::usual_choice;
use gdcm_study::{Analysis, AssessmentTable, ConditionAnalysis, Study};
use gdcm_words::Table;
use gdcm_words::assessment::summary_text;
use gdcm_words::caution::failure_text;

use super::conditions::proof_word;
use super::page::Page;
use super::wording::{MISSING, counted_are};

/// Adds the summary of the results.
pub(super) fn add_summary(page: &mut Page, analysis: &Analysis) {
    page.section("Summary");
    let conditions = analysis.study.dataset.conditions();
    let mut solved = 0;
    let mut rejected = 0;
    let mut failures = Vec::new();
    for condition in conditions {
        let id = condition.id();
        rejected += analysis.study.rejected_names(id).len();
        if analysis.condition(id).is_some() {
            solved += 1;
        }
        if let Some(Err(failure)) = analysis.conditions.get(&id) {
            let why = failure_text(failure, &analysis.study.dataset);
            failures.push(format!("Condition {id} has no result: {why}."));
        }
    }
    let scheduled = analysis.scheduled().len();
    page.paragraph(&format!(
        "{solved} of {} conditions have a result; the schedule is fitted to {scheduled} of them; \
        {} rejected.",
        conditions.len(),
        counted_are(rejected, "model")
    ));
    page.paragraph(&assessment_sentence(analysis));
    page.list(failures);
    page.table(&condition_table(analysis));
}

/// Returns a sentence on the change of J of the nominal models due to the schedule.
pub fn assessment_sentence(analysis: &Analysis) -> String {
    let dataset = &analysis.study.dataset;
    let measuring = dataset.measuring_pairs();
    let which = if dataset.on_axis().marked().next().is_some() {
        "on-axis responses"
    } else {
        "responses"
    };
    let table = AssessmentTable::assess(analysis, usual_choice(analysis));
    let found = summary_text(&table.summary(&measuring), dataset);
    let fails_between = match &analysis.schedule {
        Ok(schedule) => schedule.interpolation_fails(),
        Err(_) => false,
    };
    let between = if fails_between {
        " Between the conditions' airspeeds the schedule must not be used (see its cautions)."
    } else {
        ""
    };
    format!(
        "Change in J of the nominal models due to the schedule, over the {which} of all assessed \
        conditions: {found}.{between}"
    )
}

fn condition_table(analysis: &Analysis) -> Table {
    let title = "Conditions: kept models, matched held responses, and whether the gains are \
        proven optimal";
    let columns = [
        "condition",
        "name",
        "V [kt]",
        "physics",
        "identified",
        "gains",
        "delays",
        "optimum",
        "scheduled",
    ];
    let mut table = Table::new(title, columns);
    for condition in analysis.study.dataset.conditions() {
        let state = condition.flight_state();
        let result = analysis.condition(condition.id());
        let (gains, delays, optimum) = match result {
            Some(result) => (
                matched_words(result, result.gains.unmatched.len()),
                matched_words(result, result.delays.unmatched.len()),
                proof_word(result),
            ),
            None => (MISSING.to_owned(), MISSING.to_owned(), "no result"),
        };
        let scheduled = result.is_some() && analysis.study.choice(condition.id()).scheduled;
        table.row([
            state.id.to_string(),
            state.name.clone(),
            number(state.airspeed_kt),
            kept_words(&analysis.study, condition, BundleKind::Physics),
            kept_words(&analysis.study, condition, BundleKind::Identified),
            gains,
            delays,
            optimum.to_owned(),
            if scheduled { "yes" } else { "no" }.to_owned(),
        ]);
    }
    table
}

/// Returns how many models of a bundle are kept: "8 of 9".
fn kept_words(study: &Study, condition: &Condition, kind: BundleKind) -> String {
    let models = condition.bundle(kind);
    let rejected = &study.choice(condition.id()).bundle(kind).rejected;
    let kept = models
        .iter()
        .filter(|model| !rejected.contains(&model.name))
        .count();
    format!("{kept} of {}", models.len())
}

/// Returns how many of the constrained responses satisfy their constraint: "4 of 5".
fn matched_words(result: &ConditionAnalysis, unmatched: usize) -> String {
    let held = result.held().marked().count();
    format!("{} of {held}", held.saturating_sub(unmatched))
}
