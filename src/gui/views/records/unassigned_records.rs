//! Added records whose names match no condition, each with a selector for its condition. They do
//! not block the other records.

use egui::{Align, Label, Layout, RichText, Role, Ui};

use gdcm_model::dataset::ConditionId;

use super::page::Page;
use super::record_problems::problem_texts;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::DropDown;
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::palette::{BODY_SIZE, medium};

/// Shows the records without a condition; draws nothing if there are none.
pub(super) fn unassigned_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page { state, palette, .. } = page;
    let unassigned = &state.records.unassigned;
    if unassigned.is_empty() {
        return;
    }
    let shown = state.condition().id();
    ui.horizontal(|ui| {
        let title = format!("Without a condition: {}", unassigned.len());
        ui.label(
            RichText::new(title)
                .font(medium(BODY_SIZE))
                .color(palette.warning),
        );
        if unassigned.len() > 1 {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let all = (0..unassigned.len()).collect();
                ui.small_button(format!("Assign all to {shown}"))
                    .on_hover_text("Assigns these records to the displayed condition")
                    .asks(RecordsCommand::Assign(all, shown), commands);
            });
        }
    });
    for (index, row) in unassigned.iter().enumerate() {
        let name = &row.table.name;
        let mut text = RichText::new(name);
        if !row.problems.is_empty() {
            text = text.color(palette.warning);
        }
        let label = ui.add(Label::new(text).wrap());
        if !row.problems.is_empty() {
            label.on_hover_text(problem_texts(&row.problems).join("\n\n"));
        }
        ui.horizontal(|ui| {
            let list = DropDown {
                name: &format!("Condition of {name}"),
                width: 150.0,
                text: "choose its condition",
            };
            if let Some(id) = list.ui(ui, condition_choices(state)) {
                commands.push(RecordsCommand::Assign(vec![index], id).into());
            }
            let remove = ui.small_button("×");
            named(remove, Role::Button, format!("Remove {name}"))
                .on_hover_text("Remove the record")
                .asks(RecordsCommand::Discard(index), commands);
        });
    }
    ui.add_space(4.0);
    ui.separator();
}

/// Lists all conditions for a [`DropDown`], the displayed one first and none marked as current:
/// "10: 60 kt, low altitude, high weight".
fn condition_choices(state: &State) -> Vec<(ConditionId, bool, String)> {
    let shown = state.condition().id();
    let mut choices = Vec::new();
    for condition in state.dataset().conditions() {
        let id = condition.id();
        let text = format!("{id}: {}", condition.flight_state().name);
        let place = if id == shown { 0 } else { choices.len() };
        choices.insert(place, (id, false, text));
    }
    choices
}
