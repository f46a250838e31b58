//! The convex envelope of one exponential over an interval.

use super::exponential::{Derivatives, Exponential};
use super::rounded::Rounded;

/// The line of a convex envelope: it replaces the exponential left of `until`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    until: f64,
    at: f64,
    value: Rounded,
    slope: f64,
}

/// The exponential at `v` with the line of its envelope, if there is one, in place of what lies left of it.
pub(super) fn enveloped(function: &Exponential, line: Option<&Line>, v: f64) -> Derivatives {
    match line {
        Some(line) if v < line.until => {
            let rise = line.slope * (v - line.at);
            let moved = f64::EPSILON * (2.0 * rise.abs() + (line.slope * v).abs());
            let mut value = line.value;
            value.add(Rounded { value: rise, error: moved });
            Derivatives { value, slope: Rounded { value: line.slope, error: 0.0 }, curvature: 0.0 }
        }
        _ if function.is_zero() => Derivatives::default(),
        _ => function.at(v, v.exp()),
    }
}

/// The line of the convex envelope of an exponential over `[low, high]`: none where it is convex there, the chord where the line
/// from the left end is nowhere tangent, else the tangent, with the exponential itself to the right of it.
pub(super) fn envelope(function: &Exponential, (low, high): (f64, f64)) -> Option<Line> {
    if function.is_zero() || low >= function.inflection() {
        return None;
    }
    let start = function.at(low, low.exp());
    let end = function.at(high, high.exp());
    // Height over the left end of the tangent at b: falls as b moves right of the inflection.
    let overshoot = |b: f64, at: &Derivatives| at.value.value + at.slope.value * (low - b) - start.value.value;
    if high <= function.inflection() || overshoot(high, &end) >= 0.0 {
        return Some(chord((low, start.value), (high, end.value)));
    }
    let (mut over, mut under) = (function.inflection().max(low), high);
    let mut tangent = end;
    // Newton's method from the bracket's right side, any point of which is valid: near the tangent is near enough.
    for _ in 0..14 {
        let excess = overshoot(under, &tangent);
        let newton = under - excess / (tangent.curvature * (low - under));
        let next = if over < newton && newton < under { newton } else { 0.5 * (over + under) };
        let at = function.at(next, next.exp());
        if overshoot(next, &at) > 0.0 {
            over = next;
        } else {
            under = next;
            tangent = at;
        }
        if -overshoot(under, &tangent) <= 1e-9 * start.value.value {
            break;
        }
    }
    let error = start.value.error + tangent.value.error + 2.0 * tangent.slope.error * (under - low);
    let value = Rounded { value: tangent.value.value, error: error + 4.0 * f64::EPSILON * start.value.value };
    Some(Line { until: under, at: under, value, slope: tangent.slope.value })
}

/// The line through both ends, or below them by their rounding.
fn chord((low, start): (f64, Rounded), (high, end): (f64, Rounded)) -> Line {
    let slope = if high > low { (end.value - start.value) / (high - low) } else { 0.0 };
    let error = start.error + end.error + 4.0 * f64::EPSILON * (start.value.abs() + end.value.abs());
    let value = start.value.min(end.value - slope * (high - low));
    Line { until: f64::INFINITY, at: low, value: Rounded { value, error }, slope }
}
