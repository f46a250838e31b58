//! The polish of a model: Levenberg and Marquardt's iteration on the cost (M14, section 4).
//!
//! ```text
//! lambda = 1e-4;  for each step:
//! 1  G, g at theta
//! 2  (G + lambda diag G) d = g; while J(theta + d) >= J(theta): lambda *= 8, at most 8 times
//! 3  theta += d, lambda /= 8; stop when J has fallen by less than 1e-3 of itself
//! ```
//!
//! Marquardt, SIAM J. Appl. Math. 11, 1963. Scale freedoms of the blocks are left to lambda.

use super::IdentificationError;
use super::blocks::BlockModel;
use super::likelihood::{Likelihood, PieceCost};
use super::normal_system::{NormalSystem, normal_systems};
use super::steps::Steps;

/// Damping at the beginning.
const FIRST_DAMPING: f64 = 1e-4;
/// Factor of the damping after a failure, and its inverse after a success.
const DAMPING_FACTOR: f64 = 8.0;
/// Failures after which a step is given up.
const FAILURES: usize = 8;
/// Share of the whole work that a step is said to be.
const SHARE: f64 = 0.02;
/// Relative gain below which the polish is at its end.
const LEAST_GAIN: f64 = 1e-3;

/// A model, its cost, and how far its polish has come.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    /// The model.
    pub(super) model: BlockModel,
    /// Each piece's part of the cost.
    pub(super) parts: Vec<PieceCost>,
    /// `J`.
    pub(super) cost: f64,
    damping: f64,
    ended: bool,
}

impl Fit {
    /// The unpolished model; none where its cost is not finite.
    pub(super) fn start(likelihood: &Likelihood, model: BlockModel) -> Option<Self> {
        let parts = likelihood.parts(&model)?;
        let cost = total(&parts);
        cost.is_finite().then_some(Self { model, parts, cost, damping: FIRST_DAMPING, ended: false })
    }

    /// The model after at most `count` further steps, each of which is told.
    pub(super) fn polished(
        mut self,
        likelihood: &Likelihood,
        count: usize,
        steps: &Steps,
    ) -> Result<Self, IdentificationError> {
        for step in 1..=count {
            if self.ended {
                break;
            }
            steps.advance(SHARE, &format!("order {}, step {step} of {count}", self.model.order()))?;
            self.step(likelihood);
        }
        Ok(self)
    }

    /// The systems of the pieces at the model.
    pub(super) fn systems(&self, likelihood: &Likelihood) -> Option<Vec<NormalSystem>> {
        normal_systems(likelihood, &self.model, &self.parts)
    }

    fn step(&mut self, likelihood: &Likelihood) {
        let before = self.cost;
        let Some(systems) = self.systems(likelihood) else {
            self.ended = true;
            return;
        };
        let mut system = NormalSystem::zero(self.model.parameters());
        systems.iter().for_each(|part| system.add(part));
        match damped(likelihood, &self.model, &system, self.cost, self.damping) {
            Some((model, parts, damping)) => {
                self.cost = total(&parts);
                (self.model, self.parts, self.damping) = (model, parts, damping / DAMPING_FACTOR);
                self.ended = self.cost > (1.0 - LEAST_GAIN) * before;
            }
            None => self.ended = true,
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
) -> Option<(BlockModel, Vec<PieceCost>, f64)> {
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

/// The sum in the order of the pieces.
fn total(parts: &[PieceCost]) -> f64 {
    parts.iter().map(|part| part.cost).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::known_answers::{answers, matrix, number, numbers, response};
    use crate::identification::normal_system::tests::known_records;
    use crate::identification::{StateSpaceMatrices, Unwatched};

    #[test]
    fn exact_lines_lead_to_the_exact_response() {
        let known = &answers()["likelihood_noise_free"];
        let of = |name: &str| matrix(&known["start"][name]);
        let start = StateSpaceMatrices { a: of("A"), b: of("B"), c: of("C"), d: of("D") };
        let likelihood = known_records(known);
        let fit = Fit::start(&likelihood, BlockModel::of(&start).unwrap()).unwrap();
        // Independent numpy code; the tolerances stand in its file.
        assert!((fit.cost / number(&known["cost_at_start"]) - 1.0).abs() < 1e-8, "{}", fit.cost);
        let count = number(&known["max_iterations"]) as usize;
        let fit = fit.polished(&likelihood, count, &Steps::new(&Unwatched)).unwrap();
        assert!(fit.cost <= number(&known["cost_after_at_most"]), "{}", fit.cost);
        for (omega, expected) in numbers(&known["w"]).into_iter().zip(response(&known["H"])) {
            assert!((fit.model.response(omega) - expected).camax() < 1e-6);
        }
    }
}
