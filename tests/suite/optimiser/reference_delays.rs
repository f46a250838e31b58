//! The minima of equation (11).

use gdcm::correction::solve_delays;

use super::instances::delay_instances;

#[test]
fn every_minimum_is_reached() {
    for instance in delay_instances() {
        let solution = solve_delays(&instance.problem).unwrap();
        assert_eq!(solution.matched, instance.matched, "{}", instance.id);
        // The reference is an interior point's; the program is convex.
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
        let solution = solve_delays(&instance.problem).unwrap();
        for pair in instance.problem.constrained.marked() {
            let sum = solution.inputs_s[pair.input] + solution.outputs_s[pair.output];
            // A few roundings of delays of a tenth of a second.
            assert!((sum - solution.targets_s[pair].unwrap()).abs() <= 1e-15, "{}: {pair:?}", instance.id);
        }
        for delay in solution.inputs_s.iter().chain(&solution.outputs_s) {
            assert!((0.0..=instance.problem.upper_s).contains(delay), "{}: {delay}", instance.id);
        }
    }
}

#[test]
fn delays_on_a_bound_are_exactly_on_it() {
    for instance in delay_instances() {
        let solution = solve_delays(&instance.problem).unwrap();
        for delay in solution.inputs_s.iter().chain(&solution.outputs_s) {
            // A nanosecond: anything this near to a bound is meant to be on it.
            assert!(*delay == 0.0 || *delay > 1e-9, "{}: {delay:e}", instance.id);
            assert!(
                *delay == instance.problem.upper_s || instance.problem.upper_s - delay > 1e-9,
                "{}: {delay:e}",
                instance.id
            );
        }
    }
}

#[test]
fn sums_equal_the_reference() {
    for instance in delay_instances() {
        let solution = solve_delays(&instance.problem).unwrap();
        for pair in instance.problem.wanted_s.pairs() {
            let sum = solution.inputs_s[pair.input] + solution.outputs_s[pair.output];
            let reference = instance.inputs_s[pair.input] + instance.outputs_s[pair.output];
            // An objective known to 1e-8 fixes its minimum to about the root of that, of delays of a tenth of a second.
            assert!((sum - reference).abs() <= 2e-5, "{}: {pair:?} {sum} {reference}", instance.id);
        }
    }
}
