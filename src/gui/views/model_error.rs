//! Error view: the models' magnitude ratio and phase difference to the identified model, in the
//! response in focus.
//!
//! Strips along the frequency axis mark the ranges in which a pilot would notice the corrected
//! model's error (MUAD, maximum unnoticeable added dynamics: docs/method.md). Reference lines are
//! at the gain G and the delay D that would match the response (M6), and at the channels' bounds.

use egui::Ui;

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::error::noticed;
use gdcm_words::caution::undefined_text;

use super::frequency_curves::{bode_options, condition_source, error_curves, error_reference};
use super::frequency_plot::FrequencyPlot;
use crate::gui::commands::command::Command;
use crate::gui::plot::BodeScene;
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::plot::quantity::{BodeQuantity, PhaseErrorUnit};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::PageOption;
use crate::gui::widgets::palette::Palette;

/// Draws magnitude ratio and phase difference to the identified model for every physics model that
/// is not rejected and for the representative with each correction, in the response in focus. The
/// Bode view takes over the frequency range.
pub fn error_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let pair = state.display.selection.pair;
    // The scene borrows the state: take the view out while the plot is drawn.
    let mut view = std::mem::take(&mut state.display.frequency.error);
    let options = bode_options(state);
    let curves = error_curves(state, pair, &options);
    let reference_lines = match condition_source(state) {
        Some(source) => source.error_references(pair, &options, &curves),
        None => Vec::new(),
    };
    let reference = error_reference(&curves);
    let noticed_ranges = noticed(&curves, &options);
    let title = state.dataset().pair_name(pair);
    let message = error_message(state, pair);
    let quantity = BodeQuantity::Error {
        phase: options.phase_error,
    };
    let band = state.study.settings.band;
    let mut omega_range = None;
    if let Some(curves) = state.responses()
        && let (Some(first), Some(last)) = (curves.grid.omega().first(), curves.grid.omega().last())
    {
        omega_range = Some((*first, *last));
    }
    let scene = BodeScene {
        quantity,
        reference_lines: &reference_lines,
        reference: reference.as_ref(),
        noticed_ranges: &noticed_ranges,
        omega_range,
        message: Some(&message),
        ..BodeScene::new(&title, &curves, (band.min(), band.max()))
    };
    let plot = FrequencyPlot {
        state,
        scene,
        view: &mut view,
        palette,
    };
    plot.ui(ui, commands);
    state.display.frequency.bode.share_frequencies(&view);
    state.display.frequency.error = view;
    state.display.frequency.drawn_errors = curves;
}

/// Draws the selector between phase differences \[deg\] and equivalent delays \[ms\].
pub fn error_header_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let mut unit = state.display.curves.phase_error;
    let units = [
        (PhaseErrorUnit::Degree, "Δφ", "Phase differences [deg]"),
        (
            PhaseErrorUnit::Millisecond,
            "Δφ/ω",
            "Equivalent delay of each phase difference [ms]",
        ),
    ];
    let option = PageOption {
        name: "Phase error",
        label: "phase",
    };
    option.ui(ui, &mut unit, &units, palette);
    if unit != state.display.curves.phase_error {
        commands.push(CurveCommand::DrawPhaseErrors(unit).into());
    }
}

/// Returns the message shown if there are no error curves: first, why the response is not compared;
/// else, why there are no curves; else, that there is nothing to compare in the band.
pub fn error_message(state: &State, pair: Pair) -> String {
    let name = state.dataset().pair_name(pair);
    let undefined = match state.shown() {
        Some(shown) => shown.comparison.undefined[pair],
        None => None,
    };
    match undefined {
        Some(why) => format!("{name} is not compared: {}", undefined_text(why)),
        None => match state.curves_message() {
            Some(message) => message.to_owned(),
            None => "Nothing to compare in the band".to_owned(),
        },
    }
}
