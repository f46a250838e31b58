//! Names for the steps in the undo history.

use gdcm_study::decisions::history::Change;
use gdcm_words::edit::edit_text;

use crate::gui::state::window_state::UndoStep;

/// Returns a step's name, such as "reject nominal (condition 10)".
pub fn step_name(step: &UndoStep) -> String {
    match &step.change {
        Change::Decision(edit) => edit_text(edit, &step.study.dataset),
        Change::Settings(edits) => {
            let names: Vec<String> = edits
                .iter()
                .map(|edit| edit_text(edit, &step.study.dataset))
                .collect();
            match names.as_slice() {
                [first, second] => format!("{first}, {second}"),
                _ => format!("change {} settings", names.len()),
            }
        }
        Change::Outside(change) => change.name(),
        Change::Reload { file } => format!("reload {file}"),
    }
}
