//! Distances between the models of a bundle, and the model that stands for it (M5).

use std::collections::BTreeSet;

use crate::dataset::{Pair, PairTable};
use crate::response::PolarResponse;

use super::mean_cost::mean_cost;

/// Which responses measure distance in a bundle, and what each model lacks of them (M5b).
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredPairs {
    /// The marked responses that at least one model has.
    pub compared: Vec<Pair>,
    /// Those of them that each model lacks: zero or not finite somewhere in the band. A model that lacks any is *set aside*: it
    /// takes no part in distances, suggestions and representatives.
    pub lacks: Vec<Vec<Pair>>,
}

impl MeasuredPairs {
    /// What the models of a bundle have and lack of the responses marked in `measuring`.
    pub fn of(responses: &[PolarResponse], measuring: &PairTable<bool>) -> Self {
        let some_has = |pair: &Pair| responses.iter().any(|response| response.curves()[*pair].is_some());
        let compared: Vec<Pair> = measuring.marked().filter(some_has).collect();
        let lacking = |response: &PolarResponse| {
            compared.iter().copied().filter(|pair| response.curves()[*pair].is_none()).collect()
        };
        let lacks = responses.iter().map(lacking).collect();
        Self { compared, lacks }
    }

    /// Indices of the models that are not set aside, in bundle order.
    pub fn compared_models(&self) -> Vec<usize> {
        (0..self.lacks.len()).filter(|&model| !self.is_set_aside(model)).collect()
    }

    /// Whether a model is set aside.
    pub fn is_set_aside(&self, model: usize) -> bool {
        !self.lacks[model].is_empty()
    }
}

/// The distance of every two models of a bundle (M5):
/// `d(a, b) = sqrt(mean over the measuring pairs of J(a against b))`, J with the mean over frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct BundleDistance {
    measured: MeasuredPairs,
    /// Number of models that are not set aside.
    count: usize,
    /// Place of each model among them.
    places: Vec<Option<usize>>,
    /// Upper triangle by rows, without the models set aside: d(0,1), d(0,2), ..., d(1,2), ...
    distances: Vec<f64>,
}

impl BundleDistance {
    /// The distances of which row `a` are those of [`distances_from`] the `a`-th model that is not set aside.
    pub fn from_rows(rows: Vec<Vec<f64>>, measured: MeasuredPairs) -> Self {
        let (count, mut places) = (rows.len(), vec![None; measured.lacks.len()]);
        for (place, model) in measured.compared_models().into_iter().enumerate() {
            places[model] = Some(place);
        }
        Self { measured, count, places, distances: rows.into_iter().flatten().collect() }
    }

    /// `d(a, b)`, zero where `a = b`; `None` where one of them is set aside.
    pub fn between(&self, a: usize, b: usize) -> Option<f64> {
        let (a, b) = (self.places[a]?, self.places[b]?);
        let (low, high) = (a.min(b), a.max(b));
        if low == high {
            return Some(0.0);
        }
        self.distances.get(low * (2 * self.count - low - 1) / 2 + high - low - 1).copied()
    }

    /// What was compared, and which models are set aside.
    pub fn measured(&self) -> &MeasuredPairs {
        &self.measured
    }
}

/// The distances of one model from each of the models after it: independent pieces of work for a large bundle.
pub fn distances_from(a: usize, responses: &[&PolarResponse], compared: &[Pair]) -> Vec<f64> {
    let a_curves = responses[a].curves();
    let distance = |b: &PolarResponse| {
        let b_curves = b.curves();
        let curves = compared.iter().filter_map(|&pair| a_curves[pair].as_ref().zip(b_curves[pair].as_ref()));
        let sum: f64 = curves.map(|(a, b)| mean_cost(a, b)).sum();
        (sum / compared.len().max(1) as f64).sqrt()
    };
    responses[a + 1..].iter().map(|b| distance(b)).collect()
}

/// The medoid of the models kept, or the one the analyst pinned, with every kept model's score (M5).
#[derive(Clone, Debug, PartialEq)]
pub struct Representative {
    /// Index of the representative in the bundle.
    pub model: usize,
    /// `s_a = mean over b != a of d(a, b)` over the kept models; `None` for one rejected or set aside. Zero for the only one
    /// kept.
    pub scores: Vec<Option<f64>>,
}

impl Representative {
    /// The kept model of least score (ties: the first in file order), or `pinned`; `None` where every model is rejected or set
    /// aside. A pinned model that is set aside does not count.
    pub fn of(distance: &BundleDistance, rejected: &BTreeSet<usize>, pinned: Option<usize>) -> Option<Self> {
        let mut kept = distance.measured.compared_models();
        kept.retain(|model| !rejected.contains(model));
        let mut scores = vec![None; distance.places.len()];
        for &a in &kept {
            let sum: f64 = kept.iter().filter_map(|&b| distance.between(a, b)).sum();
            scores[a] = Some(sum / kept.len().saturating_sub(1).max(1) as f64);
        }
        let mut medoid = *kept.first()?;
        for &model in &kept {
            if scores[model] < scores[medoid] {
                medoid = model;
            }
        }
        Some(Self { model: pinned.filter(|model| kept.contains(model)).unwrap_or(medoid), scores })
    }
}
