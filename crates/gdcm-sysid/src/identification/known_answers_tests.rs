//! Known answers for the tests of this module: made-up systems, computed by independent numpy code.

use nalgebra::{Complex, DMatrix};
use serde_json::Value;

use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::executor::Sequential;

use super::*;
use crate::identification::spectrum::Spectrum;

/// The whole file.
pub(super) fn answers() -> Value {
    serde_json::from_str(include_str!(
        "../../../../tests/data/identification-known-answers.json"
    ))
    .unwrap()
}

/// A number.
pub(super) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// A list of numbers.
pub(super) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

/// A matrix, written row by row.
pub(super) fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = value.as_array().unwrap().iter().map(numbers).collect();
    DMatrix::from_fn(rows.len(), rows[0].len(), |row, column| rows[row][column])
}

/// A complex matrix, from one for its real and one for its imaginary part.
pub(super) fn complex_matrix(value: &Value) -> DMatrix<Complex<f64>> {
    matrix(&value["re"]).zip_map(&matrix(&value["im"]), Complex::new)
}

/// Complex matrices, one for each frequency.
pub(super) fn response(value: &Value) -> Vec<DMatrix<Complex<f64>>> {
    let part = |name: &str| {
        value[name]
            .as_array()
            .unwrap()
            .iter()
            .map(matrix)
            .collect::<Vec<_>>()
    };
    part("re")
        .iter()
        .zip(part("im"))
        .map(|(re, im)| re.zip_map(&im, Complex::new))
        .collect()
}

/// The lines of all records of a case, of noise one.
pub(super) fn known_records(known: &Value) -> Likelihood<'static> {
    let segments =
        known["records"]
            .as_array()
            .unwrap()
            .iter()
            .enumerate()
            .map(|(record, known)| {
                let spectrum = Spectrum {
                    record,
                    duration_s: number(&known["T"]),
                    omega: numbers(&known["w"]),
                    inputs: complex_matrix(&known["U"]).transpose(),
                    outputs: complex_matrix(&known["Y"]).transpose(),
                };
                let weights = vec![DMatrix::identity(2, 2); spectrum.omega.len()];
                SpectralLines::weighted(&spectrum, weights)
            });
    Likelihood {
        segments: segments.collect(),
        executor: &Sequential,
    }
}

/// The response of a model at a frequency.
pub(super) fn response_at(model: &StateSpace, omega: f64) -> DMatrix<Complex<f64>> {
    let response = gdcm_model::response::evaluate(model, &[omega]);
    DMatrix::from_fn(model.outputs(), model.inputs(), |output, input| {
        response.curve(Pair::new(output, input))[0]
    })
}
