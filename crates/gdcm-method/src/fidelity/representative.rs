//! Chooses a bundle's representative (M5).
//!
//! ```text
//! s_a = mean over b != a of d(a, b)
//! representative <- the model with the smallest score s_a (medoid)
//! ```
//!
//! `d(a, b)` is the distance between two models (`distance`).

use std::cmp::Ordering;
use std::collections::BTreeSet;

use super::distance::BundleDistance;

/// The accepted models' medoid, or the model pinned by the analyst, with every accepted model's
/// score (M5).
#[derive(Clone, Debug, PartialEq)]
pub struct Representative {
    /// The representative's index in the bundle.
    pub model: usize,
    /// `s_a = mean over b != a of d(a, b)` over the accepted models; `None` for a model that is
    /// rejected or set aside. Zero for a single accepted model.
    pub scores: Vec<Option<f64>>,
}

impl Representative {
    /// Returns the accepted model with the smallest score (ties: the first in file order), or
    /// `pinned`; `None` if every model is rejected or set aside. A pinned model that is rejected or
    /// set aside is ignored.
    pub fn select(
        distance: &BundleDistance,
        rejected: &BTreeSet<usize>,
        pinned: Option<usize>,
    ) -> Option<Self> {
        let mut kept = distance.measured().compared_models();
        kept.retain(|model| !rejected.contains(model));
        let mut scores = vec![None; distance.measured().lacks.len()];
        for &a in &kept {
            let sum: f64 = kept.iter().filter_map(|&b| distance.between(a, b)).sum();
            scores[a] = Some(sum / kept.len().saturating_sub(1).max(1) as f64);
        }
        let medoid = kept
            .iter()
            .copied()
            .min_by(|&a, &b| scores[a].partial_cmp(&scores[b]).unwrap_or(Ordering::Equal))?;
        let model = match pinned {
            Some(pinned) if kept.contains(&pinned) => pinned,
            _ => medoid,
        };
        Some(Self { model, scores })
    }

    /// Returns an accepted model's distances `d(a, b)` from the other accepted models, in bundle
    /// order: their mean is its score. `distance` is the one from which the scores were computed.
    pub fn score_distances(&self, distance: &BundleDistance, model: usize) -> Vec<f64> {
        let mut distances = Vec::new();
        for (other, score) in self.scores.iter().enumerate() {
            if other != model && score.is_some() {
                distances.extend(distance.between(model, other));
            }
        }
        distances
    }
}
