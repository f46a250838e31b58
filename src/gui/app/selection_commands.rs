//! Carries out selections and highlights.

use gdcm_model::dataset::ConditionId;

use super::GdcmApp;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::display::Display;

impl GdcmApp {
    pub(super) fn carry_out_selection(&mut self, command: SelectionCommand) {
        let display = &mut self.state.display;
        match command {
            SelectionCommand::SelectCondition(condition) => select_condition(display, condition),
            SelectionCommand::FocusPair(pair) if display.pair != pair => {
                display.pair = pair;
                display.curves.crossings.clear();
                display.refit_frequency_plots();
            }
            SelectionCommand::FocusPair(_) => {}
            SelectionCommand::Hover(model) => display.hovered = Some(model),
            SelectionCommand::HoverCondition(condition) => {
                display.hovered_condition = Some(condition)
            }
            SelectionCommand::Tell(words) => display.told = Some(words),
            SelectionCommand::Isolate(model) => {
                display.isolated = if display.isolated.as_ref() == Some(&model) {
                    None
                } else {
                    Some(model)
                };
            }
            SelectionCommand::Explain(asked) => display.asked = asked,
            SelectionCommand::EndIsolation => {
                display.isolated = None;
                display.curves.selected.clear();
            }
        }
    }
}

fn select_condition(display: &mut Display, condition: ConditionId) {
    if display.condition != condition {
        display.condition = condition;
        display.isolated = None;
        display.curves.selected.clear();
        display.curves.crossings.clear();
        display.refit_frequency_plots();
    }
}
