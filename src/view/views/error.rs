//! What the fit sees of the focused response.

use egui::Ui;

use super::frequency::{Drawn, carry_over, chips};
use crate::view::command::Command;
use crate::view::cursor_readout::cursor_readout;
use crate::view::curve_display::CurveCommand;
use crate::view::error_scene::{error_curves, error_message, error_rules, noticed};
use crate::view::palette::Palette;
use crate::view::plot::{BodeQuantity, BodeScene, PhaseErrorUnit, bode_ui};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;

/// The errors of the response in focus, of every physics model kept, beside those that the correction leaves.
pub fn error_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let pair = state.display.pair;
    let mut view = std::mem::take(&mut state.display.error);
    let curves = error_curves(state, pair);
    let (rules, strips) = (error_rules(state, pair, &curves), noticed(state, &curves));
    let (title, message) = (state.dataset().pair_name(pair), error_message(state, pair));
    let display = &state.display.curves;
    let quantity = BodeQuantity::Error { phase: display.phase_error };
    let at = (display.cursor, display.pinned.as_slice());
    let readout = if display.lists_values { cursor_readout(&curves, quantity, state.display.unit, at) } else { None };
    let chips: Vec<_> = chips(state).into_iter().map(|(chip, _)| chip).collect();
    let band = state.study.settings.band;
    let grid = state.curves().map(|curves| curves.grid.omega());
    let scene = BodeScene {
        quantity,
        rules: &rules,
        strips: &strips,
        omega_range: grid.and_then(|omega| Some((*omega.first()?, *omega.last()?))),
        cursor: display.cursor,
        pinned: &display.pinned,
        readout: readout.as_ref(),
        hidden_roles: &display.hidden_roles,
        chips: &chips,
        unit: state.display.unit,
        stale: state.results.is_stale(ui.input(|input| input.time)),
        message: Some(&message),
        ..BodeScene::of(&title, &curves, (band.min(), band.max()))
    };
    let events = bode_ui(ui, &scene, &mut view, palette);
    carry_over(state, Drawn { quantity, curves: &curves, view: &view, events }, commands);
    state.display.bode.share_frequencies(&view);
    state.display.error = view;
    state.display.drawn_errors = curves;
}

/// How differences of phases are read.
pub fn error_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut unit = state.display.curves.phase_error;
    let units = [
        (PhaseErrorUnit::Degree, "Δφ", "Phase differences in degrees"),
        (PhaseErrorUnit::Millisecond, "Δφ/ω", "The delay [ms] that would make up for each phase difference"),
    ];
    choice_ui(ui, "Phase error", &mut unit, &units);
    if unit != state.display.curves.phase_error {
        commands.push(CurveCommand::DrawPhaseErrors(unit).into());
    }
}
