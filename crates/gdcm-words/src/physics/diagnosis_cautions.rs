//! Cautions about the diagnosis of physics parameters, and the conditions that determine it most
//! (M18.4).
//!
//! The fit of the parameters is repeated in passes until no value changes. A *pull* is the change in
//! a value if a condition is left out of the fit.

use gdcm_method::physics::diagnosis::NOTABLE_MISFIT;
use gdcm_method::physics::identifiability::WeakDirection;
use gdcm_model::number_format::{decimals, signed};
use gdcm_study::results::physics_findings::PhysicsFindings;

/// Maximum number of listed pulls: changes in a value if a condition is left out.
const LISTED_PULLS: usize = 3;

/// Lists the cautions about the diagnosis.
pub fn diagnosis_cautions(findings: &PhysicsFindings) -> Vec<String> {
    let diagnosis = &findings.diagnosis;
    let mut cautions = Vec::new();
    if let Some(moving) = diagnosis.fit.still_moving {
        cautions.push(format!(
            "the fit has not converged after {} passes: {} still changes, usually because \
            it cannot be told apart from another parameter; set a plausible value for one of \
            the two",
            diagnosis.fit.passes.len(),
            parameter_name(findings, moving)
        ));
    }
    for diagnosed in findings.diagnosed() {
        if diagnosed.diagnosis.acts_like_channels() {
            cautions.push(format!(
                "{} acts like a gain or a delay of the channels; its value depends on the prior of \
                the channel delays",
                diagnosed.parameter.name
            ));
        }
    }
    for pair in &diagnosis.pairs {
        let [first, second] = pair.parameters;
        cautions.push(format!(
            "{} and {} cannot be told apart (correlation {}): set a plausible value for one, or \
            change both",
            parameter_name(findings, first),
            parameter_name(findings, second),
            decimals(pair.correlation, 2)
        ));
    }
    if let Some(weak) = diagnosis.weak_direction() {
        cautions.push(weak_direction_text(weak, findings));
    }
    let poor = diagnosis.poorly_fitted();
    if !poor.is_empty() {
        let ids: Vec<String> = poor.iter().map(|id| id.to_string()).collect();
        let conditions = if poor.len() == 1 {
            "condition"
        } else {
            "conditions"
        };
        cautions.push(format!(
            "{conditions} {}: fitted more than {NOTABLE_MISFIT} times worse than the median \
            condition; check the nominal model and the runs there",
            ids.join(", ")
        ));
    }
    cautions
}

/// Returns a parameter's name; `index` counts the parameters that are on.
fn parameter_name(findings: &PhysicsFindings, index: usize) -> &str {
    &findings.parameters[index].name
}

fn weak_direction_text(weak: &WeakDirection, findings: &PhysicsFindings) -> String {
    /// Smallest component that is listed.
    const LISTED: f64 = 0.2;
    let mut parts = Vec::new();
    for (&parameter, &component) in findings.diagnosis.fit.fitted.iter().zip(&weak.direction) {
        if component.abs() >= LISTED {
            parts.push(format!(
                "{} {}",
                signed(component, 2),
                parameter_name(findings, parameter)
            ));
        }
    }
    format!(
        "the data determine the combination {} (in plausible standard deviations) less than the \
        plausible changes do",
        parts.join(" ")
    )
}

/// Lists the conditions that change a value most when they are left out: "without condition 10,
/// tail_wake changes by −0.4 plausible standard deviations".
pub fn pull_lines(findings: &PhysicsFindings) -> Vec<String> {
    let mut lines = Vec::new();
    for pull in findings.pulls().into_iter().take(LISTED_PULLS) {
        lines.push(format!(
            "without condition {}, {} changes by {} plausible standard deviations",
            pull.condition,
            parameter_name(findings, pull.parameter),
            signed(pull.change, 2)
        ));
    }
    lines
}
