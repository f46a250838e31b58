//! One gain and one delay for each channel, and what they do to a response (M10).

use nalgebra::Complex;

use crate::dataset::{Pair, PairTable};

/// The correction `M_O H M_I`, each channel `k e^(-tau s)`, eq. (12).
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelCorrection {
    /// Gain of each input channel, m values.
    pub input_gains: Vec<f64>,
    /// Gain of each output channel, p values.
    pub output_gains: Vec<f64>,
    /// Delay of each input channel \[s\], m values.
    pub input_delays_s: Vec<f64>,
    /// Delay of each output channel \[s\], p values.
    pub output_delays_s: Vec<f64>,
}

impl ChannelCorrection {
    /// Net gain of a response, `k_o k_i` (M11).
    pub fn net_gain(&self, pair: Pair) -> f64 {
        self.output_gains[pair.output] * self.input_gains[pair.input]
    }

    /// Net delay of a response, `tau_o + tau_i` \[s\].
    pub fn net_delay_s(&self, pair: Pair) -> f64 {
        self.output_delays_s[pair.output] + self.input_delays_s[pair.input]
    }

    /// The corrected responses `k_o k_i e^(-j omega (tau_o + tau_i)) H(j omega)`: exact in frequency, no Pade.
    pub fn apply(&self, values: &PairTable<Vec<Complex<f64>>>, omega: &[f64]) -> PairTable<Vec<Complex<f64>>> {
        values.map(|pair, values| {
            let (gain, delay) = (self.net_gain(pair), self.net_delay_s(pair));
            values.iter().zip(omega).map(|(value, omega)| value * Complex::from_polar(gain, -omega * delay)).collect()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_multiplies_the_magnitude_and_delays_the_phase() {
        let correction = ChannelCorrection {
            input_gains: vec![2.0],
            output_gains: vec![1.5],
            input_delays_s: vec![0.01],
            output_delays_s: vec![0.04],
        };
        let values = PairTable::filled(1, 1, vec![Complex::new(1.0, 0.0)]);
        let corrected = &correction.apply(&values, &[10.0])[Pair::new(0, 0)][0];
        assert!((corrected.norm() - 3.0).abs() < 1e-15 && (corrected.arg() + 0.5).abs() < 1e-15);
    }
}
