//! Minima of the optimisation of signed delays (M15.4), and the lead filters that realise negative
//! delays (M15.3). Reference values are from independent numpy code.

use proptest::prelude::*;
use serde_json::Value;

use gdcm_method::correction::conflict::ConflictKind;
use gdcm_method::correction::lead_design::{LeadDesign, LeadSettings};
use gdcm_method::correction::sensitivity::kkt_residual;
use gdcm_method::correction::solve::solve;
use gdcm_method::correction::{Bounds, Outcome, Problem, ProofBudget};
use gdcm_model::dataset::{Band, Pair, PairTable};
use gdcm_model::response::{FrequencyGrid, LeadOrder};

use super::instances::{numbers, table};
use super::solved;

/// Asserts that a time \[s\] agrees within 1e-6 of the reference or within 1 ns.
#[track_caller]
fn assert_seconds(what: &str, found: f64, reference: f64) {
    assert_within(what, found, reference, 1e-9);
}

/// Asserts that a time \[s\] agrees within 1e-6 of the reference or within `least_s`.
#[track_caller]
fn assert_within(what: &str, found: f64, reference: f64, least_s: f64) {
    assert!(
        (found - reference).abs() <= (1e-6 * reference.abs()).max(least_s),
        "{what}: {found} is not {reference}"
    );
}

fn reference() -> Value {
    serde_json::from_str(include_str!(
        "../../../../../tests/data/reference/lead.json"
    ))
    .unwrap()
}

fn list<'a>(reference: &'a Value, name: &str) -> &'a [Value] {
    reference[name].as_array().unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Returns the filters of an order and pole, designed for the band from 0.5 to 12 rad/s.
fn design(entry: &Value) -> LeadDesign {
    let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 200);
    let order = if entry["order"] == 1 {
        LeadOrder::First
    } else {
        LeadOrder::Second
    };
    LeadDesign::new(
        LeadSettings {
            order,
            pole: number(&entry["pole"]),
            limit: 10.0,
        },
        grid.omega().into(),
    )
}

/// Returns the optimisation of signed delays of a reference case.
fn signed_delay_problem(entry: &Value) -> Problem {
    let delta = table(&entry["D_s"], Some);
    let held: Vec<Vec<f64>> = list(entry, "on").iter().map(numbers).collect();
    let constrained = PairTable::from_fn(delta.outputs(), delta.inputs(), |pair| {
        held.contains(&vec![pair.output as f64, pair.input as f64])
    });
    let bounds = Bounds {
        lower: number(&entry["lower_s"]),
        upper: number(&entry["upper_s"]),
    };
    let fitted = table(&entry["weight"], |weight| weight != 0.0);
    Problem {
        alpha: number(&entry["alpha"]),
        fitted,
        ..Problem::signed_delays(delta, constrained, bounds)
    }
}

#[test]
fn filters_have_the_reference_response_band_delay_and_gain_at_infinity() {
    for entry in list(&reference(), "filters") {
        let design = design(entry);
        let lead_s = number(&entry["lead_s"]);
        let filter = design.filter_for_lead(lead_s);
        let [omega, re, im] = ["omega", "re", "im"].map(|name| numbers(&entry[name]));
        for (k, omega) in omega.iter().enumerate() {
            let value = filter.at(*omega);
            // The reference is written with twelve digits.
            assert!(
                (value.re - re[k]).abs() + (value.im - im[k]).abs() < 1e-10 * value.norm(),
                "{entry}"
            );
        }
        assert_seconds(
            "band delay",
            design.band_delay_s(lead_s),
            number(&entry["band_delay_s"]),
        );
        assert!(
            (filter.gain_at_infinity() / number(&entry["gain_at_infinity"]) - 1.0).abs() < 1e-10
        );
    }
}

#[test]
fn a_signed_delay_has_the_reference_lead_time() {
    for entry in list(&reference(), "lead_time") {
        assert_seconds(
            "lead time",
            design(entry).lead_s(number(&entry["tau_s"])),
            number(&entry["lead_s"]),
        );
    }
}

#[test]
fn the_filter_for_a_slow_servo_exchanges_its_frequency_for_the_true_one() {
    // The servo of the simulation has a natural frequency of 22 rad/s, that of the aircraft 36
    // rad/s, both with a damping ratio of 0.707.
    let servo = &reference()["servo"];
    let entry = serde_json::json!({"order": 2, "pole": 3.0});
    let filter = design(&entry).filter(number(&servo["D_s"])).unwrap();
    assert_seconds("lead", filter.lead_s(), number(&servo["lead_s"]));
    assert!((filter.zero_rad_s() - 22.0).abs() < 1e-6 && (filter.lag_rad_s() - 36.0).abs() < 1e-12);
}

#[test]
fn every_signed_delay_problem_has_the_reference_solution() {
    for entry in list(&reference(), "programs") {
        let name = entry["name"].as_str().unwrap();
        let solution = solved(&signed_delay_problem(entry));
        // The reference approximates alpha = 0 by a small alpha, with a larger rounding error.
        let is_regularised = number(&entry["alpha"]) != 0.0;
        let least_s = if is_regularised { 1e-9 } else { 5e-9 };
        assert_eq!(
            solution.matched,
            entry["matched"].as_bool().unwrap(),
            "{name}"
        );
        assert!(
            matches!(solution.proof.outcome, Outcome::Proven { .. }),
            "{name}"
        );
        assert!(
            (solution.objective / number(&entry["objective"]) - 1.0).abs() < 1e-6,
            "{name}"
        );
        for (found, reference) in [
            (&solution.inputs, &entry["tau_in_s"]),
            (&solution.outputs, &entry["tau_out_s"]),
        ] {
            for (found, reference) in found.iter().zip(numbers(reference)) {
                assert_within(name, *found, reference, least_s);
            }
        }
    }
}

#[test]
fn the_kkt_residual_vanishes_at_each_optimum_only() {
    for entry in list(&reference(), "programs") {
        let problem = signed_delay_problem(entry);
        let mut solution = solved(&problem);
        // Rounding of slopes, each a sum of thirty delays of 0.1 s.
        assert!(
            kkt_residual(&problem, &solution) < 1e-14,
            "{}",
            entry["name"]
        );
        // Such a shift keeps all sums, so that only the regularisation notices it.
        for delay_s in &mut solution.inputs {
            *delay_s += 1e-3;
        }
        for delay_s in &mut solution.outputs {
            *delay_s -= 1e-3;
        }
        assert!(
            problem.alpha == 0.0 || kkt_residual(&problem, &solution) > 1e-3,
            "{}: the residual does not notice the shift",
            entry["name"]
        );
    }
}

#[test]
fn a_bound_on_the_gain_of_the_filters_is_met_and_explained() {
    let entry = list(&reference(), "programs")
        .iter()
        .find(|entry| entry["name"] == "one pair beyond reach")
        .cloned();
    let problem = signed_delay_problem(&entry.unwrap());
    let solution = solved(&problem);
    let lowest_s = solution
        .inputs
        .iter()
        .chain(&solution.outputs)
        .copied()
        .fold(f64::INFINITY, f64::min);
    assert_eq!(lowest_s, problem.bounds.lower);
    let ConflictKind::BelowLower { asked, .. } = solution.conflicts[0].kind else {
        panic!("{:?}", solution.conflicts)
    };
    // The two channels together give at most twice the lead of the bound, 191.2 ms.
    assert!((-2.0 * problem.bounds.lower - 0.1912).abs() < 5e-5);
    assert!(asked < 2.0 * problem.bounds.lower, "{asked}");
    let miss = &solution.unmatched[0];
    assert!(miss.delta < miss.target && miss.target < 0.0, "{miss:?}");
    let remedy = solution.remedy.unwrap();
    assert!(
        remedy.lower.unwrap() < problem.bounds.lower,
        "the remedy is a lower bound that allows more lead"
    );
}

/// Generates signed delay problems of four outputs and three inputs, and an order of each.
fn signed_delay_problems() -> impl Strategy<Value = (Problem, Vec<usize>, Vec<usize>)> {
    let table = (
        prop::collection::vec(-0.15_f64..0.1, 12),
        prop::collection::vec(any::<bool>(), 12),
        0.0_f64..0.05,
    );
    let orders = (
        Just((0..4).collect::<Vec<usize>>()).prop_shuffle(),
        Just((0..3).collect::<Vec<usize>>()).prop_shuffle(),
    );
    (table, orders).prop_map(|((delta, held, upper), (outputs, inputs))| {
        let at = |pair: Pair| pair.output * 3 + pair.input;
        let held = PairTable::from_fn(4, 3, |pair| {
            held[at(pair)] && (pair.output + pair.input) % 3 == 0
        });
        let bounds = Bounds {
            lower: -0.0956,
            upper,
        };
        let delta = PairTable::from_fn(4, 3, |pair| Some(delta[at(pair)]));
        (Problem::signed_delays(delta, held, bounds), outputs, inputs)
    })
}

proptest! {
    #[test]
    fn permuting_the_channels_permutes_the_signed_delays(
        (problem, outputs, inputs) in signed_delay_problems(),
    ) {
        let moved = |pair: Pair| Pair::new(outputs[pair.output], inputs[pair.input]);
        let permuted = Problem {
            delta: PairTable::from_fn(4, 3, |pair| problem.delta[moved(pair)]),
            constrained: PairTable::from_fn(4, 3, |pair| problem.constrained[moved(pair)]),
            ..problem.clone()
        };
        let plain = solve(&problem, ProofBudget::default(), &|| false).unwrap();
        let permuted = solve(&permuted, ProofBudget::default(), &|| false).unwrap();
        // Strictly convex: both solutions agree up to the rounding of Newton's last step.
        for (place, &output) in outputs.iter().enumerate() {
            prop_assert!((permuted.outputs[place] - plain.outputs[output]).abs() < 1e-12);
        }
        for (place, &input) in inputs.iter().enumerate() {
            prop_assert!((permuted.inputs[place] - plain.inputs[input]).abs() < 1e-12);
        }
    }

    #[test]
    fn the_band_delays_of_filters_in_series_add_up(
        first_s in 0.0_f64..0.08,
        second_s in 0.0_f64..0.08,
    ) {
        let entry = serde_json::json!({"order": 2, "pole": 3.0});
        let design = design(&entry);
        let [first, second] = [first_s, second_s].map(|lead_s| design.filter_for_lead(lead_s));
        let omega = design.omega();
        // Least-squares line through the origin: -sum(omega phase) / sum(omega^2).
        let moment: f64 = omega
            .iter()
            .map(|&omega| omega * (first.at(omega) * second.at(omega)).arg())
            .sum();
        let series_s = -moment / omega.iter().map(|omega| omega * omega).sum::<f64>();
        // If the two filters together turn the phase by less than 180 deg, its principal value is
        // the phase.
        let turn = first.phase(12.0) + second.phase(12.0);
        prop_assume!(turn < 3.1);
        let [first_delay_s, second_delay_s] =
            [first_s, second_s].map(|lead_s| design.band_delay_s(lead_s));
        prop_assert!((series_s - first_delay_s - second_delay_s).abs() < 1e-15);
    }
}
