//! The part of `corrections.json` about couplings in the physics models, and about their
//! benefit (M16).
//!
//! Couplings are an input mixing, which depends on airspeed, and a feedback from outputs to
//! inputs, which does not; both are fitted to several conditions together. The benefit is mean
//! J without and with them, over the on-axis responses and over all others (`others`): under each
//! condition's own correction, under the schedule, and in each condition with everything fitted to
//! the other conditions (`left_out`).

use nalgebra::{DMatrix, Scalar};
use serde_json::{Value, json};

use gdcm_method::couplings::PoleShift;
use gdcm_study::results::correction_costs::{AxisCost, CorrectionCost};
use gdcm_study::results::coupling_remark_search::analysis_coupling_remarks;
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_study::{Analysis, ConditionAnalysis};
use gdcm_words::coupling_error::coupling_error_text;
use gdcm_words::coupling_remark::coupling_remark_text;

use crate::json_empty_members::without_empty;

/// Returns the study's feedback, in the dataset's units, with the benefit of the couplings; null
/// without couplings, and only the reason (`why`) if they are unavailable. The mixing, which
/// depends on airspeed, is in each condition.
pub(super) fn couplings(analysis: &Analysis) -> Value {
    let fitted = match &analysis.couplings {
        None => return Value::Null,
        Some(Err(error)) => {
            return json!({"why": coupling_error_text(error, &analysis.study.dataset)});
        }
        Some(Ok(fitted)) => fitted,
    };
    let assessment = analysis.coupling_assessment.as_deref();
    let feedback_sd = assessment
        .map(CouplingsAssessment::feedback)
        .map(|feedback| matrix_rows(&feedback.map(|entry| entry.deviation)));
    let costs = assessment.map(|assessment| &assessment.costs);
    let mut conditions = Vec::new();
    for condition in &fitted.problem.conditions {
        conditions.push(condition.id.0);
    }
    let mut words = Vec::new();
    for remark in analysis_coupling_remarks(analysis) {
        words.push(coupling_remark_text(&remark, &analysis.study.dataset));
    }
    let couplings = json!({
        "conditions": conditions,
        "feedback": matrix_rows(fitted.matrices().feedback()),
        "feedback_sd": feedback_sd,
        "residual": fitted.fit.residual,
        "uncorrected": costs.map(|costs| axis_cost(costs.uncorrected)),
        "own": costs.map(|costs| correction_cost(costs.own)),
        "scheduled": costs.map(|costs| correction_cost(costs.scheduled)),
        "left_out": costs.and_then(|costs| costs.left_out).map(correction_cost),
        "words": words,
    });
    without_empty(
        couplings,
        &[
            "feedback_sd",
            "uncorrected",
            "own",
            "scheduled",
            "left_out",
            "words",
        ],
    )
}

/// Returns a matrix as a list of rows, one per receiving input.
fn matrix_rows<T: Scalar + Into<Value>>(matrix: &DMatrix<T>) -> Value {
    let mut rows = Vec::with_capacity(matrix.nrows());
    for row in matrix.row_iter() {
        let entries: Vec<Value> = row.iter().cloned().map(Into::into).collect();
        rows.push(Value::Array(entries));
    }
    Value::Array(rows)
}

pub(super) fn axis_cost(cost: AxisCost) -> Value {
    json!({"on_axis": cost.on_axis, "others": cost.others})
}

pub(super) fn correction_cost(cost: CorrectionCost) -> Value {
    json!({
        "on_axis": cost.with.on_axis,
        "others": cost.with.others,
        "without_on_axis": cost.without.on_axis,
        "without_others": cost.without.others,
    })
}

/// Returns the mixing in a condition, normalised to ones on the diagonal, and how the couplings
/// affect the condition's physics representative; null without couplings.
pub(super) fn condition_couplings(analysis: &Analysis, result: &ConditionAnalysis) -> Value {
    let Some(coupled) = &result.coupled else {
        return Value::Null;
    };
    let airspeed_kt = result.condition.flight_state().airspeed_kt;
    let mixing = coupled.fitted.matrices().normalised_mixing(airspeed_kt);
    let assessment = analysis.coupling_assessment.as_deref();
    let mixing_sd = assessment
        .map(|assessment| assessment.mixing(airspeed_kt))
        .map(|mixing| matrix_rows(&mixing.map(|entry| entry.deviation)));
    let assessed =
        assessment.and_then(|assessment| assessment.conditions.get(&result.condition.id()));
    let poles_moved = assessed
        .and_then(|assessed| assessed.poles.as_ref().ok())
        .map(|shifts| shifts.iter().map(pole_shift).collect::<Value>());
    let couplings = json!({
        "mixing": matrix_rows(&mixing),
        "mixing_sd": mixing_sd,
        "poles_moved": poles_moved,
        "least_singular_value": assessed.and_then(|assessed| assessed.margin).map(|margin| {
            json!({"value": margin.least, "omega_rad_s": margin.omega_rad_s})
        }),
        "left_out": assessed.and_then(|assessed| assessed.left_out).map(correction_cost),
    });
    without_empty(
        couplings,
        &[
            "mixing_sd",
            "poles_moved",
            "least_singular_value",
            "left_out",
        ],
    )
}

fn pole_shift(shift: &PoleShift) -> Value {
    json!({
        "before_real_rad_s": shift.before.map(|before| before.re),
        "before_imaginary_rad_s": shift.before.map(|before| before.im),
        "after_real_rad_s": shift.after.re,
        "after_imaginary_rad_s": shift.after.im,
    })
}
