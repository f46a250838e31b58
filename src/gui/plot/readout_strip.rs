//! Read-out: every role's values at the pointer, in a strip between the panes.

use egui::{Color32, FontId, Pos2, Rect, Role as WidgetRole, Sense, Stroke, Ui, WidgetInfo, vec2};

use super::curve_style::{CurveStyle, Role};
use super::panel_text::AT_RIGHT;
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::painted_text::{painted_text, row_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, medium};

/// Strip height \[pt\].
pub(in crate::gui) const STRIP_HEIGHT: f32 = 40.0;
/// Minimum gap between the two values in a cell \[pt\].
const VALUE_GAP: f32 = 10.0;
/// Minimum width for a name beside its sample \[pt\].
const LEAST_NAME: f32 = 40.0;
/// Width of the frequency column and the last column, which have longer names, relative to the
/// others.
const WIDE_COLUMN: f32 = 1.25;
/// Padding at the left and at the right of a column \[pt\].
const PAD: f32 = 8.0;
/// Length of a sample, which shows the curve's pattern in the panes \[pt\].
const SAMPLE: f32 = 22.0;
/// Gap between a sample and the name beside it \[pt\].
const SAMPLE_GAP: f32 = 6.0;

/// A role's values, or a comparison of roles or conditions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadoutCell {
    /// Role whose values the cell shows, or whose change between two marks; `None` if the cell
    /// compares roles or conditions.
    pub role: Option<Role>,
    /// Column heading.
    pub name: String,
    /// Magnitude and phase, each with its unit.
    pub values: [String; 2],
    /// Whether the magnitude and the phase are drawn as warnings.
    pub warns: [bool; 2],
}

impl ReadoutCell {
    /// Returns name and values, as a part of the read-out's sentence.
    fn sentence(&self) -> String {
        format!("{}: {}, {}", self.name, self.values[0], self.values[1])
    }

    /// Returns the sample's style, with the same width and dashes as its curves; `None` without a
    /// role.
    fn sample(&self, palette: &Palette) -> Option<CurveStyle> {
        Some(palette.role_style(self.role?, false))
    }

    /// Returns the font for the values: medium weight without a role.
    fn font(&self, size: f32) -> FontId {
        if self.role.is_none() {
            medium(size)
        } else {
            FontId::proportional(size)
        }
    }

    /// Returns the width that the values and the sample need within a column \[pt\].
    fn needed_width(&self, ui: &Ui, size: f32) -> f32 {
        let mut values = VALUE_GAP;
        for value in &self.values {
            values += text_width(ui, value, self.font(size));
        }
        match self.role {
            Some(_) => values.max(SAMPLE + SAMPLE_GAP + LEAST_NAME),
            None => values,
        }
    }

    /// Draws the values, in this font size, into a column.
    fn ui(&self, ui: &Ui, column: Rect, size: f32, palette: &Palette) {
        let [upper, lower] = halves(column);
        let mut from = 0.0;
        if let Some(style) = self.sample(palette) {
            let start = upper.left_center();
            let path = vec![start, start + vec2(SAMPLE, 0.0)];
            let mut shapes = Vec::new();
            style.add_shapes(path, &mut shapes);
            ui.painter().extend(shapes);
            from = SAMPLE + SAMPLE_GAP;
        }
        let name = self.name_within(ui, upper.width() - from);
        row_text(ui, upper, from, &name, SMALL_SIZE, palette.dim_text);
        // The magnitude is at the left of the column, the phase at its right.
        for (index, x) in [0.0, AT_RIGHT].into_iter().enumerate() {
            let color = if self.warns[index] {
                palette.warning
            } else {
                palette.text
            };
            painted_text(ui, lower, x, &self.values[index], self.font(size), color);
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

/// Every role's values at a frequency.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Readout {
    /// Column heading above the frequency, such as "ω at the pointer".
    pub heading: String,
    /// Formatted frequency, such as "6.00 rad/s".
    pub frequency: String,
    /// Roles in the same order as their chips, then comparisons.
    pub cells: Vec<ReadoutCell>,
}

impl Readout {
    /// Returns the read-out as a sentence, which is its accessible name.
    fn sentence(&self) -> String {
        let cells: Vec<String> = self.cells.iter().map(ReadoutCell::sentence).collect();
        format!("{} {}: {}", self.heading, self.frequency, cells.join("; "))
    }
}

/// Draws a read-out between the panes, its cells side by side: in a smaller font if there is not
/// enough room, then also without the first cells (`StripFit`).
pub(in crate::gui) fn readout_strip_ui(ui: &Ui, strip: Rect, readout: &Readout, palette: &Palette) {
    ui.painter().rect_filled(strip, 6.0, palette.raised);
    let fit = StripFit::new(ui, strip.width(), readout);
    let cells = &readout.cells[fit.left_out..];
    let [upper, lower] = halves(column(strip, 0, cells.len()));
    let heading = elided(ui, &readout.heading, upper.width(), SMALL_SIZE);
    row_text(ui, upper, 0.0, &heading, SMALL_SIZE, palette.dim_text);
    let frequency = &readout.frequency;
    painted_text(ui, lower, 0.0, frequency, medium(fit.size), palette.text);
    for (index, cell) in cells.iter().enumerate() {
        let column = column(strip, index + 1, cells.len());
        let line = Stroke::new(1.0, palette.line);
        ui.painter()
            .vline(column.left() - PAD, strip.shrink(8.0).y_range(), line);
        cell.ui(ui, column, fit.size, palette);
    }
    let response = ui.interact(strip, ui.scope_id().with("read-out"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(WidgetRole::Label, true, readout.sentence()));
}

/// Font size and omitted cells with which a read-out fits into a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StripFit {
    /// Number of cells omitted from the start.
    left_out: usize,
    /// Font size for the values \[pt\].
    size: f32,
}

impl StripFit {
    /// Returns the fit in which no two values touch: with small values if necessary, and without
    /// the first cells if that is not enough. The last cell always remains.
    fn new(ui: &Ui, width: f32, readout: &Readout) -> Self {
        let cells = &readout.cells;
        for left_out in 0..cells.len() {
            for size in [BODY_SIZE, SMALL_SIZE] {
                let fit = Self { left_out, size };
                if fit.has_room(ui, width, readout) {
                    return fit;
                }
            }
        }
        Self {
            left_out: cells.len().saturating_sub(1),
            size: SMALL_SIZE,
        }
    }

    fn has_room(self, ui: &Ui, width: f32, readout: &Readout) -> bool {
        let cells = &readout.cells[self.left_out..];
        let strip = Rect::from_min_size(Pos2::ZERO, vec2(width, STRIP_HEIGHT));
        let frequency = text_width(ui, &readout.frequency, medium(self.size));
        if column(strip, 0, cells.len()).width() < frequency {
            return false;
        }
        for (index, cell) in cells.iter().enumerate() {
            let room = column(strip, index + 1, cells.len()).width();
            if room < cell.needed_width(ui, self.size) {
                return false;
            }
        }
        true
    }
}

fn text_width(ui: &Ui, text: &str, font: FontId) -> f32 {
    let color = Color32::PLACEHOLDER;
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, color);
    galley.size().x
}

/// Returns a column's place in a strip with `cells` cells. Column 0 shows the frequency, the others
/// the cells in order; the first and the last are wider ([`WIDE_COLUMN`]).
fn column(strip: Rect, place: usize, cells: usize) -> Rect {
    let left = strip.left() + width_before(place, cells) * strip.width();
    let right = strip.left() + width_before(place + 1, cells) * strip.width();
    strip
        .with_min_x(left)
        .with_max_x(right)
        .shrink2(vec2(PAD, 3.0))
}

/// Returns the total width before a column, as a share of the strip.
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

fn halves(column: Rect) -> [Rect; 2] {
    let middle = column.center().y;
    [column.with_max_y(middle), column.with_min_y(middle)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gui::widgets::palette::apply;

    fn readout() -> Readout {
        let roles = [
            (Some(Role::Nominal), "nominal, rejected"),
            (Some(Role::Identified), "identified"),
            (Some(Role::Corrected), "corrected"),
            (Some(Role::Scheduled), "scheduled"),
            (None, "corrected \u{2212} identified"),
        ];
        let mut cells = Vec::new();
        for (role, name) in roles {
            cells.push(ReadoutCell {
                role,
                name: name.to_owned(),
                values: ["\u{2212}16.7 dB".to_owned(), "\u{2212}209°".to_owned()],
                warns: [false; 2],
            });
        }
        Readout {
            heading: "ω at the pointer".to_owned(),
            frequency: "6.00 rad/s".to_owned(),
            cells,
        }
    }

    fn with_ui(check: impl Fn(&Ui)) {
        let ctx = egui::Context::default();
        apply(&ctx);
        for _ in 0..2 {
            let output = ctx.run_ui(egui::RawInput::default(), |ui| check(ui));
            output.drop_without_applying_deltas();
        }
    }

    #[test]
    fn the_two_values_of_a_cell_never_touch() {
        with_ui(|ui| {
            let readout = readout();
            // Every plot is wider than the narrowest strip here.
            for width in (220..1200).step_by(10) {
                let strip = Rect::from_min_size(Pos2::ZERO, vec2(width as f32, STRIP_HEIGHT));
                let fit = StripFit::new(ui, strip.width(), &readout);
                let cells = &readout.cells[fit.left_out..];
                for (index, cell) in cells.iter().enumerate() {
                    let room = column(strip, index + 1, cells.len()).width();
                    let mut values = 0.0;
                    for value in &cell.values {
                        values += text_width(ui, value, cell.font(fit.size));
                    }
                    assert!(values + VALUE_GAP <= room, "{width}: {values} in {room}");
                }
            }
            let wide = StripFit::new(ui, 1200.0, &readout);
            assert_eq!((wide.left_out, wide.size), (0, BODY_SIZE));
        });
    }

    #[test]
    fn samples_have_the_dashes_of_their_curves() {
        let palette = Palette::dark();
        for cell in readout().cells {
            let curve = cell.role.map(|role| palette.role_style(role, false));
            assert_eq!(cell.sample(&palette), curve);
        }
    }
}
