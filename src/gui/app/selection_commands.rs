//! Carries out commands that select or highlight conditions, responses and models.

use gdcm_model::dataset::ConditionId;

use super::GdcmApp;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::display::Display;

impl GdcmApp {
    pub(super) fn carry_out_selection(&mut self, command: SelectionCommand) {
        let display = &mut self.state.display;
        match command {
            SelectionCommand::SelectCondition(condition) => select_condition(display, condition),
            SelectionCommand::FocusPair(pair) if display.selection.pair != pair => {
                display.selection.pair = pair;
                display.curves.crossings.clear();
                display.frequency.refit();
            }
            SelectionCommand::FocusPair(_) => {}
            SelectionCommand::Hover(model) => display.selection.hovered = Some(model),
            SelectionCommand::HoverCondition(condition) => {
                display.selection.hovered_condition = Some(condition)
            }
            SelectionCommand::ShowStatus(words) => display.selection.pointed_words = Some(words),
            SelectionCommand::Isolate(model) => {
                let isolated = &mut display.selection.isolated;
                *isolated = if isolated.as_ref() == Some(&model) {
                    None
                } else {
                    Some(model)
                };
            }
            SelectionCommand::Explain(target) => display.selection.explained = target,
            SelectionCommand::EndIsolation => {
                display.selection.isolated = None;
                display.curves.selected.clear();
            }
        }
    }
}

fn select_condition(display: &mut Display, condition: ConditionId) {
    if display.selection.condition != condition {
        display.selection.condition = condition;
        display.selection.isolated = None;
        display.curves.selected.clear();
        display.curves.crossings.clear();
    }
}
