//! Records that are logged fast, long or many (M14.24): the samples that are used, and times.

use std::sync::Mutex;
use std::time::Instant;

use nalgebra::DMatrix;

use gdcm_model::executor::Sequential;
use gdcm_model::progress::{Progress, Shares, Unobserved};
use gdcm_model::simulation::{FlightRecord, LowPass, Segment};

use super::identify::identify;
use super::prepared_data::PreparedData;
use super::real_flight_tests::Generator;
use super::{Options, Preparation};
use crate::spectra::spectrum::LineRange;
use crate::subspace::data_matrix::Projections;

/// Returns records without dynamics: sweeps and noise, each output a smoothed mixture of inputs.
fn records(
    count: usize,
    channels: [usize; 2],
    samples: usize,
    sample_time_s: f64,
) -> Vec<FlightRecord> {
    let [inputs, outputs] = channels;
    let mut random = Generator::new(77);
    let mut records = Vec::with_capacity(count);
    for number in 0..count {
        let length_s = samples as f64 * sample_time_s;
        let growth = (14.0_f64 / 0.4).ln() / length_s;
        let mut u = DMatrix::zeros(samples, inputs);
        let mut y = DMatrix::zeros(samples, outputs);
        let mut states = vec![0.0; outputs];
        for n in 0..samples {
            let time_s = n as f64 * sample_time_s;
            let phase = 0.4 / growth * ((growth * time_s).exp() - 1.0);
            for input in 0..inputs {
                u[(n, input)] = 0.1 * random.normal();
                if input == number % inputs {
                    u[(n, input)] += phase.sin();
                }
            }
            for (output, state) in states.iter_mut().enumerate() {
                let rate = 1.0 + output as f64;
                let drive = u[(n, output % inputs)] + 0.3 * u[(n, (output + 1) % inputs)];
                *state += (-rate * sample_time_s).exp_m1() * (*state - drive);
                y[(n, output)] = *state + 0.02 * random.normal();
            }
        }
        records.push(FlightRecord {
            name: format!("record {number}"),
            time_s: (0..samples).map(|n| n as f64 * sample_time_s).collect(),
            inputs: u,
            outputs: y,
        });
    }
    records
}

fn options(channels: [usize; 2]) -> Options {
    let inputs = &["LON", "LAT", "PED", "COL"][..channels[0]];
    let outputs = &["P", "Q", "R", "NX", "NY", "NZ"][..channels[1]];
    Options::new([0.5, 12.0], Preparation::of(inputs, outputs))
}

#[test]
fn a_record_logged_fast_has_all_its_lines_and_thinned_projections() {
    let records = records(1, [2, 2], 15_000, 0.004);
    let options = options([2, 2]);
    let progress = Shares::new(&Unobserved);
    let data = PreparedData::new(&records, &options, &Sequential, &progress).unwrap();
    assert!((data.segments[0].sample_time_s - 0.016).abs() < 1e-12);
    assert_eq!(data.segments[0].inputs.nrows(), 3750);
    assert_eq!(data.unfiltered[0].inputs.nrows(), 15_000);
    let lines = LineRange {
        lowest: options.lowest(),
        highest: options.highest(),
    };
    let expected = lines.spectra(&data.unfiltered, &Sequential);
    assert_eq!(data.spectra, expected);
}

/// Prints when each step of the identification begins.
struct Stages {
    start: Instant,
    before: Mutex<f64>,
}

impl Progress for Stages {
    fn cancelled(&self) -> bool {
        false
    }

    fn advanced(&self, _done: usize, _total: usize) {}

    fn step(&self, name: &str) {
        let now_s = self.start.elapsed().as_secs_f64();
        let mut before_s = self.before.lock().unwrap();
        println!("{now_s:8.3} s (+{:.3}): {name}", now_s - *before_s);
        *before_s = now_s;
    }
}

/// Times the preparation and the projections of one Laguerre pole, then the whole identification.
fn print_times(records: &[FlightRecord], channels: [usize; 2]) {
    let options = options(channels);
    let stages = Stages {
        start: Instant::now(),
        before: Mutex::new(0.0),
    };
    let progress = Shares::new(&stages);
    let data = PreparedData::new(records, &options, &Sequential, &progress).unwrap();
    stages.step("prepared; projections of a pole");
    let projections = Projections {
        pole: 9.0,
        past: 16,
        spacing_s: 0.1,
    };
    for segment in &data.segments {
        projections.rows(segment);
    }
    stages.step("the same with QR");
    projections.factor(&data.segments, &Sequential);
    let low_pass = 5.0 * data.highest;
    let full: Vec<Segment> = data
        .unfiltered
        .iter()
        .map(|segment| LowPass::applied(low_pass, segment))
        .collect();
    stages.step("the same with QR, from all samples");
    projections.factor(&full, &Sequential);
    stages.step("whole identification");
    identify(records, &options, &Sequential, &stages).unwrap();
}

/// `cargo test --release -p gdcm-sysid --lib times_of -- --ignored --nocapture --test-threads 1`
#[test]
#[ignore = "prints times"]
fn times_of_two_records_of_ten_minutes_at_250_hz() {
    print_times(&records(2, [2, 2], 150_000, 0.004), [2, 2]);
}

/// See above.
#[test]
#[ignore = "prints times"]
fn times_of_96_records_of_66_s() {
    print_times(&records(96, [4, 6], 3300, 0.02), [4, 6]);
}
