//! Gains and delays (M8, M9).
//!
//! ```text
//! eq. (7)   min sum w_oi (G_oi - k_o k_i)^2 + alpha sum (k_o - 1)^2
//!           with k_o k_i = G_oi where held, lb <= k <= ub
//! eq. (11)  min sum w_oi (D_oi - tau_o - tau_i)^2 + alpha sum tau_o^2
//!           with tau_o + tau_i = D_oi where held, 0 <= tau <= ub
//! o output, i input;  w 1 if the response is fitted, else 0;  alpha a setting
//! G, D the gain and the delay that match a single response;  k, tau those of the channels
//! ```
//!
//! Held values that the bounds or loops of held responses do not allow are replaced by the closest
//! *targets* in a first stage; a solution is then not `matched`.

use gdcm_method::correction::solve::solve;
use gdcm_method::correction::{Bounds, Outcome, Problem, ProofBudget, Solution};
use gdcm_model::dataset::{Pair, PairTable};

use crate::check::{CheckFault, Found};
use crate::reference::{DELAY_INSTANCES, GAIN_INSTANCES, Reference};
use crate::reference_study::ReferenceStudy;

/// Maximum relative gap between a proven bound and the minimum.
const PROOF_GAP: f64 = 1e-9;

/// Relative accuracy to which the references certify their minima.
const CERTIFIED: f64 = 1e-8;
/// On-axis responses for eq. (11), `[output, input]` (Table 2).
const ON_AXIS: [[usize; 2]; 5] = [[0, 1], [1, 0], [2, 2], [4, 2], [5, 3]];

/// Solves a problem within the default proof budget.
pub(super) fn solved(problem: &Problem) -> Result<Solution, CheckFault> {
    solve(problem, ProofBudget::default(), &|| false).map_err(CheckFault::no_result)
}

fn gain_problem(instance: &Reference) -> Result<Problem, CheckFault> {
    let bounds = Bounds {
        lower: instance.number("lb")?,
        upper: instance.number("ub")?,
    };
    let delta = instance.table("G")?.map(|_, gain| Some(*gain));
    let held = instance.table("on_axis")?.map(|_, mark| *mark != 0.0);
    Ok(Problem {
        alpha: instance.number("alpha")?,
        ..Problem::gains(delta, held, bounds)
    })
}

/// Compares minima for eq. (7) with certified ones. A minimum disagrees if it is not proven, if its
/// proven lower bound exceeds the certified minimum, or if it differs on whether the held products
/// are feasible.
pub(super) fn certified_gains(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let mut found = Found::default();
    for instance in GAIN_INSTANCES.read()?.list("instances")? {
        // Where the held products are infeasible, the answer is the minimum with the targets of
        // stage 1.
        let answer = if instance.has("two_stage") {
            instance.member("two_stage")?
        } else {
            instance.clone()
        };
        let objective = answer.number("objective")?;
        let solution = solved(&gain_problem(&instance)?)?;
        found.instance();
        found.relative(solution.objective, objective);
        let outcome = &solution.proof.outcome;
        found.agree(matches!(outcome, Outcome::Proven { gap } if *gap <= PROOF_GAP));
        found.agree(solution.proof.lower_bound <= objective * (1.0 + CERTIFIED));
        found.agree(solution.matched != instance.has("two_stage"));
    }
    Ok(found)
}

/// Compares constrained products with their targets, and gains with their bounds.
pub(super) fn held_products(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let mut found = Found::default();
    for instance in GAIN_INSTANCES.read()?.list("instances")? {
        let problem = gain_problem(&instance)?;
        let solution = solved(&problem)?;
        found.instance();
        for pair in problem.constrained.marked() {
            let product = solution.inputs[pair.input] * solution.outputs[pair.output];
            match solution.targets[pair] {
                Some(target) => found.relative(product, target),
                None => found.agree(false),
            }
        }
        let range = problem.bounds.lower..=problem.bounds.upper;
        for gain in solution.inputs.iter().chain(&solution.outputs) {
            found.agree(range.contains(gain));
        }
    }
    Ok(found)
}

/// Compares minima for eq. (11), and whether the held delays are feasible, with the results of an
/// interior-point method.
pub(super) fn certified_delays(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let mut found = Found::default();
    for instance in DELAY_INSTANCES.read()?.list("instances")? {
        let delta = instance.table("D")?.map(|_, delay_s| Some(*delay_s));
        let held = PairTable::from_fn(delta.outputs(), delta.inputs(), |pair: Pair| {
            ON_AXIS.contains(&[pair.output, pair.input])
        });
        let problem = Problem {
            alpha: instance.number("alpha")?,
            ..Problem::delays(delta, held, instance.number("ub")?)
        };
        let solution = solved(&problem)?;
        found.instance();
        found.relative(solution.objective, instance.number("objective")?);
        found.agree(solution.matched == instance.flag("matched")?);
    }
    Ok(found)
}
