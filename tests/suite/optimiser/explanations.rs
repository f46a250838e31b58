//! Every explanation is put to the test: what it says would help helps, and less does not.

use gdcm::correction::{
    Channel, DelayConflict, DelayProblem, GainBounds, GainConflict, GainObjective, GainProblem, ProofBudget,
    solve_delays, solve_gains,
};
use gdcm::dataset::{Pair, PairTable};
use proptest::prelude::*;

use super::instances::{delay_instances, gain_instances, on_axis};
use super::random::{Pattern, delay_problems, gain_problems};

/// Reachability needs no proof.
const BUDGET: ProofBudget = ProofBudget { boxes: 1, minima: 0 };

const INPUTS: [&str; 4] = ["LON", "LAT", "PED", "COL"];
const OUTPUTS: [&str; 6] = ["P", "Q", "R", "NX", "NY", "NZ"];

fn names(list: &[&str]) -> Vec<String> {
    list.iter().map(|&name| name.to_owned()).collect()
}

fn holding(problem: &GainProblem, entries: &[Pair]) -> GainProblem {
    GainProblem { constrained: problem.constrained.map(|pair, _| entries.contains(&pair)), ..problem.clone() }
}

fn without(problem: &GainProblem, freed: Pair) -> GainProblem {
    GainProblem { constrained: problem.constrained.map(|pair, held| *held && pair != freed), ..problem.clone() }
}

fn bounded(problem: &GainProblem, lower: f64, upper: f64) -> GainProblem {
    GainProblem { bounds: GainBounds { lower, upper }, ..problem.clone() }
}

fn is_matched(problem: &GainProblem) -> bool {
    solve_gains(problem, BUDGET).unwrap().matched
}

fn delays_matched(problem: &DelayProblem) -> bool {
    solve_delays(problem).unwrap().matched
}

/// Six by four gains of 1 with Table 2 held, the given entries changed.
fn table_two(changes: &[(usize, usize, f64)], bounds: GainBounds) -> GainProblem {
    let mut wanted = PairTable::filled(6, 4, Some(1.0));
    for &(output, input, gain) in changes {
        wanted[Pair::new(output, input)] = Some(gain);
    }
    GainProblem::new(wanted, on_axis(), bounds)
}

#[test]
fn a_product_above_the_bounds_is_explained() {
    let problem = table_two(&[(0, 1, 2.5)], GainBounds { lower: 0.7, upper: 1.4 });
    let solution = solve_gains(&problem, BUDGET).unwrap();
    let [conflict] = solution.conflicts.as_slice() else { panic!("{:?}", solution.conflicts) };
    // 1.58^2 = 2.496 is not enough, 1.59^2 = 2.528 is.
    assert!(matches!(conflict, GainConflict::ProductTooGreat { upper, .. } if *upper == 1.59), "{conflict:?}");
    assert_eq!(
        conflict.words(&names(&INPUTS), &names(&OUTPUTS)),
        "LAT → P cannot be held: with gains <= 1.400 the product k_LAT k_P is at most 1.960, not 2.500; set the upper bound to 1.59 \
         or free it."
    );
    assert!(is_matched(&bounded(&problem, 0.7, 1.59)));
    assert!(!is_matched(&bounded(&problem, 0.7, 1.58)));
    let miss = &solution.unmatched[0];
    // 20 log10 (1.96 / 2.5), by hand.
    assert!((miss.shortfall_db + 2.114).abs() <= 1e-3, "{}", miss.shortfall_db);
}

#[test]
fn a_product_below_the_bounds_is_explained() {
    let problem = table_two(&[(5, 3, 0.3)], GainBounds { lower: 0.7, upper: 1.4 });
    let solution = solve_gains(&problem, BUDGET).unwrap();
    let [GainConflict::ProductTooSmall { lower, channels, .. }] = solution.conflicts.as_slice() else {
        panic!("{:?}", solution.conflicts)
    };
    // 0.547^2 = 0.2992 and 0.548^2 = 0.3003.
    assert_eq!(*lower, 0.547);
    assert_eq!(*channels, (Channel::Input(3), Channel::Output(5)));
    assert!(is_matched(&bounded(&problem, 0.547, 1.4)));
    assert!(!is_matched(&bounded(&problem, 0.548, 1.4)));
}

#[test]
fn two_entries_that_share_an_input_are_explained_by_their_ratio() {
    let problem = table_two(&[(2, 2, 0.6), (4, 2, 1.5)], GainBounds { lower: 0.7, upper: 1.4 });
    let solution = solve_gains(&problem, BUDGET).unwrap();
    let [conflict] = solution.conflicts.as_slice() else { panic!("{:?}", solution.conflicts) };
    assert_eq!(
        conflict.words(&names(&INPUTS), &names(&OUTPUTS)),
        "PED → R and PED → NY cannot both be held: with k_NY <= 1.400 and k_R >= 0.700 their ratio is at most 2.000, not 2.500; \
         set the upper bound to 1.75, or the lower bound to 0.56, or free one of them."
    );
    assert!(is_matched(&bounded(&problem, 0.7, 1.75)) && !is_matched(&bounded(&problem, 0.7, 1.74)));
    assert!(is_matched(&bounded(&problem, 0.56, 1.4)) && !is_matched(&bounded(&problem, 0.561, 1.4)));
    for &pair in conflict.entries() {
        assert!(is_matched(&without(&problem, pair)), "{pair:?}");
    }
    assert_eq!(solution.unmatched.len(), 2);
}

#[test]
fn a_cycle_of_constraints_is_explained() {
    for instance in gain_instances().iter().filter(|instance| instance.kind == "cycle_inconsistent") {
        let solution = solve_gains(&instance.problem, BUDGET).unwrap();
        let [GainConflict::Loop { entries, mismatch_db }] = solution.conflicts.as_slice() else {
            panic!("{}: {:?}", instance.id, solution.conflicts)
        };
        // The least squares spread the mismatch evenly over the four entries.
        let mismatch = 4.0 * instance.residual * 20.0 / std::f64::consts::LN_10;
        assert!((mismatch_db.abs() - mismatch).abs() <= 1e-6, "{}: {mismatch_db}", instance.id);
        assert_eq!(entries.len(), 4);
        assert!(!is_matched(&bounded(&instance.problem, 1e-3, 1e3)), "{}: no bound helps", instance.id);
        for &pair in entries {
            assert!(is_matched(&without(&instance.problem, pair)), "{}: {pair:?}", instance.id);
        }
        let words = solution.conflicts[0].words(&names(&INPUTS), &names(&OUTPUTS));
        assert!(
            words.contains("form a loop: their ratios disagree by") && words.ends_with("free one of them."),
            "{words}"
        );
    }
}

#[test]
fn unreachable_reference_instances_are_explained_as_they_were_made() {
    for instance in gain_instances().iter().filter(|instance| instance.kind == "infeasible") {
        let solution = solve_gains(&instance.problem, BUDGET).unwrap();
        assert_eq!(solution.conflicts.len(), 1, "{}: {:?}", instance.id, solution.conflicts);
        let remedy = solution.remedy.unwrap();
        for pair in &remedy.free {
            assert!(is_matched(&without(&instance.problem, *pair)), "{}: {pair:?}", instance.id);
        }
        assert!(!remedy.free.is_empty(), "{}", instance.id);
    }
}

#[test]
fn an_answer_is_put_into_words_from_its_proof_to_its_remedies() {
    let problem = table_two(&[(2, 2, 0.6), (4, 2, 1.5)], GainBounds { lower: 0.7, upper: 1.4 });
    let solution = solve_gains(&problem, ProofBudget::default()).unwrap();
    let words = solution.words(&names(&INPUTS), &names(&OUTPUTS));
    // The ratio of 2.5 is cut to 2 by the factor 1.25, half of it (0.97 dB) to each side.
    assert_eq!(
        words[..3],
        [
            "Proven: no gains within the bounds are better.",
            "PED → R is held at 0.671 instead of 0.600 (+1.0 dB).",
            "PED → NY is held at 1.342 instead of 1.500 (-1.0 dB).",
        ]
    );
    assert_eq!(
        words[4],
        "Any one of these lets all be held: an upper bound of 1.75; a lower bound of 0.56; freeing PED → R; freeing PED → NY."
    );
    assert_eq!(words.len(), 5);
}

#[test]
fn a_delay_that_would_have_to_be_negative_is_explained_as_lead() {
    let mut wanted_s = PairTable::filled(6, 4, Some(0.01));
    wanted_s[Pair::new(0, 1)] = Some(-0.034);
    let problem = DelayProblem::new(wanted_s, on_axis(), 0.1);
    let solution = solve_delays(&problem).unwrap();
    let [miss] = solution.unmatched.as_slice() else { panic!("{:?}", solution.unmatched) };
    assert_eq!(miss.target_s, 0.0);
    assert!(matches!(miss.why, DelayConflict::NeedsLead { lead_s, .. } if (lead_s - 0.034).abs() <= 1e-15));
    // 0.034 s at 12 rad/s: 0.408 rad.
    assert!((miss.phase_left_deg(12.0) - 0.408_f64.to_degrees()).abs() <= 1e-12);
    assert_eq!(
        miss.words(12.0, &names(&INPUTS), &names(&OUTPUTS)),
        "LAT → P needs 34.0 ms of lead: a delay cannot give it; 23° of phase error remain at 12 rad/s."
    );
    assert_eq!(solution.remedy.unwrap().upper_s, None);
}

#[test]
fn delays_that_differ_by_more_than_the_bound_are_explained() {
    let mut wanted_s = PairTable::filled(6, 4, Some(0.01));
    wanted_s[Pair::new(2, 2)] = Some(0.001);
    wanted_s[Pair::new(4, 2)] = Some(0.0618);
    let problem = DelayProblem::new(wanted_s, on_axis(), 0.05);
    let solution = solve_delays(&problem).unwrap();
    let [DelayConflict::DifferenceTooGreat { upper_s, .. }] = solution.conflicts.as_slice() else {
        panic!("{:?}", solution.conflicts)
    };
    assert_eq!(*upper_s, 0.0608);
    assert!(delays_matched(&DelayProblem { upper_s: 0.0608, ..problem.clone() }));
    assert!(!delays_matched(&DelayProblem { upper_s: 0.0607, ..problem.clone() }));
}

#[test]
fn unreachable_reference_delays_are_all_explained() {
    for instance in delay_instances().iter().filter(|instance| !instance.matched) {
        let solution = solve_delays(&instance.problem).unwrap();
        for miss in &solution.unmatched {
            assert!(!matches!(miss.why, DelayConflict::Unclear { .. }), "{}: {miss:?}", instance.id);
        }
        assert!(!solution.unmatched.is_empty());
    }
}

/// Whether a bound of three digits is far enough from `exact` for a change of one in the last to tell.
fn next_below(value: f64) -> f64 {
    value - 10f64.powi(value.log10().floor() as i32 - 2)
}

fn next_above(value: f64) -> f64 {
    value + 10f64.powi(value.log10().floor() as i32 - 2)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_gain_conflict_is_impossible_as_it_is_and_possible_without_any_one_of_its_parts(
        problem in gain_problems((6, 4), 1.5, Pattern::Any)
    ) {
        let problem = GainProblem { objective: GainObjective::Decibel, ..problem };
        for conflict in solve_gains(&problem, BUDGET).unwrap().conflicts {
            let alone = holding(&problem, conflict.entries());
            prop_assert!(!is_matched(&alone), "{:?}", conflict);
            for &pair in conflict.entries() {
                prop_assert!(is_matched(&without(&alone, pair)), "{:?} without {:?}", conflict, pair);
            }
            let GainBounds { lower, upper } = problem.bounds;
            match conflict {
                GainConflict::ProductTooGreat { upper: enough, .. } => {
                    prop_assert!(is_matched(&bounded(&alone, lower, enough)));
                    prop_assert!(!is_matched(&bounded(&alone, lower, next_below(enough).max(upper))));
                }
                GainConflict::ProductTooSmall { lower: enough, .. } => {
                    prop_assert!(is_matched(&bounded(&alone, enough, upper)));
                    prop_assert!(!is_matched(&bounded(&alone, next_above(enough).min(lower), upper)));
                }
                GainConflict::RatioTooGreat { upper: high, lower: low, .. } => {
                    // A product of the same path may need more: the ratio's own claim is about the ratio.
                    let stretched = |lower: f64, upper: f64| bounded(&alone, lower, upper);
                    prop_assert!(!is_matched(&stretched(lower, next_below(high).max(upper))));
                    prop_assert!(!is_matched(&stretched(next_above(low).min(lower), upper)));
                }
                GainConflict::Loop { .. } => prop_assert!(!is_matched(&bounded(&alone, 1e-4, 1e4))),
                GainConflict::Unclear { .. } => prop_assert!(false, "every conflict is clear"),
            }
        }
    }

    #[test]
    fn every_gain_remedy_makes_all_reachable_and_a_smaller_change_does_not(
        problem in gain_problems((6, 4), 1.0, Pattern::Any)
    ) {
        let problem = GainProblem { objective: GainObjective::Decibel, ..problem };
        let solution = solve_gains(&problem, BUDGET).unwrap();
        prop_assert_eq!(solution.matched, solution.remedy.is_none());
        if let Some(remedy) = solution.remedy {
            let GainBounds { lower, upper } = problem.bounds;
            if let Some(enough) = remedy.upper {
                prop_assert!(is_matched(&bounded(&problem, lower, enough)), "{}", enough);
                prop_assert!(!is_matched(&bounded(&problem, lower, next_below(enough).max(upper))), "{}", enough);
            } else {
                prop_assert!(!is_matched(&bounded(&problem, lower, 1e4)));
            }
            if let Some(enough) = remedy.lower {
                prop_assert!(is_matched(&bounded(&problem, enough, upper)), "{}", enough);
                prop_assert!(!is_matched(&bounded(&problem, next_above(enough).min(lower), upper)), "{}", enough);
            } else {
                prop_assert!(!is_matched(&bounded(&problem, 1e-4, upper)));
            }
            for pair in problem.constrained.marked() {
                prop_assert_eq!(is_matched(&without(&problem, pair)), remedy.free.contains(&pair), "{:?}", pair);
            }
        }
    }

    #[test]
    fn every_delay_conflict_is_impossible_as_it_is_and_possible_without_any_one_of_its_parts(
        problem in delay_problems((6, 4), Pattern::Any)
    ) {
        for conflict in solve_delays(&problem).unwrap().conflicts {
            let alone = DelayProblem {
                constrained: problem.constrained.map(|pair, _| conflict.entries().contains(&pair)),
                ..problem.clone()
            };
            prop_assert!(!delays_matched(&alone), "{:?}", conflict);
            for &freed in conflict.entries() {
                let fewer = DelayProblem {
                    constrained: alone.constrained.map(|pair, held| *held && pair != freed),
                    ..alone.clone()
                };
                prop_assert!(delays_matched(&fewer), "{:?} without {:?}", conflict, freed);
            }
            match conflict {
                DelayConflict::SumTooGreat { upper_s, .. } | DelayConflict::DifferenceTooGreat { upper_s, .. } => {
                    let less = DelayProblem { upper_s: next_below(upper_s).max(problem.upper_s), ..alone.clone() };
                    prop_assert!(!delays_matched(&less), "{}", upper_s);
                }
                DelayConflict::NeedsLead { .. } | DelayConflict::Loop { .. } => {
                    let wide = DelayProblem { upper_s: 10.0, ..alone.clone() };
                    prop_assert!(!delays_matched(&wide));
                }
                DelayConflict::Unclear { .. } => prop_assert!(false, "every conflict is clear"),
            }
        }
    }

    #[test]
    fn every_delay_remedy_makes_all_reachable(problem in delay_problems((6, 4), Pattern::Any)) {
        let solution = solve_delays(&problem).unwrap();
        if let Some(remedy) = solution.remedy {
            match remedy.upper_s {
                Some(upper_s) => {
                    let enough = DelayProblem { upper_s, ..problem.clone() };
                    prop_assert!(delays_matched(&enough), "{}", upper_s);
                }
                None => {
                    let wide = DelayProblem { upper_s: 10.0, ..problem.clone() };
                    prop_assert!(!delays_matched(&wide));
                }
            }
            for freed in remedy.free {
                let fewer = DelayProblem {
                    constrained: problem.constrained.map(|pair, held| *held && pair != freed),
                    ..problem.clone()
                };
                prop_assert!(delays_matched(&fewer), "{:?}", freed);
            }
        }
    }
}
