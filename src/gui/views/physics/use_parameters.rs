//! Physics parameters applied to the physics models: the job that assesses them, and the control in
//! the page bar.
//!
//! A parameter is *named* if the diagnosis proposes its change (M18: docs/physics.md). While no
//! parameters are applied, the job assesses the named ones, which shows their possible benefit.

use egui::{Button, RichText, Ui};

use gdcm_model::number_format::counted;
use gdcm_study::decisions::physics_settings::PhysicsCorrection;
use gdcm_study::decisions::setting_table;
use gdcm_study::jobs::analysis_jobs::PhysicsJob;

use crate::gui::commands::command::Command;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::controls::button_ui;
use crate::gui::widgets::palette::Palette;

/// Returns the job that diagnoses and assesses the parameters.
pub fn physics_job(state: &State) -> PhysicsJob {
    PhysicsJob {
        study: state.study.clone(),
        physics: state.assessed_physics(),
    }
}

/// Counts the parameters that the diagnosis names; 0 if parameters are already applied, or without
/// a diagnosis.
pub fn unused_named(state: &State) -> usize {
    if state.study.settings.physics != PhysicsCorrection::Off {
        return 0;
    }
    match state.physics() {
        Some(Some(Ok(assessment))) => match &assessment.applied.findings {
            Some(findings) => findings.named().len(),
            None => 0,
        },
        _ => 0,
    }
}

/// Draws the selector for the applied parameters, and the button that applies the named ones.
pub fn physics_header_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let shown = state.study.settings.physics;
    let named = unused_named(state);
    if named > 0 {
        let text = format!("Use {}", counted(named, "parameter"));
        let button =
            Button::new(RichText::new(text).color(palette.on_accent())).fill(palette.accent);
        let hint = "Changes the named parameters in the physics models of all conditions, before \
            every other correction; can be undone in one step";
        let command = setting_table::PHYSICS.to(PhysicsCorrection::Named);
        button_ui(ui, button, hint, command, commands);
    }
    let mut chosen = shown;
    let choices = [
        (
            PhysicsCorrection::Off,
            "off",
            "The physics models as in the dataset",
        ),
        (
            PhysicsCorrection::Named,
            "named",
            "Only the parameters that the diagnosis names, fitted again without the others",
        ),
        (PhysicsCorrection::All, "all", "All parameters that are on"),
        (
            PhysicsCorrection::ByHand,
            "by hand",
            "The values set by hand; nothing is fitted",
        ),
    ];
    choice_ui(ui, "Physics parameters applied", &mut chosen, &choices);
    if chosen != shown {
        commands.push(setting_table::PHYSICS.to(chosen).into());
    }
}
