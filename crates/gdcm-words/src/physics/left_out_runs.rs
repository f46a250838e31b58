//! Reasons why runs and conditions take no part in the fit of physics parameters (M18.1).
//!
//! A *run* is a physics model linearised with one parameter changed by a *step*; its *base* is the
//! physics model at the same trim with the parameter nominal.

use gdcm_method::physics::RunRefusal;
use gdcm_model::units::number;
use gdcm_study::results::physics_findings::{LeftOutData, NotFitted};

/// Lists the runs and conditions that take no part in the fit, with the reasons.
pub fn left_out_lines(left_out: &LeftOutData) -> Vec<String> {
    let mut lines = Vec::new();
    for omitted in &left_out.conditions {
        lines.push(format!(
            "condition {} is left out of the fit: {}",
            omitted.condition,
            not_fitted_text(&omitted.why)
        ));
    }
    for refused in &left_out.runs {
        lines.push(format!(
            "condition {}, run \"{}\" of {} is not used: {}",
            refused.condition,
            refused.run.model,
            refused.run.parameter,
            refusal_text(&refused.run.reason)
        ));
    }
    lines
}

fn not_fitted_text(why: &NotFitted) -> String {
    match why {
        NotFitted::HeldOut => "it is held out".to_owned(),
        NotFitted::NotCompared { code } => {
            format!("its models cannot be compared (error {code})")
        }
        NotFitted::Runs(omission) => omission.to_string(),
    }
}

/// Says why a run is not used.
fn refusal_text(refusal: &RunRefusal) -> String {
    match refusal {
        RunRefusal::NoBase => {
            "no physics model of the condition has its perturbation; add the model at that trim \
            with the parameter nominal"
                .to_owned()
        }
        RunRefusal::BaseNotUsed { base } => format!(
            "its base \"{base}\" is rejected or set aside; restore it, or supply runs at another \
            trim"
        ),
        RunRefusal::NoMatrices => {
            "the run or its base is a measured response; matrices are needed".to_owned()
        }
        RunRefusal::Shape {
            base,
            expected,
            found,
        } => format!(
            "expected {} states, {} inputs and {} outputs as in \"{base}\", found {}, {} and {}",
            expected[0], expected[1], expected[2], found[0], found[1], found[2]
        ),
        RunRefusal::States {
            base,
            position,
            expected,
            found,
        } => format!(
            "state {position}: expected {expected} as in \"{base}\", found {found}; give both the \
            same states in the same order"
        ),
        RunRefusal::Timing { base } => {
            format!(
                "its sample time or delays differ from those of \"{base}\"; use the same for both"
            )
        }
        RunRefusal::Unit { expected, found } => {
            format!("unit of the step: expected {expected}, found {found}")
        }
        RunRefusal::Step { delta } => format!(
            "expected a finite step other than 0, found {}",
            number(*delta)
        ),
        RunRefusal::NoChange { base } => {
            format!("it has the matrices of its base \"{base}\": the parameter was not changed")
        }
        RunRefusal::StepRepeated { other, delta } => {
            format!(
                "\"{other}\" has the same step {}; use different steps",
                number(*delta)
            )
        }
        RunRefusal::MatricesRepeated { other } => {
            format!("\"{other}\" has the same matrices at another step; correct one of them")
        }
        RunRefusal::TooMany => {
            "at most two runs of a parameter are used, and two others already are; remove one"
                .to_owned()
        }
    }
}
