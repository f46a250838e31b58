//! Row above the time charts: for each [`TimeRole`] a chip that shows or hides its curve; at the
//! right, the selectors for outputs and spectrogram.

use egui::{Align, ComboBox, Layout, PopupCloseBehavior, Rect, Role as WidgetRole, Ui, UiBuilder};

use super::histories::shown_outputs;
use super::page::Page;
use super::simulation::Simulated;
use super::spectrogram::spectrogram_choice_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::plot::chip_row::{ChipFace, ChipRow, Sample};
use crate::gui::state::records::TimeRole;
use crate::gui::widgets::controls::named;

/// Length of a curve sample \[pt\].
const SAMPLE: f32 = 18.0;
/// Width of the output selector \[pt\].
const OUTPUTS_WIDTH: f32 = 128.0;
/// Width for both selectors \[pt\].
const SELECTORS: f32 = 290.0;
/// Maximum count of outputs below the output in focus.
const MOST_MORE: usize = 2;

/// Draws the row; `models` are compared with the displayed record.
pub(super) fn role_chips_ui(
    ui: &mut Ui,
    page: Page<'_>,
    models: &[Simulated<'_>],
    place: Rect,
    commands: &mut Vec<Command>,
) {
    let chips = place.with_max_x(place.right() - SELECTORS);
    let mut row = ChipRow::new(chips, SAMPLE);
    for role in TimeRole::ALL {
        let is_shown = !page.state.records.hidden_roles.contains(&role);
        let style = role.style(page.palette);
        let face = ChipFace {
            text: role.name(),
            name: &format!("Show {} over time", role.name()),
            sample: Some(Sample { style, is_shown }),
            is_lit: false,
        };
        let response = row.chip_ui(ui, &face, page.palette);
        if response.clicked() {
            commands.push(RecordsCommand::ShowTimeRole(role, !is_shown).into());
        }
        let model = models.iter().find(|model| model.role == role);
        let hint = match (role, model) {
            (TimeRole::Measured, _) => "Samples of the record".to_owned(),
            (_, Some(model)) => match model.failure() {
                Some(failure) => failure,
                None => {
                    "Simulated in windows of at most 10 s, each with its own initial state and \
                         offsets"
                        .to_owned()
                }
            },
            (TimeRole::Identified, None) if page.records.identification().is_none() => {
                "No model has been identified from records: choose Identify".to_owned()
            }
            (TimeRole::Physics | TimeRole::Corrected | TimeRole::Scheduled, None)
                if page.state.shown().is_none() =>
            {
                "The condition has no result, so no model to simulate".to_owned()
            }
            (TimeRole::Scheduled, None) if has_no_schedule(page) => {
                "There is no schedule, so no scheduled model".to_owned()
            }
            (_, None) => {
                "Not simulated: the record needs assigned columns, and the model must be a \
                state-space model in continuous time without delays"
                    .to_owned()
            }
        };
        response.on_hover_text(hint);
    }
    let selectors = place.with_min_x(place.right() - SELECTORS);
    let builder = UiBuilder::new()
        .max_rect(selectors)
        .layout(Layout::right_to_left(Align::Center));
    ui.scope_builder(builder, |ui| {
        spectrogram_choice_ui(ui, page, commands);
        outputs_ui(ui, page, commands);
    });
}

fn has_no_schedule(page: Page<'_>) -> bool {
    page.state
        .analysis()
        .is_some_and(|analysis| analysis.schedule.is_err())
}

/// Draws the selector of the outputs below the output in focus.
fn outputs_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let channels = page.state.dataset().outputs();
    let shown: Vec<usize> = shown_outputs(page)
        .into_iter()
        .take(1 + MOST_MORE)
        .collect();
    let names: Vec<&str> = shown
        .iter()
        .map(|output| channels[*output].name.as_str())
        .collect();
    let list = ComboBox::from_id_salt("outputs over time")
        .width(OUTPUTS_WIDTH)
        .selected_text(format!("outputs {}", names.join(", ")))
        .truncate()
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show_ui(ui, |ui| {
            for (output, channel) in channels.iter().enumerate() {
                let is_focus = shown.first() == Some(&output);
                let mut is_shown = shown.contains(&output);
                let check = ui.add_enabled_ui(!is_focus, |ui| {
                    ui.checkbox(&mut is_shown, channel.name.as_str())
                });
                if check.inner.changed() {
                    let more = with_output(&shown[1..], output, is_shown);
                    commands.push(RecordsCommand::ShowOutputs(more).into());
                }
            }
        });
    named(list.response, WidgetRole::ComboBox, "Outputs over time")
        .on_hover_text("The output in focus, and up to two more");
}

/// Returns the additional outputs with `output` added or removed; above [`MOST_MORE`], the earliest
/// is dropped.
fn with_output(more: &[usize], output: usize, is_added: bool) -> Vec<usize> {
    let mut outputs: Vec<usize> = more
        .iter()
        .copied()
        .filter(|other| *other != output)
        .collect();
    if is_added {
        outputs.push(output);
    }
    if outputs.len() > MOST_MORE {
        outputs.remove(0);
    }
    outputs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_output_takes_the_place_of_the_earliest() {
        assert_eq!(with_output(&[2, 3], 5, true), [3, 5]);
        assert_eq!(with_output(&[2, 3], 3, false), [2]);
        assert_eq!(with_output(&[2], 4, true), [2, 4]);
    }
}
