//! The error of a measured response that its coherence tells (M13.2).

use std::f64::consts::PI;

use crate::response::median;

/// How a response was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Number of independent averages, `n_d`.
    pub averages: f64,
    /// Length of the windows \[s\], `T_w`; none where it is not known: the whole band then has one error.
    pub window_s: Option<f64>,
    /// `C_epsilon`: 1, or the root of 0.55 for windows that overlap by half.
    pub factor: f64,
}

/// Standard deviations of ln G and of D \[s\] that coherence tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoherenceError {
    /// Of ln G.
    pub ln_gain: f64,
    /// Of D \[s\].
    pub delay_s: f64,
}

impl Measurement {
    /// Degrees of freedom of an error that coherence tells, `2 n_d`.
    pub fn degrees(&self) -> f64 {
        2.0 * self.averages
    }

    /// `epsilon = C sqrt(1 - gamma^2) / (|gamma| sqrt(2 n_d))`: standard deviation of `ln |H|` and, in rad, of `arg H`.
    ///
    /// J. S. Bendat and A. G. Piersol, *Random Data*, 4th ed. (2010), section 9.
    fn deviation(&self, coherence: f64) -> f64 {
        self.factor * ((1.0 - coherence) / (coherence * 2.0 * self.averages)).sqrt()
    }

    /// `kappa = sqrt(min(1, (pi/2) sum f_j^2))` with `f_j` the share of the frequencies \[rad/s\] with
    /// `floor(omega T_w / (4 pi)) = j`: errors of frequencies closer than `4 pi / T_w` are one error.
    fn averaging(&self, omega: &[f64]) -> f64 {
        let Some(window_s) = self.window_s else { return 1.0 };
        let cell = |omega: &f64| (omega * window_s / (4.0 * PI)).floor();
        let shares = omega.chunk_by(|a, b| cell(a) == cell(b)).map(|chunk| chunk.len() as f64 / omega.len() as f64);
        (0.5 * PI * shares.map(|share| share * share).sum::<f64>()).min(1.0).sqrt()
    }

    /// The error over a band of `omega` \[rad/s\], rising, at which the response has these coherences; frequencies with less than
    /// `threshold`, or none at all, are left out. None where none is left.
    pub fn error(&self, omega: &[f64], coherence: &[f64], threshold: f64) -> Option<CoherenceError> {
        let is_measured = |coherence: f64| coherence > 0.0 && coherence >= threshold;
        let measured = || omega.iter().zip(coherence).filter(|(_, coherence)| is_measured(**coherence));
        let mut gains: Vec<f64> = measured().map(|(_, &coherence)| self.deviation(coherence)).collect();
        let mut delays: Vec<f64> = measured().map(|(omega, &coherence)| self.deviation(coherence) / omega).collect();
        if gains.is_empty() || self.averages.is_nan() || self.averages <= 0.0 {
            return None;
        }
        let kappa = self.averaging(omega);
        Some(CoherenceError { ln_gain: kappa * median(&mut gains), delay_s: kappa * median(&mut delays) })
    }
}
