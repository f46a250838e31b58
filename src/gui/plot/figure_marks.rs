//! A figure's marks on the screen: as on paper, and emphasized under the pointer.
//!
//! A mark ([`Mark`]) is a line, dots, bars or another element of a panel; a dot's id ([`MarkId`])
//! names the object that it represents. The shapes are those of the printed figure, which
//! [`Canvas`] enlarges.

use egui::{Color32, Painter, Pos2, Rect, Stroke, Ui};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_plot::figure::axis::Scale;
use gdcm_plot::figure::drawing::{Area, Shape};
use gdcm_plot::figure::figure::{Dot, Dots};
use gdcm_plot::figure::marks::MarkId;
use gdcm_plot::figure::marks::RING_PT;
use gdcm_plot::figure::paint::DotStyle;
use gdcm_plot::figure::{Mark, Panel, Range};

use super::canvas::{Canvas, LETTERS_PT, SCALE, area};
use super::viewed_range::ranges_of;
use crate::gui::widgets::palette::Palette;

/// Radius of the ring around a dot in focus or under the pointer \[pt\].
pub(super) const RING: f32 = RING_PT as f32 * SCALE;
const RING_WIDTH: f32 = 1.4;
/// Factor by which a highlighted dot is enlarged.
const EMPHASIZED: f64 = 1.3;
/// Minimum dot size before it is enlarged, relative to the usual size.
const LEAST_EMPHASIZED: f64 = 0.8;
/// Opacity of the shade over the column in focus.
const SELECTED_COLUMN: f32 = 0.6;
/// Opacity of the shade over the column under the pointer.
const POINTED_COLUMN: f32 = 0.35;

/// Shapes as last drawn, cached because placing labels takes longer than drawing them.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnMarks {
    drawn: Option<DrawnPanel>,
}

/// A panel's shapes, and the arguments from which they were computed.
#[derive(Clone, Debug)]
struct DrawnPanel {
    panel: Panel,
    area: Area,
    ranges: [Range; 2],
    shapes: Vec<Shape>,
}

impl DrawnMarks {
    /// Returns the panel as last drawn.
    pub(super) fn panel(&self) -> Option<&Panel> {
        Some(&self.drawn.as_ref()?.panel)
    }

    /// Returns the panel's shapes for these ranges, recomputed only if panel, area or ranges have
    /// changed.
    fn shapes(&mut self, panel: &Panel, area: Area, ranges: [Range; 2]) -> &[Shape] {
        let is_same = self.drawn.as_ref().is_some_and(|drawn| {
            drawn.area == area && drawn.ranges == ranges && drawn.panel == *panel
        });
        if !is_same {
            let painted = panel.shapes(area, ranges, LETTERS_PT);
            self.drawn = Some(DrawnPanel {
                panel: panel.clone(),
                area,
                ranges,
                shapes: painted.shapes,
            });
        }
        match &self.drawn {
            Some(drawn) => &drawn.shapes,
            None => &[],
        }
    }
}

/// Marks to draw, and the emphasized marks among them.
pub(super) struct MarkScene<'a> {
    pub(super) panel: &'a Panel,
    pub(super) transform: PlotTransform,
    /// Marks that the columns represent, if columns are interactive rather than dots.
    pub(super) columns: &'a [MarkId],
    /// Mark in focus.
    pub(super) selected: Option<&'a MarkId>,
    /// Mark highlighted in this figure or by another view.
    pub(super) emphasized: Option<&'a MarkId>,
    /// Axis coordinates of the mark under the pointer.
    pub(super) pointed_at: Option<[f64; 2]>,
    /// Opacity of error bars and bands, which fade in when they have been computed.
    pub(super) bars_opacity: f32,
    pub(super) palette: &'a Palette,
}

impl MarkScene<'_> {
    /// Draws the marks, from bottom to top; those near the frame's edge may extend beyond it:
    ///
    /// 1. shades of the columns in focus and under the pointer;
    /// 2. the panel's shapes, as on paper; while error bars fade in, the panel without bars, then
    ///    the whole panel at the bars' opacity over it;
    /// 3. the highlighted dots enlarged, a ring around the dots in focus;
    /// 4. a dim ring around the dot under the pointer.
    pub(super) fn paint(&self, ui: &Ui, drawn: &mut DrawnMarks) {
        let frame = *self.transform.frame();
        let clip = frame.expand(RING).intersect(ui.clip_rect());
        let painter = ui.painter().with_clip_rect(clip);
        // Step 1.
        self.paint_columns(&painter);
        // Step 2.
        let canvas = Canvas {
            painter: &painter,
            origin: frame.min,
            palette: self.palette,
        };
        let [x, y] = ranges_of(self.transform.bounds());
        let ranges = [values_at(self.panel, x), y];
        if self.bars_opacity < 1.0 {
            let bare = without_bars(self.panel);
            canvas.paint(&bare.shapes(area(frame), ranges, LETTERS_PT).shapes);
            let mut fading = painter.clone();
            fading.set_opacity(self.bars_opacity * painter.opacity());
            let canvas = Canvas {
                painter: &fading,
                ..canvas
            };
            canvas.paint(drawn.shapes(self.panel, area(frame), ranges));
        } else {
            canvas.paint(drawn.shapes(self.panel, area(frame), ranges));
        }
        // Step 3.
        for mark in &self.panel.marks {
            if let Mark::Dots(dots) = mark {
                self.paint_emphasis(&canvas, dots);
            }
        }
        // Step 4.
        if let Some(at) = self.pointed_at
            && self.columns.is_empty()
        {
            let [x, y] = at;
            self.paint_ring(&painter, PlotPoint::new(x, y), self.palette.dim_text);
        }
    }

    /// Shades the columns in focus and under the pointer.
    fn paint_columns(&self, painter: &Painter) {
        for (column, id) in self.columns.iter().enumerate() {
            let place = column as f64;
            let strength = if self.selected == Some(id) {
                SELECTED_COLUMN
            } else if self.pointed_at.is_some_and(|at| at[0] == place) {
                POINTED_COLUMN
            } else {
                continue;
            };
            let left = self.transform.position_from_point_x(place - 0.5);
            let right = self.transform.position_from_point_x(place + 0.5);
            let ground = Rect::from_x_y_ranges(left..=right, self.transform.frame().y_range());
            let fill = self.palette.selected.gamma_multiply(strength);
            painter.rect_filled(ground, 0.0, fill);
        }
    }

    /// Enlarges the highlighted dots, and draws a ring around the dots in focus.
    fn paint_emphasis(&self, canvas: &Canvas<'_>, dots: &Dots) {
        for dot in dots.dots.iter().filter(|dot| dot.id.is_some()) {
            if dot.id.as_ref() == self.emphasized {
                let at = canvas.paper_place(self.position(dot));
                let style = DotStyle {
                    size: EMPHASIZED * dots.size.max(LEAST_EMPHASIZED),
                    ..DotStyle::of_group(dots)
                };
                canvas.paint(&style.shapes(at));
            }
            if dot.id.as_ref() == self.selected {
                let at = PlotPoint::new(dot.x, dot.y);
                self.paint_ring(canvas.painter, at, self.palette.text);
            }
        }
    }

    fn paint_ring(&self, painter: &Painter, at: PlotPoint, color: Color32) {
        let at = self.transform.position_from_point(&at);
        painter.circle_stroke(at, RING, Stroke::new(RING_WIDTH, color));
    }

    /// Returns a dot's position on the screen.
    fn position(&self, dot: &Dot) -> Pos2 {
        self.transform
            .position_from_point(&PlotPoint::new(dot.x, dot.y))
    }
}

/// Returns whether a mark appears with the error bars.
fn is_bar(mark: &Mark) -> bool {
    matches!(
        mark,
        Mark::Intervals(_) | Mark::Envelope(_) | Mark::Brackets(_)
    )
}

pub(super) fn has_bars(panel: &Panel) -> bool {
    panel.marks.iter().any(is_bar)
}

fn without_bars(panel: &Panel) -> Panel {
    let mut bare = panel.clone();
    bare.marks.retain(|mark| !is_bar(mark));
    bare
}

/// Converts axis coordinates to values: on the screen, a logarithmic horizontal axis has logarithms
/// as coordinates.
fn values_at(panel: &Panel, places: Range) -> Range {
    match panel.x.scale {
        Scale::Logarithmic => Range::new(10f64.powf(places.min), 10f64.powf(places.max)),
        Scale::Linear | Scale::Degrees => places,
    }
}
