//! Substitution of other models of the bundles for the representatives, one at a time (M13.1).

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::correction::ChannelCorrection;
use gdcm_method::correction::delta::{Delta, GainSource};
use gdcm_method::uncertainty::spread::{
    BarSource, CoherenceError, ConditionSpread, Figures, ReportedUncertainty, ScalarTable,
};
use gdcm_method::uncertainty::{IdentificationSource, Scalar, VarianceComponent};
use gdcm_model::dataset::{BundleKind, Dynamics, Pair, PairTable};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::curve_values::coherence_at;
use gdcm_model::statistics::{median, quantile};

use super::comparison::{Compared, Mismatches};
use super::condition_responses::ConditionResponses;
use super::condition_stages::Run;
use super::fitted_couplings::FittedCouplings;
use crate::decisions::settings::Settings;
use crate::decisions::study::Study;
use crate::results::analysis::{Analysis, ConditionAnalysis};

/// Results of the substitutions of one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionSubstitutions {
    /// Spread of the figures.
    pub spread: ConditionSpread,
    /// Figures of each substitution, with the bundle and the index of the substituted model; `None`
    /// where it could not be analysed.
    pub substitutions: Vec<Swap>,
}

/// A substituted model, with the figures of the resulting correction.
pub type Swap = (BundleKind, usize, Option<Arc<Figures>>);

/// Inputs of substitutions.
#[derive(Clone, Copy)]
pub(crate) struct Substituting<'a> {
    pub(crate) run: Run<'a>,
    pub(crate) analysis: &'a ConditionAnalysis,
    pub(crate) responses: &'a ConditionResponses,
    pub(crate) couplings: Option<&'a Arc<FittedCouplings>>,
}

/// Result of a substitution: the correction, its G, and both D \[s\].
#[derive(Clone, Debug)]
pub(crate) struct SubstitutedOptimum {
    pub(crate) correction: ChannelCorrection,
    /// The deltas, with G after the leads.
    pub(crate) delta: Delta,
}

impl SubstitutedOptimum {
    /// Returns the result of the representatives themselves.
    pub(crate) fn of(analysis: &ConditionAnalysis) -> Self {
        let delta = Delta {
            gain: analysis.gain_problem.delta.clone(),
            ..analysis.comparison.delta.clone()
        };
        Self {
            correction: analysis.correction.clone(),
            delta,
        }
    }

    /// Returns the logarithms of gains, and delays \[s\]; `None` where a figure is not defined.
    pub(crate) fn figures(&self) -> Figures {
        let Self {
            correction,
            delta:
                Delta {
                    gain,
                    delay_s,
                    band_delay_s,
                },
        } = self;
        ScalarTable::from_fn(gain.outputs(), gain.inputs(), |scalar| {
            let figure = match scalar {
                Scalar::Gain(pair) => gain[pair]?.ln(),
                Scalar::Delay(pair) => delay_s[pair]?,
                Scalar::BandDelay(pair) => band_delay_s[pair]?,
                Scalar::NetGain(pair) => correction.net_gain(pair).ln(),
                Scalar::ChannelGain(channel) => correction.gain(channel).ln(),
                Scalar::ChannelDelay(channel) => correction.delay_s(channel),
            };
            figure.is_finite().then_some(figure)
        })
    }
}

/// Dependencies of a substitution besides the two models: the settings of the analysis, the
/// representatives as the reference of phase branches, and the couplings.
type SwapKey = (
    Settings,
    PairTable<bool>,
    [usize; 2],
    Option<Arc<FittedCouplings>>,
);

/// The last substitutions, by physics and identified model: rejecting or restoring a model keeps
/// those of the others.
#[derive(Clone, Debug, Default)]
pub(crate) struct SubstitutionMemo {
    key: Option<SwapKey>,
    kept: BTreeMap<[usize; 2], Option<Arc<Figures>>>,
}

impl Substituting<'_> {
    fn representatives(&self) -> [usize; 2] {
        [
            self.analysis.comparison.physics.model,
            self.analysis.comparison.identified.model,
        ]
    }

    /// Returns the other kept models of a bundle, in file order, without models set aside (M5b).
    /// Duplicate models count once, because they add no information; copies of the representative
    /// count where there are no others.
    fn others(&self, kind: BundleKind) -> Vec<usize> {
        let representative = self.analysis.representative(kind);
        let scores = representative.scores.iter().enumerate();
        let kept =
            scores.filter(|(model, score)| score.is_some() && *model != representative.model);
        let responses = self.responses.bundle(kind);
        let mut distinct = Vec::new();
        // Models with the same numbers share their response.
        let is_copy = |a: usize, b: usize| Arc::ptr_eq(&responses[a], &responses[b]);
        let mut copies = Vec::new();
        for (model, _) in kept {
            if is_copy(model, representative.model) {
                copies.push(model);
            } else if !distinct.iter().any(|&known| is_copy(known, model)) {
                distinct.push(model);
            }
        }
        copies.truncate(1);
        if distinct.is_empty() {
            copies
        } else {
            distinct
        }
    }

    /// Returns the settings that a substitution depends on.
    fn key(&self) -> SwapKey {
        let Study {
            settings, dataset, ..
        } = self.run.study;
        let mut settings = settings.clone();
        settings.schedule = Default::default();
        settings.schedule_delays = Default::default();
        settings.uncertainty = Default::default();
        settings.gain_source = GainSource::Representatives;
        (
            settings,
            dataset.measuring_pairs(),
            self.representatives(),
            self.couplings.cloned(),
        )
    }

    fn compared(&self, kind: BundleKind, model: usize) -> Compared {
        let coherence = self.run.study.settings.coherence_threshold;
        Compared::of(
            &self.analysis.condition,
            self.responses,
            (kind, model),
            (self.run.grid, coherence),
        )
    }
}

impl SubstitutionMemo {
    /// Completes all substitutions; those not cached are computed, each a step, with the correction
    /// that `optimum` returns for a comparison.
    pub(crate) fn complete(
        &mut self,
        substituting: &Substituting<'_>,
        optimum: impl Fn(&Mismatches, Delta) -> Result<Option<SubstitutedOptimum>, Cancelled> + Sync,
    ) -> Result<ConditionSubstitutions, Cancelled> {
        let key = substituting.key();
        if self.key.as_ref() != Some(&key) {
            *self = Self {
                key: Some(key),
                kept: BTreeMap::new(),
            };
        }
        let of_bundle = |kind| {
            substituting
                .others(kind)
                .into_iter()
                .map(move |model| (kind, model))
        };
        let swaps: Vec<(BundleKind, usize)> =
            BundleKind::BOTH.into_iter().flat_map(of_bundle).collect();
        let [physics, identified] = substituting.representatives();
        let models =
            |&(kind, model): &(BundleKind, usize)| kind.pick([model, identified], [physics, model]);
        // The mean over all pairs is not a figure of the representatives: the reference of the
        // changes is computed too.
        let Run {
            study, execution, ..
        } = substituting.run;
        let base = (study.settings.gain_source == GainSource::MeanOfPairs)
            .then_some([physics, identified]);
        let wanted = swaps.iter().map(models).chain(base);
        let missing: Vec<[usize; 2]> = wanted
            .filter(|pair| !self.kept.contains_key(pair))
            .collect();
        execution.step(swaps.len().saturating_sub(missing.len()));
        let made = make(substituting, &missing, optimum)?;
        self.kept.extend(missing.into_iter().zip(made));
        let kept = |pair: [usize; 2]| self.kept.get(&pair).cloned().flatten();
        let substitutions: Vec<_> = swaps
            .iter()
            .map(|swap| (swap.0, swap.1, kept(models(swap))))
            .collect();
        let figures = |kind| -> Vec<Option<&Figures>> {
            substitutions
                .iter()
                .filter(|of| of.0 == kind)
                .map(|of| of.2.as_deref())
                .collect()
        };
        let base = match base {
            None => SubstitutedOptimum::of(substituting.analysis).figures(),
            Some(pair) => match kept(pair) {
                Some(base) => Figures::clone(&base),
                None => SubstitutedOptimum::of(substituting.analysis)
                    .figures()
                    .map(|_, _| None),
            },
        };
        let spread = ConditionSpread::of(
            &base,
            &figures(BundleKind::Physics),
            &figures(BundleKind::Identified),
        );
        Ok(ConditionSubstitutions {
            spread,
            substitutions,
        })
    }
}

/// Computes the figures of each of these pairs of models.
fn make(
    substituting: &Substituting<'_>,
    pairs: &[[usize; 2]],
    optimum: impl Fn(&Mismatches, Delta) -> Result<Option<SubstitutedOptimum>, Cancelled> + Sync,
) -> Result<Vec<Option<Arc<Figures>>>, Cancelled> {
    if pairs.is_empty() {
        return Ok(Vec::new());
    }
    let base = &substituting.analysis.comparison;
    let [physics, identified] = substituting.representatives();
    let simulated = substituting.compared(BundleKind::Physics, physics);
    let reference = substituting.compared(BundleKind::Identified, identified);
    let omega = substituting.run.grid.omega();
    let median_phases = base.representative.mismatch.map(|_, mismatch| {
        mismatch
            .as_ref()
            .map(|mismatch| mismatch.median_phase(omega))
    });
    let substitution = |place: usize| {
        let [a, b] = pairs[place];
        let other;
        let (simulated, reference) = if b == identified {
            other = substituting.compared(BundleKind::Physics, a);
            (&other, &reference)
        } else {
            other = substituting.compared(BundleKind::Identified, b);
            (&simulated, &other)
        };
        let mut mismatch = simulated.against(reference);
        // As with the pair pinned: each phase difference is on the branch nearest to that of the
        // representatives (M13.1).
        for (pair, entry) in mismatch.iter_mut() {
            *entry = entry.take().map(|entry| match median_phases[pair] {
                Some(median_phase) => entry.align_branch(omega, median_phase),
                None => entry,
            });
        }
        let delta = Delta::new(&mismatch, omega);
        // As for a pinned pair without comparable responses.
        if delta.gain.iter().all(|(_, gain)| gain.is_none()) {
            return Ok(None);
        }
        Ok(optimum(&mismatch, delta)?.map(|optimum| Arc::new(optimum.figures())))
    };
    substituting
        .run
        .execution
        .each(pairs.len(), 1, substitution)?
        .into_iter()
        .collect()
}

/// Natural logarithm of a ratio of 1 dB.
const LN_DB: f64 = std::f64::consts::LN_10 / 20.0;
/// Collects the figures of a condition with the spread of its substitutions and the errors reported
/// by its identified representative.
pub(crate) fn bar_source<'a>(
    analysis: &Analysis,
    result: &ConditionAnalysis,
    substitutions: &'a ConditionSubstitutions,
) -> BarSource<'a> {
    let figures = SubstitutedOptimum::of(result).figures();
    let by_coherence = told_by_coherence(analysis, result);
    let by_band = told_by_band(analysis, result);
    let told = figures.map(|scalar, _| {
        let (pair, deviation): (Pair, fn(&CoherenceError) -> f64) = match scalar {
            _ if !takes_reported_error(result, scalar) => return None,
            Scalar::Gain(pair) | Scalar::NetGain(pair) => (pair, |error| error.ln_gain),
            Scalar::Delay(pair) | Scalar::BandDelay(pair) => (pair, |error| error.delay_s),
            Scalar::ChannelGain(_) | Scalar::ChannelDelay(_) => return None,
        };
        let part = |(error, degrees): (CoherenceError, f64)| VarianceComponent {
            variance: deviation(&error).powi(2),
            degrees_of_freedom: degrees,
        };
        let coherence = by_coherence.as_ref().and_then(|told| told[pair]).map(part);
        let band = by_band
            .as_ref()
            .and_then(|told| told[pair])
            .map(|error| part((error, f64::INFINITY)));
        let coherence = coherence.map(|part| ReportedUncertainty {
            part,
            source: IdentificationSource::Coherence,
        });
        let band = band.map(|part| ReportedUncertainty {
            part,
            source: IdentificationSource::ModelBand,
        });
        coherence.or(band)
    });
    BarSource {
        figures,
        spread: &substitutions.spread,
        reported: told,
        delay_bounds_s: [
            result.delay_problem.bounds.lower,
            result.delay_problem.bounds.upper,
        ],
    }
}

/// Returns whether the error that the identified representative reports applies to a value: to G, D
/// and the constrained, matched net gains, which equal G (M13.2). The other net gains and the
/// channels rely on the spread of the models alone: the effect of one response's error on them is
/// unknown without the errors of all responses together.
pub(crate) fn takes_reported_error(result: &ConditionAnalysis, scalar: Scalar) -> bool {
    let is_matched = |pair: Pair| {
        result.held()[pair] && result.gains.unmatched.iter().all(|miss| miss.pair != pair)
    };
    match scalar {
        Scalar::Gain(_) | Scalar::Delay(_) | Scalar::BandDelay(_) => true,
        Scalar::NetGain(pair) => is_matched(pair),
        Scalar::ChannelGain(_) | Scalar::ChannelDelay(_) => false,
    }
}

/// Returns whether the identified representative of a condition reports an error of its own.
pub(crate) fn reports_error(analysis: &Analysis, result: &ConditionAnalysis) -> bool {
    told_by_band(analysis, result).is_some() || told_by_coherence(analysis, result).is_some()
}

/// Returns the error of each response of the identified representative from its coherence, with its
/// degrees of freedom; `None` where it was measured without coherence, or coherence is not used.
fn told_by_coherence(
    analysis: &Analysis,
    result: &ConditionAnalysis,
) -> Option<PairTable<Option<(CoherenceError, f64)>>> {
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
        let error = measurement.error(&analysis.omega, coherence, threshold)?;
        Some((error, measurement.degrees_of_freedom()))
    }))
}

/// Returns the error of each response of the identified representative from its own bands: medians
/// over the band of comparison. Its deviations are taken as known.
fn told_by_band(
    analysis: &Analysis,
    result: &ConditionAnalysis,
) -> Option<PairTable<Option<CoherenceError>>> {
    let identified = result.representative_model(BundleKind::Identified);
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
        let delay_s = within(&bands.sd_deg()[pair], &|omega, sd_deg| {
            sd_deg.to_radians() / omega
        })?;
        Some(CoherenceError { ln_gain, delay_s })
    }))
}

/// Returns `(Q84 - Q16) / 2` of `ln |H_ref| / |H_sim|` over the band.
pub(crate) fn left_in_band(result: &ConditionAnalysis) -> PairTable<Option<f64>> {
    result
        .comparison
        .representative
        .mismatch
        .map(|_, mismatch| {
            let mut errors: Vec<f64> = mismatch.as_ref()?.magnitude_db.clone();
            let width = quantile(&mut errors, 0.84) - quantile(&mut errors, 0.16);
            Some(0.5 * LN_DB * width)
        })
}
