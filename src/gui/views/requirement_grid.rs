//! Requirement grid: a row for each requirement, a column for each condition. In windows narrower
//! than [`FULL_WIDTH`], each group except that of the selected cell folds to a row of counts.
//!
//! A cell has the corrected model's value, on a warning background if it is outside the limit, and
//! at its left a strip in the warning colour if the physics model's value is outside.
//! [`GridLayout`] has the columns, [`GridPainter::lines`] the rows, and each kind of row a method
//! that draws it.
//!
//! A requirement asks that a property of the corrected model agrees with the identified model, or
//! with a held-out record, within a limit (M17: docs/requirements.md). Its verdict is *met* or
//! *outside*; other cells are not determined, or have no limit.

use egui::{
    Align2, EventFilter, Key, Rect, Response, Role, ScrollArea, Sense, Stroke, StrokeKind, Ui,
    UiBuilder, Vec2, pos2, vec2,
};

use gdcm_model::units::telling;
use gdcm_study::results::grid_cell::{CellVerdict, GridCell};
use gdcm_study::results::grid_requirement::{Requirement, RequirementGroup};
use gdcm_study::results::requirement_grid::{GridRow, RequirementGrid};
use gdcm_words::requirement_grid::{
    NOT_DETERMINED_SIGN, group_description, group_name, limit_description, limit_text, unit_text,
    value_text, value_with_unit_text, verdict_text,
};

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

/// Window width from which the grid shows all groups and the drawer all details \[pt\].
pub(super) const FULL_WIDTH: f32 = 1400.0;
// Column widths [pt].
const GROUP: f32 = 94.0;
const NAME: f32 = 158.0;
const UNIT: f32 = 28.0;
const LIMIT: f32 = 58.0;
/// Minimum width of a condition's column \[pt\].
const LEAST_CONDITION: f32 = 40.0;
/// Maximum width of a condition's column \[pt\].
const MOST_CONDITION: f32 = 72.0;
/// Row height if all groups are open \[pt\].
const ROW: f32 = 19.0;
/// Row height if groups are folded \[pt\].
const FOLDED_ROW: f32 = 21.0;
/// Distance between rows \[pt\].
const ROW_GAP: f32 = 2.0;
/// Additional distance between groups \[pt\].
const GROUP_GAP: f32 = 4.0;
/// Width of a cell's strip for the physics model \[pt\].
const STRIP: f32 = 5.0;
/// Distance between cells \[pt\].
const CELL_GAP: f32 = 2.0;
/// Distance from a number to its cell's right edge \[pt\].
const NUMBER_MARGIN: f32 = 8.0;
/// Indentation of group names and requirements if groups are folded \[pt\].
const INDENT: f32 = 13.0;
/// Share of the warning colour in the background of a cell outside its limit.
const OUTSIDE_TINT: f32 = 0.32;

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

/// Columns and row height of the grid; positions are from the grid's left edge \[pt\].
#[derive(Clone, Copy)]
struct GridLayout {
    is_folded: bool,
    name: f32,
    /// Left edge of the unit column.
    unit: f32,
    /// Left edge of the first condition's column.
    conditions: f32,
    condition_width: f32,
    count: usize,
    row: f32,
}

impl GridLayout {
    fn new(available: f32, count: usize, is_folded: bool) -> Self {
        let name = if is_folded { 0.0 } else { GROUP };
        let unit = name + NAME;
        let conditions = unit + UNIT;
        let room = (available - conditions - LIMIT) / count.max(1) as f32;
        Self {
            is_folded,
            name,
            unit,
            conditions,
            condition_width: room.clamp(LEAST_CONDITION, MOST_CONDITION).floor(),
            count,
            row: if is_folded { FOLDED_ROW } else { ROW },
        }
    }

    /// Returns the left edge of the limit column.
    fn limit(&self) -> f32 {
        self.conditions + self.condition_width * self.count as f32
    }

    fn width(&self) -> f32 {
        self.limit() + LIMIT
    }

    /// Returns a cell's area; `place` counts the columns in display order.
    fn cell(&self, row: Rect, place: usize) -> Rect {
        let left = row.left() + self.conditions + self.condition_width * place as f32;
        Rect::from_min_max(
            pos2(left, row.top()),
            pos2(left + self.condition_width - CELL_GAP, row.bottom()),
        )
    }
}

#[derive(Clone, Copy)]
enum GridLine<'a> {
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
    /// Column indices in display order.
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

    /// Returns the rows that can be selected, in display order.
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
            } if !self.layout.is_folded => ROW_GAP + GROUP_GAP,
            _ => ROW_GAP,
        }
    }

    fn height(&self) -> f32 {
        let lines = self.lines();
        let gaps: f32 = lines.iter().map(|line| self.gap_above(*line)).sum();
        gaps + self.layout.row * lines.len() as f32
    }

    fn ui(&self, ui: &mut Ui, area: Rect, commands: &mut Vec<Command>) {
        let mut top = area.top();
        for line in self.lines() {
            top += self.gap_above(line);
            let row = Rect::from_min_size(
                pos2(area.left(), top),
                vec2(self.layout.width(), self.layout.row),
            );
            top = row.bottom();
            if !ui.is_rect_visible(row) {
                continue;
            }
            match line {
                GridLine::Conditions => self.conditions_ui(ui, row, commands),
                GridLine::Airspeeds => self.airspeeds_ui(ui, row, commands),
                GridLine::Group(group) => self.group_ui(ui, row, group, commands),
                GridLine::Requirement {
                    row: requirement,
                    is_first_of_group,
                } => {
                    if is_first_of_group && !self.layout.is_folded {
                        let group = requirement.requirement.group();
                        let font = medium(BODY_SIZE);
                        let at = pos2(row.left(), row.center().y);
                        let text = group_name(group);
                        let color = self.palette.text;
                        ui.painter()
                            .text(at, Align2::LEFT_CENTER, text, font, color);
                    }
                    self.requirement_ui(ui, row, requirement, commands);
                }
            }
        }
    }

    /// Draws the condition numbers; a click on the row's name sorts the columns by number.
    fn conditions_ui(&self, ui: &mut Ui, row: Rect, commands: &mut Vec<Command>) {
        self.heading_ui(ui, row, "condition", GridOrder::Number, commands);
        let shown = self.state.condition().id();
        for (place, column) in self.columns.iter().enumerate() {
            let id = self.grid.conditions[*column].id;
            let font = if id == shown {
                medium(BODY_SIZE)
            } else {
                body()
            };
            let color = if id == shown {
                self.palette.text
            } else {
                self.palette.dim_text
            };
            let cell = self.layout.cell(row, place);
            let at = pos2(cell.right() - NUMBER_MARGIN, cell.center().y);
            let painter = ui.painter();
            painter.text(at, Align2::RIGHT_CENTER, id.to_string(), font, color);
        }
        let at = pos2(row.right(), row.center().y);
        let color = self.palette.dim_text;
        ui.painter()
            .text(at, Align2::RIGHT_CENTER, "limit", small(), color);
    }

    /// Draws the conditions' airspeeds; a click on the row's name sorts the columns by airspeed.
    fn airspeeds_ui(&self, ui: &mut Ui, row: Rect, commands: &mut Vec<Command>) {
        self.heading_ui(ui, row, "airspeed, kt", GridOrder::Airspeed, commands);
        for (place, column) in self.columns.iter().enumerate() {
            let cell = self.layout.cell(row, place);
            let at = pos2(cell.right() - NUMBER_MARGIN, cell.center().y);
            let text = telling(self.grid.conditions[*column].airspeed_kt, 0);
            let color = self.palette.dim_text;
            let painter = ui.painter();
            painter.text(at, Align2::RIGHT_CENTER, text, small(), color);
        }
    }

    /// Draws a heading row's name, a button that extends to the limit column.
    fn heading_ui(
        &self,
        ui: &mut Ui,
        row: Rect,
        text: &str,
        order: GridOrder,
        commands: &mut Vec<Command>,
    ) {
        let display = self.display();
        let is_order = display.order == order;
        let place = Rect::from_min_max(
            pos2(row.left() + self.layout.name, row.top()),
            pos2(row.left() + self.layout.limit(), row.bottom()),
        );
        let response = ui.interact(place, ui.scope_id().with(text), Sense::click());
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
        let at = pos2(place.left(), row.center().y);
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
        row: Rect,
        group: RequirementGroup,
        commands: &mut Vec<Command>,
    ) {
        let palette = self.palette;
        let is_open = group == self.selected.group();
        chevron(ui, pos2(row.left() + 5.0, row.center().y), is_open, palette);
        let at = pos2(row.left() + INDENT, row.center().y);
        let name = group_name(group);
        let font = medium(BODY_SIZE);
        let painter = ui.painter();
        let drawn = painter.text(at, Align2::LEFT_CENTER, name, font, palette.text);
        let end = if is_open {
            self.layout.limit()
        } else {
            self.layout.conditions
        };
        let place = row.with_max_x(row.left() + end);
        let response = ui.interact(place, ui.scope_id().with(("group", group)), Sense::click());
        let response = named_switch(response, Role::Button, is_open, format!("Group {name}"));
        if response.clicked() && !is_open {
            let first = self.grid.group_rows(group).next();
            if let Some(first) = first {
                let condition = self.state.condition().id();
                commands.extend(select_commands(self.state, first.requirement, condition));
            }
        }
        if is_open {
            let at = pos2(drawn.right() + 14.0, row.center().y);
            let words = group_description(group);
            let color = palette.dim_text;
            ui.painter()
                .text(at, Align2::LEFT_CENTER, words, small(), color);
        } else {
            self.counts_ui(ui, row, group, commands);
        }
    }

    /// Draws a folded group's counts: for each condition, the requirements that are met and those
    /// that have a verdict. A click selects the condition's first requirement that is not met; if
    /// all are met, the group's first.
    fn counts_ui(
        &self,
        ui: &mut Ui,
        row: Rect,
        group: RequirementGroup,
        commands: &mut Vec<Command>,
    ) {
        let palette = self.palette;
        let name = group_name(group);
        for (place, column) in self.columns.iter().enumerate() {
            let found = self.grid.group_cell(group, *column);
            let cell = self.layout.cell(row, place);
            let count = found.count;
            let has_verdict = count.judged > 0;
            let text = if has_verdict {
                format!("{}/{}", count.met, count.judged)
            } else {
                NOT_DETERMINED_SIGN.to_owned()
            };
            let look = CellLook {
                text: &text,
                has_value: has_verdict,
                is_physics_outside: found.is_physics_outside,
                is_outside: count.met < count.judged,
                is_dim: !has_verdict,
                is_selected: false,
            };
            self.paint_cell(ui, cell, &look);
            let id = self.grid.conditions[*column].id;
            let sense = Sense::CLICK;
            let response = ui.interact(cell, ui.scope_id().with(("count", group, id)), sense);
            let words = if has_verdict {
                format!("{name}, condition {id}: {text} met")
            } else {
                format!("{name}, condition {id}: no verdict")
            };
            let response = named(response, Role::Button, &words);
            if response.clicked()
                && let Some(first) = self.first_outside(group, *column)
            {
                commands.extend(select_commands(self.state, first, id));
            }
            if response.hovered() {
                commands.push(SelectionCommand::Tell(words).into());
            }
        }
        let at = pos2(row.right(), row.center().y);
        let color = palette.dim_text;
        ui.painter()
            .text(at, Align2::RIGHT_CENTER, "met", small(), color);
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
    fn requirement_ui(
        &self,
        ui: &mut Ui,
        row: Rect,
        requirement: &GridRow,
        commands: &mut Vec<Command>,
    ) {
        let palette = self.palette;
        let key = requirement.requirement;
        let is_selected = key == self.selected;
        let names = requirement_names(self.state);
        let font = if is_selected {
            medium(BODY_SIZE)
        } else {
            body()
        };
        let indent = if self.layout.is_folded { INDENT } else { 0.0 };
        let left = self.layout.name + indent;
        let at = pos2(row.left() + left, row.center().y);
        let name = names.name(key);
        let shown = elided(ui, &name, self.layout.unit - left - 4.0, BODY_SIZE);
        let painter = ui.painter();
        painter.text(at, Align2::LEFT_CENTER, shown, font, palette.text);
        let at = pos2(row.left() + self.layout.unit, row.center().y);
        let unit = unit_text(key.unit());
        painter.text(at, Align2::LEFT_CENTER, unit, small(), palette.dim_text);
        for (place, column) in self.columns.iter().enumerate() {
            if let Some(cell) = requirement.cells.get(*column) {
                let shown = ShownCell {
                    rect: self.layout.cell(row, place),
                    place,
                    column: *column,
                    cell,
                };
                self.cell_ui(ui, requirement, &shown, commands);
            }
        }
        self.limit_ui(ui, row, requirement, commands);
    }

    fn cell_ui(
        &self,
        ui: &mut Ui,
        row: &GridRow,
        shown: &ShownCell<'_>,
        commands: &mut Vec<Command>,
    ) {
        let key = row.requirement;
        let condition = self.grid.conditions[shown.column].id;
        let is_selected = key == self.selected && condition == self.state.condition().id();
        let corrected = &shown.cell.corrected;
        let text = value_text(key, corrected);
        self.paint_cell(
            ui,
            shown.rect,
            &CellLook {
                text: &text,
                has_value: corrected.value.is_some(),
                is_physics_outside: shown.cell.physics.verdict == CellVerdict::Outside,
                is_outside: corrected.verdict == CellVerdict::Outside,
                is_dim: !matches!(corrected.verdict, CellVerdict::Met | CellVerdict::Outside),
                is_selected,
            },
        );
        // Tab reaches only the selected cell (`Sense::click` is focusable, `Sense::CLICK` is not);
        // arrow keys reach the others. A cell that has just received the focus would lose it
        // without a focusable sense.
        let id = ui.scope_id().with((key, condition));
        let is_focused = ui.memory(|memory| memory.has_focus(id));
        let sense = if is_selected || is_focused {
            Sense::click()
        } else {
            Sense::CLICK
        };
        let response = ui.interact(shown.rect, id, sense);
        let words = format!(
            "{}, condition {condition}: {}, {}; physics {}",
            requirement_names(self.state).name(key),
            value_with_unit_text(key, corrected),
            verdict_text(key, &row.limit, corrected),
            value_with_unit_text(key, &shown.cell.physics),
        );
        let response = named_switch(response, Role::Button, is_selected, &words);
        if response.clicked() {
            response.request_focus();
            commands.extend(select_commands(self.state, key, condition));
        }
        if response.hovered() {
            commands.push(SelectionCommand::Tell(words).into());
        }
        if is_selected && response.has_focus() {
            self.move_selection(ui, &response, shown.place, commands);
        }
    }

    /// Moves selection and focus when arrow keys are pressed, among the rows that are not folded
    /// and the columns in display order.
    fn move_selection(
        &self,
        ui: &Ui,
        response: &Response,
        place: usize,
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
        let rows = self.visible_requirements();
        let row = rows.iter().position(|row| *row == self.selected);
        let Some(key) = neighbour(&rows, row.unwrap_or(0), down) else {
            return;
        };
        let Some(column) = neighbour(&self.columns, place, across) else {
            return;
        };
        let condition = self.grid.conditions[column].id;
        let id = ui.scope_id().with((key, condition));
        ui.memory_mut(|memory| memory.request_focus(id));
        commands.extend(select_commands(self.state, key, condition));
    }

    fn paint_cell(&self, ui: &Ui, rect: Rect, look: &CellLook<'_>) {
        let palette = self.palette;
        let painter = ui.painter();
        if look.has_value {
            let strip = rect.with_max_x(rect.left() + STRIP);
            let body = rect.with_min_x(rect.left() + STRIP + 1.0);
            let strip_color = if look.is_physics_outside {
                palette.warning
            } else {
                palette.line
            };
            let ground = if look.is_outside {
                palette.panel.lerp_to_gamma(palette.warning, OUTSIDE_TINT)
            } else {
                palette.panel
            };
            painter.rect_filled(strip, 1.5, strip_color);
            painter.rect_filled(body, 2.0, ground);
        }
        let color = if look.is_dim {
            palette.dim_text
        } else {
            palette.text
        };
        let font = if look.is_selected {
            medium(BODY_SIZE)
        } else {
            body()
        };
        let at = pos2(rect.right() - NUMBER_MARGIN, rect.center().y);
        painter.text(at, Align2::RIGHT_CENTER, look.text, font, color);
        if look.is_selected {
            let stroke = Stroke::new(1.5, palette.accent);
            painter.rect_stroke(rect.expand(0.5), 3.0, stroke, StrokeKind::Outside);
        }
    }

    /// Draws a row's limit; a double click or Enter opens its editor.
    fn limit_ui(&self, ui: &mut Ui, row: Rect, requirement: &GridRow, commands: &mut Vec<Command>) {
        let key = requirement.requirement;
        let left = row.left() + self.layout.limit();
        let place = row.with_min_x(left);
        let id = ui.scope_id().with(("limit", key));
        let response = ui.interact(place, id, Sense::click());
        let color = if response.hovered() || response.has_focus() {
            self.palette.accent
        } else {
            self.palette.dim_text
        };
        let text = limit_text(key, &requirement.limit);
        let shown = elided(ui, &text, LIMIT - 6.0, SMALL_SIZE);
        let at = pos2(row.right(), row.center().y);
        ui.painter()
            .text(at, Align2::RIGHT_CENTER, shown, small(), color);
        let name = requirement_names(self.state).name(key);
        let words = format!(
            "Limit of {name}: {}",
            limit_description(key, &requirement.limit)
        );
        let response = named(response, Role::Button, format!("Limit of {name}"));
        if response.hovered() {
            let words = format!("{words}; double click: edit");
            commands.push(SelectionCommand::Tell(words).into());
        }
        let is_entered = response.has_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if response.double_clicked() || is_entered {
            let display = RequirementsDisplay {
                edited_limit: Some(key),
                ..self.display()
            };
            commands.push(DisplayCommand::ShowRequirements(display).into());
        }
        if self.display().edited_limit == Some(key) {
            limit_editor_ui(&response, self.state, key, self.palette, commands);
        }
    }
}

/// Cell at its position on the screen.
struct ShownCell<'a> {
    rect: Rect,
    /// Position among the columns in display order.
    place: usize,
    /// Index of the condition's column in the grid.
    column: usize,
    cell: &'a GridCell,
}

/// Text in a cell, and the facts that determine its colours.
struct CellLook<'a> {
    text: &'a str,
    has_value: bool,
    is_physics_outside: bool,
    is_outside: bool,
    is_dim: bool,
    is_selected: bool,
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

/// Draws the legend for strip and background colours above the grid, from right to left; if there
/// is room, also for undetermined values.
pub(super) fn grid_legend_ui(ui: &mut Ui, palette: &Palette) {
    ui.spacing_mut().item_spacing.x = 6.0;
    if ui.available_width() > 560.0 {
        ui.label(palette.small(format!("{NOT_DETERMINED_SIGN} not determined")));
        ui.add_space(6.0);
    }
    ui.label(palette.small("background: corrected outside"));
    sample_ui(ui, palette, CellPart::Background);
    ui.add_space(6.0);
    ui.label(palette.small("strip: physics outside"));
    sample_ui(ui, palette, CellPart::Strip);
}

/// Part of a cell that the legend explains.
#[derive(Clone, Copy)]
enum CellPart {
    Strip,
    Background,
}

/// Draws a small cell with one part in the warning colour.
fn sample_ui(ui: &mut Ui, palette: &Palette, warned: CellPart) {
    const SIZE: Vec2 = vec2(22.0, 12.0);
    let (rect, _) = ui.allocate_exact_size(SIZE, Sense::hover());
    let strip = rect.with_max_x(rect.left() + 4.0);
    let body = rect.with_min_x(rect.left() + 5.0);
    let (strip_color, ground) = match warned {
        CellPart::Strip => (palette.warning, palette.panel),
        CellPart::Background => (
            palette.line,
            palette.panel.lerp_to_gamma(palette.warning, OUTSIDE_TINT),
        ),
    };
    ui.painter().rect_filled(strip, 1.5, strip_color);
    ui.painter().rect_filled(body, 2.0, ground);
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

    #[test]
    fn many_conditions_keep_readable_columns_and_few_do_not_drift_apart() {
        let many = GridLayout::new(900.0, 60, false);
        assert!(many.condition_width >= LEAST_CONDITION && many.width() > 900.0);
        let usual = GridLayout::new(945.0, 11, false);
        assert!(usual.width() <= 945.0 && usual.condition_width > 50.0);
        assert!(GridLayout::new(900.0, 1, true).condition_width <= MOST_CONDITION);
    }
}
