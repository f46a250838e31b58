//! Reruns of the physics model worth making first, suggested by the pattern in the corrections
//! (M18.4).

use egui::{Button, Label, RichText, Ui};

use gdcm_study::results::suggested_runs::{SuggestedRuns, suggested_runs};
use gdcm_words::suggested_runs::{run_template, suggestion_text};

use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::button_ui;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};

/// Returns the suggestions for the displayed results; empty until there are results.
pub(super) fn shown_suggestions(state: &State) -> Vec<SuggestedRuns> {
    let Some(analysis) = state.analysis() else {
        return Vec::new();
    };
    let couplings = match state.couplings() {
        Some(Ok(assessment)) => Some(assessment.as_ref()),
        Some(Err(_)) | None => None,
    };
    suggested_runs(analysis, couplings)
}

/// Draws the suggestions, and the button that copies a template for the models to add to the
/// dataset; draws nothing without suggestions.
pub(super) fn suggested_runs_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let suggestions = shown_suggestions(state);
    if suggestions.is_empty() {
        return;
    }
    ui.add_space(6.0);
    ui.label(RichText::new("Suggested reruns of the physics model").font(medium(BODY_SIZE)));
    for suggestion in &suggestions {
        let text = suggestion_text(suggestion, state.dataset());
        ui.add(Label::new(palette.small(text)).wrap());
    }
    let button = Button::new("Copy a template for the reruns").small();
    let hint = "Entries for the physics models of a condition: fill in the matrices of each rerun \
        (docs/physics.md)";
    let copy = OutputCommand::CopyText(run_template(&suggestions));
    button_ui(ui, button, hint, copy, commands);
}
