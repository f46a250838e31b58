//! Local minima, limits of the regularisation weight alpha, and extreme problems.

use gdcm_method::correction::problem::ProblemError;
use gdcm_method::correction::solve::solve;
use gdcm_method::correction::{Bounds, GainObjective, Outcome, Problem, ProofBudget, Quantity};
use gdcm_model::dataset::{Pair, PairTable};

use super::instances::{delay_instances, example_conditions, gain_instances};
use super::solved;

/// Returns a problem with four outputs and two inputs, of which the entries (0, 0) and (1, 1) are
/// held. It was found by a random search for two minima within 1 %.
fn two_minima() -> Problem {
    #[rustfmt::skip]
    let gains = [
        0.3941182467407782, 5.928489965329777,
        5.1475672307298925, 1.019924803403843,
        2.960866928000384, 0.3449159105810607,
        0.9167666063850984, 1.0286376474599217,
    ];
    let delta = PairTable::from_fn(4, 2, |pair| Some(gains[2 * pair.output + pair.input]));
    let constrained = PairTable::from_fn(4, 2, |pair| pair.output == pair.input);
    let mut problem = Problem::gains(
        delta,
        constrained,
        Bounds {
            lower: 0.1,
            upper: 10.0,
        },
    );
    problem.alpha = 0.0;
    problem
}

#[test]
fn every_condition_of_the_example_is_solved_and_proven() {
    for condition in example_conditions() {
        let gains = solved(&condition.gains);
        let delays = solved(&condition.delays);
        // The reference objective is certified to 1e-8.
        assert!(
            (gains.objective / condition.gain_objective - 1.0).abs() <= 1e-8,
            "{}",
            condition.id
        );
        assert!(
            matches!(gains.proof.outcome, Outcome::Proven { .. }),
            "{}",
            condition.id
        );
        assert!(
            (delays.objective / condition.delay_objective - 1.0).abs() <= 1e-8,
            "{}",
            condition.id
        );
    }
}

#[test]
fn two_local_minima_within_a_percent_are_both_kept() {
    let problem = two_minima();
    let solution = solved(&problem);
    let objectives: Vec<f64> = solution
        .proof
        .local_minima
        .iter()
        .map(|minimum| minimum.objective)
        .collect();
    assert!(solution.proof.all_minima);
    assert_eq!(objectives.len(), 2, "{objectives:?}");
    assert_eq!(objectives[0], solution.objective);
    assert!(
        objectives[0] < objectives[1] && objectives[1] <= 1.01 * objectives[0],
        "{objectives:?}"
    );
    // On the straight path (in logarithms) from one to the other, the objective rises above both:
    // they are two distinct minima.
    let [first, second] = solution.proof.local_minima.as_slice() else {
        panic!("two minima")
    };
    let objective_between = |share: f64| {
        problem.objective_at(
            &between(&first.inputs, &second.inputs, share),
            &between(&first.outputs, &second.outputs, share),
        )
    };
    assert!((1..20).any(|step| objective_between(f64::from(step) / 20.0) > objectives[1]));
}

/// Returns the gains at a share of the straight path (in logarithms) from `a` to `b`.
fn between(a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a.ln() * (1.0 - share) + b.ln() * share).exp())
        .collect()
}

#[test]
fn no_point_of_a_grid_is_below_the_lower_bound() {
    let problem = two_minima();
    let solution = solved(&problem);
    let delta = |output, input| problem.delta[Pair::new(output, input)].unwrap();
    // 201 x 201 pairs of input gains from 0.1 to 10. The held entries determine two of the outputs,
    // the other two are optimal for these inputs.
    let gain = |step: u32| 10f64.powf(f64::from(step) / 100.0 - 1.0);
    for (first, second) in (0..=200).flat_map(|i| (0..=200).map(move |j| (gain(i), gain(j)))) {
        let held = [delta(0, 0) / first, delta(1, 1) / second];
        if held.iter().any(|gain| !(0.1..=10.0).contains(gain)) {
            continue;
        }
        let optimal_output = |output| {
            let g = [delta(output, 0), delta(output, 1)];
            let k = [first, second];
            ((g[0] * k[0] + g[1] * k[1]) / (k[0] * k[0] + k[1] * k[1])).clamp(0.1, 10.0)
        };
        let objective = problem.objective_at(
            &[first, second],
            &[held[0], held[1], optimal_output(2), optimal_output(3)],
        );
        assert!(
            objective >= solution.proof.lower_bound,
            "{first} {second}: {objective}"
        );
    }
}

#[test]
fn gains_without_regularisation_are_the_limit_of_a_small_alpha() {
    for instance in gain_instances()
        .iter()
        .filter(|instance| instance.problem.alpha == 0.0)
    {
        let limit = solved(&instance.problem);
        let small = solved(&Problem {
            alpha: 1e-6,
            ..instance.problem.clone()
        });
        for (limit, small) in limit
            .inputs
            .iter()
            .chain(&limit.outputs)
            .zip(small.inputs.iter().chain(&small.outputs))
        {
            // The gains depend on alpha to first order, so alpha = 1e-6 changes them slightly.
            assert!(
                (limit / small - 1.0).abs() <= 1e-4,
                "{}: {limit} {small}",
                instance.id
            );
        }
    }
}

#[test]
fn delays_without_regularisation_are_the_limit_of_a_small_alpha() {
    for instance in delay_instances()
        .iter()
        .filter(|instance| instance.problem.alpha == 0.0)
    {
        let limit = solved(&instance.problem);
        let small = solved(&Problem {
            alpha: 1e-6,
            ..instance.problem.clone()
        });
        for (limit, small) in limit
            .inputs
            .iter()
            .chain(&limit.outputs)
            .zip(small.inputs.iter().chain(&small.outputs))
        {
            // The delays, about 0.1 s, depend on alpha to first order.
            assert!(
                (limit - small).abs() <= 1e-6,
                "{}: {limit} {small}",
                instance.id
            );
        }
    }
}

#[test]
fn a_large_alpha_keeps_the_output_gains_at_one() {
    let mut problem = gain_instances()[0].problem.clone();
    problem.constrained = PairTable::filled(6, 4, false);
    problem.alpha = 1e6;
    let solution = solved(&problem);
    assert!(
        matches!(solution.proof.outcome, Outcome::Proven { .. }),
        "{:?}",
        solution.proof.outcome
    );
    // The slope of the fit, of order 1, is small compared with alpha = 1e6.
    assert!(
        solution
            .outputs
            .iter()
            .all(|gain| (gain - 1.0).abs() <= 1e-5),
        "{:?}",
        solution.outputs
    );
}

#[test]
fn channels_without_a_fitted_entry_have_unit_gain_and_no_delay() {
    let mut gains = gain_instances()[0].problem.clone();
    gains.constrained = PairTable::filled(6, 4, false);
    gains.fitted = gains
        .fitted
        .map(|pair, _| pair.input != 2 && pair.output != 3);
    for alpha in [0.0, 1.0] {
        gains.alpha = alpha;
        let solution = solved(&gains);
        assert_eq!(
            (solution.inputs[2], solution.outputs[3]),
            (1.0, 1.0),
            "alpha {alpha}"
        );
    }
    let mut delays = delay_instances()[0].problem.clone();
    delays.constrained = PairTable::filled(6, 4, false);
    delays.fitted = delays
        .fitted
        .map(|pair, _| pair.input != 2 && pair.output != 3);
    let solution = solved(&delays);
    assert_eq!((solution.inputs[2], solution.outputs[3]), (0.0, 0.0));
}

#[test]
fn equal_bounds_determine_every_gain() {
    let mut problem = gain_instances()[0].problem.clone();
    problem.bounds = Bounds {
        lower: 1.1,
        upper: 1.1,
    };
    let solution = solved(&problem);
    assert!(
        solution
            .inputs
            .iter()
            .chain(&solution.outputs)
            .all(|gain| *gain == 1.1)
    );
    assert!(matches!(solution.proof.outcome, Outcome::Proven { .. }));
}

#[test]
fn the_decibel_objective_is_proven_in_a_single_node() {
    for instance in gain_instances() {
        let problem = Problem {
            quantity: Quantity::Gain(GainObjective::Decibel),
            ..instance.problem
        };
        let solution = solved(&problem);
        assert_eq!(solution.quantity, Quantity::Gain(GainObjective::Decibel));
        // A convex problem needs a single node.
        assert_eq!(solution.proof.nodes, 1, "{}", instance.id);
        assert!(
            matches!(solution.proof.outcome, Outcome::Proven { .. }),
            "{}: {:?}",
            instance.id,
            solution.proof.outcome
        );
    }
}

#[test]
fn the_decibel_objective_weights_errors_of_plus_and_minus_3_db_equally() {
    let bounds = Bounds {
        lower: 1.0,
        upper: 1.0,
    };
    let objective = |gain: f64| {
        let mut problem = Problem::gains(
            PairTable::filled(1, 1, Some(gain)),
            PairTable::filled(1, 1, false),
            bounds,
        );
        problem.quantity = Quantity::Gain(GainObjective::Decibel);
        solved(&problem).objective
    };
    let factor = 10f64.powf(3.0 / 20.0);
    // The objective is the square of 3 dB; the logarithms have a few rounding errors.
    assert!(
        (objective(factor) - 9.0).abs() <= 1e-13 && (objective(1.0 / factor) - 9.0).abs() <= 1e-13
    );
}

#[test]
fn an_absurd_off_axis_gain_does_not_prevent_a_proven_solution() {
    let mut problem = gain_instances()[0].problem.clone();
    problem.delta[Pair::new(3, 0)] = Some(1e14);
    let solution = solved(&problem);
    assert!(solution.objective.is_finite());
    assert!(
        matches!(solution.proof.outcome, Outcome::Proven { .. }),
        "{:?}",
        solution.proof.outcome
    );
    // The output with the absurd gain reaches its bound.
    assert_eq!(solution.outputs[3], problem.bounds.upper);
}

#[test]
fn ill_posed_gain_problems_are_refused_with_the_reason() {
    let good = gain_instances()[0].problem.clone();
    let refused =
        |problem: &Problem| solve(problem, ProofBudget::default(), &|| false).unwrap_err();
    let pair = Pair::new(2, 2);
    let mut bad = good.clone();
    bad.delta[pair] = None;
    assert_eq!(
        refused(&bad),
        ProblemError::ConstrainedUndefined {
            quantity: good.quantity,
            pair
        }
    );
    assert_eq!(refused(&bad).code(), "constrained-undefined");
    bad.delta[pair] = Some(-1.0);
    assert_eq!(refused(&bad), ProblemError::Gain { pair, gain: -1.0 });
    let bad = Problem {
        bounds: Bounds {
            lower: 2.0,
            upper: 1.0,
        },
        ..good.clone()
    };
    assert_eq!(
        refused(&bad),
        ProblemError::Bounds {
            quantity: good.quantity,
            bounds: Bounds {
                lower: 2.0,
                upper: 1.0
            }
        }
    );
    let bad = Problem {
        bounds: Bounds {
            lower: 0.0,
            upper: 1.0,
        },
        ..good.clone()
    };
    assert_eq!(
        refused(&bad),
        ProblemError::Bounds {
            quantity: good.quantity,
            bounds: Bounds {
                lower: 0.0,
                upper: 1.0
            }
        }
    );
    let bad = Problem {
        alpha: -1.0,
        ..good.clone()
    };
    assert_eq!(refused(&bad), ProblemError::Alpha { alpha: -1.0 });
    let bad = Problem {
        alpha: f64::NAN,
        ..good.clone()
    };
    assert!(matches!(refused(&bad), ProblemError::Alpha { .. }));
    let bad = Problem {
        fitted: PairTable::filled(4, 6, true),
        ..good
    };
    assert!(matches!(
        refused(&bad),
        ProblemError::Shape {
            table: "fitted",
            found: (4, 6),
            ..
        }
    ));
}

#[test]
fn ill_posed_delay_problems_are_refused_with_the_reason() {
    let good = delay_instances()[0].problem.clone();
    let refused =
        |problem: &Problem| solve(problem, ProofBudget::default(), &|| false).unwrap_err();
    let pair = Pair::new(2, 2);
    let mut bad = good.clone();
    bad.delta[pair] = None;
    assert_eq!(
        refused(&bad),
        ProblemError::ConstrainedUndefined {
            quantity: good.quantity,
            pair
        }
    );
    bad.delta[pair] = Some(f64::INFINITY);
    assert_eq!(
        refused(&bad),
        ProblemError::Delay {
            pair,
            delay_s: f64::INFINITY
        }
    );
    let bounds = Bounds {
        lower: 0.0,
        upper: -0.1,
    };
    let error = refused(&Problem {
        bounds,
        ..good.clone()
    });
    assert_eq!(
        error,
        ProblemError::Bounds {
            quantity: Quantity::Delay,
            bounds: Bounds {
                lower: 0.0,
                upper: -0.1
            }
        }
    );
    assert_eq!(
        refused(&Problem {
            alpha: -1.0,
            ..good.clone()
        }),
        ProblemError::Alpha { alpha: -1.0 }
    );
    let bad = Problem {
        constrained: PairTable::filled(1, 1, false),
        ..good
    };
    assert!(matches!(
        refused(&bad),
        ProblemError::Shape {
            table: "constrained",
            ..
        }
    ));
}

#[test]
fn delays_scale_with_the_unit_of_time() {
    for instance in delay_instances() {
        let seconds = solved(&instance.problem);
        let factor = 1e-6;
        let problem_in_micro = Problem {
            delta: instance
                .problem
                .delta
                .map(|_, delay| delay.map(|delay| delay * factor)),
            bounds: Bounds {
                lower: 0.0,
                upper: instance.problem.bounds.upper * factor,
            },
            ..instance.problem.clone()
        };
        let scaled = solved(&problem_in_micro);
        for (delay, scaled) in seconds.outputs.iter().zip(&scaled.outputs) {
            // A few rounding errors of 0.1 s, magnified by a flat minimum.
            assert!(
                (delay * factor - scaled).abs() <= 1e-12 * factor,
                "{}: {delay} {scaled}",
                instance.id
            );
        }
    }
}
