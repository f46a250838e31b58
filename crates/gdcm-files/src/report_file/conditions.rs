//! Each condition: its representatives, its gains and delays, what they rest on, and its plots.

use gdcm_core::correction::Outcome;
use gdcm_core::dataset::{BundleKind, Condition, ConditionId, FlightState};
use gdcm_core::study::{
    Analysis, CURVE_POINTS, Cancelled, ConditionAnalysis, Engine, Progress, RemarkKind, Table, details, display_band,
    lead_words, remarks,
};
use gdcm_core::units::{number, s_to_ms};

use super::extent::CONDITIONS_DRAWN;
use super::models::add_models;
use super::page::Page;
use super::plots::add_plots;
use super::responses::add_responses;
use crate::figure::ConditionSource;
use crate::figure::{compact, decimals};

/// Tells who waits how many conditions are done, and nothing of the steps within one.
struct Steps<'a>(&'a dyn Progress);

impl Progress for Steps<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }

    fn advanced(&self, _: usize, _: usize) {}
}

/// Adds the section, a part for each condition.
pub(super) fn add(
    page: &mut Page,
    analysis: &Analysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<(), Cancelled> {
    page.section("Conditions");
    let conditions = analysis.study.dataset.conditions();
    if conditions.len() > CONDITIONS_DRAWN {
        page.paragraph(&format!(
            "The first {CONDITIONS_DRAWN} conditions have figures; gdcm figure makes those of the others."
        ));
    }
    for (index, condition) in conditions.iter().enumerate() {
        if progress.cancelled() {
            return Err(Cancelled);
        }
        page.subsection(&title(condition.flight_state()));
        match analysis.conditions.get(&condition.id()) {
            Some(Ok(result)) => {
                add_result(page, analysis, result);
                if index < CONDITIONS_DRAWN {
                    draw(page, analysis, condition.id(), (engine, progress))?;
                }
            }
            Some(Err(failure)) => page.paragraph(&format!("This condition has no result: {failure}.")),
            None => page.paragraph("This condition was not analysed."),
        }
        progress.advanced(index + 1, conditions.len());
    }
    Ok(())
}

fn title(state: &FlightState) -> String {
    if state.name.is_empty() {
        format!("Condition {}", state.id)
    } else {
        format!("Condition {}: {}", state.id, state.name)
    }
}

fn draw(
    page: &mut Page,
    analysis: &Analysis,
    id: ConditionId,
    (engine, progress): (&mut Engine, &dyn Progress),
) -> Result<(), Cancelled> {
    let study = &analysis.study;
    let grid = (display_band(study.settings.band), CURVE_POINTS);
    let curves = engine.curves(&study.dataset, id, grid, &Steps(progress))?;
    if let Some((curves, result)) = curves.zip(analysis.condition(id)) {
        let schedule = analysis.schedule.as_ref().ok();
        add_plots(page, &ConditionSource { study, analysis: result, schedule, curves: &curves });
    }
    Ok(())
}

fn add_result(page: &mut Page, analysis: &Analysis, result: &ConditionAnalysis) {
    page.facts(facts(analysis, result));
    let study = &analysis.study;
    let said = remarks(study, result, None).into_iter().map(|remark| match remark.kind {
        RemarkKind::Good => remark.text,
        RemarkKind::Caution => format!("Caution: {}", remark.text),
        RemarkKind::Trouble => format!("Not matched: {}", remark.text),
    });
    page.heading_within("What was matched, what was not and why");
    page.list(said);
    page.fine_list(details(study, result));
    if result.compensated.is_some() {
        page.heading_within("What the leads do and what they cost");
        page.list(lead_words(study, result, analysis.uncertainty.as_deref()));
    }
    add_responses(page, study, result);
    page.table(&channel_table(analysis, result));
    BundleKind::BOTH.into_iter().for_each(|kind| add_models(page, study, result, kind));
}

/// How sure the gains are, in a word.
pub(super) fn proof_word(result: &ConditionAnalysis) -> &'static str {
    match result.gains.proof.outcome {
        Outcome::Proven { .. } => "proven",
        Outcome::NotProven { .. } => "not proven",
    }
}

fn facts<'a>(analysis: &Analysis, result: &ConditionAnalysis) -> Vec<(&'a str, String)> {
    let bounds = result.gain_bounds();
    let (gains, delays) = (&result.gains, &result.delays);
    let bound = gains.proof.lower_bound;
    let at_least = if bound.is_finite() { format!(", lower bound {}", compact(bound)) } else { String::new() };
    let scheduled = if analysis.study.choice(result.condition.id()).scheduled { "yes" } else { "no" };
    vec![
        ("Flight state", flight_words(&result.condition)),
        ("Physics models", representative(analysis, result, BundleKind::Physics)),
        ("Identified models", representative(analysis, result, BundleKind::Identified)),
        ("Bounds of the gains", format!("{} to {}", decimals(bounds.lower, 4), decimals(bounds.upper, 4))),
        (
            "Bounds of the delays",
            format!(
                "{} to {} ms",
                compact(s_to_ms(result.delay_bounds_s()[0])),
                decimals(s_to_ms(result.delay_upper_s()), 2)
            ),
        ),
        ("Objective of the gains", format!("{}{at_least}; {}", compact(gains.objective), proof_word(result))),
        ("Objective of the delays", format!("{} s²; the least, for the program is convex", compact(delays.objective))),
        ("In the schedule", scheduled.to_owned()),
    ]
}

fn flight_words(condition: &Condition) -> String {
    let state = condition.flight_state();
    let altitude = state.altitude_ft.map(|altitude| format!("{} ft", number(altitude)));
    let mass = state.mass_kg.map(|mass| format!("{} kg", number(mass)));
    let classes = [(&state.altitude, "altitude"), (&state.weight, "weight")];
    let classes = classes.map(|(class, of)| class.as_ref().map(|class| format!("{class} {of}")));
    let [altitude_class, weight_class] = classes;
    let parts = [Some(format!("{} kt", number(state.airspeed_kt))), altitude_class, altitude, weight_class, mass];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// How many models of a bundle are kept, and which of them represents it.
fn representative(analysis: &Analysis, result: &ConditionAnalysis, kind: BundleKind) -> String {
    let choice = analysis.study.choice(result.condition.id()).bundle(kind);
    let name = result.representative_name(kind);
    let all = result.condition.bundle(kind).len();
    let pinned = if choice.pinned.as_deref() == Some(name) { ", chosen by the analyst" } else { "" };
    format!("{} of {all} kept; represented by {name}{pinned}", all - choice.rejected.len().min(all))
}

fn channel_table(analysis: &Analysis, result: &ConditionAnalysis) -> Table {
    let (dataset, correction) = (&analysis.study.dataset, &result.correction);
    let title = format!("Condition {}: gain and delay of each channel", result.condition.id());
    let mut table = Table::new(title, ["channel", "side", "gain k", "delay τ [ms]"]);
    let [inputs_s, outputs_s] = correction.signed_delays_s();
    let sides = [
        ("input", dataset.inputs(), &correction.input_gains, inputs_s),
        ("output", dataset.outputs(), &correction.output_gains, outputs_s),
    ];
    for (side, channels, gains, delays_s) in sides {
        for ((channel, gain), delay_s) in channels.iter().zip(gains).zip(delays_s) {
            let (gain, delay) = (decimals(*gain, 4), decimals(s_to_ms(*delay_s), 2));
            table.row([channel.name.clone(), side.to_owned(), gain, delay]);
        }
    }
    table
}
