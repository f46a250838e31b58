//! How sure a figure is, and the swaps that say so (M13).

use crate::dataset::{BundleKind, ConditionId};
use crate::study::analysis::Analysis;
use crate::study::swaps::ConditionSwaps;
use crate::uncertainty::{Bar, Part, Scalar};
use crate::units::s_to_ms;

use super::ExplainTarget;

/// The bar of a figure with its parts, and the figure of every swap; nothing where it has no bar, or that was not computed.
pub(super) fn sure(analysis: &Analysis, asked: &ExplainTarget) -> Vec<String> {
    let Some((condition, scalar)) = scalar_of(asked) else { return Vec::new() };
    let Some(uncertainty) = &analysis.uncertainty else { return Vec::new() };
    let Some(of) = uncertainty.conditions.get(&condition) else { return Vec::new() };
    let Some(bar) = &of.bars[scalar] else { return Vec::new() };
    let mut lines = bar_lines(bar, scalar, uncertainty.level);
    lines.extend(swap_lines(analysis, condition, &of.swaps, scalar));
    lines
}

/// The condition and the figure with a bar that is asked about.
fn scalar_of(asked: &ExplainTarget) -> Option<(ConditionId, Scalar)> {
    Some(match asked {
        ExplainTarget::DeltaGain(id, pair) => (*id, Scalar::Gain(*pair)),
        ExplainTarget::DeltaDelay(id, pair) => (*id, Scalar::Delay(*pair)),
        ExplainTarget::NetGain(id, pair) => (*id, Scalar::NetGain(*pair)),
        ExplainTarget::Gain(id, channel) => (*id, Scalar::ChannelGain(*channel)),
        ExplainTarget::Delay(id, channel) => (*id, Scalar::ChannelDelay(*channel)),
        _ => return None,
    })
}

fn bar_lines(bar: &Bar, scalar: Scalar, level: f64) -> Vec<String> {
    let told = |deviation: f64| {
        if scalar.is_delay() { format!("{:.2} ms", s_to_ms(deviation)) } else { format!("{:.2} %", 100.0 * deviation) }
    };
    let part = |name: &str, part: Option<Part>| match part {
        Some(part) => format!("{name}: {} ({:.1} degrees of freedom)", told(part.variance.sqrt()), part.degrees),
        None => format!("{name}: not included"),
    };
    let whole = match (bar.half_width(level), bar.degrees()) {
        (Some(half), Some(degrees)) => {
            format!(
                "bar of {:.0} %: ± {} = t({degrees:.1}) · {} (M13)",
                100.0 * level,
                told(half),
                told(bar.deviation())
            )
        }
        _ => "no bar (M13)".to_owned(),
    };
    let mut lines = vec![whole, part("trim", bar.trim), part("identification", bar.identification)];
    lines.extend(bar.remarks().into_iter().map(str::to_owned));
    if bar.left_out > 0 {
        lines.push(format!("{} swaps have no such figure", bar.left_out));
    }
    lines
}

/// The figure with each other model in place of the representative.
fn swap_lines(analysis: &Analysis, condition: ConditionId, swaps: &ConditionSwaps, scalar: Scalar) -> Vec<String> {
    let Some(result) = analysis.condition(condition) else { return Vec::new() };
    let line = |(kind, model, figures): &(BundleKind, usize, _)| {
        let name = &result.condition.bundle(*kind)[*model].name;
        let figures: &Option<std::sync::Arc<crate::uncertainty::Figures>> = figures;
        let figure = figures.as_ref().and_then(|figures| figures[scalar]);
        let words = match figure {
            Some(figure) if scalar.is_delay() => format!("{:.2} ms", s_to_ms(figure)),
            Some(figure) => format!("{:.4}", figure.exp()),
            None => "none".to_owned(),
        };
        format!("with {kind} model {name}: {words}")
    };
    swaps.swaps.iter().map(line).collect()
}
