//! Compares a condition's representatives (M5, M6), independent of constraints, alpha and bounds.
//!
//! ```text
//! 1  cautions about the kept models of both bundles
//! 2  representatives: the medoid of the kept models, or the pinned model              (M5)
//! 3  mismatch of the physics representative, and of the nominal model, against the identified one
//! 4  G and D of the representatives; where they are undefined, why                    (M6)
//! ```

use std::collections::BTreeSet;

use gdcm_method::correction::delta::{Delta, delta_gains};
use gdcm_method::fidelity::CostAverage;
use gdcm_method::fidelity::representative::Representative;
use gdcm_model::dataset::{BundleKind, Condition, Dynamics, Model, Pair, PairTable};
use gdcm_model::response::GainDelay;

use super::compared_model::{ComparedModel, ComparisonGrid, why_undefined};
use super::condition_responses::ConditionResponses;
use super::model_cautions::BundleCautions;
use crate::decisions::choices::ConditionChoice;
use crate::results::analysis::ConditionFailure;
use crate::results::caution::{BundleModel, Caution, GainOutOfRange, Undefined};
use crate::results::comparison::{BundleMetrics, Comparison, ModelMismatch};

/// Inputs of the comparison of a condition's models.
#[derive(Clone, Copy)]
pub(crate) struct ComparisonInput<'a> {
    pub(crate) condition: &'a Condition,
    pub(crate) responses: &'a ConditionResponses,
    pub(crate) metrics: &'a BundleMetrics,
    pub(crate) grid: ComparisonGrid<'a>,
    pub(crate) choice: &'a ConditionChoice,
    /// Average over frequency in J.
    pub(crate) average: CostAverage,
}

impl ComparisonInput<'_> {
    fn model(&self, kind: BundleKind, index: usize) -> &Model {
        &self.condition.bundle(kind)[index]
    }

    fn compared(&self, kind: BundleKind, index: usize) -> ComparedModel {
        ComparedModel::new(self.condition, self.responses, kind, index, self.grid)
    }

    /// Returns the cautions about both bundles' kept models.
    fn model_cautions(&self) -> Vec<Caution> {
        let omega = self.grid.grid.omega();
        let mut cautions = Vec::new();
        for kind in BundleKind::BOTH {
            let bundle = BundleCautions {
                condition: self.condition,
                kind,
                choice: self.choice.bundle(kind),
                responses: self.responses,
                measured: self.metrics.bundle(kind).measured(),
                band_top: omega.last().copied().unwrap_or_default(),
            };
            cautions.extend(bundle.find());
        }
        cautions
    }

    /// Selects a bundle's representative among its kept models.
    fn representative(&self, kind: BundleKind) -> Result<Representative, ConditionFailure> {
        let choice = self.choice.bundle(kind);
        let position = |name: &String| self.condition.position(kind, name);
        let rejected: BTreeSet<usize> = choice.rejected.iter().filter_map(position).collect();
        let pinned = choice.pinned.as_ref().and_then(position);
        Representative::select(self.metrics.bundle(kind), &rejected, pinned)
            .ok_or(ConditionFailure::AllSetAside { bundle: kind })
    }

    /// Computes the mismatch of a physics model against the identified representative, and J.
    fn mismatch(&self, physics: &ComparedModel, identified: &ComparedModel) -> ModelMismatch {
        let mismatch = physics.mismatches(identified);
        let cost = mismatch.map(|_, entry| {
            entry
                .as_ref()
                .map(|entry| entry.cost(self.grid.grid.omega(), GainDelay::NONE, self.average))
        });
        ModelMismatch { mismatch, cost }
    }

    /// Returns the caution about gains between the representatives that are outside the computable
    /// range.
    fn out_of_range(&self, compared: &ComparedPair<'_>, delta: &Delta) -> Option<Caution> {
        let mut responses =
            GainOutOfRange::of_models(&compared.physics.polar, &compared.identified.polar);
        // If coherence excludes all frequencies with such a gain, G is defined and no caution is
        // needed.
        responses.retain(|gain| delta.gain[gain.pair].is_none());
        if responses.is_empty() {
            return None;
        }
        let physics = self.model(BundleKind::Physics, compared.physics_index);
        let identified = self.model(BundleKind::Identified, compared.identified_index);
        Some(Caution::GainsOutOfRange {
            physics: physics.name.clone(),
            identified: identified.name.clone(),
            responses,
        })
    }

    /// Returns the caution about the frequencies of the identified representative that coherence
    /// excludes from the comparison (M4a).
    fn coherence_caution(&self, identified: &ComparedModel, flight: &Model) -> Option<Caution> {
        let Dynamics::Measured(response) = &flight.dynamics else {
            return None;
        };
        response.coherence()?;
        let Some(threshold) = self.grid.coherence else {
            return Some(Caution::CoherenceNotUsed);
        };
        let points = self.grid.grid.len();
        let mut weighed = 0;
        let mut left_out: Vec<(Pair, usize)> = Vec::new();
        for (pair, curve) in identified.polar.curves().iter() {
            if curve.is_none() {
                continue;
            }
            let Some(count) = identified.weighted_frequencies(pair) else {
                continue;
            };
            if count > 0 {
                weighed += 1;
            }
            if count < points {
                left_out.push((pair, points - count));
            }
        }
        if left_out.is_empty() {
            return None;
        }
        left_out.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        Some(Caution::NotCoherent {
            threshold,
            weighed,
            left_out,
            points,
        })
    }

    /// Returns the cautions about the representatives' numerically zero responses (M6a).
    fn nothing_cautions(&self, compared: &ComparedPair<'_>) -> Vec<Caution> {
        let mut cautions = Vec::new();
        for (kind, index, model) in [
            (
                BundleKind::Physics,
                compared.physics_index,
                compared.physics,
            ),
            (
                BundleKind::Identified,
                compared.identified_index,
                compared.identified,
            ),
        ] {
            let responses: Vec<Pair> = model.nothing.marked().collect();
            if !responses.is_empty() {
                cautions.push(Caution::NumericallyNothing {
                    model: BundleModel::new(self.condition, kind, index),
                    responses,
                });
            }
        }
        cautions
    }
}

/// The two representatives, prepared for comparison.
struct ComparedPair<'a> {
    physics: &'a ComparedModel,
    physics_index: usize,
    identified: &'a ComparedModel,
    identified_index: usize,
}

impl Comparison {
    /// Selects the representatives among the kept models and compares them, with the coherence
    /// weights of the identified representative if a minimum coherence is set (M4a).
    ///
    /// # Errors
    /// [`ConditionFailure`] where a bundle has no model to represent it.
    pub(crate) fn compute(input: &ComparisonInput<'_>) -> Result<Self, ConditionFailure> {
        let condition = input.condition;
        if !condition.has_reference() {
            return Err(ConditionFailure::NoReference);
        }
        let mut cautions = input.model_cautions();
        let physics = input.representative(BundleKind::Physics)?;
        let identified = input.representative(BundleKind::Identified)?;
        let simulated = input.compared(BundleKind::Physics, physics.model);
        let reference = input.compared(BundleKind::Identified, identified.model);
        let representative = input.mismatch(&simulated, &reference);
        let nominal = if physics.model == condition.nominal() {
            representative.clone()
        } else {
            let nominal = input.compared(BundleKind::Physics, condition.nominal());
            input.mismatch(&nominal, &reference)
        };
        let delta = Delta::new(&representative.mismatch, input.grid.grid.omega());
        let flight = input.model(BundleKind::Identified, identified.model);
        let undefined = delta.gain.map(|pair, gain| match (gain, &flight.dynamics) {
            (Some(_), _) => None,
            (None, Dynamics::Measured(response)) if !response.is_measured(pair) => {
                Some(Undefined::NotMeasured)
            }
            (None, _) => Some(why_undefined(&simulated, &reference, pair)),
        });
        let compared = ComparedPair {
            physics: &simulated,
            physics_index: physics.model,
            identified: &reference,
            identified_index: identified.model,
        };
        cautions.extend(input.out_of_range(&compared, &delta));
        cautions.extend(input.coherence_caution(&reference, flight));
        cautions.extend(input.nothing_cautions(&compared));
        Ok(Self {
            physics,
            identified,
            representative,
            nominal,
            delta,
            undefined,
            cautions,
        })
    }

    /// Returns the same comparison with other G: each is the geometric mean over all pairs of a
    /// kept physics and a kept identified model that have the response.
    pub(crate) fn with_mean_gains(mut self, input: &ComparisonInput<'_>) -> Self {
        let physics = kept_models(input, BundleKind::Physics, &self.physics);
        let identified = kept_models(input, BundleKind::Identified, &self.identified);
        let mut means: PairTable<MeanLogarithm> =
            self.delta.gain.map(|_, _| MeanLogarithm::default());
        for simulated in &physics {
            for reference in &identified {
                for (pair, gain) in delta_gains(&simulated.mismatches(reference)).iter() {
                    if let Some(gain) = gain {
                        means[pair].add(*gain);
                    }
                }
            }
        }
        self.delta.gain = self.delta.gain.map(|pair, gain| {
            gain.as_ref()?;
            Some(means[pair].value())
        });
        self
    }
}

/// Prepares a bundle's kept models.
fn kept_models(
    input: &ComparisonInput<'_>,
    kind: BundleKind,
    representative: &Representative,
) -> Vec<ComparedModel> {
    let mut models = Vec::new();
    for (index, score) in representative.scores.iter().enumerate() {
        if score.is_some() {
            models.push(input.compared(kind, index));
        }
    }
    models
}

/// Geometric mean of gains.
#[derive(Default)]
struct MeanLogarithm {
    sum: f64,
    count: usize,
}

impl MeanLogarithm {
    fn add(&mut self, gain: f64) {
        self.sum += gain.ln();
        self.count += 1;
    }

    fn value(&self) -> f64 {
        (self.sum / self.count as f64).exp()
    }
}
