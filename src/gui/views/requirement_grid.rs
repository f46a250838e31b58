//! Requirement grid: a line for each requirement, a column for each condition. In a narrow window
//! each group of requirements, except that of the selected cell, is folded to a line of counts.
//!
//! A requirement asks that a property of the corrected model agrees with the identified model, or
//! with a held-out record, within a limit (M17: docs/requirements.md). Its verdict is *met* or
//! *outside*; other cells are not determined, or have no limit.
//!
//! [`GridPainter::lines`] lists the lines from top to bottom, and each kind of line has a method
//! that draws it. In this file, `row` is a requirement with its cells ([`GridRow`]), `line` the
//! area of a line on the screen, `column` a condition's index in the grid, and `position` the place
//! of that column in display order. `requirement_grid_layout` has the columns' positions,
//! `requirement_cells` the look of a cell.

use egui::{
    Align2, EventFilter, Key, Rect, Response, Role, ScrollArea, Sense, Ui, UiBuilder, pos2, vec2,
};

use gdcm_model::units::telling;
use gdcm_study::results::grid_cell::{CellVerdict, GridCell};
use gdcm_study::results::grid_requirement::{Requirement, RequirementGroup};
use gdcm_study::results::requirement_grid::{GridRow, RequirementGrid};
use gdcm_words::requirement_grid::{
    NOT_DETERMINED_SIGN, group_description, group_name, limit_description, limit_text, unit_text,
    value_text, value_with_unit_text, verdict_text,
};

use super::requirement_cells::{CellLook, NUMBER_MARGIN};
use super::requirement_grid_layout::{FULL_WIDTH, GridLayout, LIMIT_WIDTH};
use super::requirement_limits::limit_editor_ui;
use super::requirement_selection::{
    column_order, requirement_names, select_commands, selected_requirement,
};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::requirements_display::{GridOrder, RequirementsDisplay};
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{named, named_switch};
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::painted_text::chevron;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, body, medium, small};

/// Distance between lines \[pt\].
const LINE_GAP: f32 = 2.0;
/// Additional distance between groups without headings \[pt\].
const GROUP_GAP: f32 = 4.0;
/// Indentation of group names and requirements if groups are folded \[pt\].
const INDENT: f32 = 13.0;

/// Draws the grid into the remaining space, with scroll bars where it does not fit.
pub(super) fn grid_ui(
    ui: &mut Ui,
    state: &State,
    grid: &RequirementGrid,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let is_folded = ui.ctx().content_rect().width() < FULL_WIDTH;
    let layout = GridLayout::new(ui.available_width(), grid.conditions.len(), is_folded);
    let Some(selected) = selected_requirement(state, grid) else {
        ui.label(palette.dim("No condition has a result"));
        return;
    };
    let painter = GridPainter {
        state,
        grid,
        columns: column_order(grid, &state.display.judging.requirements),
        selected,
        layout,
        palette,
    };
    ScrollArea::both()
        .id_salt("requirement grid")
        .auto_shrink(false)
        .show(ui, |ui| {
            let size = vec2(painter.layout.width(), painter.height());
            let (area, _) = ui.allocate_exact_size(size, Sense::hover());
            ui.scope_builder(UiBuilder::new().id_salt("cells").max_rect(area), |ui| {
                painter.ui(ui, area, commands);
            });
        });
}

/// Line of the grid on the screen.
#[derive(Clone, Copy)]
enum GridLine<'a> {
    /// Condition numbers.
    Conditions,
    Airspeeds,
    /// Group heading, with counts if the group is folded.
    Group(RequirementGroup),
    Requirement {
        row: &'a GridRow,
        is_first_of_group: bool,
    },
}

/// Grid as drawn in the current frame.
struct GridPainter<'a> {
    state: &'a State,
    grid: &'a RequirementGrid,
    /// Indices of the conditions' columns, in display order.
    columns: Vec<usize>,
    selected: Requirement,
    layout: GridLayout,
    palette: &'a Palette,
}

impl GridPainter<'_> {
    fn display(&self) -> RequirementsDisplay {
        self.state.display.judging.requirements
    }

    /// Returns the lines from top to bottom.
    fn lines(&self) -> Vec<GridLine<'_>> {
        let mut lines = vec![GridLine::Conditions, GridLine::Airspeeds];
        for group in RequirementGroup::ALL {
            if self.grid.group_rows(group).next().is_none() {
                continue;
            }
            if self.layout.is_folded {
                lines.push(GridLine::Group(group));
                if group != self.selected.group() {
                    continue;
                }
            }
            let mut is_first_of_group = true;
            for row in self.grid.group_rows(group) {
                lines.push(GridLine::Requirement {
                    row,
                    is_first_of_group,
                });
                is_first_of_group = false;
            }
        }
        lines
    }

    /// Returns the requirements that can be selected, in display order.
    fn visible_requirements(&self) -> Vec<Requirement> {
        let mut requirements = Vec::new();
        for line in self.lines() {
            if let GridLine::Requirement { row, .. } = line {
                requirements.push(row.requirement);
            }
        }
        requirements
    }

    /// Returns the distance above a line: groups are further apart if they have no headings.
    fn gap_above(&self, line: GridLine<'_>) -> f32 {
        match line {
            GridLine::Requirement {
                is_first_of_group: true,
                ..
            } if !self.layout.is_folded => LINE_GAP + GROUP_GAP,
            _ => LINE_GAP,
        }
    }

    fn height(&self) -> f32 {
        let lines = self.lines();
        let gaps: f32 = lines.iter().map(|line| self.gap_above(*line)).sum();
        gaps + self.layout.row_height * lines.len() as f32
    }

    /// Draws the visible lines from top to bottom.
    fn ui(&self, ui: &mut Ui, area: Rect, commands: &mut Vec<Command>) {
        let mut top = area.top();
        for grid_line in self.lines() {
            top += self.gap_above(grid_line);
            let line = Rect::from_min_size(
                pos2(area.left(), top),
                vec2(self.layout.width(), self.layout.row_height),
            );
            top = line.bottom();
            if !ui.is_rect_visible(line) {
                continue;
            }
            match grid_line {
                GridLine::Conditions => self.conditions_ui(ui, line, commands),
                GridLine::Airspeeds => self.airspeeds_ui(ui, line, commands),
                GridLine::Group(group) => self.group_ui(ui, line, group, commands),
                GridLine::Requirement {
                    row,
                    is_first_of_group,
                } => {
                    if is_first_of_group && !self.layout.is_folded {
                        self.paint_group_name(ui, line, row.requirement.group());
                    }
                    self.requirement_ui(ui, line, row, commands);
                }
            }
        }
    }

    /// Paints a group's name in its own column, in the line of the group's first requirement.
    fn paint_group_name(&self, ui: &Ui, line: Rect, group: RequirementGroup) {
        let at = pos2(line.left(), line.center().y);
        let font = medium(BODY_SIZE);
        let color = self.palette.text;
        ui.painter()
            .text(at, Align2::LEFT_CENTER, group_name(group), font, color);
    }

    /// Draws the condition numbers; a click on the line's name sorts the columns by number.
    fn conditions_ui(&self, ui: &mut Ui, line: Rect, commands: &mut Vec<Command>) {
        self.heading_ui(ui, line, "condition", GridOrder::Number, commands);
        let displayed = self.state.condition().id();
        for (position, column) in self.columns.iter().enumerate() {
            let id = self.grid.conditions[*column].id;
            let font = if id == displayed {
                medium(BODY_SIZE)
            } else {
                body()
            };
            let color = if id == displayed {
                self.palette.text
            } else {
                self.palette.dim_text
            };
            let cell = self.layout.cell(line, position);
            let at = pos2(cell.right() - NUMBER_MARGIN, cell.center().y);
            let painter = ui.painter();
            painter.text(at, Align2::RIGHT_CENTER, id.to_string(), font, color);
        }
        self.paint_limit_heading(ui, line, "limit");
    }

    /// Paints the heading of the limit column.
    fn paint_limit_heading(&self, ui: &Ui, line: Rect, text: &str) {
        let at = pos2(line.right(), line.center().y);
        let color = self.palette.dim_text;
        ui.painter()
            .text(at, Align2::RIGHT_CENTER, text, small(), color);
    }

    /// Draws the conditions' airspeeds; a click on the line's name sorts the columns by airspeed.
    fn airspeeds_ui(&self, ui: &mut Ui, line: Rect, commands: &mut Vec<Command>) {
        self.heading_ui(ui, line, "airspeed, kt", GridOrder::Airspeed, commands);
        for (position, column) in self.columns.iter().enumerate() {
            let cell = self.layout.cell(line, position);
            let at = pos2(cell.right() - NUMBER_MARGIN, cell.center().y);
            let text = telling(self.grid.conditions[*column].airspeed_kt, 0);
            let color = self.palette.dim_text;
            let painter = ui.painter();
            painter.text(at, Align2::RIGHT_CENTER, text, small(), color);
        }
    }

    /// Draws the name of a line with condition properties, a button that extends to the limit
    /// column and sorts the columns by `order`.
    fn heading_ui(
        &self,
        ui: &mut Ui,
        line: Rect,
        text: &str,
        order: GridOrder,
        commands: &mut Vec<Command>,
    ) {
        let display = self.display();
        let is_order = display.order == order;
        let area = Rect::from_min_max(
            pos2(line.left() + self.layout.name_left, line.top()),
            pos2(line.left() + self.layout.limit_left(), line.bottom()),
        );
        let response = ui.interact(area, ui.scope_id().with(text), Sense::click());
        let is_pointed = response.hovered() || response.has_focus();
        let mut words = text.to_owned();
        if is_order {
            words.push_str(if display.is_reversed {
                " \u{2193}"
            } else {
                " \u{2191}"
            });
        }
        let color = if is_pointed {
            self.palette.accent
        } else {
            self.palette.dim_text
        };
        let at = pos2(area.left(), line.center().y);
        ui.painter()
            .text(at, Align2::LEFT_CENTER, words, small(), color);
        let response = named(response, Role::Button, format!("Sort by {text}"));
        if response.clicked() {
            let command = DisplayCommand::ShowRequirements(display.ordered_by(order));
            commands.push(command.into());
        }
    }

    /// Draws a group's heading with a description of its values if it is open, or with each
    /// condition's count if it is folded. A click on a folded group selects its first requirement.
    fn group_ui(
        &self,
        ui: &mut Ui,
        line: Rect,
        group: RequirementGroup,
        commands: &mut Vec<Command>,
    ) {
        let palette = self.palette;
        let is_open = group == self.selected.group();
        let arrow = pos2(line.left() + 5.0, line.center().y);
        chevron(ui, arrow, is_open, palette);
        let at = pos2(line.left() + INDENT, line.center().y);
        let name = group_name(group);
        let font = medium(BODY_SIZE);
        let painter = ui.painter();
        let painted_name = painter.text(at, Align2::LEFT_CENTER, name, font, palette.text);
        // The counts in a folded group's line have clicks of their own.
        let width = if is_open {
            self.layout.limit_left()
        } else {
            self.layout.conditions_left
        };
        let area = line.with_max_x(line.left() + width);
        let response = ui.interact(area, ui.scope_id().with(("group", group)), Sense::click());
        let response = named_switch(response, Role::Button, is_open, format!("Group {name}"));
        if response.clicked() && !is_open {
            let first = self.grid.group_rows(group).next();
            if let Some(first) = first {
                let condition = self.state.condition().id();
                commands.extend(select_commands(self.state, first.requirement, condition));
            }
        }
        if is_open {
            let at = pos2(painted_name.right() + 14.0, line.center().y);
            let words = group_description(group);
            let color = palette.dim_text;
            ui.painter()
                .text(at, Align2::LEFT_CENTER, words, small(), color);
        } else {
            self.counts_ui(ui, line, group, commands);
        }
    }

    /// Draws a folded group's counts: for each condition, the requirements that are met and those
    /// that have a verdict. A click selects the condition's first requirement that is not met; if
    /// all are met, the group's first.
    fn counts_ui(
        &self,
        ui: &mut Ui,
        line: Rect,
        group: RequirementGroup,
        commands: &mut Vec<Command>,
    ) {
        let name = group_name(group);
        for (position, column) in self.columns.iter().enumerate() {
            let group_cell = self.grid.group_cell(group, *column);
            let area = self.layout.cell(line, position);
            let count = group_cell.count;
            let has_verdict = count.judged > 0;
            let text = if has_verdict {
                format!("{}/{}", count.met, count.judged)
            } else {
                NOT_DETERMINED_SIGN.to_owned()
            };
            let look = CellLook {
                text: &text,
                has_value: has_verdict,
                is_physics_outside: group_cell.is_physics_outside,
                is_outside: count.met < count.judged,
                is_dim: !has_verdict,
                is_selected: false,
            };
            look.paint(ui, area, self.palette);
            let condition = self.grid.conditions[*column].id;
            let id = ui.scope_id().with(("count", group, condition));
            let response = ui.interact(area, id, Sense::CLICK);
            let words = if has_verdict {
                format!("{name}, condition {condition}: {text} met")
            } else {
                format!("{name}, condition {condition}: no verdict")
            };
            let response = named(response, Role::Button, &words);
            if response.clicked()
                && let Some(first) = self.first_outside(group, *column)
            {
                commands.extend(select_commands(self.state, first, condition));
            }
            if response.hovered() {
                commands.push(SelectionCommand::ShowStatus(words).into());
            }
        }
        self.paint_limit_heading(ui, line, "met");
    }

    /// Returns the group's first requirement that a condition does not meet; the group's first if
    /// all are met.
    fn first_outside(&self, group: RequirementGroup, column: usize) -> Option<Requirement> {
        let is_outside = |row: &&GridRow| {
            let cell = row.cells.get(column);
            cell.is_some_and(|cell| cell.corrected.verdict == CellVerdict::Outside)
        };
        let row = self
            .grid
            .group_rows(group)
            .find(is_outside)
            .or_else(|| self.grid.group_rows(group).next())?;
        Some(row.requirement)
    }

    /// Draws a requirement: name, unit, cells, limit.
    fn requirement_ui(&self, ui: &mut Ui, line: Rect, row: &GridRow, commands: &mut Vec<Command>) {
        let palette = self.palette;
        let requirement = row.requirement;
        let font = if requirement == self.selected {
            medium(BODY_SIZE)
        } else {
            body()
        };
        let indent = if self.layout.is_folded { INDENT } else { 0.0 };
        let left = self.layout.name_left + indent;
        let at = pos2(line.left() + left, line.center().y);
        let name = requirement_names(self.state).name(requirement);
        let shown = elided(ui, &name, self.layout.unit_left - left - 4.0, BODY_SIZE);
        let painter = ui.painter();
        painter.text(at, Align2::LEFT_CENTER, shown, font, palette.text);
        let at = pos2(line.left() + self.layout.unit_left, line.center().y);
        let unit = unit_text(requirement.unit());
        painter.text(at, Align2::LEFT_CENTER, unit, small(), palette.dim_text);
        for (position, column) in self.columns.iter().enumerate() {
            if let Some(cell) = row.cells.get(*column) {
                let placed = PlacedCell {
                    area: self.layout.cell(line, position),
                    position,
                    column: *column,
                    cell,
                };
                self.cell_ui(ui, row, &placed, commands);
            }
        }
        self.limit_ui(ui, line, row, commands);
    }

    /// Draws a requirement's cell in a condition; a click or the arrow keys select a cell.
    fn cell_ui(
        &self,
        ui: &mut Ui,
        row: &GridRow,
        placed: &PlacedCell<'_>,
        commands: &mut Vec<Command>,
    ) {
        let requirement = row.requirement;
        let condition = self.grid.conditions[placed.column].id;
        let is_selected = requirement == self.selected && condition == self.state.condition().id();
        let corrected = &placed.cell.corrected;
        let text = value_text(requirement, corrected);
        let look = CellLook {
            text: &text,
            has_value: corrected.value.is_some(),
            is_physics_outside: placed.cell.physics.verdict == CellVerdict::Outside,
            is_outside: corrected.verdict == CellVerdict::Outside,
            is_dim: !matches!(corrected.verdict, CellVerdict::Met | CellVerdict::Outside),
            is_selected,
        };
        look.paint(ui, placed.area, self.palette);
        // Tab reaches only the selected cell (`Sense::click` is focusable, `Sense::CLICK` is not);
        // arrow keys reach the others. A cell that has just received the focus would lose it
        // without a focusable sense.
        let id = ui.scope_id().with((requirement, condition));
        let is_focused = ui.memory(|memory| memory.has_focus(id));
        let sense = if is_selected || is_focused {
            Sense::click()
        } else {
            Sense::CLICK
        };
        let response = ui.interact(placed.area, id, sense);
        let words = format!(
            "{}, condition {condition}: {}, {}; physics {}",
            requirement_names(self.state).name(requirement),
            value_with_unit_text(requirement, corrected),
            verdict_text(requirement, &row.limit, corrected),
            value_with_unit_text(requirement, &placed.cell.physics),
        );
        let response = named_switch(response, Role::Button, is_selected, &words);
        if response.clicked() {
            response.request_focus();
            commands.extend(select_commands(self.state, requirement, condition));
        }
        if response.hovered() {
            commands.push(SelectionCommand::ShowStatus(words).into());
        }
        if is_selected && response.has_focus() {
            self.move_selection(ui, &response, placed.position, commands);
        }
    }

    /// Moves selection and focus when arrow keys are pressed, among the requirements that are not
    /// folded and the columns in display order; `position` is the selected cell's column.
    fn move_selection(
        &self,
        ui: &Ui,
        response: &Response,
        position: usize,
        commands: &mut Vec<Command>,
    ) {
        let filter = EventFilter {
            horizontal_arrows: true,
            vertical_arrows: true,
            ..EventFilter::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let across = presses(ui, Key::ArrowRight) - presses(ui, Key::ArrowLeft);
        let down = presses(ui, Key::ArrowDown) - presses(ui, Key::ArrowUp);
        if across == 0 && down == 0 {
            return;
        }
        let requirements = self.visible_requirements();
        let selected = requirements
            .iter()
            .position(|requirement| *requirement == self.selected);
        let Some(requirement) = neighbour(&requirements, selected.unwrap_or(0), down) else {
            return;
        };
        let Some(column) = neighbour(&self.columns, position, across) else {
            return;
        };
        let condition = self.grid.conditions[column].id;
        let id = ui.scope_id().with((requirement, condition));
        ui.memory_mut(|memory| memory.request_focus(id));
        commands.extend(select_commands(self.state, requirement, condition));
    }

    /// Draws a requirement's limit; a double click or Enter opens its editor.
    fn limit_ui(&self, ui: &mut Ui, line: Rect, row: &GridRow, commands: &mut Vec<Command>) {
        let requirement = row.requirement;
        let area = line.with_min_x(line.left() + self.layout.limit_left());
        let id = ui.scope_id().with(("limit", requirement));
        let response = ui.interact(area, id, Sense::click());
        let color = if response.hovered() || response.has_focus() {
            self.palette.accent
        } else {
            self.palette.dim_text
        };
        let text = limit_text(requirement, &row.limit);
        let shown = elided(ui, &text, LIMIT_WIDTH - 6.0, SMALL_SIZE);
        let at = pos2(line.right(), line.center().y);
        ui.painter()
            .text(at, Align2::RIGHT_CENTER, shown, small(), color);
        let name = requirement_names(self.state).name(requirement);
        let words = format!(
            "Limit of {name}: {}",
            limit_description(requirement, &row.limit)
        );
        let response = named(response, Role::Button, format!("Limit of {name}"));
        if response.hovered() {
            let words = format!("{words}; double click: edit");
            commands.push(SelectionCommand::ShowStatus(words).into());
        }
        let is_entered = response.has_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if response.double_clicked() || is_entered {
            let display = RequirementsDisplay {
                edited_limit: Some(requirement),
                ..self.display()
            };
            commands.push(DisplayCommand::ShowRequirements(display).into());
        }
        if self.display().edited_limit == Some(requirement) {
            limit_editor_ui(&response, self.state, requirement, self.palette, commands);
        }
    }
}

/// Cell at its position on the screen.
struct PlacedCell<'a> {
    area: Rect,
    /// Position among the columns in display order.
    position: usize,
    /// Index of the condition's column in the grid.
    column: usize,
    cell: &'a GridCell,
}

fn presses(ui: &Ui, key: Key) -> isize {
    ui.input(|input| input.num_presses(key)) as isize
}

/// Returns the entry `by` places from `here`, clamped to the ends.
fn neighbour<T: Copy>(entries: &[T], here: usize, by: isize) -> Option<T> {
    let last = entries.len().checked_sub(1)?;
    let there = here.saturating_add_signed(by).min(last);
    entries.get(there).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrow_keys_stop_at_the_edges() {
        let entries = [10, 20, 30];
        assert_eq!(neighbour(&entries, 1, 1), Some(30));
        assert_eq!(neighbour(&entries, 2, 3), Some(30));
        assert_eq!(neighbour(&entries, 1, -5), Some(10));
        assert_eq!(neighbour::<usize>(&[], 0, 1), None);
    }
}
