//! Reference values for M14 (source: independent numpy code), and small synthetic systems.

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

/// Executor with a fixed number of threads, which starts with the last task.
pub struct Threads(pub usize);

impl Executor for Threads {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        let left = Mutex::new(tasks);
        let next = || left.lock().expect("no piece of work holds the lock").pop();
        let work = || {
            while let Some(task) = next() {
                task();
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..self.0 {
                scope.spawn(work);
            }
        });
    }
}

/// Returns the reference values.
pub fn known() -> Value {
    serde_json::from_str(include_str!(
        "../../../../../tests/data/identification-known-answers.json"
    ))
    .expect("the known answers are JSON")
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
pub fn noisy(known: &Value, count: usize) -> Vec<Segment> {
    let records = known["noisy"]["records"].as_array().expect("records");
    let segment = |(record, value): (usize, &Value)| Segment {
        record,
        start_s: 0.0,
        sample_time_s: value["dt"].as_f64().expect("a sample time"),
        inputs: matrix(&value["u"]),
        outputs: matrix(&value["y"]),
    };
    records
        .iter()
        .take(count)
        .enumerate()
        .map(segment)
        .collect()
}

/// Returns the spectra of the case `noisy` in scaled units, up to 1.3 times the upper end `w_hi` of
/// its band.
pub fn noisy_spectra() -> Vec<Spectrum> {
    let segments = noisy(&known(), 4);
    let scales = Scales::from_segments(&segments).expect("its channels move");
    let scaled: Vec<_> = segments
        .iter()
        .map(|segment| scales.scaled(segment))
        .collect();
    spectra(&scaled, 1.3 * 4.0 / 3.0 * 6.0, &Sequential)
}

/// Returns the measured response of the case `noisy` in scaled units.
pub fn noisy_measured() -> ResponseEstimate {
    local_polynomial(&noisy_spectra(), &log_spaced(0.3, 8.0, 40), &Sequential)
        .expect("its records are long enough")
}

/// Returns the response of a model at a frequency \[rad/s\].
pub fn response(model: &StateSpace, omega: f64) -> DMatrix<Complex<f64>> {
    let response = evaluate(model, &[omega]);
    DMatrix::from_fn(model.outputs(), model.inputs(), |output, input| {
        response.curve(Pair::new(output, input))[0]
    })
}

/// Returns the matrices of a model.
pub fn space(model: &Model) -> &StateSpace {
    model.state_space().expect("it has matrices")
}

/// Returns the synthetic system of the case `drop_fast` without its fast mode.
pub fn slow_system() -> StateSpace {
    let known = known();
    let [a, b, c, d] = ["A", "B", "C", "D"].map(|key| matrix(&known["drop_fast"][key]));
    StateSpace::new(
        a.view((0, 0), (4, 4)).into(),
        b.rows(0, 4).into(),
        c.columns(0, 4).into(),
        d,
    )
    .expect("it is whole")
}

/// Returns pseudo-random numbers between -1 and 1; reproducible for a given seed.
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
