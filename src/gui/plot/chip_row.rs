//! Chips in lines: places, appearance and accessible names of the single chips.

use std::sync::Arc;

use egui::{
    Color32, CursorIcon, FontId, Galley, Pos2, Rect, Response, Sense, Stroke, StrokeKind, Ui,
    WidgetInfo, pos2, vec2,
};

use super::curve_style::CurveStyle;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

const CHIP_HEIGHT: f32 = 22.0;
/// Line height, including the gap below \[pt\].
pub(super) const LINE_HEIGHT: f32 = 28.0;
/// Gap between two chips \[pt\].
pub const GAP: f32 = 5.0;
/// Gap between a sample and the chip's text \[pt\].
pub const SAMPLE_GAP: f32 = 6.0;
/// Padding at both ends of a chip \[pt\].
const PAD: f32 = 6.0;

/// A chip's text, name and state.
pub struct ChipFace<'a> {
    pub text: &'a str,
    /// Accessible name.
    pub name: &'a str,
    /// Curve sample, if the chip switches curves.
    pub sample: Option<Sample>,
    /// Whether the outline has the accent colour even when the pointer is elsewhere.
    pub is_lit: bool,
}

#[derive(Clone, Copy)]
pub struct Sample {
    pub style: CurveStyle,
    /// Whether the curves are drawn in the plot.
    pub is_shown: bool,
}

impl ChipFace<'_> {
    /// Returns whether the chip switches curves that are hidden.
    fn is_hidden(&self) -> bool {
        self.sample.is_some_and(|sample| !sample.is_shown)
    }
}

/// Lines of chips in an area, filled from its upper left corner.
pub struct ChipRow {
    area: Rect,
    /// Upper left corner of the next chip.
    corner: Pos2,
    /// Length of curve samples \[pt\].
    sample_length: f32,
}

impl ChipRow {
    /// Starts at the upper left corner of `area`, with samples this long \[pt\].
    pub fn new(area: Rect, sample_length: f32) -> Self {
        Self {
            area,
            corner: area.min,
            sample_length,
        }
    }

    /// Returns the height of all lines up to the last chip \[pt\].
    pub fn height(&self) -> f32 {
        self.corner.y - self.area.top() + LINE_HEIGHT
    }

    /// Returns the last chip's right end.
    pub(in crate::gui) fn line_end(&self) -> f32 {
        self.corner.x - GAP
    }

    /// Draws a chip. With a curve sample it is a switch, pale and with a dashed outline while its
    /// curves are hidden; without a sample it is a button on the same ground as selected rows.
    pub fn chip_ui(&mut self, ui: &Ui, face: &ChipFace<'_>, palette: &Palette) -> Response {
        let text_color = if face.is_hidden() {
            palette.dim_text
        } else {
            palette.text
        };
        let galley = chip_text(ui, face.text, text_color);
        let before = match face.sample {
            Some(_) => self.sample_length + SAMPLE_GAP,
            None => 0.0,
        };
        let place = self.next_place(galley.size().x + before + 2.0 * PAD);
        let id = ui.scope_id().with(("chip", face.name));
        let response = ui.interact(place, id, Sense::click());
        response.widget_info(|| match face.sample {
            Some(sample) => {
                WidgetInfo::selected(egui::Role::CheckBox, true, sample.is_shown, face.name)
            }
            None => WidgetInfo::labeled(egui::Role::Button, true, face.name),
        });
        let is_lit = face.is_lit || response.hovered() || response.has_focus();
        paint_outline(ui, place, face, is_lit, palette);
        if let Some(sample) = face.sample {
            self.paint_sample(ui, place, sample);
        }
        let at = pos2(
            place.left() + PAD + before,
            place.center().y - 0.5 * galley.size().y,
        );
        // The last argument applies only to text that was laid out without a colour.
        ui.painter().galley(at, galley, text_color);
        response.on_hover_cursor(CursorIcon::PointingHand)
    }

    /// Returns the place for the next chip, on a new line if the current line has no room.
    fn next_place(&mut self, width: f32) -> Rect {
        let size = vec2(width, CHIP_HEIGHT);
        if self.corner.x + size.x > self.area.right() && self.corner.x > self.area.left() {
            self.corner = pos2(self.area.left(), self.corner.y + LINE_HEIGHT);
        }
        let place = Rect::from_min_size(self.corner, size);
        self.corner.x = place.right() + GAP;
        place
    }

    fn paint_sample(&self, ui: &Ui, place: Rect, sample: Sample) {
        let mut style = sample.style;
        if !sample.is_shown {
            style.color = style.color.gamma_multiply(0.5);
        }
        let start = pos2(place.left() + PAD, place.center().y);
        let end = pos2(place.left() + PAD + self.sample_length, place.center().y);
        let mut shapes = Vec::new();
        style.add_shapes(vec![start, end], &mut shapes);
        ui.painter().extend(shapes);
    }
}

fn chip_text(ui: &Ui, text: &str, color: Color32) -> Arc<Galley> {
    let font = FontId::proportional(SMALL_SIZE);
    ui.painter().layout_no_wrap(text.to_owned(), font, color)
}

/// Paints a chip's ground and outline, or only a dashed outline if its curves are hidden. The
/// outline has the accent colour if `is_lit`.
fn paint_outline(ui: &Ui, place: Rect, face: &ChipFace<'_>, is_lit: bool, palette: &Palette) {
    let color = if is_lit { palette.accent } else { palette.line };
    let outline = Stroke::new(1.0, color);
    if face.is_hidden() {
        paint_dashed_outline(ui, place, outline);
        return;
    }
    let ground = match face.sample {
        Some(_) => palette.panel,
        None => palette.selected,
    };
    let radius = 0.5 * place.height();
    ui.painter()
        .rect(place, radius, ground, outline, StrokeKind::Inside);
}

/// Paints the outline for a chip whose curves are hidden.
fn paint_dashed_outline(ui: &Ui, place: Rect, line: Stroke) {
    let path = rounded(place.shrink(0.5), 0.5 * place.height());
    ui.painter()
        .extend(egui::Shape::dashed_line(&path, line, 3.0, 3.0));
}

/// Returns a rectangle with semicircular ends of this `radius`, as a closed path.
fn rounded(place: Rect, radius: f32) -> Vec<Pos2> {
    /// Segments in each semicircle.
    const STEPS: usize = 8;
    let quarter = std::f32::consts::FRAC_PI_2;
    let right = pos2(place.right() - radius, place.center().y);
    let left = pos2(place.left() + radius, place.center().y);
    let mut path = Vec::new();
    for (center, from) in [(right, -quarter), (left, quarter)] {
        for step in 0..=STEPS {
            let angle = from + 2.0 * quarter * step as f32 / STEPS as f32;
            path.push(center + radius * vec2(angle.cos(), angle.sin()));
        }
    }
    path.push(path[0]);
    path
}

/// Returns a chip's width without its sample, including the gap to the next chip \[pt\].
pub fn chip_width(ui: &Ui, text: &str) -> f32 {
    chip_text(ui, text, Color32::PLACEHOLDER).size().x + 2.0 * PAD + GAP
}
