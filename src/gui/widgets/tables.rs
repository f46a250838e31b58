//! Tables in the window. A click on a heading sorts (`sorting.rs`); the menu and Ctrl+C copy, the
//! menu saves. `table_layout.rs` measures the columns.
//!
//! The Tab key stops at a single cell of a table, the *tab stop*; from there the arrow keys move
//! through the cells, and take the tab stop with them. egui keeps it between frames.

use std::sync::Arc;

use egui::{
    Align, Color32, Event, EventFilter, Id, Key, Rangef, Rect, Response, Role, ScrollArea, Sense,
    Shape, Stroke, Ui, WidgetInfo, pos2, vec2,
};

use gdcm_words::Table;

use super::controls::{entries_ui, named};
use super::palette::{Palette, small};
pub use super::sorting::Sorting;
use super::sorting::{SortDirection, is_missing};
use super::table_layout::{COLUMN_GAP, HEADING_HEIGHT, ROW_HEIGHT, TableLayout, shown_text};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableClick {
    /// Row index in the original order.
    pub row: usize,
    pub column: usize,
}

/// Cell colours, and the rows in focus.
pub struct TableLook<'a> {
    /// Text colour for a cell, by row in the original order and column; `None` for the default
    /// colour.
    pub color: &'a dyn Fn(usize, usize) -> Option<Color32>,
    /// Whether a row, counted in the original order, is in focus.
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

/// Returns the height of a table with single-line rows, including the scroll bar below it \[pt\].
pub fn table_height(ui: &Ui, rows: usize) -> f32 {
    HEADING_HEIGHT + ROW_HEIGHT * rows as f32 + ui.spacing().scroll.allocated_width()
}

/// Draws a table that scrolls if it is too large; its headings stay in sight. A click on a heading
/// sorts; the menu copies or saves. Returns the clicked cell.
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

/// Like [`table_ui`], at full size without scrolling of its own:
///
/// 1. sort the rows, and measure columns and rows;
/// 2. draw the headings, at the upper edge of the visible part while the table is scrolled;
/// 3. draw the rows, clipped at the headings; returns the clicked cell.
pub fn table_grid_ui<C: From<TableRequest>>(
    ui: &mut Ui,
    table: &Table,
    sorting: &mut Sorting,
    look: &TableLook<'_>,
    palette: &Palette,
    commands: &mut Vec<C>,
) -> Option<TableClick> {
    // Step 1.
    let order = sorting.order(table);
    let layout = TableLayout::new(ui, table, &order, ui.available_width());
    let size = vec2(layout.width, HEADING_HEIGHT + layout.height());
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    // Step 2.
    // The headings stay at the upper edge of the visible part until the last row.
    let lowest = (rect.bottom() - HEADING_HEIGHT - ROW_HEIGHT).max(rect.top());
    let heading_top = ui.clip_rect().top().clamp(rect.top(), lowest);
    let drawn = DrawnTable {
        id: ui.scope_id().with(("cells", &table.title)),
        table,
        order: &order,
        layout: &layout,
        rect,
        heading: rect
            .with_min_y(heading_top)
            .with_max_y(heading_top + HEADING_HEIGHT),
        palette,
    };
    drawn.headings_ui(ui, sorting, commands);
    // Step 3.
    let outer_clip = ui.clip_rect();
    ui.set_clip_rect(outer_clip.with_min_y(drawn.heading.bottom().max(outer_clip.top())));
    let clicked = drawn.rows_ui(ui, look, commands);
    ui.set_clip_rect(outer_clip);
    clicked
}

/// Draws a table at full height, for a page that scrolls; a table that is too wide scrolls
/// sideways. The window keeps the row order until it is closed. Returns the clicked cell.
pub fn table_block_ui<C: From<TableRequest>>(
    ui: &mut Ui,
    table: &Table,
    look: &TableLook<'_>,
    palette: &Palette,
    commands: &mut Vec<C>,
) -> Option<TableClick> {
    // The title may name a condition; the columns are the same for every condition.
    let id = ui.scope_id().with(("order", &table.columns));
    let mut sorting: Sorting = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let before = sorting;
    let click = ScrollArea::horizontal()
        .id_salt(("table", &table.title))
        .auto_shrink([false, true])
        .show(ui, |ui| {
            table_grid_ui(ui, table, &mut sorting, look, palette, commands)
        })
        .inner;
    if sorting != before {
        ui.data_mut(|data| data.insert_temp(id, sorting));
    }
    click
}

/// Table with its position on the screen.
struct DrawnTable<'a> {
    id: Id,
    table: &'a Table,
    /// Table row index for each row on the screen.
    order: &'a [usize],
    layout: &'a TableLayout,
    rect: Rect,
    heading: Rect,
    palette: &'a Palette,
}

/// Row and column of a cell, counted on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct CellPlace {
    row: usize,
    column: usize,
}

impl CellPlace {
    /// Moves by an arrow key, or by Home and End within the row.
    fn moved(self, key: Key, rows: usize, columns: usize) -> Self {
        let last_row = rows.saturating_sub(1);
        let last_column = columns.saturating_sub(1);
        let Self { row, column } = self;
        match key {
            Key::ArrowUp => Self {
                row: row.saturating_sub(1),
                column,
            },
            Key::ArrowDown => Self {
                row: (row + 1).min(last_row),
                column,
            },
            Key::ArrowLeft => Self {
                row,
                column: column.saturating_sub(1),
            },
            Key::ArrowRight => Self {
                row,
                column: (column + 1).min(last_column),
            },
            Key::Home => Self { row, column: 0 },
            Key::End => Self {
                row,
                column: last_column,
            },
            _ => self,
        }
    }
}

impl DrawnTable<'_> {
    /// Returns a column's horizontal range on the screen, with half the gap on both sides.
    fn column_range(&self, column: usize) -> Rangef {
        let range = self.layout.columns[column].range_with_gap();
        Rangef::new(self.rect.left() + range.start, self.rect.left() + range.end)
    }

    /// Returns a row's vertical range on the screen.
    fn row_range(&self, row: usize) -> Rangef {
        let top = self.rect.top() + HEADING_HEIGHT;
        let edges = &self.layout.row_edges;
        Rangef::new(top + edges[row], top + edges[row + 1])
    }

    /// Draws the headings; a click sorts the table.
    fn headings_ui<C: From<TableRequest>>(
        &self,
        ui: &mut Ui,
        sorting: &mut Sorting,
        commands: &mut Vec<C>,
    ) {
        for (column, heading) in self.table.columns.iter().enumerate() {
            let place = Rect::from_x_y_ranges(self.column_range(column), self.heading.y_range());
            let response = ui.interact(place, self.id.with(("heading", column)), Sense::click());
            let name = format!("Sort {} by {heading}", self.table.title);
            let response = named(response, Role::Button, name);
            response.context_menu(|ui| self.menu_ui(ui, None, commands));
            let direction = sorting.direction(column);
            let is_pointed = response.hovered() || response.has_focus();
            let color = if is_pointed || direction.is_some() {
                self.palette.text
            } else {
                self.palette.dim_text
            };
            self.paint_heading(ui, column, heading, direction, color);
            let response = response.on_hover_text("Sort; right-click: copy or save the table");
            if response.clicked() {
                *sorting = sorting.clicked(column);
            }
        }
        let line = Stroke::new(1.0, self.palette.line);
        let y = self.heading.bottom() - 0.5;
        ui.painter().hline(self.rect.x_range(), y, line);
    }

    /// Paints a heading, aligned like its cells, and a triangle in the gap beside it if the table
    /// is sorted by it.
    fn paint_heading(
        &self,
        ui: &Ui,
        column: usize,
        heading: &str,
        direction: Option<SortDirection>,
        color: Color32,
    ) {
        let galley = ui
            .painter()
            .layout_no_wrap(heading.to_owned(), small(), color);
        let measured = &self.layout.columns[column];
        let left = self.rect.left() + measured.left;
        let text_left = match measured.align() {
            Align::Max => left + measured.width - galley.size().x,
            Align::Min | Align::Center => left,
        };
        let middle = self.heading.center().y;
        let text_right = text_left + galley.size().x;
        let place = pos2(text_left, middle - 0.5 * galley.size().y);
        ui.painter().galley(place, galley, color);
        if let Some(direction) = direction {
            let x = match measured.align() {
                Align::Max => text_left - 0.4 * COLUMN_GAP,
                Align::Min | Align::Center => text_right + 0.4 * COLUMN_GAP,
            };
            let tip = match direction {
                SortDirection::Ascending => -2.5,
                SortDirection::Descending => 2.5,
            };
            let triangle = vec![
                pos2(x - 3.5, middle - tip),
                pos2(x + 3.5, middle - tip),
                pos2(x, middle + tip),
            ];
            let stroke = Stroke::NONE;
            ui.painter()
                .add(Shape::convex_polygon(triangle, self.palette.accent, stroke));
        }
    }

    /// Draws the rows below the headings; returns the clicked cell. A click or an arrow key makes
    /// another cell the tab stop.
    fn rows_ui<C: From<TableRequest>>(
        &self,
        ui: &mut Ui,
        look: &TableLook<'_>,
        commands: &mut Vec<C>,
    ) -> Option<TableClick> {
        let mut tab_stop: CellPlace = ui.data(|data| data.get_temp(self.id)).unwrap_or_default();
        tab_stop.row = tab_stop.row.min(self.order.len().saturating_sub(1));
        let mut clicked = None;
        let mut next_tab_stop = tab_stop;
        for (place, &row) in self.order.iter().enumerate() {
            self.paint_row(ui, place, (look.selected)(row));
            for column in 0..self.table.columns.len() {
                let at = CellPlace { row: place, column };
                let color = (look.color)(row, column);
                let response = self.cell_ui(ui, at, at == tab_stop, color, commands);
                if response.clicked() {
                    clicked = Some(TableClick { row, column });
                    next_tab_stop = at;
                }
                if at == tab_stop && response.has_focus() {
                    next_tab_stop = self.moved_tab_stop(ui, &response, tab_stop, commands);
                }
            }
        }
        if next_tab_stop != tab_stop {
            ui.data_mut(|data| data.insert_temp(self.id, next_tab_stop));
        }
        clicked
    }

    fn cell_id(&self, at: CellPlace) -> Id {
        self.id.with((at.row, at.column))
    }

    /// Paints a row's background, unless the row is out of sight.
    fn paint_row(&self, ui: &Ui, place: usize, is_selected: bool) {
        let rect = Rect::from_x_y_ranges(self.rect.x_range(), self.row_range(place));
        if !ui.is_rect_visible(rect) {
            return;
        }
        let fill = if is_selected {
            self.palette.selected
        } else if ui.rect_contains_pointer(rect) {
            self.palette.raised
        } else if place % 2 == 1 {
            self.palette.raised.gamma_multiply(0.6)
        } else {
            return;
        };
        ui.painter().rect_filled(rect, 0.0, fill);
    }

    /// Draws a cell. The Tab key stops only at a focusable sense: `Sense::click()`, not
    /// `Sense::CLICK`.
    fn cell_ui<C: From<TableRequest>>(
        &self,
        ui: &mut Ui,
        at: CellPlace,
        is_tab_stop: bool,
        color: Option<Color32>,
        commands: &mut Vec<C>,
    ) -> Response {
        let cell = self.table.rows[self.order[at.row]][at.column].as_str();
        let place = Rect::from_x_y_ranges(self.column_range(at.column), self.row_range(at.row));
        // A cell that has just received the focus would lose it without a focusable sense.
        let id = self.cell_id(at);
        let is_focused = ui.memory(|memory| memory.has_focus(id));
        let sense = if is_tab_stop || is_focused {
            Sense::click()
        } else {
            Sense::CLICK
        };
        let response = ui.interact(place, id, sense);
        let text = shown_text(cell);
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, text));
        response.context_menu(|ui| self.menu_ui(ui, Some(text), commands));
        if !ui.is_rect_visible(place) {
            return response;
        }
        let color = match color {
            Some(color) => color,
            None if is_missing(cell) => self.palette.dim_text,
            None => self.palette.text,
        };
        let galley = self.layout.cell_text(ui, cell, at.column);
        let left = self.rect.left() + self.layout.text_left(ui, cell, at.column);
        let top = place.center().y - 0.5 * galley.size().y;
        ui.painter().galley(pos2(left, top), galley, color);
        response
    }

    /// Applies the keys pressed while the tab stop has the focus: arrows, Home and End move both,
    /// Ctrl+C copies the table. Returns the cell that has them afterwards.
    fn moved_tab_stop<C: From<TableRequest>>(
        &self,
        ui: &Ui,
        response: &Response,
        tab_stop: CellPlace,
        commands: &mut Vec<C>,
    ) -> CellPlace {
        const KEYS: [Key; 6] = [
            Key::ArrowUp,
            Key::ArrowDown,
            Key::ArrowLeft,
            Key::ArrowRight,
            Key::Home,
            Key::End,
        ];
        if ui.input(|input| input.events.contains(&Event::Copy)) {
            commands.push(TableRequest::Copy(self.as_drawn().text()).into());
        }
        let mut moved = tab_stop;
        for key in KEYS {
            if ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, key)) {
                moved = moved.moved(key, self.order.len(), self.table.columns.len());
            }
        }
        let filter = EventFilter {
            horizontal_arrows: true,
            vertical_arrows: true,
            ..EventFilter::default()
        };
        ui.memory_mut(|memory| {
            memory.set_focus_lock_filter(response.id, filter);
            if moved != tab_stop {
                memory.request_focus(self.cell_id(moved));
            }
        });
        if moved != tab_stop {
            let x = self.column_range(moved.column);
            let y = self.row_range(moved.row);
            // The row must not be hidden by the headings.
            let y = Rangef::new(y.min - HEADING_HEIGHT, y.max);
            ui.scroll_to_rect(Rect::from_x_y_ranges(x, y), None);
        }
        moved
    }

    /// Returns the table with its rows in the order on the screen.
    fn as_drawn(&self) -> Table {
        let mut rows = Vec::new();
        for row in self.order {
            rows.push(self.table.rows[*row].clone());
        }
        Table {
            title: self.table.title.clone(),
            columns: self.table.columns.clone(),
            rows,
        }
    }

    /// Draws the menu for a heading, or for a cell with this text.
    fn menu_ui<C: From<TableRequest>>(
        &self,
        ui: &mut Ui,
        cell: Option<&str>,
        commands: &mut Vec<C>,
    ) {
        let table = self.as_drawn();
        let mut entries = Vec::new();
        if let Some(cell) = cell {
            entries.push(("Copy this value", TableRequest::Copy(cell.to_owned())));
        }
        entries.push(("Copy the table as text", TableRequest::Copy(table.text())));
        entries.push((
            "Save the table as CSV…",
            TableRequest::Save(Arc::new(table)),
        ));
        let mut requests = Vec::new();
        for (text, request) in entries {
            requests.push((text, request.into()));
        }
        entries_ui(ui, requests, commands);
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;
    use crate::gui::widgets::palette::apply;

    #[derive(Default)]
    struct Shown {
        sorting: Sorting,
        clicks: Vec<TableClick>,
        requests: Vec<TableRequest>,
    }

    fn table() -> Table {
        let mut table = Table::new("gains", ["channel", "k [-]", "τ [ms]"]);
        table.row(["LON", "1.132", "-"]);
        table.row(["LAT", "0.98", "12"]);
        table.row(["PED", "", "\u{2212}3.5"]);
        table
    }

    fn harness() -> Harness<'static, Shown> {
        let mut harness = Harness::builder().with_context_setup(apply).build_ui_state(
            |ui, shown: &mut Shown| {
                let click = table_ui(
                    ui,
                    &table(),
                    &mut shown.sorting,
                    &TableLook::PLAIN,
                    &Palette::dark(),
                    &mut shown.requests,
                );
                shown.clicks.extend(click);
            },
            Shown::default(),
        );
        harness.run_steps(2);
        harness
    }

    fn center(harness: &Harness<'_, Shown>, label: &str) -> egui::Pos2 {
        harness.get_by_label(label).rect().center()
    }

    #[test]
    fn cells_are_centred_in_rows_of_one_height_under_their_headings() {
        let harness = harness();
        let heading = harness.get_by_label("Sort gains by k [-]").rect();
        let mut rows = Vec::new();
        for label in ["LON", "LAT", "PED"] {
            rows.push(harness.get_by_label(label).rect());
        }
        for row in &rows {
            assert_eq!(row.height(), ROW_HEIGHT);
        }
        assert_eq!(rows[1].top(), rows[0].bottom());
        for label in ["1.132", "0.98"] {
            let cell = harness.get_by_label(label).rect();
            assert_eq!(cell.x_range(), heading.x_range());
        }
        let shapes = harness.output().shapes.iter();
        let mut texts = 0;
        for drawn in shapes {
            if let Shape::Text(text) = &drawn.shape
                && text.galley.text() == "LAT"
            {
                let middle = text.pos.y + 0.5 * text.galley.size().y;
                assert!((middle - rows[1].center().y).abs() < 1.0);
                texts += 1;
            }
        }
        assert_eq!(texts, 1);
        assert_eq!(harness.query_all_by_label("–").count(), 2, "one sign");
    }

    #[test]
    fn a_heading_sorts_and_missing_values_stay_last() {
        let mut harness = harness();
        harness.get_by_label("Sort gains by k [-]").click();
        harness.run_steps(2);
        assert!(center(&harness, "LAT").y < center(&harness, "LON").y);
        harness.get_by_label("Sort gains by k [-]").click();
        harness.run_steps(2);
        assert!(center(&harness, "LON").y < center(&harness, "LAT").y);
        assert!(center(&harness, "LAT").y < center(&harness, "PED").y);
    }

    #[test]
    fn the_keyboard_moves_through_the_cells_and_copies_the_table() {
        let mut harness = harness();
        // Three headings, then one cell: the others are reached with the arrow keys.
        for _ in 0..4 {
            harness.key_press(Key::Tab);
            harness.run_steps(1);
        }
        assert!(harness.get_by_label("LON").is_focused());
        for key in [Key::ArrowDown, Key::ArrowRight] {
            harness.key_press(key);
            harness.run_steps(2);
        }
        assert!(harness.get_by_label("0.98").is_focused());
        harness.event(Event::Copy);
        harness.run_steps(1);
        let copied = TableRequest::Copy(table().text());
        assert_eq!(harness.state().requests, [copied]);
        harness.key_press(Key::Enter);
        harness.run_steps(1);
        let click = TableClick { row: 1, column: 1 };
        assert_eq!(harness.state().clicks, [click]);
        harness.key_press(Key::Tab);
        harness.run_steps(1);
        assert!(!harness.get_by_label("0.98").is_focused(), "one stop only");
    }

    #[test]
    fn the_headings_stay_in_sight_while_the_rows_scroll() {
        let mut long = Table::new("long", ["row"]);
        for row in 0..100 {
            long.row([format!("row {row}")]);
        }
        let mut harness = Harness::builder()
            .with_context_setup(apply)
            .build_ui(move |ui| {
                ui.set_max_height(200.0);
                let mut sorting = Sorting::default();
                let mut requests: Vec<TableRequest> = Vec::new();
                let palette = Palette::dark();
                let look = TableLook::PLAIN;
                table_ui(ui, &long, &mut sorting, &look, &palette, &mut requests);
            });
        harness.run_steps(2);
        let before = harness.get_by_label("Sort long by row").rect();
        harness.hover_at(harness.get_by_label("row 2").rect().center());
        harness.event(Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: vec2(0.0, -300.0),
            phase: egui::TouchPhase::Move,
            modifiers: egui::Modifiers::NONE,
            source: egui::MouseWheelSource::Wheel,
        });
        harness.run_steps(20);
        let after = harness.get_by_label("Sort long by row").rect();
        let first = harness.get_by_label("row 0").rect();
        assert!(
            (after.top() - before.top()).abs() <= 4.0,
            "{before} {after}"
        );
        assert!(first.top() < before.top() - 100.0, "the rows have moved");
    }
}
