//! Identification from generated records with a known truth (M14).

use nalgebra::{DMatrix, DVector, dmatrix};

use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::evaluate;
use gdcm_model::simulation::{FirstOrderHold, FlightRecord};
use gdcm_sysid::identification::identify::identify;
use gdcm_sysid::identification::{Options, Preparation};

use crate::check::{CheckFault, Found};
use crate::reference_study::ReferenceStudy;

const SAMPLE_TIME_S: f64 = 0.02;
/// Samples per record: 40 s.
const SAMPLES: usize = 2000;
const RECORDS: usize = 3;
/// Sine waves per input.
const LINES: usize = 40;

/// The true system: a Dutch roll near 2.1 rad/s, coupled to a well-damped pair of modes near 1.3
/// rad/s.
fn truth() -> Result<StateSpace, CheckFault> {
    StateSpace::new(
        dmatrix![
            -0.4, 2.1, 0.0, 0.0;
            -2.1, -0.4, 0.0, 0.3;
            0.0, 0.0, -1.5, 0.8;
            0.2, 0.0, -1.1, -0.6],
        dmatrix![1.0, 0.2; 0.0, 0.6; 0.5, -1.0; -0.3, 0.8],
        dmatrix![0.6, 1.0, 0.3, 0.0; 0.2, 0.5, -0.8, 1.0],
        DMatrix::zeros(2, 2),
    )
    .map_err(CheckFault::no_result)
}

/// Generates a record from sums of sine waves; each input is large in some records and small in the
/// others. Between samples the inputs are straight lines, as the simulation takes them.
fn record(truth: &StateSpace, number: usize) -> Result<FlightRecord, CheckFault> {
    let mut inputs = DMatrix::zeros(SAMPLES, 2);
    let mut time_s = Vec::with_capacity(SAMPLES);
    for sample in 0..SAMPLES {
        let t = sample as f64 * SAMPLE_TIME_S;
        time_s.push(t);
        for input in 0..2 {
            let size = if input == number % 2 { 0.3 } else { 0.09 };
            let mut sum = 0.0;
            for line in 0..LINES {
                // Each input and record has frequencies of its own.
                let omega = 0.25 + 0.2 * line as f64 + 0.01 * (input + 2 * number) as f64;
                // Phases by the golden ratio are spread evenly and need no random numbers.
                let turns = 0.618_033_988_75 * (line * line + 7 * input + 13 * number) as f64;
                sum += (omega * t + std::f64::consts::TAU * turns).sin() / (1.0 + 0.2 * omega);
            }
            inputs[(sample, input)] = size * sum;
        }
    }
    let Some(hold) = FirstOrderHold::new(truth, SAMPLE_TIME_S) else {
        return Err(CheckFault::no_result("the system cannot be simulated"));
    };
    let outputs = hold.simulate(&DVector::zeros(truth.order()), &inputs);
    Ok(FlightRecord {
        name: format!("generated {}", number + 1),
        time_s,
        inputs,
        outputs,
    })
}

/// Compares the refined model's response with the true system's.
pub(super) fn known_model(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let truth = truth()?;
    let mut records = Vec::with_capacity(RECORDS);
    for number in 0..RECORDS {
        records.push(record(&truth, number)?);
    }
    // A short search: the true order and two above, and a single Laguerre pole and past window.
    let options = Options {
        orders: Some(vec![4, 6, 8]),
        poles: vec![0.54],
        pasts: Some(vec![6]),
        ..Options::new([0.6, 6.0], Preparation::new(&["LON", "LAT"], &["P", "Q"]))
    };
    let identified =
        identify(&records, &options, &Sequential, &Unobserved).map_err(CheckFault::no_result)?;
    let Some(model) = identified.refined.state_space() else {
        return Err(CheckFault::no_result("the model has no matrices"));
    };
    let omega = [0.6, 0.8, 1.0, 1.4, 2.0, 2.1, 2.5, 3.0, 4.0, 5.0, 6.0];
    let own = evaluate(model, &omega);
    let expected = evaluate(&truth, &omega);
    let mut found = Found {
        instances: RECORDS,
        ..Found::default()
    };
    for index in 0..omega.len() {
        let mut largest = 0.0_f64;
        let mut errors = Vec::new();
        for output in 0..2 {
            for input in 0..2 {
                let pair = Pair::new(output, input);
                let value = expected.curve(pair)[index];
                largest = largest.max(value.norm());
                errors.push((own.curve(pair)[index] - value).norm());
            }
        }
        for error in errors {
            found.deviation(error / largest);
        }
    }
    Ok(found)
}
