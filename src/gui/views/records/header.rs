//! Commands in the view's header.

use egui::{Button, Ui};

use super::offered_models::offered_models_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, button_ui};

/// Draws the commands for the displayed condition, from right to left.
pub fn records_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let condition = state.condition().id();
    if state.records.job_of(condition).is_some() {
        let stop = Button::new("Stop identifying");
        button_ui(ui, stop, "", RecordsCommand::Stop, commands);
        ui.spinner();
        return;
    }
    let records = state.records.conditions.get(&condition);
    let has_used_record = records.is_some_and(|records| records.used_rows().next().is_some());
    let hint = "Identifies models of this condition from its records: CT-PBSID, refined, with \
        confidence bands (M14)";
    ui.add_enabled(has_used_record, Button::new("Identify"))
        .on_hover_text(hint)
        .asks(RecordsCommand::Identify, commands);
    if records.is_some_and(|records| records.identification().is_some()) {
        let hint = "Replaces the identified models of this condition; one step to undo";
        if let Some(offered) = offered_models_ui(ui, "Use these models", hint) {
            commands.push(RecordsCommand::Take(offered).into());
        }
    }
    let has_taken_models = state.study.taken_models().any(|(id, _)| id == condition);
    if has_taken_models && ui.button("Restore the file's models").clicked() {
        commands.push(RecordsCommand::Return.into());
    }
}
