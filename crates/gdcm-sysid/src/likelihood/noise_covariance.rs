//! The noise covariance over frequency, and the weights that follow from it (M14.2, M14.4).
//!
//! The *noise* is the part of the outputs' spectral lines that the inputs do not explain: sensor
//! noise and gusts.

use nalgebra::{Complex, DMatrix};

use crate::spectra::interpolation::Neighbours;
use crate::spectra::response_estimate::{EstimatePoint, ResponseEstimate};

/// Weights on a point and its neighbours in the smoothed covariance (M14.2).
const SMOOTHING: [f64; 5] = [1.0, 2.0, 3.0, 2.0, 1.0];
/// Share by which the diagonal is raised, to keep the covariance regular if outputs depend on each
/// other.
const DIAGONAL_SHARE: f64 = 1e-4;
/// Minimum noise variance relative to the output power; even exact data have rounding errors.
const FLOOR: f64 = 1e-16;

/// `Cv` at a frequency.
pub(crate) struct NoisePoint {
    /// \[rad/s\].
    pub(crate) omega: f64,
    /// Hermitian, outputs x outputs.
    pub(crate) covariance: DMatrix<Complex<f64>>,
}

/// `Cv(omega)`, the noise covariance at a line, outputs x outputs.
///
/// Given at some frequencies, interpolated linearly in log frequency, and constant beyond the ends.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseCovariance {
    log_omega: Vec<f64>,
    /// Hermitian.
    covariances: Vec<DMatrix<Complex<f64>>>,
}

impl NoiseCovariance {
    /// Gathers Hermitian covariances, ascending by frequency \[rad/s\]; `None` if there are none.
    pub(crate) fn new(points: Vec<NoisePoint>) -> Option<Self> {
        if points.is_empty() {
            return None;
        }
        let mut covariance = Self {
            log_omega: Vec::with_capacity(points.len()),
            covariances: Vec::with_capacity(points.len()),
        };
        for point in points {
            covariance.log_omega.push(point.omega.ln());
            covariance.covariances.push(point.covariance);
        }
        Some(covariance)
    }

    /// Smooths a measured response's covariances over five neighbours; `None` if it has no points
    /// (M14.2).
    #[must_use]
    pub fn from_measured(measured: &ResponseEstimate) -> Option<Self> {
        let points = &measured.points;
        if points.is_empty() {
            return None;
        }
        Some(Self {
            log_omega: points.iter().map(|point| point.omega.ln()).collect(),
            covariances: (0..points.len())
                .map(|k| smoothed(points, k).map(Complex::from))
                .collect(),
        })
    }

    /// Returns `Cv` at `omega` \[rad/s\].
    #[must_use]
    pub fn at(&self, omega: f64) -> DMatrix<Complex<f64>> {
        let Neighbours {
            before,
            after,
            share,
        } = Neighbours::find(&self.log_omega, omega.ln());
        self.covariances[before].scale(1.0 - share) + self.covariances[after].scale(share)
    }

    /// Returns `W` at `omega` \[rad/s\]: the inverse lower Cholesky factor of `Cv / 2`,
    /// outputs x outputs, lower triangular.
    ///
    /// `W e` has real and imaginary parts with unit variance if `e` is noise (M14.4). `None` if the
    /// covariance is not positive definite in double precision, because the noise's standard
    /// deviation is 1e8 times larger in one combination of outputs than in another.
    #[must_use]
    pub fn weight(&self, omega: f64) -> Option<DMatrix<Complex<f64>>> {
        let lower = self.at(omega).scale(0.5).cholesky()?.unpack();
        let inverse =
            lower.solve_lower_triangular(&DMatrix::identity(lower.nrows(), lower.nrows()))?;
        if inverse.iter().all(|w| w.re.is_finite() && w.im.is_finite()) {
            Some(inverse)
        } else {
            None
        }
    }
}

/// Returns the weighted mean covariance around point `k`, with the raised diagonal.
fn smoothed(points: &[EstimatePoint], k: usize) -> DMatrix<f64> {
    let reach = SMOOTHING.len() / 2;
    let mut sum = points[k].noise.scale(0.0);
    let mut weights = 0.0;
    for (place, weight) in SMOOTHING.iter().enumerate() {
        // Weight 0 belongs to point k - reach. Neighbours beyond either end do not exist.
        let Some(neighbour) = (k + place).checked_sub(reach) else {
            continue;
        };
        if let Some(point) = points.get(neighbour) {
            sum += point.noise.scale(*weight);
            weights += weight;
        }
    }
    let mut covariance = sum / weights;
    for o in 0..covariance.nrows() {
        covariance[(o, o)] +=
            DIAGONAL_SHARE * covariance[(o, o)] + FLOOR * points[k].power[o] + f64::MIN_POSITIVE;
    }
    covariance
}
