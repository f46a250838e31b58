//! The text of `corrections.json` that says which couplings the physics models have, and what these are worth (M16).

use serde_json::{Value, json};

use gdcm_core::dataset::Pair;
use gdcm_core::study::{Analysis, AxisCost, ConditionAnalysis, CouplingCost, CouplingsAssessment};

use super::corrections::{rows_of, without_empty};

/// Mixing and feedback of the study, in the dataset's units; null without couplings.
pub(super) fn couplings(analysis: &Analysis) -> Value {
    let fitted = match &analysis.couplings {
        None => return Value::Null,
        Some(Err(error)) => return json!({"why": error.words(&analysis.study.dataset.names_of_channels().0)}),
        Some(Ok(fitted)) => fitted,
    };
    let feedback = fitted.matrices().feedback();
    let (inputs, outputs) = feedback.shape();
    let assessment = analysis.coupling_assessment.as_deref();
    let deviations = assessment.map(CouplingsAssessment::feedback);
    // Rows are of the input that receives.
    let rows = |entry: &dyn Fn(usize, usize) -> Value| rows_of(inputs, outputs, |at: Pair| entry(at.output, at.input));
    let costs = assessment.map(|assessment| &assessment.costs);
    let found = json!({
        "conditions": fitted.problem.conditions.iter().map(|of| of.id.0).collect::<Value>(),
        "feedback": rows(&|input, output| feedback[(input, output)].into()),
        "feedback_sd": deviations.map(|of| rows(&|input, output| of[(input, output)].deviation.into())),
        "residual": fitted.fit.residual,
        "uncorrected": costs.map(|costs| axis_cost(costs.uncorrected)),
        "own": costs.map(|costs| coupling_cost(costs.own)),
        "scheduled": costs.map(|costs| coupling_cost(costs.scheduled)),
        "left_out": costs.and_then(|costs| costs.left_out).map(coupling_cost),
        "words": analysis.coupling_remarks().into_iter().map(|remark| remark.text).collect::<Value>(),
    });
    without_empty(found, &["feedback_sd", "uncorrected", "own", "scheduled", "left_out", "words"])
}

fn axis_cost(of: AxisCost) -> Value {
    json!({"on_axis": of.on_axis, "others": of.others})
}

fn coupling_cost(of: CouplingCost) -> Value {
    json!({
        "on_axis": of.with.on_axis,
        "others": of.with.others,
        "without_on_axis": of.without.on_axis,
        "without_others": of.without.others,
    })
}

/// The mixing of a condition, ones on its diagonal, and what the couplings do to its physics representative; null without couplings.
pub(super) fn condition_couplings(analysis: &Analysis, result: &ConditionAnalysis) -> Value {
    let Some(coupled) = &result.coupled else { return Value::Null };
    let airspeed_kt = result.condition.flight_state().airspeed_kt;
    let mixing = coupled.fitted.matrices().normalised_mixing(airspeed_kt);
    let assessment = analysis.coupling_assessment.as_deref();
    let deviations = assessment.map(|assessment| assessment.mixing(airspeed_kt));
    let of = assessment.and_then(|assessment| assessment.conditions.get(&result.condition.id()));
    let rows = |entry: &dyn Fn(usize, usize) -> Value| {
        rows_of(mixing.nrows(), mixing.ncols(), |at: Pair| entry(at.output, at.input))
    };
    let poles = of.and_then(|of| of.poles.as_ref().ok()).map(|shifts| {
        let pole = |shift: &gdcm_core::couplings::PoleShift| {
            json!({
                "before_real_rad_s": shift.before.map(|before| before.re),
                "before_imaginary_rad_s": shift.before.map(|before| before.im),
                "after_real_rad_s": shift.after.re,
                "after_imaginary_rad_s": shift.after.im,
            })
        };
        shifts.iter().map(pole).collect::<Value>()
    });
    let found = json!({
        "mixing": rows(&|to, from| mixing[(to, from)].into()),
        "mixing_sd": deviations.map(|of| rows(&|to, from| of[(to, from)].deviation.into())),
        "poles_moved": poles,
        "least_singular_value": of.and_then(|of| of.margin).map(|margin| {
            json!({"value": margin.least, "omega_rad_s": margin.omega_rad_s})
        }),
        "left_out": of.and_then(|of| of.left_out).map(coupling_cost),
    });
    without_empty(found, &["mixing_sd", "poles_moved", "least_singular_value", "left_out"])
}
