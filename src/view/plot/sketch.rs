//! A sparkline as it was drawn last.

use std::sync::Arc;

use egui::{Painter, Rect, Shape};

use super::curve::{BodeCurve, Pane};
use super::range::Range;
use super::role::Role;
use super::sparkline::Sparkline;
use crate::view::palette::Palette;

/// A sparkline as shapes, kept as long as it would come out the same: making it costs far more than showing it again.
#[derive(Clone, Debug, Default)]
pub(super) struct Sketch {
    drawn_from: Option<Subject>,
    shapes: Vec<Shape>,
    range_text: String,
}

impl Sketch {
    /// Draws `curves` into `rect`, anew only where something changed since the last frame.
    pub(super) fn paint(
        &mut self,
        painter: &Painter,
        curves: &[BodeCurve],
        (pane, rect): (Pane, Rect),
        log_omega: Range,
        palette: &Palette,
    ) {
        let place = Place { rect, log_omega, palette: *palette, pixels_per_point: painter.pixels_per_point() };
        if !self.drawn_from.as_ref().is_some_and(|subject| subject.is(curves, pane, &place)) {
            let sparkline = Sparkline::new(curves, pane, log_omega, rect);
            self.range_text = sparkline.as_ref().map(Sparkline::range_text).unwrap_or_default();
            self.shapes =
                sparkline.map(|sparkline| sparkline.shapes(&place.palette, place.pixels_per_point)).unwrap_or_default();
            self.drawn_from =
                Some(Subject { lines: curves.iter().map(|curve| Trace::of(curve, pane)).collect(), place });
        }
        painter.extend(self.shapes.iter().cloned());
    }

    /// The part of the vertical axis that was in view, in words; empty where there was nothing to draw.
    pub(super) fn range_text(&self) -> &str {
        &self.range_text
    }
}

/// What a sketch was drawn from.
#[derive(Clone, Debug)]
struct Subject {
    lines: Vec<Trace>,
    place: Place,
}

impl Subject {
    fn is(&self, curves: &[BodeCurve], pane: Pane, place: &Place) -> bool {
        let same = |(line, curve): (&Trace, &BodeCurve)| line.is(curve, pane);
        self.place == *place && self.lines.len() == curves.len() && self.lines.iter().zip(curves).all(same)
    }
}

/// Where and how a sketch was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    rect: Rect,
    log_omega: Range,
    palette: Palette,
    pixels_per_point: f32,
}

/// What one line of a sketch was drawn from. It holds the numbers, so that no others can take their place in memory.
#[derive(Clone, Debug)]
struct Trace {
    omega: Arc<[f64]>,
    values: Arc<[f64]>,
    role: Role,
    rejected: bool,
    highlighted: bool,
}

impl Trace {
    fn of(curve: &BodeCurve, pane: Pane) -> Self {
        Self {
            omega: Arc::clone(&curve.omega),
            values: Arc::clone(curve.shared_values(pane)),
            role: curve.role,
            rejected: curve.rejected,
            highlighted: curve.highlighted,
        }
    }

    fn is(&self, curve: &BodeCurve, pane: Pane) -> bool {
        Arc::ptr_eq(&self.omega, &curve.omega)
            && Arc::ptr_eq(&self.values, curve.shared_values(pane))
            && (self.role, self.rejected, self.highlighted) == (curve.role, curve.rejected, curve.highlighted)
    }
}
