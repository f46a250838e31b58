//! Fields for the test input in the requirement details: a step or a doublet of the input in focus,
//! from rest (M17.2: docs/requirements.md). A change is stored in the study.

use egui::{Label, Ui};

use gdcm_method::requirements::{TestInput, TestInputShape};
use gdcm_model::units::number;
use gdcm_study::decisions::requirement_settings::RequirementPart;

use super::requirement_edits::requirement_edit;
use super::requirement_history_jobs::compared_record;
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::number_entry::number_entry_ui;
use crate::gui::widgets::palette::Palette;
use crate::message::Message;

/// Draws the fields for shape, size and duration; above them, why the details can show no record:
/// one is being read, or the condition has none in use.
pub(super) fn test_input_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    if let Some(reading) = &state.records.reading {
        ui.label(palette.small(format!("reading {reading} …")));
    } else if compared_record(state).is_none() {
        ui.add(
            Label::new(
                palette.small(
                    "No flight record of this condition is in use; add or use one in Records",
                ),
            )
            .truncate(),
        );
    }
    let test = state.study.requirements.test;
    let input = &state.dataset().inputs()[state.display.selection.pair.input];
    ui.horizontal(|ui| {
        let mut shape = test.shape;
        let choices = [
            (
                TestInputShape::Step,
                "step",
                "Constant for its whole duration, then back to trim",
            ),
            (
                TestInputShape::Doublet,
                "doublet",
                "To one side for the first half of its duration, to the other side for the second \
                half",
            ),
        ];
        choice_ui(ui, "Shape of the test input", &mut shape, &choices);
        if shape != test.shape {
            let changed = TestInput { shape, ..test };
            commands.push(set_test_input(state, RequirementPart::TestShape, changed));
        }
        ui.label(palette.small(format!("of {} by", input.name)));
        let size = test_number_ui(ui, "Size of the test input", test.size, commands);
        if let Some(size) = size {
            let changed = TestInput { size, ..test };
            commands.push(set_test_input(state, RequirementPart::TestSize, changed));
        }
        ui.label(palette.small(format!("{} for", input.unit)));
        let duration_s =
            test_number_ui(ui, "Duration of the test input", test.duration_s, commands);
        if let Some(duration_s) = duration_s {
            let changed = TestInput { duration_s, ..test };
            commands.push(set_test_input(
                state,
                RequirementPart::TestDuration,
                changed,
            ));
        }
        ui.label(palette.small("s"));
    });
}

/// Draws a number field; returns a newly typed number; `None` without one, or if the field was
/// emptied.
fn test_number_ui(ui: &mut Ui, name: &str, value: f64, commands: &mut Vec<Command>) -> Option<f64> {
    number_entry_ui(ui, name, &number(value), "", 48.0, commands)?
}

/// Returns the command that changes the test input, or the command that reports why it is refused.
fn set_test_input(state: &State, part: RequirementPart, test: TestInput) -> Command {
    match test.checked() {
        Ok(test) => requirement_edit(state, part, |settings| settings.test = test),
        Err(why) => FormCommand::Refuse(Message::new("wrong-test-input", why.to_string())).into(),
    }
}
