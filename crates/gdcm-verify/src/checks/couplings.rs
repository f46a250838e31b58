//! Mixing and feedback (M16: `docs/couplings.md`).
//!
//! Couplings are two constant matrices around the physics model H: a mixing M of the inputs u and a
//! feedback K of the outputs y to the inputs, `y = H (M u + K y)`. They are fitted in five solves
//! with improving weights.
//!
//! In the reference, `renovated` is H with M and K as matrices A to D, and `toy` a synthetic
//! aircraft at several airspeeds: its physics `H`, its flight responses `R_disturbed` with errors,
//! the standard deviations `sd` of `ln R` at each frequency, and the marks `on_axis`.

use std::sync::Arc;

use nalgebra::DMatrix;

use gdcm_method::correction::Pade;
use gdcm_method::couplings::problem::CouplingOptions;
use gdcm_method::couplings::{
    CouplingCondition, CouplingKind, CouplingMatrices, CouplingProblem, Unknown, fit_couplings,
};
use gdcm_method::schedule::Airspeeds;
use gdcm_model::dataset::{ConditionId, Pair, PairTable, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;

use crate::check::{CheckFault, Found};
use crate::reference::{MIXING, Reference};
use crate::reference_study::ReferenceStudy;

/// Airspeed at which constant couplings are evaluated \[kt\].
const AIRSPEED_KT: f64 = 60.0;

/// Compares a coupled model's state-space matrices with the reference.
pub(super) fn coupled_state_space(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let case = MIXING.read()?.member("state_space")?;
    let physics = StateSpace::new(
        case.matrix("A")?,
        case.matrix("B")?,
        case.matrix("C")?,
        case.matrix("D")?,
    )
    .map_err(CheckFault::no_result)?;
    let couplings = constant_couplings(&case.matrix("M")?, &case.matrix("K")?)?;
    // The model has no delays: the approximant's order does not matter.
    let Some(pade) = Pade::new(4) else {
        return Err(CheckFault::no_result("no approximant of order 4"));
    };
    let coupled = couplings
        .model(&physics, AIRSPEED_KT, pade)
        .map_err(CheckFault::no_result)?;
    let mut found = Found::default();
    found.instance();
    let matrices = [coupled.a(), coupled.b(), coupled.c(), coupled.d()];
    for (matrix, expected) in matrices.into_iter().zip(case.list("renovated")?) {
        let expected = expected.as_matrix()?;
        if matrix.shape() != expected.shape() {
            found.agree(false);
            continue;
        }
        for (entry, expected_entry) in matrix.iter().zip(expected.iter()) {
            found.deviation(entry - expected_entry);
        }
    }
    Ok(found)
}

/// Returns couplings that do not depend on airspeed.
fn constant_couplings(
    mixing: &DMatrix<f64>,
    feedback: &DMatrix<f64>,
) -> Result<CouplingMatrices, CheckFault> {
    let (inputs, outputs) = feedback.shape();
    let mut unknowns = Vec::new();
    let mut values = Vec::new();
    for to in 0..inputs {
        for from in 0..inputs {
            unknowns.push(Unknown::Mixing { to, from, power: 0 });
            values.push(mixing[(to, from)]);
        }
        for output in 0..outputs {
            unknowns.push(Unknown::Feedback { input: to, output });
            values.push(feedback[(to, output)]);
        }
    }
    match Airspeeds::new(vec![AIRSPEED_KT], 2.0) {
        Some(airspeeds) => {
            Ok(CouplingMatrices::none(airspeeds, inputs, outputs).with(&unknowns, &values))
        }
        None => Err(CheckFault::no_result("no airspeed")),
    }
}

/// Compares the synthetic aircraft's coupling coefficients after each solve with the reference.
pub(super) fn disturbed_aircraft(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let aircraft = MIXING.read()?.member("toy")?;
    let problem = coupling_problem(&aircraft)?;
    let fit = fit_couplings(&problem, &Sequential, &Unobserved).map_err(CheckFault::no_result)?;
    let solves = aircraft
        .member("disturbed")?
        .list("coefficients_of_each_solve")?;
    let mut found = Found::default();
    found.agree(fit.coefficients.len() == solves.len());
    for (own, expected) in fit.coefficients.iter().zip(solves) {
        found.instance();
        found.all_scaled(own, &expected.as_numbers()?, 1.0);
    }
    Ok(found)
}

/// Reads the fit of mixing and feedback to the disturbed flight responses; each airspeed is a
/// condition.
fn coupling_problem(aircraft: &Reference) -> Result<CouplingProblem, CheckFault> {
    let on_axis = on_axis_marks(aircraft)?;
    let deviation = standard_deviations(aircraft)?;
    let usable = PairTable::filled(on_axis.outputs(), on_axis.inputs(), true);
    let physics = aircraft.list("H")?;
    let flight = aircraft.list("R_disturbed")?;
    let mut conditions = Vec::new();
    for (index, airspeed_kt) in aircraft.numbers("airspeeds_kt")?.into_iter().enumerate() {
        conditions.push(CouplingCondition {
            id: ConditionId(index as i64 + 1),
            airspeed_kt,
            physics: Arc::new(physics[index].as_response()?),
            flight: flight[index].as_response()?,
            usable: usable.clone(),
            deviation: Some(deviation.clone()),
            coherence: None,
        });
    }
    Ok(CouplingProblem {
        kind: CouplingKind::MixingAndFeedback,
        on_axis,
        conditions,
        omega: aircraft.numbers("omega_rad_s")?.into(),
        options: CouplingOptions::default(),
    })
}

/// Reads the standard deviation of `ln R` over frequency for each response.
fn standard_deviations(aircraft: &Reference) -> Result<PairTable<Vec<f64>>, CheckFault> {
    let mut at_frequencies: Vec<DMatrix<f64>> = Vec::new();
    for matrix in aircraft.list("sd")? {
        at_frequencies.push(matrix.as_matrix()?);
    }
    let (outputs, inputs) = at_frequencies.first().map_or((0, 0), DMatrix::shape);
    Ok(PairTable::from_fn(outputs, inputs, |pair: Pair| {
        let mut curve = Vec::with_capacity(at_frequencies.len());
        for matrix in &at_frequencies {
            curve.push(matrix[(pair.output, pair.input)]);
        }
        curve
    }))
}

/// Reads which responses are on-axis.
fn on_axis_marks(aircraft: &Reference) -> Result<PairTable<bool>, CheckFault> {
    let rows = aircraft.list("on_axis")?;
    let inputs = match rows.first() {
        Some(row) => row.elements()?.len(),
        None => 0,
    };
    let mut on_axis = PairTable::filled(rows.len(), inputs, false);
    for (output, row) in rows.iter().enumerate() {
        for (input, mark) in row.elements()?.iter().enumerate() {
            on_axis[Pair::new(output, input)] = mark.as_flag()?;
        }
    }
    Ok(on_axis)
}
