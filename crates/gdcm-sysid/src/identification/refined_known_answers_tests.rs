//! Known answers for the refinement (M14.19 to M14.22): simulated flights, computed by independent
//! numpy code. Tolerances stand in the file.

use nalgebra::DMatrix;
use serde_json::Value;

use gdcm_model::dataset::StateSpace;
use gdcm_model::executor::Sequential;
use gdcm_model::progress::{Shares, Unobserved};
use gdcm_model::simulation::FlightRecord;

use crate::identification::known_answers_tests::{matrix, number, numbers, response};
use crate::identification::prepared_data::PreparedData;
use crate::likelihood::cost::{Likelihood, SpectralLines};
use crate::likelihood::dense_model::DenseModel;
use crate::likelihood::descent::{CONVERGED, DenseFit, Limits};
use crate::likelihood::linear_model::LinearModel;
use crate::likelihood::noise_covariance::NoiseCovariance;
use crate::likelihood::residual_noise::residual_noise;
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
            let value = ALPHABET.iter().position(|own| own == letter).unwrap();
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
    let preparation = Preparation::of(&texts(&known["inputs"]), &texts(&known["outputs"]));
    Options::new([band[0], band[1]], preparation)
}

/// Converts a model in file units to scaled units.
pub(super) fn scaled_start(known: &Value, data: &PreparedData) -> DenseModel {
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
    DenseModel::from_state_space(&StateSpace::new(a, b, c, d).unwrap()).unwrap()
}

pub(super) fn weighed<'a>(data: &PreparedData, noise: &NoiseCovariance) -> Likelihood<'a> {
    let lines = |spectrum| SpectralLines::new(spectrum, noise).unwrap();
    Likelihood::new(data.spectra.iter().map(lines).collect(), &Sequential)
}

fn step_case(known: &Value) {
    let records = flight_records(known);
    let options = options(known);
    let progress = Shares::new(&Unobserved);
    let data = PreparedData::new(&records, &options, &Sequential, &progress).unwrap();
    let step = &known["step"];
    let model = scaled_start(step, &data);
    println!(
        "lines {:?}",
        data.spectra
            .iter()
            .map(|s| (s.omega.len(), s.omega[0]))
            .collect::<Vec<_>>()
    );
    println!(
        "dof {} {}",
        data.likelihood.freedom(model.order()),
        step["dof"]
    );
    let fit = DenseFit::start(&data.likelihood, model).unwrap();
    println!("f lpm {} {}", fit.cost, step["f_lpm_noise"]);
    let noise = residual_noise(&data.likelihood, &fit.model, &fit.parts).unwrap();
    let expected = response(&step["noise_from_start"]);
    for (omega, expected) in [0.7, 1.5, 3.0, 6.0, 10.0].into_iter().zip(expected) {
        let mut found = noise.at(omega);
        for (o, scale) in data.scales.outputs.iter().enumerate() {
            found.row_mut(o).scale_mut(*scale);
            found.column_mut(o).scale_mut(*scale);
        }
        println!(
            "noise {omega}: {:.6} {:.6} | {:.6} {:.6}",
            found[(0, 0)],
            found[(0, 1)],
            expected[(0, 0)],
            expected[(0, 1)]
        );
    }
    let likelihood = weighed(&data, &noise);
    let fit = DenseFit::start(&likelihood, fit.model).unwrap();
    println!("f start {} {}", fit.cost, step["f_start"]);
    let started = std::time::Instant::now();
    let once = fit
        .clone()
        .descended(&likelihood, Limits::to(f64::INFINITY), &progress)
        .unwrap();
    println!(
        "decrement {} {}, {:?}",
        once.decrement,
        step["decrement_start_over_k_phi"],
        started.elapsed()
    );
    let fit = fit
        .descended(&likelihood, Limits::to(CONVERGED), &progress)
        .unwrap();
    println!(
        "minimum {} {}, decrement {}, {:?}",
        fit.cost,
        step["f_minimum"],
        fit.decrement,
        started.elapsed()
    );
}

#[test]
fn steps_whole() {
    let mut known = answers();
    let step = known["whole"]["step"].clone();
    known["gap"]["outputs_missing"] = Value::Array(Vec::new());
    known["gap"]["step"] = step;
    step_case(&known["gap"]);
}

#[test]
fn steps_helicopter() {
    step_case(&answers()["helicopter"]);
}

fn whole_case(known: &Value) {
    let records = flight_records(known);
    let options = options(known);
    let started = std::time::Instant::now();
    let found =
        crate::identification::identify::identify(&records, &options, &Sequential, &Unobserved)
            .unwrap();
    println!(
        "order {} {}, bic {:?}, cost {}, {:?}",
        found.refined.name,
        known["whole"]["order"],
        found.criteria,
        found.cost,
        started.elapsed()
    );
    println!(
        "F {:?} {}",
        found
            .contrasts
            .iter()
            .map(|c| c.contrast)
            .collect::<Vec<_>>(),
        known["whole"]["F"]
    );
    for caution in &found.cautions {
        println!(
            "  {}",
            format!("{caution:?}").chars().take(100).collect::<String>()
        );
    }
}

#[test]
fn whole_whole() {
    let mut known = answers();
    known["gap"]["outputs_missing"] = Value::Array(Vec::new());
    let whole = known["whole"]["whole"].clone();
    known["gap"]["whole"] = whole;
    whole_case(&known["gap"]);
}

#[test]
fn whole_helicopter() {
    whole_case(&answers()["helicopter"]);
}
