//! Error of a physics model's response at each frequency, as used by the fit (M6):
//!
//! ```text
//! magnitude  20 log10 |H_ref| / |H_sim|  [dB]
//! phase      Delta phi  [deg], or Delta phi / omega  [ms]: phase of H_sim minus phase of H_ref
//! ```
//!
//! H_sim is the physics model's response, H_ref that of the identified reference. Both errors are
//! zero for a perfect model. The magnitude is drawn as reference over model, so that it lies about
//! G, the gain that the model lacks; the phase lies about the phase of D, the delay that it lacks.

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

/// Plots the errors used by the fit for `pairs`: for every physics model that is not rejected, and
/// for the representative before and after its correction, with G, D and the bounds.
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
        uncertainty_bands: &[],
        noticed: &noticed(&curves, options),
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
    /// Returns the errors over the band: for every physics model that is not rejected; if there are
    /// any, for the reference as the line at zero; and for the representative after each
    /// correction. `cache` keeps the computed errors until their sources change.
    pub fn error_curves(
        &self,
        pair: Pair,
        options: &BodeOptions,
        cache: &mut ErrorCache,
    ) -> Vec<BodeCurve> {
        let band = self.study.settings.band;
        let reference = self.reference_index();
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
        let mut curves = Vec::new();
        for model in self.models(BundleKind::Physics, options) {
            if !model.rejected
                && let Some(error) = &cache.errors[model.index]
            {
                let curve = self.curve_of(model);
                curves.push(error.drawn.apply(curve, &cache.omega));
            }
        }
        if !curves.is_empty() {
            for model in self.models(BundleKind::Identified, options) {
                if model.index == reference {
                    let curve = self.curve_of(model);
                    curves.push(curve.with(&cache.omega, &cache.zero, &cache.zero));
                }
            }
        }
        for corrected in self.corrected_models(pair, options) {
            let shape = if corrected.result.has_changed_physics() {
                let coupled = self
                    .curves
                    .with_couplings(corrected.result, corrected.model);
                cache.shape(&coupled)
            } else {
                cache.model_shape(corrected.model)
            };
            if let Some(shape) = shape {
                let error = shape.drawn(corrected.correction, &cache.omega, options.phase_error);
                curves.push(error.apply(corrected.curve, &cache.omega));
            }
        }
        curves
    }
}
