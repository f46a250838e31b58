//! The focused response, large.

use egui::Ui;

use super::frequency::carry_over;
use crate::view::bode_scene::bode_curves;
use crate::view::command::Command;
use crate::view::palette::Palette;
use crate::view::plot::{BodeScene, bode_ui};
use crate::view::state::State;

/// Magnitude and phase of the response in focus, of every model of the condition shown.
pub fn bode_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let pair = state.display.pair;
    state.display.drawn = bode_curves(state, pair);
    let band = state.study.settings.band;
    let title = state.dataset().pair_name(pair);
    let scene = BodeScene {
        unit: state.display.unit,
        cursor: state.display.error.pointed_omega(),
        stale: state.results.is_stale(ui.input(|input| input.time)),
        message: state.curves_message(),
        ..BodeScene::of(&title, &state.display.drawn, (band.min(), band.max()))
    };
    let events = bode_ui(ui, &scene, &mut state.display.bode, palette);
    let display = &mut state.display;
    display.error.share_frequencies(&display.bode);
    carry_over(state, events, state.display.bode.hovered(), commands);
}
