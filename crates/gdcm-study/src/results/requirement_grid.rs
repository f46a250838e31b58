//! Every requirement in every condition, as a grid (M17.5): a corrected model, and the physics
//! model beside it, against the identified model or the held-out flight records.
//!
//! ```text
//! bandwidth     omega_BW / omega_BW of the identified model - 1
//! phase delay   tau_p - tau_p of the identified model [s]
//! level         number of the level of bandwidth and phase delay, against that of the identified model
//! peak error    max |simulated - flown| / tolerance, over the held-out records of the condition
//! mode          |lambda| / |lambda| of the identified model - 1, judged by the tolerances of modes
//! summary       mean J; share of the band inside the MUAD envelopes
//! ```
//!
//! `omega_BW` is the bandwidth and `tau_p` the phase delay (M17.1), `lambda` a mode's pole (M17.3),
//! J the mismatch cost (M4), MUAD maximum unnoticeable added dynamics (M17.4). `grid_source` builds
//! the grid.
//!
//! A cell counts as met or outside only where its requirement has a limit and both models, or the
//! record, determine its value.
use serde::Serialize;

use gdcm_model::dataset::ConditionId;

use super::grid_cell::{CellVerdict, GridCell};
use super::grid_requirement::{Requirement, RequirementGroup, RequirementLimit};
use super::requirement_role::RequirementRole;

/// A requirement in all conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct GridRow {
    pub requirement: Requirement,
    pub limit: RequirementLimit,
    /// Cells in the order of [`RequirementGrid::conditions`].
    pub cells: Vec<GridCell>,
}

/// A condition: a grid column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridCondition {
    pub id: ConditionId,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
}

/// Cell counts by verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct GridCount {
    /// Cells that the corrected model meets.
    pub met: usize,
    /// Cells in which the corrected model meets or misses a limit.
    pub judged: usize,
    /// Cells that the physics model meets.
    pub physics_met: usize,
    /// Cells whose value or verdict is not determined for the corrected model.
    pub not_determined: usize,
}

impl GridCount {
    fn add(&mut self, cell: &GridCell) {
        match cell.corrected.verdict {
            CellVerdict::Met => {
                self.met += 1;
                self.judged += 1;
            }
            CellVerdict::Outside => self.judged += 1,
            CellVerdict::NotDetermined(_) => self.not_determined += 1,
            CellVerdict::NoTolerance => {}
        }
        if cell.physics.verdict == CellVerdict::Met {
            self.physics_met += 1;
        }
    }
}

/// A requirement group's result in a condition, shown when the group is folded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GroupCell {
    pub count: GridCount,
    /// Whether the physics model is outside any limit.
    pub is_physics_outside: bool,
}

/// Requirements by condition.
#[derive(Clone, Debug, PartialEq)]
pub struct RequirementGrid {
    /// The corrected model's role: with the condition's own correction or with the schedule.
    pub role: RequirementRole,
    pub conditions: Vec<GridCondition>,
    pub rows: Vec<GridRow>,
}

impl RequirementGrid {
    /// Counts the cells in all rows.
    pub fn count(&self) -> GridCount {
        let mut count = GridCount::default();
        for cell in self.rows.iter().flat_map(|row| &row.cells) {
            count.add(cell);
        }
        count
    }

    /// Counts a group's cells in a column.
    pub fn group_cell(&self, group: RequirementGroup, column: usize) -> GroupCell {
        let mut found = GroupCell::default();
        for row in self.group_rows(group) {
            if let Some(cell) = row.cells.get(column) {
                found.count.add(cell);
                if cell.physics.verdict == CellVerdict::Outside {
                    found.is_physics_outside = true;
                }
            }
        }
        found
    }

    /// Returns a group's rows, in the order of the grid.
    pub fn group_rows(&self, group: RequirementGroup) -> impl Iterator<Item = &GridRow> {
        self.rows
            .iter()
            .filter(move |row| row.requirement.group() == group)
    }

    /// Returns a requirement's row; `None` if the grid has none.
    pub fn row(&self, requirement: Requirement) -> Option<&GridRow> {
        self.rows.iter().find(|row| row.requirement == requirement)
    }

    /// Returns a requirement's cell in a condition; `None` if the grid has no such row or column.
    pub fn cell(&self, requirement: Requirement, condition: ConditionId) -> Option<&GridCell> {
        let column = self.column(condition)?;
        self.row(requirement)?.cells.get(column)
    }

    /// Returns a condition's column index.
    pub fn column(&self, condition: ConditionId) -> Option<usize> {
        self.conditions
            .iter()
            .position(|known| known.id == condition)
    }
}
