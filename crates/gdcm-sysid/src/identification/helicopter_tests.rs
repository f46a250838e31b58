//! Flights of helicopters with 39 states, some unstable, under feedback and in gusts: errors
//! against the Cramer-Rao bound, and J of the refined and of the unrefined model (M14.22).
//!
//! The aircraft are nominal physics models of the example. The loop is simulated at 200 Hz as a
//! linear system driven by white noise and a sweep, so that inputs and outputs are smooth between
//! their samples at 50 Hz:
//!
//! ```text
//! x' = A x + B u + E g,     E = -(columns of u, v, w of A),  g: gusts of u, v, w [m/s]
//! g' = -0.5 g + s_g w,      s_g^2 = 2 0.5 rms^2
//! u = sweep + r + K x,      r'' = -6 r' - 9 r + s_r w:  the other sticks move a little
//! K: rates p, q, r and attitudes phi, theta to LAT, LON, PED
//! ```

use std::io::Read;
use std::path::Path;

use flate2::read::GzDecoder;
use nalgebra::{DMatrix, DVector};
use serde_json::Value;

use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::simulation::{FirstOrderHold, FlightRecord};
use gdcm_model::statistics::median;

use super::Identification;
use super::identify::identify;
use super::known_answers_tests::matrix;
use super::known_flight::{Figures, KnownFlight, NEPER_DB, log_errors};
use super::real_flight_tests::Generator;
use crate::options::Options;
use crate::spectra::preparation_settings::Preparation;

const INPUTS: [&str; 4] = ["LON", "LAT", "PED", "COL"];
const OUTPUTS: [&str; 6] = ["P", "Q", "R", "NX", "NY", "NZ"];
const BAND: [f64; 2] = [0.5, 12.0];
const STEP_S: f64 = 0.02;
/// Steps of the simulation in a sample time.
const SUBSTEPS: usize = 4;
/// Length of a record \[s\].
const SECONDS: usize = 60;
/// Amplitude of a sweep \[%\].
const AMPLITUDE: f64 = 8.0;
/// Standard deviation of the movement of the other sticks \[%\].
const REMNANT: f64 = 0.3;
/// Cut-off of the gusts \[rad/s\].
const GUST_RATE: f64 = 0.5;
/// Cut-off of the movement of the other sticks \[rad/s\].
const REMNANT_RATE: f64 = 3.0;
/// Responses on axis.
const ON_AXIS: [Pair; 5] = [
    Pair {
        output: 0,
        input: 1,
    },
    Pair {
        output: 1,
        input: 0,
    },
    Pair {
        output: 2,
        input: 2,
    },
    Pair {
        output: 4,
        input: 2,
    },
    Pair {
        output: 5,
        input: 3,
    },
];

/// A nominal physics model of the example.
struct Helicopter {
    model: StateSpace,
    states: Vec<String>,
}

impl Helicopter {
    /// Reads the model of a condition from the example in the assets.
    fn from_example(id: i64) -> Self {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/example-dataset.json.gz");
        let mut text = String::new();
        GzDecoder::new(std::fs::File::open(path).unwrap())
            .read_to_string(&mut text)
            .unwrap();
        let dataset: Value = serde_json::from_str(&text).unwrap();
        let conditions = dataset["conditions"].as_array().unwrap();
        let condition = conditions
            .iter()
            .find(|condition| condition["id"] == id)
            .unwrap();
        let models = condition["physics_models"].as_array().unwrap();
        let nominal = models
            .iter()
            .find(|model| model["role"] == "nominal")
            .unwrap();
        let [a, b, c, d] = ["A", "B", "C", "D"].map(|key| matrix(&nominal[key]));
        let states = nominal["states"].as_array().unwrap();
        Self {
            model: StateSpace::new(a, b, c, d).unwrap(),
            states: states
                .iter()
                .map(|name| name.as_str().unwrap().to_owned())
                .collect(),
        }
    }

    fn state(&self, name: &str) -> usize {
        self.states.iter().position(|state| state == name).unwrap()
    }

    /// Returns K, inputs x states, with a gain \[% per deg and per deg/s\] on pitch, and half of it
    /// on roll.
    fn feedback(&self, gain: f64) -> DMatrix<f64> {
        let mut feedback = DMatrix::zeros(4, self.model.order());
        for (input, name, share) in [
            (0, "q", 1.0),
            (0, "theta", 1.0),
            (1, "p", 0.5),
            (1, "phi", 0.5),
            (2, "r", 1.0),
        ] {
            feedback[(input, self.state(name))] = -share * gain * 1f64.to_degrees();
        }
        feedback
    }

    /// Returns the model with gusts of 1 m/s as further states and their white noises as inputs.
    fn in_gusts(&self) -> StateSpace {
        let order = self.model.order();
        let mut a = DMatrix::zeros(order + 3, order + 3);
        a.view_mut((0, 0), (order, order)).copy_from(self.model.a());
        for (gust, name) in ["u", "v", "w"].into_iter().enumerate() {
            let column = -self.model.a().column(self.state(name));
            a.view_mut((0, order + gust), (order, 1)).copy_from(&column);
            a[(order + gust, order + gust)] = -GUST_RATE;
        }
        let mut b = DMatrix::zeros(order + 3, 3);
        b.view_mut((order, 0), (3, 3))
            .fill_diagonal((2.0 * GUST_RATE).sqrt());
        let mut c = DMatrix::zeros(6, order + 3);
        c.columns_mut(0, order).copy_from(self.model.c());
        StateSpace::new(a, b, c, DMatrix::zeros(6, 3)).unwrap()
    }
}

/// Conditions of a simulated flight.
#[derive(Clone, Copy, Debug)]
struct FlightSettings {
    /// Standard deviation of each gust \[m/s\].
    gusts: f64,
    /// Standard deviation of the measurement noise, relative to each output's.
    noise: f64,
    /// Gain of the feedback \[% per deg and per deg/s\].
    gain: f64,
    /// Number of further pedal sweeps at the lower end of the band.
    slow_pedal_sweeps: usize,
}

/// Settings with errors on axis of some tenths of a decibel.
const GUSTY: FlightSettings = FlightSettings {
    gusts: 0.3,
    noise: 0.02,
    gain: 0.6,
    slow_pedal_sweeps: 0,
};

/// A third of the gusts and of the noise.
const CALM: FlightSettings = FlightSettings {
    gusts: 0.1,
    noise: 0.007,
    ..GUSTY
};

/// Returns the closed loop: inputs are four sweeps, the white noises of three gusts and of four
/// movements of sticks; outputs are those of the helicopter, then the sticks.
fn closed_loop(helicopter: &Helicopter, settings: FlightSettings) -> StateSpace {
    let gusty = helicopter.in_gusts();
    let order = gusty.order();
    let mut feedback = DMatrix::zeros(4, order + 8);
    feedback
        .columns_mut(0, helicopter.model.order())
        .copy_from(&helicopter.feedback(settings.gain));
    let mut b_sticks = DMatrix::zeros(order + 8, 4);
    b_sticks
        .rows_mut(0, helicopter.model.order())
        .copy_from(helicopter.model.b());
    // Positions of the other sticks, then their rates.
    let mut remnant = DMatrix::zeros(4, order + 8);
    remnant.columns_mut(order, 4).fill_with_identity();
    let sticks = feedback + remnant;
    let mut a = DMatrix::zeros(order + 8, order + 8);
    a.view_mut((0, 0), (order, order)).copy_from(gusty.a());
    a.view_mut((order, order + 4), (4, 4)).fill_with_identity();
    a.view_mut((order + 4, order), (4, 4))
        .fill_diagonal(-REMNANT_RATE * REMNANT_RATE);
    a.view_mut((order + 4, order + 4), (4, 4))
        .fill_diagonal(-2.0 * REMNANT_RATE);
    a += &b_sticks * &sticks;
    let mut b = DMatrix::zeros(order + 8, 11);
    b.columns_mut(0, 4).copy_from(&b_sticks);
    b.view_mut((0, 4), (order, 3))
        .copy_from(&gusty.b().scale(settings.gusts));
    // White noise of density s^2 through the double lag of rate w gives the variance s^2 / (4 w^3).
    b.view_mut((order + 4, 7), (4, 4))
        .fill_diagonal(REMNANT * (4.0 * REMNANT_RATE.powi(3)).sqrt());
    let mut c = DMatrix::zeros(10, order + 8);
    c.view_mut((0, 0), (6, order)).copy_from(gusty.c());
    c.rows_mut(6, 4).copy_from(&sticks);
    let mut d = DMatrix::zeros(10, 11);
    d.view_mut((6, 0), (4, 4)).fill_with_identity();
    StateSpace::new(a, b, c, d).unwrap()
}

/// Simulates two sweeps of each input, and the slow sweeps of the pedals.
fn fly(condition: i64, settings: FlightSettings, seed: u64) -> KnownFlight {
    let helicopter = Helicopter::from_example(condition);
    let closed = closed_loop(&helicopter, settings);
    let poles = closed.a().complex_eigenvalues();
    let growth = poles.iter().map(|pole| pole.re).fold(f64::MIN, f64::max);
    assert!(
        growth < 0.0,
        "the closed loop of condition {condition} is unstable: {growth} rad/s"
    );
    let step_s = STEP_S / SUBSTEPS as f64;
    let plant = FirstOrderHold::new(&closed, step_s).unwrap();
    let samples = SECONDS * 50;
    let mut random = Generator::new(seed);
    let mut noise = vec![0.0; 6];
    let mut records = Vec::new();
    for number in 0..8 + settings.slow_pedal_sweeps {
        let is_slow = number >= 8;
        let swept = if is_slow { 2 } else { number / 2 };
        let highest_hz = if is_slow { 0.25 } else { 2.7 };
        let mut driven = DMatrix::zeros(samples * SUBSTEPS, closed.inputs());
        for (k, mut row) in driven.row_iter_mut().enumerate() {
            row[swept] = sweep_at(k as f64 * step_s, highest_hz);
            for channel in 4..11 {
                // White noise of unit power density.
                row[channel] = random.normal() / step_s.sqrt();
            }
        }
        let simulated = plant.simulate(&DVector::zeros(closed.order()), &driven);
        let logged = DMatrix::from_fn(samples, 10, |k, channel| simulated[(k * SUBSTEPS, channel)]);
        let mut outputs = logged.columns(0, 6).into_owned();
        for (o, mut column) in outputs.column_iter_mut().enumerate() {
            if number == 0 {
                noise[o] = settings.noise * (column.norm_squared() / column.len() as f64).sqrt();
            }
            column.apply(|y| *y += noise[o] * random.normal());
        }
        records.push(FlightRecord {
            name: format!("{} {number}", INPUTS[swept]),
            time_s: (0..samples).map(|k| STEP_S * k as f64).collect(),
            inputs: logged.columns(6, 4).into_owned(),
            outputs,
        });
    }
    let gusty = helicopter.in_gusts();
    KnownFlight {
        truth: helicopter.model,
        disturbed: gusty,
        density: settings.gusts * settings.gusts,
        noise,
        step_s: STEP_S,
        records,
        options: Options::new(BAND, Preparation::new(&INPUTS, &OUTPUTS)),
        main_pairs: ON_AXIS.to_vec(),
    }
}

/// Returns a logarithmic sweep from 0.05 Hz \[%\], which begins after 2 s and ends 2 s before the
/// record does.
fn sweep_at(time_s: f64, highest_hz: f64) -> f64 {
    let length_s = SECONDS as f64 - 4.0;
    if !(2.0..=2.0 + length_s).contains(&time_s) {
        return 0.0;
    }
    let rate = (highest_hz / 0.05).ln();
    let share = (time_s - 2.0) / length_s;
    let turns = 0.05 * length_s / rate * ((rate * share).exp() - 1.0);
    // Rises and falls within a second.
    let edge = (length_s * share.min(1.0 - share)).min(1.0);
    AMPLITUDE * edge * (std::f64::consts::TAU * turns).sin()
}

/// Computes J (M4) of each response against the truth, outputs x inputs:
/// `J = mean 20 (error_dB^2 + 0.0175 error_deg^2)` over frequency.
fn mismatch(found: &StateSpace, truth: &StateSpace) -> DMatrix<f64> {
    let omegas = log_spaced(BAND[0], BAND[1], 60);
    let mut sums = DMatrix::zeros(truth.outputs(), truth.inputs());
    for omega in &omegas {
        sums += log_errors(found, truth, *omega).map(|error| {
            20.0 * ((NEPER_DB * error.re).powi(2) + 0.0175 * error.im.to_degrees().powi(2))
        });
    }
    sums / omegas.len() as f64
}

fn on_axis(mismatch: &DMatrix<f64>) -> [f64; 5] {
    ON_AXIS.map(|pair| mismatch[(pair.output, pair.input)])
}

fn identified(flight: &KnownFlight) -> Identification {
    identify(&flight.records, &flight.options, &Sequential, &Unobserved).unwrap()
}

/// Computes the expected J on axis at the bound: `20 (sd_dB^2 + 0.0175 sd_deg^2)`, averaged over
/// the band. The real and the imaginary part of the logarithm have the same variance, so that
/// sd_deg is a multiple of sd_dB.
fn mismatch_at_the_bound(flight: &KnownFlight) -> [f64; 5] {
    let omegas = log_spaced(BAND[0], BAND[1], 60);
    let bound = flight.bound_db(&flight.truth, &omegas);
    let degrees_of_db = 1f64.to_degrees() / NEPER_DB;
    ON_AXIS.map(|pair| {
        let squares: f64 = bound
            .iter()
            .map(|sd| sd[(pair.output, pair.input)].powi(2))
            .sum();
        20.0 * (1.0 + 0.0175 * degrees_of_db * degrees_of_db) * squares / omegas.len() as f64
    })
}

/// J on axis of the models of many flights.
#[derive(Default)]
struct Mismatches {
    refined: Vec<f64>,
    unrefined: Vec<f64>,
    bound: Vec<f64>,
}

impl Mismatches {
    fn add(&mut self, flight: &KnownFlight) {
        let found = identified(flight);
        let refined = mismatch(found.refined.state_space().unwrap(), &flight.truth);
        let unrefined = mismatch(found.unrefined.state_space().unwrap(), &flight.truth);
        self.refined.extend(on_axis(&refined));
        self.unrefined.extend(on_axis(&unrefined));
        self.bound.extend(mismatch_at_the_bound(flight));
    }

    /// Simulates and identifies flights with five seeds from the first on, for each condition.
    fn from_flights(settings: FlightSettings, conditions_and_seeds: [(i64, u64); 3]) -> Self {
        let mut mismatches = Self::default();
        for (condition, first) in conditions_and_seeds {
            for seed in first..first + 5 {
                mismatches.add(&fly(condition, settings, seed));
            }
        }
        mismatches.print(settings);
        mismatches
    }

    fn print(&self, settings: FlightSettings) {
        println!("{settings:?}");
        for (name, values) in [
            ("refined", &self.refined),
            ("unrefined", &self.unrefined),
            ("at the bound", &self.bound),
        ] {
            println!(
                "J on axis, {name}: median {:.3}, mean {:.3}, worst {:.3}",
                median(&mut values.clone()),
                mean(values),
                worst(values)
            );
        }
        for (at, pair) in ON_AXIS.into_iter().enumerate() {
            let refined = every_fifth(&self.refined, at);
            let unrefined = every_fifth(&self.unrefined, at);
            let bound = every_fifth(&self.bound, at);
            println!(
                "  {}/{}: mean refined {:.3}, unrefined {:.3}, at the bound {:.3}; \
                 refined larger in {} of {}",
                OUTPUTS[pair.output],
                INPUTS[pair.input],
                mean(&refined),
                mean(&unrefined),
                mean(&bound),
                count_larger(&refined, &unrefined),
                refined.len()
            );
        }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn worst(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// Returns the values of the on-axis response `first` in [`ON_AXIS`], of all flights.
fn every_fifth(values: &[f64], first: usize) -> Vec<f64> {
    values.iter().skip(first).step_by(5).copied().collect()
}

fn count_larger(values: &[f64], others: &[f64]) -> usize {
    values
        .iter()
        .zip(others)
        .filter(|(value, other)| value > other)
        .count()
}

/// Identifies flights, prints the figures against the bound at the truth and at the model, and
/// returns those against the bound at the truth.
fn figures(
    settings: FlightSettings,
    conditions_and_seeds: [(i64, std::ops::Range<u64>); 3],
) -> Figures {
    let mut at_truth = Figures::default();
    let mut at_model = Figures::default();
    for (condition, seeds) in conditions_and_seeds {
        for seed in seeds {
            let flight = fly(condition, settings, seed);
            let found = identified(&flight);
            at_truth.add(&flight, &found, &flight.truth);
            at_model.add(&flight, &found, found.refined.state_space().unwrap());
        }
    }
    println!("{settings:?}, bound at the truth: {}", at_truth.summary());
    println!("{settings:?}, bound at the model: {}", at_model.summary());
    at_truth
}

#[test]
#[ignore = "eighteen flights of a helicopter with 39 states"]
fn errors_are_near_the_bound_at_the_size_of_a_helicopter() {
    for found in [
        figures(GUSTY, [(1, 7500..7503), (3, 7510..7513), (10, 7520..7523)]),
        figures(CALM, [(1, 7530..7533), (3, 7540..7543), (10, 7550..7553)]),
    ] {
        for mut ratios in [found.ratios, found.main_ratios] {
            // Measured: 0.99 to 1.03 (docs/identification.md, M14.22).
            assert!(median(&mut ratios) < 1.4, "{ratios:?}");
        }
        for held in [found.held_db, found.held_deg] {
            assert!(
                100 * held >= 95 * found.count,
                "{held} of {} intervals hold",
                found.count
            );
        }
        assert!(
            10 * found.held_poles >= 9 * found.poles,
            "{} of {} poles are within their interval",
            found.held_poles,
            found.poles
        );
    }
}

#[test]
#[ignore = "thirty flights of a helicopter with 39 states"]
fn refinement_lowers_j_on_axis_to_the_bound() {
    let plain = Mismatches::from_flights(CALM, [(1, 7600), (3, 7610), (10, 7620)]);
    let ratio = mean(&plain.refined) / mean(&plain.bound);
    assert!(
        (0.6..1.5).contains(&ratio),
        "mean J is {ratio} times that at the bound"
    );
    assert!(median(&mut plain.refined.clone()) < 0.5 * median(&mut plain.unrefined.clone()));
    // The largest J is that of a weak response where it is hardly excited: PED to R at the lower
    // end of the band. Two slow sweeps of the pedals lower J of both responses to PED.
    let slow_sweeps = FlightSettings {
        slow_pedal_sweeps: 2,
        ..CALM
    };
    let slow = Mismatches::from_flights(slow_sweeps, [(1, 7600), (3, 7610), (10, 7620)]);
    let mut shares = Vec::new();
    for at in [2, 3] {
        let before = every_fifth(&plain.refined, at);
        let after = every_fifth(&slow.refined, at);
        shares.push(mean(&after) / mean(&before));
    }
    assert!(shares[0] < 0.6 && shares[1] < 1.0, "{shares:?}");
}
