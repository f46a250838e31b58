//! Deviation of a response from its reference at each frequency, as used by the fit (M6).
//!
//! ```text
//! magnitude  20 log10 |H_ref| / |H_sim|  [dB]
//! phase      Delta phi  [deg], or Delta phi / omega  [ms]: phase of H_sim minus phase of H_ref
//! ```
//!
//! H_sim is the response of a physics model, H_ref of the identified reference. Both deviations are
//! zero for a perfect model; G and D are the gain and the delay that the model lacks.

use std::sync::Arc;

use gdcm_model::dataset::{BundleKind, Pair};

pub use super::error_cache::ErrorCache;
pub use super::muad::{muad_about, noticed};

use super::axis::{Axis, PhaseErrorUnit};
use super::bode_curve::{BodeCurve, Pane};
use super::bode_options::BodeOptions;
use super::condition_source::ConditionSource;
use super::error_cache::{ErrorKey, ErrorSource};
use super::figure::{Figure, Plot};
use super::frequency_panels::{FrequencyPanels, figure_of_pairs};

/// Plots the deviations used by the fit for `pairs`: for every kept physics model, and for the
/// representative before and after its correction, with G, D and the bounds.
pub fn error_figure(source: &ConditionSource<'_>, pairs: &[Pair], options: &BodeOptions) -> Figure {
    figure_of_pairs(source, pairs, Some("Error"), |pair| {
        error_plot(source, pair, options)
    })
}

fn error_plot(source: &ConditionSource<'_>, pair: Pair, options: &BodeOptions) -> Plot {
    let curves = source.error_curves(pair, options, &mut ErrorCache::default());
    let panels = FrequencyPanels {
        curves: &curves,
        references: &source.error_references(pair, options, &curves),
        bands: &[],
        strips: &noticed(&curves, options),
        options,
    };
    let ratio = Axis::linear("|ident.| / |model| [dB]")
        .including(0.0)
        .at_least(1.0)
        .showing(options.values[0]);
    let phase = match options.phase_error {
        PhaseErrorUnit::Degree => Axis::degrees("Δφ [deg]"),
        PhaseErrorUnit::Millisecond => Axis::linear("Δφ/ω [ms]"),
    };
    let phase = phase
        .including(0.0)
        .at_least(5.0)
        .showing(options.values[1]);
    Plot::default()
        .panel(panels.panel(Pane::Magnitude, ratio))
        .panel(panels.panel(Pane::Phase, phase))
}

impl ConditionSource<'_> {
    /// Returns the deviations over the band: for every kept physics model, for the reference as the
    /// line at zero, and for the representative after each correction. `cache` keeps the computed
    /// deviations until their sources change.
    pub fn error_curves(
        &self,
        pair: Pair,
        options: &BodeOptions,
        cache: &mut ErrorCache,
    ) -> Vec<BodeCurve> {
        let band = self.study.settings.band;
        let reference = self.reference();
        cache.refresh(ErrorSource {
            curves: Arc::clone(self.curves),
            key: ErrorKey {
                pair,
                reference,
                band: [band.min(), band.max()],
                least_coherence: self.study.settings.coherence_threshold,
                unit: options.phase_error,
            },
        });
        let mut drawn = Vec::new();
        for model in self.models(BundleKind::Physics, options) {
            if !model.rejected
                && let Some(error) = &cache.errors[model.index]
            {
                let curve = self.curve_of(model);
                drawn.push(error.drawn.apply(curve, &cache.omega));
            }
        }
        if !drawn.is_empty() {
            for model in self.models(BundleKind::Identified, options) {
                if model.index == reference {
                    let curve = self.curve_of(model);
                    drawn.push(curve.with(&cache.omega, &cache.zero, &cache.zero));
                }
            }
        }
        for corrected in self.corrected_models(pair, options) {
            let shape = match &corrected.result.coupled {
                Some(_) => {
                    let curves = self.curves;
                    let coupled = curves.with_couplings(corrected.result, corrected.model);
                    cache.shape(&coupled)
                }
                None => cache.model_shape(corrected.model),
            };
            if let Some(shape) = shape {
                let error = shape.drawn(corrected.correction, &cache.omega, options.phase_error);
                drawn.push(error.apply(corrected.curve, &cache.omega));
            }
        }
        drawn
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
