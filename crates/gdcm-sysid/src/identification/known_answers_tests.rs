//! Reference results for the tests of identification: synthetic systems, computed by independent
//! numpy code. Functions that read the files of results.

use nalgebra::{Complex, DMatrix};
use serde_json::Value;

use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::executor::Sequential;

use crate::likelihood::cost::Likelihood;
use crate::likelihood::spectral_lines::SpectralLines;
use crate::spectra::spectrum::Spectrum;

/// Reads the file of reference results.
pub(crate) fn answers() -> Value {
    serde_json::from_str(include_str!(
        "../../../../tests/data/identification-known-answers.json"
    ))
    .unwrap()
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

/// Reads a matrix that is written row by row.
pub(crate) fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = value.as_array().unwrap().iter().map(numbers).collect();
    DMatrix::from_fn(rows.len(), rows[0].len(), |row, column| rows[row][column])
}

/// Reads a complex matrix from its real and imaginary parts.
pub(crate) fn complex_matrix(value: &Value) -> DMatrix<Complex<f64>> {
    matrix(&value["re"]).zip_map(&matrix(&value["im"]), Complex::new)
}

/// Reads a complex matrix at each frequency.
pub(crate) fn response(value: &Value) -> Vec<DMatrix<Complex<f64>>> {
    let re = value["re"].as_array().unwrap().iter().map(matrix);
    let im = value["im"].as_array().unwrap().iter().map(matrix);
    re.zip(im)
        .map(|(re, im)| re.zip_map(&im, Complex::new))
        .collect()
}

/// Reads the lines of all records of a case, with noise of unit variance.
pub(crate) fn known_records(known: &Value) -> Likelihood<'static> {
    let mut segments = Vec::new();
    for (record, known) in known["records"].as_array().unwrap().iter().enumerate() {
        let spectrum = Spectrum {
            record,
            duration_s: number(&known["T"]),
            omega: numbers(&known["w"]),
            inputs: complex_matrix(&known["U"]).transpose(),
            outputs: complex_matrix(&known["Y"]).transpose(),
            hats: Vec::new(),
        };
        let weights = vec![DMatrix::identity(2, 2); spectrum.omega.len()];
        segments.push(SpectralLines::weighted(&spectrum, weights));
    }
    Likelihood::new(segments, &Sequential)
}

/// Evaluates the response of a model at a frequency \[rad/s\].
pub(crate) fn response_at(model: &StateSpace, omega: f64) -> DMatrix<Complex<f64>> {
    let response = gdcm_model::response::evaluate(model, &[omega]);
    DMatrix::from_fn(model.outputs(), model.inputs(), |output, input| {
        response.curve(Pair::new(output, input))[0]
    })
}
