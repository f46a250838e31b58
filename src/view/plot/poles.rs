//! The s-plane twice: all of it, and the window of the slow modes.

use egui::{CursorIcon, Rect, Response, RichText, Ui, UiBuilder, Vec2, vec2};
use egui_plot::PlotPoint;
use gdcm_core::dataset::ModelId;
use gdcm_files::figure::Range;

use super::axes::{message_ui, use_frame_colors};
use super::readout::tooltip_ui;
use super::s_plane::{PlaneView, PoleMark, plane_ui};
use crate::view::palette::{Palette, SMALL_SIZE};

/// Real and imaginary parts in the window of the slow modes \[rad/s\]: the rigid-body modes of a helicopter lie there.
const SLOW_REAL: Range = Range { min: -2.0, max: 0.6 };
const SLOW_IMAGINARY: Range = Range { min: -3.2, max: 3.2 };
/// Below this, there is no room for two plots beside one another \[pt\].
const LEAST_PAIR_WIDTH: f32 = 620.0;
const LEAST_SIZE: Vec2 = vec2(140.0, 130.0);
const GAP: f32 = 8.0;

/// What the plots of poles show.
#[derive(Clone, Copy, Debug)]
pub struct PolesScene<'a> {
    /// Poles and zeros, in any order; values that are not finite are left out by the caller.
    pub marks: &'a [PoleMark],
    /// What to say where there is nothing to draw.
    pub message: Option<&'a str>,
}

/// What the engineer did in the plots of poles.
#[derive(Clone, Debug, PartialEq)]
pub enum PoleEvent {
    /// The pointer means a pole of this model.
    Hovered(ModelId),
    /// A pole of this model was clicked.
    Clicked(ModelId),
    /// A pole of this model was clicked with Alt held.
    Isolated(ModelId),
}

/// What the plots of poles remember between frames.
#[derive(Clone, Debug, Default)]
pub struct PolesView {
    whole: PlaneView,
    slow: PlaneView,
}

impl PolesView {
    /// Shows all of the poles at the next frame.
    pub fn request_fit(&mut self) {
        self.whole.ranges = None;
        self.slow.ranges = None;
    }

    /// Where a value of λ \[rad/s\] is on the screen, in the plot of the whole plane.
    pub fn screen_position(&self, [real, imaginary]: [f64; 2]) -> Option<egui::Pos2> {
        Some(self.whole.transform.as_ref()?.position_from_point(&PlotPoint::new(real, imaginary)))
    }

    fn fit_if_needed(&mut self, marks: &[PoleMark]) {
        let real = Range::of(marks.iter().map(|mark| mark.value[0]));
        let imaginary = Range::of(marks.iter().map(|mark| mark.value[1]));
        let whole = real.zip(imaginary).map(|(real, imaginary)| {
            let reach = imaginary.max.abs().max(imaginary.min.abs());
            (real.including(0.0).with_margin(0.06, 1.0), Range::new(-reach, reach).with_margin(0.08, 1.0))
        });
        self.whole.ranges = self.whole.ranges.or(whole);
        self.slow.ranges = self.slow.ranges.or(Some((SLOW_REAL, SLOW_IMAGINARY)));
    }
}

/// Draws the s-plane into the space that is left in `ui`.
pub fn poles_ui(ui: &mut Ui, scene: &PolesScene<'_>, view: &mut PolesView, palette: &Palette) -> Vec<PoleEvent> {
    let rect = ui.available_rect_before_wrap();
    let mut events = Vec::new();
    if rect.width() < LEAST_SIZE.x || rect.height() < LEAST_SIZE.y {
        return events;
    }
    if scene.marks.is_empty() {
        message_ui(ui, rect, scene.message.unwrap_or("Nothing to draw"), palette);
        return events;
    }
    view.fit_if_needed(scene.marks);
    let pointer = ui.input(|input| input.pointer.hover_pos());
    ui.scope_builder(UiBuilder::new().id_salt("poles").max_rect(rect), |ui| {
        use_frame_colors(ui, palette);
        for ((title, rect), plane) in planes(rect).into_iter().zip([&mut view.whole, &mut view.slow]) {
            let inside = |at: &egui::Pos2| {
                plane.transform.is_some_and(|t| t.frame().contains(*at)) && ui.rect_contains_pointer(rect)
            };
            let hovered = pointer.filter(inside).and_then(|at| plane.nearest(scene.marks, at));
            let response = plane_ui(ui, (title, rect), scene.marks, (plane, hovered), palette);
            if response.double_clicked() && hovered.is_none() {
                plane.ranges = None;
                response.ctx.request_repaint();
            }
            if let Some(mark) = hovered.map(|hovered| &scene.marks[hovered]) {
                events.extend(mark_events(&response, mark, palette));
            }
        }
    });
    ui.advance_cursor_after_rect(rect);
    events
}

/// Where the plots go: side by side where there is room, else the whole plane alone.
fn planes(rect: Rect) -> Vec<(&'static str, Rect)> {
    let inner = Rect::from_min_max(rect.min, rect.max - vec2(0.0, GAP));
    if rect.width() < LEAST_PAIR_WIDTH {
        return vec![("s-plane", inner)];
    }
    let (left, right) = inner.split_left_right_at_fraction(0.55);
    vec![("s-plane", left), ("s-plane, slow modes", right)]
}

fn mark_events(response: &Response, mark: &PoleMark, palette: &Palette) -> Vec<PoleEvent> {
    tooltip_ui(response, |ui| {
        ui.label(&mark.label);
        for detail in &mark.details {
            ui.label(RichText::new(detail).size(SMALL_SIZE).color(palette.dim_text));
        }
    });
    let mut events = vec![PoleEvent::Hovered(mark.id.clone())];
    response.clone().on_hover_cursor(CursorIcon::PointingHand);
    if response.clicked() {
        let alt = response.ctx.input(|input| input.modifiers.alt);
        events.push(if alt { PoleEvent::Isolated(mark.id.clone()) } else { PoleEvent::Clicked(mark.id.clone()) });
    }
    events
}

#[cfg(test)]
mod tests {
    use super::super::curve_style::Role;
    use super::super::s_plane::MarkShape;
    use super::*;
    use egui::{Pos2, pos2};
    use egui_plot::{PlotBounds, PlotTransform};
    use gdcm_core::dataset::{BundleKind, ConditionId};

    fn mark(name: &str, role: Role, value: [f64; 2]) -> PoleMark {
        PoleMark {
            id: ModelId::new(ConditionId(1), BundleKind::Physics, name),
            label: name.to_owned(),
            details: Vec::new(),
            shape: MarkShape::Cross,
            role,
            rejected: false,
            highlighted: false,
            value,
        }
    }

    /// One rad/s is ten points in both directions; the origin is at (100, 100).
    fn plane() -> PlaneView {
        let frame = Rect::from_min_max(Pos2::ZERO, pos2(200.0, 200.0));
        let transform = PlotTransform::new(frame, PlotBounds::from_min_max([-10.0, -10.0], [10.0, 10.0]), false);
        PlaneView { ranges: None, transform: Some(transform) }
    }

    #[test]
    fn the_nearest_mark_is_meant_and_of_equally_near_ones_the_one_on_top() {
        let marks = [
            mark("a", Role::Perturbed, [-5.0, 0.0]),
            mark("b", Role::Nominal, [-5.0, 0.0]),
            mark("c", Role::Perturbed, [-4.0, 0.0]),
        ];
        let at = |x, y| plane().nearest(&marks, pos2(x, y));
        assert_eq!(at(51.0, 100.0), Some(1));
        assert_eq!(at(58.0, 100.0), Some(2));
        assert_eq!(at(80.0, 100.0), None);
    }

    #[test]
    fn fitting_shows_every_pole_and_the_border_of_stability() {
        let mut view = PolesView::default();
        view.fit_if_needed(&[mark("a", Role::Perturbed, [-9.0, 3.0]), mark("a", Role::Perturbed, [-9.0, -3.0])]);
        let (real, imaginary) = view.whole.ranges.unwrap();
        assert!(real.contains(-9.0) && real.contains(0.0) && imaginary.contains(3.0) && imaginary.contains(-3.0));
    }
}
