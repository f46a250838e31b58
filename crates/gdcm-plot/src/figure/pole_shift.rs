//! Poles before and after a physics model changes, with an arrow from each pole to its new
//! position.

use nalgebra::Complex;

use gdcm_method::couplings::PoleShift;

use super::arrow::{arrow, spans};
use super::drawing::{Color, Hue, Stroke};
use super::marks::{Curve, DotShape, Dots, Mark};
use super::role::Role;

/// Arrow width \[pt\].
const ARROW: f64 = 1.0;

/// Legend texts for the poles before and after the change, and the colour of the arrows and of the
/// poles after it.
pub(super) struct PoleShiftNames {
    pub(super) before: &'static str,
    pub(super) after: &'static str,
    pub(super) color: Color,
}

impl PoleShiftNames {
    pub(super) const COUPLINGS: Self = Self {
        before: "without couplings",
        after: "with couplings",
        color: Color::new(Hue::Corrected),
    };
}

/// Draws the poles before and after, and an arrow from each pole to its new position; a pole that
/// did not exist before has no arrow.
pub(super) fn pole_shift_marks(shifts: &[PoleShift], names: &PoleShiftNames) -> Vec<Mark> {
    let mut ends = Vec::new();
    let unchanged = Role::Representative.stroke(false).color;
    let mut before = Dots::new(names.before, DotShape::Cross, unchanged)
        .key(names.before)
        .filled(false);
    let mut after = Dots::new(names.after, DotShape::Circle, names.color)
        .key(names.after)
        .filled(false);
    for shift in shifts {
        if let Some(from) = shift.before {
            ends.push([point(from), point(shift.after)]);
            before = before.dot(from.re, from.im, "");
        }
        after = after.dot(shift.after.re, shift.after.im, "");
    }
    let spans = spans(ends.as_flattened());
    let shift = Stroke::solid(names.color, ARROW);
    let mut marks: Vec<Mark> = Vec::new();
    for [from, to] in ends {
        marks.push(Curve::through("moved", shift, arrow(from, to, spans)).into());
    }
    marks.push(before.into());
    marks.push(after.into());
    marks
}

fn point(pole: Complex<f64>) -> [f64; 2] {
    [pole.re, pole.im]
}
