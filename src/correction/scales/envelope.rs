//! The convex envelope of a well over an interval.

use super::well::{Jet, Well};

/// A straight line that replaces a well left of `until`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    until: f64,
    at: f64,
    value: f64,
    slope: f64,
    error: f64,
}

/// The well at `v` with the line of its envelope, if there is one, in place of what lies left of it.
pub(super) fn well_jet(well: &Well, line: Option<&Line>, v: f64) -> Jet {
    match line {
        Some(line) if v < line.until => {
            let rise = line.slope * (v - line.at);
            Jet {
                value: line.value + rise,
                slope: line.slope,
                curvature: 0.0,
                value_error: line.error + 8.0 * f64::EPSILON * (line.value.abs() + rise.abs()),
                slope_error: 8.0 * f64::EPSILON * line.slope.abs(),
            }
        }
        _ if well.is_flat() => Jet::default(),
        _ => well.at(v.exp()),
    }
}

/// The line of the convex envelope of a well over `[low, high]`: none where it is convex there, the chord where the line from
/// the left end is nowhere tangent, else the tangent, with the well itself to the right of it.
pub(super) fn envelope(well: &Well, low: f64, high: f64) -> Option<Line> {
    if well.is_flat() || low >= well.inflection() {
        return None;
    }
    let start = well.at(low.exp());
    let end = well.at(high.exp());
    // Height over the well's left end of the tangent at b: falls as b moves right of the inflection.
    let overshoot = |b: f64, jet: &Jet| jet.value + jet.slope * (low - b) - start.value;
    if high <= well.inflection() || overshoot(high, &end) >= 0.0 {
        let slope = if high > low { (end.value - start.value) / (high - low) } else { 0.0 };
        let error = start.value_error + end.value_error;
        return Some(Line {
            until: f64::INFINITY,
            at: low,
            value: start.value.min(end.value - slope * (high - low)),
            slope,
            error,
        });
    }
    let (mut over, mut under) = (well.inflection().max(low), high);
    let mut tangent = end;
    // Newton's method from the bracket's right side, any point of which is valid: near the tangent is near enough.
    for _ in 0..14 {
        let excess = overshoot(under, &tangent);
        let newton = under - excess / (tangent.curvature * (low - under));
        let next = if over < newton && newton < under { newton } else { 0.5 * (over + under) };
        let jet = well.at(next.exp());
        if overshoot(next, &jet) > 0.0 {
            over = next;
        } else {
            under = next;
            tangent = jet;
        }
        if -overshoot(under, &tangent) <= 1e-9 * start.value {
            break;
        }
    }
    let error = start.value_error + tangent.value_error + tangent.slope_error * (under - low);
    Some(Line { until: under, at: under, value: tangent.value, slope: tangent.slope, error })
}
