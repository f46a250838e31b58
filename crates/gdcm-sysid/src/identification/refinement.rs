//! The refinement of a model: Levenberg and Marquardt's iteration on the cost (M14, section 4).
//!
//! ```text
//! lambda = 1e-4;  for each step:
//! 1  G, g at theta
//! 2  (G + lambda diag G) d = g; while J(theta + d) >= J(theta): lambda *= 8, at most 8 times
//! 3  theta += d, lambda /= 8; stop when J has fallen by less than the least gain, a share of itself
//! ```
//!
//! Marquardt, SIAM J. Appl. Math. 11, 1963. Scale freedoms of the blocks are left to lambda.

use std::collections::BTreeMap;

use gdcm_model::progress::Shares;

use super::blocks::BlockModel;
use super::cautions::IdentificationCaution;
use super::diagnostics::fits_of_records;
use super::identify::{IdentificationError, Options};
use super::likelihood::{Likelihood, SegmentCost, SpectralLines};
use super::normal_system::{NormalSystem, normal_systems};
use super::order::{LEAST_GAIN, OrderSearch};
use super::prepared_data::PreparedData;
use super::subspace::{Candidate, StabilisationPoint, stabilisation};

/// Damping at the beginning.
const FIRST_DAMPING: f64 = 1e-4;
/// Factor of the damping after a failure, and its inverse after a success.
const DAMPING_FACTOR: f64 = 8.0;
/// Failures after which a step is given up.
const FAILURES: usize = 8;
/// Share of the whole work that a step is said to be.
const SHARE: f64 = 0.02;

/// A model, its cost, and how far its refinement has come.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    /// The model.
    pub(super) model: BlockModel,
    /// Each segment's part of the cost.
    pub(super) parts: Vec<SegmentCost>,
    /// `J`.
    pub(super) cost: f64,
    damping: f64,
    /// Share of the cost that the last step gained.
    gain: f64,
}

impl Fit {
    /// The unrefined model; none where its cost is not finite.
    pub(super) fn start(likelihood: &Likelihood, model: BlockModel) -> Option<Self> {
        let parts = likelihood.parts(&model)?;
        let cost = total(&parts);
        cost.is_finite().then_some(Self {
            model,
            parts,
            cost,
            damping: FIRST_DAMPING,
            gain: f64::INFINITY,
        })
    }

    /// The model after at most `count` further steps, each of which is told, as long as each gains `least_gain` of the cost.
    pub(super) fn refined(
        mut self,
        likelihood: &Likelihood,
        count: usize,
        least_gain: f64,
        progress: &Shares,
    ) -> Result<Self, IdentificationError> {
        for step in 1..=count {
            if self.gain < least_gain {
                break;
            }
            progress.advance(
                SHARE,
                &format!("order {}, step {step} of {count}", self.model.order()),
            )?;
            self.step(likelihood);
        }
        Ok(self)
    }

    /// The systems of the segments at the model.
    pub(super) fn systems(&self, likelihood: &Likelihood) -> Option<Vec<NormalSystem>> {
        normal_systems(likelihood, &self.model, &self.parts)
    }

    fn step(&mut self, likelihood: &Likelihood) {
        let before = self.cost;
        let Some(systems) = self.systems(likelihood) else {
            self.gain = 0.0;
            return;
        };
        let system = NormalSystem::sum(self.model.parameters(), &systems);
        match damped(likelihood, &self.model, &system, self.cost, self.damping) {
            Some((model, parts, damping)) => {
                self.cost = total(&parts);
                (self.model, self.parts, self.damping) = (model, parts, damping / DAMPING_FACTOR);
                self.gain = 1.0 - self.cost / before;
            }
            None => self.gain = 0.0,
        }
    }
}

/// The model after one damped step that lowers the cost, its parts of the cost, and the damping that it took; none after
/// eight failures.
pub(super) fn damped(
    likelihood: &Likelihood,
    model: &BlockModel,
    system: &NormalSystem,
    cost: f64,
    damping: f64,
) -> Option<(BlockModel, Vec<SegmentCost>, f64)> {
    let mut damping = damping;
    for _ in 0..=FAILURES {
        if let Some(step) = system.damped_step(damping) {
            let stepped = model.stepped(&step);
            if let Some(parts) = likelihood.parts(&stepped)
                && total(&parts) < cost
            {
                return Some((stepped, parts, damping));
            }
        }
        damping *= DAMPING_FACTOR;
    }
    None
}

/// The sum in the order of the segments.
fn total(parts: &[SegmentCost]) -> f64 {
    parts.iter().map(|part| part.cost).sum()
}

// From models that CT-PBSID proposes to the recommended one (M14, section 7).

/// Steps of the refinement for the chosen order at most, after those of the comparison.
const FURTHER_STEPS: usize = 15;
/// Steps after records were weighed anew.
const STEPS_AFTER_WEIGHING: usize = 3;
/// Greatest over least cost per degree of freedom of records that weigh alike.
const ALIKE: f64 = 1.5;

/// The models that CT-PBSID proposes.
pub(super) struct Proposal {
    /// Best Laguerre pole \[rad/s\].
    pub(super) laguerre_pole: f64,
    /// Best past window.
    pub(super) past: usize,
    /// The cheapest model of each order.
    pub(super) starts: BTreeMap<usize, Fit>,
    /// Poles over orders at the best pole and past window.
    pub(super) stabilisation: Vec<StabilisationPoint>,
}

/// The chosen order, refined.
pub(super) struct Refinement<'a> {
    /// The orders that were compared.
    pub(super) search: OrderSearch,
    /// The recommended model.
    pub(super) fit: Fit,
    /// The same before records were weighed anew, where they were: its likelihood is that of the data.
    pub(super) before_weighing: Option<Fit>,
    /// The cost that it is the minimum of.
    pub(super) likelihood: Likelihood<'a>,
    /// What was done to the weights.
    pub(super) caution: Option<IdentificationCaution>,
}

/// Runs CT-PBSID for every pole and past window; shows a first model.
pub(super) fn propose(
    data: &PreparedData,
    options: &Options,
    progress: &Shares,
) -> Result<Proposal, IdentificationError> {
    let settings = data.subspace_settings(options);
    progress.next(0.1, "projections")?;
    let candidates = settings.candidates(&data.segments, &data.likelihood, progress)?;
    progress.next(0.3, "models of all orders")?;
    let best = candidates.first().ok_or_else(|| data.no_model())?;
    let starts = settings.starts(&candidates, &data.likelihood);
    let first = OrderSearch::first(&starts, &data.likelihood).ok_or_else(|| data.no_model())?;
    if let Some(first) = data.in_units(&first.model) {
        progress.progress().first_model(&first);
    }
    let stabilisation = stabilisation(&settings.poles_by_order(best, data.likelihood.executor));
    let &Candidate {
        pole: laguerre_pole,
        past,
        ..
    } = best;
    Ok(Proposal {
        laguerre_pole,
        past,
        starts,
        stabilisation,
    })
}

/// Chooses the order and polishes its model further.
pub(super) fn refine<'a>(
    data: &PreparedData<'a>,
    proposal: &Proposal,
    progress: &Shares,
) -> Result<Refinement<'a>, IdentificationError> {
    progress.next(0.4, "order")?;
    let search = data
        .search_order(&proposal.starts, progress)?
        .ok_or_else(|| data.no_model())?;
    let chosen = search
        .fits
        .get(&search.order)
        .ok_or_else(|| data.no_model())?
        .clone();
    progress.next(0.7, "refinement")?;
    let fit = chosen.refined(&data.likelihood, FURTHER_STEPS, LEAST_GAIN, progress)?;
    let likelihood = data.likelihood.clone();
    let before_weighing = None;
    let unweighed = Refinement {
        search,
        fit,
        before_weighing,
        likelihood,
        caution: None,
    };
    Ok(
        match reweighed(&data.likelihood, &unweighed.fit, progress)? {
            Some((likelihood, fit, caution)) => {
                let before_weighing = Some(unweighed.fit);
                Refinement {
                    fit,
                    before_weighing,
                    likelihood,
                    caution: Some(caution),
                    ..unweighed
                }
            }
            None => unweighed,
        },
    )
}

/// Weighs records of unlike turbulence by what the model leaves of them, once; none where they are alike.
///
/// ```text
/// Cv_r <- Cv_r (J_r/dof_r) / geometric mean of J/dof
/// ```
fn reweighed<'a>(
    likelihood: &Likelihood<'a>,
    fit: &Fit,
    progress: &Shares,
) -> Result<Option<(Likelihood<'a>, Fit, IdentificationCaution)>, IdentificationError> {
    let costs: Vec<f64> = fits_of_records(likelihood, &fit.model, &fit.parts, false)
        .iter()
        .map(|record| record.cost)
        .collect();
    let (least, greatest) = costs.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), cost| {
        (a.min(*cost), b.max(*cost))
    });
    if !(least > 0.0 && greatest > ALIKE * least) {
        return Ok(None);
    }
    let mean = (costs.iter().map(|cost| cost.ln()).sum::<f64>() / costs.len() as f64).exp();
    let records = likelihood.records();
    let weigh = |segment: &SpectralLines| {
        let cost = records
            .iter()
            .position(|record| *record == segment.record)
            .and_then(|k| costs.get(k));
        cost.map_or_else(|| segment.clone(), |cost| segment.with_noise(cost / mean))
    };
    let weighed = Likelihood {
        segments: likelihood.segments.iter().map(weigh).collect(),
        executor: likelihood.executor,
    };
    let Some(start) = Fit::start(&weighed, fit.model.clone()) else {
        return Ok(None);
    };
    let fit = start.refined(&weighed, STEPS_AFTER_WEIGHING, LEAST_GAIN, progress)?;
    Ok(Some((
        weighed,
        fit,
        IdentificationCaution::Reweighed(greatest / least),
    )))
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::state_space::StateSpace;
    use gdcm_model::progress::Unobserved;

    use super::*;
    use crate::identification::known_answers_tests::{
        answers, known_records, matrix, number, numbers, response,
    };

    #[test]
    fn exact_lines_lead_to_the_exact_response() {
        let known = &answers()["likelihood_noise_free"];
        let of = |name: &str| matrix(&known["start"][name]);
        let start = StateSpace::new(of("A"), of("B"), of("C"), of("D")).unwrap();
        let likelihood = known_records(known);
        let fit = Fit::start(&likelihood, BlockModel::of(&start).unwrap()).unwrap();
        // Independent numpy code; the tolerances stand in its file.
        assert!(
            (fit.cost / number(&known["cost_at_start"]) - 1.0).abs() < 1e-8,
            "{}",
            fit.cost
        );
        let count = number(&known["max_iterations"]) as usize;
        let fit = fit
            .refined(&likelihood, count, LEAST_GAIN, &Shares::new(&Unobserved))
            .unwrap();
        assert!(
            fit.cost <= number(&known["cost_after_at_most"]),
            "{}",
            fit.cost
        );
        for (omega, expected) in numbers(&known["w"]).into_iter().zip(response(&known["H"])) {
            assert!((fit.model.response(omega) - expected).camax() < 1e-6);
        }
    }
}
