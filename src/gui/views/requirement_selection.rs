//! Displayed requirement grid, its selected cell, and the commands that select another cell.
//!
//! A requirement is a row of the grid, a condition a column; the selected cell is that of the
//! selected requirement in the displayed condition.

use gdcm_method::requirements::ToleranceTable;
use gdcm_model::dataset::ConditionId;
use gdcm_study::results::grid_cell::GridCell;
use gdcm_study::results::grid_requirement::Requirement;
use gdcm_study::results::grid_source::GridSource;
use gdcm_study::results::requirement_grid::{GridRow, RequirementGrid};
use gdcm_words::requirement_grid::RequirementNames;

use super::requirement_history_jobs::time_histories_job;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::requirements_display::{GridOrder, RequirementsDisplay};
use crate::gui::state::window_state::State;

/// Returns the grid for the displayed results; `None` until the requirements are available.
pub fn shown_grid(state: &State) -> Option<RequirementGrid> {
    let requirements = state.requirements()?;
    // Histories count only while records are held out; otherwise there is no such job.
    let mut histories = None;
    if time_histories_job(state).is_some() {
        histories = state.time_histories().map(AsRef::as_ref);
    }
    Some(RequirementGrid::new(&GridSource {
        requirements,
        histories,
        dataset: state.dataset(),
        settings: &state.study.requirements,
        role: state.display.judging.requirements.role(),
    }))
}

pub(super) fn requirement_names(state: &State) -> RequirementNames<'_> {
    RequirementNames {
        dataset: state.dataset(),
        tolerances: tolerances(state),
    }
}

fn tolerances(state: &State) -> &ToleranceTable {
    &state.study.requirements.tolerances
}

/// Returns the selected requirement: the chosen one, else the first for the response in focus, else
/// the grid's first.
pub(super) fn selected_requirement(state: &State, grid: &RequirementGrid) -> Option<Requirement> {
    if let Some(selected) = state.display.judging.requirements.selected
        && grid.row(selected).is_some()
    {
        return Some(selected);
    }
    let focused = Some(state.display.selection.pair);
    let of_response = grid
        .rows
        .iter()
        .find(|row| row.requirement.pair(state.dataset(), tolerances(state)) == focused);
    of_response.or(grid.rows.first()).map(|row| row.requirement)
}

#[derive(Clone, Copy)]
pub(super) struct SelectedCell<'a> {
    pub(super) row: &'a GridRow,
    /// `None` if the displayed condition has no result.
    pub(super) cell: Option<&'a GridCell>,
    pub(super) condition: ConditionId,
}

/// Returns the selected cell; `None` for an empty grid.
pub(super) fn selected_cell<'a>(
    state: &State,
    grid: &'a RequirementGrid,
) -> Option<SelectedCell<'a>> {
    let requirement = selected_requirement(state, grid)?;
    let condition = state.condition().id();
    Some(SelectedCell {
        row: grid.row(requirement)?,
        cell: grid.cell(requirement, condition),
        condition,
    })
}

/// Returns the commands that select a cell's requirement, condition and response.
pub(super) fn select_commands(
    state: &State,
    requirement: Requirement,
    condition: ConditionId,
) -> Vec<Command> {
    let display = state
        .display
        .judging
        .requirements
        .with_selected(requirement);
    let mut commands: Vec<Command> = vec![
        DisplayCommand::ShowRequirements(display).into(),
        SelectionCommand::SelectCondition(condition).into(),
    ];
    if let Some(pair) = requirement.pair(state.dataset(), tolerances(state)) {
        commands.push(SelectionCommand::FocusPair(pair).into());
    }
    commands
}

/// Returns the column indices in display order: by number or by airspeed, reversed if so chosen.
pub(super) fn column_order(grid: &RequirementGrid, display: &RequirementsDisplay) -> Vec<usize> {
    let mut columns: Vec<usize> = (0..grid.conditions.len()).collect();
    match display.order {
        GridOrder::Number => columns.sort_by_key(|column| grid.conditions[*column].id),
        GridOrder::Airspeed => columns.sort_by(|a, b| {
            let airspeed_a = grid.conditions[*a].airspeed_kt;
            let airspeed_b = grid.conditions[*b].airspeed_kt;
            airspeed_a.total_cmp(&airspeed_b)
        }),
    }
    if display.is_reversed {
        columns.reverse();
    }
    columns
}
