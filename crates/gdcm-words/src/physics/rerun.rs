//! Comparison of a rerun with its prediction, in words (M18.6).
//!
//! A *rerun* is a physics model linearised anew with several parameters changed; the *prediction*
//! for the same changes comes from runs with one parameter changed each.

use gdcm_model::number_format::{NO_VALUE, telling};
use gdcm_study::results::rerun_check::{RerunCheck, RerunRefusal, RerunVerdict};

/// Describes how well the prediction agrees with a rerun of the physics model, or why they are not
/// compared.
pub fn rerun_text(check: &RerunCheck) -> String {
    let place = format!("condition {}, rerun \"{}\"", check.condition, check.model);
    let cost = match &check.outcome {
        Ok(cost) => cost,
        Err(refusal) => {
            return format!("{place} is not compared: {}", rerun_refusal_text(refusal));
        }
    };
    let figures = format!(
        "J between prediction and rerun: {} on-axis, {} others (between base and rerun: {} and {})",
        mean_j_text(cost.prediction.on_axis),
        mean_j_text(cost.prediction.others),
        mean_j_text(cost.base.on_axis),
        mean_j_text(cost.base.others)
    );
    let verdict = match cost.verdict() {
        RerunVerdict::Good => "the prediction is good",
        RerunVerdict::Fair => "the prediction is fair",
        RerunVerdict::NotLinear => {
            "not linear enough: add a second run at the value found, or use the rerun as the new \
            nominal model with its own runs"
        }
    };
    format!("{place}: {figures}; {verdict}")
}

/// Formats a mean J; a dash if no response can be compared.
fn mean_j_text(mean: Option<f64>) -> String {
    match mean {
        Some(mean) => telling(mean, 2),
        None => NO_VALUE.to_owned(),
    }
}

fn rerun_refusal_text(refusal: &RerunRefusal) -> String {
    match refusal {
        RerunRefusal::NoBase => {
            "no physics model of the condition has its perturbation; add one".to_owned()
        }
        RerunRefusal::UnknownParameter { name } => {
            format!("the dataset has no physics model linearised with {name} changed; add one")
        }
        RerunRefusal::Unit {
            name,
            expected,
            found,
        } => format!(
            "unit of the change of {name}: expected {expected} as in its runs, found {found}"
        ),
        RerunRefusal::Runs(omission) => omission.to_string(),
        RerunRefusal::Increments(error) => error.to_string(),
        RerunRefusal::NothingToCompare => "no response can be compared".to_owned(),
    }
}
