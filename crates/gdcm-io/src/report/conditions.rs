//! Report section on the conditions, with cautions and a figure for each; and the appendix with
//! representatives, gains and delays with their basis, and all plots.
//!
//! The tables are in `condition_tables`, the plots in `condition_plots`. A *remark* states whether
//! a request, such as matching the held responses, was fulfilled: good, with a caution, or not.

use gdcm_model::dataset::{BundleKind, Condition, ConditionId};
use gdcm_model::number_format::{compact, decimals};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::units::{number, s_to_ms};
use gdcm_plot::figure::caption_words::condition_words;
use gdcm_plot::figure::gains::class_names;
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::remark::Remark;
use gdcm_study::results::remark_kind::RemarkKind;
use gdcm_study::{Analysis, ConditionAnalysis, Engine, Study};
use gdcm_words::caution::failure_text;
use gdcm_words::leads::lead_words;
use gdcm_words::remark::remark_text;
use gdcm_words::solution_details::details;

use super::CancellationOnly;
use super::condition_plots::{add_condition_plots, add_response_plots};
use super::condition_tables::{
    add_models_omitted, add_responses, channel_table, condition_table, model_table, proof_word,
};
use super::limits::CONDITIONS_DRAWN;
use super::page::Page;
use super::wording::names;

/// Adds the section on the conditions: an overview, the remarks that need attention, and a figure
/// with each condition's on-axis responses.
///
/// # Errors
/// [`Cancelled`] soon after `progress` requests it.
pub(super) fn add_conditions(
    page: &mut Page,
    analysis: &Analysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<(), Cancelled> {
    page.section("Conditions");
    page.table(&condition_table(analysis));
    page.list(shared_remarks(analysis));
    let conditions = analysis.study.dataset.conditions();
    if conditions.len() > CONDITIONS_DRAWN {
        page.paragraph(&format!(
            "Only the first {CONDITIONS_DRAWN} conditions have figures here; the command gdcm figure \
            draws those of the others."
        ));
    }
    page.paragraph(
        "Magnitude and phase of the models, and of the representative under its own and under \
        the scheduled correction:",
    );
    for condition in conditions.iter().take(CONDITIONS_DRAWN) {
        if let Some(result) = analysis.condition(condition.id()) {
            let step = CancellationOnly(progress);
            add_response_plots(page, analysis, result, engine, &step)?;
        }
    }
    Ok(())
}

/// Remarks with the same code, worded for the first condition that has one.
struct SharedRemark {
    code: &'static str,
    words: String,
    conditions: Vec<ConditionId>,
}

/// Returns the cautions and the unmatched responses: each remark code once, worded for its first
/// condition, followed by the other conditions with such a remark.
fn shared_remarks(analysis: &Analysis) -> Vec<String> {
    let study = &analysis.study;
    let mut shared: Vec<SharedRemark> = Vec::new();
    for result in analysis.conditions.values().flatten() {
        let id = result.condition.id();
        for remark in condition_remarks(study, result, None) {
            if remark.kind() == RemarkKind::Good {
                continue;
            }
            match shared.iter_mut().find(|known| known.code == remark.code()) {
                Some(known) if known.conditions.contains(&id) => {}
                Some(known) => known.conditions.push(id),
                None => shared.push(SharedRemark {
                    code: remark.code(),
                    words: remark_words(&remark, study),
                    conditions: vec![id],
                }),
            }
        }
    }
    let mut lines = Vec::with_capacity(shared.len());
    for remark in shared {
        let ids: Vec<String> = remark.conditions.iter().map(ToString::to_string).collect();
        let [first, others @ ..] = ids.as_slice() else {
            continue;
        };
        let also = match others {
            [] => String::new(),
            [other] => format!(" Likewise in condition {other}."),
            _ => format!(" Likewise in conditions {}.", names(others)),
        };
        lines.push(format!("Condition {first}: {}{also}", remark.words));
    }
    lines
}

/// Adds an appendix with a subsection for each condition: representatives, gains and delays with
/// their basis, and plots for the first [`CONDITIONS_DRAWN`]; or the reason why there is no result.
/// Each condition is a progress step.
///
/// # Errors
/// [`Cancelled`] soon after `progress` requests it.
pub(super) fn add_condition_details(
    page: &mut Page,
    analysis: &Analysis,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<(), Cancelled> {
    page.appendix("Details of the conditions");
    let conditions = analysis.study.dataset.conditions();
    for (index, condition) in conditions.iter().enumerate() {
        if progress.cancelled() {
            return Err(Cancelled);
        }
        page.subsection(&condition_words(condition.flight_state()));
        match analysis.conditions.get(&condition.id()) {
            Some(Ok(result)) => {
                add_result(page, analysis, result);
                if index < CONDITIONS_DRAWN {
                    let step = CancellationOnly(progress);
                    add_condition_plots(page, analysis, result, engine, &step)?;
                }
            }
            Some(Err(failure)) => page.paragraph(&format!(
                "This condition has no result: {}.",
                failure_text(failure, &analysis.study.dataset)
            )),
            None => page.paragraph("This condition was not analysed."),
        }
        progress.advanced(index + 1, conditions.len());
    }
    Ok(())
}

/// Returns a remark as text, which begins with its kind unless it is good.
fn remark_words(remark: &Remark, study: &Study) -> String {
    let text = remark_text(remark, &study.dataset);
    match remark.kind() {
        RemarkKind::Good => text,
        RemarkKind::Caution => format!("Caution: {text}"),
        RemarkKind::Trouble => format!("Not matched: {text}"),
    }
}

/// Adds a condition's results as text and tables.
fn add_result(page: &mut Page, analysis: &Analysis, result: &ConditionAnalysis) {
    page.facts(facts(analysis, result));
    let study = &analysis.study;
    let mut lines = Vec::new();
    for remark in condition_remarks(study, result, None) {
        lines.push(remark_words(&remark, study));
    }
    page.heading_within("Matched and unmatched responses, with reasons");
    page.list(lines);
    page.fine_list(details(study, result));
    if result.compensated.is_some() {
        page.heading_within("Effect and cost of the leads");
        page.list(lead_words(study, result, analysis.uncertainty.as_deref()));
    }
    add_responses(page, study, result);
    page.begin_side_by_side();
    page.table(&channel_table(analysis, result));
    for kind in BundleKind::BOTH {
        page.table(&model_table(study, result, kind));
    }
    page.end_side_by_side();
    for kind in BundleKind::BOTH {
        add_models_omitted(page, study, result, kind);
    }
}

/// Returns names and values for a condition's first table: flight state, bundles, bounds,
/// objectives, and whether the condition is scheduled.
fn facts<'a>(analysis: &Analysis, result: &ConditionAnalysis) -> Vec<(&'a str, String)> {
    let bounds = result.gain_bounds();
    let gains = &result.gains;
    let delays = &result.delays;
    let least_ms = compact(s_to_ms(result.delay_bounds_s()[0]));
    let most_ms = decimals(s_to_ms(result.delay_upper_s()), 2);
    let bound = gains.proof.lower_bound;
    let at_least = if bound.is_finite() {
        format!(", lower bound {}", compact(bound))
    } else {
        String::new()
    };
    let scheduled = if analysis.study.choice(result.condition.id()).scheduled {
        "yes"
    } else {
        "no"
    };
    vec![
        ("Flight state", flight_words(&result.condition)),
        (
            "Physics models",
            representative(analysis, result, BundleKind::Physics),
        ),
        (
            "Identified models",
            representative(analysis, result, BundleKind::Identified),
        ),
        (
            "Bounds of the gains",
            format!(
                "{} to {}",
                decimals(bounds.lower, 4),
                decimals(bounds.upper, 4)
            ),
        ),
        (
            "Bounds of the delays",
            format!("{least_ms} to {most_ms} ms"),
        ),
        (
            "Objective of the gains",
            format!(
                "{}{at_least}; {}",
                compact(gains.objective),
                proof_word(result)
            ),
        ),
        (
            "Objective of the delays",
            format!("{} s²; global optimum (convex)", compact(delays.objective)),
        ),
        ("In the schedule", scheduled.to_owned()),
    ]
}

/// Describes a condition's flight state: "80 kt, sea level, 0 ft, light, 6500 kg".
fn flight_words(condition: &Condition) -> String {
    let state = condition.flight_state();
    let [altitude_class, weight_class] = class_names(state);
    let mut parts = vec![format!("{} kt", number(state.airspeed_kt))];
    parts.extend(altitude_class);
    if let Some(altitude_ft) = state.altitude_ft {
        parts.push(format!("{} ft", number(altitude_ft)));
    }
    parts.extend(weight_class);
    if let Some(mass_kg) = state.mass_kg {
        parts.push(format!("{} kg", number(mass_kg)));
    }
    parts.join(", ")
}

/// Describes how many models in a bundle the analyst has not rejected, and its representative.
fn representative(analysis: &Analysis, result: &ConditionAnalysis, kind: BundleKind) -> String {
    let choice = analysis.study.choice(result.condition.id()).bundle(kind);
    let name = result.representative_name(kind);
    let all = result.condition.bundle(kind).len();
    let pinned = if choice.pinned.as_deref() == Some(name) {
        ", chosen by the analyst"
    } else {
        ""
    };
    format!(
        "{} of {all} kept; represented by {name}{pinned}",
        all - choice.rejected.len().min(all)
    )
}
