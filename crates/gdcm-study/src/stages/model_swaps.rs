//! Swaps: another model of the bundle replaces a representative (M13.1).
//!
//! ```text
//! 1  replacing models: the other kept models of each bundle, copies counted once
//! 2  for each replacement that is not cached: mismatch of the new pair on the phase branch of the
//!    representatives, its G and D, and the optimal correction
//! 3  base: the results of the representatives, to which the results of the swaps are compared
//! 4  spread of the results over the swaps of each bundle
//! ```
//!
//! "Figures" are a model pair's gains, as logarithms, and its delays \[s\]. A phase difference is
//! known up to whole turns; its *branch* is the number of turns chosen (M3).

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::correction::ChannelCorrection;
use gdcm_method::correction::delta::{Delta, GainSource};
use gdcm_method::uncertainty::Scalar;
use gdcm_method::uncertainty::scalar::{Figures, ScalarTable};
use gdcm_method::uncertainty::spread::ConditionSpread;
use gdcm_model::dataset::{BundleKind, PairTable};
use gdcm_model::progress::Cancelled;

use super::compared_model::ComparedModel;
use super::condition_responses::ConditionResponses;
use super::run::Run;
use crate::decisions::settings::Settings;
use crate::results::analysis::ConditionAnalysis;
use crate::results::comparison::Mismatches;
use crate::results::fitted_couplings::FittedCouplings;
use crate::results::model_swap::{ConditionSwaps, ModelSwap};

/// A physics and an identified model by their indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ModelPair {
    physics: usize,
    identified: usize,
}

impl ModelPair {
    /// Returns the pair with one bundle's model replaced.
    fn with(self, kind: BundleKind, model: usize) -> Self {
        match kind {
            BundleKind::Physics => Self {
                physics: model,
                ..self
            },
            BundleKind::Identified => Self {
                identified: model,
                ..self
            },
        }
    }
}

/// Inputs to a condition's swaps.
#[derive(Clone, Copy)]
pub(crate) struct SwapInput<'a> {
    pub(crate) run: Run<'a>,
    pub(crate) analysis: &'a ConditionAnalysis,
    pub(crate) responses: &'a ConditionResponses,
    pub(crate) couplings: Option<&'a Arc<FittedCouplings>>,
}

/// A model pair's optimal correction, with its G and D.
#[derive(Clone, Debug)]
pub(crate) struct SwapOptimum {
    pub(crate) correction: ChannelCorrection,
    /// The deltas, with G after the leads.
    pub(crate) delta: Delta,
}

impl SwapOptimum {
    /// Returns the gains as logarithms and the delays \[s\]; `None` for undefined values.
    fn figures(&self) -> Figures {
        let correction = &self.correction;
        let delta = &self.delta;
        ScalarTable::from_fn(delta.gain.outputs(), delta.gain.inputs(), |scalar| {
            let figure = match scalar {
                Scalar::Gain(pair) => delta.gain[pair]?.ln(),
                Scalar::Delay(pair) => delta.delay_s[pair]?,
                Scalar::BandDelay(pair) => delta.band_delay_s[pair]?,
                Scalar::NetGain(pair) => correction.net_gain(pair).ln(),
                Scalar::ChannelGain(channel) => correction.gain(channel).ln(),
                Scalar::ChannelDelay(channel) => correction.delay_s(channel),
            };
            if figure.is_finite() {
                Some(figure)
            } else {
                None
            }
        })
    }
}

/// Returns the representatives' gains and delays.
pub(crate) fn representative_figures(analysis: &ConditionAnalysis) -> Figures {
    let optimum = SwapOptimum {
        correction: analysis.correction.clone(),
        delta: Delta {
            gain: analysis.gain_problem.delta.clone(),
            ..analysis.comparison.delta.clone()
        },
    };
    optimum.figures()
}

/// Inputs on which a swap depends, besides the two models.
#[derive(Clone, Debug, PartialEq)]
struct SwapKey {
    /// The analysis's settings, except those that affect no swap.
    settings: Settings,
    measuring: PairTable<bool>,
    /// The representatives, which determine the phase branches.
    representatives: ModelPair,
    couplings: Option<Arc<FittedCouplings>>,
}

/// Last swaps, by their models: rejecting or restoring a model does not affect the other models'
/// swaps.
#[derive(Clone, Debug, Default)]
pub(crate) struct SwapMemo {
    key: Option<SwapKey>,
    kept: BTreeMap<ModelPair, Option<Arc<Figures>>>,
}

impl SwapInput<'_> {
    fn representatives(&self) -> ModelPair {
        ModelPair {
            physics: self.analysis.comparison.physics.model,
            identified: self.analysis.comparison.identified.model,
        }
    }

    /// Returns a bundle's other kept models in file order, without models set aside (M5b).
    /// Identical models count once, because they add no information. A copy of the representative
    /// counts only if the bundle has no different model.
    fn others(&self, kind: BundleKind) -> Vec<usize> {
        let representative = self.analysis.representative(kind);
        let responses = self.responses.bundle(kind);
        // Models with equal dynamics share their response.
        let is_copy = |a: usize, b: usize| Arc::ptr_eq(&responses[a], &responses[b]);
        let mut distinct: Vec<usize> = Vec::new();
        let mut copies = Vec::new();
        for (model, score) in representative.scores.iter().enumerate() {
            if score.is_none() || model == representative.model {
                continue;
            }
            if is_copy(model, representative.model) {
                copies.push(model);
            } else if !distinct.iter().any(|&known| is_copy(known, model)) {
                distinct.push(model);
            }
        }
        if distinct.is_empty() {
            copies.truncate(1);
            copies
        } else {
            distinct
        }
    }

    /// Returns the inputs on which the swaps depend, besides the two models.
    fn key(&self) -> SwapKey {
        let mut settings = self.run.study.settings.clone();
        settings.schedule = Default::default();
        settings.schedule_delays = Default::default();
        settings.uncertainty = Default::default();
        settings.gain_source = GainSource::Representatives;
        SwapKey {
            settings,
            measuring: self.run.study.dataset.measuring_pairs(),
            representatives: self.representatives(),
            couplings: self.couplings.cloned(),
        }
    }

    fn compared(&self, kind: BundleKind, model: usize) -> ComparedModel {
        ComparedModel::new(
            &self.analysis.condition,
            self.responses,
            kind,
            model,
            self.run.comparison_grid(),
        )
    }
}

impl SwapMemo {
    /// Completes all swaps (steps 1 to 4 above). Those that are not cached are computed, one step
    /// each; `optimum` returns the correction for a comparison.
    ///
    /// # Errors
    /// [`Cancelled`] where the execution is cancelled.
    pub(crate) fn complete(
        &mut self,
        input: &SwapInput<'_>,
        optimum: impl Fn(&Mismatches, Delta) -> Result<Option<SwapOptimum>, Cancelled> + Sync,
    ) -> Result<ConditionSwaps, Cancelled> {
        let key = input.key();
        if self.key.as_ref() != Some(&key) {
            self.kept.clear();
            self.key = Some(key);
        }
        // Step 1.
        let mut replacements = Vec::new();
        for kind in BundleKind::BOTH {
            for model in input.others(kind) {
                replacements.push((kind, model));
            }
        }
        let representatives = input.representatives();
        // With the mean over all pairs, the values for the two representatives differ from the
        // analysis's values: this pair is computed too, as the reference for the changes.
        let is_mean = input.run.study.settings.gain_source == GainSource::MeanOfPairs;
        let mut wanted: Vec<ModelPair> = replacements
            .iter()
            .map(|(kind, model)| representatives.with(*kind, *model))
            .collect();
        if is_mean {
            wanted.push(representatives);
        }
        // Step 2.
        self.compute_missing(input, wanted, replacements.len(), optimum)?;
        let swaps: Vec<ModelSwap> = replacements
            .into_iter()
            .map(|(bundle, model)| ModelSwap {
                bundle,
                model,
                figures: self.figures(representatives.with(bundle, model)),
            })
            .collect();
        // Step 3.
        let base = match (is_mean, self.figures(representatives)) {
            (false, _) => representative_figures(input.analysis),
            (true, Some(base)) => Figures::clone(&base),
            (true, None) => representative_figures(input.analysis).map(|_, _| None),
        };
        // Step 4.
        let spread = ConditionSpread::new(
            &base,
            &bundle_figures(&swaps, BundleKind::Physics),
            &bundle_figures(&swaps, BundleKind::Identified),
        );
        Ok(ConditionSwaps { spread, swaps })
    }

    /// Computes the results for the pairs that are not cached; `swap_count` is the number of pairs
    /// that count as steps.
    fn compute_missing(
        &mut self,
        input: &SwapInput<'_>,
        mut wanted: Vec<ModelPair>,
        swap_count: usize,
        optimum: impl Fn(&Mismatches, Delta) -> Result<Option<SwapOptimum>, Cancelled> + Sync,
    ) -> Result<(), Cancelled> {
        wanted.retain(|pair| !self.kept.contains_key(pair));
        input
            .run
            .execution
            .step(swap_count.saturating_sub(wanted.len()));
        let figures = swap_figures(input, &wanted, optimum)?;
        self.kept.extend(wanted.into_iter().zip(figures));
        Ok(())
    }

    /// Returns a pair's cached figures; `None` if the pair could not be analysed.
    fn figures(&self, pair: ModelPair) -> Option<Arc<Figures>> {
        self.kept.get(&pair).cloned().flatten()
    }
}

/// Returns the results after each swap in a bundle.
fn bundle_figures(swaps: &[ModelSwap], bundle: BundleKind) -> Vec<Option<&Figures>> {
    swaps
        .iter()
        .filter(|swap| swap.bundle == bundle)
        .map(|swap| swap.figures.as_deref())
        .collect()
}

/// Computes the results for each model pair.
fn swap_figures(
    input: &SwapInput<'_>,
    pairs: &[ModelPair],
    optimum: impl Fn(&Mismatches, Delta) -> Result<Option<SwapOptimum>, Cancelled> + Sync,
) -> Result<Vec<Option<Arc<Figures>>>, Cancelled> {
    if pairs.is_empty() {
        return Ok(Vec::new());
    }
    let representatives = input.representatives();
    let physics = input.compared(BundleKind::Physics, representatives.physics);
    let identified = input.compared(BundleKind::Identified, representatives.identified);
    let omega = input.run.grid.omega();
    let base = &input.analysis.comparison.representative.mismatch;
    let median_phases = base.map(|_, mismatch| {
        mismatch
            .as_ref()
            .map(|mismatch| mismatch.median_phase(omega))
    });
    let figures = input.run.execution.each(pairs.len(), 1, |index| {
        let pair = pairs[index];
        let mut mismatch = if pair.identified == representatives.identified {
            let other = input.compared(BundleKind::Physics, pair.physics);
            other.mismatches(&identified)
        } else {
            let other = input.compared(BundleKind::Identified, pair.identified);
            physics.mismatches(&other)
        };
        // As for pinned models, each phase difference is on the branch nearest to the
        // representatives' phase difference (M13.1).
        for (pair, entry) in mismatch.iter_mut() {
            if let Some(median_phase) = median_phases[pair] {
                *entry = entry
                    .take()
                    .map(|entry| entry.align_branch(omega, median_phase));
            }
        }
        let delta = Delta::new(&mismatch, omega);
        // No result, as for pinned models without comparable responses.
        if delta.gain.iter().all(|(_, gain)| gain.is_none()) {
            return Ok(None);
        }
        let optimum = optimum(&mismatch, delta)?;
        Ok(optimum.map(|optimum| Arc::new(optimum.figures())))
    })?;
    figures.into_iter().collect()
}
