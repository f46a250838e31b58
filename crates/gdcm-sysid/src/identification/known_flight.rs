//! For tests: flights of known aircraft, and the errors of identified models against the Cramer-Rao
//! bound (M14.22).
//!
//! ```text
//! noise of the outputs: S(omega) = N N^H + dt diag s_v^2,  N: response to the disturbances, of unit power density
//!     (s_v standard deviations of the measurement noise, dt sample time)
//! bound: standard deviations from the normal equations at a model, with weights from S
//! ratio = median over responses and frequencies of |error| / (0.6745 sd of the bound):
//!     1 at the bound, because the median |x| of a normal x with sd 1 is 0.6745
//! ```
//!
//! An interval *holds* if the true value lies within it.

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::{Shares, Unobserved};
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::response::pole_estimate::POLE_INTERVAL;
use gdcm_model::simulation::FlightRecord;
use gdcm_model::statistics::median;

use super::identify::Identification;
use super::known_answers_tests::response_at;
use super::prepared_data::PreparedData;
use super::real_flight_tests::Generator;
use crate::diagnostics::bands::{BandModels, TWO_SIDED_95};
use crate::likelihood::balancing::{Coordinates, Gramians, balancing_coordinates};
use crate::likelihood::cost::Likelihood;
use crate::likelihood::covariance::ParameterCovariance;
use crate::likelihood::noise_covariance::{NoiseCovariance, NoisePoint};
use crate::likelihood::schur_model::SchurModel;
use crate::likelihood::spectral_lines::SpectralLines;
use crate::options::Options;

/// A neper in decibels.
pub(super) const NEPER_DB: f64 = 8.685_889_638;
/// Median modulus of a normal variable with standard deviation 1.
const MEDIAN_OF_NORMAL: f64 = 0.6745;
/// Number of frequencies at which errors are counted.
const POINTS: usize = 12;

/// A flight of a known aircraft.
pub(super) struct KnownFlight {
    pub(super) truth: StateSpace,
    /// Response of the outputs to the disturbances.
    pub(super) disturbed: StateSpace,
    /// Power density of each disturbance: `s^2 dt` for white noise with standard deviation s and
    /// sample time dt.
    pub(super) density: f64,
    /// Standard deviations of the measurement noise.
    pub(super) noise: Vec<f64>,
    /// Sample time \[s\].
    pub(super) step_s: f64,
    pub(super) records: Vec<FlightRecord>,
    pub(super) options: Options,
    /// Responses whose errors also count in [`Figures::main_ratios`].
    pub(super) main_pairs: Vec<Pair>,
}

impl KnownFlight {
    /// Computes the covariance of the noise of the outputs at a frequency, in scaled units.
    fn noise_at(&self, omega: f64, scales: &[f64]) -> DMatrix<Complex<f64>> {
        let outputs = self.truth.outputs();
        let response = response_at(&self.disturbed, omega);
        let mut covariance = &response * response.adjoint() * Complex::from(self.density);
        for (o, noise) in self.noise.iter().enumerate() {
            covariance[(o, o)] += noise * noise * self.step_s;
        }
        DMatrix::from_fn(outputs, outputs, |row, column| {
            covariance[(row, column)] / (scales[row] * scales[column])
        })
    }

    /// Returns the cost of the lines with the true noise.
    pub(super) fn likelihood<'a>(&self, data: &PreparedData<'a>) -> Likelihood<'a> {
        let points = log_spaced(0.2, 20.0, 80)
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
        Likelihood::new(lines.collect(), &Sequential)
    }

    /// Computes the standard deviations of the bound at a model, in dB, `[output, input]` at each
    /// frequency.
    pub(super) fn bound_db(&self, at: &StateSpace, omegas: &[f64]) -> Vec<DMatrix<f64>> {
        let progress = Shares::new(&Unobserved);
        let data = PreparedData::new(&self.records, &self.options, &Sequential, &progress).unwrap();
        let likelihood = self.likelihood(&data);
        let model = scaled(at, &data);
        // Balances the model, because physical states have unlike units.
        let Coordinates {
            transformation,
            inverse,
        } = balancing_coordinates(&Gramians::sampled(&likelihood, &model)).unwrap();
        let model = model.in_coordinates(&transformation, &inverse).unwrap();
        let covariance = ParameterCovariance::from_lines(&likelihood, &model).unwrap();
        let models = BandModels {
            model: &model,
            neighbours: &[],
            feedback: None,
        };
        let bands = models.bands(&covariance, omegas, &Sequential).unwrap();
        // The bands' variances contain a factor of 2.
        let sd_db = |k: usize| {
            DMatrix::from_fn(at.outputs(), at.inputs(), |output, input| {
                bands.sd_db()[Pair { output, input }][k] / 2f64.sqrt()
            })
        };
        (0..omegas.len()).map(sd_db).collect()
    }
}

/// Returns a random K, with the standard deviation `deviation` in each entry, then reduced until
/// every pole lies to the left of -0.1 rad/s; 0 if `deviation` is 0.
pub(crate) fn stable_feedback(
    deviation: f64,
    truth: &StateSpace,
    random: &mut Generator,
) -> DMatrix<f64> {
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

/// Converts a model from record units to scaled units.
pub(super) fn scaled(at: &StateSpace, data: &PreparedData) -> SchurModel {
    let mut b = at.b().clone();
    let mut d = at.d().clone();
    for (input, scale) in data.scales.inputs.iter().enumerate() {
        b.column_mut(input).scale_mut(*scale);
        d.column_mut(input).scale_mut(*scale);
    }
    let mut c = at.c().clone();
    for (output, scale) in data.scales.outputs.iter().enumerate() {
        c.row_mut(output).unscale_mut(*scale);
        d.row_mut(output).unscale_mut(*scale);
    }
    SchurModel::new(at.a().clone(), b, c, d).unwrap()
}

/// Returns each output's response with the largest mean log modulus over the band.
pub(super) fn largest_pairs(model: &StateSpace, band: [f64; 2]) -> Vec<Pair> {
    let mut sums = DMatrix::zeros(model.outputs(), model.inputs());
    for omega in log_spaced(band[0], band[1], POINTS) {
        sums += response_at(model, omega).map(|h| h.norm().ln());
    }
    let mut pairs = Vec::new();
    for output in 0..sums.nrows() {
        let input = sums.row(output).transpose().imax();
        pairs.push(Pair { output, input });
    }
    pairs
}

/// Returns `ln(H_found / H_true)` of all responses at a frequency.
pub(super) fn log_errors(
    found: &StateSpace,
    truth: &StateSpace,
    omega: f64,
) -> DMatrix<Complex<f64>> {
    response_at(found, omega).zip_map(&response_at(truth, omega), |own, known| (own / known).ln())
}

/// Errors over a set of flights, compared with the bound, and with the 95 % intervals. `held`
/// counts the errors within their interval.
#[derive(Default)]
pub(super) struct Figures {
    /// `|error| / (0.6745 sd of the bound)` of each response and frequency.
    pub(super) ratios: Vec<f64>,
    /// The same for [`KnownFlight::main_pairs`] only.
    pub(super) main_ratios: Vec<f64>,
    pub(super) held_db: usize,
    pub(super) held_deg: usize,
    pub(super) count: usize,
    pub(super) poles: usize,
    pub(super) held_poles: usize,
}

impl Figures {
    /// Adds a flight, with the bound at the model `at`.
    pub(super) fn add(&mut self, flight: &KnownFlight, found: &Identification, at: &StateSpace) {
        let [lowest, highest] = flight.options.band;
        let omegas = log_spaced(lowest, highest, POINTS);
        let bound = flight.bound_db(at, &omegas);
        let model = found.refined.state_space().unwrap();
        let bands = found.refined.bands.as_ref().unwrap();
        for (k, omega) in omegas.iter().enumerate() {
            let errors = log_errors(model, &flight.truth, *omega);
            let place = bands.omega().partition_point(|other| *other < *omega);
            let place = place.min(bands.omega().len() - 1);
            for output in 0..errors.nrows() {
                for input in 0..errors.ncols() {
                    let pair = Pair { output, input };
                    let error = errors[(output, input)];
                    let error_db = (NEPER_DB * error.re).abs();
                    let ratio = error_db / (MEDIAN_OF_NORMAL * bound[k][(output, input)]);
                    self.ratios.push(ratio);
                    if flight.main_pairs.contains(&pair) {
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
    /// Describes the figures in a line.
    pub(super) fn summary(&self) -> String {
        let share = |part: usize, whole: usize| 100.0 * part as f64 / whole as f64;
        format!(
            "ratio {:.2}, apart {:.2}; held {:.1} % dB, {:.1} % deg of {}; poles {:.0} % of {}",
            median(&mut self.ratios.clone()),
            median(&mut self.main_ratios.clone()),
            share(self.held_db, self.count),
            share(self.held_deg, self.count),
            self.count,
            share(self.held_poles, self.poles),
            self.poles
        )
    }
}
