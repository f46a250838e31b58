//! Sensitivities and toggles against solving the changed problem.

use gdcm::correction::{
    DelayProblem, DelayRestraint, GainBounds, GainProblem, GainRestraint, ProofBudget, delay_sensitivities,
    delay_toggles, gain_sensitivities, gain_toggles, solve_delays, solve_gains,
};

use super::instances::{delay_instances, gain_instances};

/// 1e-4 dB: small enough for the second order to vanish, large enough for the objective's rounding to.
const STEP_DB: f64 = 1e-4;

fn gain_objective(problem: &GainProblem) -> f64 {
    solve_gains(problem, ProofBudget::default()).unwrap().objective
}

#[test]
fn gain_sensitivities_are_slopes_of_the_least_objective() {
    let factor = 10f64.powf(STEP_DB / 20.0);
    for instance in gain_instances().iter().filter(|instance| instance.kind == "base") {
        let problem = &instance.problem;
        let solution = solve_gains(problem, ProofBudget::default()).unwrap();
        for sensitivity in gain_sensitivities(problem, &solution) {
            let with = |factor: f64| {
                let mut changed = problem.clone();
                match sensitivity.restraint {
                    // The wanted gain itself is in the objective too: take the held entry out of it.
                    GainRestraint::Held(pair) => {
                        changed.fitted[pair] = false;
                        changed.wanted[pair] = changed.wanted[pair].map(|gain| gain * factor);
                    }
                    GainRestraint::LowerBound(_) => changed.bounds.lower *= factor,
                    GainRestraint::UpperBound(_) => changed.bounds.upper *= factor,
                }
                gain_objective(&changed)
            };
            let several_on_bound = gain_sensitivities(problem, &solution)
                .iter()
                .filter(|other| matches!(other.restraint, GainRestraint::LowerBound(_) | GainRestraint::UpperBound(_)))
                .count()
                > 1;
            if !matches!(sensitivity.restraint, GainRestraint::Held(_)) && several_on_bound {
                // One bound moves for all channels on it: their sum is checked by the other instances.
                continue;
            }
            let slope = (with(factor) - with(1.0 / factor)) / (2.0 * STEP_DB);
            // Second differences of 1e-4 dB, and the rounding of an objective of about 1 over that step.
            assert!(
                (slope - sensitivity.per_db).abs() <= 1e-6 + 1e-4 * slope.abs(),
                "{}: {sensitivity:?} {slope}",
                instance.id
            );
        }
    }
}

#[test]
fn delay_sensitivities_are_slopes_of_the_least_objective() {
    // A microsecond.
    let step_s = 1e-6;
    for instance in delay_instances().iter().filter(|instance| instance.matched) {
        let problem = &instance.problem;
        let solution = solve_delays(problem).unwrap();
        for sensitivity in delay_sensitivities(problem, &solution) {
            let DelayRestraint::Held(pair) = sensitivity.restraint else {
                continue;
            };
            let with = |step_s: f64| {
                let mut changed = problem.clone();
                changed.fitted[pair] = false;
                changed.wanted_s[pair] = changed.wanted_s[pair].map(|delay| delay + step_s);
                solve_delays(&changed).unwrap().objective
            };
            let (up, down) =
                ((with(step_s) - with(0.0)) / (1e3 * step_s), (with(0.0) - with(-step_s)) / (1e3 * step_s));
            // Where a bound begins to act the slope differs to both sides; the multiplier is one of them or between.
            let (low, high) = (up.min(down), up.max(down));
            // A microsecond's second order, against objectives of a hundredth of a square second.
            assert!(
                (low - 1e-7..=high + 1e-7).contains(&sensitivity.per_ms),
                "{}: {sensitivity:?} {up} {down}",
                instance.id
            );
        }
    }
}

#[test]
fn sensitivities_are_put_into_words() {
    let instance = &gain_instances()[0];
    let solution = solve_gains(&instance.problem, ProofBudget::default()).unwrap();
    let names = |list: &[&str]| list.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
    let (inputs, outputs) = (names(&["LON", "LAT", "PED", "COL"]), names(&["P", "Q", "R", "NX", "NY", "NZ"]));
    let all = gain_sensitivities(&instance.problem, &solution);
    // The five entries of Table 2; the wide bounds of this instance do not act.
    assert_eq!(all.len(), 5);
    for sensitivity in all {
        let words = sensitivity.words(&inputs, &outputs);
        let change = if sensitivity.per_db > 0.0 { "lowering" } else { "raising" };
        assert!(
            words.contains(&format!("is held: {change} its gain by 1 dB would lower the objective by about")),
            "{words}"
        );
    }
}

#[test]
fn the_table_of_toggles_holds_what_solving_each_toggle_gives() {
    let instance = &gain_instances()[0];
    let solution = solve_gains(&instance.problem, ProofBudget::default()).unwrap();
    let toggles = gain_toggles(&instance.problem, &solution, ProofBudget::default(), &|| false).unwrap();
    assert_eq!(toggles.len(), 24);
    for toggle in toggles {
        let mut changed = instance.problem.clone();
        changed.constrained[toggle.pair] = !changed.constrained[toggle.pair];
        assert_eq!(toggle.held_now, instance.problem.constrained[toggle.pair]);
        assert_eq!(toggle.after, gain_objective(&changed), "{:?}", toggle.pair);
        assert_eq!(toggle.before, solution.objective);
        if toggle.held_now {
            assert!(toggle.after <= toggle.before, "{:?}", toggle.pair);
        }
    }
}

#[test]
fn the_table_of_delay_toggles_holds_what_solving_each_toggle_gives() {
    let instance = &delay_instances()[0];
    let solution = solve_delays(&instance.problem).unwrap();
    let toggles = delay_toggles(&instance.problem, &solution, &|| false).unwrap();
    assert_eq!(toggles.len(), 24);
    for toggle in toggles {
        let mut constrained = instance.problem.constrained.clone();
        constrained[toggle.pair] = !constrained[toggle.pair];
        let changed = DelayProblem { constrained, ..instance.problem.clone() };
        assert_eq!(toggle.after, solve_delays(&changed).unwrap().objective, "{:?}", toggle.pair);
    }
}

#[test]
fn toggles_stop_when_told_to() {
    let gains = &gain_instances()[0].problem;
    let solution = solve_gains(gains, ProofBudget::default()).unwrap();
    assert_eq!(gain_toggles(gains, &solution, ProofBudget::default(), &|| true).unwrap(), []);
    let delays = &delay_instances()[0].problem;
    let solution = solve_delays(delays).unwrap();
    assert_eq!(delay_toggles(delays, &solution, &|| true).unwrap(), []);
}

#[test]
fn a_bound_that_acts_has_a_multiplier_of_the_right_sign() {
    let mut problem = gain_instances()[0].problem.clone();
    problem.bounds = GainBounds { lower: 0.8, upper: 1.3 };
    let solution = solve_gains(&problem, ProofBudget::default()).unwrap();
    let restraints = gain_sensitivities(&problem, &solution);
    let bounds: Vec<_> = restraints.iter().filter(|found| !matches!(found.restraint, GainRestraint::Held(_))).collect();
    assert!(!bounds.is_empty());
    for bound in bounds {
        match bound.restraint {
            GainRestraint::UpperBound(_) => assert!(bound.per_db < 0.0, "{bound:?}"),
            _ => assert!(bound.per_db > 0.0, "{bound:?}"),
        }
    }
}
