//! Reference results for the refinement (M14.19 to M14.22): simulated flights, computed by
//! independent numpy code. Tolerances are in the file, unless a comment says otherwise.

use nalgebra::{Complex, DMatrix};
use serde_json::Value;

use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::{Shares, Unobserved};
use gdcm_model::simulation::FlightRecord;
use gdcm_model::statistics::median;

use crate::identification::identify::identify;
use crate::identification::known_answers_tests::{matrix, number, numbers, response, response_at};
use crate::identification::prepared_data::PreparedData;
use crate::likelihood::balancing::{Gramians, balancing_coordinates, without_last_states};
use crate::likelihood::cost::Likelihood;
use crate::likelihood::descent::{CONVERGED, Fit, Limits};
use crate::likelihood::noise_covariance::NoiseCovariance;
use crate::likelihood::residual_noise::residual_noise;
use crate::likelihood::schur_model::SchurModel;
use crate::likelihood::spectral_lines::SpectralLines;
use crate::options::Options;
use crate::spectra::preparation_settings::Preparation;

pub(super) fn answers() -> Value {
    serde_json::from_str(include_str!(
        "../../../../tests/data/identification-refined-known-answers.json"
    ))
    .unwrap()
}

/// Decodes base64 without line breaks.
fn decode(text: &str) -> Vec<u8> {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut bytes = Vec::new();
    for group in text.trim_end_matches('=').as_bytes().chunks(4) {
        let mut bits = 0_u32;
        for letter in group {
            let value = ALPHABET.iter().position(|known| known == letter).unwrap();
            bits = (bits << 6) | value as u32;
        }
        bits <<= 6 * (4 - group.len());
        bytes.extend(&bits.to_be_bytes()[1..group.len()]);
    }
    bytes
}

fn texts(value: &Value) -> Vec<&str> {
    let texts = value.as_array().unwrap().iter();
    texts.map(|text| text.as_str().unwrap()).collect()
}

/// Reads the records of a case, with missing samples as NaN.
pub(super) fn flight_records(known: &Value) -> Vec<FlightRecord> {
    let inputs = texts(&known["inputs"]).len();
    let outputs = texts(&known["outputs"]).len();
    let dt = number(&known["dt"]);
    let missing: Option<[f64; 2]> = known["outputs_missing"]
        .as_array()
        .and_then(|ends| Some([ends.first()?.as_f64()?, ends.get(1)?.as_f64()?]));
    let mut records = Vec::new();
    for record in known["records"].as_array().unwrap() {
        let bytes = decode(record["data"].as_str().unwrap());
        let integers: Vec<f64> = bytes
            .chunks_exact(2)
            .map(|pair| f64::from(i16::from_le_bytes([pair[0], pair[1]])))
            .collect();
        let offset = numbers(&record["offset"]);
        let scale = numbers(&record["scale"]);
        let samples = number(&record["samples"]) as usize;
        let value = |n: usize, channel: usize| {
            offset[channel] + scale[channel] * integers[n * (inputs + outputs) + channel]
        };
        let mut record = FlightRecord {
            name: record["name"].as_str().unwrap().to_owned(),
            time_s: (0..samples).map(|n| n as f64 * dt).collect(),
            inputs: DMatrix::from_fn(samples, inputs, value),
            outputs: DMatrix::from_fn(samples, outputs, |n, o| value(n, inputs + o)),
        };
        if let Some([first, end]) = missing {
            for n in first as usize..end as usize {
                record.outputs.row_mut(n).fill(f64::NAN);
            }
        }
        records.push(record);
    }
    records
}

pub(super) fn options(known: &Value) -> Options {
    let band = numbers(&known["band"]);
    let preparation = Preparation::new(&texts(&known["inputs"]), &texts(&known["outputs"]));
    Options::new([band[0], band[1]], preparation)
}

/// Converts a model in file units to scaled units.
pub(super) fn scaled_start(known: &Value, data: &PreparedData) -> SchurModel {
    let start = &known["start"];
    let [a, mut b, mut c, mut d] = ["A", "B", "C", "D"].map(|name| matrix(&start[name]));
    for (input, scale) in data.scales.inputs.iter().enumerate() {
        b.column_mut(input).scale_mut(*scale);
        d.column_mut(input).scale_mut(*scale);
    }
    for (output, scale) in data.scales.outputs.iter().enumerate() {
        c.row_mut(output).unscale_mut(*scale);
        d.row_mut(output).unscale_mut(*scale);
    }
    SchurModel::from_state_space(&StateSpace::new(a, b, c, d).unwrap()).unwrap()
}

/// Weights the lines by a noise covariance.
pub(super) fn weighed<'a>(data: &PreparedData, noise: &NoiseCovariance) -> Likelihood<'a> {
    let lines = |spectrum| SpectralLines::new(spectrum, noise).unwrap();
    Likelihood::new(data.spectra.iter().map(lines).collect(), &Sequential)
}

/// Compares covariance matrices; the tolerance is relative to the standard deviations of row and
/// column.
fn assert_covariance(
    found: &DMatrix<Complex<f64>>,
    expected: &DMatrix<Complex<f64>>,
    tolerance: f64,
) {
    for row in 0..expected.nrows() {
        for column in 0..expected.ncols() {
            let scale = (expected[(row, row)].re * expected[(column, column)].re).sqrt();
            let difference = (found[(row, column)] - expected[(row, column)]).norm();
            assert!(
                difference < tolerance * scale,
                "({row}, {column}): {}, expected {}",
                found[(row, column)],
                expected[(row, column)]
            );
        }
    }
}

/// Compares cost, noise, decrement and minimum from the start of a case. All figures are from
/// independent numpy code; the file states the tolerances.
fn assert_steps(known: &Value) {
    let records = flight_records(known);
    let options = options(known);
    let progress = Shares::new(&Unobserved);
    let data = PreparedData::new(&records, &options, &Sequential, &progress).unwrap();
    let step = &known["step"];
    let tolerance = &step["tolerance"];
    let model = scaled_start(step, &data);
    assert_eq!(
        data.likelihood.freedom(model.order()) as u64,
        step["dof"].as_u64().unwrap()
    );
    let relative = number(&tolerance["f_relative"]);
    let fit = Fit::start(&data.likelihood, model).unwrap();
    assert_relative(fit.cost, number(&step["f_lpm_noise"]), relative);
    let noise = residual_noise(&data.likelihood, &fit.model, &fit.parts).unwrap();
    let expected = response(&step["noise_from_start"]);
    for (omega, expected) in [0.7, 1.5, 3.0, 6.0, 10.0].into_iter().zip(expected) {
        let mut found = noise.at(omega);
        for (o, scale) in data.scales.outputs.iter().enumerate() {
            found.row_mut(o).scale_mut(*scale);
            found.column_mut(o).scale_mut(*scale);
        }
        assert_covariance(&found, &expected, number(&tolerance["noise_relative"]));
    }
    let likelihood = weighed(&data, &noise);
    let fit = Fit::start(&likelihood, fit.model).unwrap();
    assert_relative(fit.cost, number(&step["f_start"]), relative);
    // The reference approximates the normal equations (it sums V^H V over bins of 0.04, but the
    // transients over lines), so that its decrement is up to 5 % below that of the exact normal
    // equations. The 2 % in the file are for these bins.
    let decrement = fit.decrement(&likelihood).unwrap();
    assert_relative(decrement, number(&step["decrement_start_over_k_phi"]), 0.06);
    let fit = fit
        .descended(&likelihood, Limits::to(CONVERGED), &progress)
        .unwrap();
    // Another minimum is allowed if it is not higher.
    let minimum = number(&step["f_minimum"]);
    assert!(
        fit.cost < minimum * (1.0 + 1e-3),
        "{}, expected {minimum}",
        fit.cost
    );
    // Balanced truncation by two states.
    let reduced = without_last_states(&balanced(&likelihood, &fit.model), 2);
    let least = reduced
        .iter()
        .filter_map(|model| likelihood.cost(model))
        .fold(f64::INFINITY, f64::min);
    let truncated = number(&step["f_truncated_by_2"]);
    assert!(
        least < truncated * (1.0 + 1e-3),
        "{least}, expected {truncated}"
    );
}

/// Returns a model in balanced coordinates.
fn balanced(likelihood: &Likelihood, model: &SchurModel) -> SchurModel {
    let coordinates = balancing_coordinates(&Gramians::sampled(likelihood, model)).unwrap();
    model
        .in_coordinates(&coordinates.transformation, &coordinates.inverse)
        .unwrap()
}

fn assert_relative(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() < tolerance,
        "{found}, expected {expected}"
    );
}

/// Returns the case with a gap, with the samples of the gap and the results for whole records.
fn case_without_gap() -> Value {
    let mut answers = answers();
    let mut known = answers["gap"].take();
    known["outputs_missing"] = Value::Null;
    known["step"] = answers["whole"]["step"].take();
    known["whole"] = answers["whole"]["whole"].take();
    known
}

#[test]
fn refinement_steps_for_two_inputs_and_outputs_match_independent_code() {
    assert_steps(&case_without_gap());
}

#[test]
fn refinement_steps_for_a_helicopter_match_independent_code() {
    assert_steps(&answers()["helicopter"]);
}

/// Identifies the records of a case, and compares the order, the responses and their standard
/// deviations.
fn assert_identified(known: &Value) {
    let found = identify(
        &flight_records(known),
        &options(known),
        &Sequential,
        &Unobserved,
    )
    .unwrap();
    let expected = &known["whole"];
    let range = numbers(&expected["order_range"]);
    let model = found.refined.state_space().unwrap();
    let order = model.a().nrows() as f64;
    assert!(range[0] <= order && order <= range[1], "order {order}");
    let bands = found.refined.bands.as_ref().unwrap();
    let omegas = numbers(&known["truth"]["w"]);
    let truth = response(&known["truth"]["H"]);
    let reference = response(&expected["H"]);
    let tolerance = number(&expected["H_tolerance_in_sd"]);
    // Differences from the reference in its standard deviations, and logarithms of the ratios of
    // the standard deviations.
    let mut deviations = Vec::new();
    let mut ratios = Vec::new();
    let mut within_truth = 0;
    let mut count = 0;
    for (k, omega) in omegas.into_iter().enumerate() {
        let response = response_at(model, omega);
        let sd_db = matrix(&expected["sd_db"][k]);
        for output in 0..response.nrows() {
            for input in 0..response.ncols() {
                let pair = (output, input);
                let own_sd_db =
                    at_frequency(bands.omega(), &bands.sd_db()[Pair { output, input }], omega);
                let db =
                    |other: Complex<f64>| 20.0 * (response[pair].norm() / other.norm()).log10();
                deviations.push(db(reference[k][pair]).abs() / sd_db[pair]);
                ratios.push((own_sd_db / sd_db[pair]).ln());
                count += 1;
                if db(truth[k][pair]).abs() < 3.0 * own_sd_db {
                    within_truth += 1;
                }
            }
        }
    }
    assert!(
        20 * within_truth >= 19 * count,
        "{within_truth} of {count} responses are within three standard deviations of the truth"
    );
    // The median: at another minimum or order, single responses differ by more than the tolerance
    // in the file.
    assert!(median(&mut deviations) < tolerance, "{deviations:?}");
    // The standard deviations include the differences from models of neighbouring orders, which may
    // be other orders than those of the independent code.
    assert!(median(&mut ratios).abs() < 0.25, "{ratios:?}");
    let codes: Vec<&str> = found
        .cautions
        .iter()
        .map(|caution| caution.note().code)
        .collect();
    assert!(
        !codes.contains(&"time-skew") && !codes.contains(&"record"),
        "{codes:?}"
    );
    for contrast in &found.contrasts {
        assert!(contrast.contrast < 2.0, "{:?}", found.contrasts);
    }
}

/// Interpolates linearly in frequency.
fn at_frequency(omegas: &[f64], values: &[f64], omega: f64) -> f64 {
    let above = omegas.partition_point(|other| *other < omega);
    let share = (omega - omegas[above - 1]) / (omegas[above] - omegas[above - 1]);
    values[above - 1] + share * (values[above] - values[above - 1])
}

#[test]
fn records_of_two_inputs_and_outputs_are_identified_as_by_independent_code() {
    assert_identified(&case_without_gap());
}

#[test]
fn records_of_a_helicopter_are_identified_as_by_independent_code() {
    assert_identified(&answers()["helicopter"]);
}
