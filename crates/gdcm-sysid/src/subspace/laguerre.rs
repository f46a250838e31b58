//! Laguerre filters: projections of a signal's future on the Laguerre functions (M14.3).
//!
//! ```text
//! s_k(t) = int_0^inf l_k(tau) s(t + tau) dtau
//!     l_k <-> sqrt(2a)/(s + a) ((a - s)/(a + s))^k,   k = 0 ... p
//!
//! a the Laguerre pole, dt the sample time, s the signal, tau the time ahead
//!
//! 1  c = 2/dt, g = sqrt(2a)/(a + c), alpha = (a - c)/(a + c)                  (bilinear rule)
//! 2  x = the signal less its last sample, from its end to its beginning
//! 3  y_0[n] = g (x[n] + x[n-1]) - alpha y_0[n-1]                              zero initial state
//! 4  y_k[n] = alpha y_{k-1}[n] + y_{k-1}[n-1] - alpha y_k[n-1]                k = 1 ... p
//! 5  each y_k from its end to its beginning
//! ```
//!
//! M. Bergamasco & M. Lovera, "Continuous-time predictor-based subspace identification using
//! Laguerre filters", IET Control Theory & Applications 5(7), 2011.

use nalgebra::DMatrix;

/// The filters for a Laguerre pole at a sample time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LaguerreBank {
    /// The first filter's gain.
    gain: f64,
    /// Every filter has its pole at `-alpha`; the all-pass filters have their zero at `-1/alpha`.
    alpha: f64,
}

impl LaguerreBank {
    /// Designs the filters with the pole `-pole` rad/s for samples every `sample_time_s` (step 1).
    pub(crate) fn new(pole: f64, sample_time_s: f64) -> Self {
        let c = 2.0 / sample_time_s;
        Self {
            gain: (2.0 * pole).sqrt() / (pole + c),
            alpha: (pole - c) / (pole + c),
        }
    }

    /// Computes the projections at every sample in a signal that ends near 0 (steps 3 to 5), with a
    /// column for each k = 0 ... `past`. The caller subtracts the last sample (step 2).
    pub(crate) fn projections(self, signal: &[f64], past: usize) -> DMatrix<f64> {
        let samples = signal.len();
        let mut projections = DMatrix::zeros(samples, past + 1);
        self.first_filter(signal, &mut projections.as_mut_slice()[..samples]);
        for k in 1..=past {
            let (filtered, remaining) = projections.as_mut_slice().split_at_mut(k * samples);
            self.all_pass(&filtered[(k - 1) * samples..], &mut remaining[..samples]);
        }
        projections
    }

    /// Runs the first filter backwards over `input` (steps 3 and 5).
    fn first_filter(self, input: &[f64], output: &mut [f64]) {
        let mut before = 0.0;
        let mut state = 0.0;
        for (&now, to) in input.iter().zip(output).rev() {
            state = self.gain * (now + before) - self.alpha * state;
            before = now;
            *to = state;
        }
    }

    /// Runs an all-pass filter backwards over `input` (steps 4 and 5).
    fn all_pass(self, input: &[f64], output: &mut [f64]) {
        let mut before = 0.0;
        let mut state = 0.0;
        for (&now, to) in input.iter().zip(output).rev() {
            state = self.alpha * (now - state) + before;
            before = now;
            *to = state;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::known_answers_tests::{answers, matrix, number};

    #[test]
    fn projections_are_those_of_independent_code() {
        let known = &answers()["bank"];
        let signals = matrix(&known["x"]);
        let bank = LaguerreBank::new(number(&known["a"]), number(&known["dt"]));
        let count = number(&known["nk"]) as usize;
        for channel in 0..signals.ncols() {
            let projections = bank.projections(signals.column(channel).as_slice(), count - 1);
            for (sample, expected) in known["expected"].as_array().unwrap().iter().enumerate() {
                for k in 0..count {
                    // Expected values from independent numpy code; their file states the tolerance.
                    assert!(
                        (projections[(sample, k)] - number(&expected[k][channel])).abs() < 1e-12
                    );
                }
            }
        }
    }
}
