//! What came of the study, at a glance.

use gdcm_core::dataset::{BundleKind, Condition};
use gdcm_core::schedule::Schedule;
use gdcm_core::study::{Analysis, AssessmentTable, ConditionAnalysis, Study, Table};
use gdcm_core::units::number;

use super::assessment::usual_choice;
use super::conditions::proof_word;
use super::page::Page;

/// Adds the section.
pub(super) fn add(page: &mut Page, analysis: &Analysis) {
    page.section("Summary");
    let conditions = analysis.study.dataset.conditions();
    let solved = conditions.iter().filter(|condition| analysis.condition(condition.id()).is_some()).count();
    let rejected: usize = conditions.iter().map(|of| analysis.study.rejected_names(of.id()).len()).sum();
    let scheduled = analysis.scheduled().len();
    page.paragraph(&format!(
        "{solved} of {} conditions have a result, {scheduled} of them make the schedule; {rejected} models are rejected.",
        conditions.len()
    ));
    page.paragraph(&assessment_sentence(analysis));
    let without = conditions.iter().filter_map(|condition| {
        let failure = analysis.conditions.get(&condition.id())?.as_ref().err()?;
        Some(format!("Condition {} has no result: {failure}.", condition.id()))
    });
    page.list(without);
    page.table(&condition_table(analysis));
}

fn assessment_sentence(analysis: &Analysis) -> String {
    let dataset = &analysis.study.dataset;
    let measuring = dataset.measuring_pairs();
    let which = if dataset.on_axis().marked().next().is_some() { "on-axis responses" } else { "responses" };
    let found = AssessmentTable::of(analysis, usual_choice(analysis)).summary(&measuring).words(dataset);
    let between = if analysis.schedule.as_ref().is_ok_and(Schedule::interpolation_fails) {
        " Between the conditions' airspeeds the schedule must not be used (see its cautions)."
    } else {
        ""
    };
    format!(
        "J of the nominal models under the schedule, over the {which} of every condition assessed: {found}.{between}"
    )
}

fn condition_table(analysis: &Analysis) -> Table {
    let mut table = Table::new(
        "The conditions: models kept of those there are, held responses matched of those held, and how sure the gains are",
        ["condition", "name", "V [kt]", "physics", "identified", "gains", "delays", "optimum", "scheduled"],
    );
    for condition in analysis.study.dataset.conditions() {
        let state = condition.flight_state();
        let result = analysis.condition(condition.id());
        let [gains, delays] = result.map_or(["–".to_owned(), "–".to_owned()], matched);
        let scheduled = result.is_some() && analysis.study.choice(condition.id()).scheduled;
        table.row([
            state.id.to_string(),
            state.name.clone(),
            number(state.airspeed_kt),
            kept(&analysis.study, condition, BundleKind::Physics),
            kept(&analysis.study, condition, BundleKind::Identified),
            gains,
            delays,
            result.map_or("no result", proof_word).to_owned(),
            if scheduled { "yes" } else { "no" }.to_owned(),
        ]);
    }
    table
}

fn kept(study: &Study, condition: &Condition, kind: BundleKind) -> String {
    let models = condition.bundle(kind);
    let rejected = &study.choice(condition.id()).bundle(kind).rejected;
    let kept = models.iter().filter(|model| !rejected.contains(&model.name)).count();
    format!("{kept} of {}", models.len())
}

/// Held gains and held delays that are matched, of how many.
fn matched(result: &ConditionAnalysis) -> [String; 2] {
    let held = result.held().marked().count();
    let of = |unmatched: usize| format!("{} of {held}", held.saturating_sub(unmatched));
    [of(result.gains.unmatched.len()), of(result.delays.unmatched.len())]
}
