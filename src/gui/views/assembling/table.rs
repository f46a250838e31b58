//! The table of models, and the list of incomplete items.

use egui::{
    Align, Button, Color32, Label, Layout, Rect, RichText, Role, ScrollArea, Sense, Ui, vec2,
};

use gdcm_model::assembly::part::Part;

use super::details::columns_ui;
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::state::assembly_columns::COLUMNS;
use crate::gui::widgets::controls::{
    Asks, ROW_HEIGHT, elided_among, named, named_switch, painted_text,
};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE, small};

/// Index of the column that marks incomplete models.
const FILE: usize = COLUMNS.len() - 1;

/// Draws the table; only visible lines are laid out.
pub(super) fn table_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let width = ui.available_width() - 12.0;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        for (index, column) in COLUMNS.iter().enumerate() {
            let text = palette.small(format!(
                "{}{}",
                column.heading,
                assembly.sorting.mark(index)
            ));
            let size = vec2(width * column.share, ROW_HEIGHT);
            let button =
                ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
                    ui.set_min_size(size);
                    ui.add(Button::new(text).frame(false))
                });
            let name = format!("Sort models by {}", column.heading);
            named(button.inner, Role::Button, &name)
                .on_hover_text(&name)
                .asks(AssemblingCommand::Sort(index), commands);
        }
    });
    let order = assembly.order();
    let incomplete: Vec<usize> = assembly
        .assembly()
        .problems()
        .iter()
        .filter_map(|problem| problem.part)
        .collect();
    let area = ScrollArea::vertical()
        .id_salt("models that are imported")
        .auto_shrink(false);
    area.show_rows(ui, ROW_HEIGHT, order.len(), |ui, rows| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let part_at = |place: usize| {
            order
                .get(place)
                .map(|index| &assembly.assembly().parts()[*index])
        };
        for place in rows {
            let (index, Some(part)) = (order[place], part_at(place)) else {
                continue;
            };
            let neighbours = [place.checked_sub(1), Some(place + 1)].map(|place| part_at(place?));
            let (rect, response) = ui.allocate_exact_size(vec2(width, ROW_HEIGHT), Sense::click());
            let is_shown = assembly.selected == index;
            let response = named_switch(
                response,
                Role::Row,
                is_shown,
                format!("Model {}", part.found.key()),
            );
            let fill = match () {
                () if is_shown => palette.selected,
                () if response.contains_pointer() => palette.raised,
                () => Color32::TRANSPARENT,
            };
            ui.painter().rect_filled(rect, 2.0, fill);
            paint_cells(
                ui,
                rect,
                (part, neighbours),
                incomplete.contains(&index),
                palette,
            );
            response.asks(AssemblingCommand::Select(index), commands);
        }
    });
}

/// Paints the texts of a row; cut texts keep the part that distinguishes them from other rows.
fn paint_cells(
    ui: &Ui,
    row: Rect,
    (part, neighbours): (&Part, [Option<&Part>; 2]),
    is_incomplete: bool,
    palette: &Palette,
) {
    let mut left = row.left();
    for (index, column) in COLUMNS.iter().enumerate() {
        let text = column.text(part);
        let room = row.width() * column.share;
        let is_marked = is_incomplete && index == FILE;
        let color = match () {
            () if text == "?" => palette.warning,
            () if part.row.left_out => palette.quiet_text,
            () if is_marked => palette.warning,
            () => palette.text,
        };
        let text = if is_marked {
            format!("⚠ {text}")
        } else {
            text
        };
        let others = neighbours.map(|other| other.map(|other| column.text(other)));
        let text = elided_among(
            ui,
            &text,
            others.each_ref().map(Option::as_deref),
            room - 6.0,
            SMALL_SIZE,
        );
        let place = Rect::from_x_y_ranges(left + 3.0..=left + room, row.y_range());
        painted_text(ui, place, 0.0, &text, small(), color);
        left += room;
    }
}

/// Maximum number of listed lines; further ones are only counted.
const MOST_LINES: usize = 200;
/// Maximum number of tables without models whose columns are shown here; the others follow once
/// these are read.
const MOST_TABLES: usize = 5;

/// Shows a line for each incomplete item; a click displays its model.
pub(super) fn problems_ui(
    ui: &mut Ui,
    state: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let assembly = state.assembly();
    let problems = state.assembly().problem_lines();
    let heading = match problems.len() {
        0 => "Nothing is missing: the dataset can be made".to_owned(),
        1 => "1 item to complete".to_owned(),
        count => format!("{count} items to complete"),
    };
    ui.label(
        RichText::new(heading)
            .strong()
            .color(if problems.is_empty() {
                palette.text
            } else {
                palette.warning
            }),
    );
    let without = assembly.without_reference();
    if problems.is_empty() && !without.is_empty() {
        let ids = without
            .iter()
            .map(i64::to_string)
            .collect::<Vec<_>>()
            .join(", ");
        let words = format!(
            "No identified models yet of conditions {ids}: identify them from flight records afterwards"
        );
        ui.add(Label::new(palette.small(words)).wrap());
    }
    ScrollArea::vertical()
        .id_salt("problems")
        .auto_shrink(false)
        .show(ui, |ui| {
            for caution in assembly.cautions() {
                let words = format!("caution: {}", assembly.caution_words(&caution));
                let response = ui.add(
                    Label::new(palette.small_warning(words))
                        .sense(Sense::click())
                        .wrap(),
                );
                if response.clicked()
                    && let Some(part) = caution.parts.first()
                {
                    commands.push(AssemblingCommand::Select(*part).into());
                }
            }
            for problem in problems.iter().take(MOST_LINES) {
                let text = RichText::new(&problem.text)
                    .size(SMALL_SIZE)
                    .color(palette.text);
                let response = ui.add(Label::new(text).sense(Sense::click()).wrap());
                if response.clicked()
                    && let Some(part) = problem.part
                {
                    commands.push(AssemblingCommand::Select(part).into());
                }
            }
            if problems.len() > MOST_LINES {
                ui.label(palette.small(format!("and {} more", problems.len() - MOST_LINES)));
            }
            let parts = assembly.parts();
            let unread = state
                .tables
                .keys()
                .filter(|file| !parts.iter().any(|part| part.found.file() == file.as_str()));
            for file in unread.take(MOST_TABLES) {
                columns_ui(ui, state, file, palette, commands);
            }
            let not_read = state
                .faults
                .iter()
                .map(|fault| palette.small_warning(format!("not read: {fault}")));
            let no_models = state
                .ignored
                .iter()
                .map(|words| palette.small(format!("no model: {words}")));
            let not_used = state.unused.iter().map(|words| palette.small(words));
            for text in not_read.chain(no_models).chain(not_used).take(MOST_LINES) {
                ui.add(Label::new(text).wrap());
            }
        });
}
