//! Problems with the maximum number of channels of a dataset.

use gdcm_method::correction::conflict::ConflictKind;
use gdcm_method::correction::sensitivity::{ActiveConstraint, sensitivities};
use gdcm_method::correction::{Bounds, Channel, Outcome, Problem, ProofBudget};
use gdcm_model::dataset::limits::MOST_CHANNELS;
use gdcm_model::dataset::{Pair, PairTable};

use super::kkt::gain_residual;
use super::solved_within;

const BOUNDS: Bounds = Bounds {
    lower: 0.2,
    upper: 5.0,
};

/// A hundredth of the program's default budget.
const BUDGET: ProofBudget = ProofBudget {
    work: 500_000,
    listing: 10_000,
    bytes: 8_000_000,
};

/// Returns the true gain of a channel (inputs follow the outputs): different values between 0.7 and
/// 1.4.
fn true_gain(channel: usize) -> f64 {
    (0.35 * (1.7 * channel as f64).sin()).exp()
}

/// Returns the products of the true gains, each with an error of up to 10 %.
fn delta_gains() -> PairTable<Option<f64>> {
    PairTable::from_fn(MOST_CHANNELS, MOST_CHANNELS, |Pair { output, input }| {
        let error = 0.1 * (12.9898 * output as f64 + 78.233 * input as f64).sin();
        Some(true_gain(output) * true_gain(MOST_CHANNELS + input) * (1.0 + error))
    })
}

/// Marks held entries that form a path through all channels, the longest possible chain of
/// constraints.
fn path_through_all_channels() -> PairTable<bool> {
    PairTable::from_fn(MOST_CHANNELS, MOST_CHANNELS, |pair| {
        pair.output == pair.input || pair.output == pair.input + 1
    })
}

#[test]
fn all_entries_are_held_if_they_are_consistent() {
    let delta = delta_gains().map(|Pair { output, input }, _| {
        Some(true_gain(output) * true_gain(MOST_CHANNELS + input))
    });
    let held = PairTable::filled(MOST_CHANNELS, MOST_CHANNELS, true);
    let solution = solved_within(&Problem::gains(delta, held, BOUNDS), BUDGET);
    assert!(solution.matched);
    assert!(
        matches!(solution.proof.outcome, Outcome::Proven { .. }),
        "a single unknown is proven at once: {:?}",
        solution.proof
    );
    for (pair, target) in solution.targets.iter() {
        let product = solution.inputs[pair.input] * solution.outputs[pair.output];
        // The logarithms are matched within 1e-9 (M8).
        assert!((product / target.unwrap() - 1.0).abs() <= 1e-9, "{pair:?}");
    }
}

#[test]
fn a_loop_through_all_channels_is_found() {
    let mut held = path_through_all_channels();
    // This entry closes the path to a loop.
    held[Pair::new(0, MOST_CHANNELS - 1)] = true;
    let solution = solved_within(&Problem::gains(delta_gains(), held, BOUNDS), BUDGET);
    let [conflict] = solution.conflicts.as_slice() else {
        panic!("{:?}", solution.conflicts)
    };
    assert!(
        matches!(conflict.kind, ConflictKind::Loop { .. }),
        "{conflict:?}"
    );
    assert_eq!(conflict.entries.len(), 2 * MOST_CHANNELS);
}

#[test]
fn sensitivities_of_held_entries_and_bounds_balance_the_gradient() {
    let mut problem = Problem::gains(delta_gains(), path_through_all_channels(), BOUNDS);
    problem.alpha = 3.0;
    let solution = solved_within(&problem, BUDGET);
    assert!(solution.matched);
    // Multipliers of the active constraints minus the gradient of the objective; inputs first.
    let mut balance = vec![0.0; 2 * MOST_CHANNELS];
    for sensitivity in sensitivities(&problem, &solution) {
        // Convert from per dB to per natural logarithm.
        let slope = sensitivity.per_unit * 20.0 / std::f64::consts::LN_10;
        match sensitivity.constraint {
            ActiveConstraint::Held(pair) => {
                balance[pair.input] += slope;
                balance[MOST_CHANNELS + pair.output] += slope;
            }
            ActiveConstraint::LowerBound(channel) | ActiveConstraint::UpperBound(channel) => {
                match channel {
                    Channel::Input(input) => balance[input] += slope,
                    Channel::Output(output) => balance[MOST_CHANNELS + output] += slope,
                }
            }
        }
    }
    for (pair, delta) in problem.delta.iter() {
        let product = solution.inputs[pair.input] * solution.outputs[pair.output];
        let slope = 2.0 * product * (product - delta.unwrap());
        balance[pair.input] -= slope;
        balance[MOST_CHANNELS + pair.output] -= slope;
    }
    for (output, gain) in solution.outputs.iter().enumerate() {
        balance[MOST_CHANNELS + output] -= 2.0 * problem.alpha * gain * (gain - 1.0);
    }
    // The solution is stationary within 1e-9 of slopes of order 1, which a path of 64 channels
    // sums.
    assert!(balance.iter().all(|left| left.abs() <= 1e-6), "{balance:?}");
}

#[test]
fn a_proof_without_constraints_ends_within_its_budget() {
    let problem = Problem::gains(
        delta_gains(),
        PairTable::filled(MOST_CHANNELS, MOST_CHANNELS, false),
        BOUNDS,
    );
    let solution = solved_within(&problem, BUDGET);
    assert!(solution.proof.lower_bound <= solution.objective);
    assert!(gain_residual(&problem, &solution) <= 1e-9);
}
