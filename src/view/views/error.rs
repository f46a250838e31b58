//! What the fit sees of the focused response.

use egui::Ui;

use super::frequency::carry_over;
use crate::view::command::Command;
use crate::view::error_scene::{error_curves, error_message, error_rules};
use crate::view::palette::Palette;
use crate::view::plot::{BodeQuantity, BodeScene, PhaseErrorUnit, bode_ui};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;

/// The errors of the response in focus, of every physics model kept, beside those that the correction leaves.
pub fn error_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let pair = state.display.pair;
    state.display.drawn_errors = error_curves(state, pair);
    let rules = error_rules(state, pair, &state.display.drawn_errors);
    let band = state.study.settings.band;
    let (title, message) = (state.dataset().pair_name(pair), error_message(state, pair));
    let grid = state.curves().map(|curves| curves.grid.omega());
    let scene = BodeScene {
        quantity: BodeQuantity::Error { phase: state.display.phase_error },
        rules: &rules,
        omega_range: grid.and_then(|omega| Some((*omega.first()?, *omega.last()?))),
        unit: state.display.unit,
        cursor: state.display.bode.pointed_omega(),
        stale: state.results.is_stale(ui.input(|input| input.time)),
        message: Some(&message),
        ..BodeScene::of(&title, &state.display.drawn_errors, (band.min(), band.max()))
    };
    let mut view = std::mem::take(&mut state.display.error);
    let events = bode_ui(ui, &scene, &mut view, palette);
    state.display.error = view;
    let display = &mut state.display;
    display.bode.share_frequencies(&display.error);
    carry_over(state, events, state.display.error.hovered(), commands);
}

/// How differences of phases are read.
pub fn error_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut unit = state.display.phase_error;
    let units = [
        (PhaseErrorUnit::Degree, "Δφ", "Phase differences in degrees"),
        (PhaseErrorUnit::Millisecond, "Δφ/ω", "The delay [ms] that would make up for each phase difference"),
    ];
    choice_ui(ui, "Phase error", &mut unit, &units);
    if unit != state.display.phase_error {
        commands.push(Command::SetPhaseErrorUnit(unit));
    }
}
