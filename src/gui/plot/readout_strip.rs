//! Read-out: values of every role at the pointer, in a strip between the panes.

use egui::{FontId, Rect, Role as WidgetRole, Sense, Stroke, Ui, WidgetInfo, vec2};

use super::curve_style::Role;
use super::panel_text::AT_RIGHT;
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::painted_text::{painted_text, row_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, medium};

/// Height of the strip \[pt\].
pub(in crate::gui) const STRIP_HEIGHT: f32 = 40.0;
/// Minimum width of a cell \[pt\].
const LEAST_CELL: f32 = 96.0;
/// Width of the columns of frequency and difference, whose names are longer, relative to the column
/// of a role.
const WIDE_COLUMN: f32 = 1.25;
/// Padding at the left and at the right of a column \[pt\].
const PAD: f32 = 8.0;
/// Length of a sample, and of the gap beside it \[pt\].
const SAMPLE: f32 = 14.0;
const SAMPLE_GAP: f32 = 6.0;

/// Values of a role, or differences between two roles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadoutCell {
    /// Role; `None` for a difference.
    pub role: Option<Role>,
    /// Column heading.
    pub name: String,
    /// Magnitude and phase, each with its unit.
    pub values: [String; 2],
    /// Whether the magnitude and the phase are drawn as warnings.
    pub warns: [bool; 2],
}

impl ReadoutCell {
    /// Returns the values within a sentence.
    fn sentence(&self) -> String {
        format!("{}: {}, {}", self.name, self.values[0], self.values[1])
    }

    /// Draws the values into a column.
    fn ui(&self, ui: &Ui, column: Rect, palette: &Palette) {
        let [upper, lower] = halves(column);
        let mut from = 0.0;
        if let Some(role) = self.role {
            let start = upper.left_center();
            let path = vec![start, start + vec2(SAMPLE, 0.0)];
            let style = palette.role_style(role, false).in_miniature();
            let mut shapes = Vec::new();
            style.add_shapes(path, &mut shapes);
            ui.painter().extend(shapes);
            from = SAMPLE + SAMPLE_GAP;
        }
        let name = self.name_within(ui, upper.width() - from);
        row_text(ui, upper, from, &name, SMALL_SIZE, palette.dim_text);
        let font = if self.role.is_none() {
            medium(BODY_SIZE)
        } else {
            FontId::proportional(BODY_SIZE)
        };
        // The magnitude is at the left of the column, the phase at its right.
        for (index, x) in [0.0, AT_RIGHT].into_iter().enumerate() {
            let color = if self.warns[index] {
                palette.warning
            } else {
                palette.text
            };
            painted_text(ui, lower, x, &self.values[index], font.clone(), color);
        }
    }

    /// Returns the name, or only "nominal" if there is no room for "nominal, rejected".
    fn name_within(&self, ui: &Ui, room: f32) -> String {
        let shown = elided(ui, &self.name, room, SMALL_SIZE);
        match self.name.split_once(", ") {
            Some((first, _)) if shown != self.name => elided(ui, first, room, SMALL_SIZE),
            _ => shown,
        }
    }
}

/// Values of every role at a frequency.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Readout {
    /// "ω at the pointer".
    pub heading: String,
    /// Formatted frequency: "6.00 rad/s".
    pub frequency: String,
    /// Roles in the order of the chips, the difference last.
    pub cells: Vec<ReadoutCell>,
}

impl Readout {
    /// Returns the values as a sentence.
    fn sentence(&self) -> String {
        let cells: Vec<String> = self.cells.iter().map(ReadoutCell::sentence).collect();
        format!("{} {}: {}", self.heading, self.frequency, cells.join("; "))
    }
}

/// Draws a read-out between the panes, its cells side by side; if there is not enough room, the
/// first cells are omitted.
pub(in crate::gui) fn readout_strip_ui(ui: &Ui, strip: Rect, readout: &Readout, palette: &Palette) {
    ui.painter().rect_filled(strip, 6.0, palette.raised);
    let most = ((strip.width() / LEAST_CELL) as usize).saturating_sub(1);
    let left_out = readout.cells.len().saturating_sub(most);
    let cells = &readout.cells[left_out..];
    let [upper, lower] = halves(column(strip, 0, cells.len()));
    let heading = elided(ui, &readout.heading, upper.width(), SMALL_SIZE);
    row_text(ui, upper, 0.0, &heading, SMALL_SIZE, palette.dim_text);
    let frequency = &readout.frequency;
    painted_text(ui, lower, 0.0, frequency, medium(BODY_SIZE), palette.text);
    for (index, cell) in cells.iter().enumerate() {
        let column = column(strip, index + 1, cells.len());
        let line = Stroke::new(1.0, palette.line);
        ui.painter()
            .vline(column.left() - PAD, strip.shrink(8.0).y_range(), line);
        cell.ui(ui, column, palette);
    }
    let response = ui.interact(strip, ui.scope_id().with("read-out"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(WidgetRole::Label, true, readout.sentence()));
}

/// Returns the place of a column in a strip with `cells` cells; column 0 shows the frequency.
fn column(strip: Rect, place: usize, cells: usize) -> Rect {
    let left = strip.left() + width_before(place, cells) * strip.width();
    let right = strip.left() + width_before(place + 1, cells) * strip.width();
    strip
        .with_min_x(left)
        .with_max_x(right)
        .shrink2(vec2(PAD, 3.0))
}

/// Returns the total width of all columns before a column, as a share of the strip.
fn width_before(place: usize, cells: usize) -> f32 {
    let width = |column: usize| {
        if column == 0 || column == cells {
            WIDE_COLUMN
        } else {
            1.0
        }
    };
    (0..place).map(width).sum::<f32>() / (0..=cells).map(width).sum::<f32>()
}

/// Returns the upper and the lower half.
fn halves(column: Rect) -> [Rect; 2] {
    let middle = column.center().y;
    [column.with_max_y(middle), column.with_min_y(middle)]
}
