//! Cell of the requirement grid, and the legend that explains its colours.
//!
//! A cell has the corrected model's value, on a warning background if it is outside the limit, and
//! at its left a strip, in the warning colour if the physics model's value is outside.

use egui::{Align2, Color32, Rect, Sense, Stroke, StrokeKind, Ui, Vec2, pos2, vec2};

use gdcm_words::requirement_grid::NOT_DETERMINED_SIGN;

use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium};

/// Width of a cell's strip for the physics model \[pt\].
const STRIP: f32 = 5.0;
/// Distance from a number to its cell's right edge \[pt\].
pub(super) const NUMBER_MARGIN: f32 = 8.0;
/// Share of the warning colour in the background of a cell outside its limit.
const OUTSIDE_TINT: f32 = 0.32;
/// Header width from which the legend also explains undetermined values \[pt\].
const WIDE_LEGEND: f32 = 560.0;

/// Text in a cell, and the facts that determine its colours.
pub(super) struct CellLook<'a> {
    pub(super) text: &'a str,
    /// Whether the cell has a value; a cell without one has neither strip nor background.
    pub(super) has_value: bool,
    pub(super) is_physics_outside: bool,
    pub(super) is_outside: bool,
    /// Whether the text is dim, as it is where nothing is judged.
    pub(super) is_dim: bool,
    pub(super) is_selected: bool,
}

impl CellLook<'_> {
    /// Paints strip, background, right-aligned text, and a frame about the selected cell.
    pub(super) fn paint(&self, ui: &Ui, cell: Rect, palette: &Palette) {
        let painter = ui.painter();
        if self.has_value {
            let strip = cell.with_max_x(cell.left() + STRIP);
            let background = cell.with_min_x(cell.left() + STRIP + 1.0);
            let strip_color = if self.is_physics_outside {
                palette.warning
            } else {
                palette.line
            };
            let background_color = if self.is_outside {
                outside_color(palette)
            } else {
                palette.panel
            };
            painter.rect_filled(strip, 1.5, strip_color);
            painter.rect_filled(background, 2.0, background_color);
        }
        let color = if self.is_dim {
            palette.dim_text
        } else {
            palette.text
        };
        let font = if self.is_selected {
            medium(BODY_SIZE)
        } else {
            body()
        };
        let at = pos2(cell.right() - NUMBER_MARGIN, cell.center().y);
        painter.text(at, Align2::RIGHT_CENTER, self.text, font, color);
        if self.is_selected {
            let stroke = Stroke::new(1.5, palette.accent);
            painter.rect_stroke(cell.expand(0.5), 3.0, stroke, StrokeKind::Outside);
        }
    }
}

/// Returns the background colour of a cell whose corrected value is outside its limit.
fn outside_color(palette: &Palette) -> Color32 {
    palette.panel.lerp_to_gamma(palette.warning, OUTSIDE_TINT)
}

/// Draws the legend for strip and background colours above the grid; if there is room, also for
/// undetermined values. The items are added in an order for a layout from right to left, which the
/// caller sets.
pub(super) fn grid_legend_ui(ui: &mut Ui, palette: &Palette) {
    ui.spacing_mut().item_spacing.x = 6.0;
    if ui.available_width() > WIDE_LEGEND {
        ui.label(palette.small(format!("{NOT_DETERMINED_SIGN} not determined")));
        ui.add_space(6.0);
    }
    ui.label(palette.small("background: corrected outside"));
    sample_ui(ui, palette, CellPart::Background);
    ui.add_space(6.0);
    ui.label(palette.small("strip: physics outside"));
    sample_ui(ui, palette, CellPart::Strip);
}

/// Part of a cell that the legend explains.
#[derive(Clone, Copy)]
enum CellPart {
    Strip,
    Background,
}

/// Draws a small cell with one part in the warning colour.
fn sample_ui(ui: &mut Ui, palette: &Palette, warned: CellPart) {
    const SIZE: Vec2 = vec2(22.0, 12.0);
    let (sample, _) = ui.allocate_exact_size(SIZE, Sense::hover());
    let strip = sample.with_max_x(sample.left() + 4.0);
    let background = sample.with_min_x(sample.left() + 5.0);
    let (strip_color, background_color) = match warned {
        CellPart::Strip => (palette.warning, palette.panel),
        CellPart::Background => (palette.line, outside_color(palette)),
    };
    ui.painter().rect_filled(strip, 1.5, strip_color);
    ui.painter().rect_filled(background, 2.0, background_color);
}
