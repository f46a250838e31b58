//! The focused response, large.

use egui::Ui;
use gdcm_core::dataset::Pair;
use gdcm_core::units::{number, ratio_to_db, s_to_ms};
use gdcm_files::figure::{ConditionSource, decimals, muad_about, uncertainty_bands};

use super::frequency::{bode_curves, bode_options, condition_source, frequency_plot_ui};
use crate::view::command::Command;
use crate::view::palette::Palette;
use crate::view::plot::{
    BodeBand, BodeCurve, BodeQuantity, BodeScene, InvalidRegion, Pane, PaneNote, ResponsePlace, Role,
};
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
    let shows_bands = (!bands.is_empty()).then_some(display.shows_bands);
    let unnoticed = muad_about(&curves, &bode_options(state));
    let options = bode_options(state);
    let source = condition_source(state);
    let coherence = source.as_ref().map(|source| source.coherence_curves(pair, &options)).unwrap_or_default();
    let least_coherence = source.as_ref().map_or(0.0, ConditionSource::least_coherence);
    let missing = missing_phase(&curves, (band.min(), band.max()));
    let invalid = invalid_region(state, &curves);
    let notes = notes(state, pair);
    let notes = notes.as_ref().map_or([None; 2], |notes| [Some(&notes[0]), Some(&notes[1])]);
    let (band, message) = ((band.min(), band.max()), state.curves_message());
    let scene = BodeScene {
        quantity,
        rules: &unnoticed,
        coherence: &coherence,
        least_coherence,
        bands: &bands,
        shows_bands,
        missing: missing.as_ref(),
        invalid: invalid.as_ref(),
        notes,
        message,
        ..BodeScene::of(&title, &curves, band)
    };
    frequency_plot_ui(ui, state, (scene, &mut view), palette, commands);
    state.display.error.share_frequencies(&view);
    state.display.bode = view;
    state.display.drawn = curves;
}

/// Where the curves are drawn only to show the price of leads: none without leads (M15.6).
fn invalid_region(state: &State, curves: &[BodeCurve]) -> Option<InvalidRegion> {
    let leads = &state.shown()?.compensated.as_ref()?.leads;
    leads.filters().iter().find_map(|(_, filter)| *filter)?;
    let last = |role: Role| curves.iter().find(|curve| !curve.hidden && curve.role == role).map(|curve| &curve.omega);
    let up_to = *last(Role::Corrected)?.last()?;
    let end = |role: Role| {
        let curve = curves.iter().find(|curve| !curve.hidden && curve.role == role)?;
        curve.value_at(Pane::Magnitude, up_to)
    };
    let ends_db = end(Role::Corrected).zip(end(Role::WithoutLeads)).map(|(with, without)| [with, without]);
    let words = format!("not valid above {}", unit_words(state, state.study.settings.band.max()));
    Some(InvalidRegion { up_to, words, ends_db })
}

/// The phase between the corrected and the identified model, within the band \[rad/s\].
fn missing_phase(curves: &[BodeCurve], (min, max): (f64, f64)) -> Option<BodeBand> {
    let of_role = |role: Role| curves.iter().find(|curve| !curve.hidden && curve.role == role);
    let (corrected, identified) = (of_role(Role::Corrected)?, of_role(Role::IdentifiedRepresentative)?);
    let within = corrected.omega.iter().copied().filter(|omega| (min..=max).contains(omega));
    let omega: Vec<f64> = [min].into_iter().chain(within).chain([max]).collect();
    let value = |curve: &BodeCurve, omega| curve.value_at(Pane::Phase, omega).unwrap_or(f64::NAN);
    let phase_deg = omega.iter().map(|omega| [value(corrected, *omega), value(identified, *omega)]).collect();
    Some(BodeBand { magnitude_db: vec![[f64::NAN; 2]; omega.len()], omega, phase_deg })
}

/// J of magnitude and of phase before and after the correction, and what is left in words.
fn notes(state: &State, pair: Pair) -> Option<[PaneNote; 2]> {
    let shown = state.shown()?;
    let change = shown.cost[pair]?;
    let is_held = shown.held()[pair];
    let cost = |before: f64, after: f64| format!("J {} → {}", decimals(before, 1), decimals(after, 1));
    let left_db = ratio_to_db(shown.wanted_gain(pair)? / shown.correction.net_gain(pair));
    let magnitude = PaneNote {
        cost: cost(change.uncorrected.magnitude, change.corrected.magnitude),
        verdict: match left_db.abs() < 0.05 {
            true => "matched".to_owned(),
            false => format!("{} dB left", decimals(left_db, 1)),
        },
        warns: is_held && left_db.abs() >= 0.05,
    };
    let left_s = shown.wanted_delay_s(pair)? - shown.correction.net_delay_s(pair);
    let top = state.study.settings.band.max();
    let verdict = if left_s.abs() < 0.5e-3 {
        "matched".to_owned()
    } else {
        let verb = if left_s < 0.0 { "lags" } else { "leads" };
        let at_top = decimals((left_s * top).to_degrees().abs(), 0);
        format!("{verb} by {} ms, {at_top}° at {}", decimals(s_to_ms(left_s.abs()), 0), unit_words(state, top))
    };
    let phase = PaneNote {
        cost: cost(change.uncorrected.phase, change.corrected.phase),
        verdict,
        warns: is_held && left_s.abs() >= 0.5e-3,
    };
    Some([magnitude, phase])
}

fn unit_words(state: &State, omega: f64) -> String {
    let unit = state.display.unit;
    format!("{} {}", number(unit.of_omega(omega)), unit.symbol())
}
