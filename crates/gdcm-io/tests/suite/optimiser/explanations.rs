//! Explanations of constraints that cannot be satisfied: the named conflict is minimal, and the
//! proposed remedy, a bound or an entry to free, suffices while a smaller change does not.

use proptest::prelude::*;

use gdcm_method::correction::conflict::{Conflict, ConflictKind};
use gdcm_method::correction::{
    Bounds, Channel, GainObjective, Outcome, Problem, ProofBudget, Quantity,
};
use gdcm_model::dataset::{Pair, PairTable};

use super::instances::{delay_instances, gain_instances, on_axis};
use super::random::{Pattern, delay_problems, gain_problems};
use super::{solved, solved_within};
use crate::synthetic::tries;

/// Budget without a proof, which is not needed to decide whether constraints can be satisfied.
const BUDGET: ProofBudget = ProofBudget {
    work: 0,
    listing: 0,
    bytes: 0,
};

/// Returns the problem with only these entries held.
fn holding(problem: &Problem, entries: &[Pair]) -> Problem {
    Problem {
        constrained: problem.constrained.map(|pair, _| entries.contains(&pair)),
        ..problem.clone()
    }
}

/// Returns the problem with one of its held entries free.
fn without(problem: &Problem, freed: Pair) -> Problem {
    Problem {
        constrained: problem.constrained.map(|pair, held| *held && pair != freed),
        ..problem.clone()
    }
}

/// Returns the problem with other bounds.
fn bounded(problem: &Problem, lower: f64, upper: f64) -> Problem {
    Problem {
        bounds: Bounds { lower, upper },
        ..problem.clone()
    }
}

/// Returns whether all held entries can be matched.
fn is_matched(problem: &Problem) -> bool {
    solved_within(problem, BUDGET).matched
}

/// Returns a problem of six outputs and four inputs with all delta gains 1 except `changes`; the
/// entries of Table 2 are held.
fn table_two(changes: &[(usize, usize, f64)], bounds: Bounds) -> Problem {
    let mut delta = PairTable::filled(6, 4, Some(1.0));
    for &(output, input, gain) in changes {
        delta[Pair::new(output, input)] = Some(gain);
    }
    Problem::gains(delta, on_axis(), bounds)
}

#[test]
fn a_product_above_the_bounds_is_explained() {
    let problem = table_two(
        &[(0, 1, 2.5)],
        Bounds {
            lower: 0.7,
            upper: 1.4,
        },
    );
    let solution = solved_within(&problem, BUDGET);
    let [conflict] = solution.conflicts.as_slice() else {
        panic!("{:?}", solution.conflicts)
    };
    // The required product is 2.5: 1.58^2 = 2.496 is too small, 1.59^2 = 2.528 suffices.
    let ConflictKind::AboveUpper {
        channels,
        asked,
        upper,
    } = conflict.kind
    else {
        panic!("{conflict:?}")
    };
    assert_eq!(channels, [Channel::Input(1), Channel::Output(0)]);
    assert!((asked - 2.5).abs() < 1e-12, "{asked}");
    assert_eq!(upper, 1.59);
    assert_eq!(conflict.entries, [Pair::new(0, 1)]);
    assert!(is_matched(&bounded(&problem, 0.7, 1.59)));
    assert!(!is_matched(&bounded(&problem, 0.7, 1.58)));
    let miss = &solution.unmatched[0];
    // The bounds allow 1.4^2 = 1.96: 20 log10 (1.96 / 2.5) = -2.114 dB.
    assert!((miss.excess + 2.114).abs() <= 1e-3, "{}", miss.excess);
}

#[test]
fn a_product_below_the_bounds_is_explained() {
    let problem = table_two(
        &[(5, 3, 0.3)],
        Bounds {
            lower: 0.7,
            upper: 1.4,
        },
    );
    let solution = solved_within(&problem, BUDGET);
    let [
        Conflict {
            kind: ConflictKind::BelowLower {
                lower, channels, ..
            },
            ..
        },
    ] = solution.conflicts.as_slice()
    else {
        panic!("{:?}", solution.conflicts)
    };
    // The required product is 0.3: 0.547^2 = 0.2992 is below, 0.548^2 = 0.3003 above.
    assert_eq!(*lower, Some(0.547));
    assert_eq!(*channels, [Channel::Input(3), Channel::Output(5)]);
    assert!(is_matched(&bounded(&problem, 0.547, 1.4)));
    assert!(!is_matched(&bounded(&problem, 0.548, 1.4)));
}

#[test]
fn two_entries_that_share_an_input_are_explained_by_their_ratio() {
    let problem = table_two(
        &[(2, 2, 0.6), (4, 2, 1.5)],
        Bounds {
            lower: 0.7,
            upper: 1.4,
        },
    );
    let solution = solved_within(&problem, BUDGET);
    let [conflict] = solution.conflicts.as_slice() else {
        panic!("{:?}", solution.conflicts)
    };
    let ConflictKind::TooFarApart {
        greater,
        lesser,
        asked,
        upper,
        lower,
    } = conflict.kind
    else {
        panic!("{conflict:?}")
    };
    assert_eq!([greater, lesser], [Channel::Output(4), Channel::Output(2)]);
    assert!((asked - 2.5).abs() < 1e-12, "{asked}");
    // The outputs must differ by a factor of 2.5, the bounds by 2: 0.7 * 2.5 = 1.75 and 1.4 / 2.5 =
    // 0.56 suffice.
    assert_eq!((upper, lower), (1.75, Some(0.56)));
    assert_eq!(conflict.entries, [Pair::new(2, 2), Pair::new(4, 2)]);
    assert!(
        is_matched(&bounded(&problem, 0.7, 1.75)) && !is_matched(&bounded(&problem, 0.7, 1.74))
    );
    assert!(
        is_matched(&bounded(&problem, 0.56, 1.4)) && !is_matched(&bounded(&problem, 0.561, 1.4))
    );
    for &pair in &conflict.entries {
        assert!(is_matched(&without(&problem, pair)), "{pair:?}");
    }
    assert_eq!(solution.unmatched.len(), 2);
}

#[test]
fn a_cycle_of_constraints_is_explained() {
    for instance in gain_instances()
        .iter()
        .filter(|instance| instance.kind == "cycle_inconsistent")
    {
        let solution = solved_within(&instance.problem, BUDGET);
        let [
            Conflict {
                entries,
                kind:
                    ConflictKind::Loop {
                        mismatch: mismatch_db,
                    },
                ..
            },
        ] = solution.conflicts.as_slice()
        else {
            panic!("{}: {:?}", instance.id, solution.conflicts)
        };
        // Least squares distributes the mismatch evenly over the four entries.
        let mismatch = 4.0 * instance.residual * 20.0 / std::f64::consts::LN_10;
        assert!(
            (mismatch_db.abs() - mismatch).abs() <= 1e-6,
            "{}: {mismatch_db}",
            instance.id
        );
        assert_eq!(entries.len(), 4);
        assert!(
            !is_matched(&bounded(&instance.problem, 1e-3, 1e3)),
            "{}: no bound helps",
            instance.id
        );
        for &pair in entries {
            assert!(
                is_matched(&without(&instance.problem, pair)),
                "{}: {pair:?}",
                instance.id
            );
        }
    }
}

/// Returns a problem like [`table_two`] in which a loop of four entries is held; their delta gains
/// disagree by `mismatch_db`, and a mismatch up to `agreement` \[dB\] is accepted.
fn near_loop(mismatch_db: f64, agreement: f64) -> Problem {
    let entries = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(output, input)| Pair::new(output, input));
    let problem = table_two(
        &[(0, 0, 10_f64.powf(mismatch_db / 20.0))],
        Bounds {
            lower: 0.5,
            upper: 2.0,
        },
    );
    Problem {
        agreement,
        ..holding(&problem, &entries)
    }
}

/// Returns the magnitude of the mismatch of a loop \[dB\].
fn loop_mismatch_db(conflict: &Conflict) -> f64 {
    match conflict.kind {
        ConflictKind::Loop { mismatch } => mismatch.abs(),
        _ => panic!("{conflict:?}"),
    }
}

#[test]
fn a_loop_that_disagrees_by_less_than_the_tolerance_is_matched_and_reported() {
    let agreeing = solved_within(&near_loop(0.04, 0.05), BUDGET);
    assert!(
        agreeing.matched && agreeing.unmatched.is_empty() && agreeing.conflicts.is_empty(),
        "{agreeing:?}"
    );
    assert_eq!(agreeing.remedy, None);
    let [agreement] = agreeing.agreeing.as_slice() else {
        panic!("{:?}", agreeing.agreeing)
    };
    assert!((loop_mismatch_db(agreement) - 0.04).abs() < 1e-9);
    // Least squares distributes the mismatch evenly over the four entries.
    for (pair, target) in agreeing.targets.iter() {
        let Some(target) = *target else {
            continue;
        };
        let net = agreeing.outputs[pair.output] * agreeing.inputs[pair.input];
        let wanted = near_loop(0.04, 0.05).delta[pair];
        assert!((net / target).ln().abs() < 1e-8);
        assert!(
            (20.0 * (target / wanted.unwrap()).log10()).abs() < 0.0101,
            "{pair:?}"
        );
    }
    let disagreeing = solved_within(&near_loop(0.06, 0.05), BUDGET);
    assert!(!disagreeing.matched && disagreeing.agreeing.is_empty());
    assert!((loop_mismatch_db(&disagreeing.conflicts[0]) - 0.06).abs() < 1e-9);
}

#[test]
fn a_small_mismatch_is_not_rounded_to_zero() {
    let solution = solved_within(&near_loop(0.002, 0.0), BUDGET);
    assert!((loop_mismatch_db(&solution.conflicts[0]) - 0.002).abs() < 1e-9);
    // Least squares distributes the mismatch evenly over the four entries.
    assert_eq!(solution.unmatched.len(), 4);
    for miss in &solution.unmatched {
        assert!((miss.excess.abs() - 0.0005).abs() < 1e-7, "{miss:?}");
    }
    // The bounds allow 1.96.
    let problem = table_two(
        &[(0, 1, 1.960_1)],
        Bounds {
            lower: 0.7,
            upper: 1.4,
        },
    );
    let solution = solved_within(&problem, BUDGET);
    assert!(
        matches!(
            solution.conflicts[0].kind,
            ConflictKind::AboveUpper { asked, .. } if (asked - 1.960_1).abs() < 1e-12
        ),
        "{:?}",
        solution.conflicts
    );
}

#[test]
fn a_loop_within_tolerance_does_not_hide_the_remedy_of_a_real_conflict() {
    let mut problem = near_loop(0.04, 0.05);
    let unreachable = Pair::new(2, 2);
    problem.constrained[unreachable] = true;
    // The bounds allow 2^2 = 4.
    problem.delta[unreachable] = Some(4.5);
    let solution = solved_within(&problem, BUDGET);
    assert_eq!(
        (solution.unmatched.len(), solution.agreeing.len()),
        (1, 1),
        "{solution:?}"
    );
    let remedy = solution.remedy.unwrap();
    assert_eq!(remedy.free, [unreachable]);
    assert!(is_matched(&without(&problem, unreachable)));
    assert!(is_matched(&bounded(&problem, 0.5, remedy.upper.unwrap())));
}

#[test]
fn unreachable_reference_instances_have_one_conflict_and_a_remedy() {
    for instance in gain_instances()
        .iter()
        .filter(|instance| instance.kind == "infeasible")
    {
        let solution = solved_within(&instance.problem, BUDGET);
        assert_eq!(
            solution.conflicts.len(),
            1,
            "{}: {:?}",
            instance.id,
            solution.conflicts
        );
        let remedy = solution.remedy.unwrap();
        for pair in &remedy.free {
            assert!(
                is_matched(&without(&instance.problem, *pair)),
                "{}: {pair:?}",
                instance.id
            );
        }
        assert!(!remedy.free.is_empty(), "{}", instance.id);
    }
}

#[test]
fn an_unmatched_solution_has_a_proof_its_residuals_and_a_remedy() {
    let problem = table_two(
        &[(2, 2, 0.6), (4, 2, 1.5)],
        Bounds {
            lower: 0.7,
            upper: 1.4,
        },
    );
    let solution = solved(&problem);
    assert!(matches!(solution.proof.outcome, Outcome::Proven { .. }));
    // The ratio of 2.5 is reduced to 2 by the factor 1.25, of which each entry takes half (0.97
    // dB).
    let [rate_miss, force_miss] = solution.unmatched.as_slice() else {
        panic!("{:?}", solution.unmatched)
    };
    assert_eq!(
        [rate_miss.pair, force_miss.pair],
        [Pair::new(2, 2), Pair::new(4, 2)]
    );
    assert!(
        (rate_miss.target - 0.6 * 1.25_f64.sqrt()).abs() < 1e-6,
        "{rate_miss:?}"
    );
    assert!(
        (force_miss.target - 1.5 / 1.25_f64.sqrt()).abs() < 1e-6,
        "{force_miss:?}"
    );
    assert!((rate_miss.excess - 0.969).abs() < 1e-3 && (force_miss.excess + 0.969).abs() < 1e-3);
    let remedy = solution.remedy.unwrap();
    assert_eq!((remedy.upper, remedy.lower), (Some(1.75), Some(0.56)));
    assert_eq!(remedy.free, [rate_miss.pair, force_miss.pair]);
}

#[test]
fn a_required_negative_delay_is_explained_as_a_lead() {
    let mut delta_s = PairTable::filled(6, 4, Some(0.01));
    delta_s[Pair::new(0, 1)] = Some(-0.034);
    let problem = Problem::delays(delta_s, on_axis(), 0.1);
    let solution = solved(&problem);
    let [miss] = solution.unmatched.as_slice() else {
        panic!("{:?}", solution.unmatched)
    };
    assert_eq!(miss.target, 0.0);
    assert!(matches!(
        miss.why.kind,
        ConflictKind::BelowLower { asked, .. } if (asked + 0.034).abs() <= 1e-15
    ));
    // 0.034 s at 12 rad/s are 0.408 rad.
    assert!((miss.phase_left_deg(12.0) - 0.408_f64.to_degrees()).abs() <= 1e-12);
    assert!(miss.why.is_lone_lead());
    assert_eq!((miss.pair, miss.why.entries.len()), (Pair::new(0, 1), 1));
    assert_eq!(solution.remedy.unwrap().upper, None);
}

#[test]
fn a_lead_as_small_as_rounding_counts_as_matched() {
    let mut delta_s = PairTable::filled(6, 4, Some(0.0));
    delta_s[Pair::new(0, 1)] = Some(-2.6e-17);
    delta_s[Pair::new(1, 0)] = Some(1.3e-17);
    let solution = solved(&Problem::delays(delta_s.clone(), on_axis(), 0.1));
    assert!(
        solution.matched && solution.unmatched.is_empty() && solution.conflicts.is_empty(),
        "{solution:?}"
    );
    // A required lead of one microsecond counts as unmatched.
    delta_s[Pair::new(0, 1)] = Some(-1e-6);
    assert_eq!(
        solved(&Problem::delays(delta_s, on_axis(), 0.1))
            .unmatched
            .len(),
        1
    );
}

#[test]
fn delays_that_differ_by_more_than_the_bound_are_explained() {
    let mut delta_s = PairTable::filled(6, 4, Some(0.01));
    delta_s[Pair::new(2, 2)] = Some(0.001);
    delta_s[Pair::new(4, 2)] = Some(0.0618);
    let problem = Problem::delays(delta_s, on_axis(), 0.05);
    let solution = solved(&problem);
    let [
        Conflict {
            kind: ConflictKind::TooFarApart { upper, .. },
            ..
        },
    ] = solution.conflicts.as_slice()
    else {
        panic!("{:?}", solution.conflicts)
    };
    // The difference of the delays, 0.0618 s - 0.001 s.
    assert_eq!(*upper, 0.0608);
    assert!(is_matched(&bounded(&problem, 0.0, 0.0608)));
    assert!(!is_matched(&bounded(&problem, 0.0, 0.0607)));
}

#[test]
fn every_unreachable_reference_delay_is_explained() {
    for instance in delay_instances()
        .iter()
        .filter(|instance| !instance.matched)
    {
        let solution = solved(&instance.problem);
        for miss in &solution.unmatched {
            assert!(
                miss.why.kind != ConflictKind::Unclear,
                "{}: {miss:?}",
                instance.id
            );
        }
        assert!(!solution.unmatched.is_empty());
    }
}

/// Returns the next lower value with three significant digits.
fn next_below(value: f64) -> f64 {
    value - 10f64.powi(value.log10().floor() as i32 - 2)
}

/// Returns the next higher value with three significant digits.
fn next_above(value: f64) -> f64 {
    value + 10f64.powi(value.log10().floor() as i32 - 2)
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: tries(64, 500),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn every_gain_conflict_is_unmatched_and_matched_without_any_of_its_entries(
        problem in gain_problems((6, 4), 1.5, Pattern::Any)
    ) {
        let problem = Problem { quantity: Quantity::Gain(GainObjective::Decibel), ..problem };
        for conflict in solved_within(&problem, BUDGET).conflicts {
            let alone = holding(&problem, &conflict.entries);
            prop_assert!(!is_matched(&alone), "{:?}", conflict);
            for &pair in &conflict.entries {
                let fewer = without(&alone, pair);
                prop_assert!(is_matched(&fewer), "{:?} without {:?}", conflict, pair);
            }
            let Bounds { lower, upper } = problem.bounds;
            match conflict.kind {
                ConflictKind::AboveUpper { upper: enough, .. } => {
                    prop_assert!(is_matched(&bounded(&alone, lower, enough)));
                    let less = next_below(enough).max(upper);
                    prop_assert!(!is_matched(&bounded(&alone, lower, less)));
                }
                ConflictKind::BelowLower { lower: Some(enough), .. } => {
                    prop_assert!(is_matched(&bounded(&alone, enough, upper)));
                    let less = next_above(enough).min(lower);
                    prop_assert!(!is_matched(&bounded(&alone, less, upper)));
                }
                ConflictKind::TooFarApart { upper: high, lower: Some(low), .. } => {
                    // The explanation concerns the ratio alone: a product along the same path may
                    // need even wider bounds.
                    prop_assert!(!is_matched(&bounded(&alone, lower, next_below(high).max(upper))));
                    prop_assert!(!is_matched(&bounded(&alone, next_above(low).min(lower), upper)));
                }
                ConflictKind::Loop { .. } => prop_assert!(!is_matched(&bounded(&alone, 1e-4, 1e4))),
                kind => prop_assert!(false, "conflict without a sufficient bound: {:?}", kind),
            }
        }
    }

    #[test]
    fn every_gain_remedy_suffices_and_a_smaller_change_does_not(
        problem in gain_problems((6, 4), 1.0, Pattern::Any)
    ) {
        let problem = Problem { quantity: Quantity::Gain(GainObjective::Decibel), ..problem };
        let solution = solved_within(&problem, BUDGET);
        prop_assert_eq!(solution.matched, solution.remedy.is_none());
        if let Some(remedy) = solution.remedy {
            let Bounds { lower, upper } = problem.bounds;
            if let Some(enough) = remedy.upper {
                prop_assert!(is_matched(&bounded(&problem, lower, enough)), "{}", enough);
                let less = next_below(enough).max(upper);
                prop_assert!(!is_matched(&bounded(&problem, lower, less)), "{}", enough);
            } else {
                prop_assert!(!is_matched(&bounded(&problem, lower, 1e4)));
            }
            if let Some(enough) = remedy.lower {
                prop_assert!(is_matched(&bounded(&problem, enough, upper)), "{}", enough);
                let less = next_above(enough).min(lower);
                prop_assert!(!is_matched(&bounded(&problem, less, upper)), "{}", enough);
            } else {
                prop_assert!(!is_matched(&bounded(&problem, 1e-4, upper)));
            }
            for pair in problem.constrained.marked() {
                let is_remedy = remedy.free.contains(&pair);
                prop_assert_eq!(is_matched(&without(&problem, pair)), is_remedy, "{:?}", pair);
            }
        }
    }

    #[test]
    fn every_delay_conflict_is_unmatched_and_matched_without_any_of_its_entries(
        problem in delay_problems((6, 4), Pattern::Any)
    ) {
        for conflict in solved(&problem).conflicts {
            let alone = holding(&problem, &conflict.entries);
            prop_assert!(!is_matched(&alone), "{:?}", conflict);
            for &freed in &conflict.entries {
                let fewer = without(&alone, freed);
                prop_assert!(is_matched(&fewer), "{:?} without {:?}", conflict, freed);
            }
            match conflict.kind {
                ConflictKind::AboveUpper { upper, .. }
                | ConflictKind::TooFarApart { upper, .. } => {
                    let less = bounded(&alone, 0.0, next_below(upper).max(problem.bounds.upper));
                    prop_assert!(!is_matched(&less), "{}", upper);
                }
                ConflictKind::BelowLower { .. } | ConflictKind::Loop { .. } => {
                    prop_assert!(!is_matched(&bounded(&alone, 0.0, 10.0)));
                }
                ConflictKind::Unclear => prop_assert!(false, "conflict without an explanation"),
            }
        }
    }

    #[test]
    fn every_delay_remedy_suffices(problem in delay_problems((6, 4), Pattern::Any)) {
        let solution = solved(&problem);
        if let Some(remedy) = solution.remedy {
            match remedy.upper {
                Some(upper) => {
                    prop_assert!(is_matched(&bounded(&problem, 0.0, upper)), "{}", upper);
                }
                None => prop_assert!(!is_matched(&bounded(&problem, 0.0, 10.0))),
            }
            for freed in remedy.free {
                prop_assert!(is_matched(&without(&problem, freed)), "{:?}", freed);
            }
        }
    }
}
