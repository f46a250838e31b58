//! Requirement grid as a table for copying and saving.

use gdcm_words::Table;
use gdcm_words::requirement_grid::grid_table;

use super::requirement_selection::{requirement_names, shown_grid};
use crate::gui::state::window_state::State;

/// Returns the displayed grid as a table; `None` until it is available.
pub fn requirement_tables(state: &State) -> Option<Vec<Table>> {
    let grid = shown_grid(state)?;
    Some(vec![grid_table(&grid, requirement_names(state))])
}
