//! Model table: a row per model, sortable by every column. A *part* is a model that was found in
//! the files, with the settings that the rules give it.

use egui::{Color32, Rect, Role, ScrollArea, Sense, Ui, vec2};

use gdcm_model::assembly::part::Part;

use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::state::assembly_columns::COLUMNS;
use crate::gui::widgets::controls::{Asks, named, named_switch};
use crate::gui::widgets::elision::{elided, elided_among};
use crate::gui::widgets::list_row::ROW_HEIGHT;
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE, small};

/// Index of the column with the file, in which incomplete models are marked.
const FILE_COLUMN: usize = COLUMNS.len() - 1;
/// Left padding in headings and cells \[pt\].
const CELL_PAD: f32 = 3.0;
/// Room for the scroll bar at the right of the rows \[pt\].
const SCROLL_BAR: f32 = 12.0;
/// Room in a heading for padding and sort mark \[pt\].
const SORT_MARK: f32 = 18.0;

/// Draws the table; only visible rows are laid out.
pub(super) fn table_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let width = ui.available_width() - SCROLL_BAR;
    headings_ui(ui, assembly, width, palette, commands);
    let table = Table {
        assembly,
        parts: assembly.assembly().parts(),
        order: assembly.order(),
        incomplete: incomplete_parts(assembly),
        width,
        palette,
    };
    ScrollArea::vertical()
        .id_salt("models that are imported")
        .auto_shrink(false)
        .show_rows(ui, ROW_HEIGHT, table.order.len(), |ui, rows| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for row in rows {
                table.row_ui(ui, row, commands);
            }
        });
}

/// Draws the headings, left-aligned with their cells; a click sorts the table.
fn headings_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    width: f32,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let (rect, _) = ui.allocate_exact_size(vec2(width, ROW_HEIGHT), Sense::hover());
    let mut left = rect.left();
    for (index, column) in COLUMNS.iter().enumerate() {
        let room = width * column.share;
        let place = Rect::from_x_y_ranges(left..=left + room, rect.y_range());
        left += room;
        let id = ui.scope_id().with(("heading of models", index));
        let name = format!("Sort models by {}", column.heading);
        let heading = named(ui.interact(place, id, Sense::click()), Role::Button, &name);
        let mark = assembly.sorting.mark(index);
        let color = if heading.hovered() || !mark.is_empty() {
            palette.text
        } else {
            palette.dim_text
        };
        let text = elided(ui, column.heading, room - SORT_MARK, SMALL_SIZE);
        let text = format!("{text}{mark}");
        painted_text(ui, place, CELL_PAD, &text, small(), color);
        heading
            .on_hover_text(&name)
            .asks(AssemblingCommand::Sort(index), commands);
    }
}

fn incomplete_parts(assembly: &AssemblyState) -> Vec<usize> {
    let problems = assembly.assembly().problems();
    problems.iter().filter_map(|problem| problem.part).collect()
}

struct Table<'a> {
    assembly: &'a AssemblyState,
    parts: &'a [Part],
    /// Model index in each row.
    order: Vec<usize>,
    /// Indices of models with a problem.
    incomplete: Vec<usize>,
    /// Row width \[pt\].
    width: f32,
    palette: &'a Palette,
}

impl Table<'_> {
    /// Returns the model in a row; `None` if the row does not exist.
    fn part(&self, row: usize) -> Option<&Part> {
        let index = self.order.get(row)?;
        Some(&self.parts[*index])
    }

    /// Draws a row; a click displays its model.
    fn row_ui(&self, ui: &mut Ui, row: usize, commands: &mut Vec<Command>) {
        let Some(part) = self.part(row) else {
            return;
        };
        let index = self.order[row];
        let size = vec2(self.width, ROW_HEIGHT);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        let is_selected = self.assembly.selected == index;
        let name = format!("Model {}", part.found.key());
        let response = named_switch(response, Role::Row, is_selected, name);
        let fill = if is_selected {
            self.palette.selected
        } else if response.contains_pointer() {
            self.palette.raised
        } else {
            Color32::TRANSPARENT
        };
        ui.painter().rect_filled(rect, 2.0, fill);
        self.paint_cells(ui, rect, row, part);
        response.asks(AssemblingCommand::Select(index), commands);
    }

    /// Paints a row's texts; shortened texts keep the part that distinguishes them from the rows
    /// above and below.
    fn paint_cells(&self, ui: &Ui, rect: Rect, row: usize, part: &Part) {
        let is_incomplete = self.incomplete.contains(&self.order[row]);
        let neighbours = [
            row.checked_sub(1).and_then(|above| self.part(above)),
            self.part(row + 1),
        ];
        let mut left = rect.left();
        for (index, column) in COLUMNS.iter().enumerate() {
            let mut text = column.text(part);
            let is_marked = is_incomplete && index == FILE_COLUMN;
            let color = self.cell_color(&text, part, is_marked);
            if is_marked {
                text = format!("⚠ {text}");
            }
            let others = neighbours.map(|other| Some(column.text(other?)));
            let others = others.each_ref().map(Option::as_deref);
            let room = rect.width() * column.share;
            let text = elided_among(ui, &text, others, room - 2.0 * CELL_PAD, SMALL_SIZE);
            let place = Rect::from_x_y_ranges(left..=left + room, rect.y_range());
            painted_text(ui, place, CELL_PAD, &text, small(), color);
            left += room;
        }
    }

    /// Returns a cell's colour: warning for an unknown value; otherwise quiet if the model is left
    /// out; otherwise warning if the cell is marked.
    fn cell_color(&self, text: &str, part: &Part, is_marked: bool) -> Color32 {
        if text == "?" {
            self.palette.warning
        } else if part.row.left_out {
            self.palette.quiet_text
        } else if is_marked {
            self.palette.warning
        } else {
            self.palette.text
        }
    }
}
