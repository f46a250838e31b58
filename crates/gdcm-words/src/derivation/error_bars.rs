//! Error bars for explained results, and each result with another model substituted for a
//! representative (M13). An error bar has two parts: *trim*, the spread over the other physics
//! models, and *identification*, the spread over the other identified models or their standard
//! errors.
//!
//! A *scalar* is a result with an error bar; for gains it is the logarithm. Each result is computed
//! again with another model substituted for a representative ([`ModelSwap`], a model exchange).

use gdcm_method::uncertainty::{Bar, Scalar, VarianceComponent};
use gdcm_model::dataset::ConditionId;
use gdcm_model::number_format::counted;
use gdcm_model::units::s_to_ms;
use gdcm_study::results::model_swap::ModelSwap;
use gdcm_study::results::reported_error::{reports_error, takes_reported_error};
use gdcm_study::{Analysis, ConditionAnalysis};

use super::explain_target::ExplainTarget;
use crate::uncertainty::bar_remark_texts;

/// Remark on unconstrained net gains and on channel values, used if the identified models come with
/// standard errors.
pub const SPREAD_ALONE: &str = "its identification part is the spread of the models alone, which is \
    too small if the models share records; the standard errors of the models themselves count \
    only for G, D and held net gains (M13.2)";

/// Describes a result's error bar with its parts, and the result after each substituted model;
/// empty if no error bar is available.
pub(super) fn error_bar_lines(analysis: &Analysis, target: &ExplainTarget) -> Vec<String> {
    lines_of(analysis, target).unwrap_or_default()
}

fn lines_of(analysis: &Analysis, target: &ExplainTarget) -> Option<Vec<String>> {
    let (condition, scalar) = scalar_of(analysis, target)?;
    let uncertainty = analysis.uncertainty.as_ref()?;
    let of_condition = uncertainty.conditions.get(&condition)?;
    let bar = of_condition.bars[scalar].as_ref()?;
    let mut lines = bar_lines(bar, scalar, uncertainty.level);
    if let Some(result) = analysis.condition(condition) {
        if !takes_reported_error(result, scalar) && reports_error(analysis, result) {
            lines.push(SPREAD_ALONE.to_owned());
        }
        for swap in &of_condition.swaps.swaps {
            lines.push(swap_words(result, swap, scalar));
        }
    }
    Some(lines)
}

/// Returns the condition and the scalar whose error bar belongs to a result; `None` for results
/// without error bars.
fn scalar_of(analysis: &Analysis, target: &ExplainTarget) -> Option<(ConditionId, Scalar)> {
    Some(match target {
        ExplainTarget::DeltaGain(id, pair) => (*id, Scalar::Gain(*pair)),
        ExplainTarget::DeltaDelay(id, pair) => {
            (*id, analysis.condition(*id)?.delta_delay_scalar(*pair))
        }
        ExplainTarget::NetGain(id, pair) => (*id, Scalar::NetGain(*pair)),
        ExplainTarget::Gain(id, channel) => (*id, Scalar::ChannelGain(*channel)),
        ExplainTarget::Delay(id, channel) => (*id, Scalar::ChannelDelay(*channel)),
        _ => return None,
    })
}

/// Describes an error bar, its two parts, and its remarks.
fn bar_lines(bar: &Bar, scalar: Scalar, level: f64) -> Vec<String> {
    let whole = match (bar.half_width(level), bar.degrees_of_freedom()) {
        (Some(half_width), Some(degrees)) => format!(
            "{:.0} % error bar: ± {} = t · {}, Student's t with {degrees:.1} degrees of freedom (M13)",
            100.0 * level,
            deviation_words(scalar, half_width),
            deviation_words(scalar, bar.deviation())
        ),
        _ => "no error bar (M13)".to_owned(),
    };
    let mut lines = vec![
        whole,
        part_words("trim", scalar, bar.trim),
        part_words("identification", scalar, bar.identification),
    ];
    lines.extend(bar_remark_texts(bar).into_iter().map(str::to_owned));
    if bar.left_out > 0 {
        let verb = if bar.left_out == 1 { "gives" } else { "give" };
        lines.push(format!(
            "{} {verb} no value of this quantity",
            counted(bar.left_out, "model exchange")
        ));
    }
    lines
}

fn part_words(name: &str, scalar: Scalar, part: Option<VarianceComponent>) -> String {
    match part {
        Some(part) => format!(
            "{name}: standard deviation {} ({:.1} degrees of freedom)",
            deviation_words(scalar, part.variance.sqrt()),
            part.degrees_of_freedom
        ),
        None => format!("{name}: not included"),
    }
}

/// Formats a standard deviation: in ms for a delay; for a gain in percent, because that of a
/// logarithm is relative.
fn deviation_words(scalar: Scalar, deviation: f64) -> String {
    if scalar.is_delay() {
        format!("{:.2} ms", s_to_ms(deviation))
    } else {
        format!("{:.2} %", 100.0 * deviation)
    }
}

/// Describes a result after a model was substituted: "with physics model roll+5: 1.0423".
fn swap_words(result: &ConditionAnalysis, swap: &ModelSwap, scalar: Scalar) -> String {
    let kind = swap.bundle;
    let name = &result.condition.bundle(kind)[swap.model].name;
    let value = swap.figures.as_ref().and_then(|figures| figures[scalar]);
    let words = match value {
        Some(delay_s) if scalar.is_delay() => format!("{:.2} ms", s_to_ms(delay_s)),
        Some(ln_gain) => format!("{:.4}", ln_gain.exp()),
        None => "no value".to_owned(),
    };
    format!("with {kind} model {name} instead of the representative: {words}")
}
