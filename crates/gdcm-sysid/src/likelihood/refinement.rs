//! Model refinement: Levenberg-Marquardt iteration on the cost (M14.4).
//!
//! ```text
//! lambda = 1e-4;  for each step:
//! 1  G, g at theta
//! 2  (G + lambda diag G) d = g; while J(theta + d) >= J(theta): lambda *= 8, at most 8 times
//! 3  theta += d, lambda /= 8; stop if the relative decrease of J is below the minimum gain
//! ```
//!
//! D. W. Marquardt, "An algorithm for least-squares estimation of nonlinear parameters", SIAM J.
//! Appl. Math. 11, 1963. lambda also controls the blocks' free scales.

use gdcm_model::progress::{Cancelled, Shares};

use super::blocks::BlockModel;
use super::cost::{Likelihood, SegmentCost};
use super::linear_model::LinearModel;
use super::normal_system::{NormalSystem, normal_systems};
use crate::subspace::tried_orders::parameters_of_order;

/// Relative gain in cost below which the refinement ends; the comparison of orders of large models
/// uses another limit.
pub(crate) const LEAST_GAIN: f64 = 1e-4;
/// Damping of the first step.
pub(crate) const FIRST_DAMPING: f64 = 1e-4;
/// Damping factor after a failure, and its inverse after a success.
const DAMPING_FACTOR: f64 = 8.0;
/// Maximum number of failures of a step.
const FAILURES: usize = 8;
/// Share of the total progress that is reported for a step.
const SHARE: f64 = 0.02;

/// A model, its cost, and the state of its refinement.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub(crate) model: BlockModel,
    /// Contribution of each segment to the cost.
    pub(crate) parts: Vec<SegmentCost>,
    /// `J`.
    pub(crate) cost: f64,
    damping: f64,
    /// Relative decrease of the cost in the last step.
    gain: f64,
}

impl Fit {
    /// Starts from an unrefined model; `None` if its cost is not finite.
    pub(crate) fn start(likelihood: &Likelihood, model: BlockModel) -> Option<Self> {
        let parts = likelihood.parts(&model)?;
        let cost = total(&parts);
        if !cost.is_finite() {
            return None;
        }
        Some(Self {
            model,
            parts,
            cost,
            damping: FIRST_DAMPING,
            gain: f64::INFINITY,
        })
    }

    /// Takes at most `count` further steps, as long as each lowers the cost by the share
    /// `least_gain`.
    pub(crate) fn refined(
        mut self,
        likelihood: &Likelihood,
        count: usize,
        least_gain: f64,
        progress: &Shares,
    ) -> Result<Self, Cancelled> {
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

    /// Computes the normal systems of the segments at the model.
    pub(crate) fn systems(&self, likelihood: &Likelihood) -> Option<Vec<NormalSystem>> {
        normal_systems(likelihood, &self.model, &self.parts)
    }

    /// Returns the number of parameters, without those that only change the state basis.
    pub(crate) fn effective_parameters(&self) -> usize {
        parameters_of_order(
            self.model.order(),
            self.model.b.ncols(),
            self.model.c.nrows(),
        )
    }

    /// Returns `N - k`, the degrees of freedom that the parameters leave; `None` if they leave
    /// none.
    pub(crate) fn spare_freedom(&self, likelihood: &Likelihood) -> Option<usize> {
        let freedom = likelihood.freedom(self.model.order());
        match freedom.checked_sub(self.effective_parameters()) {
            None | Some(0) => None,
            spare => spare,
        }
    }

    fn step(&mut self, likelihood: &Likelihood) {
        let before = self.cost;
        // If this step fails, the gain stays 0, which ends the refinement.
        self.gain = 0.0;
        let Some(systems) = self.systems(likelihood) else {
            return;
        };
        let start = DampedStart {
            model: &self.model,
            system: &NormalSystem::sum(self.model.parameters(), &systems),
            cost: self.cost,
            damping: self.damping,
        };
        let Some(stepped) = start.step(likelihood) else {
            return;
        };
        self.cost = total(&stepped.parts);
        self.model = stepped.model;
        self.parts = stepped.parts;
        self.damping = stepped.damping / DAMPING_FACTOR;
        self.gain = 1.0 - self.cost / before;
    }
}

/// Starting point of a damped step.
pub(crate) struct DampedStart<'s> {
    pub(crate) model: &'s BlockModel,
    /// `G` and `g` at the model.
    pub(crate) system: &'s NormalSystem,
    /// The cost that the step has to lower.
    pub(crate) cost: f64,
    pub(crate) damping: f64,
}

/// Result of a damped step.
pub(crate) struct DampedStep {
    pub(crate) model: BlockModel,
    parts: Vec<SegmentCost>,
    /// The damping at which the cost fell.
    damping: f64,
}

impl DampedStart<'_> {
    /// Takes a step that lowers the cost; `None` after eight failures.
    pub(crate) fn step(&self, likelihood: &Likelihood) -> Option<DampedStep> {
        let mut damping = self.damping;
        for _ in 0..=FAILURES {
            if let Some(step) = self.system.damped_step(damping) {
                let model = self.model.stepped(&step);
                if let Some(parts) = likelihood.parts(&model)
                    && total(&parts) < self.cost
                {
                    return Some(DampedStep {
                        model,
                        parts,
                        damping,
                    });
                }
            }
            damping *= DAMPING_FACTOR;
        }
        None
    }
}

/// Sums the cost in segment order.
fn total(parts: &[SegmentCost]) -> f64 {
    parts.iter().map(|part| part.cost).sum()
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
        let [a, b, c, d] = ["A", "B", "C", "D"].map(|name| matrix(&known["start"][name]));
        let start = StateSpace::new(a, b, c, d).unwrap();
        let likelihood = known_records(known);
        let fit = Fit::start(&likelihood, BlockModel::from_state_space(&start).unwrap()).unwrap();
        // Reference results from independent numpy code; the file states the tolerances.
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
