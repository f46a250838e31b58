//! Tables in the window: a click on a heading sorts, a right-click copies or saves.

use std::sync::Arc;

use egui::{
    Align, Button, Color32, Grid, Label, Layout, Response, RichText, Role, ScrollArea, Sense, Ui,
};

use gdcm_words::Table;

use super::controls::{entries_ui, named};
use super::palette::{Palette, SMALL_SIZE};

/// Order of a table's rows; the default is the original order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sorting {
    key: Option<SortKey>,
}

/// Column by which a table is sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct SortKey {
    column: usize,
    is_descending: bool,
}

impl Sorting {
    /// Returns the order after a click on a column's heading: ascending, descending, original.
    pub fn clicked(self, column: usize) -> Self {
        let is_descending = match self.key {
            Some(key) if key.column == column && key.is_descending => return Self::default(),
            Some(key) => key.column == column,
            None => false,
        };
        Self {
            key: Some(SortKey {
                column,
                is_descending,
            }),
        }
    }

    /// Returns the sorted row indices: numbers by value, text alphabetically, empty cells last.
    /// Equal rows keep their order.
    pub fn order(self, table: &Table) -> Vec<usize> {
        self.order_of(table.rows.len(), |row, column| {
            table.rows[row].get(column).cloned().unwrap_or_default()
        })
    }

    /// Like [`Self::order`], for `rows` rows and a function that returns the cell at a row and a
    /// column.
    pub fn order_of(self, rows: usize, cell: impl Fn(usize, usize) -> String) -> Vec<usize> {
        let mut order: Vec<usize> = (0..rows).collect();
        let Some(key) = self.key else {
            return order;
        };
        let cells: Vec<String> = order.iter().map(|&row| cell(row, key.column)).collect();
        order.sort_by(|a, b| {
            let a = &cells[*a];
            let b = &cells[*b];
            let compared = match (number_in(a), number_in(b)) {
                (Some(a), Some(b)) => a.total_cmp(&b),
                _ => a.cmp(b),
            };
            let compared = if key.is_descending {
                compared.reverse()
            } else {
                compared
            };
            a.is_empty().cmp(&b.is_empty()).then(compared)
        });
        order
    }

    /// Returns the sort mark in the heading of a column.
    pub fn mark(self, column: usize) -> &'static str {
        match self.key {
            Some(key) if key.column == column && key.is_descending => " ▼",
            Some(key) if key.column == column => " ▲",
            _ => "",
        }
    }
}

/// Parses the number at the beginning of a cell, with either minus sign.
fn number_in(cell: &str) -> Option<f64> {
    cell.split_whitespace()
        .next()?
        .replacen('\u{2212}', "-", 1)
        .parse()
        .ok()
}

/// Clicked cell of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableClick {
    /// Row index in the original order.
    pub row: usize,
    pub column: usize,
}

/// Colours of the cells, and the rows in focus.
pub struct TableLook<'a> {
    /// Text colour of a cell, by row and column; `None` for the default colour.
    pub color: &'a dyn Fn(usize, usize) -> Option<Color32>,
    /// Whether a row is in focus.
    pub selected: &'a dyn Fn(usize) -> bool,
}

impl TableLook<'_> {
    /// Default colours, no row in focus.
    pub const PLAIN: TableLook<'static> = TableLook {
        color: &|_, _| None,
        selected: &|_| false,
    };
}

/// Request from a table's context menu.
#[derive(Clone, Debug, PartialEq)]
pub enum TableRequest {
    /// Copies this text to the clipboard.
    Copy(String),
    /// Asks for a path and saves the table there as CSV.
    Save(Arc<Table>),
}

/// Draws a table that scrolls if it is too large. Its headings sort it; a right-click copies or
/// saves it.
pub fn table_ui<C: From<TableRequest>>(
    ui: &mut Ui,
    table: &Table,
    sorting: &mut Sorting,
    look: &TableLook<'_>,
    palette: &Palette,
    commands: &mut Vec<C>,
) -> Option<TableClick> {
    let area = ScrollArea::both()
        .id_salt(("table", &table.title))
        .auto_shrink(false);
    area.show(ui, |ui| {
        table_grid_ui(ui, table, sorting, look, palette, commands)
    })
    .inner
}

/// Like [`table_ui`], at full size without scrolling.
pub fn table_grid_ui<C: From<TableRequest>>(
    ui: &mut Ui,
    table: &Table,
    sorting: &mut Sorting,
    look: &TableLook<'_>,
    palette: &Palette,
    commands: &mut Vec<C>,
) -> Option<TableClick> {
    let mut clicked = None;
    let order = sorting.order(table);
    // Row 0 is the heading.
    let is_selected: Vec<bool> = std::iter::once(false)
        .chain(order.iter().map(|row| (look.selected)(*row)))
        .collect();
    let selected = palette.selected;
    Grid::new(("cells", &table.title))
        .spacing([12.0, 3.0])
        .with_row_color(move |row, style| {
            if is_selected.get(row) == Some(&true) {
                Some(selected)
            } else if row % 2 == 1 {
                Some(style.visuals.faint_bg_color)
            } else {
                None
            }
        })
        .show(ui, |ui| {
            headings_ui(ui, table, sorting, palette, commands);
            for row in order {
                for (column, cell) in table.rows[row].iter().enumerate() {
                    let color = (look.color)(row, column).unwrap_or(palette.text);
                    let response = cell_ui(ui, cell, color);
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

/// Draws the headings; a click sorts the table.
fn headings_ui<C: From<TableRequest>>(
    ui: &mut Ui,
    table: &Table,
    sorting: &mut Sorting,
    palette: &Palette,
    commands: &mut Vec<C>,
) {
    for (column, heading) in table.columns.iter().enumerate() {
        let text = palette.small(format!("{heading}{}", sorting.mark(column)));
        let button = ui.add(Button::new(text).frame(false));
        let name = format!("Sort {} by {heading}", table.title);
        let button = named(button, Role::Button, name);
        button.context_menu(|ui| copy_ui(ui, table, commands));
        let button = button.on_hover_text("Sort; right-click: copy or save the table");
        if button.clicked() {
            *sorting = sorting.clicked(column);
        }
    }
    ui.end_row();
}

/// Draws a cell; numbers are aligned at the right edge.
fn cell_ui(ui: &mut Ui, cell: &str, color: Color32) -> Response {
    let text = RichText::new(cell).size(SMALL_SIZE).color(color);
    let align = if number_in(cell).is_some() || cell == "-" {
        Align::Max
    } else {
        Align::Min
    };
    let label = Label::new(text)
        .sense(Sense::click())
        .selectable(false)
        .extend();
    ui.with_layout(Layout::top_down(align), |ui| ui.add(label))
        .inner
}

fn copy_ui<C: From<TableRequest>>(ui: &mut Ui, table: &Table, commands: &mut Vec<C>) {
    let entries = [
        ("Copy the table as text", TableRequest::Copy(table.text())),
        (
            "Save the table as CSV…",
            TableRequest::Save(Arc::new(table.clone())),
        ),
    ];
    entries_ui(
        ui,
        entries.map(|(text, request)| (text, request.into())),
        commands,
    );
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
        let by_name = Sorting::default().clicked(0);
        let by_value = Sorting::default().clicked(1);
        assert_eq!(by_value.order(&table()), [1, 3, 0, 2], "empty cells last");
        let falling = by_value.clicked(1);
        assert_eq!(falling.order(&table()), [0, 3, 1, 2], "downwards too");
        assert_eq!(by_name.order(&table()), [1, 0, 2, 3]);
    }

    #[test]
    fn the_third_click_on_a_heading_leaves_the_table_as_it_was_made() {
        let sorting = Sorting::default().clicked(1).clicked(1).clicked(1);
        assert_eq!(sorting.order(&table()), [0, 1, 2, 3]);
        assert_eq!(
            Sorting::default().clicked(0).clicked(1),
            Sorting::default().clicked(1)
        );
    }
}
