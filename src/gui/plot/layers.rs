//! Layers used by several plots: shades, areas, lines across a panel.

use std::ops::RangeInclusive;

use egui::{Color32, Shape, Stroke, Ui};
use egui_plot::{
    Axis, FilledArea, HLine, LineStyle, PlotBounds, PlotGeometry, PlotItem, PlotItemBase,
    PlotTransform, PlotUi, Span, VLine,
};

/// Distance between dots \[pt\].
const DOT_SPACING: f32 = 4.0;

/// Shades a horizontal range.
pub(super) fn add_shade(plot: &mut PlotUi<'_>, range: RangeInclusive<f64>, fill: Color32) {
    plot.span(Span::new("", range).fill(fill).border_width(0.0));
}

/// Shades a vertical range.
pub(super) fn add_shade_of_values(
    plot: &mut PlotUi<'_>,
    range: RangeInclusive<f64>,
    fill: Color32,
) {
    plot.span(
        Span::new("", range)
            .axis(Axis::Y)
            .fill(fill)
            .border_width(0.0),
    );
}

/// Draws a dashed horizontal line across the panel at a value.
pub(super) fn add_dashed_level(plot: &mut PlotUi<'_>, value: f64, stroke: Stroke) {
    let line = HLine::new("", value).stroke(stroke);
    plot.hline(line.style(LineStyle::dashed_dense()).allow_hover(false));
}

/// Fills the area between two lines through `points`: `[x, lower value, upper value]`, all finite.
pub(super) fn add_area(plot: &mut PlotUi<'_>, points: &[[f64; 3]], fill: Color32) {
    let places = column(points, 0);
    let lower = column(points, 1);
    let upper = column(points, 2);
    let area = FilledArea::new("", &places, &lower, &upper);
    plot.add(area.fill_color(fill).allow_hover(false));
}

fn column(points: &[[f64; 3]], index: usize) -> Vec<f64> {
    points.iter().map(|point| point[index]).collect()
}

/// Draws a vertical line across the panel at a horizontal coordinate.
pub(super) fn add_vertical(plot: &mut PlotUi<'_>, place: f64, stroke: Stroke) {
    plot.vline(vertical(place, stroke));
}

/// Draws a dotted vertical line across the panel at a horizontal coordinate.
pub(super) fn add_dotted_vertical(plot: &mut PlotUi<'_>, place: f64, stroke: Stroke) {
    let style = LineStyle::Dotted {
        spacing: DOT_SPACING,
    };
    plot.vline(vertical(place, stroke).style(style));
}

fn vertical(place: f64, stroke: Stroke) -> VLine {
    VLine::new("", place).stroke(stroke)
}

type Drawing<'a> = Box<dyn Fn(&PlotTransform, &mut Vec<Shape>) + 'a>;

/// Layer that draws shapes in screen coordinates; egui_plot ignores it when fitting ranges and when
/// finding the item under the pointer.
pub(super) struct DrawnItem<'a> {
    base: PlotItemBase,
    draw: Drawing<'a>,
}

impl<'a> DrawnItem<'a> {
    /// Creates a layer from the function that adds its shapes.
    pub(super) fn new(draw: impl Fn(&PlotTransform, &mut Vec<Shape>) + 'a) -> Self {
        Self {
            base: PlotItemBase::new(String::new()),
            draw: Box::new(draw),
        }
    }
}

impl PlotItem for DrawnItem<'_> {
    fn shapes(&self, _: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        (self.draw)(transform, shapes);
    }

    fn initialize(&mut self, _: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        Color32::TRANSPARENT
    }

    fn allow_hover(&self) -> bool {
        false
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        PlotBounds::NOTHING
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}
