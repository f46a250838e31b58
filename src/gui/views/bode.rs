//! Bode view: the response in focus for every model in the displayed condition, with the
//! correction's effect.

use egui::Ui;

use gdcm_plot::figure::ConditionSource;
use gdcm_plot::figure::error::muad_about;
use gdcm_plot::figure::responses::uncertainty_bands;

use super::correction_effect::{effect_notes, invalid_region, remaining_phase_area};
use super::frequency_curves::{bode_curves, bode_options, condition_source};
use super::frequency_plot::FrequencyPlot;
use crate::gui::commands::command::Command;
use crate::gui::plot::BodeScene;
use crate::gui::plot::quantity::{BodeQuantity, ResponseSubject};
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Draws magnitude and phase of the response in focus, for every model in the displayed condition.
/// Around the curves: confidence bands, envelopes of maximum unnoticeable added dynamics (MUAD),
/// coherence of the measured response, the remaining phase error, the region above the band in
/// which the corrected model is not valid, and notes with J. The error view takes over the
/// frequency range.
pub fn bode_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let pair = state.display.selection.pair;
    // The scene borrows the state: take the view out while the plot is drawn.
    let mut view = std::mem::take(&mut state.display.frequency.bode);
    let curves = bode_curves(state, pair);
    let title = state.dataset().pair_name(pair);
    let ratio_unit = ConditionSource::ratio_unit(state.dataset(), pair);
    let band = state.study.settings.band;
    let confidence_bands = uncertainty_bands(state.dataset(), pair, &curves);
    let shows_confidence_bands = if confidence_bands.is_empty() {
        None
    } else {
        Some(state.display.curves.shows_bands)
    };
    let options = bode_options(state);
    let muad_envelopes = muad_about(&curves, &options);
    let mut coherence = Vec::new();
    let mut least_coherence = 0.0;
    if let Some(source) = condition_source(state) {
        coherence = source.coherence_curves(pair, &options);
        least_coherence = source.least_coherence();
    }
    let remaining_phase = remaining_phase_area(&curves, band);
    let invalid = invalid_region(state, &curves);
    let notes = effect_notes(state, pair);
    let scene = BodeScene {
        quantity: response_quantity(state, &ratio_unit),
        reference_lines: &muad_envelopes,
        coherence: &coherence,
        least_coherence,
        uncertainty_bands: &confidence_bands,
        shows_uncertainty: shows_confidence_bands,
        remaining_phase: remaining_phase.as_ref(),
        invalid: invalid.as_ref(),
        notes: match &notes {
            Some([magnitude, phase]) => [Some(magnitude), Some(phase)],
            None => [None; 2],
        },
        message: state.curves_message(),
        ..BodeScene::new(&title, &curves, (band.min(), band.max()))
    };
    let plot = FrequencyPlot {
        state,
        scene,
        view: &mut view,
        palette,
    };
    plot.ui(ui, commands);
    state.display.frequency.error.share_frequencies(&view);
    state.display.frequency.bode = view;
    state.display.frequency.drawn = curves;
}

/// Returns the plotted quantity in the displayed units; `ratio_unit` as in "(deg/s)/in".
fn response_quantity<'a>(state: &State, ratio_unit: &'a str) -> BodeQuantity<'a> {
    let display = &state.display.curves;
    BodeQuantity::Response {
        magnitude: display.magnitude,
        phase: display.phase,
        ratio_unit,
        subject: ResponseSubject::Condition,
    }
}
