//! The optimisation of gains (M8, eq. (7)), delays (M9, eq. (11)) and signed delays (M15.4):
//! comparison with independent reference values, and properties of every solution.

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

/// Solves a problem within the default budget.
fn solved(problem: &Problem) -> Solution {
    solved_within(problem, ProofBudget::default())
}

/// Solves a problem within a budget for the proof of its optimality.
fn solved_within(problem: &Problem, budget: ProofBudget) -> Solution {
    solve(problem, budget, &|| false).unwrap()
}
