//! Every response at once: a table of small Bode plots with outputs in rows and inputs in columns,
//! all over the same frequencies.

use egui::{Align2, Rect, Ui, UiBuilder, Vec2, pos2, vec2};

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::Range;

use super::overview_cell::PlacedCell;
use super::overview_scene::{OverviewCell, OverviewEvent, OverviewScene, OverviewView};
use super::panel_text::{caption_font, message_ui};
use crate::gui::widgets::palette::Palette;

/// Width for the row names and height for the column names \[pt\].
const HEADER: Vec2 = vec2(52.0, 22.0);
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
    let mut events = Vec::new();
    ui.scope_builder(UiBuilder::new().id_salt("overview").max_rect(rect), |ui| {
        table.paint_names(ui, scene, palette);
        for cell in scene.cells {
            let placed = PlacedCell {
                cell,
                place: table.cell(cell.pair),
                name: cell_name(scene, cell),
                band: scene.band,
                log_omega,
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

/// Returns "LON → Q: J 75".
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
        let area = Rect::from_min_max(self.rect.min + HEADER, self.rect.max);
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
        let mut names = Vec::new();
        for (input, name) in scene.inputs.iter().enumerate() {
            let x = self.cell(Pair::new(0, input)).center().x;
            names.push((pos2(x, self.rect.top() + 0.5 * HEADER.y - 1.0), name));
        }
        for (output, name) in scene.outputs.iter().enumerate() {
            let y = self.cell(Pair::new(output, 0)).center().y;
            names.push((pos2(self.rect.left() + 0.5 * HEADER.x - 2.0, y), name));
        }
        for (place, name) in names {
            let font = caption_font();
            ui.painter()
                .text(place, Align2::CENTER_CENTER, name, font, palette.dim_text);
        }
    }
}
