//! The correction's effect in the Bode view: notes with J and the remaining error, the remaining
//! phase error as an area, and the region above the band in which the corrected model is not valid.
//!
//! The wanted gain G and delay D of a response are those that would match the physics model to the
//! identified one (M6: docs/method.md). The correction provides the net gain k, the product of the
//! gains of input and output, and the net delay τ, the sum of their delays.

use gdcm_model::dataset::{Band, Pair};
use gdcm_model::number_format::decimals;
use gdcm_model::units::{number, ratio_to_db, s_to_ms};

use crate::gui::plot::bode_scene::{BodeBand, InvalidRegion, PaneNote};
use crate::gui::plot::{BodeCurve, Pane, Role};
use crate::gui::state::window_state::State;

/// Remaining gain \[dB\] below which the magnitudes count as matched: it would be shown as 0.0 dB.
const MATCHED_DB: f64 = 0.05;

/// Remaining delay \[s\] below which the phases count as matched: it would be shown as 0 ms.
const MATCHED_S: f64 = 0.5e-3;

/// Returns the notes in the magnitude and phase panes: J before and after the correction, and the
/// parts of the wanted gain G and delay D that remain after its net gain k and net delay τ. A
/// constrained response that is not matched is a warning. `None` unless G, D and J exist.
///
/// ```text
/// remaining gain   G / k, in dB
/// remaining delay  D - τ, in s; negative if the corrected model lags
/// ```
pub(super) fn effect_notes(state: &State, pair: Pair) -> Option<[PaneNote; 2]> {
    let shown = state.shown()?;
    let change = shown.cost[pair]?;
    let is_constrained = shown.held()[pair];
    let remaining_db = ratio_to_db(shown.delta_gain(pair)? / shown.correction.net_gain(pair));
    let remaining_s = shown.delta_delay_s(pair)? - shown.correction.net_delay_s(pair);
    let magnitude = PaneNote {
        cost: cost_change(change.uncorrected.magnitude, change.corrected.magnitude),
        verdict: if remaining_db.abs() < MATCHED_DB {
            "matched".to_owned()
        } else {
            format!("{} dB left", decimals(remaining_db, 1))
        },
        warns: is_constrained && remaining_db.abs() >= MATCHED_DB,
    };
    let phase = PaneNote {
        cost: cost_change(change.uncorrected.phase, change.corrected.phase),
        verdict: delay_verdict(state, remaining_s),
        warns: is_constrained && remaining_s.abs() >= MATCHED_S,
    };
    Some([magnitude, phase])
}

/// Returns the area between corrected and identified phase within the band, its ends included;
/// `NaN` where a curve has no value, and for the magnitudes, which have no area. `None` unless both
/// curves are drawn.
pub(super) fn remaining_phase_area(curves: &[BodeCurve], band: Band) -> Option<BodeBand> {
    let corrected = drawn_curve(curves, Role::Corrected)?;
    let identified = drawn_curve(curves, Role::IdentifiedRepresentative)?;
    let mut omega = vec![band.min()];
    for &drawn_omega in corrected.omega.iter() {
        if (band.min()..=band.max()).contains(&drawn_omega) {
            omega.push(drawn_omega);
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

/// Returns the region above the band in which the corrected model is not valid and only shows the
/// gain added by leads (M15.6: docs/lead.md). `None` without lead filters, or if the corrected
/// curve is hidden.
///
/// The text is as in `lead_price::limit_text`, but shows the band currently being edited, in the
/// displayed unit.
pub(super) fn invalid_region(state: &State, curves: &[BodeCurve]) -> Option<InvalidRegion> {
    let leads = &state.shown()?.compensated.as_ref()?.leads;
    let has_filter = leads.filters().iter().any(|(_, filter)| filter.is_some());
    if !has_filter {
        return None;
    }
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

/// Returns the corrected model's magnitudes \[dB\] with and without leads at `omega` \[rad/s\];
/// `None` if the curve without leads is hidden.
fn lead_ends_db(corrected: &BodeCurve, curves: &[BodeCurve], omega: f64) -> Option<[f64; 2]> {
    let without = drawn_curve(curves, Role::WithoutLeads)?;
    Some([
        corrected.value_at(Pane::Magnitude, omega)?,
        without.value_at(Pane::Magnitude, omega)?,
    ])
}

/// Returns the curve with this role, unless it is hidden.
fn drawn_curve(curves: &[BodeCurve], role: Role) -> Option<&BodeCurve> {
    curves
        .iter()
        .find(|curve| !curve.hidden && curve.role == role)
}

/// Formats "J 13.4 → 0.3".
fn cost_change(before: f64, after: f64) -> String {
    format!("J {} → {}", decimals(before, 1), decimals(after, 1))
}

/// Formats a remaining delay, with the phase that it causes at the upper band limit, as "lags by 66
/// ms, 46° at 12 rad/s"; the corrected model lags if
/// `remaining_s` is negative.
fn delay_verdict(state: &State, remaining_s: f64) -> String {
    if remaining_s.abs() < MATCHED_S {
        return "matched".to_owned();
    }
    let verb = if remaining_s < 0.0 { "lags" } else { "leads" };
    let band_end = state.study.settings.band.max();
    let phase_at_band_end_deg = (remaining_s * band_end).to_degrees().abs();
    format!(
        "{verb} by {} ms, {}° at {}",
        decimals(s_to_ms(remaining_s.abs()), 0),
        decimals(phase_at_band_end_deg, 0),
        frequency_words(state, band_end)
    )
}

/// Formats a frequency \[rad/s\] in the displayed unit.
fn frequency_words(state: &State, omega: f64) -> String {
    let unit = state.display.curves.unit;
    format!("{} {}", number(unit.of_omega(omega)), unit.symbol())
}
