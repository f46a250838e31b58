//! Swaps: another model of the bundle replaces a representative (M13.1).
//!
//! ```text
//! 1  replacing models: the other kept models of each bundle, copies counted once
//! 2  for each replacement that is not cached: mismatch of the two models on the phase branch of
//!    the representatives, their G and D, and the optimal correction
//! 3  base: the figures of the representatives, to which those of the swaps are compared
//! 4  spread of the figures over the swaps of each bundle
//! ```
//!
//! The *figures* of two models that are compared are the resulting gains, as logarithms, and delays
//! \[s\]. A phase difference is known up to whole turns; its *branch* is the number of turns chosen
//! (M3).

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

/// The two models that are compared, by their indices in the bundles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ComparedIndices {
    physics: usize,
    identified: usize,
}

impl ComparedIndices {
    /// Returns the indices with one bundle's model replaced.
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

/// The optimal correction for two models, with their G and D.
#[derive(Clone, Debug)]
pub(crate) struct SwapOptimum {
    pub(crate) correction: ChannelCorrection,
    /// G and D; G is what remains after the lead filters.
    pub(crate) delta: Delta,
}

impl SwapOptimum {
    /// Returns the gains as logarithms and the delays \[s\]; `None` for undefined values.
    fn figures(&self) -> Figures {
        let correction = &self.correction;
        let delta = &self.delta;
        ScalarTable::from_fn(delta.gain.outputs(), delta.gain.inputs(), |scalar| {
            let value = match scalar {
                Scalar::Gain(pair) => delta.gain[pair]?.ln(),
                Scalar::Delay(pair) => delta.delay_s[pair]?,
                Scalar::BandDelay(pair) => delta.band_delay_s[pair]?,
                Scalar::NetGain(pair) => correction.net_gain(pair).ln(),
                Scalar::ChannelGain(channel) => correction.gain(channel).ln(),
                Scalar::ChannelDelay(channel) => correction.delay_s(channel),
            };
            if value.is_finite() { Some(value) } else { None }
        })
    }
}

/// Returns the representatives' figures from an analysis.
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
    representatives: ComparedIndices,
    couplings: Option<Arc<FittedCouplings>>,
}

/// Figures from the last swaps, by the compared models: rejecting or restoring a model does not
/// affect the other models' swaps.
#[derive(Clone, Debug, Default)]
pub(crate) struct SwapMemo {
    key: Option<SwapKey>,
    /// `None` for models that could not be compared.
    kept: BTreeMap<ComparedIndices, Option<Arc<Figures>>>,
}

impl SwapInput<'_> {
    fn representatives(&self) -> ComparedIndices {
        ComparedIndices {
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

    /// Returns whether the base must be computed: with G as the mean over all pairs of kept models,
    /// the analysis's values are not those of the two representatives.
    fn needs_computed_base(&self) -> bool {
        self.run.study.settings.gain_source == GainSource::MeanOfPairs
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
        let mut needed: Vec<ComparedIndices> = replacements
            .iter()
            .map(|(kind, model)| representatives.with(*kind, *model))
            .collect();
        if input.needs_computed_base() {
            needed.push(representatives);
        }
        // Step 2.
        self.compute_missing(input, needed, replacements.len(), optimum)?;
        let swaps: Vec<ModelSwap> = replacements
            .into_iter()
            .map(|(bundle, model)| ModelSwap {
                bundle,
                model,
                figures: self.figures(representatives.with(bundle, model)),
            })
            .collect();
        // Step 3.
        let base = self.base(input);
        // Step 4.
        let spread = ConditionSpread::new(
            &base,
            &bundle_figures(&swaps, BundleKind::Physics),
            &bundle_figures(&swaps, BundleKind::Identified),
        );
        Ok(ConditionSwaps { spread, swaps })
    }

    /// Returns the figures to which those of the swaps are compared (step 3); all undefined if they
    /// had to be computed, but could not be.
    fn base(&self, input: &SwapInput<'_>) -> Figures {
        let from_analysis = representative_figures(input.analysis);
        if !input.needs_computed_base() {
            return from_analysis;
        }
        match self.figures(input.representatives()) {
            Some(computed) => Figures::clone(&computed),
            None => from_analysis.map(|_, _| None),
        }
    }

    /// Computes the figures for the `needed` models that are not cached; `swap_count` of them count
    /// as steps.
    fn compute_missing(
        &mut self,
        input: &SwapInput<'_>,
        mut needed: Vec<ComparedIndices>,
        swap_count: usize,
        optimum: impl Fn(&Mismatches, Delta) -> Result<Option<SwapOptimum>, Cancelled> + Sync,
    ) -> Result<(), Cancelled> {
        needed.retain(|models| !self.kept.contains_key(models));
        input
            .run
            .execution
            .step(swap_count.saturating_sub(needed.len()));
        let figures = swap_figures(input, &needed, optimum)?;
        self.kept.extend(needed.into_iter().zip(figures));
        Ok(())
    }

    /// Returns the cached figures for two models; `None` if they could not be compared.
    fn figures(&self, models: ComparedIndices) -> Option<Arc<Figures>> {
        self.kept.get(&models).cloned().flatten()
    }
}

/// Returns the figures after each swap in a bundle.
fn bundle_figures(swaps: &[ModelSwap], bundle: BundleKind) -> Vec<Option<&Figures>> {
    swaps
        .iter()
        .filter(|swap| swap.bundle == bundle)
        .map(|swap| swap.figures.as_deref())
        .collect()
}

/// Computes the figures for each two models in `needed` (step 2).
fn swap_figures(
    input: &SwapInput<'_>,
    needed: &[ComparedIndices],
    optimum: impl Fn(&Mismatches, Delta) -> Result<Option<SwapOptimum>, Cancelled> + Sync,
) -> Result<Vec<Option<Arc<Figures>>>, Cancelled> {
    if needed.is_empty() {
        return Ok(Vec::new());
    }
    let comparison = SwapComparison::new(input);
    let figures = input.run.execution.each(needed.len(), 1, |index| {
        let mismatches = comparison.mismatches(needed[index]);
        let delta = Delta::new(&mismatches, input.run.grid.omega());
        // No result, as for pinned models without comparable responses.
        if delta.gain.iter().all(|(_, gain)| gain.is_none()) {
            return Ok(None);
        }
        let found = optimum(&mismatches, delta)?;
        Ok(found.map(|found| Arc::new(found.figures())))
    })?;
    figures.into_iter().collect()
}

/// The representatives, prepared for comparison with the models that replace one of them.
struct SwapComparison<'i, 'a> {
    input: &'i SwapInput<'a>,
    representatives: ComparedIndices,
    physics: ComparedModel,
    identified: ComparedModel,
    /// Median phase difference between the representatives in each response \[rad\].
    median_phases: PairTable<Option<f64>>,
}

impl<'i, 'a> SwapComparison<'i, 'a> {
    fn new(input: &'i SwapInput<'a>) -> Self {
        let representatives = input.representatives();
        let omega = input.run.grid.omega();
        let between_representatives = &input.analysis.comparison.representative.mismatch;
        Self {
            input,
            representatives,
            physics: input.compared(BundleKind::Physics, representatives.physics),
            identified: input.compared(BundleKind::Identified, representatives.identified),
            median_phases: between_representatives
                .map(|_, mismatch| Some(mismatch.as_ref()?.median_phase(omega))),
        }
    }

    /// Computes the mismatches between two models, one of which is a representative. As for pinned
    /// models, each phase difference is on the branch nearest to the representatives' phase
    /// difference (M13.1).
    fn mismatches(&self, models: ComparedIndices) -> Mismatches {
        let mut mismatches = if models.identified == self.representatives.identified {
            let other = self.input.compared(BundleKind::Physics, models.physics);
            other.mismatches(&self.identified)
        } else {
            let other = self
                .input
                .compared(BundleKind::Identified, models.identified);
            self.physics.mismatches(&other)
        };
        let omega = self.input.run.grid.omega();
        for (pair, mismatch) in mismatches.iter_mut() {
            if let Some(median_phase) = self.median_phases[pair] {
                *mismatch = mismatch
                    .take()
                    .map(|mismatch| mismatch.align_branch(omega, median_phase));
            }
        }
        mismatches
    }
}
