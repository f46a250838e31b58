//! What the bars of a condition are made of besides its swaps (M13.2).

use crate::dataset::{BundleKind, Dynamics, Pair, PairTable};
use crate::response::{coherence_at, median, quantile};
use crate::uncertainty::{BarSource, CoherenceError, IdentificationSource, Part, ReportedUncertainty, Scalar};

use super::{Analysis, ConditionAnalysis, ConditionSwaps, SwapOptimum};

/// Natural logarithm of a ratio of 1 dB.
const LN_DB: f64 = std::f64::consts::LN_10 / 20.0;
/// The figures of a condition with what its swaps and its identified representative say of them.
pub(super) fn bar_source<'a>(
    analysis: &Analysis,
    result: &ConditionAnalysis,
    swaps: &'a ConditionSwaps,
) -> BarSource<'a> {
    let figures = SwapOptimum::of(result).figures();
    let by_coherence = told_by_coherence(analysis, result);
    let by_band = told_by_band(analysis, result);
    let told = figures.map(|scalar, _| {
        let (pair, deviation): (Pair, fn(&CoherenceError) -> f64) = match scalar {
            _ if !takes_reported_error(result, scalar) => return None,
            Scalar::Gain(pair) | Scalar::NetGain(pair) => (pair, |error| error.ln_gain),
            Scalar::Delay(pair) | Scalar::BandDelay(pair) => (pair, |error| error.delay_s),
            Scalar::ChannelGain(_) | Scalar::ChannelDelay(_) => return None,
        };
        let part = |(error, degrees): (CoherenceError, f64)| Part { variance: deviation(&error).powi(2), degrees };
        let coherence = by_coherence.as_ref().and_then(|told| told[pair]).map(part);
        let band = by_band.as_ref().and_then(|told| told[pair]).map(|error| part((error, f64::INFINITY)));
        let coherence = coherence.map(|part| ReportedUncertainty { part, source: IdentificationSource::Coherence });
        let band = band.map(|part| ReportedUncertainty { part, source: IdentificationSource::ModelBand });
        coherence.or(band)
    });
    BarSource {
        figures,
        spread: &swaps.spread,
        told,
        delay_bounds_s: [result.delay_problem.bounds.lower, result.delay_problem.bounds.upper],
    }
}

/// Whether the error that the identified representative tells of itself counts for a value: for G, D and the net gains that are held
/// and matched, which are G (M13.2). The other net gains and the channels rest on the spread of the models alone: what one response's
/// error does to them is not known without that of all responses together.
pub(super) fn takes_reported_error(result: &ConditionAnalysis, scalar: Scalar) -> bool {
    let is_matched = |pair: Pair| result.held()[pair] && result.gains.unmatched.iter().all(|miss| miss.pair != pair);
    match scalar {
        Scalar::Gain(_) | Scalar::Delay(_) | Scalar::BandDelay(_) => true,
        Scalar::NetGain(pair) => is_matched(pair),
        Scalar::ChannelGain(_) | Scalar::ChannelDelay(_) => false,
    }
}

/// Whether the identified representative of a condition tells an error of its own.
pub(super) fn reports_error(analysis: &Analysis, result: &ConditionAnalysis) -> bool {
    told_by_band(analysis, result).is_some() || told_by_coherence(analysis, result).is_some()
}

/// The error of each response of the identified representative that its coherence tells, with its degrees of freedom; none where it
/// was not measured so, or coherence counts for nothing.
fn told_by_coherence(
    analysis: &Analysis,
    result: &ConditionAnalysis,
) -> Option<PairTable<Option<(CoherenceError, f64)>>> {
    let settings = &analysis.study.settings;
    let identified = &result.condition.bundle(BundleKind::Identified)[result.comparison.identified.model];
    let (Dynamics::Measured(response), Some(threshold)) = (&identified.dynamics, settings.coherence_threshold) else {
        return None;
    };
    let estimate = response.estimate();
    let measurement = settings.uncertainty.measurement(estimate.averages, estimate.window_s)?;
    let coherence = coherence_at(response, &analysis.omega)?;
    Some(coherence.map(|_, coherence| {
        let error = measurement.error(&analysis.omega, coherence, threshold)?;
        Some((error, measurement.degrees()))
    }))
}

/// The error of each response of the identified representative that its own band tells: medians over the band of comparison. Its
/// deviations are taken as known.
fn told_by_band(analysis: &Analysis, result: &ConditionAnalysis) -> Option<PairTable<Option<CoherenceError>>> {
    let identified = &result.condition.bundle(BundleKind::Identified)[result.comparison.identified.model];
    let bands = identified.bands.as_ref()?;
    let band = analysis.study.settings.band;
    let inside = |omega: &f64| (band.min()..=band.max()).contains(omega);
    let omega = bands.omega();
    Some(bands.sd_db().map(|pair, sd_db| {
        let within = |values: &[f64], of: &dyn Fn(f64, f64) -> f64| -> Option<f64> {
            let values = omega.iter().zip(values).filter(|(omega, _)| inside(omega));
            let mut values: Vec<f64> = values.map(|(omega, value)| of(*omega, *value)).collect();
            (!values.is_empty()).then(|| median(&mut values))
        };
        let ln_gain = within(sd_db, &|_, sd_db| LN_DB * sd_db)?;
        let delay_s = within(&bands.sd_deg()[pair], &|omega, sd_deg| sd_deg.to_radians() / omega)?;
        Some(CoherenceError { ln_gain, delay_s })
    }))
}

/// `(Q84 - Q16) / 2` of `ln |H_ref| / |H_sim|` over the band.
pub(super) fn left_in_band(result: &ConditionAnalysis) -> PairTable<Option<f64>> {
    result.comparison.representative.mismatch.map(|_, mismatch| {
        let mut errors: Vec<f64> = mismatch.as_ref()?.magnitude_db.clone();
        let width = quantile(&mut errors, 0.84) - quantile(&mut errors, 0.16);
        Some(0.5 * LN_DB * width)
    })
}
