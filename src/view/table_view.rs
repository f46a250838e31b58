//! A table in the window: sorted by a click on a heading, copied as text.

use std::sync::Arc;

use egui::{Align, Button, Color32, Grid, Label, Layout, RichText, Role, ScrollArea, Sense, Ui};

use gdcm_core::study::Table;

use super::{Command, Palette, SMALL_SIZE, entries_ui, named};

/// By which column a table is sorted, and whether downwards; by none as it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sorting(Option<(usize, bool)>);

impl Sorting {
    /// What a click on the heading of a column makes of it: rising, falling, as it was made.
    pub fn clicked(self, column: usize) -> Self {
        Self(match self.0 {
            Some((sorted, false)) if sorted == column => Some((column, true)),
            Some((sorted, true)) if sorted == column => None,
            _ => Some((column, false)),
        })
    }

    /// The rows of a table in this order: numbers by value, words by letters, empty cells last. Equal rows stay as they are.
    pub fn order(self, table: &Table) -> Vec<usize> {
        self.order_of(table.rows.len(), |row, column| table.rows[row].get(column).cloned().unwrap_or_default())
    }

    /// The same of so many rows, by what stands in the cell of a row and a column.
    pub fn order_of(self, rows: usize, cell: impl Fn(usize, usize) -> String) -> Vec<usize> {
        let mut order: Vec<usize> = (0..rows).collect();
        let Some((column, falling)) = self.0 else { return order };
        let cells: Vec<String> = order.iter().map(|&row| cell(row, column)).collect();
        order.sort_by(|a, b| {
            let (a, b) = (&cells[*a], &cells[*b]);
            let compared = match (number_in(a), number_in(b)) {
                (Some(a), Some(b)) => a.total_cmp(&b),
                _ => a.cmp(b),
            };
            let compared = if falling { compared.reverse() } else { compared };
            a.is_empty().cmp(&b.is_empty()).then(compared)
        });
        order
    }

    /// The mark on the heading of a column.
    pub fn mark(self, column: usize) -> &'static str {
        match self.0 {
            Some((sorted, false)) if sorted == column => " ▲",
            Some((sorted, true)) if sorted == column => " ▼",
            _ => "",
        }
    }
}

/// The number that a cell begins with, whichever its minus sign.
fn number_in(cell: &str) -> Option<f64> {
    cell.split_whitespace().next()?.replacen('\u{2212}', "-", 1).parse().ok()
}

/// What the engineer did in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableClick {
    /// Index of the row, as the table was made.
    pub row: usize,
    /// Index of the column.
    pub column: usize,
}

/// How the cells of a table look.
pub struct TableLook<'a> {
    /// Colour of a cell's text, by row and column; the usual one where it is none.
    pub color: &'a dyn Fn(usize, usize) -> Option<Color32>,
    /// Whether a row is the one in focus.
    pub selected: &'a dyn Fn(usize) -> bool,
}

/// Draws a table that scrolls where it is too large. Its headings sort it; a right-click copies or saves it.
pub fn table_ui(
    ui: &mut Ui,
    table: &Table,
    sorting: &mut Sorting,
    look: &TableLook<'_>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) -> Option<TableClick> {
    let area = ScrollArea::both().id_salt(("table", &table.title)).auto_shrink(false);
    area.show(ui, |ui| table_grid_ui(ui, table, sorting, look, palette, commands)).inner
}

/// The same, as large as it is.
pub fn table_grid_ui(
    ui: &mut Ui,
    table: &Table,
    sorting: &mut Sorting,
    look: &TableLook<'_>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) -> Option<TableClick> {
    let mut clicked = None;
    let order = sorting.order(table);
    // The heading is row 0.
    let is_selected: Vec<bool> = std::iter::once(false).chain(order.iter().map(|row| (look.selected)(*row))).collect();
    let selected = palette.selected;
    let row_color = move |row: usize, style: &egui::Style| match is_selected.get(row) {
        Some(true) => Some(selected),
        _ => (row % 2 == 1).then_some(style.visuals.faint_bg_color),
    };
    Grid::new(("cells", &table.title)).spacing([12.0, 3.0]).with_row_color(row_color).show(ui, |ui| {
        for (column, heading) in table.columns.iter().enumerate() {
            let text = palette.small(format!("{heading}{}", sorting.mark(column)));
            let button = ui.add(Button::new(text).frame(false));
            let button = named(button, Role::Button, format!("Sort {} by {heading}", table.title));
            button.context_menu(|ui| copy_ui(ui, table, commands));
            if button.on_hover_text("Sort; right-click: copy or save the table").clicked() {
                *sorting = sorting.clicked(column);
            }
        }
        ui.end_row();
        for row in order {
            for (column, cell) in table.rows[row].iter().enumerate() {
                let color = (look.color)(row, column).unwrap_or(palette.text);
                let text = RichText::new(cell).size(SMALL_SIZE).color(color);
                let layout = if number_in(cell).is_some() || cell == "-" { Align::Max } else { Align::Min };
                let label = Label::new(text).sense(Sense::click()).selectable(false).extend();
                let response = ui.with_layout(Layout::top_down(layout), |ui| ui.add(label)).inner;
                response.context_menu(|ui| copy_ui(ui, table, commands));
                if response.clicked() {
                    clicked = Some(TableClick { row, column });
                }
            }
            ui.end_row();
        }
    });
    clicked
}

fn copy_ui(ui: &mut Ui, table: &Table, commands: &mut Vec<Command>) {
    let entries = [
        ("Copy the table as text", Command::CopyText(table.text())),
        ("Save the table as CSV…", Command::AskSaveShownTable(Arc::new(table.clone()))),
    ];
    entries_ui(ui, entries, commands);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new("t", ["name", "value"]);
        for (name, value) in [("b", "10"), ("a", "\u{2212}2.5"), ("c", ""), ("d", "9")] {
            table.row([name, value]);
        }
        table
    }

    #[test]
    fn numbers_are_sorted_by_value_and_words_by_letters() {
        let by = |column| Sorting::default().clicked(column);
        assert_eq!(by(1).order(&table()), [1, 3, 0, 2], "empty cells last");
        assert_eq!(by(1).clicked(1).order(&table()), [0, 3, 1, 2], "downwards too");
        assert_eq!(by(0).order(&table()), [1, 0, 2, 3]);
    }

    #[test]
    fn the_third_click_on_a_heading_leaves_the_table_as_it_was_made() {
        let sorting = Sorting::default().clicked(1).clicked(1).clicked(1);
        assert_eq!(sorting.order(&table()), [0, 1, 2, 3]);
        assert_eq!(Sorting::default().clicked(0).clicked(1), Sorting::default().clicked(1));
    }
}
