//! The covariance of the noise over frequency, and the weight that comes of it.

use super::MeasuredResponse;
use nalgebra::{Complex, DMatrix};

/// Weights of a point and its neighbours in the smoothed covariance (M14, 2).
const SMOOTHING: [f64; 5] = [1.0, 2.0, 3.0, 2.0, 1.0];
/// Share of the diagonal added to it, so that outputs that depend on each other do not make the covariance singular (M14, 2).
const ADDED: f64 = 1e-4;
/// The least variance of the noise over the power of the output: exact data have noise of rounding alone.
const FLOOR: f64 = 1e-16;

/// `Cv(omega)`, covariance of the noise of a line, outputs x outputs: the covariances of a measured response smoothed over
/// five neighbours, linear in log frequency between them and constant beyond them (M14, 2).
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseCovariance {
    log_omega: Vec<f64>,
    covariances: Vec<DMatrix<f64>>,
}

impl NoiseCovariance {
    /// The covariance of the noise of `measured`; none where it has no points.
    #[must_use]
    pub fn of(measured: &MeasuredResponse) -> Option<Self> {
        let points = &measured.points;
        let smoothed = |k: usize| {
            let reach = SMOOTHING.len() / 2;
            let (mut sum, mut weights) = (points[k].noise.scale(0.0), 0.0);
            for (weight, neighbour) in SMOOTHING.iter().zip(k..) {
                if let Some(point) = neighbour.checked_sub(reach).and_then(|neighbour| points.get(neighbour)) {
                    sum += point.noise.scale(*weight);
                    weights += weight;
                }
            }
            let mut covariance = sum / weights;
            for o in 0..covariance.nrows() {
                covariance[(o, o)] += ADDED * covariance[(o, o)] + FLOOR * points[k].power[o] + f64::MIN_POSITIVE;
            }
            covariance
        };
        let log_omega = points.iter().map(|point| point.omega.ln()).collect();
        let covariances = (0..points.len()).map(smoothed).collect();
        (!points.is_empty()).then_some(Self { log_omega, covariances })
    }

    /// `Cv` at `omega` \[rad/s\].
    #[must_use]
    pub fn at(&self, omega: f64) -> DMatrix<f64> {
        let x = omega.ln();
        let after = self.log_omega.partition_point(|&w| w <= x);
        if after == 0 {
            return self.covariances[0].clone();
        }
        let before = after - 1;
        let Some(next) = self.covariances.get(after) else {
            return self.covariances[before].clone();
        };
        let share = (x - self.log_omega[before]) / (self.log_omega[after] - self.log_omega[before]);
        self.covariances[before].scale(1.0 - share) + next.scale(share)
    }

    /// `W` at `omega`: the inverse of the lower Cholesky factor of `Cv / 2`, outputs x outputs, lower triangular.
    ///
    /// `W e` has real and imaginary parts of variance one each where `e` is noise (M14, 4). None where the covariance is not
    /// positive definite, which takes noise that is 1e8 times stronger in one combination of outputs than in another.
    #[must_use]
    pub fn weight(&self, omega: f64) -> Option<DMatrix<f64>> {
        let lower = self.at(omega).scale(0.5).cholesky()?.unpack();
        let inverse = lower.solve_lower_triangular(&DMatrix::identity(lower.nrows(), lower.nrows()))?;
        inverse.iter().all(|w| w.is_finite()).then_some(inverse)
    }

    /// `W e` for a vector of lines `e`, one an output; see [`Self::weight`].
    #[must_use]
    pub fn whitened(weight: &DMatrix<f64>, lines: &[Complex<f64>]) -> Vec<Complex<f64>> {
        let row = |o: usize| (0..=o).map(|k| lines[k] * weight[(o, k)]).sum();
        (0..weight.nrows().min(lines.len())).map(row).collect()
    }
}
