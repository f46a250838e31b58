//! Command-table entries for decisions: history, rejections, held responses, models.
//!
//! A held (constrained) response has its net gain matched exactly, its delay as far as possible. A
//! bundle is all physics models, or all identified models, in a condition; its representative is
//! the medoid, unless the engineer has chosen another model (M5: docs/method.md).

use egui::Key;

use gdcm_model::dataset::{BundleKind, ModelId, Pair};
use gdcm_study::Edit;

use super::command::Command;
use super::entry::{CTRL, CTRL_SHIFT, Entry, Menu, group};
use super::form::FormCommand;
use super::step_name::step_name;
use super::study::StudyCommand;
use crate::gui::state::window_state::{State, UndoStep};

/// Returns the entries in the Edit menu.
pub(super) fn edit_entries(state: &State) -> Vec<Entry> {
    let condition = state.condition().id();
    let scheduled = state.study.choice(condition).scheduled;
    let schedule = if scheduled {
        "Leave this condition out of the schedule"
    } else {
        "Include this condition in the schedule"
    };
    let schedule = Entry::new(
        schedule,
        "Whether the correction of the condition enters the schedule",
        Edit::SetScheduled {
            condition,
            scheduled: !scheduled,
        },
    );
    let held = [
        hold_entry(state, state.display.selection.pair).free_key(Key::Space),
        Entry::new(
            "Hold only the on-axis responses",
            "The on-axis responses of the dataset, and no others",
            Edit::ConstrainOnAxis,
        ),
    ];
    group(Menu::Edit, 0, history_entries(state))
        .chain(group(Menu::Edit, 1, rejection_entries(state)))
        .chain(group(Menu::Edit, 2, held))
        .chain(group(Menu::Edit, 3, [schedule]))
        .collect()
}

fn history_entries(state: &State) -> [Entry; 2] {
    let undo = state.history.undo_step();
    let redo = state.history.redo_step();
    [
        Entry::new(
            step_command("Undo", undo),
            "Undo the last decision",
            StudyCommand::Undo,
        )
        .keys(CTRL, Key::Z)
        .enabled(undo.is_some()),
        Entry::new(
            step_command("Redo", redo),
            "Redo the last undone decision",
            StudyCommand::Redo,
        )
        .keys(CTRL_SHIFT, Key::Z)
        .keys(CTRL, Key::Y)
        .enabled(redo.is_some()),
    ]
}

/// Names an entry of the history: "Undo reject physics model 7"; the verb alone without a step.
fn step_command(verb: &str, step: Option<&UndoStep>) -> String {
    match step {
        Some(step) => format!("{verb} {}", step_name(step)),
        None => verb.to_owned(),
    }
}

/// Returns the entries that reject the displayed condition's suggested models, and restore all its
/// rejected models.
fn rejection_entries(state: &State) -> [Entry; 2] {
    let condition = state.condition().id();
    let choice = state.study.choice(condition);
    let suggested = match state.shown() {
        Some(shown) => state.open_suggestions(shown),
        None => Vec::new(),
    };
    let reject = match suggested.len() {
        0 => "Reject suggested".to_owned(),
        count => format!("Reject {count} suggested"),
    };
    let is_any_rejected =
        !choice.physics.rejected.is_empty() || !choice.identified.rejected.is_empty();
    [
        Entry::new(
            reject,
            "Reject the suggested outliers of this condition",
            Edit::reject_physics(condition, &suggested),
        )
        .keys(CTRL, Key::R)
        .enabled(!suggested.is_empty()),
        Entry::new(
            "Restore all models of this condition",
            "Return every rejected model of this condition to its bundle",
            Edit::RestoreAll { condition },
        )
        .enabled(is_any_rejected),
    ]
}

/// Returns the entry "Hold LON → Q exactly" or "Release LON → Q"; the first is disabled for a
/// response without G, which cannot be constrained.
pub(super) fn hold_entry(state: &State, pair: Pair) -> Entry {
    let held = state.study.settings.constrained[pair];
    let name = state.dataset().pair_name(pair);
    let is_undefined = match state.shown() {
        Some(shown) => shown.comparison.undefined[pair].is_some(),
        None => false,
    };
    let text = if held {
        format!("Release {name}")
    } else {
        format!("Hold {name} exactly")
    };
    Entry::new(
        text,
        "Held: net gain exact, delay as far as possible; released: both fitted",
        Edit::Hold(pair, !held),
    )
    .enabled(held || !is_undefined)
}

/// Returns the entries for each model in the displayed condition.
pub(super) fn model_entries(state: &State) -> Vec<Entry> {
    let condition = state.condition();
    let mut entries = Vec::new();
    for bundle in [BundleKind::Physics, BundleKind::Identified] {
        let choice = state.study.choice(condition.id()).bundle(bundle);
        for model in condition.bundle(bundle) {
            let id = ModelId::new(condition.id(), bundle, &model.name);
            if choice.rejected.contains(&model.name) {
                entries.extend(rejected_model_entries(id));
            } else {
                let is_pinned = choice.pinned.as_ref() == Some(&model.name);
                entries.extend(kept_model_entries(id, is_pinned));
            }
        }
    }
    entries
}

/// Tooltip for entries that ask for a reason.
const REASON: &str = "The reason is saved in the study";

fn rejected_model_entries(id: ModelId) -> [Entry; 2] {
    let name = format!("{} model {}", id.bundle, id.name);
    let ask = Command::Form(FormCommand::AskReason(id.clone()));
    [
        Entry::new(
            format!("Restore {name}"),
            "Return the model to its bundle",
            Edit::Restore(id),
        ),
        Entry::new(
            format!("Give the reason for rejecting {name}…"),
            REASON,
            ask,
        ),
    ]
}

fn kept_model_entries(id: ModelId, is_pinned: bool) -> [Entry; 3] {
    let name = format!("{} model {}", id.bundle, id.name);
    let ask = Command::Form(FormCommand::AskReason(id.clone()));
    let reject = Edit::Reject(id.clone());
    let representative = if is_pinned {
        Entry::new(
            format!("Use the medoid as representative instead of {name}"),
            "The medoid is the representative unless another model is chosen",
            Edit::Unpin {
                condition: id.condition,
                bundle: id.bundle,
            },
        )
    } else {
        Entry::new(
            format!("Use {name} as representative"),
            "Represents the bundle instead of the medoid, or of the model chosen before",
            Edit::Pin(id),
        )
    };
    [
        Entry::new(
            format!("Reject {name}"),
            "Remove the model from its bundle",
            reject,
        ),
        Entry::new(format!("Reject {name} with a reason…"), REASON, ask),
        representative,
    ]
}
