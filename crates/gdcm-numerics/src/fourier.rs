//! Fourier transforms for real signals.

use std::sync::Arc;

use nalgebra::Complex;
use realfft::{RealFftPlanner, RealToComplex};

/// Plans Fourier transforms; transforms with equal lengths share their twiddle factors.
#[derive(Default)]
pub struct FourierPlanner(RealFftPlanner<f64>);

/// Fourier transform for real signals with a fixed length.
#[derive(Clone)]
pub struct FourierTransform(Arc<dyn RealToComplex<f64>>);

impl FourierPlanner {
    /// Plans a transform for signals with `length` samples.
    pub fn plan(&mut self, length: usize) -> FourierTransform {
        FourierTransform(self.0.plan_fft_forward(length))
    }
}

impl FourierTransform {
    /// Computes `X_k = sum_n x[n] e^(-2 pi j k n / N)` for k = 0 ... N / 2; `None` for a signal with
    /// another length. The samples are overwritten.
    pub fn transform(&self, samples: &mut [f64]) -> Option<Vec<Complex<f64>>> {
        let mut lines = self.0.make_output_vec();
        self.0.process(samples, &mut lines).ok()?;
        Some(lines)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cosine_with_two_periods_has_only_line_two() {
        let mut samples: Vec<f64> = (0..12)
            .map(|n| (std::f64::consts::TAU * f64::from(n) / 6.0).cos())
            .collect();
        let transform = FourierPlanner::default().plan(12);
        let lines = transform.transform(&mut samples).unwrap();
        for (k, line) in lines.iter().enumerate() {
            let expected = Complex::from(if k == 2 { 6.0 } else { 0.0 });
            assert!((line - expected).norm() < 1e-14, "line {k}: {line}");
        }
        assert!(transform.transform(&mut [0.0; 5]).is_none());
    }
}
