//! Command that changes requirement settings.

use std::sync::Arc;

use gdcm_study::Edit;
use gdcm_study::decisions::requirement_settings::{RequirementPart, RequirementSettings};

use crate::gui::commands::command::Command;
use crate::gui::state::window_state::State;

/// Returns the command that applies `change` to the requirement settings. Consecutive changes of
/// the same `part` form one undo step.
pub(super) fn requirement_edit(
    state: &State,
    part: RequirementPart,
    change: impl FnOnce(&mut RequirementSettings),
) -> Command {
    let mut settings = RequirementSettings::clone(&state.study.requirements);
    change(&mut settings);
    Edit::SetRequirements(part, Arc::new(settings)).into()
}
