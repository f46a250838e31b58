//! What hovering a curve says.

use std::sync::Arc;

use egui::{
    Align2, Color32, FontId, Galley, Painter, PopupAnchor, Rect, Response, RichText, Role as WidgetRole, Sense, Stroke,
    StrokeKind, Tooltip, Ui, Vec2, WidgetInfo, pos2, vec2,
};
use gdcm_core::response::wrap;
use gdcm_files::figure::decimals;

use super::bode::BodeScene;
use super::curve::{BodeCurve, Pane};
use super::curve_style::Role;
use super::quantity::BodeQuantity;
use crate::view::palette::{Palette, SMALL_SIZE};

/// "nominal · 2.9 dB · −99°" at `omega` \[rad/s\].
pub(super) fn value_text(quantity: BodeQuantity<'_>, curve: &BodeCurve, omega: f64) -> String {
    let value = |pane| match curve.value_at(pane, omega) {
        Some(value) => quantity.unit(pane).readout(value),
        None => "–".to_owned(),
    };
    let branch = match quantity {
        BodeQuantity::Response { .. } => curve.value_at(Pane::Phase, omega).and_then(branch_text).unwrap_or_default(),
        BodeQuantity::Error { .. } => String::new(),
    };
    format!("{} · {} · {}{branch}", curve.label, value(Pane::Magnitude), value(Pane::Phase))
}

/// " (−99° less 1 turn)": where a phase \[deg\] lies on another branch than that of its principal value.
fn branch_text(phase_deg: f64) -> Option<String> {
    let principal = wrap(phase_deg.to_radians()).to_degrees();
    let turns = ((phase_deg - principal) / 360.0).round();
    let (word, count) = (if turns < 0.0 { "less" } else { "and" }, turns.abs());
    let noun = if count == 1.0 { "turn" } else { "turns" };
    (count > 0.0).then(|| format!(" ({}° {word} {count} {noun})", decimals(principal, 0)))
}

/// Shows frequency, name and values of `curve` at `omega` \[rad/s\] beside the pointer.
pub(super) fn curve_tooltip_ui(
    plot: &Response,
    scene: &BodeScene<'_>,
    curve: &BodeCurve,
    omega: f64,
    palette: &Palette,
) {
    tooltip_ui(plot, |ui| {
        ui.label(RichText::new(scene.unit.readout(omega)).size(SMALL_SIZE).color(palette.dim_text));
        ui.label(value_text(scene.quantity, curve, omega));
        if !curve.detail.is_empty() {
            ui.label(RichText::new(&curve.detail).size(SMALL_SIZE).color(palette.dim_text));
        }
    });
}

/// Shows `content` beside the pointer, which is over `plot`.
pub(super) fn tooltip_ui(plot: &Response, content: impl FnOnce(&mut Ui)) {
    Tooltip::always_open(plot.ctx.clone(), plot.layer_id, plot.id, PopupAnchor::Pointer).gap(14.0).show(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        content(ui);
    });
}

/// The values of one role.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadoutRow {
    /// Whose they are.
    pub role: Role,
    /// One text for each column.
    pub cells: Vec<String>,
}

/// What every role has at the cursor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Readout {
    /// Where: "ω 2.05 rad/s".
    pub heading: String,
    /// What stands above the cells.
    pub columns: Vec<&'static str>,
    /// The roles, in the order of a legend.
    pub rows: Vec<ReadoutRow>,
}

impl Readout {
    /// All of it as one sentence.
    fn words(&self) -> String {
        let row = |row: &ReadoutRow| {
            let cells = self.columns.iter().zip(&row.cells).map(|(column, cell)| format!("{column} {cell}"));
            format!("{}: {}", row.role.name(), cells.collect::<Vec<_>>().join(", "))
        };
        let rows: Vec<String> = self.rows.iter().map(row).collect();
        format!("At {}: {}", self.heading, rows.join("; "))
    }
}

const FONT: FontId = FontId::monospace(10.5);
const ROW_HEIGHT: f32 = 13.5;
const COLUMN_GAP: f32 = 7.0;
const PADDING: Vec2 = vec2(7.0, 5.0);
const SWATCH: f32 = 4.0;
/// Part of the plot that may be covered.
const MOST_COVERED: f32 = 0.35;

/// Draws a read-out into a corner of `frame` other than that which `taken` covers, at the right where labels stand at the left; not
/// at all where it would hide too much of the plot.
pub(super) fn readout_box_ui(
    ui: &Ui,
    frame: Rect,
    readout: &Readout,
    (taken, is_left_labelled): (Option<Rect>, bool),
    palette: &Palette,
) {
    let painter = ui.painter().with_clip_rect(frame);
    let table = Table::new(&painter, readout, palette);
    let room = frame.shrink(9.0);
    let is_small = table.size.x * table.size.y < MOST_COVERED * room.area();
    if !is_small || table.size.x > room.width() || table.size.y > room.height() {
        return;
    }
    let mut corners = [Align2::LEFT_BOTTOM, Align2::LEFT_TOP, Align2::RIGHT_BOTTOM, Align2::RIGHT_TOP];
    if is_left_labelled {
        corners.reverse();
    }
    let place = |corner: Align2| corner.align_size_within_rect(table.size, room);
    let is_free = |corner: &Align2| taken.is_none_or(|taken| !taken.intersects(place(*corner)));
    let rect = place(corners.into_iter().find(is_free).unwrap_or(corners[0]));
    painter.rect(rect, 4.0, palette.raised.gamma_multiply(0.88), Stroke::new(1.0, palette.line), StrokeKind::Inside);
    table.paint(&painter, rect);
    let response = ui.interact(rect, ui.scope_id().with("read-out"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(WidgetRole::Label, true, readout.words()));
}

/// A read-out, laid out.
struct Table {
    heading: Arc<Galley>,
    /// The columns' names, then the rows.
    lines: Vec<(Option<Color32>, Vec<Arc<Galley>>)>,
    widths: Vec<f32>,
    size: Vec2,
}

impl Table {
    fn new(painter: &Painter, readout: &Readout, palette: &Palette) -> Self {
        let text = |text: String, color| painter.layout_no_wrap(text, FONT, color);
        let names = std::iter::once("").chain(readout.columns.iter().copied());
        let head = (None, names.map(|name| text(name.to_owned(), palette.dim_text)).collect());
        let row = |row: &ReadoutRow| {
            let cells = std::iter::once(row.role.short_name().to_owned()).chain(row.cells.iter().cloned());
            let color = palette.role_style(row.role, false).color.to_opaque();
            (Some(color), cells.map(|cell| text(cell, palette.text)).collect())
        };
        let lines: Vec<(Option<Color32>, Vec<Arc<Galley>>)> =
            std::iter::once(head).chain(readout.rows.iter().map(row)).collect();
        let width = |column: usize| {
            lines.iter().filter_map(|(_, cells)| cells.get(column)).map(|cell| cell.size().x).fold(0.0, f32::max)
        };
        let widths: Vec<f32> = (0..=readout.columns.len()).map(width).collect();
        let heading = text(readout.heading.clone(), palette.text);
        let inner = widths.iter().sum::<f32>() + COLUMN_GAP * readout.columns.len() as f32 + 2.0 * SWATCH;
        let size = vec2(inner.max(heading.size().x), ROW_HEIGHT * (lines.len() + 1) as f32) + 2.0 * PADDING;
        Self { heading, lines, widths, size }
    }

    fn paint(self, painter: &Painter, rect: Rect) {
        let corner = rect.min + PADDING;
        painter.galley(corner, self.heading, Color32::PLACEHOLDER);
        for (line, (color, cells)) in self.lines.into_iter().enumerate() {
            let top = corner.y + ROW_HEIGHT * (line + 1) as f32;
            if let Some(color) = color {
                painter.circle_filled(pos2(corner.x + 2.0, top + 0.45 * ROW_HEIGHT), 2.5, color);
            }
            let mut left = corner.x + 2.0 * SWATCH;
            for (column, cell) in cells.into_iter().enumerate() {
                // Names to the left, numbers to the right of their columns.
                let indent = if column == 0 { 0.0 } else { self.widths[column] - cell.size().x };
                painter.galley(pos2(left + indent, top), cell, Color32::PLACEHOLDER);
                left += self.widths[column] + COLUMN_GAP;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::curve_style::Role;
    use super::*;
    use crate::view::plot::curve::numbered;

    #[test]
    fn a_readout_names_the_curve_and_its_values() {
        let curve = BodeCurve {
            id: numbered(0),
            label: "nominal".into(),
            detail: String::new(),
            role: Role::Nominal,
            rejected: true,
            highlighted: false,
            hidden: false,
            omega: vec![1.0, 2.0].into(),
            magnitude_db: vec![2.94, 3.0].into(),
            phase_deg: vec![-99.2, f64::NAN].into(),
        };
        assert_eq!(value_text(BodeQuantity::RESPONSE, &curve, 1.0), "nominal · 2.9 dB · \u{2212}99°");
        assert_eq!(value_text(BodeQuantity::RESPONSE, &curve, 2.0), "nominal · 3.0 dB · –");
    }

    #[test]
    fn another_branch_than_the_principal_one_is_told() {
        assert_eq!(branch_text(-459.0).as_deref(), Some(" (\u{2212}99° less 1 turn)"));
        assert_eq!(branch_text(730.0).as_deref(), Some(" (10° and 2 turns)"));
        assert_eq!(branch_text(-170.0), None);
    }
}
