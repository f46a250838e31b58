//! Distances between the models of a bundle, and the model that stands for it (M5).

use std::collections::BTreeSet;

use crate::dataset::{Pair, PairTable};
use crate::response::{PolarCurve, PolarResponse};

use super::cost::{Cost, CostAverage};
use super::counted::CountedFrequencies;
use super::mean_cost::mean_cost;
use super::mismatch::Mismatch;

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

/// A model of a bundle as distances compare it.
#[derive(Clone, Copy, Debug)]
pub struct ComparedModel<'a> {
    /// Its responses.
    pub responses: &'a PolarResponse,
    /// Which frequencies of each count, where it is measured with coherence (M4a).
    pub counted: Option<&'a PairTable<CountedFrequencies>>,
}

impl ComparedModel<'_> {
    /// J with this model as the reference, by its coherence; none where it says nothing.
    fn cost_as_reference(&self, a: &PolarCurve, b: &PolarCurve, pair: Pair) -> Option<f64> {
        let mismatch = Mismatch::new(a, b).counting(Some(&self.counted?[pair]))?;
        let weights = mismatch.counted.as_ref().map(CountedFrequencies::weights);
        let (magnitude_db, phase) = (mismatch.magnitude_db.iter().copied(), mismatch.phase.iter().copied());
        Some(Cost::of(magnitude_db, phase, weights, CostAverage::Mean, &mut Vec::new()).total())
    }
}

/// The distances of one model from each of the models after it: independent pieces of work for a large bundle.
///
/// J is weighted by the coherence of the model that is compared with (M4a). In a bundle either may be that: where one of the two
/// has coherence, J is the mean of both ways, so that a distance does not depend on the order of the models. A response of which
/// no frequency counts is compared over all of them, for models that were hardly measured must not look alike.
pub fn distances_from(a: usize, models: &[ComparedModel<'_>], compared: &[Pair]) -> Vec<f64> {
    let of_pair = |b: &ComparedModel<'_>, pair: Pair| {
        let (from, to) = (models[a].responses.curves()[pair].as_ref()?, b.responses.curves()[pair].as_ref()?);
        if models[a].counted.is_none() && b.counted.is_none() {
            return Some(mean_cost(from, to));
        }
        let ways = [models[a], *b].map(|reference| reference.cost_as_reference(from, to, pair));
        let [one, other] = ways.map(|cost| cost.unwrap_or_else(|| mean_cost(from, to)));
        Some(0.5 * (one + other))
    };
    let distance = |b: &ComparedModel<'_>| {
        let sum: f64 = compared.iter().filter_map(|&pair| of_pair(b, pair)).sum();
        (sum / compared.len().max(1) as f64).sqrt()
    };
    models[a + 1..].iter().map(distance).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::{Dynamics, MeasuredResponse};
    use crate::response::{FrequencyGrid, FrequencyResponse};

    /// A response of 1 but for the upper half of the band, where it is `upper`, of this coherence there.
    fn measured(upper: f64, coherence: f64) -> Dynamics {
        let table = |low: f64, high: f64| PairTable::filled(1, 1, vec![low, low, high, high]);
        let coherence = Some(table(1.0, coherence));
        let omega = vec![1.0, 2.99, 3.01, 9.0];
        Dynamics::Measured(MeasuredResponse::new(omega, &table(1.0, upper), &table(0.0, 0.0), coherence).unwrap())
    }

    fn distances(models: &[Dynamics], threshold: Option<f64>) -> Vec<f64> {
        let grid = FrequencyGrid::logarithmic(crate::dataset::Band::new(1.0, 9.0).unwrap(), 100);
        let of = |model| PolarResponse::of(&FrequencyResponse::of(model, &grid));
        let responses: Vec<PolarResponse> = models.iter().map(of).collect();
        let counted: Vec<_> =
            models.iter().map(|model| CountedFrequencies::of_model(model, grid.omega(), threshold)).collect();
        let models: Vec<ComparedModel<'_>> = responses
            .iter()
            .zip(&counted)
            .map(|(responses, counted)| ComparedModel { responses, counted: counted.as_ref() })
            .collect();
        (0..models.len()).flat_map(|a| distances_from(a, &models, &[Pair::new(0, 0)])).collect()
    }

    #[test]
    fn what_was_not_measured_counts_in_a_distance_one_way_only_where_the_other_model_has_it() {
        let (good, bad) = (measured(1.0, 0.9), measured(2.0, 0.1));
        let [apart] = distances(&[good.clone(), bad.clone()], None)[..] else { panic!("one distance") };
        let [weighed] = distances(&[good.clone(), bad.clone()], Some(0.6))[..] else { panic!("one distance") };
        let [turned] = distances(&[bad.clone(), good.clone()], Some(0.6))[..] else { panic!("one distance") };
        assert_eq!(weighed, turned, "whichever comes first");
        assert!(weighed > 0.0 && weighed < apart);
        // Half of J at the weight 0.879 of the one, and none of it by the other.
        assert!((weighed / apart - (0.5 * crate::fidelity::coherence_weight(0.9)).sqrt()).abs() < 0.01);
    }
}
