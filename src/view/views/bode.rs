//! The focused response, large.

use egui::Ui;
use gdcm_files::figure::{ConditionSource, uncertainty_bands};

use super::frequency::{bode_curves, frequency_plot_ui};
use crate::view::command::Command;
use crate::view::palette::Palette;
use crate::view::plot::{BodeQuantity, BodeScene, ResponsePlace};
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
    let band = state.study.settings.band;
    let bands = uncertainty_bands(state.dataset(), pair, &curves);
    let (band, message) = ((band.min(), band.max()), state.curves_message());
    let scene = BodeScene { quantity, bands: &bands, message, ..BodeScene::of(&title, &curves, band) };
    frequency_plot_ui(ui, state, (scene, &mut view), palette, commands);
    state.display.error.share_frequencies(&view);
    state.display.bode = view;
    state.display.drawn = curves;
}
