//! Limits on the work and memory of an optimality proof, and its cancellation.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::DMatrix;

use gdcm_method::correction::branch_and_bound::proof_budget::Limit;
use gdcm_method::correction::problem::ProblemError;
use gdcm_method::correction::solve::solve;
use gdcm_method::correction::toggles::toggles;
use gdcm_method::correction::{Bounds, Outcome, Problem, ProofBudget};
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::dataset::DatasetHeader;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{
    Band, Channel, Condition, ConditionId, Dataset, Dynamics, Model, Pair, PairTable, StateSpace,
};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::{Engine, Study};

use super::instances::gain_instances;
use super::{solved, solved_within};

/// Returns a number between -1 and 1 for an entry, irregular but reproducible.
fn noise(output: usize, input: usize, seed: usize) -> f64 {
    (12.9898 * output as f64 + 78.233 * input as f64 + 37.719 * seed as f64).sin()
}

/// Returns a problem with twelve outputs and eight inputs, without constraints.
fn twelve_by_eight(seed: usize) -> Problem {
    let delta = PairTable::from_fn(12, 8, |pair| {
        Some((0.7 * noise(pair.output, pair.input, seed)).exp())
    });
    Problem::gains(
        delta,
        PairTable::filled(12, 8, false),
        Bounds {
            lower: 0.3,
            upper: 3.0,
        },
    )
}

/// Returns a reference instance whose proof exceeds small budgets.
fn hard_problem() -> Problem {
    gain_instances()
        .into_iter()
        .find(|instance| instance.id == 271)
        .unwrap()
        .problem
}

#[test]
fn a_proof_that_exceeds_its_work_budget_is_reported_as_incomplete() {
    let minimum = solved(&hard_problem()).objective;
    let solution = solved_within(
        &hard_problem(),
        ProofBudget {
            work: 4_000,
            ..ProofBudget::default()
        },
    );
    let Outcome::NotProven { gap, limit } = solution.proof.outcome else {
        panic!("{:?}", solution.proof)
    };
    assert!(
        gap > 1e-9 && gap < 1.0 && limit == Limit::Work,
        "{:?}",
        solution.proof.outcome
    );
    assert!(solution.proof.nodes > 0 && !solution.proof.all_minima);
    assert!(solution.proof.lower_bound <= minimum);
}

#[test]
fn a_proof_that_exceeds_its_memory_budget_is_reported_as_incomplete() {
    // A node with 21 scales takes 3.9 kB, so that about a dozen nodes fit.
    let solution = solved_within(
        &twelve_by_eight(0),
        ProofBudget {
            bytes: 50_000,
            ..ProofBudget::default()
        },
    );
    let Outcome::NotProven { gap, limit } = solution.proof.outcome else {
        panic!("{:?}", solution.proof)
    };
    assert!(
        gap > 1e-9 && gap < 1.0 && limit == Limit::Memory,
        "{:?}",
        solution.proof.outcome
    );
    assert!(solution.proof.lower_bound > 0.0);
}

#[test]
fn a_larger_work_budget_never_lowers_the_lower_bound() {
    let bounds = [0, 100_000, 400_000, 1_600_000].map(|work| {
        let budget = ProofBudget {
            work,
            ..ProofBudget::default()
        };
        solved_within(&twelve_by_eight(1), budget).proof.lower_bound
    });
    assert!(bounds.is_sorted() && bounds[0] < bounds[3], "{bounds:?}");
}

#[test]
fn the_search_polls_for_cancellation_at_least_every_25_000_units_of_work() {
    let polls = Cell::new(0_u64);
    let count_poll = || {
        polls.set(polls.get() + 1);
        false
    };
    let budget = ProofBudget {
        work: 2_000_000,
        ..ProofBudget::default()
    };
    let solution = solve(&twelve_by_eight(1), budget, &count_poll).unwrap();
    assert!(
        matches!(
            solution.proof.outcome,
            Outcome::NotProven {
                limit: Limit::Work,
                ..
            }
        ),
        "{:?}",
        solution.proof
    );
    // The search polls every 20 000 units, about half a millisecond; a line search, which is not
    // interrupted, may add to them.
    assert!(polls.get() >= 2_000_000 / 25_000, "{} polls", polls.get());
}

#[test]
fn a_cancelled_search_has_no_solution() {
    for refusals in [0, 1, 10] {
        let polls = Cell::new(0);
        let stop = || polls.replace(polls.get() + 1) >= refusals;
        assert_eq!(
            solve(&twelve_by_eight(1), ProofBudget::default(), &stop),
            Err(ProblemError::Stopped)
        );
        assert!(
            polls.get() <= refusals + 2,
            "polled {} times after the request to stop",
            polls.get() - refusals
        );
    }
}

#[test]
fn toggles_cancelled_during_a_proof_keep_those_found_before() {
    let problem = gain_instances()[0].problem.clone();
    let solution = solved(&problem);
    let polls = Cell::new(0);
    let stop = || polls.replace(polls.get() + 1) >= 20;
    let found = toggles(&problem, &solution, ProofBudget::default(), &stop).unwrap();
    // Completed, there are 24: one for each entry of 6 outputs and 4 inputs.
    assert!(!found.is_empty() && found.len() < 24, "{}", found.len());
}

/// Returns a model without states, whose gains depend on `seed`.
fn static_model(name: &str, origin: Origin, seed: usize) -> Model {
    let a = DMatrix::zeros(0, 0);
    let b = DMatrix::zeros(0, 8);
    let c = DMatrix::zeros(12, 0);
    let d = DMatrix::from_fn(12, 8, |output, input| {
        (0.7 * noise(output, input, seed)).exp()
    });
    let state_space = StateSpace::new(a, b, c, d).unwrap();
    Model::new(name, origin, Dynamics::StateSpace(state_space))
}

fn static_condition(index: usize) -> Condition {
    let flight_state = FlightState {
        id: ConditionId(index as i64),
        name: format!("condition {index}"),
        airspeed_kt: 10.0 * index as f64,
        altitude: None,
        altitude_ft: None,
        weight: None,
        mass_kg: None,
    };
    let nominal = Origin::Nominal { perturbation: None };
    let identified = Origin::Identified {
        method: None,
        order: None,
    };
    let physics = static_model("nominal", nominal, 2 * index);
    let flight = static_model("flight", identified, 2 * index + 1);
    Condition::new(flight_state, vec![physics], vec![flight]).unwrap()
}

fn channels(letter: &str, count: usize) -> Vec<Channel> {
    (0..count)
        .map(|index| Channel::new(format!("{letter}{index}"), ""))
        .collect()
}

/// Returns a dataset of static gains with twelve outputs and eight inputs; each condition has
/// different physics and identified models.
fn static_gains(conditions: usize) -> Dataset {
    let header = DatasetHeader {
        name: "static gains".to_owned(),
        description: String::new(),
        inputs: channels("u", 8),
        outputs: channels("y", 12),
        on_axis: PairTable::filled(12, 8, false),
        band: Band::new(0.5, 12.0).unwrap(),
        parameters: Vec::new(),
    };
    Dataset::new(header, (0..conditions).map(static_condition).collect()).unwrap()
}

/// Cancels after a number of polls, and counts the polls.
struct Impatient {
    patience: usize,
    polls: AtomicUsize,
}

impl Progress for Impatient {
    fn cancelled(&self) -> bool {
        self.polls.fetch_add(1, Ordering::Relaxed) >= self.patience
    }

    fn advanced(&self, _done: usize, _total: usize) {}
}

#[test]
fn an_analysis_is_cancelled_in_the_middle_of_a_proof() {
    let study = Study::new(Arc::new(static_gains(20)));
    assert_eq!(
        study.settings.constrained.marked().collect::<Vec<Pair>>(),
        []
    );
    // Each condition polls only a few times outside its proof, so that poll 120 occurs during the
    // first proofs.
    let watch = Impatient {
        patience: 120,
        polls: AtomicUsize::new(0),
    };
    assert_eq!(Engine::default().analyze(&study, &watch), Err(Cancelled));
    // Tasks in progress and the conditions not yet begun, 20 in all, poll once more each.
    assert!(watch.polls.into_inner() <= 120 + 30);
}
