//! Correlation between the physics parameters, and the share of each parameter's effect that
//! channel gains and delays can take, that is, imitate (M18.3: docs/physics.md).

use egui::{Align2, Color32, Pos2, Rect, Role, Sense, Ui, pos2, vec2};

use gdcm_method::physics::identifiability::{ACTS_LIKE_CHANNELS, INSEPARABLE};
use gdcm_study::results::physics_findings::PhysicsFindings;

use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::palette::{Palette, small};

/// Magnitude from which a correlation or a share is written into its cell; smaller ones show only
/// as a pale colour.
const LEAST_WRITTEN: f64 = 0.3;
/// Cell side above which a number fits into the cell \[pt\].
const WRITABLE_CELL: f32 = 18.0;
/// Minimum cell side \[pt\].
const LEAST_CELL: f32 = 10.0;
/// Maximum cell side \[pt\].
const LARGEST_CELL: f32 = 26.0;
/// Room for row and column numbers \[pt\].
const MARGIN: f32 = 18.0;
/// Gap before the column for the channels' share \[pt\].
const CHANNEL_GAP: f32 = 10.0;
/// Room for the heading of that column, which is wider than a cell \[pt\].
const CHANNEL_HEADING: f32 = 28.0;

/// Triangle of correlations, and a column for the channels' share.
pub(super) struct CorrelationMatrix<'a> {
    pub(super) findings: &'a PhysicsFindings,
    pub(super) palette: &'a Palette,
}

/// Positions of the matrix on the screen.
struct MatrixLayout {
    /// Area that the matrix may take.
    room: Rect,
    /// Upper left corner of the first cell.
    corner: Pos2,
    /// Cell side \[pt\].
    side: f32,
    /// Number of rows.
    count: f32,
}

impl MatrixLayout {
    /// Makes the cells as large as width and height allow, within the limits of their side.
    fn new(room: Rect, count: usize) -> Self {
        let count = count as f32;
        let by_width = (room.width() - MARGIN - CHANNEL_GAP - CHANNEL_HEADING) / (count + 1.0);
        let by_height = (room.height() - 2.0 * MARGIN) / count;
        Self {
            room,
            corner: room.min + vec2(MARGIN, MARGIN),
            side: by_width.min(by_height).clamp(LEAST_CELL, LARGEST_CELL),
            count,
        }
    }

    fn cell(&self, row: usize, column: usize) -> Rect {
        let left = self.corner.x + self.side * column as f32;
        self.cell_at(left, row)
    }

    /// Returns the cell with the channels' share, behind a gap.
    fn channel_cell(&self, row: usize) -> Rect {
        let left = self.corner.x + self.side * self.count + CHANNEL_GAP;
        self.cell_at(left, row)
    }

    fn cell_at(&self, left: f32, row: usize) -> Rect {
        let top = self.corner.y + self.side * row as f32;
        Rect::from_min_size(pos2(left, top), vec2(self.side, self.side))
    }

    /// Returns the centre of a row's number, at the left.
    fn row_number(&self, row: usize) -> Pos2 {
        let top = self.corner.y + self.side * row as f32;
        pos2(self.room.left() + 6.0, top + 0.5 * self.side)
    }

    /// Returns the centre of a column's number, at the top.
    fn column_number(&self, column: usize) -> Pos2 {
        let x = self.corner.x + self.side * (column as f32 + 0.5);
        pos2(x, self.room.top() + 8.0)
    }

    /// Returns the centre of the heading of the channels' share.
    fn channel_heading(&self) -> Pos2 {
        let x = self.corner.x + self.side * (self.count + 0.5) + CHANNEL_GAP;
        pos2(x, self.room.top() + 8.0)
    }

    /// Returns the upper left corner of the title, which fits into the empty upper triangle.
    fn title(&self) -> Pos2 {
        let x = self.corner.x + 0.62 * self.side * self.count;
        pos2(x, self.corner.y + 6.0)
    }

    /// Returns the area that the matrix takes.
    fn area(&self) -> Rect {
        let bottom = self.corner.y + self.side * self.count + 4.0;
        self.room.with_max_y(bottom)
    }
}

impl CorrelationMatrix<'_> {
    /// Draws the matrix; a click on a cell selects the parameter of its row.
    ///
    /// Rows and columns are the fitted parameters in ranking order, with their numbers at the left
    /// and at the top. Row `k` has the correlations with the parameters `1 … k − 1` (the lower
    /// triangle), and behind a gap the share of its effect that the channels can take.
    pub(super) fn ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let ranked = self.fitted();
        if ranked.is_empty() {
            return;
        }
        let layout = MatrixLayout::new(ui.available_rect_before_wrap(), ranked.len());
        for (row, parameter) in ranked.iter().enumerate() {
            let number = (row + 1).to_string();
            self.text(ui, layout.row_number(row), &number);
            self.text(ui, layout.column_number(row), &number);
            for (column, other) in ranked.iter().enumerate().take(row) {
                let cell = layout.cell(row, column);
                let correlation = self.correlation(*parameter, *other);
                self.paint_cell(ui, cell, correlation, INSEPARABLE);
                self.words_ui(ui, cell, *parameter, Some(*other), commands);
            }
            let cell = layout.channel_cell(row);
            let share = self.findings.diagnosis.parameters[*parameter].channels_can_take;
            if let Some(share) = share {
                self.paint_cell(ui, cell, share, ACTS_LIKE_CHANNELS);
            }
            self.words_ui(ui, cell, *parameter, None, commands);
        }
        self.text(ui, layout.channel_heading(), "channels");
        ui.painter().text(
            layout.title(),
            Align2::LEFT_TOP,
            "correlation",
            small(),
            self.palette.dim_text,
        );
        ui.allocate_rect(layout.area(), Sense::hover());
    }

    /// Returns the fitted parameters in ranking order.
    fn fitted(&self) -> Vec<usize> {
        let fitted = &self.findings.diagnosis.fit.fitted;
        let mut ranked = self.findings.ranked();
        ranked.retain(|parameter| fitted.contains(parameter));
        ranked
    }

    /// Returns the correlation of two parameters, given by their indices in the findings; 0 if one
    /// is not fitted.
    fn correlation(&self, parameter: usize, other: usize) -> f64 {
        let diagnosis = &self.findings.diagnosis;
        let fitted = &diagnosis.fit.fitted;
        let row = fitted.iter().position(|fitted| *fitted == parameter);
        let column = fitted.iter().position(|fitted| *fitted == other);
        match (row, column) {
            (Some(row), Some(column)) => diagnosis.identifiability.correlation[(row, column)],
            _ => 0.0,
        }
    }

    /// Paints a cell with a correlation or a share: the larger its magnitude, the stronger; above
    /// `limit`, in the warning colour. Adds the number if its magnitude is at least
    /// [`LEAST_WRITTEN`] and it fits.
    fn paint_cell(&self, ui: &Ui, place: Rect, value: f64, limit: f64) {
        let inner = place.shrink(1.0);
        let strength = value.abs().clamp(0.0, 1.0) as f32;
        let is_strong = value.abs() > limit;
        let color = if is_strong {
            self.palette.warning
        } else {
            self.palette.text.gamma_multiply(0.06 + 0.4 * strength)
        };
        ui.painter().rect_filled(inner, 2.0, color);
        if value.abs() >= LEAST_WRITTEN && place.width() > WRITABLE_CELL {
            let text = short_number(value);
            let color = if is_strong {
                self.palette.background
            } else {
                self.palette.text
            };
            ui.painter()
                .text(inner.center(), Align2::CENTER_CENTER, text, small(), color);
        }
    }

    /// Gives a cell an accessible name, explains it under the pointer, and selects its parameter on
    /// a click. `other` is the second parameter of a correlation; `None` for the channels' share.
    fn words_ui(
        &self,
        ui: &mut Ui,
        place: Rect,
        parameter: usize,
        other: Option<usize>,
        commands: &mut Vec<Command>,
    ) {
        let name = &self.findings.parameters[parameter].name;
        let words = match other {
            Some(other) => {
                let other_name = &self.findings.parameters[other].name;
                let correlation = self.correlation(parameter, other);
                format!("Correlation of {name} and {other_name}: {correlation:.2}")
            }
            None => match self.findings.diagnosis.parameters[parameter].channels_can_take {
                Some(share) => {
                    let percent = 100.0 * share;
                    format!(
                        "Gains and delays of the channels can imitate {percent:.0} % of the \
                            effect of {name}"
                    )
                }
                None => return,
            },
        };
        let id = ui.scope_id().with(("correlation", parameter, other));
        let response = named(ui.interact(place, id, Sense::click()), Role::Button, &words);
        response
            .on_hover_text(words)
            .asks(DisplayCommand::ShowParameter(name.clone()), commands);
    }

    fn text(&self, ui: &Ui, at: Pos2, text: &str) {
        let color: Color32 = self.palette.dim_text;
        ui.painter()
            .text(at, Align2::CENTER_CENTER, text, small(), color);
    }
}

/// Writes a number between −1 and 1 with two digits: ".71", "−.55".
fn short_number(value: f64) -> String {
    let digits = format!("{:.2}", value.abs());
    let digits = digits.strip_prefix('0').unwrap_or(&digits);
    if value < 0.0 {
        format!("\u{2212}{digits}")
    } else {
        digits.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::short_number;

    #[test]
    fn a_short_number_keeps_its_sign_and_the_one() {
        assert_eq!(short_number(0.714), ".71");
        assert_eq!(short_number(-0.55), "\u{2212}.55");
        assert_eq!(short_number(1.0), "1.00");
    }
}
