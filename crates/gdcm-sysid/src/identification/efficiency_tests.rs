//! Errors and intervals of identified models against the Cramer-Rao bound, on simulated flights of
//! known aircraft (M14.19, M14.22; `known_flight` computes the bound).
//!
//! ```text
//! x' = A x + B u + E w,  y = C x + v;   w: gusts, white;  v: measurement noise, white
//! noise of the outputs: S(omega) = dt (s_w^2 C R E E' R^H C' + s_v^2 I),  R = (j omega - A)^-1
//! bound: standard deviations from G at the true model with weights from S
//! ratio = median over responses and frequencies of |error| / (0.6745 sd of the bound)
//! ```
//!
//! In closed loop, u = r + K y with the sweep in r: gusts reach the inputs. Seeds from 5000 on were
//! used for nothing else.

use nalgebra::{DMatrix, DVector};

use gdcm_model::dataset::StateSpace;
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::simulation::{FirstOrderHold, FlightRecord};
use gdcm_model::statistics::median;

use super::fresh_flight_tests::aircraft;
use super::identify::identify;
use super::known_flight::{Figures, KnownFlight, largest_pairs, stable_feedback};
use super::real_flight_tests::Generator;
use crate::diagnostics::cautions::IdentificationCaution;
use crate::evidence;
use crate::options::Options;
use crate::spectra::preparation_settings::Preparation;

const STEP_S: f64 = 0.04;
/// Standard deviation of the measurement noise, relative to each output's.
const NOISE: f64 = 0.02;
/// Standard deviation of the gusts \[1\].
const GUSTS: f64 = 0.15;
const BAND: [f64; 2] = [0.5, 12.0];

/// Conditions of a simulated flight.
#[derive(Clone, Copy)]
struct FlightSettings {
    /// Length of each record \[s\].
    seconds: i32,
    /// Standard deviation of the gusts.
    gusts: f64,
    /// Standard deviation of an entry of K; 0 in open loop.
    feedback: f64,
    /// Steps of the simulation in a sample time; with 1 the inputs are straight lines between the
    /// samples, otherwise smooth.
    substeps: usize,
}

/// Open loop, a minute for each record.
const OPEN_LOOP: FlightSettings = FlightSettings {
    seconds: 60,
    gusts: GUSTS,
    feedback: 0.0,
    substeps: 8,
};

/// Simulates two sweeps of each input; the other inputs move a little.
fn fly(settings: FlightSettings, inputs: usize, outputs: usize, seed: u64) -> KnownFlight {
    let seconds = settings.seconds;
    let substeps = settings.substeps;
    let mut random = Generator::new(seed);
    let truth = aircraft(inputs, outputs, &mut random);
    let gusts = DMatrix::from_fn(truth.order(), 2, |_, _| random.normal());
    let feedback = stable_feedback(settings.feedback, &truth, &mut random);
    // Closed loop: inputs r and w, outputs y and u = r + K y.
    let loop_gain = &feedback * truth.c();
    let a = truth.a() + truth.b() * &loop_gain;
    let mut b = DMatrix::zeros(truth.order(), inputs + 2);
    b.columns_mut(0, inputs).copy_from(truth.b());
    b.columns_mut(inputs, 2).copy_from(&gusts);
    let mut c = DMatrix::zeros(outputs + inputs, truth.order());
    c.rows_mut(0, outputs).copy_from(truth.c());
    c.rows_mut(outputs, inputs).copy_from(&loop_gain);
    let mut d = DMatrix::zeros(outputs + inputs, inputs + 2);
    d.view_mut((outputs, 0), (inputs, inputs))
        .fill_with_identity();
    let closed = StateSpace::new(a, b, c, d).unwrap();
    let plant = FirstOrderHold::new(&closed, STEP_S / substeps as f64).unwrap();
    let time_s: Vec<f64> = (0..25 * seconds).map(|k| STEP_S * f64::from(k)).collect();
    let mut noise = vec![0.0; outputs];
    let mut records = Vec::new();
    for number in 0..2 * inputs {
        let swept = number / 2;
        let mut slow = vec![0.0; inputs];
        let remnants_and_gusts = DMatrix::from_fn(inputs + 2, time_s.len(), |channel, _| {
            if channel >= inputs {
                return settings.gusts * random.normal();
            }
            slow[channel] = 0.9 * slow[channel] + 0.05 * random.normal();
            slow[channel]
        })
        .transpose();
        let mut driven = DMatrix::zeros(time_s.len() * substeps, inputs + 2);
        for (k, mut row) in driven.row_iter_mut().enumerate() {
            // In samples.
            let place = k as f64 / substeps as f64;
            for channel in 0..inputs {
                row[channel] = smooth_at(&remnants_and_gusts, channel, place);
            }
            for channel in inputs..inputs + 2 {
                row[channel] = straight_at(&remnants_and_gusts, channel, place);
            }
            row[swept] += sweep_at(STEP_S * place, f64::from(seconds));
        }
        let simulated = plant.simulate(&DVector::zeros(truth.order()), &driven);
        let logged = DMatrix::from_fn(time_s.len(), outputs + inputs, |k, channel| {
            simulated[(k * substeps, channel)]
        });
        let mut flown = logged.columns(0, outputs).into_owned();
        for (o, mut column) in flown.column_iter_mut().enumerate() {
            if number == 0 {
                noise[o] = NOISE * (column.norm_squared() / column.len() as f64).sqrt();
            }
            column.apply(|y| *y += noise[o] * random.normal());
        }
        records.push(FlightRecord {
            name: format!("sweep {number}"),
            time_s: time_s.clone(),
            inputs: logged.columns(outputs, inputs).into_owned(),
            outputs: flown,
        });
    }
    let disturbed = StateSpace::new(
        truth.a().clone(),
        gusts,
        truth.c().clone(),
        DMatrix::zeros(outputs, 2),
    );
    KnownFlight {
        main_pairs: largest_pairs(&truth, BAND),
        options: options(inputs, outputs),
        truth,
        disturbed: disturbed.unwrap(),
        density: STEP_S * settings.gusts * settings.gusts,
        noise,
        step_s: STEP_S,
        records,
    }
}

fn options(inputs: usize, outputs: usize) -> Options {
    let input_names = ["u0", "u1", "u2", "u3"];
    let output_names = ["y0", "y1", "y2", "y3", "y4", "y5"];
    let preparation = Preparation::new(&input_names[..inputs], &output_names[..outputs]);
    Options::new(BAND, preparation)
}

/// Evaluates a logarithmic sweep from 0.08 to 2.4 Hz with the amplitude 1.
fn sweep_at(time_s: f64, length_s: f64) -> f64 {
    let rate = 30f64.ln();
    let turns = 0.08 * length_s / rate * ((rate * time_s / length_s).exp() - 1.0);
    (std::f64::consts::TAU * turns).sin()
}

/// Interpolates a column linearly at `place`, in samples.
fn straight_at(samples: &DMatrix<f64>, column: usize, place: f64) -> f64 {
    let first = place.floor() as usize;
    let share = place - first as f64;
    let next = (first + 1).min(samples.nrows() - 1);
    (1.0 - share) * samples[(first, column)] + share * samples[(next, column)]
}

/// Interpolates a column smoothly at `place`, in samples: cubic convolution, R. G. Keys, IEEE
/// Trans. Acoust. Speech Signal Process. 29, 1981.
fn smooth_at(samples: &DMatrix<f64>, column: usize, place: f64) -> f64 {
    let first = place.floor() as usize;
    let share = place - first as f64;
    let last = samples.nrows() - 1;
    let before = samples[(first.saturating_sub(1), column)];
    let here = samples[(first, column)];
    let next = samples[((first + 1).min(last), column)];
    let after = samples[((first + 2).min(last), column)];
    let slope = 0.5 * (next - before);
    let slope_next = 0.5 * (after - here);
    let square = share * share;
    let cube = share * square;
    (2.0 * cube - 3.0 * square + 1.0) * here
        + (cube - 2.0 * square + share) * slope
        + (3.0 * square - 2.0 * cube) * next
        + (cube - square) * slope_next
}

/// Identifies flights with these seeds and returns their figures.
fn figures(
    settings: FlightSettings,
    inputs: usize,
    outputs: usize,
    seeds: std::ops::Range<u64>,
) -> Figures {
    let mut figures = Figures::default();
    for seed in seeds {
        let flight = fly(settings, inputs, outputs, seed);
        let found = identify(&flight.records, &flight.options, &Sequential, &Unobserved).unwrap();
        figures.add(&flight, &found, &flight.truth);
    }
    println!(
        "{inputs} x {outputs}, gusts {}, feedback {}, substeps {}: {}",
        settings.gusts,
        settings.feedback,
        settings.substeps,
        figures.summary()
    );
    figures
}

/// Asserts that the median error is at most 1.4 times that of the bound, and that intervals of 95 %
/// and poles hold. The measured figures are in docs/identification.md, M14.22.
fn assert_near_the_bound(figures: &Figures) {
    let ratio = median(&mut figures.ratios.clone());
    assert!(ratio < 1.4, "median error {ratio} times the bound");
    for held in [figures.held_db, figures.held_deg] {
        assert!(
            100 * held >= 93 * figures.count,
            "{held} of {} intervals hold",
            figures.count
        );
    }
    assert!(
        10 * figures.held_poles >= 8 * figures.poles,
        "{} of {} poles are within their interval",
        figures.held_poles,
        figures.poles
    );
}

#[test]
fn errors_are_near_the_bound_and_intervals_hold() {
    assert_near_the_bound(&figures(OPEN_LOOP, 2, 2, 5000..5002));
}

#[test]
#[ignore = "thirty flights take a minute"]
fn errors_are_near_the_bound_and_intervals_hold_over_many_seeds() {
    for (code, inputs, outputs, seeds) in [
        ("intervals-of-two-by-two-responses", 2, 2, 5010..5030),
        ("intervals-of-six-by-four-responses", 4, 6, 5040..5050),
    ] {
        let found = figures(OPEN_LOOP, inputs, outputs, seeds.clone());
        assert_near_the_bound(&found);
        evidence::record_coverage(evidence::Coverage {
            code,
            // A magnitude and a phase each.
            intervals: 2 * found.count,
            covered: found.held_db + found.held_deg,
            nominal: 0.95,
            seeds: &format!("{} to {}", seeds.start, seeds.end - 1),
        });
    }
    for settings in [
        FlightSettings {
            gusts: 0.5 * GUSTS,
            ..OPEN_LOOP
        },
        FlightSettings {
            gusts: 0.5 * GUSTS,
            substeps: 1,
            ..OPEN_LOOP
        },
        FlightSettings {
            feedback: 0.02,
            ..OPEN_LOOP
        },
        FlightSettings {
            gusts: 0.5 * GUSTS,
            feedback: 0.02,
            ..OPEN_LOOP
        },
        FlightSettings {
            gusts: 0.5 * GUSTS,
            feedback: 0.02,
            substeps: 1,
            ..OPEN_LOOP
        },
        FlightSettings {
            gusts: 0.5 * GUSTS,
            feedback: 0.1,
            ..OPEN_LOOP
        },
    ] {
        let found = figures(settings, 4, 6, 5070..5080);
        if settings.substeps > 1 {
            assert_near_the_bound(&found);
        } else {
            // Straight inputs cause an error of up to (omega dt)^2 / 12, 2 % at 12 rad/s: the error
            // is clearly above the bound.
            assert!(median(&mut found.ratios.clone()) > 1.3);
        }
    }
}

/// Open loop, five minutes for each record.
const LONG: FlightSettings = FlightSettings {
    seconds: 300,
    ..OPEN_LOOP
};

/// Returns the numbers of the records that a caution names because they contradict the others.
fn contradicting(records: &[FlightRecord], options: &Options) -> Vec<usize> {
    let found = identify(records, options, &Sequential, &Unobserved).unwrap();
    for caution in &found.cautions {
        if let IdentificationCaution::Contradiction { records, .. } = caution {
            return records.iter().map(|record| record.record).collect();
        }
    }
    Vec::new()
}

/// Delays the outputs of the last record by one sample, 40 ms.
fn delay_last(records: &mut [FlightRecord]) {
    let last = records.len() - 1;
    let outputs = &mut records[last].outputs;
    for k in (1..outputs.nrows()).rev() {
        let before = outputs.row(k - 1).into_owned();
        outputs.row_mut(k).copy_from(&before);
    }
}

#[test]
#[ignore = "five flights of twenty minutes and twenty of four minutes"]
fn long_flights_do_not_contradict_and_a_late_record_is_found() {
    for seed in 6000..6005 {
        let flight = fly(LONG, 2, 2, seed);
        let named = contradicting(&flight.records, &flight.options);
        assert!(named.is_empty(), "seed {seed}: {named:?}");
    }
    let mut found = 0;
    for seed in 6100..6120 {
        let mut flight = fly(OPEN_LOOP, 2, 2, seed);
        let named = contradicting(&flight.records, &flight.options);
        assert!(named.is_empty(), "seed {seed}: {named:?}");
        delay_last(&mut flight.records);
        if contradicting(&flight.records, &flight.options).contains(&3) {
            found += 1;
        }
    }
    println!("late record found in {found} of 20");
    assert_eq!(found, 20);
}
