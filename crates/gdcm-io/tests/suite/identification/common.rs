//! Reference values for M14, computed by independent numpy code, in
//! `tests/data/identification-known-answers.json`, and small synthetic systems.

use std::sync::Mutex;

use nalgebra::{Complex, DMatrix};
use serde_json::Value;

use gdcm_model::dataset::{Model, Pair, StateSpace};
use gdcm_model::executor::{Executor, Sequential, Task};
use gdcm_model::response::evaluate;
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::simulation::Segment;
use gdcm_sysid::identification::ResponseEstimate;
use gdcm_sysid::spectra::local_polynomial::local_polynomial;
use gdcm_sysid::spectra::scales::Scales;
use gdcm_sysid::spectra::spectrum::{Spectrum, spectra};

/// Highest spectral line \[rad/s\] of a measured response in the band from 0.6 to 6 rad/s: the
/// likelihood uses lines up to 4/3 of the upper end, and the windows of the local polynomials
/// extend to 1.3 times the highest of them.
pub const HIGHEST_LINE: f64 = 10.4;

/// Executor with a fixed number of threads; the last task is started first.
pub struct Threads(pub usize);

impl Executor for Threads {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        let remaining = Mutex::new(tasks);
        let next_task = || remaining.lock().expect("no thread panicked").pop();
        std::thread::scope(|scope| {
            for _ in 0..self.0 {
                scope.spawn(|| {
                    while let Some(task) = next_task() {
                        task();
                    }
                });
            }
        });
    }
}

/// Returns the reference values of all cases.
pub fn known_answers() -> Value {
    serde_json::from_str(include_str!(
        "../../../../../tests/data/identification-known-answers.json"
    ))
    .expect("the file of known answers is valid JSON")
}

/// Returns a list of numbers; null becomes NaN.
pub fn list(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .expect("a list")
        .iter()
        .map(|x| x.as_f64().unwrap_or(f64::NAN))
        .collect()
}

/// Returns a matrix from a list of rows.
pub fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = value
        .as_array()
        .expect("a list of rows")
        .iter()
        .map(list)
        .collect();
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

/// Returns a complex matrix from its real and imaginary parts.
pub fn complex(value: &Value) -> DMatrix<Complex<f64>> {
    matrix(&value["re"]).zip_map(&matrix(&value["im"]), Complex::new)
}

/// Returns the first `count` records of the case `noisy` as segments.
pub fn noisy_segments(known: &Value, count: usize) -> Vec<Segment> {
    let records = known["noisy"]["records"].as_array().expect("records");
    let mut segments = Vec::new();
    for (record, value) in records.iter().take(count).enumerate() {
        segments.push(Segment {
            record,
            start_s: 0.0,
            sample_time_s: value["dt"].as_f64().expect("a sample time"),
            inputs: matrix(&value["u"]),
            outputs: matrix(&value["y"]),
        });
    }
    segments
}

/// Returns the spectra of the records of the case `noisy` used for identification, in scaled units,
/// up to [`HIGHEST_LINE`].
pub fn noisy_spectra() -> Vec<Spectrum> {
    let segments = noisy_segments(&known_answers(), 4);
    let scales = Scales::from_segments(&segments).expect("all channels vary");
    let scaled: Vec<_> = segments
        .iter()
        .map(|segment| scales.scaled(segment))
        .collect();
    spectra(&scaled, 1.3 * 4.0 / 3.0 * 6.0, &Sequential)
}

/// Returns the measured response of the case `noisy` in scaled units.
pub fn noisy_response() -> ResponseEstimate {
    local_polynomial(&noisy_spectra(), &log_spaced(0.3, 8.0, 40), &Sequential)
        .expect("the records are long enough")
}

/// Returns the response of a model at a frequency \[rad/s\].
pub fn response(model: &StateSpace, omega: f64) -> DMatrix<Complex<f64>> {
    let response = evaluate(model, &[omega]);
    DMatrix::from_fn(model.outputs(), model.inputs(), |output, input| {
        response.curve(Pair::new(output, input))[0]
    })
}

/// Returns the matrices of a model.
pub fn state_space(model: &Model) -> &StateSpace {
    model.state_space().expect("the model has matrices")
}

/// Returns the synthetic system of the case `drop_fast` without its fast mode.
pub fn slow_system() -> StateSpace {
    let known = known_answers();
    let [a, b, c, d] = ["A", "B", "C", "D"].map(|key| matrix(&known["drop_fast"][key]));
    StateSpace::new(
        a.view((0, 0), (4, 4)).into(),
        b.rows(0, 4).into(),
        c.columns(0, 4).into(),
        d,
    )
    .expect("the shapes of the matrices agree")
}

/// Returns pseudo-random numbers, uniform between -1 and 1 (xorshift); reproducible for a given
/// seed.
pub fn noise(seed: u64, count: usize) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(1);
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| next()).collect()
}
