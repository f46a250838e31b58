//! The comparisons, one file per part of the method.

mod couplings;
mod error_bars;
mod example;
mod fidelity;
mod identification;
mod leads;
mod optimum;
mod physics;
mod requirements;
mod responses;

use crate::check::Check;

/// Source of expected values: code that shares nothing with the program.
const NUMPY: &str = "independent NumPy code of the method on a dataset of eleven conditions";

/// Reason for a tolerance of 1e-6 where medians and quantiles are compared.
const OF_MEDIANS: &str = "both programs take medians and quantiles of the same 200 values, which the \
                          reference contains to about 1e-9";

/// All comparisons, ordered by method section.
pub const CHECKS: &[Check] = &[
    Check {
        code: "frequency-responses",
        sections: "M2",
        what: "frequency responses of published helicopters, of a nearly defective model, and of \
               models of the example",
        source: "arithmetic with 50 digits",
        measure: "relative to the largest magnitude of the model",
        tolerance: 1e-9,
        reason: "conditioning with 39 states; well-conditioned models agree to about 1e-13 in double \
                 precision",
        run: responses::golden_responses,
    },
    Check {
        code: "discrete-and-delayed-responses",
        sections: "M2a",
        what: "responses of first-order models in discrete time and with channel delays",
        source: "closed form",
        measure: "relative to the magnitude",
        tolerance: 1e-12,
        reason: "rounding of a division and of two complex exponentials",
        run: responses::timed_responses,
    },
    Check {
        code: "cost-of-gain-and-delay",
        sections: "M4",
        what: "J of a pure gain and a pure delay, as median and as mean",
        source: "closed form: J = 20 (20 log10 k)^2 + 20 W_p average((omega tau)^2)",
        measure: "relative",
        tolerance: 1e-12,
        reason: "rounding of sums over 200 frequencies",
        run: fidelity::cost_of_gain_and_delay,
    },
    Check {
        code: "coherence-weights",
        sections: "M4a",
        what: "coherence weights",
        source: "independent NumPy code of M. B. Tischler's weight",
        measure: "absolute",
        tolerance: 1e-15,
        reason: "rounding of an exponential",
        run: fidelity::coherence_weights,
    },
    Check {
        code: "muad-envelopes",
        sections: "MUAD",
        what: "envelopes of maximum unnoticeable added dynamics",
        source: "coefficients as published in three public programs, evaluated by NumPy",
        measure: "dB and deg",
        tolerance: 1e-11,
        reason: "the same formula evaluated in another order",
        run: fidelity::envelopes,
    },
    Check {
        code: "representatives",
        sections: "M5",
        what: "representatives, suggested outliers, scores and discontinuity ratios of the example",
        source: NUMPY,
        measure: "relative to the value or 1, whichever is larger",
        tolerance: 1e-6,
        reason: OF_MEDIANS,
        run: example::representatives,
    },
    Check {
        code: "delta-gains-and-delays",
        sections: "M3, M6, M7",
        what: "delta gains G, delta delays D and bounds of the example",
        source: NUMPY,
        measure: "relative to the value or 1 (delays: 1 ms), whichever is larger",
        tolerance: 1e-6,
        reason: OF_MEDIANS,
        run: example::deltas,
    },
    Check {
        code: "channel-gains-and-delays",
        sections: "M8, M9",
        what: "channel gains and delays of the example",
        source: NUMPY,
        measure: "relative to the value or 1 (delays: 1 ms), whichever is larger",
        tolerance: 1e-6,
        reason: OF_MEDIANS,
        run: example::corrections,
    },
    Check {
        code: "costs-of-corrections",
        sections: "M4, M10",
        what: "J of every response of the example before and after its correction",
        source: NUMPY,
        measure: "relative to J or 1, whichever is larger",
        tolerance: 1e-6,
        reason: OF_MEDIANS,
        run: example::costs,
    },
    Check {
        code: "schedule-and-assessment",
        sections: "M11, M12",
        what: "scheduled gains of the example at every airspeed, and the change of J",
        source: NUMPY,
        measure: "relative to the value or 1, whichever is larger",
        tolerance: 1e-6,
        reason: OF_MEDIANS,
        run: example::assessment,
    },
    Check {
        code: "certified-gains",
        sections: "M8",
        what: "global minimum of eq. (7): realistic, wide, unreachable, cyclic and single-point \
               instances; each proven by branch and bound to a gap of 1e-9",
        source: "minima certified by an independent interval branch and bound, confirmed by SCIP or \
                 IPOPT",
        measure: "relative deviation of the objective",
        tolerance: 1e-8,
        reason: "the references are certified to 1e-8",
        run: optimum::certified_gains,
    },
    Check {
        code: "held-products",
        sections: "M8",
        what: "held products and bounds of the gains in the same instances",
        source: "the constraints themselves",
        measure: "relative",
        tolerance: 1e-9,
        reason: "rounding of exponentials of sums of logarithms",
        run: optimum::held_products,
    },
    Check {
        code: "certified-delays",
        sections: "M9",
        what: "minimum of eq. (11)",
        source: "an interior-point method; the problem is convex, so that its minimum is global",
        measure: "relative deviation of the objective",
        tolerance: 1e-8,
        reason: "termination of the interior-point method",
        run: optimum::certified_delays,
    },
    Check {
        code: "error-bars",
        sections: "M13",
        what: "value, parts and half-width of the error bars of the example's net gains and delays",
        source: "independent NumPy code",
        measure: "absolute (natural logarithm; s)",
        tolerance: 1e-5,
        reason: "the optimum of the gains is flat",
        run: error_bars::bars_of_the_example,
    },
    Check {
        code: "student-quantiles",
        sections: "M13",
        what: "Student's t at 90 % and 95 %",
        source: "M. Abramowitz, I. A. Stegun: Handbook of Mathematical Functions, 1964, table 26.10",
        measure: "absolute",
        tolerance: 5e-4,
        reason: "the table has three decimals",
        run: error_bars::student_quantiles,
    },
    Check {
        code: "identification-of-known-model",
        sections: "M14",
        what: "identification of a system of four states from three generated records without noise",
        source: "the system from which the records are generated",
        measure: "relative to the largest magnitude at each frequency",
        tolerance: 2e-3,
        reason: "a sum over samples replaces an integral: error (omega T)^2 / 12, 1.2e-3 at 6 rad/s",
        run: identification::known_model,
    },
    Check {
        code: "lead-filters",
        sections: "M15.3",
        what: "lead filters: response, gain at infinity, and the lead of a signed delay",
        source: "independent NumPy code",
        measure: "relative (times: to the value or 1 ms, whichever is larger)",
        tolerance: 1e-6,
        reason: "the references are written with twelve digits; their times come from a search that \
                 ends at 1e-9 s",
        run: leads::filters,
    },
    Check {
        code: "signed-delays",
        sections: "M15.4",
        what: "minima of the optimisations of signed delays, and their proofs",
        source: "independent NumPy code",
        measure: "relative deviation of the objective",
        tolerance: 1e-6,
        reason: "alpha = 0 is approximated by a small alpha in the reference",
        run: leads::signed_delays,
    },
    Check {
        code: "coupled-state-space",
        sections: "M16",
        what: "state space with feed-through after mixing and feedback",
        source: "independent NumPy code",
        measure: "absolute (entries of order 1)",
        tolerance: 1e-12,
        reason: "rounding of a matrix inverse of condition number below 10",
        run: couplings::coupled_state_space,
    },
    Check {
        code: "coupling-fit",
        sections: "M16",
        what: "mixing and feedback of a synthetic aircraft after each of five solves",
        source: "independent NumPy code",
        measure: "absolute (coefficients of order 1)",
        tolerance: 1e-9,
        reason: "condition number of the normal equations",
        run: couplings::disturbed_aircraft,
    },
    Check {
        code: "bandwidth-and-phase-delay",
        sections: "M17",
        what: "bandwidth, phase delay and margins of four attitude responses with delay",
        source: "independent code that evaluates the closed forms",
        measure: "relative",
        tolerance: 1e-9,
        reason: "root search to 1e-10 of the frequency",
        run: requirements::bandwidths,
    },
    Check {
        code: "physics-parameters",
        sections: "M18",
        what: "two named parameters of a synthetic aircraft after each pass, and its delays",
        source: "independent NumPy code",
        measure: "absolute (scaled parameters)",
        tolerance: 1e-8,
        reason: "condition number of the information matrix",
        run: physics::synthetic_aircraft,
    },
];

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::reference_study::ReferenceStudy;

    #[test]
    fn codes_are_distinct_kebab_case() {
        let codes: BTreeSet<&str> = CHECKS.iter().map(|check| check.code).collect();
        assert_eq!(codes.len(), CHECKS.len());
        for code in codes {
            let is_kebab = code
                .chars()
                .all(|letter| letter.is_ascii_lowercase() || letter == '-');
            assert!(is_kebab, "{code}");
        }
    }

    /// Runs all comparisons, and records their figures for `docs/verification.md`.
    #[test]
    fn every_comparison_is_within_its_tolerance() {
        let mut study = ReferenceStudy::default();
        for check in CHECKS {
            let found = (check.run)(&mut study).expect(check.code);
            assert!(found.values > 0, "{}: nothing was compared", check.code);
            assert!(
                found.worst <= check.tolerance,
                "{}: {:e}",
                check.code,
                found.worst
            );
            crate::evidence::record(crate::evidence::Deviations {
                code: check.code,
                instances: found.instances,
                values: found.values,
                worst: found.worst,
                tolerance: check.tolerance,
            });
        }
    }

    #[test]
    fn a_wrong_reference_is_found() {
        let analysis = ReferenceStudy::default()
            .analysis()
            .expect("it is embedded");
        let mut found = crate::check::Found::default();
        for result in analysis.conditions.values().flatten() {
            found.scaled(1.01 * result.gains.objective, result.gains.objective, 1e-3);
        }
        assert!(found.worst > 1e-3 && found.values == 11);
    }
}
