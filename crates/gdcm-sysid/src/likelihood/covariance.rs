//! The uncertainty of a model: parameters, poles and response (M14.5).
//!
//! ```text
//! Cov theta = phi G^+,   phi = J / (N - k),   G = sum_r J_r'J_r
//!     eigenvalues of G below 1e-9 of the largest are free scales of the states
//! var Re(dH/H), Im(dH/H) = h' Cov h, h the real or imaginary part of the gradient of ln H_oi
//! sd^2 = 2 (sd_GN^2 + sd_order^2) + |G_b/G|^2 / 2
//!     sd_order = rms of Re and Im ln(H_n'/H_n) over neighbouring orders
//!     |G_b/G| the fed-back share of the response (M14.17)
//! pole: d lambda = -(d a0 + lambda d a1) / (2 lambda + a1)
//! ```
//!
//! The factor 2 was measured: with it, 95 % bands hold 95 % of the true curves.

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::executor::{Executor, each};
use gdcm_model::response::pole_estimate::PoleEstimate;
use gdcm_model::units::neper_to_db;

use super::blocks::{Block, BlockModel};
use super::cost::{Likelihood, SegmentCost};
use super::gram_matrix::pseudo_inverse_root;
use super::normal_system::{NormalSystem, normal_systems};
use super::refinement::Fit;
use crate::diagnostics::feedback::Feedback;

/// Standard deviations that hold 95 %.
pub const TWO_SIDED_95: f64 = 1.96;
/// Share of the largest eigenvalue below which a direction is a free scale of the states.
const FREE_SCALE: f64 = 1e-9;
/// Measured variance factor (M14.5).
const MEASURED_FACTOR: f64 = 2.0;
/// Largest reported standard deviation: of a pole over its modulus and the band, of a response in
/// neper and radians.
const UNKNOWN: f64 = 1e3;
/// Standard deviation of a pole over its modulus up to which it is determined.
const DETERMINED: f64 = 0.5;

/// Parameter covariance.
#[derive(Clone, Debug)]
pub(crate) struct ParameterCovariance {
    /// `phi G^+`.
    covariance: DMatrix<f64>,
    /// `G / phi`.
    information: DMatrix<f64>,
}

/// A model, and the further causes for its uncertainty.
pub(crate) struct BandModels<'a> {
    pub(crate) model: &'a BlockModel,
    /// Models with neighbouring orders.
    pub(crate) neighbours: &'a [&'a BlockModel],
    pub(crate) feedback: Option<&'a Feedback>,
}

/// Variances of real and imaginary part.
struct ComplexVariance {
    re: f64,
    im: f64,
}

/// Standard deviations over frequency, for a single response.
struct PairBands {
    sd_db: Vec<f64>,
    sd_deg: Vec<f64>,
}

impl ParameterCovariance {
    /// Computes `phi G^+` for the dispersion `phi`; `None` if an iteration does not converge.
    pub(crate) fn new(system: &NormalSystem, dispersion: f64) -> Option<Self> {
        let root = pseudo_inverse_root(system.matrix.clone(), FREE_SCALE)?;
        Some(Self {
            covariance: &root * root.transpose() * dispersion,
            information: &system.matrix / dispersion,
        })
    }

    /// Computes a fit's covariance from its normal systems and its cost; `None` if the
    /// parameters leave no degrees of freedom.
    pub(crate) fn from_systems(
        likelihood: &Likelihood,
        fit: &Fit,
        systems: &[NormalSystem],
        cost: f64,
    ) -> Option<Self> {
        let spare = fit.spare_freedom(likelihood)?;
        let system = NormalSystem::sum(fit.model.parameters(), systems);
        Self::new(&system, cost / spare as f64)
    }

    /// Computes a model's covariance from other lines than the fitted ones.
    pub(crate) fn from_lines(likelihood: &Likelihood, fit: &Fit) -> Option<Self> {
        let parts = likelihood.parts(&fit.model)?;
        let systems = normal_systems(likelihood, &fit.model, &parts)?;
        let cost = parts.iter().map(|part| part.cost).sum();
        Self::from_systems(likelihood, fit, &systems, cost)
    }

    /// Computes the cost over other records with the model free to move within its uncertainty:
    /// `r'r - r'J (G/phi + J'J)^-1 J'r` (M14.17).
    pub(crate) fn moved_cost(
        &self,
        records: &Likelihood,
        model: &BlockModel,
        parts: &[SegmentCost],
    ) -> Option<f64> {
        let system = NormalSystem::sum(model.parameters(), &normal_systems(records, model, parts)?);
        let root = pseudo_inverse_root(&self.information + &system.matrix, FREE_SCALE)?;
        let cost: f64 = parts.iter().map(|part| part.cost).sum();
        Some(cost - root.tr_mul(&system.gradient).norm_squared())
    }

    /// Returns the model's poles with their standard deviations; `lowest` is the lower end of
    /// the band \[rad/s\].
    pub(crate) fn poles(&self, model: &BlockModel, lowest: f64) -> Vec<PoleEstimate> {
        let mut place = 0;
        let mut estimates = Vec::new();
        for block in &model.blocks {
            for pole in block.poles() {
                let variance = self.pole_variance(*block, pole, place);
                let most = UNKNOWN * pole.norm().max(lowest);
                let sd_re = bounded_root(variance.re, most);
                let sd_im = bounded_root(variance.im, most);
                let is_sharp = sd_re.hypot(sd_im) <= DETERMINED * pole.norm();
                estimates.push(PoleEstimate {
                    pole,
                    sd_re,
                    sd_im,
                    determined: pole.norm() >= lowest && is_sharp,
                });
            }
            place += block.size();
        }
        estimates
    }

    /// Computes a pole's variance; the parameters of its block begin at `place`.
    fn pole_variance(&self, block: Block, pole: Complex<f64>, place: usize) -> ComplexVariance {
        match block {
            Block::Single(_) => ComplexVariance {
                re: self.covariance[(place, place)],
                im: 0.0,
            },
            Block::Pair { a1, .. } => {
                let factor = -1.0 / (2.0 * pole + a1);
                self.variance(&[place, place + 1], &[factor, factor * pole])
            }
        }
    }

    /// Computes the variance for `sum_k gradient_k d theta_k` over the parameters at `places`.
    fn variance(&self, places: &[usize], gradient: &[Complex<f64>]) -> ComplexVariance {
        let mut variance = ComplexVariance { re: 0.0, im: 0.0 };
        for (p, x) in places.iter().zip(gradient) {
            for (q, y) in places.iter().zip(gradient) {
                variance.re += self.covariance[(*p, *q)] * x.re * y.re;
                variance.im += self.covariance[(*p, *q)] * x.im * y.im;
            }
        }
        variance
    }

    /// Computes all responses' standard deviations at `omegas` \[rad/s\]; `None` for fewer
    /// than two frequencies.
    pub(crate) fn bands(
        &self,
        models: &BandModels<'_>,
        omegas: &[f64],
        executor: &dyn Executor,
    ) -> Option<ModelBands> {
        let outputs = models.model.c.nrows();
        let inputs = models.model.b.ncols();
        let points: Vec<ResponsePoint> = omegas
            .iter()
            .map(|&omega| ResponsePoint::new(models, omega))
            .collect();
        // Response by response, outputs first.
        let bands: Vec<PairBands> = each(executor, 0..outputs * inputs, |number| {
            let pair = Pair::new(number % outputs, number / outputs);
            self.pair_bands(models, &points, pair)
        });
        let number = |pair: Pair| pair.input * outputs + pair.output;
        let sd_db = PairTable::from_fn(outputs, inputs, |pair| bands[number(pair)].sd_db.clone());
        let sd_deg = PairTable::from_fn(outputs, inputs, |pair| bands[number(pair)].sd_deg.clone());
        ModelBands::new(omegas.to_vec(), sd_db, sd_deg).ok()
    }

    /// Computes a single response's standard deviations.
    fn pair_bands(
        &self,
        models: &BandModels<'_>,
        points: &[ResponsePoint],
        pair: Pair,
    ) -> PairBands {
        let places = pair_places(models.model, pair);
        let covariance = DMatrix::from_fn(places.len(), places.len(), |row, column| {
            self.covariance[(places[row], places[column])]
        });
        // Real parts, then imaginary parts; columns are frequencies.
        let count = points.len();
        let mut gradients = DMatrix::zeros(places.len(), 2 * count);
        for (k, point) in points.iter().enumerate() {
            let gradient = point.log_gradient(models.model, pair);
            for (row, value) in gradient.into_iter().enumerate() {
                gradients[(row, k)] = value.re;
                gradients[(row, count + k)] = value.im;
            }
        }
        let products = covariance * &gradients;
        let mut bands = PairBands {
            sd_db: Vec::with_capacity(count),
            sd_deg: Vec::with_capacity(count),
        };
        for (k, point) in points.iter().enumerate() {
            let order = point.order_variance[(pair.output, pair.input)];
            let fed_back = match models.feedback {
                Some(feedback) => {
                    let ratio = feedback.ratio(point.omega, (pair.output, pair.input));
                    0.5 * ratio.powi(2)
                }
                None => 0.0,
            };
            let variance_re = products.column(k).dot(&gradients.column(k)).max(0.0);
            let variance_im = products
                .column(count + k)
                .dot(&gradients.column(count + k))
                .max(0.0);
            let sd_re = (MEASURED_FACTOR * (variance_re + order.re) + fed_back).sqrt();
            let sd_im = (MEASURED_FACTOR * (variance_im + order.im) + fed_back).sqrt();
            bands.sd_db.push(neper_to_db(sd_re.min(UNKNOWN)));
            bands.sd_deg.push(sd_im.min(UNKNOWN).to_degrees());
        }
        bands
    }
}

/// Returns a variance's square root, at most `most`; `most` if the variance is not finite.
fn bounded_root(variance: f64, most: f64) -> f64 {
    if variance.is_finite() {
        variance.max(0.0).sqrt().min(most)
    } else {
        most
    }
}

/// Returns the parameter places that a response depends on: the blocks, a `B` column, a
/// `C` row, a `D` entry.
fn pair_places(model: &BlockModel, pair: Pair) -> Vec<usize> {
    let order = model.order();
    let mut places: Vec<usize> = (0..order).collect();
    places.extend((0..order).map(|state| model.place_of_b(state, pair.input)));
    places.extend((0..order).map(|state| model.place_of_c(pair.output, state)));
    places.push(model.place_of_d(pair.output, pair.input));
    places
}

/// A model's responses at a frequency, with the factors of their gradients.
struct ResponsePoint {
    /// \[rad/s\].
    omega: f64,
    /// `H`, outputs x inputs.
    response: DMatrix<Complex<f64>>,
    /// `C R`, outputs x n.
    output_resolvent: DMatrix<Complex<f64>>,
    /// `R B`, n x inputs.
    states: DMatrix<Complex<f64>>,
    /// Mean squares of `Re ln(H_n'/H_n)` and `Im ln(H_n'/H_n)`.
    order_variance: DMatrix<Complex<f64>>,
}

impl ResponsePoint {
    fn new(models: &BandModels<'_>, omega: f64) -> Self {
        let model = models.model;
        let response = model.response(omega);
        let mut output_resolvent = DMatrix::zeros(model.c.nrows(), model.order());
        model.output_resolvent(omega, output_resolvent.as_mut_slice());
        let mut states = model.b.map(Complex::from);
        for mut column in states.column_iter_mut() {
            model.resolve(omega, column.as_mut_slice());
        }
        let count = models.neighbours.len() as f64;
        let mut order_variance = DMatrix::zeros(response.nrows(), response.ncols());
        for neighbour in models.neighbours {
            order_variance += neighbour.response(omega).zip_map(&response, |other, own| {
                let ratio = (other / own).ln();
                Complex::new(finite_square(ratio.re), finite_square(ratio.im)) / count
            });
        }
        Self {
            omega,
            response,
            output_resolvent,
            states,
            order_variance,
        }
    }

    /// Returns the gradient of `ln H`, ordered as in [`pair_places`].
    fn log_gradient(&self, model: &BlockModel, pair: Pair) -> Vec<Complex<f64>> {
        let cr = self.output_resolvent.row(pair.output);
        let x = self.states.column(pair.input);
        let mut gradient = Vec::with_capacity(3 * model.order() + 1);
        for (first, block) in model.rows() {
            match block {
                Block::Pair { .. } => {
                    gradient.push(-cr[first + 1] * x[first]);
                    gradient.push(-cr[first + 1] * x[first + 1]);
                }
                Block::Single(_) => gradient.push(cr[first] * x[first]),
            }
        }
        gradient.extend(cr.iter());
        gradient.extend(x.iter());
        gradient.push(Complex::from(1.0));
        let response = self.response[(pair.output, pair.input)];
        for value in &mut gradient {
            *value = finite_or_unknown(*value / response);
        }
        gradient
    }
}

/// Returns a number squared, or a large value if it is not finite.
fn finite_square(part: f64) -> f64 {
    if part.is_finite() {
        part * part
    } else {
        UNKNOWN
    }
}

/// Returns a number, or a large value if it is not finite.
fn finite_or_unknown(value: Complex<f64>) -> Complex<f64> {
    if value.re.is_finite() && value.im.is_finite() {
        value
    } else {
        Complex::from(UNKNOWN)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;
    use serde_json::Value;

    use gdcm_model::executor::Sequential;
    use gdcm_model::progress::{Shares, Unobserved};
    use gdcm_model::response::frequency_response::log_spaced;
    use gdcm_model::simulation::FlightRecord;

    use super::*;
    use crate::identification::known_answers_tests::{answers, matrix, number, numbers};
    use crate::identification::prepared_data::PreparedData;
    use crate::likelihood::cost::SpectralLines;
    use crate::likelihood::noise_covariance::NoiseCovariance;
    use crate::options::Options;
    use crate::spectra::local_polynomial::local_polynomial;
    use crate::spectra::preparation_settings::Preparation;
    use crate::spectra::spectrum::{Spectrum, spectra};
    use crate::subspace::ct_pbsid::SubspaceSettings;

    /// Reverses the sign of the second of two real modes of a block, which changes the path of the
    /// refinement but not the model.
    fn turned(model: &BlockModel) -> BlockModel {
        let Block::Pair { a0, a1 } = model.blocks[0] else {
            panic!("a pair")
        };
        let poles = model.blocks[0].poles();
        // alpha + beta F has the eigenvalues 1 and -1.
        let beta = 2.0 / (poles[0].re - poles[1].re);
        let alpha = 1.0 - beta * poles[0].re;
        let turn = dmatrix![alpha, beta; -beta * a0, alpha - beta * a1];
        let mut turned = model.clone();
        turned
            .b
            .copy_from(&(turn.clone().try_inverse().unwrap() * &model.b));
        turned.c.copy_from(&(&model.c * turn));
        let ratio = (turned.c.norm() / turned.b.norm()).sqrt();
        turned.b *= ratio;
        turned.c /= ratio;
        turned
    }

    /// Reads the sampled records of a case.
    fn flight_records(known: &Value) -> Vec<FlightRecord> {
        let mut records = Vec::new();
        for record in known["records"].as_array().unwrap() {
            let inputs = matrix(&record["u"]);
            let step_s = number(&record["dt"]);
            records.push(FlightRecord {
                name: String::new(),
                time_s: (0..inputs.nrows())
                    .map(|sample| sample as f64 * step_s)
                    .collect(),
                inputs,
                outputs: matrix(&record["y"]),
            });
        }
        records
    }

    fn whole_numbers(value: &Value) -> Vec<usize> {
        numbers(value)
            .into_iter()
            .map(|value| value as usize)
            .collect()
    }

    #[test]
    fn bands_match_independent_code() {
        let known = &answers()["noisy"];
        let records = flight_records(known);
        let band = numbers(&known["band"]);
        let preparation = Preparation::of(&["U1", "U2"], &["Y1", "Y2"]);
        let options = Options {
            held_out: vec![4],
            ..Options::new([band[0], band[1]], preparation)
        };
        let progress = Shares::new(&Unobserved);
        let data = PreparedData::new(&records, &options, &Sequential, &progress).unwrap();
        // The known answers use all lines around the band, also the first of a record, which does
        // not count here (M14.12).
        let [lowest, highest] = [0.5 * band[0], 4.0 / 3.0 * band[1]];
        let between = |lines: Spectrum| lines.between(lowest / 1.3, 1.3 * highest);
        let wide: Vec<Spectrum> = spectra(&data.unfiltered, 1.3 * highest, &Sequential)
            .into_iter()
            .map(between)
            .collect();
        let measured =
            local_polynomial(&wide, &log_spaced(lowest, highest, 40), &Sequential).unwrap();
        let noise = NoiseCovariance::from_measured(&measured).unwrap();
        let whitened =
            |lines: &Spectrum| SpectralLines::new(&lines.between(lowest, highest), &noise).unwrap();
        let likelihood = &Likelihood {
            segments: wide.iter().map(whitened).collect(),
            executor: &Sequential,
        };
        let poles = numbers(&known["poles_a"]);
        let pasts = whole_numbers(&known["pasts"]);
        let orders = whole_numbers(&known["orders"]);
        let settings = SubspaceSettings {
            highest: band[1],
            poles,
            pasts,
            orders,
            longest_future: 12,
        };
        let candidates = settings
            .candidates(&data.segments, likelihood, &progress)
            .unwrap();
        let starts = settings.starts(&candidates, likelihood);
        let refined = |model: BlockModel, count| {
            Fit::start(likelihood, model)
                .unwrap()
                .refined(likelihood, count, 1e-3, &progress)
        };
        let fit = refined(starts[&4].model.clone(), 8).unwrap();
        let below = refined(turned(&starts[&2].model), 3).unwrap();
        let above = refined(starts[&6].model.clone(), 3).unwrap();

        let system = NormalSystem::sum(fit.model.parameters(), &fit.systems(likelihood).unwrap());
        let spare = likelihood.freedom(4) - fit.effective_parameters();
        let covariance = ParameterCovariance::new(&system, fit.cost / spare as f64).unwrap();
        let expected = &known["expected"];
        let models = BandModels {
            model: &fit.model,
            neighbours: &[&below.model, &above.model],
            feedback: None,
        };
        let bands = covariance
            .bands(&models, &numbers(&expected["w"]), &Sequential)
            .unwrap();
        let tolerance = number(&expected["sd_tolerance_relative"]);
        for (found, name) in [(bands.sd_db(), "sd_db"), (bands.sd_deg(), "sd_deg")] {
            for (Pair { output, input }, found) in found.iter() {
                for (k, found) in found.iter().enumerate() {
                    let expected = matrix(&expected[name][k])[(output, input)];
                    // Independent numpy code; the tolerance is stated in its file.
                    assert!(
                        (found / expected - 1.0).abs() < tolerance,
                        "{name} {k}: {found}, not {expected}"
                    );
                }
            }
        }
    }
}
