//! Sentences and tables about named physics parameters (M18.4 to M18.6 in `docs/physics.md`).
//!
//! A parameter needs a "change to agree with flight", or "acts like" another: the diagnosis never
//! states a cause, because a parameter of similar effect that was not offered cannot be excluded.
//!
//! | term | meaning |
//! |---|---|
//! | run | physics model linearised with one parameter changed |
//! | rerun | physics model linearised with several parameters changed, to check the prediction |
//! | step | position in the stepwise list, which adds the parameter that explains most next |
//! | learned | share of a parameter's prior variance that the data remove |
//! | imitated by channels | share of a parameter's effect that channel gains and delays can explain |

mod diagnosis_cautions;
mod left_out_runs;
mod parameter_change;
mod rerun;

use gdcm_method::physics::intervals::LEAST_CONDITIONS;
use gdcm_method::physics::verdict::LEAST_EXPLAINED;
use gdcm_method::physics::{Verdict, WhyNotNamed};
use gdcm_model::number_format::{counted, decimals, signed};
use gdcm_model::units::number;
use gdcm_study::results::physics_assessment::PhysicsAssessment;
use gdcm_study::results::physics_findings::{DiagnosedParameter, PhysicsFindings};

use crate::couplings::cost_table;
use crate::table::Table;

use parameter_change::{half_width_decimals, unit_text};

pub use diagnosis_cautions::{diagnosis_cautions, pull_lines};
pub use left_out_runs::left_out_lines;
pub use parameter_change::{applied_value_list, applied_value_text, change_text, paste_block};
pub use rerun::rerun_text;

/// Sentence displayed beside every verdict.
pub const LIKE_EFFECT: &str =
    "A parameter with a similar effect that is not listed may be the real cause.";

/// Displayed beside error bars where parameters are moved.
pub const BARS_KEEP_VALUES: &str =
    "error bars hold these values fixed: the uncertainty of the values is not included";

/// States the verdict on the parameters, and that a parameter with like effect cannot be excluded.
pub fn verdict_text(findings: &PhysicsFindings) -> String {
    format!("{} {LIKE_EFFECT}", verdict_sentence(findings))
}

/// States the verdict, or that there are too few conditions for one.
fn verdict_sentence(findings: &PhysicsFindings) -> String {
    let diagnosis = &findings.diagnosis;
    let count = findings.parameters.len();
    let (Some(verdict), Some(explained)) = (diagnosis.verdict, diagnosis.explained()) else {
        return format!(
            "{} in the fit, {LEAST_CONDITIONS} are needed: the values have no intervals, and no \
            parameter is named.",
            counted(diagnosis.conditions.len(), "condition")
        );
    };
    let explained = percent(explained);
    let named = findings.named();
    match verdict {
        Verdict::None if count == 1 => format!(
            "The parameter explains only {explained} of the misfit that remains after the \
            channels' gains and delays."
        ),
        Verdict::None => format!(
            "The {count} parameters explain only {explained} of the misfit that remains after the \
            channels' gains and delays."
        ),
        Verdict::Accounts if named.is_empty() => format!(
            "The parameters together explain {explained} of the misfit that remains after the \
            channels' gains and delays, but no single one is named."
        ),
        Verdict::Accounts => format!(
            "{}. The parameters explain {explained} of the misfit that remains after the channels' \
            gains and delays; the rest is close to the spread of the identified models.",
            needed_changes_text(&named)
        ),
        Verdict::InPart if named.is_empty() => format!(
            "The parameters explain {explained} of the misfit that remains after the channels' \
            gains and delays, but no single one is named. Differences outside these parameters \
            remain."
        ),
        Verdict::InPart => format!(
            "{}. The parameters explain {explained} of the misfit that remains after the channels' \
            gains and delays. Differences outside these parameters remain.",
            needed_changes_text(&named)
        ),
    }
}

/// Formats a share in percent; a small negative share is zero.
fn percent(share: f64) -> String {
    format!("{} %", decimals((100.0 * share).max(0.0), 0))
}

/// Lists the changes that named parameters need: "Changes needed to agree with flight: tail_lift
/// +10 ± 2 %".
fn needed_changes_text(named: &[DiagnosedParameter<'_>]) -> String {
    let mut changes = Vec::new();
    for diagnosed in named {
        let change = change_text(
            diagnosed.parameter,
            diagnosed.change(),
            diagnosed.half_width(),
        );
        changes.push(format!("{} {change}", diagnosed.parameter.name));
    }
    format!("Changes needed to agree with flight: {}", joined(&changes))
}

/// Joins parts by commas and "and".
fn joined(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [only] => only.clone(),
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
    }
}

/// Describes the diagnosis of a parameter: the change that it needs, or why it is not named.
pub fn parameter_text(diagnosed: DiagnosedParameter<'_>) -> String {
    let parameter = diagnosed.parameter;
    let change = change_text(parameter, diagnosed.change(), diagnosed.half_width());
    match diagnosed.diagnosis.why_not_named {
        None => format!("change needed to agree with flight: {change}"),
        Some(WhyNotNamed::Held) => format!("held by hand at {change}"),
        Some(WhyNotNamed::FewConditions { found: count }) => format!(
            "not named: {} in the fit, but {LEAST_CONDITIONS} are needed",
            counted(count, "condition")
        ),
        Some(WhyNotNamed::NotPredicted) => {
            "not named: conditions left out of the fit could not be predicted, or have no misfit to explain".to_owned()
        }
        Some(WhyNotNamed::NothingExplained { .. }) => format!(
            "no change proposed: all parameters together explain less than {} of the misfit",
            percent(LEAST_EXPLAINED)
        ),
        Some(WhyNotNamed::AtBound { z }) => format!(
            "would need to {} by {}, more than is plausible: look for a parameter of similar \
            effect",
            if z < 0.0 { "decrease" } else { "increase" },
            change_text(parameter, diagnosed.change().abs(), None).trim_start_matches('+')
        ),
        Some(WhyNotNamed::DataSilent { .. }) => "not determined by the data".to_owned(),
        Some(WhyNotNamed::IntervalContainsZero) => match diagnosed.interval() {
            Some([least, most]) => format!(
                "between {} and {}: no change needed",
                interval_end(least, diagnosed),
                interval_end(most, diagnosed)
            ),
            None => "no change needed".to_owned(),
        },
        Some(WhyNotNamed::LittleGain { .. }) => format!(
            "no change proposed: {change} hardly improves the prediction of conditions left out of \
            the fit"
        ),
    }
}

/// Describes the diagnosis of a parameter in a few words, for a narrow column; `why_not` is `None`
/// for a named parameter.
pub fn naming_words(why_not: Option<WhyNotNamed>) -> &'static str {
    match why_not {
        None => "change needed",
        Some(WhyNotNamed::Held) => "held by hand",
        Some(WhyNotNamed::FewConditions { .. }) => "too few conditions",
        Some(WhyNotNamed::NotPredicted) => "not predicted",
        Some(WhyNotNamed::NothingExplained { .. }) => "explains little",
        Some(WhyNotNamed::AtBound { .. }) => "implausibly large",
        Some(WhyNotNamed::DataSilent { .. }) => "not determined",
        Some(WhyNotNamed::IntervalContainsZero) => "no change needed",
        Some(WhyNotNamed::LittleGain { .. }) => "little benefit",
    }
}

fn interval_end(end: f64, diagnosed: DiagnosedParameter<'_>) -> String {
    let count = half_width_decimals(diagnosed.half_width().unwrap_or(1.0));
    format!(
        "{}{}",
        signed(end, count),
        unit_text(&diagnosed.parameter.unit)
    )
}

/// Tabulates the parameters: change and half-width; plausible change; share of the misfit explained
/// alone; step that adds the parameter to the fit, and share explained by this step; share of the
/// prior variance removed by the data; share of the effect that channels can imitate; verdict.
/// `level` is the confidence level of the half-width, 0 to 1. The last rows are the parameters that
/// are switched off.
pub fn parameter_table(findings: &PhysicsFindings, level: f64) -> Table {
    let bar = format!("± {} %", number(100.0 * level));
    let columns = [
        "parameter".to_owned(),
        "unit".to_owned(),
        "change".to_owned(),
        bar,
        "plausible ±".to_owned(),
        "explained alone [%]".to_owned(),
        "step".to_owned(),
        "explained by step [%]".to_owned(),
        "learned from data [%]".to_owned(),
        "imitated by channels [%]".to_owned(),
        "verdict".to_owned(),
    ];
    let mut table = Table::new("Physics parameters", columns);
    for diagnosed in findings.diagnosed() {
        let diagnosis = diagnosed.diagnosis;
        let half_width = diagnosed.half_width();
        let count = half_width_decimals(half_width.unwrap_or(diagnosed.parameter.plausible_sd));
        table.row([
            diagnosed.parameter.name.clone(),
            diagnosed.parameter.unit.clone(),
            signed(diagnosed.change(), count),
            cell(half_width, count),
            number(diagnosed.parameter.plausible_sd),
            cell(diagnosis.ratio_alone.map(|ratio| 100.0 * (1.0 - ratio)), 1),
            match diagnosis.step {
                Some(step) => step.to_string(),
                None => String::new(),
            },
            cell(diagnosis.gain.map(|gain| 100.0 * gain), 1),
            cell(diagnosis.learned.map(|learned| 100.0 * learned), 0),
            cell(diagnosis.channels_can_take.map(|share| 100.0 * share), 0),
            parameter_text(diagnosed),
        ]);
    }
    for parameter in &findings.off {
        table.row([
            parameter.name.clone(),
            parameter.unit.clone(),
            String::new(),
            String::new(),
            number(parameter.plausible_sd),
            String::new(),
            String::new(),
            String::new(),
            String::new(),
            String::new(),
            "off".to_owned(),
        ]);
    }
    table
}

/// Formats a number; empty if it is missing.
fn cell(value: Option<f64>, count: usize) -> String {
    match value {
        Some(value) => decimals(value, count),
        None => String::new(),
    }
}

/// Tabulates mean J without and with the parameters.
pub fn physics_cost_table(assessment: &PhysicsAssessment) -> Table {
    cost_table(&assessment.costs, assessment.moved_uncorrected)
}

/// Tabulates the channels' mean signed delays \[ms\] without and with the parameters: what a
/// parameter takes over from the leads.
pub fn channel_delay_table(
    assessment: &PhysicsAssessment,
    inputs: &[String],
    outputs: &[String],
) -> Table {
    let columns = ["channel", "without [ms]", "with [ms]"];
    let mut table = Table::new("Mean delays of the channels (leads negative)", columns);
    let Some(mean) = assessment.mean_delays_s() else {
        return table;
    };
    let without = mean.without.inputs.iter().chain(&mean.without.outputs);
    let with = mean.with.inputs.iter().chain(&mean.with.outputs);
    for ((name, without_s), with_s) in inputs.iter().chain(outputs).zip(without).zip(with) {
        table.row([
            name.clone(),
            decimals(1e3 * without_s, 1),
            decimals(1e3 * with_s, 1),
        ]);
    }
    table
}
