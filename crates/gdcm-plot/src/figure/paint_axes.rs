//! Paints a panel's axes: grid, ticks, tick labels and axis labels.

use super::axis::Axis;
use super::drawing::{Anchor, Area, Color, Shape, Stroke, Text};
use super::layout::{LABEL_PT, SMALL_PT, TICK};
use super::letters::{HALF_LETTER_HEIGHT, width};
use super::marks::Along;
use super::placed::{Placed, Side};

const TICK_LINE: Stroke = Stroke::solid(Color::DIM, 0.6);
const GRID: Stroke = Stroke::solid(Color::GRID, 0.4);
/// Length of an unlabelled tick on a horizontal axis, relative to a labelled tick.
const MINOR: f64 = 0.6;
/// Space between a tick and its label on a vertical axis \[pt\].
const TICK_LABEL_GAP: f64 = 1.5;
/// Space between the tick labels and the label of a vertical axis \[pt\].
const VERTICAL_LABEL_GAP: f64 = 2.5;
/// Amount by which the label of a horizontal axis is moved towards the tick labels \[pt\].
const HORIZONTAL_LABEL_RISE: f64 = 0.5;

/// Paints the grid: a line at each tick, except on an axis with names.
pub(super) fn grid(placed: &Placed<'_>) -> Vec<Shape> {
    let panel = placed.panel;
    let mut lines = Vec::new();
    for (along, axis, side) in [
        (Along::X, &panel.x, &placed.x),
        (Along::Y, &panel.y, &placed.y),
    ] {
        if axis.names.is_some() {
            continue;
        }
        for tick in &side.ticks {
            if let Some(ends) = placed.across(along, tick.value) {
                lines.push(Shape::line(ends, GRID));
            }
        }
    }
    lines
}

/// Paints ticks, tick labels and the axis label below a frame.
pub(super) fn horizontal_axis(side: &Side, axis: &Axis, frame: Area) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for tick in &side.ticks {
        let Some(fraction) = axis.fraction(tick.value, side.range) else {
            continue;
        };
        let [x, y] = frame.at(fraction, 0.0);
        let length = match tick.label {
            Some(_) => TICK,
            None => MINOR * TICK,
        };
        shapes.push(Shape::line([[x, y], [x, y + length]], TICK_LINE));
        if side.has_numbers
            && let Some(label) = &tick.label
        {
            let text = Text::new([x, y + TICK + SMALL_PT], label, SMALL_PT);
            shapes.push(Shape::Text(text.anchored(Anchor::Middle)));
        }
    }
    if side.has_label {
        // A label wider than the frame begins at the frame's left edge.
        let is_wide = LABEL_PT * width(&axis.label) > frame.width;
        let anchor = if is_wide {
            Anchor::Start
        } else {
            Anchor::Middle
        };
        let [x, y] = frame.at(anchor.before(), 0.0);
        let place = [x, y + side.depth + LABEL_PT - HORIZONTAL_LABEL_RISE];
        let text = Text::new(place, &axis.label, LABEL_PT);
        shapes.push(Shape::Text(text.anchored(anchor)));
    }
    shapes
}

/// Paints ticks, tick labels and the axis label to the left of a frame.
pub(super) fn vertical_axis(side: &Side, axis: &Axis, frame: Area) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for tick in &side.ticks {
        let Some(fraction) = axis.fraction(tick.value, side.range) else {
            continue;
        };
        let [x, y] = frame.at(0.0, fraction);
        shapes.push(Shape::line([[x - TICK, y], [x, y]], TICK_LINE));
        if side.has_numbers
            && let Some(label) = &tick.label
        {
            let place = [x - TICK - TICK_LABEL_GAP, y + HALF_LETTER_HEIGHT * SMALL_PT];
            let text = Text::new(place, label, SMALL_PT);
            shapes.push(Shape::Text(text.anchored(Anchor::End)));
        }
    }
    if side.has_label {
        let [x, y] = frame.at(0.0, 0.5);
        let place = [x - side.depth - VERTICAL_LABEL_GAP, y];
        let text = Text::new(place, &axis.label, LABEL_PT);
        shapes.push(Shape::Text(text.anchored(Anchor::Middle).upright(true)));
    }
    shapes
}
