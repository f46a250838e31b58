//! The samples and lines that are used of a record that is logged fast (M14.24).

use nalgebra::DMatrix;

use gdcm_model::executor::Sequential;
use gdcm_model::progress::{Shares, Unobserved};
use gdcm_model::simulation::FlightRecord;

use super::prepared_data::PreparedData;
use super::real_flight_tests::Generator;
use super::{Options, Preparation};
use crate::spectra::spectrum::LineRange;

/// Returns records of sweeps and noise; each output is a mixture of two inputs through a lag, with
/// measurement noise.
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
    Options::new([0.5, 12.0], Preparation::new(inputs, outputs))
}

#[test]
fn a_record_logged_fast_is_thinned_for_the_projections_and_keeps_its_lines() {
    // A minute at 250 Hz. Every fourth sample is sufficient for the projections.
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
