//! Sentences and tables about named physics parameters (M18.4 to M18.6 in `docs/physics.md`).
//!
//! A parameter needs a "change to agree with flight", or "acts like" another: the diagnosis never
//! states a cause, because a parameter of similar effect that was not offered cannot be excluded.
//!
//! | term | meaning |
//! |---|---|
//! | run | physics model linearised with one parameter changed |
//! | base | physics model at the same trim as a run, with the parameter nominal |
//! | rerun | physics model linearised with several parameters changed, to check the prediction |
//! | step | position in the stepwise list, which adds the parameter that explains most next |
//! | learned | share of a parameter's prior variance that the data remove |
//! | imitated by channels | share of a parameter's effect that channel gains and delays can explain |
//! | pull | change in a parameter's value if a condition is left out of the fit |

mod left_out_runs;
mod rerun;

use gdcm_method::physics::diagnosis::NOTABLE_MISFIT;
use gdcm_method::physics::identifiability::WeakDirection;
use gdcm_method::physics::intervals::LEAST_CONDITIONS;
use gdcm_method::physics::verdict::LEAST_EXPLAINED;
use gdcm_method::physics::{OfferedParameter, Verdict, WhyNotNamed};
use gdcm_model::number_format::{counted, decimals, signed, six_digits, with_minus_sign};
use gdcm_model::units::number;
use gdcm_study::results::applied_physics::{AppliedPhysics, AppliedValue};
use gdcm_study::results::physics_assessment::PhysicsAssessment;
use gdcm_study::results::physics_findings::{DiagnosedParameter, PhysicsFindings};

use crate::couplings::cost_table;
use crate::table::Table;

pub use left_out_runs::left_out_lines;
pub use rerun::rerun_text;

/// Sentence displayed beside every verdict.
pub const LIKE_EFFECT: &str =
    "A parameter with a similar effect that is not listed may be the real cause.";

/// Displayed beside error bars where parameters are moved.
pub const BARS_KEEP_VALUES: &str =
    "error bars hold these values fixed: the uncertainty of the values is not included";

/// Maximum number of listed pulls: changes in a value if a condition is left out.
const LISTED_PULLS: usize = 3;

/// Formats a change with its half-width in the parameter's unit: "+1.6 ± 0.2 deg".
pub fn change_text(parameter: &OfferedParameter, change: f64, half_width: Option<f64>) -> String {
    let unit = unit_text(&parameter.unit);
    match half_width {
        Some(half_width) if half_width > 0.0 && half_width.is_finite() => {
            let count = interval_decimals(half_width);
            format!(
                "{} ± {}{unit}",
                signed(change, count),
                decimals(half_width, count)
            )
        }
        _ => format!("{}{unit}", plain_change(change)),
    }
}

/// Formats a change with up to six digits and its sign.
fn plain_change(change: f64) -> String {
    let text = with_minus_sign(&six_digits(change));
    if change > 0.0 {
        format!("+{text}")
    } else {
        text
    }
}

/// Returns the unit after a space; empty for a number without unit ("1").
fn unit_text(unit: &str) -> String {
    if unit == "1" || unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    }
}

/// Returns the decimals that a half-width needs for one significant digit, or two if the first is
/// 1.
fn interval_decimals(half_width: f64) -> usize {
    let exponent = half_width.log10().floor();
    let first_digit = half_width / 10_f64.powf(exponent);
    let mut count = -exponent;
    if first_digit < 2.0 {
        count += 1.0;
    }
    count.clamp(0.0, 9.0) as usize
}

/// Names an applied value: "Ixx +4 %".
pub fn applied_value_text(value: &AppliedValue) -> String {
    format!(
        "{} {}",
        value.parameter.name,
        change_text(&value.parameter, value.change(), value.half_width())
    )
}

/// Lists the applied values: "Ixx +4 %", "tail_lift +10 ± 2 %".
pub fn applied_value_list(applied: &AppliedPhysics) -> Vec<String> {
    applied.values.iter().map(applied_value_text).collect()
}

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
            moves_text(&named)
        ),
        Verdict::InPart if named.is_empty() => format!(
            "The parameters explain {explained} of the misfit that remains after the channels' \
            gains and delays, but no single one is named. Differences outside these parameters \
            remain."
        ),
        Verdict::InPart => format!(
            "{}. The parameters explain {explained} of the misfit that remains after the channels' \
            gains and delays. Differences outside these parameters remain.",
            moves_text(&named)
        ),
    }
}

/// Formats a share in percent; a small negative share is zero.
fn percent(share: f64) -> String {
    format!("{} %", decimals((100.0 * share).max(0.0), 0))
}

/// Lists the changes that named parameters need: "Changes needed to agree with flight: tail_lift
/// +10 ± 2 %".
fn moves_text(named: &[DiagnosedParameter<'_>]) -> String {
    let mut moves = Vec::new();
    for found in named {
        let change = change_text(found.parameter, found.change(), found.half_width());
        moves.push(format!("{} {change}", found.parameter.name));
    }
    format!("Changes needed to agree with flight: {}", joined(&moves))
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
pub fn parameter_text(found: DiagnosedParameter<'_>) -> String {
    let parameter = found.parameter;
    let change = change_text(parameter, found.change(), found.half_width());
    match found.diagnosis.why_not_named {
        None => format!("change needed to agree with flight: {change}"),
        Some(WhyNotNamed::Held) => format!("held by hand at {change}"),
        Some(WhyNotNamed::FewConditions { found: count }) => format!(
            "not named: {} in the fit, but {LEAST_CONDITIONS} are needed",
            counted(count, "condition")
        ),
        Some(WhyNotNamed::NotPredicted) => {
            "not named: conditions left out could not be predicted".to_owned()
        }
        Some(WhyNotNamed::NothingExplained { .. }) => format!(
            "no change proposed: all parameters together explain less than {} of the misfit",
            percent(LEAST_EXPLAINED)
        ),
        Some(WhyNotNamed::AtBound { z }) => format!(
            "would need to {} by {}, more than is plausible: look for a parameter of similar \
            effect",
            if z < 0.0 { "decrease" } else { "increase" },
            change_text(parameter, found.change().abs(), None).trim_start_matches('+')
        ),
        Some(WhyNotNamed::DataSilent { .. }) => "not determined by the data".to_owned(),
        Some(WhyNotNamed::IntervalContainsZero) => match found.interval() {
            Some([least, most]) => format!(
                "between {} and {}: no change needed",
                interval_end(least, found),
                interval_end(most, found)
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

fn interval_end(end: f64, found: DiagnosedParameter<'_>) -> String {
    let count = interval_decimals(found.half_width().unwrap_or(1.0));
    format!("{}{}", signed(end, count), unit_text(&found.parameter.unit))
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
    for found in findings.diagnosed() {
        let diagnosis = found.diagnosis;
        let half_width = found.half_width();
        let count = interval_decimals(half_width.unwrap_or(found.parameter.plausible_sd));
        table.row([
            found.parameter.name.clone(),
            found.parameter.unit.clone(),
            signed(found.change(), count),
            cell(half_width, count),
            number(found.parameter.plausible_sd),
            cell(diagnosis.ratio_alone.map(|ratio| 100.0 * (1.0 - ratio)), 1),
            match diagnosis.step {
                Some(step) => step.to_string(),
                None => String::new(),
            },
            cell(diagnosis.gain.map(|gain| 100.0 * gain), 1),
            cell(diagnosis.learned.map(|learned| 100.0 * learned), 0),
            cell(diagnosis.channels_can_take.map(|share| 100.0 * share), 0),
            parameter_text(found),
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

/// Lists the cautions about the diagnosis.
pub fn diagnosis_cautions(findings: &PhysicsFindings) -> Vec<String> {
    let diagnosis = &findings.diagnosis;
    let mut cautions = Vec::new();
    if let Some(moving) = diagnosis.fit.still_moving {
        cautions.push(format!(
            "the fit has not converged after {} passes: {} still changes, usually because \
            it cannot be told apart from another parameter; set a plausible value for one of \
            the two",
            diagnosis.fit.passes.len(),
            parameter_name(findings, moving)
        ));
    }
    for found in findings.diagnosed() {
        if found.diagnosis.acts_like_channels() {
            cautions.push(format!(
                "{} acts like a gain or a delay of the channels; its value depends on the prior of \
                the channel delays",
                found.parameter.name
            ));
        }
    }
    for pair in &diagnosis.pairs {
        let [first, second] = pair.parameters;
        cautions.push(format!(
            "{} and {} cannot be told apart (correlation {}): set a plausible value for one, or \
            change both",
            parameter_name(findings, first),
            parameter_name(findings, second),
            decimals(pair.correlation, 2)
        ));
    }
    if let Some(weak) = diagnosis.weak_direction() {
        cautions.push(weak_direction_text(weak, findings));
    }
    let poor = diagnosis.poorly_fitted();
    if !poor.is_empty() {
        let ids: Vec<String> = poor.iter().map(|id| id.to_string()).collect();
        cautions.push(format!(
            "condition {}: fitted more than {NOTABLE_MISFIT} times worse than the median \
            condition; check the nominal model and the runs there",
            ids.join(", ")
        ));
    }
    cautions
}

/// Returns a parameter's name; `index` counts the parameters that are on.
fn parameter_name(findings: &PhysicsFindings, index: usize) -> &str {
    &findings.parameters[index].name
}

fn weak_direction_text(weak: &WeakDirection, findings: &PhysicsFindings) -> String {
    /// Smallest component that is listed.
    const LISTED: f64 = 0.2;
    let mut parts = Vec::new();
    for (&parameter, &component) in findings.diagnosis.fit.fitted.iter().zip(&weak.direction) {
        if component.abs() >= LISTED {
            parts.push(format!(
                "{} {}",
                signed(component, 2),
                parameter_name(findings, parameter)
            ));
        }
    }
    format!(
        "the data determine the combination {} (in plausible standard deviations) less than the \
        plausible changes do",
        parts.join(" ")
    )
}

/// Lists the conditions that change a value most when they are left out: "without condition 10,
/// tail_wake changes by −0.4 plausible standard deviations".
pub fn pull_lines(findings: &PhysicsFindings) -> Vec<String> {
    let mut lines = Vec::new();
    for pull in findings.pulls().into_iter().take(LISTED_PULLS) {
        lines.push(format!(
            "without condition {}, {} changes by {} plausible standard deviations",
            pull.condition,
            parameter_name(findings, pull.parameter),
            signed(pull.change, 2)
        ));
    }
    lines
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

/// Returns a text block to paste into the physics model's input: name, change, unit.
pub fn paste_block(applied: &AppliedPhysics) -> String {
    let mut text = String::from("# parameter  change from nominal  unit\n");
    for value in &applied.values {
        let name = &value.parameter.name;
        let change = plain_change(value.change()).replace('\u{2212}', "-");
        text.push_str(&format!("{name} = {change} {}\n", value.parameter.unit));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(unit: &str) -> OfferedParameter {
        OfferedParameter {
            name: "p".to_owned(),
            unit: unit.to_owned(),
            plausible_sd: 1.0,
            description: String::new(),
        }
    }

    #[test]
    fn changes_have_the_digits_of_their_interval() {
        let text = |unit, change, half_width| change_text(&parameter(unit), change, half_width);
        assert_eq!(text("deg", 1.58, Some(0.21)), "+1.6 ± 0.2 deg");
        assert_eq!(text("%", 10.2, Some(2.1)), "+10 ± 2 %");
        assert_eq!(text("1", 0.243, Some(0.17)), "+0.24 ± 0.17");
        assert_eq!(text("%", -12.0, None), "−12 %");
        assert_eq!(text("%", 4.0, Some(0.0)), "+4 %");
    }
}
