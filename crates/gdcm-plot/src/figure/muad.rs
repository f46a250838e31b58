//! Envelopes for maximum unnoticeable added dynamics (MUAD, MIL-STD-1797A), drawn about a response
//! or in an error plot, and the frequencies at which an error leaves them.
//!
//! The envelopes are defined for the ratio of model to reference.

use gdcm_method::fidelity::{Muad, ranges_outside};
use gdcm_model::response::wrap;
use gdcm_model::units::s_to_ms;

use super::axis::PhaseErrorUnit;
use super::bode_curve::{BodeCurve, CurveId, Pane};
use super::bode_options::BodeOptions;
use super::reference_line::{Level, ReferenceKind, ReferenceLine};
use super::role::Role;

/// Index of the lower envelope in [`Muad`].
const LOWER: usize = 0;
/// Index of the upper envelope in [`Muad`].
const UPPER: usize = 1;
/// Label for an envelope above which errors are unnoticeable: the lower limit.
const ABOVE: &str = "unnoticeable above (MUAD)";
/// Label for an envelope below which errors are unnoticeable: the upper limit.
const BELOW: &str = "unnoticeable below (MUAD)";

/// Returns the envelopes about the identified representative in `drawn`, whether its curve is
/// hidden or not: a pilot does not notice a difference from the identified response that stays
/// between them. Empty unless the options show MUAD.
pub fn muad_about(drawn: &[BodeCurve], options: &BodeOptions) -> Vec<ReferenceLine> {
    let identified = drawn
        .iter()
        .find(|curve| curve.role == Role::IdentifiedRepresentative);
    let Some(curve) = identified else {
        return Vec::new();
    };
    if !options.shows_muad {
        return Vec::new();
    }
    let mut lines = Vec::new();
    for (end, label) in [(LOWER, ABOVE), (UPPER, BELOW)] {
        let mut magnitude = Vec::new();
        let mut phase = Vec::new();
        for (k, &omega) in curve.omega.iter().enumerate() {
            let muad = Muad::at(omega);
            magnitude.push([omega, curve.magnitude_db[k] + muad.magnitude_db[end]]);
            phase.push([omega, curve.phase_deg[k] + muad.phase_deg[end]]);
        }
        lines.push(envelope(Pane::Magnitude, label, magnitude));
        lines.push(envelope(Pane::Phase, label, phase));
    }
    lines
}

/// An envelope in an error plot, with its label in either panel.
struct ErrorEnvelope {
    /// Index in [`Muad`].
    end: usize,
    magnitude_label: &'static str,
    phase_label: &'static str,
}

/// Phase errors are drawn as model minus reference, as the envelopes are defined. Magnitude errors
/// are drawn as reference over model: their envelopes are mirrored, so that the lower envelope
/// limits them from above.
const ERROR_ENVELOPES: [ErrorEnvelope; 2] = [
    ErrorEnvelope {
        end: LOWER,
        magnitude_label: BELOW,
        phase_label: ABOVE,
    },
    ErrorEnvelope {
        end: UPPER,
        magnitude_label: ABOVE,
        phase_label: BELOW,
    },
];

/// Returns the envelopes for an error plot at the frequencies `omega` \[rad/s\].
pub(super) fn muad_among_errors(omega: &[f64], unit: PhaseErrorUnit) -> Vec<ReferenceLine> {
    let mut lines = Vec::new();
    for ErrorEnvelope {
        end,
        magnitude_label,
        phase_label,
    } in ERROR_ENVELOPES
    {
        let mut magnitude = Vec::new();
        let mut phase = Vec::new();
        for &omega in omega {
            let muad = Muad::at(omega);
            magnitude.push([omega, -muad.magnitude_db[end]]);
            let degrees = muad.phase_deg[end];
            let error = match unit {
                PhaseErrorUnit::Degree => degrees,
                PhaseErrorUnit::Millisecond => s_to_ms(degrees.to_radians() / omega),
            };
            phase.push([omega, error]);
        }
        lines.push(envelope(Pane::Magnitude, magnitude_label, magnitude));
        lines.push(envelope(Pane::Phase, phase_label, phase));
    }
    lines
}

/// Creates an envelope through points `[omega, value]`.
fn envelope(pane: Pane, label: &str, points: Vec<[f64; 2]>) -> ReferenceLine {
    ReferenceLine::new(pane, ReferenceKind::Envelope, label, Level::Sampled(points))
}

/// Returns the frequency ranges \[rad/s\] in which the corrected curve in `drawn`, an error curve,
/// leaves the envelopes. Empty unless the options show MUAD.
pub fn noticed(drawn: &[BodeCurve], options: &BodeOptions) -> Vec<(f64, f64)> {
    let corrected = drawn.iter().find(|curve| curve.id == CurveId::Corrected);
    let Some(curve) = corrected else {
        return Vec::new();
    };
    if !options.shows_muad {
        return Vec::new();
    }
    let mut omega = Vec::new();
    let mut mismatch_db = Vec::new();
    let mut principal_deg = Vec::new();
    for (k, &at) in curve.omega.iter().enumerate() {
        let error_db = curve.magnitude_db[k];
        if !error_db.is_finite() {
            // The error is NaN at frequencies that do not count.
            continue;
        }
        let phase = curve.phase_deg[k];
        let radians = match options.phase_error {
            PhaseErrorUnit::Degree => phase.to_radians(),
            PhaseErrorUnit::Millisecond => 1e-3 * phase * at,
        };
        omega.push(at);
        // Model over reference, as the envelopes are defined.
        mismatch_db.push(-error_db);
        principal_deg.push(wrap(radians).to_degrees());
    }
    ranges_outside(&omega, &mismatch_db, &principal_deg)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn the_envelopes_about_a_response_are_those_of_model_over_reference() {
        let omega: Arc<[f64]> = [2.0].into();
        let curve = BodeCurve::new(CurveId::Corrected, Role::IdentifiedRepresentative);
        let drawn = [curve.with(&omega, &[-6.0].into(), &[-90.0].into())];
        let options = BodeOptions {
            shows_muad: true,
            ..BodeOptions::default()
        };
        let muad = Muad::at(2.0);
        let mut expected = Vec::new();
        for end in [0, 1] {
            for value in [-6.0 + muad.magnitude_db[end], -90.0 + muad.phase_deg[end]] {
                expected.push(Level::Sampled(vec![[2.0, value]]));
            }
        }
        let levels: Vec<Level> = muad_about(&drawn, &options)
            .into_iter()
            .map(|line| line.level)
            .collect();
        assert_eq!(levels, expected);
        assert!(
            muad_about(&drawn, &BodeOptions::default()).is_empty(),
            "optional"
        );
    }

    #[test]
    fn the_envelopes_of_magnitude_are_mirrored_among_errors() {
        let muad = Muad::at(2.0);
        let rules = muad_among_errors(&[2.0], PhaseErrorUnit::Degree);
        let levels = |pane: Pane| -> Vec<Level> {
            rules
                .iter()
                .filter(|rule| rule.pane == pane)
                .map(|rule| rule.level.clone())
                .collect()
        };
        let sampled = |value: f64| Level::Sampled(vec![[2.0, value]]);
        assert_eq!(
            levels(Pane::Magnitude),
            muad.magnitude_db.map(|db| sampled(-db))
        );
        assert_eq!(levels(Pane::Phase), muad.phase_deg.map(sampled));
    }
}
