//! The focused response, large.

use egui::Ui;
use gdcm_files::figure::{ConditionSource, uncertainty_bands};

use super::frequency::{Drawn, bode_curves, carry_over, chips, cursor_readout};
use crate::view::command::Command;
use crate::view::palette::Palette;
use crate::view::plot::{BodeQuantity, BodeScene, ResponsePlace, bode_ui};
use crate::view::state::State;

/// Magnitude and phase of the response in focus, of every model of the condition shown.
pub fn bode_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let pair = state.display.pair;
    let mut view = std::mem::take(&mut state.display.bode);
    let curves = bode_curves(state, pair);
    let title = state.dataset().pair_name(pair);
    let ratio_unit = ConditionSource::ratio_unit(state.dataset(), pair);
    let display = &state.display.curves;
    let quantity = BodeQuantity::Response {
        magnitude: display.magnitude,
        phase: display.phase,
        ratio_unit: &ratio_unit,
        place: ResponsePlace::Condition,
    };
    let at = (display.cursor, display.pinned.as_slice());
    let readout = if display.lists_values { cursor_readout(&curves, quantity, state.display.unit, at) } else { None };
    let chips: Vec<_> = chips(state).into_iter().map(|(chip, _)| chip).collect();
    let band = state.study.settings.band;
    let bands = uncertainty_bands(state.dataset(), pair, &curves);
    let scene = BodeScene {
        quantity,
        bands: &bands,
        cursor: display.cursor,
        pinned: &display.pinned,
        readout: readout.as_ref(),
        hidden_roles: &display.hidden_roles,
        chips: &chips,
        unit: state.display.unit,
        stale: state.results.is_stale(ui.input(|input| input.time)),
        message: state.curves_message(),
        ..BodeScene::of(&title, &curves, (band.min(), band.max()))
    };
    let events = bode_ui(ui, &scene, &mut view, palette);
    carry_over(state, Drawn { quantity, curves: &curves, view: &view, events }, commands);
    state.display.error.share_frequencies(&view);
    state.display.bode = view;
    state.display.drawn = curves;
}
