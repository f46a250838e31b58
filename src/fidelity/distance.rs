//! Distances between the models of a bundle.

use crate::dataset::{Pair, PairTable};
use crate::response::{PolarCurve, PolarResponse};

use super::cost::CostAverage;
use super::mismatch::Mismatch;

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
    pub fn of(responses: &[&PolarResponse], omega: &[f64], measuring: &PairTable<bool>) -> Self {
        let defined = |pair: &Pair| responses.iter().all(|response| response.curves()[*pair].is_some());
        let mut compared: Vec<Pair> = measuring.marked().filter(defined).collect();
        if compared.is_empty() {
            compared = measuring.pairs().filter(defined).collect();
        }
        let curves: Vec<Vec<&PolarCurve>> = responses
            .iter()
            .map(|response| compared.iter().filter_map(|&pair| response.curves()[pair].as_ref()).collect())
            .collect();
        let mut distances = Vec::with_capacity(responses.len() * responses.len().saturating_sub(1) / 2);
        for (index, a) in curves.iter().enumerate() {
            distances.extend(curves[index + 1..].iter().map(|b| distance(a, b, omega)));
        }
        Self { models: responses.len(), distances, compared }
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

fn distance(a: &[&PolarCurve], b: &[&PolarCurve], omega: &[f64]) -> f64 {
    if a.is_empty() {
        return 0.0;
    }
    let cost =
        |(a, b): (&&PolarCurve, &&PolarCurve)| Mismatch::new(a, b).cost(omega, 0.0, 0.0, CostAverage::Mean).total();
    (a.iter().zip(b).map(cost).sum::<f64>() / a.len() as f64).sqrt()
}
