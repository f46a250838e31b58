//! Options for displaying the requirements: selected cell, details, column order.
//!
//! The requirements (M17: docs/requirements.md) are shown as a grid with a row for each requirement
//! and a column for each condition.

use gdcm_model::dataset::ConditionId;
use gdcm_study::results::grid_requirement::{Requirement, RequirementGroup};
use gdcm_study::results::requirement_role::RequirementRole;

/// Details shown about the selected requirement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RequirementDetail {
    /// Phase delay over bandwidth in all conditions.
    #[default]
    Frequency,
    /// A flight record with its tolerances, or the responses to a test input.
    Time,
    Modes,
}

impl RequirementDetail {
    pub const ALL: [Self; 3] = [Self::Frequency, Self::Time, Self::Modes];

    /// Returns the details for a requirement group; `None` for summary costs, which have none.
    pub fn of_group(group: RequirementGroup) -> Option<Self> {
        match group {
            RequirementGroup::Bandwidth => Some(Self::Frequency),
            RequirementGroup::InTime => Some(Self::Time),
            RequirementGroup::Modes => Some(Self::Modes),
            RequirementGroup::Summary => None,
        }
    }
}

/// Order in which the grid lists the conditions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GridOrder {
    #[default]
    Number,
    Airspeed,
}

/// A flight record, by its index among its condition's records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordChoice {
    pub condition: ConditionId,
    pub index: usize,
}

/// Options for displaying the requirements. The selected cell's column is the displayed condition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RequirementsDisplay {
    /// The selected cell's row; `None` before the first selection.
    pub selected: Option<Requirement>,
    /// Details in front where only some fit.
    pub detail: RequirementDetail,
    pub are_details_hidden: bool,
    /// Whether the models corrected by the schedule are judged; otherwise those with their own
    /// corrections.
    pub judges_schedule: bool,
    pub order: GridOrder,
    pub is_reversed: bool,
    /// Record chosen for the details; `None`, or a record in another condition, selects the first
    /// held-out record.
    pub record: Option<RecordChoice>,
    /// Row whose limit is being edited.
    pub edited_limit: Option<Requirement>,
}

impl RequirementsDisplay {
    /// Returns the role that the judged models have.
    pub fn role(&self) -> RequirementRole {
        if self.judges_schedule {
            RequirementRole::Scheduled
        } else {
            RequirementRole::Corrected
        }
    }

    /// Returns the display after a click on the heading that sorts by `order`; a second click
    /// reverses it.
    pub fn ordered_by(self, order: GridOrder) -> Self {
        Self {
            order,
            is_reversed: self.order == order && !self.is_reversed,
            ..self
        }
    }

    /// Returns the display with a selected requirement, and its details in front.
    pub fn with_selected(self, requirement: Requirement) -> Self {
        Self {
            selected: Some(requirement),
            detail: RequirementDetail::of_group(requirement.group()).unwrap_or(self.detail),
            are_details_hidden: false,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use gdcm_method::requirements::ModeName;

    use super::*;

    #[test]
    fn a_second_click_on_a_heading_reverses_the_order() {
        let display = RequirementsDisplay::default().ordered_by(GridOrder::Airspeed);
        assert!(!display.is_reversed);
        assert!(display.ordered_by(GridOrder::Airspeed).is_reversed);
        assert!(!display.ordered_by(GridOrder::Number).is_reversed);
    }

    #[test]
    fn a_selection_brings_its_details_to_the_front_and_summary_costs_change_nothing() {
        let mode = Requirement::ModeFrequency(ModeName::DutchRoll);
        let display = RequirementsDisplay::default().with_selected(mode);
        assert_eq!(display.detail, RequirementDetail::Modes);
        let display = display.with_selected(Requirement::MeanJAll);
        assert_eq!(display.detail, RequirementDetail::Modes);
    }
}
