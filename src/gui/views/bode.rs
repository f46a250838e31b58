//! Bode view: the response in focus of every model in the displayed condition, with the effect of
//! the correction.

use egui::Ui;

use gdcm_model::dataset::{Band, Pair};
use gdcm_model::number_format::decimals;
use gdcm_model::units::{number, ratio_to_db, s_to_ms};
use gdcm_plot::figure::ConditionSource;
use gdcm_plot::figure::error::muad_about;
use gdcm_plot::figure::responses::uncertainty_bands;

use super::frequency::FrequencyPlot;
use super::frequency_curves::{bode_curves, bode_options, condition_source};
use crate::gui::commands::command::Command;
use crate::gui::plot::bode_scene::{BodeBand, InvalidRegion, PaneNote};
use crate::gui::plot::quantity::{BodeQuantity, ResponseSubject};
use crate::gui::plot::{BodeCurve, BodeScene, Pane, Role};
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Draws magnitude and phase of the response in focus, for every model in the displayed condition.
pub fn bode_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let pair = state.display.selection.pair;
    let mut view = std::mem::take(&mut state.display.frequency.bode);
    let curves = bode_curves(state, pair);
    let title = state.dataset().pair_name(pair);
    let ratio_unit = ConditionSource::ratio_unit(state.dataset(), pair);
    let band = state.study.settings.band;
    let bands = uncertainty_bands(state.dataset(), pair, &curves);
    let shows_bands = if bands.is_empty() {
        None
    } else {
        Some(state.display.curves.shows_bands)
    };
    let options = bode_options(state);
    let unnoticed = muad_about(&curves, &options);
    let mut coherence = Vec::new();
    let mut least_coherence = 0.0;
    if let Some(source) = condition_source(state) {
        coherence = source.coherence_curves(pair, &options);
        least_coherence = source.least_coherence();
    }
    let missing = missing_phase(&curves, band);
    let invalid = invalid_region(state, &curves);
    let notes = effect_notes(state, pair);
    let scene = BodeScene {
        quantity: response_quantity(state, &ratio_unit),
        rules: &unnoticed,
        coherence: &coherence,
        least_coherence,
        bands: &bands,
        shows_bands,
        missing: missing.as_ref(),
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

/// Returns the quantity of the plot in the displayed units; `ratio_unit` as in "(deg/s)/in".
fn response_quantity<'a>(state: &State, ratio_unit: &'a str) -> BodeQuantity<'a> {
    let display = &state.display.curves;
    BodeQuantity::Response {
        magnitude: display.magnitude,
        phase: display.phase,
        ratio_unit,
        subject: ResponseSubject::Condition,
    }
}

/// Returns the curve with this role, unless it is hidden.
fn drawn_curve(curves: &[BodeCurve], role: Role) -> Option<&BodeCurve> {
    curves
        .iter()
        .find(|curve| !curve.hidden && curve.role == role)
}

/// Returns the region above the band in which the corrected model is not valid and only shows the
/// gain added by leads; `None` without leads (M15.6).
///
/// The words are those of `lead_price::limit_text`, but with the band that is being edited and in
/// the displayed unit.
fn invalid_region(state: &State, curves: &[BodeCurve]) -> Option<InvalidRegion> {
    let leads = &state.shown()?.compensated.as_ref()?.leads;
    leads.filters().iter().find_map(|(_, filter)| *filter)?;
    let corrected = drawn_curve(curves, Role::Corrected)?;
    let up_to = *corrected.omega.last()?;
    Some(InvalidRegion {
        up_to,
        words: format!(
            "not valid above {}",
            frequency_words(state, state.study.settings.band.max())
        ),
        ends_db: lead_ends_db(corrected, curves, up_to),
    })
}

/// Returns the magnitudes \[dB\] of the corrected model with and without leads at `omega`
/// \[rad/s\].
fn lead_ends_db(corrected: &BodeCurve, curves: &[BodeCurve], omega: f64) -> Option<[f64; 2]> {
    let without = drawn_curve(curves, Role::WithoutLeads)?;
    Some([
        corrected.value_at(Pane::Magnitude, omega)?,
        without.value_at(Pane::Magnitude, omega)?,
    ])
}

/// Returns the area between corrected and identified phase within the band.
fn missing_phase(curves: &[BodeCurve], band: Band) -> Option<BodeBand> {
    let corrected = drawn_curve(curves, Role::Corrected)?;
    let identified = drawn_curve(curves, Role::IdentifiedRepresentative)?;
    let mut omega = vec![band.min()];
    for &inner in corrected.omega.iter() {
        if (band.min()..=band.max()).contains(&inner) {
            omega.push(inner);
        }
    }
    omega.push(band.max());
    let phase_deg = omega
        .iter()
        .map(|&omega| {
            [corrected, identified]
                .map(|curve| curve.value_at(Pane::Phase, omega).unwrap_or(f64::NAN))
        })
        .collect();
    Some(BodeBand {
        magnitude_db: vec![[f64::NAN; 2]; omega.len()],
        omega,
        phase_deg,
    })
}

/// Remaining magnitude difference \[dB\] below which the magnitudes count as matched.
const MATCHED_DB: f64 = 0.05;
/// Remaining delay \[s\] below which the phases count as matched.
const MATCHED_S: f64 = 0.5e-3;

/// Returns the notes in the magnitude and phase panes: J before and after the correction, and the
/// gain and delay that the correction leaves uncorrected.
fn effect_notes(state: &State, pair: Pair) -> Option<[PaneNote; 2]> {
    let shown = state.shown()?;
    let change = shown.cost[pair]?;
    let is_constrained = shown.held()[pair];
    let left_db = ratio_to_db(shown.wanted_gain(pair)? / shown.correction.net_gain(pair));
    let left_s = shown.wanted_delay_s(pair)? - shown.correction.net_delay_s(pair);
    let magnitude = PaneNote {
        cost: cost_change(change.uncorrected.magnitude, change.corrected.magnitude),
        verdict: if left_db.abs() < MATCHED_DB {
            "matched".to_owned()
        } else {
            format!("{} dB left", decimals(left_db, 1))
        },
        warns: is_constrained && left_db.abs() >= MATCHED_DB,
    };
    let phase = PaneNote {
        cost: cost_change(change.uncorrected.phase, change.corrected.phase),
        verdict: delay_verdict(state, left_s),
        warns: is_constrained && left_s.abs() >= MATCHED_S,
    };
    Some([magnitude, phase])
}

/// Formats "J 13.4 → 0.3".
fn cost_change(before: f64, after: f64) -> String {
    format!("J {} → {}", decimals(before, 1), decimals(after, 1))
}

/// Formats a remaining delay as "lags by 66 ms, 46° at 12 rad/s"; the corrected model lags if
/// `left_s` is negative.
fn delay_verdict(state: &State, left_s: f64) -> String {
    if left_s.abs() < MATCHED_S {
        return "matched".to_owned();
    }
    let verb = if left_s < 0.0 { "lags" } else { "leads" };
    let top = state.study.settings.band.max();
    let at_top_deg = (left_s * top).to_degrees().abs();
    format!(
        "{verb} by {} ms, {}° at {}",
        decimals(s_to_ms(left_s.abs()), 0),
        decimals(at_top_deg, 0),
        frequency_words(state, top)
    )
}

/// Formats a frequency \[rad/s\] in the displayed unit.
fn frequency_words(state: &State, omega: f64) -> String {
    let unit = state.display.curves.unit;
    format!("{} {}", number(unit.of_omega(omega)), unit.symbol())
}
