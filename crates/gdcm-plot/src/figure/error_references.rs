//! Reference lines in error plots: G and D, bounds, quantiles, and the envelopes of maximum
//! unnoticeable added dynamics (MUAD).
//!
//! The *delta* gain G and the *delta* delay D are the gain and the delay that the physics
//! representative lacks (M6); the *bounds* limit each channel's gain and delay in the fit (M7). A
//! positive delay is a delay that the physics model lacks.

use gdcm_method::correction::delta::GainSource;
use gdcm_model::dataset::{BundleKind, Pair};
use gdcm_model::number_format::with_minus_sign;
use gdcm_model::statistics::quantile;
use gdcm_model::units::{ratio_to_db, s_to_ms};
use gdcm_study::ConditionAnalysis;
use gdcm_study::decisions::settings::Settings;

use super::axis::PhaseErrorUnit;
use super::bode_curve::{BodeCurve, CurveId, Pane};
use super::bode_options::BodeOptions;
use super::condition_source::ConditionSource;
use super::muad::muad_among_errors;
use super::reference_line::{Level, ReferenceKind, ReferenceLine};

impl ConditionSource<'_> {
    /// Returns lines at G and D, at the channel bounds, and at quantiles of the representative's
    /// error (M6, M7); where requested, also the MUAD envelopes. Empty before the condition is
    /// compared. Lines at quantiles are returned even if the representative's curve in `drawn` is
    /// hidden.
    pub fn error_references(
        &self,
        pair: Pair,
        options: &BodeOptions,
        drawn: &[BodeCurve],
    ) -> Vec<ReferenceLine> {
        let Some(analysis) = self.analysis else {
            return Vec::new();
        };
        let unit = options.phase_error;
        let mut lines = delta_lines(analysis, &self.study.settings, pair, unit);
        lines.extend(bound_lines(analysis, unit));
        let name = analysis.representative_name(BundleKind::Physics);
        let representative = drawn.iter().find(|curve| {
            matches!(&curve.id, CurveId::Model(id) if id.bundle == BundleKind::Physics && id.name == name)
        });
        if let Some(curve) = representative {
            lines.extend(quantile_lines(curve, self.study.settings.quantile, unit));
        }
        if options.shows_muad
            && let Some(curve) = drawn.first()
        {
            // All curves have the same frequencies.
            lines.extend(muad_among_errors(&curve.omega, unit));
        }
        lines
    }
}

/// Returns lines at delta gain G and delta delay D (M6) where these are defined.
fn delta_lines(
    analysis: &ConditionAnalysis,
    settings: &Settings,
    pair: Pair,
    unit: PhaseErrorUnit,
) -> Vec<ReferenceLine> {
    let mut lines = Vec::new();
    // With leads, G always comes from the representatives.
    let is_mean_of_pairs =
        settings.gain_source == GainSource::MeanOfPairs && !settings.is_gain_source_idle();
    if let Some(gain) = analysis.delta_gain(pair) {
        let label = format!("G {gain:.3} ({} dB)", one_decimal(ratio_to_db(gain)));
        let mut line = gain_line(ReferenceKind::Delta, label, gain);
        line.note = if is_mean_of_pairs {
            ", mean over all pairs of kept models".to_owned()
        } else {
            ", median over the band".to_owned()
        };
        lines.push(line);
    }
    if let Some(delay_s) = analysis.delta_delay_s(pair) {
        let label = format!("D {} ms", one_decimal(s_to_ms(delay_s)));
        let mut line = delay_line(ReferenceKind::Delta, label, delay_s, unit);
        if delay_s < 0.0 {
            line.note = ": lead is needed".to_owned();
        }
        lines.push(line);
    }
    lines
}

/// Returns lines at the channel bounds: the lower and the upper gain, and the upper delay (M7).
fn bound_lines(analysis: &ConditionAnalysis, unit: PhaseErrorUnit) -> Vec<ReferenceLine> {
    let bounds = analysis.gain_bounds();
    let delay_s = analysis.delay_upper_s();
    let lower = format!("LB {:.3}", bounds.lower);
    let upper = format!("UB {:.3}", bounds.upper);
    let latest = format!("UB {} ms", one_decimal(s_to_ms(delay_s)));
    vec![
        gain_line(ReferenceKind::Bound, lower, bounds.lower),
        gain_line(ReferenceKind::Bound, upper, bounds.upper),
        delay_line(ReferenceKind::Bound, latest, delay_s, unit),
    ]
}

/// Returns lines at the quantiles `q` and `1 - q` of a response's error, as in M7 but for this
/// response alone.
fn quantile_lines(curve: &BodeCurve, q: f64, unit: PhaseErrorUnit) -> Vec<ReferenceLine> {
    let mut ratios_db = curve.magnitude_db.to_vec();
    let mut delays_s = Vec::new();
    for (omega, phase) in curve.omega.iter().zip(curve.phase_deg.iter()) {
        // In an error curve, `phase_deg` holds the phase error in `unit`.
        delays_s.push(match unit {
            PhaseErrorUnit::Degree => phase.to_radians() / omega,
            PhaseErrorUnit::Millisecond => 1e-3 * phase,
        });
    }
    // Frequencies that are excluded from the fit have NaN as their error.
    ratios_db.retain(|ratio| ratio.is_finite());
    delays_s.retain(|delay| delay.is_finite());
    let mut lines = Vec::new();
    for q in [q, 1.0 - q] {
        let label = format!("{:.0} % quantile", 100.0 * q);
        let ratio = Level::Constant(quantile(&mut ratios_db, q));
        let delay_s = quantile(&mut delays_s, q);
        lines.push(ReferenceLine::new(
            Pane::Magnitude,
            ReferenceKind::Quantile,
            label.clone(),
            ratio,
        ));
        lines.push(delay_line(ReferenceKind::Quantile, label, delay_s, unit));
    }
    lines
}

/// Creates a line at a delay \[s\] in a phase-error panel.
fn delay_line(
    kind: ReferenceKind,
    label: String,
    delay_s: f64,
    unit: PhaseErrorUnit,
) -> ReferenceLine {
    let level = match unit {
        PhaseErrorUnit::Degree => Level::ProportionalToOmega(delay_s.to_degrees()),
        PhaseErrorUnit::Millisecond => Level::Constant(s_to_ms(delay_s)),
    };
    ReferenceLine::new(Pane::Phase, kind, label, level)
}

/// Creates a line at a gain \[-\] in a magnitude-error panel.
fn gain_line(kind: ReferenceKind, label: String, gain: f64) -> ReferenceLine {
    let level = Level::Constant(ratio_to_db(gain));
    ReferenceLine::new(Pane::Magnitude, kind, label, level)
}

/// Formats a value with one decimal and a true minus sign.
fn one_decimal(value: f64) -> String {
    with_minus_sign(&format!("{value:.1}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delay_is_a_ray_in_degrees_and_level_in_milliseconds() {
        let level = |unit| delay_line(ReferenceKind::Delta, String::new(), 0.1, unit).level;
        assert_eq!(
            level(PhaseErrorUnit::Degree),
            Level::ProportionalToOmega(0.1f64.to_degrees())
        );
        assert_eq!(level(PhaseErrorUnit::Millisecond), Level::Constant(100.0));
    }
}
