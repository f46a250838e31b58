//! The identified representative's standard errors, from its coherence or its standard deviations
//! (M13.2).
//!
//! A representative is the model that stands for its bundle. A measured response carries coherence,
//! from which the errors of `ln G` and D follow; an identified model carries the standard
//! deviations of its response over frequency ([`ModelBands`]). G is the gain and D the delay that
//! would match a response (M6).

use gdcm_method::uncertainty::coherence_error::CoherenceError;
use gdcm_method::uncertainty::condition_bars::ReportedUncertainty;
use gdcm_method::uncertainty::{IdentificationSource, Scalar, VarianceComponent};
use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{Band, BundleKind, Dynamics, Pair, PairTable};
use gdcm_model::response::interpolation::coherence_at;
use gdcm_model::statistics::median;

use super::analysis::{Analysis, ConditionAnalysis};

/// 1 dB as a difference between natural logarithms.
pub(crate) const LN_DB: f64 = std::f64::consts::LN_10 / 20.0;

/// A response's standard errors, with their degrees of freedom.
#[derive(Clone, Copy)]
struct ReportedError {
    error: CoherenceError,
    degrees_of_freedom: f64,
}

/// Standard errors for an identified representative's responses, by source.
pub(crate) struct ReportedErrors {
    by_coherence: Option<PairTable<Option<ReportedError>>>,
    by_deviations: Option<PairTable<Option<ReportedError>>>,
}

impl ReportedErrors {
    /// Collects the standard errors for a condition's identified representative.
    pub(crate) fn new(analysis: &Analysis, result: &ConditionAnalysis) -> Self {
        Self {
            by_coherence: errors_by_coherence(analysis, result),
            by_deviations: errors_by_deviations(analysis, result),
        }
    }

    /// Returns the standard error in a gain or delay: from coherence where available, otherwise
    /// from the model's standard deviations. `None` if neither is available, or if the error does
    /// not enter the value's error bar ([`takes_reported_error`]).
    pub(crate) fn of_scalar(
        &self,
        result: &ConditionAnalysis,
        scalar: Scalar,
    ) -> Option<ReportedUncertainty> {
        if !takes_reported_error(result, scalar) {
            return None;
        }
        let (pair, is_gain) = match scalar {
            Scalar::Gain(pair) | Scalar::NetGain(pair) => (pair, true),
            Scalar::Delay(pair) | Scalar::BandDelay(pair) => (pair, false),
            Scalar::ChannelGain(_) | Scalar::ChannelDelay(_) => return None,
        };
        let by_coherence = self.by_coherence.as_ref().and_then(|errors| errors[pair]);
        let by_deviations = self.by_deviations.as_ref().and_then(|errors| errors[pair]);
        let (reported, source) = match (by_coherence, by_deviations) {
            (Some(reported), _) => (reported, IdentificationSource::Coherence),
            (None, Some(reported)) => (reported, IdentificationSource::ModelBand),
            (None, None) => return None,
        };
        let deviation = if is_gain {
            reported.error.ln_gain
        } else {
            reported.error.delay_s
        };
        Some(ReportedUncertainty {
            part: VarianceComponent {
                variance: deviation.powi(2),
                degrees_of_freedom: reported.degrees_of_freedom,
            },
            source,
        })
    }
}

/// Returns whether the identified representative's standard error enters a value's error bar.
///
/// It enters for G, D and the net gains that are constrained and matched, which equal G (M13.2).
/// For other net gains and for channels only the spread among the models counts: the effect of a
/// single response's standard error on them is unknown without the joint errors of all responses.
pub fn takes_reported_error(result: &ConditionAnalysis, scalar: Scalar) -> bool {
    match scalar {
        Scalar::Gain(_) | Scalar::Delay(_) | Scalar::BandDelay(_) => true,
        Scalar::NetGain(pair) => {
            result.held()[pair] && result.gains.unmatched.iter().all(|miss| miss.pair != pair)
        }
        Scalar::ChannelGain(_) | Scalar::ChannelDelay(_) => false,
    }
}

/// Returns whether a condition's identified representative has standard errors, from its standard
/// deviations or from its coherence.
pub fn reports_error(analysis: &Analysis, result: &ConditionAnalysis) -> bool {
    errors_by_deviations(analysis, result).is_some()
        || errors_by_coherence(analysis, result).is_some()
}

/// Returns the identified representative's standard errors from its coherence; `None` where
/// coherence or the number of averages is not available, or coherence is not used.
fn errors_by_coherence(
    analysis: &Analysis,
    result: &ConditionAnalysis,
) -> Option<PairTable<Option<ReportedError>>> {
    let settings = &analysis.study.settings;
    let identified = result.representative_model(BundleKind::Identified);
    let (Dynamics::Measured(response), Some(threshold)) =
        (&identified.dynamics, settings.coherence_threshold)
    else {
        return None;
    };
    let estimate = response.estimate();
    let measurement = settings
        .uncertainty
        .measurement(estimate.averages, estimate.window_s)?;
    let coherence = coherence_at(response, &analysis.omega)?;
    Some(coherence.map(|_, coherence| {
        Some(ReportedError {
            error: measurement.error(&analysis.omega, coherence, threshold)?,
            degrees_of_freedom: measurement.degrees_of_freedom(),
        })
    }))
}

/// Returns the identified representative's standard errors from its model's standard deviations:
/// medians over the comparison band; no response has any if the deviations have no frequency in the
/// band.
fn errors_by_deviations(
    analysis: &Analysis,
    result: &ConditionAnalysis,
) -> Option<PairTable<Option<ReportedError>>> {
    let identified = result.representative_model(BundleKind::Identified);
    let deviations = identified.bands.as_ref()?;
    let inside = places_in_band(deviations, analysis.study.settings.band);
    Some(deviations.sd_db().map(|pair: Pair, sd_db| {
        if inside.is_empty() {
            return None;
        }
        let sd_deg = &deviations.sd_deg()[pair];
        let mut ln_gains: Vec<f64> = inside.iter().map(|place| LN_DB * sd_db[*place]).collect();
        let mut delays_s: Vec<f64> = inside
            .iter()
            .map(|place| sd_deg[*place].to_radians() / deviations.omega()[*place])
            .collect();
        Some(ReportedError {
            error: CoherenceError {
                ln_gain: median(&mut ln_gains),
                delay_s: median(&mut delays_s),
            },
            // The standard deviations are treated as exact.
            degrees_of_freedom: f64::INFINITY,
        })
    }))
}

/// Returns the indices of the frequencies inside a band.
fn places_in_band(deviations: &ModelBands, band: Band) -> Vec<usize> {
    let mut inside = Vec::new();
    for (place, omega) in deviations.omega().iter().enumerate() {
        if (band.min()..=band.max()).contains(omega) {
            inside.push(place);
        }
    }
    inside
}
