//! Standard deviations of a model's responses (M14.5).
//!
//! ```text
//! var Re(dH/H), Im(dH/H) = h' Cov h, h the real or imaginary part of the gradient of ln H_oi
//! sd^2 = 2 (sd_GN^2 + sd_order^2) + |G_b/G|^2 / 2
//!     sd_order = rms of Re and Im ln(H_n'/H_n) over neighbouring orders
//!     |G_b/G| the fed-back share of the response (M14.17)
//! ```
//!
//! The factor 2 was measured: with it, 95 % bands hold 95 % of the true curves.

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::executor::{Executor, each};
use gdcm_model::units::neper_to_db;

use super::feedback::Feedback;
use crate::likelihood::blocks::{Block, BlockModel};
use crate::likelihood::covariance::ParameterCovariance;
use crate::likelihood::linear_model::LinearModel;

/// Half-width of a two-sided 95 % confidence interval, in standard deviations.
pub const TWO_SIDED_95: f64 = 1.96;
/// Factor on the variances from the fit and from the order, found by measurement (M14.5).
pub(crate) const MEASURED_FACTOR: f64 = 2.0;
/// Maximum reported standard deviation, in neper and radians.
pub(crate) const UNKNOWN: f64 = 1e3;

/// A model, and the causes of its uncertainty besides the fit.
pub(crate) struct BandModels<'a> {
    pub(crate) model: &'a BlockModel,
    /// Models with neighbouring orders.
    pub(crate) neighbours: &'a [BlockModel],
    pub(crate) feedback: Option<&'a Feedback>,
}

/// Standard deviations of a single response over frequency.
struct PairBands {
    sd_db: Vec<f64>,
    sd_deg: Vec<f64>,
}

impl BandModels<'_> {
    /// Computes the standard deviations of all responses at `omegas` \[rad/s\]; `None` for fewer
    /// than two frequencies.
    pub(crate) fn bands(
        &self,
        covariance: &ParameterCovariance,
        omegas: &[f64],
        executor: &dyn Executor,
    ) -> Option<ModelBands> {
        let outputs = self.model.c.nrows();
        let inputs = self.model.b.ncols();
        let points: Vec<ResponsePoint> = omegas
            .iter()
            .map(|&omega| ResponsePoint::new(self, omega))
            .collect();
        // One entry for each response; the output index runs fastest.
        let bands: Vec<PairBands> = each(executor, 0..outputs * inputs, |number| {
            let pair = Pair::new(number % outputs, number / outputs);
            self.pair_bands(covariance, &points, pair)
        });
        let sd_db = PairTable::from_fn(outputs, inputs, |pair| {
            bands[pair.input * outputs + pair.output].sd_db.clone()
        });
        let sd_deg = PairTable::from_fn(outputs, inputs, |pair| {
            bands[pair.input * outputs + pair.output].sd_deg.clone()
        });
        ModelBands::new(omegas.to_vec(), sd_db, sd_deg).ok()
    }

    /// Computes the standard deviations of a single response.
    fn pair_bands(
        &self,
        covariance: &ParameterCovariance,
        points: &[ResponsePoint],
        pair: Pair,
    ) -> PairBands {
        let places = pair_places(self.model, pair);
        // Real parts, then imaginary parts; columns are frequencies.
        let count = points.len();
        let mut gradients = DMatrix::zeros(places.len(), 2 * count);
        for (k, point) in points.iter().enumerate() {
            let gradient = point.log_gradient(self.model, pair);
            for (row, value) in gradient.into_iter().enumerate() {
                gradients[(row, k)] = value.re;
                gradients[(row, count + k)] = value.im;
            }
        }
        let products = covariance.at(&places) * &gradients;
        let mut bands = PairBands {
            sd_db: Vec::with_capacity(count),
            sd_deg: Vec::with_capacity(count),
        };
        for (k, point) in points.iter().enumerate() {
            let order = point.order_variance[(pair.output, pair.input)];
            let fed_back = match self.feedback {
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

/// Returns the indices of the parameters on which a response depends: the blocks, a `B` column, a
/// `C` row, a `D` entry.
fn pair_places(model: &BlockModel, pair: Pair) -> Vec<usize> {
    let order = model.order();
    let mut places: Vec<usize> = (0..order).collect();
    places.extend((0..order).map(|state| model.place_of_b(state, pair.input)));
    places.extend((0..order).map(|state| model.place_of_c(pair.output, state)));
    places.push(model.place_of_d(pair.output, pair.input));
    places
}

/// Responses of a model at a frequency, with the factors of their gradients.
struct ResponsePoint {
    omega: f64,
    /// `H`, outputs x inputs.
    response: DMatrix<Complex<f64>>,
    /// `C R`, outputs x n.
    output_resolvent: DMatrix<Complex<f64>>,
    /// `R B`, n x inputs.
    states: DMatrix<Complex<f64>>,
    /// Mean squares of `Re ln(H_n'/H_n)` (real part) and `Im ln(H_n'/H_n)` (imaginary part).
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

/// Returns `part` squared; `UNKNOWN` if it is not finite.
fn finite_square(part: f64) -> f64 {
    if part.is_finite() {
        part * part
    } else {
        UNKNOWN
    }
}

/// Returns `value`; `UNKNOWN` if it is not finite.
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
    use gdcm_model::response::frequency_grid::log_spaced;
    use gdcm_model::simulation::FlightRecord;

    use super::*;
    use crate::identification::candidates::SubspaceSettings;
    use crate::identification::known_answers_tests::{answers, matrix, number, numbers};
    use crate::identification::prepared_data::PreparedData;
    use crate::likelihood::cost::{Likelihood, SpectralLines};
    use crate::likelihood::noise_covariance::NoiseCovariance;
    use crate::likelihood::normal_system::NormalSystem;
    use crate::likelihood::refinement::Fit;
    use crate::options::Options;
    use crate::spectra::local_polynomial::local_polynomial;
    use crate::spectra::preparation_settings::Preparation;
    use crate::spectra::spectrum::{Spectrum, spectra};

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
        // The reference code uses all lines around the band, including the first line of a record,
        // which this crate does not use (M14.12).
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
        let likelihood = &Likelihood::new(wide.iter().map(whitened).collect(), &Sequential);
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
            neighbours: &[below.model.clone(), above.model.clone()],
            feedback: None,
        };
        let bands = models
            .bands(&covariance, &numbers(&expected["w"]), &Sequential)
            .unwrap();
        let tolerance = number(&expected["sd_tolerance_relative"]);
        for (found, name) in [(bands.sd_db(), "sd_db"), (bands.sd_deg(), "sd_deg")] {
            for (Pair { output, input }, found) in found.iter() {
                for (k, found) in found.iter().enumerate() {
                    let expected = matrix(&expected[name][k])[(output, input)];
                    // Reference results from independent numpy code; the file states the tolerance.
                    assert!(
                        (found / expected - 1.0).abs() < tolerance,
                        "{name} {k}: {found}, not {expected}"
                    );
                }
            }
        }
    }
}
