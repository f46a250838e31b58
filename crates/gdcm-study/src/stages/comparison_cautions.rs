//! Cautions about a condition's representatives: gains outside the computable range, frequencies
//! without coherence, numerically zero responses. A *representative* is the model that stands for
//! its bundle (M5); these two are compared. A frequency has no weight if its coherence is too low
//! or if it lies outside the valid band (M4a).

use gdcm_method::correction::delta::Delta;
use gdcm_model::dataset::{BundleKind, Dynamics, Model, Pair};

use super::compared_model::ComparedModel;
use super::comparison_input::ComparisonInput;
use crate::results::caution::{BundleModel, Caution, GainOutOfRange};

/// The two representatives, prepared for comparison.
pub(super) struct ComparedPair<'a> {
    pub(super) physics: &'a ComparedModel,
    pub(super) physics_index: usize,
    pub(super) identified: &'a ComparedModel,
    pub(super) identified_index: usize,
}

impl ComparisonInput<'_> {
    /// Returns the caution about gains between the representatives that are outside the computable
    /// range.
    pub(super) fn out_of_range(
        &self,
        compared: &ComparedPair<'_>,
        delta: &Delta,
    ) -> Option<Caution> {
        let mut responses =
            GainOutOfRange::of_models(&compared.physics.polar, &compared.identified.polar);
        // A response whose delta gain G is still determined, because the frequencies with such a
        // gain have no weight, needs no caution.
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

    /// Returns the caution about the identified representative's frequencies that have no weight,
    /// or that its coherence is not used (M4a). A model without coherence needs no caution: all its
    /// frequencies count.
    pub(super) fn coherence_caution(
        &self,
        compared: &ComparedModel,
        identified: &Model,
    ) -> Option<Caution> {
        let Dynamics::Measured(response) = &identified.dynamics else {
            return None;
        };
        response.coherence()?;
        let Some(threshold) = self.grid.coherence else {
            return Some(Caution::CoherenceNotUsed);
        };
        let points = self.grid.grid.len();
        // Number of responses with a weighted frequency.
        let mut weighed = 0;
        // Responses with frequencies without weight, and the number of these frequencies.
        let mut left_out: Vec<(Pair, usize)> = Vec::new();
        for (pair, curve) in compared.polar.curves().iter() {
            if curve.is_none() {
                continue;
            }
            // `None` without coherence or threshold, which is excluded above.
            let Some(count) = compared.weighted_frequencies(pair) else {
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
    pub(super) fn numerically_zero_cautions(&self, compared: &ComparedPair<'_>) -> Vec<Caution> {
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
            let responses: Vec<Pair> = model.numerically_zero.marked().collect();
            if !responses.is_empty() {
                cautions.push(Caution::NumericallyZero {
                    model: BundleModel::new(self.condition, kind, index),
                    responses,
                });
            }
        }
        cautions
    }
}
