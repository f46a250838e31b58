//! Computes the noise covariance from a model's residuals (M14.20).
//!
//! ```text
//! l outputs
//! 1  e(omega): residual of each record, nuisance columns (`cost`) removed, in output units
//!    h(omega): share of the line that the nuisance columns take, at most 0.9
//! 2  at 24 log-spaced frequencies, over the lines of all records:
//!       C = sum a e e^H / sum a (1 - h - k/N)
//!       a = (1 + cos(pi x / w)) / 2,  x = ln(omega/omega_0),  |x| < w
//!       N real values in all lines, k parameters
//!       w = 0.25, times 1.2 until nu = (sum b)^2 / sum b^2 >= 8 l,  b = a (1 - h - k/N),
//!       or until w is twice the range of ln omega
//! 3  C <- (nu C + l diag C) / (nu + l),  plus 1e-4 of its diagonal
//! ```
//!
//! Step 3 shrinks C towards its diagonal, as if that had been observed with l degrees of freedom.
//!
//! The noise that the local polynomial method measures has too few degrees of freedom in short
//! pieces, and is too small near lightly damped modes; a wrong model that follows the noise then
//! costs less than the right one.

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix};

use gdcm_model::executor::each;
use gdcm_model::response::frequency_grid::log_spaced;

use super::cost::{Likelihood, SegmentCost};
use super::noise_covariance::{NoiseCovariance, NoisePoint};
use super::schur_model::SchurModel;
use super::spectral_lines::SpectralLines;
use crate::subspace::tried_orders::parameters_of_order;

/// Number of frequencies at which the covariance is computed.
const POINTS: usize = 24;
/// Upper limit on `h`, the share of a line that the nuisance columns take, so that `1 - h` does not
/// vanish.
const LARGEST_SHARE: f64 = 0.9;
/// First half-width of the Hann weight, in ln omega.
const HALF_WIDTH: f64 = 0.25;
/// Factor on the half-width while there are too few degrees of freedom.
const WIDENING: f64 = 1.2;
/// Minimum degrees of freedom per output.
const FREEDOM_AN_OUTPUT: f64 = 8.0;
/// Share by which the diagonal is raised, to keep the covariance regular.
const DIAGONAL_SHARE: f64 = 1e-4;

/// A line's residual in output units, and the share of the noise power left in it.
struct ResidualLine {
    log_omega: f64,
    /// `e`.
    residual: Vec<Complex<f64>>,
    /// `1 - h - k/N`: the share of the noise power that nuisance columns and parameters leave.
    remaining_share: f64,
}

/// Computes the noise covariance from a model's residuals; `parts` are its segment costs.
///
/// `None` if there are no more values than parameters, if a weight has no inverse, or if the
/// eigenvalue iteration of a segment's nuisance columns does not converge.
pub(crate) fn residual_noise(
    likelihood: &Likelihood,
    model: &SchurModel,
    parts: &[SegmentCost],
) -> Option<NoiseCovariance> {
    let outputs = model.c().nrows();
    let parameters = parameters_of_order(model.order(), model.b().ncols(), outputs);
    let lines: usize = likelihood
        .segments
        .iter()
        .map(|lines| lines.omega.len())
        .sum();
    let values = 2 * outputs * lines;
    if values <= parameters {
        return None;
    }
    let taken_by_model = parameters as f64 / values as f64;
    let resolvents = likelihood.resolvents(model);
    let segments = likelihood.segments.iter().zip(parts);
    // Step 1.
    let lines_of_segments = each(likelihood.executor, segments, |(segment, part)| {
        let shares = segment.transient_shares(model, &resolvents)?;
        residual_lines(segment, part, &shares, taken_by_model)
    });
    let mut lines: Vec<ResidualLine> = Vec::new();
    for lines_of_segment in lines_of_segments {
        lines.extend(lines_of_segment?);
    }
    lines.sort_by(|a, b| a.log_omega.total_cmp(&b.log_omega));
    let lowest = lines.first()?.log_omega.exp();
    let highest = lines.last()?.log_omega.exp();
    // Steps 2 and 3.
    let mut points = Vec::with_capacity(POINTS);
    for omega in log_spaced(lowest, highest, POINTS) {
        points.push(NoisePoint {
            omega,
            covariance: covariance_around(&lines, omega.ln(), outputs),
        });
    }
    NoiseCovariance::new(points)
}

/// Computes the residual at each line in a segment, in output units, with the share of the noise
/// power left (step 1); `None` if a weight has no inverse.
fn residual_lines(
    segment: &SpectralLines,
    part: &SegmentCost,
    shares: &[f64],
    taken_by_model: f64,
) -> Option<Vec<ResidualLine>> {
    let mut lines = Vec::with_capacity(shares.len());
    for (k, (&omega, weight)) in segment.omega.iter().zip(&segment.weights).enumerate() {
        // Divided by the record's noise level, 1 / scale.
        let whitened = part.residual.column(k).scale(segment.scale);
        let residual = weight.solve_lower_triangular(&whitened)?;
        lines.push(ResidualLine {
            log_omega: omega.ln(),
            residual: residual.iter().copied().collect(),
            remaining_share: 1.0 - shares[k].min(LARGEST_SHARE) - taken_by_model,
        });
    }
    Some(lines)
}

/// Computes the covariance around a frequency (steps 2 and 3); `lines` is ascending.
fn covariance_around(
    lines: &[ResidualLine],
    log_omega: f64,
    outputs: usize,
) -> DMatrix<Complex<f64>> {
    let least_freedom = FREEDOM_AN_OUTPUT * outputs as f64;
    let mut half_width = HALF_WIDTH;
    let mut sums = WeightedSums::new(lines, log_omega, half_width, outputs);
    let log_range = lines[lines.len() - 1].log_omega - lines[0].log_omega;
    while sums.freedom() < least_freedom && half_width < 2.0 * log_range {
        half_width *= WIDENING;
        sums = WeightedSums::new(lines, log_omega, half_width, outputs);
    }
    let freedom = sums.freedom();
    // Step 3: l degrees of freedom for the diagonal matrix, so that only the other entries shrink.
    let diagonal_freedom = outputs as f64;
    let mut covariance = sums.products.unscale(sums.weights);
    for row in 0..outputs {
        for column in 0..outputs {
            if row != column {
                covariance[(row, column)] *= freedom / (freedom + diagonal_freedom);
            }
        }
    }
    for o in 0..outputs {
        let variance = covariance[(o, o)].re;
        covariance[(o, o)] = Complex::from(variance * (1.0 + DIAGONAL_SHARE) + f64::MIN_POSITIVE);
    }
    covariance
}

/// Sums over the lines around a frequency.
struct WeightedSums {
    /// `sum a e e^H`.
    products: DMatrix<Complex<f64>>,
    /// `sum b`.
    weights: f64,
    /// `sum b^2`.
    squared_weights: f64,
}

impl WeightedSums {
    fn new(lines: &[ResidualLine], log_omega: f64, half_width: f64, outputs: usize) -> Self {
        let mut sums = Self {
            products: DMatrix::zeros(outputs, outputs),
            weights: 0.0,
            squared_weights: 0.0,
        };
        let first = lines.partition_point(|line| line.log_omega <= log_omega - half_width);
        for line in &lines[first..] {
            let x = line.log_omega - log_omega;
            if x >= half_width {
                break;
            }
            let hann = 0.5 * (1.0 + (PI * x / half_width).cos());
            let weight = hann * line.remaining_share;
            sums.weights += weight;
            sums.squared_weights += weight * weight;
            for (column, second) in line.residual.iter().enumerate() {
                for (row, first) in line.residual.iter().enumerate() {
                    sums.products[(row, column)] += first * second.conj() * hann;
                }
            }
        }
        sums
    }

    /// Returns `nu`, the degrees of freedom.
    fn freedom(&self) -> f64 {
        if self.squared_weights > 0.0 {
            self.weights * self.weights / self.squared_weights
        } else {
            0.0
        }
    }
}
