//! Distances between the models of a bundle.

use crate::dataset::{Pair, PairTable};
use crate::response::PolarResponse;

use super::mean_cost::MeanCost;

/// The distance of every two models of a bundle (M5):
/// `d(a, b) = sqrt(mean over the measuring pairs of J(a against b))`, J with the mean over frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct BundleDistance {
    models: usize,
    /// Upper triangle by rows: d(0,1), d(0,2), ..., d(1,2), ...
    distances: Vec<f64>,
    /// The pairs that could be compared in every model.
    compared: Vec<Pair>,
}

impl BundleDistance {
    /// Distances over the responses marked in `measuring`.
    ///
    /// A response that some model of the bundle does not have (zero or not finite) is left out for all of them, so that
    /// distances stay comparable; where none of the marked is left all others are tried, and without any the distances are 0.
    pub fn of(responses: &[&PolarResponse], measuring: &PairTable<bool>) -> Self {
        let compared = compared_pairs(responses, measuring);
        let rows = (0..responses.len()).map(|a| distances_from(a, responses, &compared)).collect();
        Self::from_rows(rows, compared)
    }

    /// The distances of which row `a` are those of [`distances_from`] `a`.
    pub fn from_rows(rows: Vec<Vec<f64>>, compared: Vec<Pair>) -> Self {
        Self { models: rows.len(), distances: rows.into_iter().flatten().collect(), compared }
    }

    /// Number of models.
    pub fn models(&self) -> usize {
        self.models
    }

    /// `d(a, b)`; zero where `a = b`.
    pub fn between(&self, a: usize, b: usize) -> f64 {
        let (low, high) = (a.min(b), a.max(b));
        if low == high {
            return 0.0;
        }
        self.distances[low * (2 * self.models - low - 1) / 2 + high - low - 1]
    }

    /// The responses that were compared.
    pub fn compared(&self) -> &[Pair] {
        &self.compared
    }
}

/// The responses over which the distances of a bundle are taken.
pub fn compared_pairs(responses: &[&PolarResponse], measuring: &PairTable<bool>) -> Vec<Pair> {
    let defined = |pair: &Pair| responses.iter().all(|response| response.curves()[*pair].is_some());
    let marked: Vec<Pair> = measuring.marked().filter(defined).collect();
    if marked.is_empty() { measuring.pairs().filter(defined).collect() } else { marked }
}

/// The distances of one model from each of the models after it: independent pieces of work for a large bundle.
pub fn distances_from(a: usize, responses: &[&PolarResponse], compared: &[Pair]) -> Vec<f64> {
    let a_curves = responses[a].curves();
    let mut meter = MeanCost::default();
    let mut distance = |b: &PolarResponse| {
        let b_curves = b.curves();
        let curves = compared.iter().filter_map(|&pair| a_curves[pair].as_ref().zip(b_curves[pair].as_ref()));
        let sum: f64 = curves.map(|(a, b)| meter.of(a, b)).sum();
        (sum / compared.len().max(1) as f64).sqrt()
    };
    responses[a + 1..].iter().map(|b| distance(b)).collect()
}
