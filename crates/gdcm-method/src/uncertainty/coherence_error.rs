//! Measurement error of a response `H` from its coherence `gamma^2` (M13.2), and hence of the
//! response's delta gain `G` and delta delay `D`, the medians over frequency of the gain and the
//! delay that it needs.

use std::f64::consts::PI;

use gdcm_model::statistics::median;

/// Measurement data that determine the measured response's standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Count of independent averages, `n_d`.
    pub averages: f64,
    /// Window length \[s\], `T_w`. `None` if unknown: all frequencies then have a common error.
    pub window_s: Option<f64>,
    /// `C_epsilon`: 1, or `sqrt(0.55)` for windows that overlap by half, which reduces the error
    /// (Bendat and Piersol).
    pub factor: f64,
}

/// Standard deviations from the coherence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoherenceError {
    /// Standard deviation of `ln G`.
    pub ln_gain: f64,
    /// Standard deviation of `D` \[s\].
    pub delay_s: f64,
}

impl Measurement {
    /// Returns the error's degrees of freedom, `2 n_d`.
    pub fn degrees_of_freedom(&self) -> f64 {
        2.0 * self.averages
    }

    /// Computes the standard deviation of `ln |H|`, which is also that of `arg H` \[rad\]: `epsilon
    /// = C sqrt(1 - gamma^2) / (|gamma| sqrt(2 n_d))`.
    ///
    /// J. S. Bendat and A. G. Piersol, *Random Data*, 4th ed. 2010, chapter 9.
    pub fn deviation(&self, coherence: f64) -> f64 {
        self.factor * ((1.0 - coherence) / (coherence * 2.0 * self.averages)).sqrt()
    }

    /// Computes `kappa`, the factor by which the median over the ascending frequencies `omega`
    /// \[rad/s\] reduces the error; 1 without a window length.
    ///
    /// ```text
    /// kappa = sqrt(min(1, (pi/2) sum_j f_j^2)),   f_j: share of the frequencies in cell j
    /// ```
    ///
    /// A cell is `4 pi / T_w` wide, two frequency steps of the window; the frequencies in it have a
    /// common error. The mean over cells with independent errors has the relative variance
    /// `sum_j f_j^2`, and the median of normal errors `pi/2` times that of the mean.
    fn frequency_averaging(&self, omega: &[f64]) -> f64 {
        let Some(window_s) = self.window_s else {
            return 1.0;
        };
        let cells: Vec<f64> = omega
            .iter()
            .map(|omega| (omega * window_s / (4.0 * PI)).floor())
            .collect();
        let sum: f64 = cells
            .chunk_by(|a, b| a == b)
            .map(|cell| {
                let share = cell.len() as f64 / omega.len() as f64;
                share * share
            })
            .sum();
        (0.5 * PI * sum).min(1.0).sqrt()
    }

    /// Computes the standard errors of `ln G` and `D` over a band from the coherence at ascending
    /// frequencies `omega` \[rad/s\]. Frequencies with zero coherence, or coherence below
    /// `threshold`, are left out; `None` if no frequency remains, or if the average count is not
    /// positive.
    pub fn error(
        &self,
        omega: &[f64],
        coherence: &[f64],
        threshold: f64,
    ) -> Option<CoherenceError> {
        let mut used_omega = Vec::new();
        let mut gain_errors = Vec::new();
        let mut delay_errors = Vec::new();
        for (omega, &coherence) in omega.iter().zip(coherence) {
            if coherence > 0.0 && coherence >= threshold {
                let deviation = self.deviation(coherence);
                used_omega.push(*omega);
                gain_errors.push(deviation);
                delay_errors.push(deviation / *omega);
            }
        }
        if gain_errors.is_empty() || self.averages.is_nan() || self.averages <= 0.0 {
            return None;
        }
        let kappa = self.frequency_averaging(&used_omega);
        Some(CoherenceError {
            ln_gain: kappa * median(&mut gain_errors),
            delay_s: kappa * median(&mut delay_errors),
        })
    }
}
