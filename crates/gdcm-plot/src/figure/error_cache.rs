//! Errors of physics models' responses at each frequency, computed once and kept until their
//! sources change. H_sim is a physics model's response, H_ref that of the identified reference. If
//! coherence is ignored, all frequencies *count*; otherwise those in the reference's valid band at
//! which its coherence reaches the minimum in the settings (M4a).
//!
//! The *branch* of a phase is the number of whole turns at each frequency, chosen in M6b so that
//! the phase follows a delay.

use std::sync::Arc;

use gdcm_method::fidelity::{CoherenceWeights, Mismatch};
use gdcm_model::dataset::{BundleKind, Pair};
use gdcm_model::response::polar_response::PolarCurve;
use gdcm_model::response::{FrequencyResponse, GainDelay};
use gdcm_model::units::s_to_ms;
use gdcm_study::stages::condition_curves::ConditionCurves;

use super::axis::PhaseErrorUnit;
use super::bode_curve::BodeCurve;

/// Error of a response against the reference, with the phase on the branch chosen in M6b.
#[derive(Clone, Debug)]
pub(super) struct ErrorShape {
    /// `20 log10 |H_sim| / |H_ref|`: the inverse of the drawn ratio, so that a correction of H_sim
    /// adds its own magnitude.
    mismatch_db: Vec<f64>,
    /// `Delta phi(H_sim, H_ref)` \[rad\] (M3, M6b): never the difference between two separately
    /// unwrapped phases.
    phase: Vec<f64>,
}

/// Error in the units in which it is drawn.
#[derive(Clone, Debug)]
pub(super) struct DrawnError {
    /// `20 log10 |H_ref| / |H_sim|`.
    magnitude_db: Arc<[f64]>,
    /// `Delta phi` \[deg\] or `Delta phi / omega` \[ms\].
    phase: Arc<[f64]>,
}

impl DrawnError {
    /// Returns the curve with these values over `omega` \[rad/s\].
    pub(super) fn apply(&self, curve: BodeCurve, omega: &Arc<[f64]>) -> BodeCurve {
        curve.with(omega, &self.magnitude_db, &self.phase)
    }
}

impl ErrorShape {
    /// Computes the error at the frequencies that count; NaN at the others (M4a). `None` if no
    /// frequency counts.
    fn new(
        simulated: &PolarCurve,
        reference: &PolarCurve,
        omega: &[f64],
        coherence_weights: Option<&CoherenceWeights>,
    ) -> Option<Self> {
        let mismatch = Mismatch::new(simulated, reference).coherence_weighted(coherence_weights)?;
        let phase = mismatch.on_grid(mismatch.phase_difference(omega), omega.len());
        Some(Self {
            phase,
            mismatch_db: mismatch.on_grid(mismatch.magnitude_db.clone(), omega.len()),
        })
    }

    /// Returns the error, as drawn over `omega` \[rad/s\], after the correction is applied to
    /// the simulated response (M10); the phase stays on its branch.
    pub(super) fn drawn(
        &self,
        correction: GainDelay,
        omega: &[f64],
        unit: PhaseErrorUnit,
    ) -> DrawnError {
        let magnitude_db = correction
            .magnitudes_db(&self.mismatch_db, omega)
            .map(|db| -db)
            .collect();
        let phases = correction.phases(&self.phase, omega);
        let phase = match unit {
            PhaseErrorUnit::Degree => phases.map(f64::to_degrees).collect(),
            PhaseErrorUnit::Millisecond => phases
                .zip(omega)
                .map(|(phase, omega)| s_to_ms(phase / omega))
                .collect(),
        };
        DrawnError {
            magnitude_db,
            phase,
        }
    }
}

/// Choices that determine a response's errors.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ErrorKey {
    pub(super) pair: Pair,
    /// Index of the identified model that serves as the reference.
    pub(super) reference: usize,
    /// Band ends \[rad/s\].
    pub(super) band: [f64; 2],
    /// Minimum coherence at which a frequency counts; `None` if coherence is ignored.
    pub(super) least_coherence: Option<f64>,
    pub(super) unit: PhaseErrorUnit,
}

/// Responses and choices from which an error is computed.
#[derive(Clone, Debug)]
pub(super) struct ErrorSource {
    pub(super) curves: Arc<ConditionCurves>,
    pub(super) key: ErrorKey,
}

impl ErrorSource {
    fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.curves, &other.curves) && self.key == other.key
    }

    /// Computes a response's error over `omega`, the frequencies in the band. `None` if the
    /// response or the reference is zero or not finite at any of them, or if no frequency counts
    /// (M4a).
    pub(super) fn shape(&self, response: &FrequencyResponse, omega: &[f64]) -> Option<ErrorShape> {
        let reference = self.polar(self.curves.identified.get(self.key.reference)?)?;
        ErrorShape::new(
            &self.polar(response)?,
            &reference,
            omega,
            self.coherence_weights(omega).as_ref(),
        )
    }

    /// Returns a response in the band; `None` if it is zero or not finite at any frequency there.
    fn polar(&self, response: &FrequencyResponse) -> Option<PolarCurve> {
        PolarCurve::from_values(response.curve(self.key.pair).get(self.band_indices())?)
    }

    /// Returns weights for the frequencies `omega`, derived from the reference's coherence; `None`
    /// if it has no coherence or coherence is ignored.
    fn coherence_weights(&self, omega: &[f64]) -> Option<CoherenceWeights> {
        let identified = self.curves.condition.bundle(BundleKind::Identified);
        let flight = &identified.get(self.key.reference)?.dynamics;
        let weights = CoherenceWeights::of_model(flight, omega, self.key.least_coherence)?;
        Some(weights[self.key.pair].clone())
    }

    /// Returns the indices of the frequencies in the band.
    fn band_indices(&self) -> std::ops::Range<usize> {
        let omega = self.curves.grid.omega();
        let [min, max] = self.key.band;
        let first = omega.partition_point(|omega| *omega < min);
        let end = omega.partition_point(|omega| *omega <= max);
        first..end
    }
}

/// Error before correction, for one physics model.
#[derive(Debug)]
pub(super) struct ModelError {
    shape: ErrorShape,
    pub(super) drawn: DrawnError,
}

/// A response's errors for every physics model in a condition, kept until their source changes.
#[derive(Debug, Default)]
pub struct ErrorCache {
    source: Option<ErrorSource>,
    pub(super) omega: Arc<[f64]>,
    /// Zero at each frequency: the reference's error from itself.
    pub(super) zero: Arc<[f64]>,
    /// Errors of the physics models before correction, in bundle order; `None` for a model
    /// without an error.
    pub(super) errors: Vec<Option<ModelError>>,
}

impl ErrorCache {
    pub(super) fn refresh(&mut self, source: ErrorSource) {
        if let Some(known) = &self.source
            && known.is_same(&source)
        {
            return;
        }
        self.omega = source.curves.grid.omega()[source.band_indices()].into();
        self.zero = vec![0.0; self.omega.len()].into();
        self.errors.clear();
        for response in &source.curves.physics {
            let error = source.shape(response, &self.omega).map(|shape| ModelError {
                drawn: shape.drawn(GainDelay::NONE, &self.omega, source.key.unit),
                shape,
            });
            self.errors.push(error);
        }
        self.source = Some(source);
    }

    /// Returns a physics model's error before correction; `None` if it has none.
    pub(super) fn model_shape(&self, model: usize) -> Option<ErrorShape> {
        let error = self.errors[model].as_ref()?;
        Some(error.shape.clone())
    }

    /// Computes the error of a response that is not in the cache; `None` as for
    /// [`ErrorSource::shape`], or if the cache is empty.
    pub(super) fn shape(&self, response: &FrequencyResponse) -> Option<ErrorShape> {
        self.source.as_ref()?.shape(response, &self.omega)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use gdcm_model::response::wrap;

    use super::*;

    /// Returns a response with a constant gain \[dB\] and a constant lead \[s\].
    fn polar(omega: &[f64], gain_db: f64, lead_s: f64) -> PolarCurve {
        PolarCurve {
            magnitude_db: vec![gain_db; omega.len()],
            phase: omega.iter().map(|omega| wrap(omega * lead_s)).collect(),
        }
    }

    #[test]
    fn the_right_gain_and_delay_bring_an_error_to_zero_on_its_branch() {
        // At 12 rad/s, a lead of 0.6 s is 1.15 turns: the individual phases wrap.
        let omega: Vec<f64> = (1..=120).map(|k| 0.1 * f64::from(k)).collect();
        let simulated = polar(&omega, 2.0, 0.6);
        let reference = polar(&omega, 0.0, 0.0);
        let error = ErrorShape::new(&simulated, &reference, &omega, None).unwrap();
        let before = error.drawn(GainDelay::NONE, &omega, PhaseErrorUnit::Millisecond);
        // Tolerance for rounding errors of angles of several turns, divided by 0.1 rad/s.
        assert!(
            before
                .phase
                .iter()
                .all(|delay| (delay - 600.0).abs() < 1e-9)
                && omega[119] * 0.6 > TAU
        );
        assert_eq!(
            before.magnitude_db[0], -2.0,
            "the gain of the model is to be reduced"
        );
        let after = error.drawn(
            GainDelay::new(10f64.powf(-0.1), 0.6),
            &omega,
            PhaseErrorUnit::Degree,
        );
        let values = after.magnitude_db.iter().chain(after.phase.iter());
        assert!(values.into_iter().all(|value| value.abs() < 1e-10));
    }

    #[test]
    fn frequencies_that_do_not_count_are_gaps() {
        let omega = [1.0, 2.0, 3.0];
        let polar = PolarCurve {
            magnitude_db: vec![1.0; 3],
            phase: vec![0.1; 3],
        };
        let coherence_weights = CoherenceWeights::select(&omega, &[0.9, 0.2, 0.9], 0.6, None);
        let shape = ErrorShape::new(&polar, &polar, &omega, Some(&coherence_weights)).unwrap();
        assert!(shape.mismatch_db[1].is_nan() && shape.phase[1].is_nan());
        assert_eq!((shape.mismatch_db[0], shape.phase[2]), (0.0, 0.0));
        let nothing = CoherenceWeights::select(&omega, &[0.0; 3], 0.6, None);
        assert!(ErrorShape::new(&polar, &polar, &omega, Some(&nothing)).is_none());
    }
}
