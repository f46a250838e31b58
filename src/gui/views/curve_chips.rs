//! Command chips above a plot over frequency: isolation, marks and hidden models, each with the
//! command that ends it, and commands for the models that the engineer has selected by a box.

use std::collections::BTreeSet;

use gdcm_model::dataset::ModelId;
use gdcm_model::units::telling;
use gdcm_study::Edit;

use crate::gui::commands::command::Command;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::chips::CommandChip;
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::state::window_state::State;

/// Chips, each with the command carried out by a click.
#[derive(Default)]
pub(super) struct CurveChips {
    pub(super) chips: Vec<CommandChip>,
    /// Commands, in the order of `chips`.
    pub(super) commands: Vec<Command>,
}

impl CurveChips {
    /// Collects the chips for the displayed condition.
    pub(super) fn new(state: &State) -> Self {
        let mut chips = Self::default();
        chips.add_isolated_model(state);
        chips.add_selected_models(state);
        chips.add_crossings(state);
        chips.add_hidden_models(state);
        chips
    }

    fn add(&mut self, text: String, hint: &str, command: impl Into<Command>) {
        self.chips.push(CommandChip {
            text,
            hint: hint.to_owned(),
        });
        self.commands.push(command.into());
    }

    fn add_isolated_model(&mut self, state: &State) {
        if let Some(id) = &state.display.selection.isolated {
            self.add(
                format!("Only {} ×", id.name),
                "Only this model and the representatives are drawn. Click or Escape: draw all",
                SelectionCommand::EndIsolation,
            );
        }
    }

    fn add_selected_models(&mut self, state: &State) {
        let mut rejected = Vec::new();
        let mut kept = Vec::new();
        for id in &state.display.curves.selected {
            if !is_displayed(state, id) {
                continue;
            }
            if state.study.is_rejected(id) {
                rejected.push(id.clone());
            } else {
                kept.push(id.clone());
            }
        }
        let has_selection = !(rejected.is_empty() && kept.is_empty());
        if !kept.is_empty() {
            self.add(
                format!("Reject {}", model_count(kept.len())),
                "Removes the models inside the drawn box from their bundles",
                Edit::RejectEach(kept),
            );
        }
        if !rejected.is_empty() {
            self.add(
                format!("Restore {}", model_count(rejected.len())),
                "Returns the rejected models inside the drawn box to their bundles",
                Edit::RestoreEach(rejected),
            );
        }
        if has_selection {
            self.add(
                "Select none ×".to_owned(),
                "Leaves the models unchanged (Escape)",
                CurveCommand::Select(BTreeSet::new()),
            );
        }
    }

    /// Adds a chip for the marks at the crossings: the frequencies that define bandwidth and phase
    /// delay, marked by *Show in Bode* in the requirements. Its command also removes the other
    /// marked frequencies.
    fn add_crossings(&mut self, state: &State) {
        let curves = &state.display.curves;
        if curves.crossings.is_empty() {
            return;
        }
        let names: Vec<String> = curves
            .crossings
            .iter()
            .map(|(name, omega)| format!("{name} {}", telling(curves.unit.of_omega(*omega), 2)))
            .collect();
        self.add(
            format!("{} {} ×", names.join(" · "), curves.unit.symbol()),
            "Removes the marks at these frequencies",
            CurveCommand::RemoveFrequencyMarks,
        );
    }

    /// Adds a chip that counts the hidden models of the displayed condition; its command shows
    /// those of every condition.
    fn add_hidden_models(&mut self, state: &State) {
        let hidden = state
            .display
            .curves
            .hidden_models
            .iter()
            .filter(|id| is_displayed(state, id))
            .count();
        if hidden > 0 {
            self.add(
                format!("{} hidden ×", model_count(hidden)),
                "Draws every model again",
                CurveCommand::ShowHidden,
            );
        }
    }
}

/// Returns whether a model belongs to the displayed condition.
fn is_displayed(state: &State, id: &ModelId) -> bool {
    id.condition == state.condition().id()
}

fn model_count(models: usize) -> String {
    if models == 1 {
        "1 model".to_owned()
    } else {
        format!("{models} models")
    }
}
