//! Computes the covariance of a model's parameters and poles (M14.5, M14.22).
//!
//! ```text
//! Cov theta = max(phi, 1) G^-1,   phi = J / (N - k)
//!    theta: local parameters, as many entries of [A B; C D] as the response has degrees of freedom
//!    (`local_parameters`),   G: their normal matrix, the information about them (`local_system`)
//!    J cost, N degrees of freedom (`cost`), k parameters;   lambda a pole
//! pole:      d lambda = w^H dA v,   w^H A = lambda w^H,  A v = lambda v,  w^H v = 1
//! response:  dH = [C R, I] d[A B; C D] [R B; I],   R = (j omega - A)^-1
//! ```
//!
//! phi below 1 means that the noise was overestimated, which does not make the model more certain.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::response::pole_estimate::{POLE_INTERVAL, PoleEstimate};

use super::cost::{Likelihood, SegmentCost};
use super::descent::Fit;
use super::gram_matrix::pseudo_inverse_root;
use super::local_parameters::LocalParameters;
use super::local_system::{LocalSystem, LocalSystems};
use super::schur_model::SchurModel;

/// Eigenvalues of `G`, with columns of unit length, below this share of the largest are rounding
/// errors.
const ROUNDING: f64 = 1e-13;
/// Largest standard deviation that is reported for a pole, relative to its modulus or the lower
/// band end, whichever is larger.
const UNKNOWN: f64 = 1e3;
/// A pole is determined if its interval has at most this half-width, relative to its modulus.
const DETERMINED: f64 = 0.5;

/// The model parameters' covariance and information matrix.
#[derive(Clone, Debug)]
pub(crate) struct ParameterCovariance {
    parameters: LocalParameters,
    /// `F` with `F F' = max(phi, 1) G^-1`, the covariance.
    root: DMatrix<f64>,
    /// `G / max(phi, 1)`.
    information: DMatrix<f64>,
}

impl ParameterCovariance {
    /// Computes the covariance for the dispersion `phi`; `None` if the eigenvalue iteration does
    /// not converge.
    pub(crate) fn new(systems: &LocalSystems, dispersion: f64) -> Option<Self> {
        let LocalSystem { matrix, .. } = systems.whole();
        let dispersion = dispersion.max(1.0);
        Some(Self {
            parameters: systems.parameters.clone(),
            root: pseudo_inverse_root(matrix.clone(), ROUNDING)? * dispersion.sqrt(),
            information: matrix / dispersion,
        })
    }

    /// Computes a model's covariance from lines other than the fitted lines; `None` if the cost or
    /// the normal equations are not finite, if an eigenvalue iteration does not converge, or if
    /// there are no degrees of freedom.
    pub(crate) fn from_lines(likelihood: &Likelihood, model: &SchurModel) -> Option<Self> {
        let fit = Fit::start(likelihood, model.clone())?;
        let systems = LocalSystems::new(likelihood, &fit)?;
        Self::new(&systems, fit.dispersion(likelihood)?)
    }

    /// Computes the cost over other records with the model free to move within its uncertainty:
    /// `e'e - g' (G / max(phi, 1) + G_o)^-1 g` (M14.17), with the residual e and the normal
    /// equations `G_o`, `g` of the other records.
    pub(crate) fn cost_within_uncertainty(
        &self,
        records: &Likelihood,
        model: &SchurModel,
        parts: &[SegmentCost],
    ) -> Option<f64> {
        let systems = LocalSystems::in_parameters(self.parameters.clone(), records, model, parts)?;
        let system = systems.whole();
        let root = pseudo_inverse_root(&self.information + &system.matrix, ROUNDING)?;
        let cost: f64 = parts.iter().map(|part| part.cost).sum();
        Some(cost - root.tr_mul(&system.gradient).norm_squared())
    }

    /// Computes the variances of the real and imaginary parts of `l' d[A B; C D] r` for many pairs
    /// of vectors: `left` holds a vector l (states, outputs) and `right` a vector r (states,
    /// inputs) in each column. In theta, this is `sum_p l_row(p) r_column(p) d theta_p`.
    pub(crate) fn variances(
        &self,
        left: &DMatrix<Complex<f64>>,
        right: &DMatrix<Complex<f64>>,
    ) -> Vec<ComplexVariance> {
        let count = left.ncols();
        // Real parts, then imaginary parts.
        let mut gradients = DMatrix::zeros(self.parameters.count(), 2 * count);
        for k in 0..count {
            for (p, entry) in self.parameters.entries.iter().enumerate() {
                let product = left[(entry.row, k)] * right[(entry.column, k)];
                gradients[(p, k)] = product.re;
                gradients[(p, count + k)] = product.im;
            }
        }
        let whitened = self.root.tr_mul(&gradients);
        let squares: Vec<f64> = whitened
            .column_iter()
            .map(|column| column.norm_squared())
            .collect();
        (0..count)
            .map(|k| ComplexVariance {
                re: squares[k],
                im: squares[count + k],
            })
            .collect()
    }

    /// Returns the model's poles with their standard deviations; `band` is the frequency band
    /// \[rad/s\].
    ///
    /// A pole is determined if its modulus is within the band, and its interval is at most half the
    /// modulus to each side. Above the band, a pole of the model represents several true poles, of
    /// servos and sensors, to which it need not be near.
    pub(crate) fn poles(&self, model: &SchurModel, band: [f64; 2]) -> Vec<PoleEstimate> {
        let [lowest, highest] = band;
        let (outputs, inputs) = model.d().shape();
        let mut estimates = Vec::new();
        for (number, pole) in model.poles().into_iter().enumerate() {
            let vectors = model.eigenvectors(number);
            let left = with_zeros(&vectors.left, outputs);
            let right = with_zeros(&vectors.right, inputs);
            let most = UNKNOWN * pole.norm().max(lowest);
            let mut sd_re = most;
            let mut sd_im = most;
            if let [variance] = self.variances(&left, &right).as_slice() {
                sd_re = bounded_root(variance.re, most);
                sd_im = bounded_root(variance.im, most);
            }
            if pole.im == 0.0 {
                sd_im = 0.0;
            }
            let is_sharp = POLE_INTERVAL * sd_re.hypot(sd_im) <= DETERMINED * pole.norm();
            estimates.push(PoleEstimate {
                pole,
                sd_re,
                sd_im,
                determined: (lowest..=highest).contains(&pole.norm()) && is_sharp,
            });
        }
        estimates
    }
}

/// Variances of a complex number's real and imaginary part.
pub(crate) struct ComplexVariance {
    pub(crate) re: f64,
    pub(crate) im: f64,
}

/// Appends zeros to a vector, as a single-column matrix.
fn with_zeros(vector: &DVector<Complex<f64>>, zeros: usize) -> DMatrix<Complex<f64>> {
    let mut column = DMatrix::zeros(vector.len() + zeros, 1);
    column.rows_mut(0, vector.len()).copy_from(vector);
    column
}

/// Returns the square root of a variance, limited to `most`; `most` if the variance is not finite.
fn bounded_root(variance: f64, most: f64) -> f64 {
    if variance.is_finite() {
        variance.max(0.0).sqrt().min(most)
    } else {
        most
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use super::*;
    use crate::identification::known_answers_tests::{answers, known_records, matrix};
    use crate::likelihood::local_parameters::Entry;
    use crate::likelihood::normal_equations::{EXACT, NormalEquations};

    /// Variances of a response and of the poles do not depend on which entries are the parameters.
    #[test]
    fn variances_are_the_same_for_any_selection_of_parameters() {
        let known = &answers()["likelihood_noise_free"];
        let likelihood = known_records(known);
        let [a, b, c, d] = ["A", "B", "C", "D"].map(|name| matrix(&known["start"][name]));
        let fit = Fit::start(&likelihood, SchurModel::new(a, b, c, d).unwrap()).unwrap();
        let equations = NormalEquations::new(&likelihood, &fit.model, &fit.parts, EXACT).unwrap();
        let first = LocalParameters::select(&fit.model, &equations.matrix);
        // Without the first entry in A, another takes its place.
        let mut without = equations.matrix.clone();
        let is_in_a = |entry: &Entry| entry.row < 4 && entry.column < 4;
        let in_a = first.entries.iter().position(is_in_a).unwrap();
        let place = first.places()[in_a];
        without.row_mut(place).fill(0.0);
        without.column_mut(place).fill(0.0);
        let second = LocalParameters::select(&fit.model, &without);
        assert_eq!(first.count(), fit.model.parameters());
        assert_eq!(second.count(), first.count());
        let mut cr = DMatrix::zeros(2, 4);
        fit.model.output_resolvent(2.0, cr.as_mut_slice());
        let covariances = [first, second].map(|parameters| {
            let systems =
                LocalSystems::in_parameters(parameters, &likelihood, &fit.model, &fit.parts)
                    .unwrap();
            ParameterCovariance::new(&systems, 1.0).unwrap()
        });
        // dH_00 at 2 rad/s.
        let mut rows = DMatrix::zeros(6, 1);
        rows.rows_mut(0, 4).copy_from(&cr.row(0).transpose());
        rows[4] = Complex::from(1.0);
        let states = fit.model.states(
            &[2.0],
            &dmatrix![Complex::from(1.0); Complex::from(0.0)],
            &DVector::zeros(4),
        );
        let mut columns = DMatrix::zeros(6, 1);
        columns.rows_mut(0, 4).copy_from(&states);
        columns[4] = Complex::from(1.0);
        let [response, other] = covariances
            .each_ref()
            .map(|covariance| covariance.variances(&rows, &columns)[0].re);
        // The normal equations have condition numbers of 1e8.
        assert!((response / other - 1.0).abs() < 1e-6, "{response} {other}");
        let [poles, others] = covariances
            .each_ref()
            .map(|covariance| covariance.poles(&fit.model, [0.1, 100.0]));
        for (pole, other) in poles.iter().zip(&others) {
            assert!((pole.sd_re / other.sd_re - 1.0).abs() < 1e-6);
        }
    }
}
