//! Constraint matrix: channel names and a cell for each response; outputs are rows, inputs are
//! columns. `matrix_cell.rs` draws a cell.
//!
//! A held (constrained) response has its net gain matched exactly, its delay as far as possible.
//! Gain constraints conflict if no gains within their bounds meet all of them.

use std::collections::BTreeSet;

use egui::{Align2, Pos2, Rect, ScrollArea, Sense, Ui, pos2, vec2};

use gdcm_method::correction::Channel;
use gdcm_model::dataset::Pair;
use gdcm_study::ConditionAnalysis;

use super::matrix_cell::{Cell, MatrixPlace};
use super::table_menu::table_menu_ui;
use crate::gui::commands::command::Command;
use crate::gui::state::panel_tables::TableKind;
use crate::gui::state::window_state::State;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, medium, small};
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Height of the title line \[pt\].
const TITLE_HEIGHT: f32 = 20.0;
/// Minimum cell height \[pt\].
const LEAST_CELL_HEIGHT: f32 = 34.0;
/// Maximum cell height \[pt\].
const MOST_CELL_HEIGHT: f32 = 44.0;
/// Gap between two cells \[pt\].
const GAP: f32 = 3.0;
/// Minimum distance between the left edges of two cells \[pt\].
const LEAST_CELL_WIDTH: f32 = 58.0;
/// Width for the output names beside the rows \[pt\].
const ROW_LABEL_WIDTH: f32 = 28.0;
/// Height for the input names above the columns \[pt\].
const HEADER_HEIGHT: f32 = 20.0;

/// Minimum width of the title line with room for the symbol of the underlined cost \[pt\].
const LEAST_WITH_SYMBOL: f32 = 310.0;

/// Space for the matrix with its title.
#[derive(Clone, Copy)]
pub struct MatrixSpace {
    /// Height \[pt\].
    pub height: f32,
    /// Whether the focused response's card is below the matrix.
    pub has_card: bool,
}

/// Draws every response as a cell within `space`. A click on the cell shows the response in the
/// large plot; a click on its box, a double click or the space bar constrains or releases it; a
/// right-click opens a menu.
pub fn matrix_ui(
    ui: &mut Ui,
    state: &State,
    space: MatrixSpace,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let (rect, heading) =
        ui.allocate_exact_size(vec2(ui.available_width(), TITLE_HEIGHT), Sense::hover());
    painted_text(
        ui,
        rect,
        0.0,
        "Constraint matrix",
        medium(BODY_SIZE),
        palette.text,
    );
    key_ui(ui, rect, palette);
    table_menu_ui(ui, &heading, TableKind::Matrix, commands);
    let outputs = state.dataset().outputs().len();
    let pitch = (space.height - TITLE_HEIGHT - HEADER_HEIGHT) / outputs as f32;
    let grid = CellGrid {
        visible_height: space.height - TITLE_HEIGHT,
        has_card: space.has_card,
        cell_height: (pitch - GAP).clamp(LEAST_CELL_HEIGHT, MOST_CELL_HEIGHT),
    };
    region_ui(ui, Region::Matrix, |ui| {
        grid.ui(ui, state, palette, commands)
    });
}

/// Draws the key that explains the underlines, laid out from right to left.
fn key_ui(ui: &Ui, row: Rect, palette: &Palette) {
    let mut right = row.right();
    for (words, color) in [
        ("not reduced", palette.warning),
        ("after", palette.text),
        ("before", palette.quiet_mark),
    ] {
        let upto = row.with_max_x(right);
        let place = painted_text(ui, upto, AT_RIGHT_END, words, small(), palette.dim_text);
        let mark = Rect::from_center_size(pos2(place.left() - 9.0, row.center().y), vec2(9.0, 3.0));
        ui.painter().rect_filled(mark, 1.5, color);
        right = mark.left() - 10.0;
    }
    // In a narrow panel, the title leaves no room for the symbol.
    if row.width() > LEAST_WITH_SYMBOL {
        painted_text(
            ui,
            row.with_max_x(right),
            AT_RIGHT_END,
            "J",
            small(),
            palette.dim_text,
        );
    }
}

/// Layout of cells and channel names \[pt\].
struct CellGrid {
    visible_height: f32,
    /// Whether the focused response's card is below the matrix.
    has_card: bool,
    cell_height: f32,
}

impl CellGrid {
    /// Draws channel names and cells. A matrix larger than the available space scrolls separately,
    /// so that verdict and export keep their places.
    fn ui(&self, ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
        let outputs = state.dataset().outputs();
        let inputs = state.dataset().inputs();
        let column_pitch = ((ui.available_width() - ROW_LABEL_WIDTH + GAP) / inputs.len() as f32)
            .max(LEAST_CELL_WIDTH);
        let row_pitch = self.cell_height + GAP;
        let size = vec2(
            ROW_LABEL_WIDTH + column_pitch * inputs.len() as f32 - GAP,
            HEADER_HEIGHT + row_pitch * outputs.len() as f32,
        );
        let marks = match state.shown() {
            Some(shown) => MatrixMarks::new(shown),
            None => MatrixMarks::default(),
        };
        let focus = state.display.selection.pair;
        ScrollArea::both()
            .id_salt("constraint matrix")
            .max_height(self.visible_height)
            .show(ui, |ui| {
                let (area, _) = ui.allocate_exact_size(size, Sense::hover());
                let matrix = MatrixPlace {
                    visible: area.intersect(ui.clip_rect()),
                    has_card: self.has_card,
                };
                let places = CellPlaces {
                    area,
                    column_pitch,
                    row_pitch,
                    cell_height: self.cell_height,
                };
                for (input, channel) in inputs.iter().enumerate() {
                    ChannelName {
                        name: &channel.name,
                        place: places.input_name(input),
                        align: Align2::CENTER_CENTER,
                        is_marked: marks.channels.contains(&Channel::Input(input)),
                        is_focused: input == focus.input,
                    }
                    .paint(ui, palette);
                }
                for (output, channel) in outputs.iter().enumerate() {
                    ChannelName {
                        name: &channel.name,
                        place: places.output_name(output),
                        align: Align2::RIGHT_CENTER,
                        is_marked: marks.channels.contains(&Channel::Output(output)),
                        is_focused: output == focus.output,
                    }
                    .paint(ui, palette);
                    for input in 0..inputs.len() {
                        let pair = Pair { output, input };
                        Cell::new(state, pair, marks.pairs.contains(&pair), matrix).ui(
                            ui,
                            places.cell(pair),
                            palette,
                            commands,
                        );
                    }
                }
            });
    }
}

/// Screen positions of cells and names; outputs are rows, inputs are columns.
struct CellPlaces {
    /// Area with all cells and names.
    area: Rect,
    /// Distance between the left edges of two cells \[pt\].
    column_pitch: f32,
    /// Distance between the upper edges of two cells \[pt\].
    row_pitch: f32,
    cell_height: f32,
}

impl CellPlaces {
    fn left(&self, input: usize) -> f32 {
        self.area.left() + ROW_LABEL_WIDTH + self.column_pitch * input as f32
    }

    fn top(&self, output: usize) -> f32 {
        self.area.top() + HEADER_HEIGHT + self.row_pitch * output as f32
    }

    fn cell(&self, pair: Pair) -> Rect {
        Rect::from_min_size(
            pos2(self.left(pair.input), self.top(pair.output)),
            vec2(self.column_pitch - GAP, self.cell_height),
        )
    }

    /// Returns the centre of an input name on the screen.
    fn input_name(&self, input: usize) -> Pos2 {
        let center = self.left(input) + 0.5 * (self.column_pitch - GAP);
        pos2(center, self.area.top() + 0.5 * HEADER_HEIGHT)
    }

    /// Returns the right end of an output name on the screen.
    fn output_name(&self, output: usize) -> Pos2 {
        let right = self.area.left() + ROW_LABEL_WIDTH - 8.0;
        pos2(right, self.top(output) + 0.5 * self.cell_height)
    }
}

/// Input name above a column, or output name beside a row.
struct ChannelName<'a> {
    name: &'a str,
    place: Pos2,
    align: Align2,
    /// Whether the channel is marked ([`MatrixMarks::channels`]).
    is_marked: bool,
    is_focused: bool,
}

impl ChannelName<'_> {
    fn paint(&self, ui: &Ui, palette: &Palette) {
        let color = if self.is_marked {
            palette.warning
        } else if self.is_focused {
            palette.text
        } else {
            palette.dim_text
        };
        let font = if self.is_focused && !self.is_marked {
            medium(SMALL_SIZE)
        } else {
            small()
        };
        ui.painter()
            .text(self.place, self.align, self.name, font, color);
    }
}

/// Responses and channels drawn as warnings in the matrix.
#[derive(Debug, Default)]
pub struct MatrixMarks {
    /// Responses with conflicting gain constraints.
    pub pairs: BTreeSet<Pair>,
    /// Channels involved in these conflicts, and channels whose sign or unit is doubtful.
    pub channels: BTreeSet<Channel>,
}

impl MatrixMarks {
    /// Collects the marks for a condition's result.
    pub fn new(shown: &ConditionAnalysis) -> Self {
        let mut marks = Self::default();
        for conflict in &shown.gains.conflicts {
            marks.pairs.extend(conflict.entries.iter().copied());
            marks.channels.extend(conflict.channels());
        }
        for doubt in &shown.doubts {
            marks.channels.insert(doubt.channel);
        }
        marks
    }
}
