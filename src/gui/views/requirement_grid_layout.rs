//! Columns and row height of the requirement grid, and the areas of its cells.
//!
//! From left to right: group name (unless groups are folded), requirement, unit, a column for each
//! condition, limit. In a window narrower than [`FULL_WIDTH`], groups are folded.

use egui::{Rect, pos2};

/// Window width from which the grid shows all groups and the drawer all details \[pt\].
pub(super) const FULL_WIDTH: f32 = 1400.0;
/// Width of the group names, which are in a column of their own unless groups are folded \[pt\].
const GROUP_WIDTH: f32 = 94.0;
/// Width of the requirements' names \[pt\].
const NAME_WIDTH: f32 = 158.0;
/// Width of the units \[pt\].
const UNIT_WIDTH: f32 = 28.0;
/// Width of the limits \[pt\].
pub(super) const LIMIT_WIDTH: f32 = 58.0;
/// Minimum width of a condition's column \[pt\].
const LEAST_CONDITION: f32 = 40.0;
/// Maximum width of a condition's column \[pt\].
const MOST_CONDITION: f32 = 72.0;
/// Row height if all groups are open \[pt\].
const ROW: f32 = 19.0;
/// Row height if groups are folded \[pt\].
const FOLDED_ROW: f32 = 21.0;
/// Distance between cells \[pt\].
const CELL_GAP: f32 = 2.0;

/// Columns and row height of the grid; positions are from the grid's left edge \[pt\].
#[derive(Clone, Copy)]
pub(super) struct GridLayout {
    /// Whether each group except that of the selected cell is a single row of counts.
    pub(super) is_folded: bool,
    /// Left edge of the requirements' names.
    pub(super) name_left: f32,
    /// Left edge of the unit column.
    pub(super) unit_left: f32,
    /// Left edge of the first condition's column.
    pub(super) conditions_left: f32,
    condition_width: f32,
    condition_count: usize,
    pub(super) row_height: f32,
}

impl GridLayout {
    /// Divides the available width among the conditions' columns, within their limits.
    pub(super) fn new(available: f32, condition_count: usize, is_folded: bool) -> Self {
        let name_left = if is_folded { 0.0 } else { GROUP_WIDTH };
        let unit_left = name_left + NAME_WIDTH;
        let conditions_left = unit_left + UNIT_WIDTH;
        let room = (available - conditions_left - LIMIT_WIDTH) / condition_count.max(1) as f32;
        Self {
            is_folded,
            name_left,
            unit_left,
            conditions_left,
            condition_width: room.clamp(LEAST_CONDITION, MOST_CONDITION).floor(),
            condition_count,
            row_height: if is_folded { FOLDED_ROW } else { ROW },
        }
    }

    /// Returns the left edge of the limit column.
    pub(super) fn limit_left(&self) -> f32 {
        self.conditions_left + self.condition_width * self.condition_count as f32
    }

    pub(super) fn width(&self) -> f32 {
        self.limit_left() + LIMIT_WIDTH
    }

    /// Returns the area of a cell in the line `line`; `position` counts the conditions' columns in
    /// display order.
    pub(super) fn cell(&self, line: Rect, position: usize) -> Rect {
        let left = line.left() + self.conditions_left + self.condition_width * position as f32;
        Rect::from_min_max(
            pos2(left, line.top()),
            pos2(left + self.condition_width - CELL_GAP, line.bottom()),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_conditions_keep_readable_columns_and_few_do_not_drift_apart() {
        let many = GridLayout::new(900.0, 60, false);
        assert!(many.condition_width >= LEAST_CONDITION && many.width() > 900.0);
        let usual = GridLayout::new(945.0, 11, false);
        assert!(usual.width() <= 945.0 && usual.condition_width > 50.0);
        assert!(GridLayout::new(900.0, 1, true).condition_width <= MOST_CONDITION);
    }
}
