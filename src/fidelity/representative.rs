//! The model that stands for a bundle.

use std::collections::BTreeSet;

use super::distance::BundleDistance;

/// The medoid of the models kept, or the one the analyst pinned, with every kept model's score (M5).
#[derive(Clone, Debug, PartialEq)]
pub struct Representative {
    /// Index of the representative in the bundle.
    pub model: usize,
    /// `s_a = mean over b != a of d(a, b)` over the kept models; `None` for a rejected one. Zero for the only one kept.
    pub scores: Vec<Option<f64>>,
}

impl Representative {
    /// The kept model of least score (ties: the first in file order), or `pinned`.
    ///
    /// Where every model is rejected the first one stands in; [`crate::study::Study`] never lets that happen.
    pub fn of(distance: &BundleDistance, rejected: &BTreeSet<usize>, pinned: Option<usize>) -> Self {
        let kept: Vec<usize> = (0..distance.models()).filter(|model| !rejected.contains(model)).collect();
        let mut scores = vec![None; distance.models()];
        for &a in &kept {
            let sum: f64 = kept.iter().map(|&b| distance.between(a, b)).sum();
            scores[a] = Some(sum / kept.len().saturating_sub(1).max(1) as f64);
        }
        let mut medoid = kept.first().copied().unwrap_or(0);
        for &model in &kept {
            if scores[model] < scores[medoid] {
                medoid = model;
            }
        }
        let model = pinned.filter(|model| kept.contains(model)).unwrap_or(medoid);
        Self { model, scores }
    }
}
