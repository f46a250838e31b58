//! What the scheduled correction is worth.

use egui::Ui;

use crate::view::assessment_scene::assessment_panels;
use crate::view::command::Command;
use crate::view::palette::Palette;
use crate::view::plot::{AssessmentEvent, AssessmentScene, assessment_ui};
use crate::view::state::State;

/// The change of J of every measuring response in every condition (Figures 8 to 19).
pub fn assessment_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let (pairs, panels) = assessment_panels(state);
    let scene = AssessmentScene { panels: &panels, message: Some(state.results.absence()) };
    let events = assessment_ui(ui, &scene, &mut state.display.assessment, palette);
    for AssessmentEvent::BarClicked { panel, condition } in events {
        commands.push(Command::SelectCondition(condition));
        commands.extend(pairs.get(panel).map(|&pair| Command::FocusPair(pair)));
    }
}
