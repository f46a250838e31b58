//! Paints the marks that are clipped to a panel's frame: backgrounds, lines and bars.
//!
//! For paper and for the screen, with a single difference: an envelope with edges is two lines on
//! paper, an area on the screen. Order of painting (`paint.rs`): [`backgrounds`]; grid, which the
//! window draws itself; lines and bars in mark order ([`mark_lines`]); dots and notes on top.

use super::drawing::{Color, Shape, Stroke};
use super::marks::{Along, Bars, Brackets, Curve, Envelope, Guide, Intervals, Mark, Spans};
use super::placed::Placed;
use super::thinning::{Pixel, thinned};

/// Print resolution \[pt\], horizontally and vertically: about a tenth of the thinnest curve's
/// width. A thinned line is at most this far from its original points.
const TOLERANCE: f64 = 0.04;
/// Pixel to which curves are thinned: square.
const FINEST: Pixel = Pixel {
    width: TOLERANCE,
    tolerance: TOLERANCE,
};
/// Maximum absolute coordinate \[pt\] in a curve; points beyond it leave a gap.
const FAR_OUT: f64 = 1e6;
/// Style of guides, the labelled grid lines.
const GUIDE: Stroke = Stroke::solid(Color::DIM.tint(40), 0.4);
/// Line around a bar.
const BAR_EDGE: Stroke = Stroke::solid(Color::DIM, 0.3);

/// Paints the backgrounds, which lie below the grid: strips first, then spans and envelopes without
/// edges, both in mark order.
pub(super) fn backgrounds(placed: &Placed<'_>) -> Vec<Shape> {
    let mut shapes = strips(placed);
    for mark in &placed.panel.marks {
        match mark {
            Mark::Spans(spans) => shapes.extend(span_areas(placed, spans)),
            Mark::Envelope(envelope) if envelope.edge.is_none() => {
                shapes.extend(envelope_areas(placed, envelope));
            }
            _ => {}
        }
    }
    shapes
}

fn strips(placed: &Placed<'_>) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for mark in &placed.panel.marks {
        // A strip spans the frame's full height between two vertical lines, at its ends; `across`
        // returns each line's lower end first.
        if let Mark::Strip(strip) = mark
            && let Some([lower_left, _]) = placed.across(Along::X, strip.range.min)
            && let Some([_, upper_right]) = placed.across(Along::X, strip.range.max)
        {
            shapes.push(rectangle(lower_left, upper_right, strip.color, None));
        }
    }
    shapes
}

fn span_areas(placed: &Placed<'_>, spans: &Spans) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for &[x, lower, upper] in &spans.spans {
        if let Some(from) = placed.at([x - 0.5 * spans.width, lower])
            && let Some(to) = placed.at([x + 0.5 * spans.width, upper])
        {
            shapes.push(rectangle(from, to, spans.color, None));
        }
    }
    shapes
}

/// Paints an envelope's area between gaps: a polygon along the lower line and back along the upper
/// line.
///
/// An envelope without edges is always an area, below the grid ([`backgrounds`]). An envelope with
/// edges is two lines on paper ([`mark_lines`]), and an area on the screen (`Panel::shapes`).
pub(super) fn envelope_areas(placed: &Placed<'_>, envelope: &Envelope) -> Vec<Shape> {
    let ends: Vec<Option<[[f64; 2]; 2]>> = envelope
        .points
        .iter()
        .map(|ends| placed.vertical(*ends))
        .collect();
    let mut areas = Vec::new();
    for run in runs(&ends) {
        let lower = run.iter().map(|[low, _]| *low);
        let upper = run.iter().rev().map(|[_, high]| *high);
        areas.push(Shape::Path {
            points: lower.chain(upper).collect(),
            closed: true,
            fill: Some(envelope.color),
            stroke: None,
        });
    }
    areas
}

/// Splits values at gaps into runs of at least two.
fn runs<T: Copy>(values: &[Option<T>]) -> Vec<Vec<T>> {
    values
        .split(Option::is_none)
        .map(|run| run.iter().copied().flatten().collect::<Vec<T>>())
        .filter(|run| run.len() > 1)
        .collect()
}

/// Creates the rectangle between two opposite corners.
fn rectangle(from: [f64; 2], to: [f64; 2], color: Color, stroke: Option<Stroke>) -> Shape {
    Shape::Path {
        points: vec![from, [from[0], to[1]], to, [to[0], from[1]]],
        closed: true,
        fill: Some(color),
        stroke,
    }
}

/// Paints a mark's lines and bars, which lie above the grid; an envelope has lines if it has edges.
pub(super) fn mark_lines(placed: &Placed<'_>, mark: &Mark) -> Vec<Shape> {
    match mark {
        Mark::Curve(curve) => curve_lines(placed, curve),
        Mark::Bars(bars) => bar_areas(placed, bars),
        Mark::Rule(rule) => match placed.across(rule.along, rule.at) {
            Some(ends) => vec![Shape::line(ends, rule.stroke)],
            None => Vec::new(),
        },
        Mark::Guide(guide) => vec![guide_line(placed, guide)],
        Mark::Intervals(intervals) => interval_lines(placed, intervals),
        Mark::Brackets(brackets) => bracket_lines(placed, brackets),
        Mark::Envelope(envelope) => envelope
            .edges()
            .iter()
            .flat_map(|edge| curve_lines(placed, edge))
            .collect(),
        // Strips and spans are backgrounds; dots and notes are painted over the lines.
        Mark::Dots(_) | Mark::Strip(_) | Mark::Spans(_) | Mark::Note(_) => Vec::new(),
    }
}

/// Paints a curve's parts between gaps, thinned for print.
fn curve_lines(placed: &Placed<'_>, curve: &Curve) -> Vec<Shape> {
    let mut positions = Vec::new();
    for point in curve.points() {
        let position = placed.at(point);
        positions.push(position.filter(|[x, y]| x.abs() < FAR_OUT && y.abs() < FAR_OUT));
    }
    runs(&positions)
        .into_iter()
        .map(|run| Shape::line(thinned(&run, FINEST), curve.stroke))
        .collect()
}

/// Paints each bar as a rectangle; `beside` moves it off its x, where other bars may be.
fn bar_areas(placed: &Placed<'_>, bars: &Bars) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for (&[x, _], [foot, top]) in bars.bars.iter().zip(bars.ends()) {
        let left = x + bars.beside - 0.5 * bars.width;
        if let Some(foot) = placed.at([left, foot])
            && let Some(top) = placed.at([left + bars.width, top])
        {
            shapes.push(rectangle(foot, top, bars.color, Some(BAR_EDGE)));
        }
    }
    shapes
}

/// Paints a guide as a single line. Unlike a curve it keeps points beyond [`FAR_OUT`]: a ray has
/// two or three points, the last one often far outside the frame, and would vanish without it.
fn guide_line(placed: &Placed<'_>, guide: &Guide) -> Shape {
    let positions: Vec<[f64; 2]> = guide
        .points
        .iter()
        .filter_map(|point| placed.at(*point))
        .collect();
    Shape::line(positions, GUIDE)
}

fn interval_lines(placed: &Placed<'_>, intervals: &Intervals) -> Vec<Shape> {
    intervals
        .ends
        .iter()
        .filter_map(|ends| placed.vertical(*ends))
        .map(|ends| Shape::line(ends, intervals.stroke))
        .collect()
}

/// Paints each bracket as a single line: hook, spine, hook.
fn bracket_lines(placed: &Placed<'_>, brackets: &Brackets) -> Vec<Shape> {
    let mut lines = Vec::new();
    for bracket in &brackets.brackets {
        if let Some(ends) = placed.bracket(bracket) {
            let [from, to] = ends.spine;
            let [near, far] = ends.hooks;
            lines.push(Shape::line([near, from, to, far], brackets.stroke));
        }
    }
    lines
}
