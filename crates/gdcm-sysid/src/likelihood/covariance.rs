//! Covariance of the parameters and poles of a model (M14.5).
//!
//! ```text
//! Cov theta = phi G^+,   phi = J / (N - k),   G = sum_r J_r'J_r
//!     eigenvalues of G below 1e-9 of the largest are free scales of the states
//! pole: d lambda = -(d a0 + lambda d a1) / (2 lambda + a1)
//! ```

use nalgebra::{Complex, DMatrix};

use gdcm_model::response::pole_estimate::PoleEstimate;

use super::blocks::{Block, BlockModel};
use super::cost::{Likelihood, SegmentCost};
use super::gram_matrix::pseudo_inverse_root;
use super::normal_system::{NormalSystem, normal_systems};
use super::refinement::Fit;

/// Eigenvalues of the information matrix `G` below this share of the largest belong to
/// unidentifiable directions (state scaling).
const FREE_SCALE: f64 = 1e-9;
/// Maximum reported standard deviation of a pole, relative to its modulus or the lower band end,
/// whichever is larger.
const UNKNOWN: f64 = 1e3;
/// Maximum standard deviation of a determined pole, relative to its modulus.
const DETERMINED: f64 = 0.5;

/// Covariance of the model parameters, and their information matrix.
#[derive(Clone, Debug)]
pub(crate) struct ParameterCovariance {
    /// `phi G^+`.
    covariance: DMatrix<f64>,
    /// `G / phi`.
    information: DMatrix<f64>,
}

/// Variances of the real and the imaginary part.
struct ComplexVariance {
    re: f64,
    im: f64,
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

    /// Computes the covariance of a fit from its normal systems and its cost; `None` if the
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

    /// Computes the covariance of a model from lines other than the fitted lines.
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

    /// Returns the poles of the model with their standard deviations; `lowest` is the lower end of
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

    /// Computes the variance of a pole; `place` is the index of the first parameter of its block.
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

    /// Computes the variance of `sum_k gradient_k d theta_k` over the parameters at `places`.
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

    /// Returns the covariance of the parameters at `places`.
    pub(crate) fn at(&self, places: &[usize]) -> DMatrix<f64> {
        DMatrix::from_fn(places.len(), places.len(), |row, column| {
            self.covariance[(places[row], places[column])]
        })
    }
}

/// Returns the square root of a variance, limited to `most`; `most` if the variance is not finite.
fn bounded_root(variance: f64, most: f64) -> f64 {
    if variance.is_finite() {
        variance.max(0.0).sqrt().min(most)
    } else {
        most
    }
}
