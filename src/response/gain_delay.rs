//! One gain and one delay acting on a response, eq. (12).

use crate::units::ratio_to_db;

/// `k e^(-j omega tau)`: what the correction multiplies a response by (eq. (12), M10). Exact in frequency, no Pade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainDelay {
    gain_db: f64,
    delay_s: f64,
}

impl GainDelay {
    /// Leaves a response as it is.
    pub const NONE: Self = Self { gain_db: 0.0, delay_s: 0.0 };

    /// A positive gain (ratio) and a delay \[s\].
    pub fn new(gain: f64, delay_s: f64) -> Self {
        Self { gain_db: ratio_to_db(gain), delay_s }
    }

    /// Magnitudes \[dB\] after it: `20 log10 k` more.
    pub fn magnitudes_db(self, magnitudes_db: &[f64]) -> impl Iterator<Item = f64> {
        magnitudes_db.iter().map(move |magnitude| magnitude + self.gain_db)
    }

    /// Phases \[rad\] at `omega` after it: `omega tau` less.
    pub fn phases(self, phases: &[f64], omega: &[f64]) -> impl Iterator<Item = f64> {
        phases.iter().zip(omega).map(move |(phase, omega)| phase - omega * self.delay_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_multiplies_the_magnitude_and_delays_the_phase() {
        let correction = GainDelay::new(10.0, 0.05);
        assert_eq!(correction.magnitudes_db(&[-6.0]).collect::<Vec<_>>(), [14.0]);
        assert_eq!(correction.phases(&[1.0, 1.0], &[10.0, 20.0]).collect::<Vec<_>>(), [0.5, 0.0]);
        assert_eq!(GainDelay::new(1.0, 0.0), GainDelay::NONE);
    }
}
