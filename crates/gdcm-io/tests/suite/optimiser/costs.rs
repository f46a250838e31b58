//! Sensitivities, and the objectives after toggling an entry between held and free, compared with
//! solutions of the modified problem.

use gdcm_method::correction::sensitivity::{ActiveConstraint, sensitivities};
use gdcm_method::correction::toggles::toggles;
use gdcm_method::correction::{Bounds, Problem, ProofBudget};

use super::instances::{delay_instances, gain_instances};
use super::solved;

/// Step \[dB\]: small enough to neglect second-order terms, large enough compared with the rounding
/// of the objective.
const STEP_DB: f64 = 1e-4;

#[test]
fn gain_sensitivities_are_slopes_of_the_minimum_objective() {
    let factor = 10f64.powf(STEP_DB / 20.0);
    for instance in gain_instances()
        .iter()
        .filter(|instance| instance.kind == "base")
    {
        let problem = &instance.problem;
        let solution = solved(problem);
        for sensitivity in sensitivities(problem, &solution) {
            let objective_with = |factor: f64| {
                let mut changed = problem.clone();
                match sensitivity.constraint {
                    // Move the target of the held entry only, without its term of the objective.
                    ActiveConstraint::Held(pair) => {
                        changed.fitted[pair] = false;
                        changed.delta[pair] = changed.delta[pair].map(|gain| gain * factor);
                    }
                    ActiveConstraint::LowerBound(_) => changed.bounds.lower *= factor,
                    ActiveConstraint::UpperBound(_) => changed.bounds.upper *= factor,
                }
                solved(&changed).objective
            };
            let several_on_bound = sensitivities(problem, &solution)
                .iter()
                .filter(|other| {
                    matches!(
                        other.constraint,
                        ActiveConstraint::LowerBound(_) | ActiveConstraint::UpperBound(_)
                    )
                })
                .count()
                > 1;
            if !matches!(sensitivity.constraint, ActiveConstraint::Held(_)) && several_on_bound {
                // Skip bounds that several channels have reached: changing the bound gives only the
                // sum of their sensitivities.
                continue;
            }
            let slope = (objective_with(factor) - objective_with(1.0 / factor)) / (2.0 * STEP_DB);
            // Tolerance for second-order terms of a step of 1e-4 dB, and for the rounding of an
            // objective of about 1 divided by the step.
            assert!(
                (slope - sensitivity.per_unit).abs() <= 1e-6 + 1e-4 * slope.abs(),
                "{}: {sensitivity:?}, slope {slope}",
                instance.id
            );
        }
    }
}

#[test]
fn delay_sensitivities_are_slopes_of_the_minimum_objective() {
    let step_s = 1e-6;
    for instance in delay_instances().iter().filter(|instance| instance.matched) {
        let problem = &instance.problem;
        let solution = solved(problem);
        for sensitivity in sensitivities(problem, &solution) {
            let ActiveConstraint::Held(pair) = sensitivity.constraint else {
                continue;
            };
            let objective_with = |step_s: f64| {
                let mut changed = problem.clone();
                changed.fitted[pair] = false;
                changed.delta[pair] = changed.delta[pair].map(|delay| delay + step_s);
                solved(&changed).objective
            };
            // Per millisecond, the unit of a delay sensitivity.
            let base = objective_with(0.0);
            let up = (objective_with(step_s) - base) / (1e3 * step_s);
            let down = (base - objective_with(-step_s)) / (1e3 * step_s);
            // Where a bound becomes active, the slopes to either side differ, and the multiplier
            // lies between them.
            let low = up.min(down);
            let high = up.max(down);
            // 1e-7: second-order terms of a microsecond, relative to objectives of about 0.01 s^2.
            assert!(
                (low - 1e-7..=high + 1e-7).contains(&sensitivity.per_unit),
                "{}: {sensitivity:?}, slopes {up} and {down}",
                instance.id
            );
        }
    }
}

#[test]
fn only_held_entries_have_sensitivities_within_wide_bounds() {
    let instance = &gain_instances()[0];
    let solution = solved(&instance.problem);
    let found = sensitivities(&instance.problem, &solution);
    // The five held entries of Table 2; the wide bounds of this instance are not active.
    assert_eq!(found.len(), 5);
    for sensitivity in found {
        let ActiveConstraint::Held(pair) = sensitivity.constraint else {
            panic!("{sensitivity:?}")
        };
        assert!(instance.problem.constrained[pair], "{sensitivity:?}");
        assert_eq!(sensitivity.step(), 1.0);
    }
}

#[test]
fn each_gain_toggle_has_the_objective_of_the_toggled_problem() {
    let instance = &gain_instances()[0];
    let solution = solved(&instance.problem);
    let toggles = toggles(
        &instance.problem,
        &solution,
        ProofBudget::default(),
        &|| false,
    )
    .unwrap();
    assert_eq!(toggles.len(), 24);
    for toggle in toggles {
        let mut changed = instance.problem.clone();
        changed.constrained[toggle.pair] = !changed.constrained[toggle.pair];
        assert_eq!(toggle.held_now, instance.problem.constrained[toggle.pair]);
        assert_eq!(
            toggle.after,
            solved(&changed).objective,
            "{:?}",
            toggle.pair
        );
        assert_eq!(toggle.before, solution.objective);
        if toggle.held_now {
            assert!(toggle.after <= toggle.before, "{:?}", toggle.pair);
        }
    }
}

#[test]
fn each_delay_toggle_has_the_objective_of_the_toggled_problem() {
    let instance = &delay_instances()[0];
    let solution = solved(&instance.problem);
    let toggles = toggles(
        &instance.problem,
        &solution,
        ProofBudget::default(),
        &|| false,
    )
    .unwrap();
    assert_eq!(toggles.len(), 24);
    for toggle in toggles {
        let mut constrained = instance.problem.constrained.clone();
        constrained[toggle.pair] = !constrained[toggle.pair];
        let changed = Problem {
            constrained,
            ..instance.problem.clone()
        };
        assert_eq!(
            toggle.after,
            solved(&changed).objective,
            "{:?}",
            toggle.pair
        );
    }
}

#[test]
fn cancelled_toggles_are_empty() {
    let gains = &gain_instances()[0].problem;
    let solution = solved(gains);
    assert_eq!(
        toggles(gains, &solution, ProofBudget::default(), &|| true).unwrap(),
        []
    );
    let delays = &delay_instances()[0].problem;
    let solution = solved(delays);
    assert_eq!(
        toggles(delays, &solution, ProofBudget::default(), &|| true).unwrap(),
        []
    );
}

#[test]
fn an_active_bound_has_a_multiplier_of_the_right_sign() {
    let mut problem = gain_instances()[0].problem.clone();
    problem.bounds = Bounds {
        lower: 0.8,
        upper: 1.3,
    };
    let solution = solved(&problem);
    let found = sensitivities(&problem, &solution);
    let bounds: Vec<_> = found
        .iter()
        .filter(|found| !matches!(found.constraint, ActiveConstraint::Held(_)))
        .collect();
    assert!(!bounds.is_empty());
    for bound in bounds {
        // Raising an upper bound lowers the minimum; raising a lower bound raises it.
        match bound.constraint {
            ActiveConstraint::UpperBound(_) => assert!(bound.per_unit < 0.0, "{bound:?}"),
            _ => assert!(bound.per_unit > 0.0, "{bound:?}"),
        }
    }
}
