//! Computes standard deviations for a model's responses over frequency, its *bands* (M14.5).
//!
//! ```text
//! ln H_oi = log modulus [neper] + j phase [rad],   H_oi response of output o to input i
//! sd^2 = 2 (sd_fit^2 + sd_order^2) + |G_b/G|^2 / 2,   for modulus and phase alike; at most 1e3
//!
//! 1  sd_fit^2 = h' Cov h from the fit alone: Cov covariance of the parameters (`covariance`),
//!    h real (modulus) or imaginary part (phase) of the gradient of ln H_oi, that is of dH_oi/H_oi:
//!    dH = [C R, I] d[A B; C D] [R B; I],   R = (j omega I - A)^-1
//! 2  sd_order = rms of the real or imaginary part of ln(H_n'/H_n) over neighbouring orders n': on
//!    each side of n the nearest order whose BIC is within 10 % (`order`)
//! 3  |G_b/G| the fed-back share of the response, half of its square for modulus and phase each
//!    (`feedback`; M14.14, M14.17)
//! ```
//!
//! The factor 2 was measured: with it, 95 % of the true curves lie within 95 % bands.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::executor::{Executor, each};
use gdcm_model::units::neper_to_db;

use super::feedback::Feedback;
use crate::likelihood::covariance::ParameterCovariance;
use crate::likelihood::schur_model::SchurModel;

/// Half-width, in standard deviations, that gives a two-sided 95 % confidence interval.
pub const TWO_SIDED_95: f64 = 1.96;
/// Factor on the variances from the fit and between orders, found by measurement (M14.5).
pub(crate) const MEASURED_FACTOR: f64 = 2.0;
/// Largest standard deviation that is reported, in neper and radians; it also replaces intermediate
/// values that are not finite, because any large number says the same.
pub(crate) const UNKNOWN: f64 = 1e3;

/// A model, and the sources of its uncertainty besides the fit.
pub(crate) struct BandModels<'a> {
    pub(crate) model: &'a SchurModel,
    /// Models with neighbouring orders.
    pub(crate) neighbours: &'a [SchurModel],
    pub(crate) feedback: Option<&'a Feedback>,
}

/// Standard deviations over frequency for a single response.
struct PairBands {
    sd_db: Vec<f64>,
    sd_deg: Vec<f64>,
}

impl BandModels<'_> {
    /// Computes all responses' standard deviations at `omegas` \[rad/s\]; `None` for fewer than two
    /// frequencies.
    pub(crate) fn bands(
        &self,
        covariance: &ParameterCovariance,
        omegas: &[f64],
        executor: &dyn Executor,
    ) -> Option<ModelBands> {
        let outputs = self.model.c().nrows();
        let inputs = self.model.b().ncols();
        let points = each(executor, omegas, |&omega| ResponsePoint::new(self, omega));
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

    /// Computes a response's standard deviations at all frequencies.
    fn pair_bands(
        &self,
        covariance: &ParameterCovariance,
        points: &[ResponsePoint],
        pair: Pair,
    ) -> PairBands {
        let count = points.len();
        let order = self.model.order();
        // Step 1: dH_oi/H_oi = left' d[A B; C D] right at each frequency, with [C R, I]_o / H_oi on
        // the left and [R B; I]_i on the right.
        let mut left = DMatrix::zeros(order + self.model.c().nrows(), count);
        let mut right = DMatrix::zeros(order + self.model.b().ncols(), count);
        for (k, point) in points.iter().enumerate() {
            let response = point.response[(pair.output, pair.input)];
            for state in 0..order {
                let cr = point.output_resolvent[(pair.output, state)];
                left[(state, k)] = finite_or_unknown(cr / response);
                right[(state, k)] = point.states[(state, pair.input)];
            }
            left[(order + pair.output, k)] = finite_or_unknown(1.0 / response);
            right[(order + pair.input, k)] = Complex::from(1.0);
        }
        let variances = covariance.variances(&left, &right);
        let mut bands = PairBands {
            sd_db: Vec::with_capacity(count),
            sd_deg: Vec::with_capacity(count),
        };
        // Steps 2 and 3.
        for (point, variance) in points.iter().zip(variances) {
            let between_orders = point.order_variance[(pair.output, pair.input)];
            let fed_back = match self.feedback {
                Some(feedback) => {
                    let ratio = feedback.ratio(point.omega, (pair.output, pair.input));
                    0.5 * ratio.powi(2)
                }
                None => 0.0,
            };
            let sd_re = (MEASURED_FACTOR * (variance.re + between_orders.re) + fed_back).sqrt();
            let sd_im = (MEASURED_FACTOR * (variance.im + between_orders.im) + fed_back).sqrt();
            bands.sd_db.push(neper_to_db(sd_re.min(UNKNOWN)));
            bands.sd_deg.push(sd_im.min(UNKNOWN).to_degrees());
        }
        bands
    }
}

/// A model's responses at a frequency, with the factors in their gradients.
struct ResponsePoint {
    omega: f64,
    /// `H`, outputs x inputs.
    response: DMatrix<Complex<f64>>,
    /// `C R`, outputs x n.
    output_resolvent: DMatrix<Complex<f64>>,
    /// `R B`, n x inputs.
    states: DMatrix<Complex<f64>>,
    /// Over the neighbouring orders n', the mean square of `Re ln(H_n'/H_n)` (real part) and of `Im
    /// ln(H_n'/H_n)` (imaginary part).
    order_variance: DMatrix<Complex<f64>>,
}

impl ResponsePoint {
    fn new(models: &BandModels<'_>, omega: f64) -> Self {
        let model = models.model;
        let response = model.response(omega);
        let mut output_resolvent = DMatrix::zeros(model.c().nrows(), model.order());
        model.output_resolvent(omega, output_resolvent.as_mut_slice());
        let inputs = model.b().ncols();
        // The states for a unit input in each channel, without transient.
        let unit_inputs = DMatrix::identity(inputs, inputs);
        let no_transient = DVector::zeros(model.order());
        let states = model.states(&vec![omega; inputs], &unit_inputs, &no_transient);
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
