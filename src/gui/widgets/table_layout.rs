//! Measured table layout: column alignments and widths, row heights.
//!
//! A number column is right-aligned, heading included, and its numbers are aligned at the decimal
//! point; any other column is left-aligned.

use std::ops::Range;
use std::sync::Arc;

use egui::{Align, Color32, FontId, Galley, Ui};

use gdcm_model::number_format::NO_VALUE;
use gdcm_words::Table;

use super::palette::small;
use super::sorting::{is_missing, number_in};

/// Height of a row with a single text line \[pt\].
pub(super) const ROW_HEIGHT: f32 = 20.0;
/// Heading height \[pt\].
pub(super) const HEADING_HEIGHT: f32 = 22.0;
/// Gap between two columns; it has room for the sort mark \[pt\].
pub(super) const COLUMN_GAP: f32 = 18.0;
/// Margin before the first column and after the last one \[pt\].
const MARGIN: f32 = 6.0;
/// Minimum width for a last column whose text is wrapped \[pt\].
const LEAST_WRAPPED: f32 = 140.0;
/// Space above and below wrapped text \[pt\].
const WRAPPED_PAD: f32 = 3.0;

/// Returns the text shown in a cell: every missing value has the same sign.
pub(super) fn shown_text(cell: &str) -> &str {
    if is_missing(cell) { NO_VALUE } else { cell }
}

/// Returns the part of a cell before the decimal point in its first number, or the whole number if
/// it has none: "−2" in "−2.54 ± j1.26", "120" in "120 kt".
fn before_point(cell: &str) -> &str {
    let word = cell.split_whitespace().next().unwrap_or(cell);
    match word.find('.') {
        Some(point) => &word[..point],
        None => word,
    }
}

/// Returns whether all values in a column are numbers, with at most three words such as a unit
/// after them, and there is at least one value.
fn is_numeric(table: &Table, column: usize) -> bool {
    /// Maximum count of words, the number included: "1.20 ± 0.05 ms".
    const MOST_WORDS: usize = 4;
    let mut has_number = false;
    for row in &table.rows {
        let cell = row[column].as_str();
        if is_missing(cell) {
            continue;
        }
        if number_in(cell).is_none() || cell.split_whitespace().count() > MOST_WORDS {
            return false;
        }
        has_number = true;
    }
    has_number
}

/// Measured column: position, width, and alignment at the decimal point.
pub(super) struct TableColumn {
    /// Left edge, relative to the table \[pt\].
    pub left: f32,
    pub width: f32,
    /// Distance from the left edge to the decimal points \[pt\]; `None` for a text column.
    decimal_point: Option<f32>,
}

impl TableColumn {
    /// Returns the alignment for the heading, and for the cells as a block.
    pub fn align(&self) -> Align {
        if self.decimal_point.is_some() {
            Align::Max
        } else {
            Align::Min
        }
    }

    /// Returns the horizontal range from the table's left edge \[pt\], with half the gap on both
    /// sides.
    pub fn range_with_gap(&self) -> Range<f32> {
        let half = 0.5 * COLUMN_GAP;
        self.left - half..self.left + self.width + half
    }

    /// Returns the left end of a cell's text, relative to the column's left edge \[pt\].
    fn text_start(&self, ui: &Ui, cell: &str) -> f32 {
        match self.decimal_point {
            Some(point) => point - text_width(ui, before_point(cell), &small()),
            None => 0.0,
        }
    }
}

/// Table layout, with the rows in drawing order.
pub(super) struct TableLayout {
    pub columns: Vec<TableColumn>,
    /// Upper edges of the rows, and the lower edge of the last row, measured from the headings'
    /// lower edge \[pt\].
    pub row_edges: Vec<f32>,
    /// Total width \[pt\].
    pub width: f32,
    /// Width to which the last column's text is wrapped \[pt\]; `None` if it is not wrapped.
    wrap_width: Option<f32>,
}

impl TableLayout {
    /// Measures a table whose rows are drawn in the given order. If the table is wider than `room`
    /// points and its last column is text, that column is wrapped.
    pub fn new(ui: &Ui, table: &Table, order: &[usize], room: f32) -> Self {
        let mut columns = Vec::new();
        let mut left = MARGIN;
        for (index, heading) in table.columns.iter().enumerate() {
            let column = measured_column(ui, table, index, heading, left);
            left += column.width + COLUMN_GAP;
            columns.push(column);
        }
        let mut width = (left - COLUMN_GAP + MARGIN).max(0.0);
        let mut wrap_width = None;
        if let Some(last) = columns.last_mut()
            && last.decimal_point.is_none()
            && width > room
        {
            let excess = width - room;
            let wrapped = (last.width - excess).max(LEAST_WRAPPED);
            if wrapped < last.width {
                width -= last.width - wrapped;
                last.width = wrapped;
                wrap_width = Some(wrapped);
            }
        }
        let mut layout = Self {
            columns,
            row_edges: Vec::new(),
            width,
            wrap_width,
        };
        layout.row_edges = layout.measured_rows(ui, table, order);
        layout
    }

    fn measured_rows(&self, ui: &Ui, table: &Table, order: &[usize]) -> Vec<f32> {
        let mut edges = vec![0.0];
        let mut edge = 0.0;
        for &row in order {
            let mut height = ROW_HEIGHT;
            if self.wrap_width.is_some()
                && let Some(cell) = table.rows[row].last()
            {
                let text = self.cell_text(ui, cell, self.columns.len() - 1);
                if text.rows.len() > 1 {
                    height = text.size().y + 2.0 * WRAPPED_PAD;
                }
            }
            edge += height;
            edges.push(edge);
        }
        edges
    }

    /// Lays out a cell's text, without its colour.
    pub fn cell_text(&self, ui: &Ui, cell: &str, column: usize) -> Arc<Galley> {
        let text = shown_text(cell).to_owned();
        let placeholder = Color32::PLACEHOLDER;
        match self.wrap_width {
            Some(width) if column + 1 == self.columns.len() => {
                ui.painter().layout(text, small(), placeholder, width)
            }
            _ => ui.painter().layout_no_wrap(text, small(), placeholder),
        }
    }

    /// Returns the left end of a cell's text, relative to the table's left edge \[pt\].
    pub fn text_left(&self, ui: &Ui, cell: &str, column: usize) -> f32 {
        let column = &self.columns[column];
        column.left + column.text_start(ui, shown_text(cell))
    }

    /// Returns the total row height, without the headings \[pt\].
    pub fn height(&self) -> f32 {
        self.row_edges.last().copied().unwrap_or_default()
    }
}

/// Measures a column: as wide as its heading and its widest cell. Since the decimal points of a
/// number column are aligned, its cells need the widest part before the point and the widest part
/// from the point on; the block of numbers ends at the right edge.
fn measured_column(ui: &Ui, table: &Table, index: usize, heading: &str, left: f32) -> TableColumn {
    let font = small();
    let heading_width = text_width(ui, heading, &font);
    if !is_numeric(table, index) {
        let mut width = heading_width;
        for row in &table.rows {
            width = width.max(text_width(ui, shown_text(&row[index]), &font));
        }
        return TableColumn {
            left,
            width,
            decimal_point: None,
        };
    }
    let mut before = 0.0_f32;
    let mut from_point = 0.0_f32;
    for row in &table.rows {
        let cell = shown_text(&row[index]);
        let width_before = text_width(ui, before_point(cell), &font);
        before = before.max(width_before);
        from_point = from_point.max(text_width(ui, cell, &font) - width_before);
    }
    let width = heading_width.max(before + from_point);
    TableColumn {
        left,
        width,
        decimal_point: Some(width - from_point),
    }
}

/// Returns the text width on a single line \[pt\].
fn text_width(ui: &Ui, text: &str, font: &FontId) -> f32 {
    let color = Color32::PLACEHOLDER;
    let galley = ui
        .painter()
        .layout_no_wrap(text.to_owned(), font.clone(), color);
    galley.size().x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gui::widgets::palette::apply;

    fn with_layout(table: &Table, room: f32, check: impl Fn(&Ui, &TableLayout)) {
        let ctx = egui::Context::default();
        apply(&ctx);
        let order: Vec<usize> = (0..table.rows.len()).collect();
        for _ in 0..2 {
            let output = ctx.run_ui(egui::RawInput::default(), |ui| {
                check(ui, &TableLayout::new(ui, table, &order, room));
            });
            output.drop_without_applying_deltas();
        }
    }

    #[test]
    fn numbers_share_the_place_of_their_decimal_point() {
        let mut table = Table::new("t", ["pole", "name"]);
        for pole in ["−2.54 ± j1.26", "10.125", "7", "-", ""] {
            table.row([pole, "a"]);
        }
        with_layout(&table, 900.0, |ui, layout| {
            let mut points = Vec::new();
            for row in &table.rows {
                let cell = shown_text(&row[0]);
                let left = layout.text_left(ui, cell, 0);
                points.push(left + text_width(ui, before_point(cell), &small()));
            }
            for point in &points {
                assert!((point - points[0]).abs() < 0.01, "{points:?}");
            }
            let column = &layout.columns[0];
            assert_eq!(column.align(), Align::Max);
            assert_eq!(layout.columns[1].align(), Align::Min);
            let end = layout.text_left(ui, "−2.54 ± j1.26", 0)
                + text_width(ui, "−2.54 ± j1.26", &small());
            assert!(
                (end - column.left - column.width).abs() < 0.01,
                "the widest cell ends where its heading ends"
            );
        });
    }

    #[test]
    fn a_missing_value_has_one_sign() {
        for cell in ["", "-", "—", "–", " "] {
            assert_eq!(shown_text(cell), "–");
        }
        assert_eq!(shown_text("-0.1"), "-0.1");
    }

    #[test]
    fn sentences_that_begin_with_a_number_are_text() {
        let mut table = Table::new("t", ["a", "b", "c"]);
        table.row(["2 of the 11 conditions have no schedule", "3 ± 1 ms", "–"]);
        assert!(!is_numeric(&table, 0));
        assert!(is_numeric(&table, 1));
        assert!(!is_numeric(&table, 2), "no number at all");
    }

    #[test]
    fn a_long_last_text_is_wrapped_within_the_room() {
        let mut table = Table::new("t", ["no.", "text"]);
        table.row(["1", &"word ".repeat(80)]);
        table.row(["2", "short"]);
        with_layout(&table, 400.0, |_, layout| {
            assert!(layout.width <= 400.5, "{}", layout.width);
            let edges = &layout.row_edges;
            assert!(edges[1] > 2.0 * ROW_HEIGHT, "{edges:?}");
            assert_eq!(edges[2] - edges[1], ROW_HEIGHT);
        });
    }
}
