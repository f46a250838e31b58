//! Errors and intervals of identified models against the Cramer-Rao bound, on simulated flights of
//! known aircraft (M14.19, M14.22).
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

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::{Shares, Unobserved};
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::response::pole_estimate::POLE_INTERVAL;
use gdcm_model::simulation::{FirstOrderHold, FlightRecord};
use gdcm_model::statistics::median;

use super::fresh_flight_tests::aircraft;
use super::identify::{Identification, identify};
use super::known_answers_tests::response_at;
use super::prepared_data::PreparedData;
use super::real_flight_tests::Generator;
use crate::diagnostics::bands::{BandModels, TWO_SIDED_95};
use crate::diagnostics::cautions::IdentificationCaution;
use crate::evidence;
use crate::likelihood::cost::{Likelihood, SpectralLines};
use crate::likelihood::covariance::ParameterCovariance;
use crate::likelihood::noise_covariance::{NoiseCovariance, NoisePoint};
use crate::likelihood::schur_model::SchurModel;
use crate::options::Options;
use crate::spectra::preparation_settings::Preparation;

const STEP_S: f64 = 0.04;
/// Standard deviation of the measurement noise, relative to each output's.
const NOISE: f64 = 0.02;
/// Standard deviation of the gusts \[1\].
const GUSTS: f64 = 0.15;
const BAND: [f64; 2] = [0.5, 12.0];

/// How a flight is flown.
#[derive(Clone, Copy)]
struct Conduct {
    /// Length of each record \[s\].
    seconds: i32,
    /// Standard deviation of the gusts.
    gusts: f64,
    /// Standard deviation of an entry of K; 0 in open loop.
    feedback: f64,
}

/// Open loop, a minute for each record.
const OPEN_LOOP: Conduct = Conduct {
    seconds: 60,
    gusts: GUSTS,
    feedback: 0.0,
};

/// A flight of a known aircraft.
struct KnownFlight {
    truth: StateSpace,
    conduct: Conduct,
    /// `E`, n x gusts.
    gusts: DMatrix<f64>,
    /// Standard deviations of the measurement noise.
    noise: Vec<f64>,
    records: Vec<FlightRecord>,
}

impl KnownFlight {
    /// Simulates two sweeps of each input; the other inputs move a little.
    fn fly(conduct: Conduct, inputs: usize, outputs: usize, seed: u64) -> Self {
        let seconds = conduct.seconds;
        let mut random = Generator::new(seed);
        let truth = aircraft(inputs, outputs, &mut random);
        let gusts = DMatrix::from_fn(truth.order(), 2, |_, _| random.normal());
        let feedback = stable_feedback(conduct.feedback, &truth, &mut random);
        // Outputs y and u = r + K y.
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
        let disturbed = StateSpace::new(a, b, c, d).unwrap();
        let plant = FirstOrderHold::new(&disturbed, STEP_S).unwrap();
        let time_s: Vec<f64> = (0..25 * seconds).map(|k| STEP_S * f64::from(k)).collect();
        let mut noise = vec![0.0; outputs];
        let mut records = Vec::new();
        for number in 0..2 * inputs {
            let swept = number / 2;
            let mut slow = vec![0.0; inputs];
            let inputs_and_gusts = DMatrix::from_fn(inputs + 2, time_s.len(), |channel, k| {
                if channel >= inputs {
                    return conduct.gusts * random.normal();
                }
                slow[channel] = 0.9 * slow[channel] + 0.05 * random.normal();
                // A logarithmic sweep from 0.08 to 2.4 Hz.
                let rate = 30f64.ln();
                let length_s = f64::from(seconds);
                let turns = 0.08 * length_s / rate * ((rate * time_s[k] / length_s).exp() - 1.0);
                if channel == swept {
                    slow[channel] + (std::f64::consts::TAU * turns).sin()
                } else {
                    slow[channel]
                }
            })
            .transpose();
            let simulated = plant.simulate(&DVector::zeros(truth.order()), &inputs_and_gusts);
            let mut flown = simulated.columns(0, outputs).into_owned();
            for (o, mut column) in flown.column_iter_mut().enumerate() {
                if number == 0 {
                    noise[o] = NOISE * (column.norm_squared() / column.len() as f64).sqrt();
                }
                column.apply(|y| *y += noise[o] * random.normal());
            }
            records.push(FlightRecord {
                name: format!("sweep {number}"),
                time_s: time_s.clone(),
                inputs: simulated.columns(outputs, inputs).into_owned(),
                outputs: flown,
            });
        }
        Self {
            truth,
            conduct,
            gusts,
            noise,
            records,
        }
    }

    fn options(&self) -> Options {
        let inputs = ["u0", "u1", "u2", "u3"];
        let outputs = ["y0", "y1", "y2", "y3", "y4", "y5"];
        let preparation = Preparation::of(
            &inputs[..self.truth.inputs()],
            &outputs[..self.truth.outputs()],
        );
        Options::new(BAND, preparation)
    }

    /// Computes the covariance of the noise of the outputs at a frequency, in scaled units.
    fn noise_at(&self, omega: f64, scales: &[f64]) -> DMatrix<Complex<f64>> {
        let outputs = self.truth.outputs();
        let to_outputs = StateSpace::new(
            self.truth.a().clone(),
            self.gusts.clone(),
            self.truth.c().clone(),
            DMatrix::zeros(outputs, 2),
        )
        .unwrap();
        let response = response_at(&to_outputs, omega) * Complex::from(self.conduct.gusts);
        let mut covariance = &response * response.adjoint();
        for (o, noise) in self.noise.iter().enumerate() {
            covariance[(o, o)] += noise * noise;
        }
        DMatrix::from_fn(outputs, outputs, |row, column| {
            covariance[(row, column)] * STEP_S / (scales[row] * scales[column])
        })
    }

    /// Computes the standard deviations of the bound, in dB, `[output, input]` at each frequency.
    fn bound_db(&self, omegas: &[f64]) -> Vec<DMatrix<f64>> {
        let options = self.options();
        let progress = Shares::new(&Unobserved);
        let data = PreparedData::new(&self.records, &options, &Sequential, &progress).unwrap();
        let points = log_spaced(0.3, 20.0, 60)
            .into_iter()
            .map(|omega| NoisePoint {
                omega,
                covariance: self.noise_at(omega, &data.scales.outputs),
            });
        let noise = NoiseCovariance::new(points.collect()).unwrap();
        let lines = data
            .spectra
            .iter()
            .map(|spectrum| SpectralLines::new(spectrum, &noise).unwrap());
        let likelihood = Likelihood::new(lines.collect(), &Sequential);
        let mut b = self.truth.b().clone();
        for (mut column, scale) in b.column_iter_mut().zip(&data.scales.inputs) {
            column.scale_mut(*scale);
        }
        let mut c = self.truth.c().clone();
        for (mut row, scale) in c.row_iter_mut().zip(&data.scales.outputs) {
            row.unscale_mut(*scale);
        }
        let model = SchurModel::new(self.truth.a().clone(), b, c, self.truth.d().clone()).unwrap();
        let covariance = ParameterCovariance::from_lines(&likelihood, &model).unwrap();
        let models = BandModels {
            model: &model,
            neighbours: &[],
            feedback: None,
        };
        let bands = models.bands(&covariance, omegas, &Sequential).unwrap();
        // Without the factor of the bands on the variances.
        let sd_db = |k: usize| {
            DMatrix::from_fn(
                self.truth.outputs(),
                self.truth.inputs(),
                |output, input| bands.sd_db()[Pair { output, input }][k] / 2f64.sqrt(),
            )
        };
        (0..omegas.len()).map(sd_db).collect()
    }
}

/// Returns a random K that leaves every pole to the left of -0.1 rad/s.
fn stable_feedback(deviation: f64, truth: &StateSpace, random: &mut Generator) -> DMatrix<f64> {
    if deviation == 0.0 {
        return DMatrix::zeros(truth.inputs(), truth.outputs());
    }
    let mut feedback = DMatrix::from_fn(truth.inputs(), truth.outputs(), |_, _| {
        deviation * random.normal()
    });
    while (truth.a() + truth.b() * &feedback * truth.c())
        .complex_eigenvalues()
        .iter()
        .any(|pole| pole.re > -0.1)
    {
        feedback *= 0.7;
    }
    feedback
}

/// Figures of a set of flights.
#[derive(Default)]
struct Figures {
    /// `|error| / (0.6745 sd of the bound)` of each response and frequency.
    ratios: Vec<f64>,
    /// The same for the largest response of each output.
    main_ratios: Vec<f64>,
    held_db: usize,
    held_deg: usize,
    count: usize,
    poles: usize,
    held_poles: usize,
}

impl Figures {
    /// Adds a flight.
    fn add(&mut self, flight: &KnownFlight, found: &Identification) {
        let omegas = log_spaced(BAND[0], BAND[1], 12);
        let bound = flight.bound_db(&omegas);
        let model = found.refined.state_space().unwrap();
        let bands = found.refined.bands.as_ref().unwrap();
        for (k, omega) in omegas.iter().enumerate() {
            let own = response_at(model, *omega);
            let true_response = response_at(&flight.truth, *omega);
            let place = bands.omega().partition_point(|other| *other < *omega);
            let place = place.min(bands.omega().len() - 1);
            for output in 0..own.nrows() {
                let row = true_response.row(output);
                let strongest = row.iter().map(|h| h.norm()).fold(0.0, f64::max);
                for input in 0..own.ncols() {
                    let pair = Pair { output, input };
                    let error = (own[(output, input)] / true_response[(output, input)]).ln();
                    let error_db = (8.685_889_638 * error.re).abs();
                    let ratio = error_db / (0.6745 * bound[k][(output, input)]);
                    self.ratios.push(ratio);
                    if row[input].norm() == strongest {
                        self.main_ratios.push(ratio);
                    }
                    self.count += 1;
                    if error_db < TWO_SIDED_95 * bands.sd_db()[pair][place] {
                        self.held_db += 1;
                    }
                    if error.im.to_degrees().abs() < TWO_SIDED_95 * bands.sd_deg()[pair][place] {
                        self.held_deg += 1;
                    }
                }
            }
        }
        let true_poles = flight.truth.a().complex_eigenvalues();
        for estimate in found.poles.iter().filter(|estimate| estimate.determined) {
            self.poles += 1;
            let is_held = |pole: &Complex<f64>| {
                let error = pole - estimate.pole;
                error.re.abs() <= POLE_INTERVAL * estimate.sd_re
                    && error.im.abs() <= POLE_INTERVAL * estimate.sd_im + 1e-9
            };
            if true_poles.iter().any(is_held) {
                self.held_poles += 1;
            }
        }
    }
}

/// Identifies flights with these seeds and returns their figures.
fn figures(
    conduct: Conduct,
    inputs: usize,
    outputs: usize,
    seeds: std::ops::Range<u64>,
) -> Figures {
    let mut figures = Figures::default();
    for seed in seeds {
        let flight = KnownFlight::fly(conduct, inputs, outputs, seed);
        let found = identify(&flight.records, &flight.options(), &Sequential, &Unobserved).unwrap();
        figures.add(&flight, &found);
    }
    let share = |part: usize, whole: usize| 100.0 * part as f64 / whole as f64;
    println!(
        "{inputs} x {outputs}, gusts {}, feedback {}: ratio {:.2}, largest responses {:.2}; held {:.1} % dB, {:.1} % deg of {}; \
         poles {:.0} % of {}",
        conduct.gusts,
        conduct.feedback,
        median(&mut figures.ratios.clone()),
        median(&mut figures.main_ratios.clone()),
        share(figures.held_db, figures.count),
        share(figures.held_deg, figures.count),
        figures.count,
        share(figures.held_poles, figures.poles),
        figures.poles
    );
    figures
}

fn assert_near_the_bound(figures: &Figures) {
    let ratio = median(&mut figures.ratios.clone());
    assert!(ratio < 1.4, "{ratio}");
    for held in [figures.held_db, figures.held_deg] {
        assert!(
            100 * held >= 93 * figures.count,
            "{held} of {}",
            figures.count
        );
    }
    assert!(
        10 * figures.held_poles >= 8 * figures.poles,
        "{} of {} poles",
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
    // With halved gusts the straight lines between the samples of the inputs, an error of up to
    // (omega dt)^2 / 12, count in open and closed loop.
    for (feedback, gusts, most) in [
        (0.0, 0.5, 2.0),
        (0.02, 0.5, 2.0),
        (0.02, 1.0, 2.0),
        (0.1, 0.5, 2.5),
    ] {
        let conduct = Conduct {
            gusts: gusts * GUSTS,
            feedback,
            ..OPEN_LOOP
        };
        let ratio = median(&mut figures(conduct, 4, 6, 5060..5070).ratios);
        assert!(ratio < most, "{feedback} {gusts}: {ratio}");
    }
}

/// Open loop, five minutes for each record.
const LONG: Conduct = Conduct {
    seconds: 300,
    ..OPEN_LOOP
};

/// Returns the records that contradict the others by the caution about them.
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
        let flight = KnownFlight::fly(LONG, 2, 2, seed);
        let wrong = contradicting(&flight.records, &flight.options());
        assert!(wrong.is_empty(), "seed {seed}: {wrong:?}");
    }
    let mut found = 0;
    for seed in 6100..6120 {
        let mut flight = KnownFlight::fly(OPEN_LOOP, 2, 2, seed);
        let good = contradicting(&flight.records, &flight.options());
        assert!(good.is_empty(), "seed {seed}: {good:?}");
        delay_last(&mut flight.records);
        if contradicting(&flight.records, &flight.options()).contains(&3) {
            found += 1;
        }
    }
    println!("late record found in {found} of 20");
    assert_eq!(found, 20);
}
