//! Tables in the window: a click on a heading sorts (`sorting.rs`), a right-click copies or saves.

use std::sync::Arc;

use egui::{
    Align, Button, Color32, Grid, Label, Layout, Response, RichText, Role, ScrollArea, Sense, Ui,
};

use gdcm_words::Table;

use super::controls::{entries_ui, named};
use super::palette::{Palette, SMALL_SIZE};
pub use super::sorting::Sorting;
use super::sorting::number_in;

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
