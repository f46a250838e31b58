//! Mixing and feedback (M16: `docs/couplings.md`).
//!
//! Couplings are two constant matrices around the physics model H: a mixing M of the inputs u and a
//! feedback K of the outputs y to the inputs, `y = H (M u + K y)`. They are fitted in five solves
//! with improving weights.

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
use crate::reference::MIXING;
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
    let own = [coupled.a(), coupled.b(), coupled.c(), coupled.d()];
    for (own, expected) in own.into_iter().zip(case.list("renovated")?) {
        let expected = expected.as_matrix()?;
        if own.shape() != expected.shape() {
            found.agree(false);
            continue;
        }
        for (own, expected) in own.iter().zip(expected.iter()) {
            found.deviation(own - expected);
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
    let omega: Arc<[f64]> = aircraft.numbers("omega_rad_s")?.into();
    let mut at_frequencies = Vec::new();
    for matrix in aircraft.list("sd")? {
        at_frequencies.push(matrix.as_matrix()?);
    }
    let on_axis = aircraft.list("on_axis")?;
    let outputs = on_axis.len();
    let inputs = at_frequencies.first().map_or(0, DMatrix::ncols);
    let deviation = PairTable::from_fn(outputs, inputs, |pair: Pair| {
        let mut curve = Vec::with_capacity(at_frequencies.len());
        for matrix in &at_frequencies {
            curve.push(matrix[(pair.output, pair.input)]);
        }
        curve
    });
    let mut marked = PairTable::filled(outputs, inputs, false);
    for (output, row) in on_axis.iter().enumerate() {
        for (input, mark) in row.elements()?.iter().enumerate() {
            marked[Pair::new(output, input)] = mark.as_flag()?;
        }
    }
    let physics = aircraft.list("H")?;
    let flight = aircraft.list("R_disturbed")?;
    let mut conditions = Vec::new();
    for (index, airspeed_kt) in aircraft.numbers("airspeeds_kt")?.into_iter().enumerate() {
        conditions.push(CouplingCondition {
            id: ConditionId(index as i64 + 1),
            airspeed_kt,
            physics: Arc::new(physics[index].as_response()?),
            flight: flight[index].as_response()?,
            usable: PairTable::filled(outputs, inputs, true),
            deviation: Some(deviation.clone()),
            coherence: None,
        });
    }
    let problem = CouplingProblem {
        kind: CouplingKind::MixingAndFeedback,
        on_axis: marked,
        conditions,
        omega,
        options: CouplingOptions::default(),
    };
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
