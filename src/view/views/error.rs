//! What the fit sees of the focused response.

use egui::Ui;
use gdcm_core::dataset::Pair;
use gdcm_core::study::Undefined;
use gdcm_files::figure::noticed;

use super::frequency::{bode_options, condition_source, error_curves, frequency_plot_ui};
use crate::view::command::Command;
use crate::view::curve_display::CurveCommand;
use crate::view::palette::Palette;
use crate::view::plot::{BodeQuantity, BodeScene, PhaseErrorUnit};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;

/// The errors of the response in focus, of every physics model kept, beside those that the correction leaves.
pub fn error_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let pair = state.display.pair;
    let mut view = std::mem::take(&mut state.display.error);
    let options = bode_options(state);
    let curves = error_curves(state, pair, &options);
    let rules =
        condition_source(state).map(|source| source.error_references(pair, &options, &curves)).unwrap_or_default();
    let strips = noticed(&curves, &options);
    let (title, message) = (state.dataset().pair_name(pair), error_message(state, pair));
    let quantity = BodeQuantity::Error { phase: options.phase_error };
    let band = state.study.settings.band;
    let grid = state.curves().map(|curves| curves.grid.omega());
    let scene = BodeScene {
        quantity,
        rules: &rules,
        strips: &strips,
        omega_range: grid.and_then(|omega| Some((*omega.first()?, *omega.last()?))),
        message: Some(&message),
        ..BodeScene::of(&title, &curves, (band.min(), band.max()))
    };
    frequency_plot_ui(ui, state, (scene, &mut view), palette, commands);
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

/// What stands where there is no error to draw.
pub fn error_message(state: &State, pair: Pair) -> String {
    match state.shown() {
        Some(shown) if shown.comparison.undefined[pair] == Some(Undefined::NotCoherent) => {
            format!("{} is not compared: {}", state.dataset().pair_name(pair), Undefined::NotCoherent)
        }
        Some(shown) if shown.comparison.undefined[pair].is_some() => {
            let name = state.dataset().pair_name(pair);
            format!("{name} is not compared: one of the representatives has no such response in the band")
        }
        _ => state.curves_message().unwrap_or("Nothing to compare in the band").to_owned(),
    }
}
