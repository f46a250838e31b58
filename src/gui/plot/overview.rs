//! Every response at once: a table of small Bode plots with outputs in rows and inputs in columns.
//! The axes are labelled at the left of the rows and below the columns.
//!
//! J, which a cell's note may give, is the cost of the response's mismatch (M4: docs/method.md).

use egui::{Align2, Pos2, Rect, Ui, UiBuilder, Vec2, pos2, vec2};

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::Range;

use super::overview_axes::AxisRange;
use super::overview_cell::{CellLayout, PlacedCell};
use super::overview_response::OverviewCell;
use super::overview_scene::{OverviewEvent, OverviewScene, OverviewView};
use super::panel_text::{caption_font, message_ui};
use super::ticks::Ticks;
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Width of row names and value labels, and height of the column names \[pt\].
const HEADER: Vec2 = vec2(76.0, 22.0);
/// Width of the row names \[pt\].
const NAMES: f32 = 42.0;
/// Height of the frequency labels \[pt\].
const FOOT: f32 = 16.0;
/// Gap between two cells \[pt\].
const GAP: f32 = 4.0;

/// Draws the overview into the remaining space in `ui`.
pub fn overview_ui(
    ui: &mut Ui,
    scene: &OverviewScene<'_>,
    view: &mut OverviewView,
    palette: &Palette,
) -> Vec<OverviewEvent> {
    let rect = ui.available_rect_before_wrap();
    let is_empty = scene.inputs.is_empty() || scene.outputs.is_empty();
    let (Some(log_omega), false) = (log_omega_of(scene.cells), is_empty) else {
        let message = scene.message.unwrap_or("Nothing to draw");
        message_ui(ui, rect, message, palette);
        return Vec::new();
    };
    let table = Table {
        rect,
        columns: scene.inputs.len(),
        rows: scene.outputs.len(),
    };
    let frequencies = AxisRange {
        ticks: Ticks::Frequency(scene.unit),
        range: log_omega,
    };
    view.ranges.follow(scene.cells, scene.band, scene.update);
    let mut events = Vec::new();
    ui.scope_builder(UiBuilder::new().id_salt("overview").max_rect(rect), |ui| {
        table.paint_names(ui, scene, palette);
        table.paint_axes(ui, scene, frequencies, view, palette);
        for cell in scene.cells {
            let placed = PlacedCell {
                cell,
                place: table.cell(cell.pair),
                name: cell_name(scene, cell),
                band: scene.band,
                frequencies,
                cursor: scene.cursor,
                palette,
            };
            events.extend(placed.ui(ui, view));
        }
    });
    ui.advance_cursor_after_rect(rect);
    events
}

/// Returns the range of `log10 omega` over all curves. Frequencies ascend, so the first and the
/// last suffice.
fn log_omega_of(cells: &[OverviewCell<'_>]) -> Option<Range> {
    let mut ends = Vec::new();
    for curve in cells.iter().flat_map(|cell| cell.curves) {
        if let (Some(first), Some(last)) = (curve.omega.first(), curve.omega.last()) {
            ends.extend([first.log10(), last.log10()]);
        }
    }
    Range::spanning(ends)
}

/// Returns the accessible name of a cell, such as "LON → Q: J 75", or "LON → Q" without a note.
fn cell_name(scene: &OverviewScene<'_>, cell: &OverviewCell<'_>) -> String {
    let input = &scene.inputs[cell.pair.input];
    let output = &scene.outputs[cell.pair.output];
    if cell.note.is_empty() {
        format!("{input} → {output}")
    } else {
        format!("{input} → {output}: {}", cell.note)
    }
}

/// Places for the cells.
struct Table {
    rect: Rect,
    columns: usize,
    rows: usize,
}

impl Table {
    fn cell(&self, pair: Pair) -> Rect {
        let area = Rect::from_min_max(self.rect.min + HEADER, self.rect.max - vec2(0.0, FOOT));
        let size = vec2(
            area.width() / self.columns as f32,
            area.height() / self.rows as f32,
        );
        let offset = vec2(pair.input as f32 * size.x, pair.output as f32 * size.y);
        let inner = (size - vec2(GAP, GAP)).max(vec2(1.0, 1.0));
        Rect::from_min_size(area.min + offset, inner)
    }

    /// Paints input names above the columns and output names beside the rows.
    fn paint_names(&self, ui: &Ui, scene: &OverviewScene<'_>, palette: &Palette) {
        let column = self.cell(Pair::new(0, 0)).width();
        for (input, name) in scene.inputs.iter().enumerate() {
            let x = self.cell(Pair::new(0, input)).center().x;
            let at = pos2(x, self.rect.top() + 0.5 * HEADER.y - 1.0);
            paint_name(ui, at, name, column, palette);
        }
        for (output, name) in scene.outputs.iter().enumerate() {
            let y = self.cell(Pair::new(output, 0)).center().y;
            let at = pos2(self.rect.left() + 0.5 * NAMES, y);
            paint_name(ui, at, name, NAMES, palette);
        }
    }

    /// Paints the labels of the values at the left of each row, those of the frequencies below each
    /// column, and the units of both.
    fn paint_axes(
        &self,
        ui: &Ui,
        scene: &OverviewScene<'_>,
        frequencies: AxisRange,
        view: &OverviewView,
        palette: &Palette,
    ) {
        let painter = ui.painter();
        for output in 0..self.rows {
            let cell = self.cell(Pair::new(output, 0));
            for (pane, rect) in CellLayout::new(cell, view.show_phase).panes {
                if let Some(values) = view.ranges.values(output, pane) {
                    AxisRange::of_values(pane, values).paint_beside(painter, rect, palette);
                }
            }
        }
        let last = self.rows.saturating_sub(1);
        for input in 0..self.columns {
            let cell = self.cell(Pair::new(last, input)).shrink2(vec2(2.0, 0.0));
            frequencies.paint_below(painter, cell, palette);
        }
        let right = self.cell(Pair::new(0, 0)).left() - 4.0;
        let units = [
            (
                self.rect.top() + 0.5 * HEADER.y - 1.0,
                values_unit(view.show_phase),
            ),
            (self.rect.bottom() - 0.5 * FOOT - 1.0, scene.unit.symbol()),
        ];
        for (y, unit) in units {
            let font = caption_font();
            painter.text(
                pos2(right, y),
                Align2::RIGHT_CENTER,
                unit,
                font,
                palette.dim_text,
            );
        }
    }
}

fn values_unit(show_phase: bool) -> &'static str {
    if show_phase { "dB, deg" } else { "dB" }
}

/// Paints the name of a row or column, shortened to `room` \[pt\].
fn paint_name(ui: &Ui, center: Pos2, name: &str, room: f32, palette: &Palette) {
    let name = elided(ui, name, room, SMALL_SIZE);
    let font = caption_font();
    ui.painter()
        .text(center, Align2::CENTER_CENTER, name, font, palette.dim_text);
}
