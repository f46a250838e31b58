//! One condition in a plot over airspeed: a dot whose shape and filling tell its class.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};
use gdcm_core::dataset::ConditionId;
use gdcm_files::figure::{Area, LabelPlace, LabelledDot, Surroundings, place_labels};

use super::curve_menu::NamedFigure;
use crate::view::palette::Palette;

/// Radius of a dot \[pt\].
pub(super) const DOT_RADIUS: f32 = 4.0;

/// Widths of a bar, and of the thick one in it \[pt\].
const OUTER_WIDTH: f32 = 1.2;
const INNER_WIDTH: f32 = 3.6;
/// Distance of the ring around the condition in focus from its dot \[pt\].
const RING_GAP: f32 = 3.0;

/// The outline of a dot: one for each class of a first property, such as altitude.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DotShape {
    /// The first class.
    #[default]
    Circle,
    /// The second class.
    Diamond,
    /// The third class.
    Square,
    /// Every further class.
    Triangle,
}

impl DotShape {
    /// The shape of the class of this index.
    pub fn of_class(index: usize) -> Self {
        match index {
            0 => Self::Circle,
            1 => Self::Diamond,
            2 => Self::Square,
            _ => Self::Triangle,
        }
    }

    /// Corners about the origin for a dot of radius 1; a circle has none. All shapes cover about the same area.
    fn corners(self) -> &'static [Vec2] {
        const DIAMOND: [Vec2; 4] = [vec2(0.0, -1.3), vec2(1.3, 0.0), vec2(0.0, 1.3), vec2(-1.3, 0.0)];
        const SQUARE: [Vec2; 4] = [vec2(-0.9, -0.9), vec2(0.9, -0.9), vec2(0.9, 0.9), vec2(-0.9, 0.9)];
        const TRIANGLE: [Vec2; 3] = [vec2(0.0, -1.3), vec2(1.2, 0.9), vec2(-1.2, 0.9)];
        match self {
            Self::Circle => &[],
            Self::Diamond => &DIAMOND,
            Self::Square => &SQUARE,
            Self::Triangle => &TRIANGLE,
        }
    }

    fn paint(self, painter: &Painter, center: Pos2, radius: f32, fill: Color32, stroke: Stroke) {
        match self {
            Self::Circle => painter.circle(center, radius, fill, stroke),
            _ => {
                let corners = self.corners().iter().map(|corner| center + *corner * radius).collect();
                painter.add(Shape::convex_polygon(corners, fill, stroke))
            }
        };
    }
}

/// One condition in a plot over airspeed.
#[derive(Clone, Debug)]
pub struct Dot {
    /// How events name the condition.
    pub condition: ConditionId,
    /// The short text beside the dot: the condition's number.
    pub label: String,
    /// Where it stands on the horizontal axis, see [`super::Across`].
    pub x: f64,
    /// Airspeed \[kt\].
    pub airspeed_kt: f64,
    /// The figure, in the unit of its panel: net gain of a pair, gain or delay of a channel.
    pub value: f64,
    /// Between which values the optimum was looked for, in the same unit.
    pub bounds: Option<[f64; 2]>,
    /// How sure the figure is, in the same unit; drawn where it is there.
    pub bar: Option<DotBar>,
    /// Outline: the class of a first property.
    pub shape: DotShape,
    /// Filled or open: the class of a second property.
    pub filled: bool,
    /// Whether it is the condition in focus.
    pub selected: bool,
    /// Whether the schedule is fitted to it.
    pub chosen: bool,
    /// Whether it is held out of the schedule, to judge it: drawn hollow.
    pub held_out: bool,
    /// A further line for hovering: what the caller wants to say. May be empty.
    pub detail: String,
    /// Sentences for hovering: how sure it is, and how it differs from others.
    pub sentences: Vec<String>,
    /// The figures that can be asked about here.
    pub figures: Vec<NamedFigure>,
}

/// How sure a figure is, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DotBar {
    /// For the physics model chosen; none where the identification is not included.
    pub inner: Option<[f64; 2]>,
    /// With not knowing the trim flown.
    pub outer: [f64; 2],
}

impl DotBar {
    /// Draws the bar at the horizontal place `x`; `y` says where a value is.
    pub(super) fn paint(&self, painter: &Painter, x: f32, y: impl Fn(f64) -> f32, color: Color32) {
        for area in self.areas(x, y) {
            painter.rect_filled(area, 0.0, color);
        }
    }

    /// What it covers at the horizontal place `x`: the thin bar, and the thick one in it.
    pub(super) fn areas(&self, x: f32, y: impl Fn(f64) -> f32) -> Vec<Rect> {
        let area = |[low, high]: [f64; 2], width: f32| {
            Rect::from_two_pos(Pos2::new(x - 0.5 * width, y(low)), Pos2::new(x + 0.5 * width, y(high)))
        };
        let inner = self.inner.map(|inner| area(inner, INNER_WIDTH));
        std::iter::once(area(self.outer, OUTER_WIDTH)).chain(inner).collect()
    }
}

impl Dot {
    /// Draws the dot at `center`.
    pub(super) fn paint(&self, painter: &Painter, center: Pos2, is_hovered: bool, palette: &Palette) {
        let color = self.color(palette);
        let radius = if is_hovered { DOT_RADIUS + 1.2 } else { DOT_RADIUS };
        if self.selected {
            painter.circle_stroke(center, radius + RING_GAP, Stroke::new(1.6, palette.text));
        }
        if self.filled && !self.held_out {
            self.shape.paint(painter, center, radius, color, Stroke::NONE);
        } else {
            // An open dot hides the lines that run through it, and looks as large as a filled one.
            self.shape.paint(painter, center, radius - 0.75, palette.background, Stroke::new(1.5, color));
        }
    }

    /// Its colour, and that of its bar.
    pub(super) fn color(&self, palette: &Palette) -> Color32 {
        if self.chosen { palette.perturbed } else { palette.rejected }
    }

    /// How far from its centre a label must stay \[pt\].
    pub(super) fn clearance(&self) -> f32 {
        if self.selected { DOT_RADIUS + RING_GAP + 1.0 } else { DOT_RADIUS }
    }
}

/// Labels as they were placed last: placing them costs more than drawing them, and from frame to frame little moves.
#[derive(Clone, Debug, Default)]
pub struct PlacedLabels {
    /// The dots, and what is around them, that the places are for.
    placed_for: Option<(Vec<LabelledDot>, Surroundings)>,
    places: Vec<Option<LabelPlace>>,
}

impl PlacedLabels {
    /// The places of the labels of `dots`, in their order; none of a label without room.
    pub fn places(&mut self, dots: Vec<LabelledDot>, around: Surroundings) -> &[Option<LabelPlace>] {
        let asked = (dots, around);
        if self.placed_for.as_ref() != Some(&asked) {
            self.places = place_labels(&asked.0, &asked.1);
            self.placed_for = Some(asked);
        }
        &self.places
    }

    /// Whether a label has no room.
    pub fn leaves_some_out(&self) -> bool {
        self.places.iter().any(Option::is_none)
    }
}

/// A rectangle of the screen.
pub(super) fn area(rect: Rect) -> Area {
    Area::new(rect.left().into(), rect.top().into(), rect.width().into(), rect.height().into())
}

/// A place on the screen.
pub(super) fn point(at: Pos2) -> [f64; 2] {
    [at.x.into(), at.y.into()]
}

/// The place on the screen of a point.
pub(super) fn position([x, y]: [f64; 2]) -> Pos2 {
    Pos2::new(x as f32, y as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_placed_anew_where_a_dot_moved() {
        let mut labels = PlacedLabels::default();
        let mut placed = |x: f64| {
            let dots = vec![LabelledDot { center: [x, 80.0], radius: 4.0, size: [12.0, 12.0] }];
            let bounds = Area::new(0.0, 0.0, 140.0, 170.0);
            labels.places(dots, Surroundings { bounds, path: Vec::new(), bars: Vec::new() })[0].unwrap().area
        };
        let (first, again, moved) = (placed(70.0), placed(70.0), placed(75.0));
        assert_eq!(first, again);
        assert_eq!(moved, Area::new(first.left + 5.0, first.top, first.width, first.height));
    }
}
