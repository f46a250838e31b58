//! The stages of a condition's analysis that do not depend on constraints, alpha or bounds.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use nalgebra::Complex;

use gdcm_method::correction::delta::{Delta, delta_gains, mismatch_table};
use gdcm_method::fidelity::absolute_deviations::FitError;
use gdcm_method::fidelity::distance::{
    BundleDistance, ComparedModel, DiscontinuityError, MeasuredPairs, Representative,
    distances_from,
};
use gdcm_method::fidelity::{CoherenceWeights, Cost, CostAverage, Discontinuity, Mismatch};
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Dynamics, Pair, PairTable};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, GainDelay, PolarResponse};

use super::condition_responses::ConditionResponses;
use super::execution::Execution;
use crate::decisions::study::{BundleChoice, ConditionChoice, Study};
use crate::results::analysis::ConditionFailure;
use crate::results::caution;
use crate::results::caution::{BundleModel, Caution, GainOutOfRange, Undefined};

/// Distances within each bundle and discontinuity ratios of the physics bundle, independent of
/// rejections.
#[derive(Clone, Debug, PartialEq)]
pub struct BundleMetrics {
    pub physics: BundleDistance,
    pub identified: BundleDistance,
    /// Discontinuity ratios of the physics models, or why there are none.
    pub discontinuity: Result<Discontinuity, DiscontinuityError>,
}

impl BundleMetrics {
    /// Computes the distances over the responses marked in `measuring`, two steps for each model.
    /// Measured models are compared with coherence weights where a threshold is set (M4a).
    pub fn of(
        condition: &Condition,
        responses: &ConditionResponses,
        measuring: &PairTable<bool>,
        (grid, coherence): (&FrequencyGrid, Option<f64>),
        execution: &Execution<'_>,
    ) -> Result<Self, Cancelled> {
        let distances = |kind| {
            let models = condition.bundle(kind).iter();
            let coherence_weights = models
                .map(|model| CoherenceWeights::of_model(&model.dynamics, grid.omega(), coherence));
            distances(
                responses.bundle(kind),
                &coherence_weights.collect::<Vec<_>>(),
                measuring,
                execution,
            )
        };
        let physics = distances(BundleKind::Physics)?;
        let identified = distances(BundleKind::Identified)?;
        let models = condition.bundle(BundleKind::Physics);
        let perturbations: Vec<(&str, Option<&BTreeMap<String, f64>>)> = models
            .iter()
            .map(|model| (model.name.as_str(), model.perturbation()))
            .collect();
        let discontinuity = Discontinuity::fit(&physics, &perturbations, &|| {
            execution.progress().cancelled()
        });
        if discontinuity == Err(DiscontinuityError::Fit(FitError::Cancelled)) {
            return Err(Cancelled);
        }
        Ok(Self {
            physics,
            identified,
            discontinuity,
        })
    }

    /// Returns the distances of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &BundleDistance {
        kind.pick(&self.physics, &self.identified)
    }
}

/// Returns the marked responses of every model, or all responses where no model has a marked one;
/// and the missing responses of each model.
fn measured_pairs(
    responses: &[Arc<FrequencyResponse>],
    measuring: &PairTable<bool>,
    execution: &Execution<'_>,
) -> Result<(Vec<PolarResponse>, MeasuredPairs), Cancelled> {
    let polar = |marked: &PairTable<bool>, steps| {
        execution.each(responses.len(), steps, |model| {
            PolarResponse::from_marked(&responses[model], marked)
        })
    };
    let marked = polar(measuring, 1)?;
    let measured = MeasuredPairs::new(&marked, measuring);
    if !measured.compared.is_empty() {
        return Ok((marked, measured));
    }
    let all = measuring.map(|_, _| true);
    let polar_responses = polar(&all, 0)?;
    let measured = MeasuredPairs::new(&polar_responses, &all);
    Ok((polar_responses, measured))
}

fn distances(
    responses: &[Arc<FrequencyResponse>],
    coherence_weights: &[Option<PairTable<CoherenceWeights>>],
    measuring: &PairTable<bool>,
    execution: &Execution<'_>,
) -> Result<BundleDistance, Cancelled> {
    let (polar, measured) = measured_pairs(responses, measuring, execution)?;
    let model = |model: usize| ComparedModel {
        responses: &polar[model],
        coherence_weights: coherence_weights[model].as_ref(),
    };
    let compared: Vec<ComparedModel<'_>> =
        measured.compared_models().into_iter().map(model).collect();
    let rows = execution.each(compared.len(), 1, |place| {
        distances_from(place, &compared, &measured.compared)
    })?;
    execution.step(polar.len() - compared.len());
    Ok(BundleDistance::from_rows(rows, measured))
}

/// Returns the cautions about the models alone, condition by condition: responses that cannot be
/// computed or compared in the study's band.
pub fn cautions_of_models(
    study: &Study,
    execution: &Execution<'_>,
) -> Result<Vec<(ConditionId, Caution)>, Cancelled> {
    let grid = (study.settings.band, study.settings.points);
    let measuring = study.dataset.measuring_pairs();
    let mut cautions = Vec::new();
    for condition in study.dataset.conditions() {
        let responses = ConditionResponses::of(condition, grid, execution)?;
        for kind in BundleKind::BOTH {
            let (_, measured) = measured_pairs(responses.bundle(kind), &measuring, execution)?;
            let choice = study.choice(condition.id()).bundle(kind);
            let of_bundle = caution::of_models(
                condition,
                choice,
                kind,
                responses.bundle(kind),
                &measured,
                grid.0.max(),
            );
            let of_positions = Caution::of_positions(condition, choice, kind);
            cautions.extend(
                of_bundle
                    .into_iter()
                    .chain(of_positions)
                    .map(|caution| (condition.id(), caution)),
            );
        }
        let out_of_range = gains_out_of_range(condition, &responses, study.choice(condition.id()));
        cautions.extend(out_of_range.map(|caution| (condition.id(), caution)));
    }
    Ok(cautions)
}

/// Returns the gains out of the computable range, between the nominal physics model and the first
/// kept identified model with any.
fn gains_out_of_range(
    condition: &Condition,
    responses: &ConditionResponses,
    choice: &ConditionChoice,
) -> Option<Caution> {
    let nominal = condition.nominal();
    let physics = PolarResponse::new(&responses.bundle(BundleKind::Physics)[nominal]);
    let identified = condition
        .bundle(BundleKind::Identified)
        .iter()
        .zip(responses.bundle(BundleKind::Identified));
    for (model, response) in
        identified.filter(|(model, _)| !choice.identified.rejected.contains(&model.name))
    {
        let responses = GainOutOfRange::of_models(&physics, &PolarResponse::new(response));
        if !responses.is_empty() {
            let physics = condition.bundle(BundleKind::Physics)[nominal].name.clone();
            return Some(Caution::GainsOutOfRange {
                physics,
                identified: model.name.clone(),
                responses,
            });
        }
    }
    None
}

/// Mismatch of a physics model and the identified representative, with the resulting J.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelMismatch {
    /// Difference of every response that both models have.
    pub mismatch: PairTable<Option<Mismatch>>,
    /// J of the uncorrected physics model.
    pub cost: PairTable<Option<Cost>>,
}

impl ModelMismatch {
    fn of(simulated: &Compared, reference: &Compared, omega: &[f64], average: CostAverage) -> Self {
        let mismatch = simulated.against(reference);
        let cost = mismatch.map(|_, entry| {
            entry
                .as_ref()
                .map(|entry| entry.cost(omega, GainDelay::NONE, average))
        });
        Self { mismatch, cost }
    }
}

/// The two representatives and their differences.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    pub physics: Representative,
    pub identified: Representative,
    /// The physics representative against the identified one.
    pub representative: ModelMismatch,
    /// The nominal physics model against the identified representative.
    pub nominal: ModelMismatch,
    /// G and D of the representatives.
    pub delta: Delta,
    /// Why a response has no G and no D, where it has none.
    pub undefined: PairTable<Option<Undefined>>,
    /// Cautions about the models, independent of the constraints.
    pub cautions: Vec<Caution>,
}

impl Comparison {
    /// Selects the representatives among the kept models and compares them, with the identified
    /// representative's coherence weights where a threshold is set (M4a).
    pub fn of(
        condition: &Condition,
        responses: &ConditionResponses,
        figures: &BundleMetrics,
        grid: &FrequencyGrid,
        choice: &ConditionChoice,
        (average, coherence): (CostAverage, Option<f64>),
    ) -> Result<Self, ConditionFailure> {
        if !condition.has_reference() {
            return Err(ConditionFailure::NoReference);
        }
        let top = grid.omega().last().copied().unwrap_or_default();
        let of_kind = |kind| {
            let measured = figures.bundle(kind).measured();
            let choice = choice.bundle(kind);
            let mut cautions = caution::of_models(
                condition,
                choice,
                kind,
                responses.bundle(kind),
                measured,
                top,
            );
            cautions.extend(Caution::of_positions(condition, choice, kind));
            cautions
        };
        let mut cautions: Vec<Caution> = BundleKind::BOTH.into_iter().flat_map(of_kind).collect();
        let representative = |kind: BundleKind| {
            let position = |name: &String| condition.position(kind, name);
            let BundleChoice {
                rejected, pinned, ..
            } = choice.bundle(kind);
            let rejected: BTreeSet<usize> = rejected.iter().filter_map(position).collect();
            let representative = Representative::select(
                figures.bundle(kind),
                &rejected,
                pinned.as_ref().and_then(position),
            );
            representative.ok_or(ConditionFailure::AllSetAside { bundle: kind })
        };
        let physics = representative(BundleKind::Physics)?;
        let identified = representative(BundleKind::Identified)?;
        let flight = &condition.bundle(BundleKind::Identified)[identified.model].dynamics;
        let compared =
            |kind, model| Compared::of(condition, responses, (kind, model), (grid, coherence));
        let reference = compared(BundleKind::Identified, identified.model);
        let simulated = compared(BundleKind::Physics, physics.model);
        let against =
            |simulated: &Compared| ModelMismatch::of(simulated, &reference, grid.omega(), average);
        let representative = against(&simulated);
        let nominal = condition.nominal();
        let nominal = if physics.model == nominal {
            representative.clone()
        } else {
            against(&compared(BundleKind::Physics, nominal))
        };
        let delta = Delta::new(&representative.mismatch, grid.omega());
        let why = |pair: Pair| match flight {
            Dynamics::Measured(response) if !response.is_measured(pair) => Undefined::NotMeasured,
            _ => why_undefined(&simulated, &reference, pair),
        };
        let undefined = delta
            .gain
            .map(|pair, gain| gain.is_none().then(|| why(pair)));
        let mut out_of_range = GainOutOfRange::of_models(&simulated.polar, &reference.polar);
        // A gain may be out of range where coherence excludes the response.
        out_of_range.retain(|of| delta.gain[of.pair].is_none());
        if !out_of_range.is_empty() {
            let name = |kind: BundleKind, model: usize| condition.bundle(kind)[model].name.clone();
            cautions.push(Caution::GainsOutOfRange {
                physics: name(BundleKind::Physics, physics.model),
                identified: name(BundleKind::Identified, identified.model),
                responses: out_of_range,
            });
        }
        cautions.extend(coherence_caution(flight, &reference, grid.len(), coherence));
        for (kind, model, compared) in [
            (BundleKind::Physics, physics.model, &simulated),
            (BundleKind::Identified, identified.model, &reference),
        ] {
            let responses: Vec<Pair> = compared.nothing.marked().collect();
            if !responses.is_empty() {
                cautions.push(Caution::NumericallyNothing {
                    model: BundleModel::of(condition, kind, model),
                    responses,
                });
            }
        }
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
}

impl Comparison {
    /// Returns the same comparison, with G of each response the mean (of its logarithm) over all
    /// pairs of a kept physics and a kept identified model that have the response.
    pub(crate) fn with_mean_gains(
        mut self,
        condition: &Condition,
        responses: &ConditionResponses,
        grid: &FrequencyGrid,
        coherence: Option<f64>,
    ) -> Self {
        let kept = |kind, of: &Representative| -> Vec<Compared> {
            let kept = (0..of.scores.len()).filter(|&model| of.scores[model].is_some());
            kept.map(|model| Compared::of(condition, responses, (kind, model), (grid, coherence)))
                .collect()
        };
        let physics = kept(BundleKind::Physics, &self.physics);
        let identified = kept(BundleKind::Identified, &self.identified);
        let mut sums = self.delta.gain.map(|_, _| (0.0, 0_usize));
        for (simulated, reference) in physics
            .iter()
            .flat_map(|a| identified.iter().map(move |b| (a, b)))
        {
            for (pair, gain) in delta_gains(&simulated.against(reference)).iter() {
                let Some(gain) = gain else { continue };
                let (sum, count) = &mut sums[pair];
                *sum += gain.ln();
                *count += 1;
            }
        }
        let mean = |(sum, count): (f64, usize)| (sum / count as f64).exp();
        self.delta.gain = self
            .delta
            .gain
            .map(|pair, gain| gain.and(Some(mean(sums[pair]))));
        self
    }
}

/// Returns why a response of two representatives has no G and no D.
fn why_undefined(simulated: &Compared, reference: &Compared, pair: Pair) -> Undefined {
    for (bundle, compared) in [
        (BundleKind::Physics, simulated),
        (BundleKind::Identified, reference),
    ] {
        if compared.nothing[pair] {
            return Undefined::NumericallyNothing(bundle);
        }
    }
    for (bundle, compared) in [
        (BundleKind::Physics, simulated),
        (BundleKind::Identified, reference),
    ] {
        if let Some(absence) = compared.absence(pair) {
            return match absence {
                Absence::Zero => Undefined::Zero(bundle),
                Absence::ZeroSomewhere => Undefined::ZeroSomewhere(bundle),
                Absence::NotFinite => Undefined::NotFinite(bundle),
            };
        }
    }
    match GainOutOfRange::of_pair(&simulated.polar, &reference.polar, pair) {
        Some(GainOutOfRange { power_of_ten, .. }) if reference.left(pair) != Some(0) => {
            Undefined::GainOutOfRange(power_of_ten)
        }
        // Both have the response, and no frequency has weight.
        _ => Undefined::NotCoherent,
    }
}

/// Returns the caution about frequencies that coherence excludes from the comparison with a
/// reference (M4a).
fn coherence_caution(
    flight: &Dynamics,
    reference: &Compared,
    points: usize,
    coherence: Option<f64>,
) -> Option<Caution> {
    let Dynamics::Measured(response) = flight else {
        return None;
    };
    response.coherence()?;
    let Some(threshold) = coherence else {
        return Some(Caution::CoherenceNotUsed);
    };
    let pairs = reference
        .polar
        .curves()
        .pairs()
        .filter(|pair| reference.has(*pair));
    let left: Vec<(Pair, usize)> = pairs
        .filter_map(|pair| Some((pair, reference.left(pair)?)))
        .collect();
    let weighed = left.iter().filter(|(_, count)| *count > 0).count();
    let left_out = left.into_iter().map(|(pair, count)| (pair, points - count));
    let mut left_out: Vec<(Pair, usize)> = left_out.filter(|(_, count)| *count > 0).collect();
    left_out.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    (!left_out.is_empty()).then_some(Caution::NotCoherent {
        threshold,
        weighed,
        left_out,
        points,
    })
}

/// Difference of every response that two models have.
pub(crate) type Mismatches = PairTable<Option<Mismatch>>;

/// Why a response has no magnitude in dB at every frequency.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Absence {
    Zero,
    ZeroSomewhere,
    NotFinite,
}

impl Absence {
    /// Classifies a response that is zero, or not finite, at one frequency at least.
    fn of(values: &[Complex<f64>]) -> Self {
        let mut finite = values.iter().filter(|value| value.is_finite()).peekable();
        if finite.peek().is_some() && finite.all(|value| value.norm() == 0.0) {
            return Self::Zero;
        }
        if values.iter().all(|value| value.is_finite()) {
            Self::ZeroSomewhere
        } else {
            Self::NotFinite
        }
    }
}

/// A model prepared for comparison, without its numerically zero responses.
pub(crate) struct Compared {
    polar: PolarResponse,
    absent: PairTable<Option<Absence>>,
    nothing: PairTable<bool>,
    /// Weights of the frequencies, where coherence is used.
    coherence_weights: Option<PairTable<CoherenceWeights>>,
}

impl Compared {
    /// Prepares a model of a bundle; an identified model with coherence weights where a threshold
    /// is set (M4a).
    pub(crate) fn of(
        condition: &Condition,
        responses: &ConditionResponses,
        (kind, model): (BundleKind, usize),
        (grid, coherence): (&FrequencyGrid, Option<f64>),
    ) -> Self {
        let response = responses.compared(kind, model);
        let mut polar = PolarResponse::new(&response);
        let absent = polar.curves().map(|pair, curve| match curve {
            Some(_) => None,
            None => Some(Absence::of(response.curve(pair))),
        });
        let nothing = polar.numerically_nothing();
        polar.clear(&nothing);
        let coherence = coherence.filter(|_| kind == BundleKind::Identified);
        let dynamics = &condition.bundle(kind)[model].dynamics;
        Self {
            polar,
            absent,
            nothing,
            coherence_weights: CoherenceWeights::of_model(dynamics, grid.omega(), coherence),
        }
    }

    /// Computes the mismatches against a reference, response by response.
    pub(crate) fn against(&self, reference: &Self) -> Mismatches {
        mismatch_table(
            &self.polar,
            &reference.polar,
            reference.coherence_weights.as_ref(),
        )
    }

    fn has(&self, pair: Pair) -> bool {
        self.polar.curves()[pair].is_some()
    }

    /// Returns why the unmodified model lacks a response; `None` where it has it, even if
    /// numerically zero.
    fn absence(&self, pair: Pair) -> Option<Absence> {
        self.absent[pair]
    }

    /// Returns the number of frequencies with weight in a response, where coherence is used.
    fn left(&self, pair: Pair) -> Option<usize> {
        self.coherence_weights
            .as_ref()
            .map(|coherence_weights| coherence_weights[pair].weights.len())
    }
}
