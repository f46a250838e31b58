//! The optimiser against independent reference figures, and the properties that any answer must have.

mod budgets;
mod costs;
mod explanations;
mod instances;
mod kkt;
mod largest;
mod minima;
mod properties;
mod random;
mod reference_delays;
mod reference_gains;
mod reference_leads;

use gdcm_method::correction::solve::solve;
use gdcm_method::correction::{Problem, ProofBudget, Solution};

/// The answer within the budget that the program gives.
fn solved(problem: &Problem) -> Solution {
    solved_within(problem, ProofBudget::default())
}

fn solved_within(problem: &Problem, budget: ProofBudget) -> Solution {
    solve(problem, budget, &|| false).unwrap()
}
