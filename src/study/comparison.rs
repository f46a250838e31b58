//! The stages of a condition's analysis that do not depend on constraints, alpha or bounds.

use std::collections::BTreeMap;

use crate::correction::{Delta, mismatch_table};
use crate::dataset::{BundleKind, Condition, PairTable};
use crate::fidelity::{
    BundleDistance, Cost, CostAverage, Discontinuity, DiscontinuityError, FitError, Mismatch, Representative,
    compared_pairs, distances_from,
};
use crate::response::{FrequencyGrid, FrequencyResponse, GainDelay, PolarResponse};

use super::condition_responses::ConditionResponses;
use super::document::ConditionChoice;
use super::effort::Effort;
use super::watch::Stopped;

/// Distances within each bundle and discontinuity ratios of the physics bundle; they do not depend on what is rejected.
#[derive(Clone, Debug, PartialEq)]
pub struct BundleFigures {
    /// Distances of the physics models.
    pub physics: BundleDistance,
    /// Distances of the identified models.
    pub identified: BundleDistance,
    /// Discontinuity ratios of the physics models, or why there are none.
    pub discontinuity: Result<Discontinuity, DiscontinuityError>,
}

impl BundleFigures {
    /// Distances over the responses marked in `measuring`, two steps for each model.
    pub fn of(
        condition: &Condition,
        responses: &ConditionResponses,
        measuring: &PairTable<bool>,
        effort: &Effort<'_>,
    ) -> Result<Self, Stopped> {
        let physics = distances(&responses.physics, measuring, effort)?;
        let identified = distances(&responses.identified, measuring, effort)?;
        let models = condition.bundle(BundleKind::Physics);
        let perturbations: Vec<(&str, Option<&BTreeMap<String, f64>>)> =
            models.iter().map(|model| (model.name.as_str(), model.perturbation())).collect();
        let discontinuity = Discontinuity::of(&physics, &perturbations, &|| !effort.watch().stopped());
        if discontinuity == Err(DiscontinuityError::Fit(FitError::GivenUp)) {
            return Err(Stopped);
        }
        Ok(Self { physics, identified, discontinuity })
    }
}

/// Distances over the marked responses; over all where none of those can be compared.
fn distances(
    responses: &[FrequencyResponse],
    measuring: &PairTable<bool>,
    effort: &Effort<'_>,
) -> Result<BundleDistance, Stopped> {
    let polar = |marked: &PairTable<bool>, steps| {
        effort.each(responses.len(), steps, |model| PolarResponse::of_marked(&responses[model], marked))
    };
    let references = |polar: &[PolarResponse]| compared_pairs(&polar.iter().collect::<Vec<_>>(), measuring);
    let mut polar_responses = polar(measuring, 1)?;
    let mut compared = references(&polar_responses);
    if compared.is_empty() {
        polar_responses = polar(&measuring.map(|_, _| true), 0)?;
        compared = references(&polar_responses);
    }
    let all: Vec<&PolarResponse> = polar_responses.iter().collect();
    let rows = effort.each(all.len(), 1, |model| distances_from(model, &all, &compared))?;
    Ok(BundleDistance::from_rows(rows, compared))
}

/// Mismatch of a physics model and the identified representative, with the J it amounts to.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelMismatch {
    /// Difference of every response that both models have.
    pub mismatch: PairTable<Option<Mismatch>>,
    /// J of the physics model as it is.
    pub cost: PairTable<Option<Cost>>,
}

impl ModelMismatch {
    fn of(simulated: &PolarResponse, reference: &PolarResponse, omega: &[f64], average: CostAverage) -> Self {
        let mismatch = mismatch_table(simulated, reference);
        let cost = mismatch.map(|_, entry| entry.as_ref().map(|entry| entry.cost(omega, GainDelay::NONE, average)));
        Self { mismatch, cost }
    }
}

/// The two representatives and how they differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Representative of the physics bundle, with scores.
    pub physics: Representative,
    /// Representative of the identified bundle, with scores.
    pub identified: Representative,
    /// The physics representative against the identified one.
    pub representative: ModelMismatch,
    /// The nominal physics model against the identified representative.
    pub nominal: ModelMismatch,
    /// G and D of the representatives.
    pub delta: Delta,
}

impl Comparison {
    /// Picks the representatives among the models kept and compares them.
    pub fn of(
        condition: &Condition,
        responses: &ConditionResponses,
        figures: &BundleFigures,
        grid: &FrequencyGrid,
        choice: &ConditionChoice,
        average: CostAverage,
    ) -> Self {
        let physics = Representative::of(&figures.physics, &choice.physics.rejected, choice.physics.pinned);
        let identified = Representative::of(&figures.identified, &choice.identified.rejected, choice.identified.pinned);
        let reference = PolarResponse::of(&responses.identified[identified.model]);
        let against = |model: usize| {
            ModelMismatch::of(&PolarResponse::of(&responses.physics[model]), &reference, grid.omega(), average)
        };
        let representative = against(physics.model);
        let nominal =
            if physics.model == condition.nominal() { representative.clone() } else { against(condition.nominal()) };
        let delta = Delta::of(&representative.mismatch, grid.omega());
        Self { physics, identified, representative, nominal, delta }
    }
}
