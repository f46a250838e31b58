//! What the window says of a condition besides the remarks on its result.

use std::collections::BTreeSet;

use gdcm_core::correction::Channel;
use gdcm_core::dataset::Pair;
use gdcm_core::study::{ConditionAnalysis, Remark, details, remarks};

use super::state::State;

/// The remarks on the result shown, and on the schedule.
pub fn remarks_shown(state: &State, shown: &ConditionAnalysis) -> Vec<Remark> {
    let schedule = state.analysis().and_then(|analysis| analysis.schedule.as_ref().ok());
    remarks(&state.study, shown, schedule)
}

/// What the remarks leave to say of the result shown.
pub fn details_shown(state: &State, shown: &ConditionAnalysis) -> Vec<String> {
    details(&state.study, shown)
}

/// The responses and the channels that are in each other's way, of the gains.
pub fn gain_conflict_marks(shown: &ConditionAnalysis) -> (BTreeSet<Pair>, BTreeSet<Channel>) {
    let conflicts = &shown.gains.conflicts;
    let pairs = conflicts.iter().flat_map(|conflict| conflict.entries.iter().copied()).collect();
    (pairs, conflicts.iter().flat_map(|conflict| conflict.channels()).collect())
}

/// What holding or freeing a response would cost, in words; nothing until the table of all toggles of this very result is computed.
pub fn toggle_costs(state: &State, pair: Pair) -> Vec<String> {
    let Some(toggles) = state.toggles() else {
        return Vec::new();
    };
    let (inputs, outputs) = channel_names(state);
    let (gain, delay) = toggles.of_pair(pair);
    let gain = gain.map(|toggle| format!("Gains: {}", toggle.words(&inputs, &outputs)));
    let delay = delay.map(|toggle| format!("Delays: {}", toggle.words(&inputs, &outputs)));
    gain.into_iter().chain(delay).collect()
}

/// Names of the inputs and of the outputs.
pub fn channel_names(state: &State) -> (Vec<String>, Vec<String>) {
    state.dataset().names_of_channels()
}
