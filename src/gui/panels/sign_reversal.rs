//! Menu entry that reverses a channel's sign.

use gdcm_method::correction::Channel;
use gdcm_study::Edit;
use gdcm_study::decisions::signs::SignRole;

use crate::gui::commands::command::Command;
use crate::gui::state::window_state::State;

/// Returns the label and the command that reverse a channel's sign in the models with this role;
/// without a role, those that undo the reversal.
pub fn sign_reversal_entry(
    state: &State,
    channel: Channel,
    role: Option<SignRole>,
) -> (String, Command) {
    let (inputs, outputs) = state.dataset().input_and_output_names();
    let name = channel.name(&inputs, &outputs);
    let label = if role.is_some() {
        format!("Reverse sign of {name}")
    } else {
        format!("Undo sign reversal of {name}")
    };
    (label, Edit::SetSign { channel, role }.into())
}
