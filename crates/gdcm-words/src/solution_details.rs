//! Details about a condition's solution, as sentences.

use gdcm_method::correction::Outcome;
use gdcm_method::correction::branch_and_bound::proof_budget::Limit;
use gdcm_method::correction::sensitivity::{kkt_residual, sensitivities};
use gdcm_study::{ConditionAnalysis, PhaseCorrection, Study};

use crate::conflict_text::miss_text;
use crate::sensitivity::sensitivity_text;

/// Lists details about the solution: whether the gains are proven to be optimal, other minima of
/// the gains, with leads the KKT residual, the phase error at the upper end of the band due to each
/// missed delay, and the sensitivity to constraints and active bounds.
pub fn details(study: &Study, result: &ConditionAnalysis) -> Vec<String> {
    /// Sensitivities up to this value, relative to the objective, are not listed.
    const NOTABLE: f64 = 1e-3;
    let (inputs, outputs) = study.dataset.input_and_output_names();
    let mut details = vec![proof_text(result.gains.proof.outcome)];
    // The first minimum is the solution itself.
    for minimum in result.gains.proof.local_minima.iter().skip(1) {
        let worse = 100.0 * (minimum.objective / result.gains.objective - 1.0);
        let of_inputs = named_gains(&inputs, &minimum.inputs);
        let of_outputs = named_gains(&outputs, &minimum.outputs);
        details.push(format!(
            "Another set of gains is only {worse:.2} % worse: {of_inputs}; {of_outputs}."
        ));
    }
    if study.settings.phase == PhaseCorrection::Lead {
        let residual_s = kkt_residual(&result.delay_problem, &result.delays);
        details.push(format!(
            "The optimisation of delays and leads is convex: the KKT residual of {residual_s:.0e} \
            s proves that the solution is optimal."
        ));
    }
    let band_top = study.settings.band.max();
    for miss in &result.delays.unmatched {
        details.push(miss_text(miss, band_top, &inputs, &outputs));
    }
    for (problem, solution) in [
        (&result.gain_problem, &result.gains),
        (&result.delay_problem, &result.delays),
    ] {
        for sensitivity in sensitivities(problem, solution) {
            if sensitivity.share_per_unit.abs() > NOTABLE {
                details.push(sensitivity_text(&sensitivity, &inputs, &outputs));
            }
        }
    }
    details
}

/// Describes in a sentence whether a solution is proven to be optimal.
pub fn proof_text(outcome: Outcome) -> String {
    match outcome {
        Outcome::Proven { .. } => {
            "Proven: no better solution satisfies the bounds and the held responses.".to_owned()
        }
        Outcome::NotProven { gap, limit } => {
            let ended = match limit {
                Limit::Work => "because its work budget was exhausted",
                Limit::Memory => "because its memory budget was exhausted",
                Limit::Rounding => "because of rounding errors",
            };
            let percent = 100.0 * gap;
            format!(
                "Not proven: a solution that is up to {percent:.2} % better may exist; the search ended {ended}."
            )
        }
    }
}

/// Lists gains with their channels: "LON 1.012, LAT 0.987".
fn named_gains(names: &[String], gains: &[f64]) -> String {
    let named: Vec<String> = names
        .iter()
        .zip(gains)
        .map(|(name, gain)| format!("{name} {gain:.3}"))
        .collect();
    named.join(", ")
}
