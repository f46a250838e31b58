//! Delays compared with the reference minima of equation (11).

use super::instances::delay_instances;
use super::solved;

#[test]
fn every_reference_minimum_is_reached() {
    for instance in delay_instances() {
        let solution = solved(&instance.problem);
        assert_eq!(solution.matched, instance.matched, "{}", instance.id);
        // The reference is from an interior-point method, whose minimum is global because the
        // problem is convex.
        assert!(
            (solution.objective / instance.objective - 1.0).abs() <= 1e-8,
            "{}: {} is not {}",
            instance.id,
            solution.objective,
            instance.objective
        );
    }
}

#[test]
fn held_sums_are_held_and_delays_stay_inside_their_bounds() {
    for instance in delay_instances() {
        let solution = solved(&instance.problem);
        for pair in instance.problem.constrained.marked() {
            let sum = solution.inputs[pair.input] + solution.outputs[pair.output];
            // A few rounding errors of delays of 0.1 s.
            assert!(
                (sum - solution.targets[pair].unwrap()).abs() <= 1e-15,
                "{}: {pair:?}",
                instance.id
            );
        }
        for delay in solution.inputs.iter().chain(&solution.outputs) {
            assert!(
                (0.0..=instance.problem.bounds.upper).contains(delay),
                "{}: {delay}",
                instance.id
            );
        }
    }
}

#[test]
fn delays_near_a_bound_are_exactly_at_the_bound() {
    for instance in delay_instances() {
        let solution = solved(&instance.problem);
        for delay in solution.inputs.iter().chain(&solution.outputs) {
            // No delay is within a nanosecond of a bound without being equal to it.
            assert!(*delay == 0.0 || *delay > 1e-9, "{}: {delay:e}", instance.id);
            assert!(
                *delay == instance.problem.bounds.upper
                    || instance.problem.bounds.upper - delay > 1e-9,
                "{}: {delay:e}",
                instance.id
            );
        }
    }
}

#[test]
fn sums_equal_the_reference() {
    for instance in delay_instances() {
        let solution = solved(&instance.problem);
        for pair in instance.problem.delta.pairs() {
            let sum = solution.inputs[pair.input] + solution.outputs[pair.output];
            let reference = instance.inputs[pair.input] + instance.outputs[pair.output];
            // An objective with a relative accuracy of 1e-8 determines its minimiser to about the
            // square root: 1e-4 of delays of 0.1 s, 1e-5 s.
            assert!(
                (sum - reference).abs() <= 2e-5,
                "{}: {pair:?} {sum} is not {reference}",
                instance.id
            );
        }
    }
}
