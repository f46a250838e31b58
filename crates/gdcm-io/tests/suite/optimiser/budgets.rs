//! Limits on the cost of an optimality proof, and its cancellation.

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

/// Returns a pseudo-random number between -1 and 1 for an entry.
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

fn hard() -> Problem {
    gain_instances()
        .into_iter()
        .find(|instance| instance.id == 271)
        .unwrap()
        .problem
}

#[test]
fn a_budget_of_work_too_small_for_the_proof_is_admitted() {
    let least = solved(&hard()).objective;
    let solution = solved_within(
        &hard(),
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
    assert!(solution.proof.lower_bound <= least);
}

#[test]
fn a_budget_of_memory_too_small_for_the_proof_is_admitted() {
    // A node with 21 scales takes 3.9 kB.
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
fn a_greater_budget_never_gives_a_lower_bound_that_is_worse() {
    let bound = |work: u64| {
        solved_within(
            &twelve_by_eight(1),
            ProofBudget {
                work,
                ..ProofBudget::default()
            },
        )
        .proof
    };
    let bounds = [0, 100_000, 400_000, 1_600_000].map(|work| bound(work).lower_bound);
    assert!(bounds.is_sorted() && bounds[0] < bounds[3], "{bounds:?}");
}

#[test]
fn the_search_asks_whether_to_stop_at_every_half_millisecond_of_work() {
    let asked = Cell::new(0_u64);
    let count = || {
        asked.set(asked.get() + 1);
        false
    };
    let budget = ProofBudget {
        work: 2_000_000,
        ..ProofBudget::default()
    };
    let solution = solve(&twelve_by_eight(1), budget, &count).unwrap();
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
    // Queried at least every 25 000 work units: 20 000, plus a line search, which is not
    // interrupted.
    assert!(asked.get() >= 2_000_000 / 25_000, "{}", asked.get());
}

#[test]
fn a_search_that_is_stopped_has_no_answer() {
    for questions in [0, 1, 10] {
        let asked = Cell::new(0);
        let stop = || asked.replace(asked.get() + 1) >= questions;
        assert_eq!(
            solve(&twelve_by_eight(1), ProofBudget::default(), &stop),
            Err(ProblemError::Stopped)
        );
        assert!(
            asked.get() <= questions + 2,
            "{} questions after the first yes",
            asked.get() - questions
        );
    }
}

#[test]
fn toggles_that_are_stopped_within_a_proof_keep_what_is_there() {
    let problem = gain_instances()[0].problem.clone();
    let solution = solved(&problem);
    let asked = Cell::new(0);
    let stop = || asked.replace(asked.get() + 1) >= 20;
    let found = toggles(&problem, &solution, ProofBudget::default(), &stop).unwrap();
    assert!(!found.is_empty() && found.len() < 24, "{}", found.len());
}

/// Returns a dataset of static gains with twelve outputs and eight inputs; each condition has
/// different physics and identified models.
fn static_gains(conditions: usize) -> Dataset {
    let model = |name: &str, origin, seed: usize| {
        let gain = DMatrix::from_fn(12, 8, |output, input| {
            (0.7 * noise(output, input, seed)).exp()
        });
        let a = DMatrix::zeros(0, 0);
        let b = DMatrix::zeros(0, 8);
        let c = DMatrix::zeros(12, 0);
        Model::new(
            name,
            origin,
            Dynamics::StateSpace(StateSpace::new(a, b, c, gain).unwrap()),
        )
    };
    let condition = |index: usize| {
        let flight_state = FlightState {
            id: ConditionId(index as i64),
            name: format!("condition {index}"),
            airspeed_kt: 10.0 * index as f64,
            altitude: None,
            altitude_ft: None,
            weight: None,
            mass_kg: None,
        };
        let physics = model("nominal", Origin::Nominal { perturbation: None }, 2 * index);
        let flight = model(
            "flight",
            Origin::Identified {
                method: None,
                order: None,
            },
            2 * index + 1,
        );
        Condition::new(flight_state, vec![physics], vec![flight]).unwrap()
    };
    let channels = |letter: &str, count| {
        (0..count)
            .map(|index| Channel::new(format!("{letter}{index}"), ""))
            .collect()
    };
    let header = DatasetHeader {
        name: "static gains".to_owned(),
        description: String::new(),
        inputs: channels("u", 8),
        outputs: channels("y", 12),
        on_axis: PairTable::filled(12, 8, false),
        band: Band::new(0.5, 12.0).unwrap(),
        parameters: Vec::new(),
    };
    Dataset::new(header, (0..conditions).map(condition).collect()).unwrap()
}

/// Cancels after a number of queries, and counts the queries.
struct Impatient {
    patience: usize,
    asked: AtomicUsize,
}

impl Progress for Impatient {
    fn cancelled(&self) -> bool {
        self.asked.fetch_add(1, Ordering::Relaxed) >= self.patience
    }

    fn advanced(&self, _done: usize, _total: usize) {}
}

#[test]
fn an_analysis_is_stopped_in_the_middle_of_a_proof() {
    let study = Study::new(Arc::new(static_gains(20)));
    assert_eq!(
        study.settings.constrained.marked().collect::<Vec<Pair>>(),
        []
    );
    // Each condition queries only a few times outside its proof, so that query 120 occurs during
    // the first proofs.
    let watch = Impatient {
        patience: 120,
        asked: AtomicUsize::new(0),
    };
    assert_eq!(Engine::default().analyze(&study, &watch), Err(Cancelled));
    // Tasks in progress and conditions not yet begun query once more each.
    assert!(watch.asked.into_inner() <= 120 + 30);
}
