//! Corrects a response by the gains, delays and lead filters of its two channels (eq. (12), M15.5).

use nalgebra::Complex;

use super::lead_filter::LeadFilter;
use crate::units::{db_to_ratio, ratio_to_db};

/// A response's correction factor `k e^(-j omega tau) L_o L_i` (eq. (12), M10): `k` is the product
/// of the gains of its output and its input channel, `tau` the sum of their delays, and `L_o` and
/// `L_i` are their optional lead filters (M15). The delay is exact, not a Padé approximation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainDelay {
    /// `20 log10 k`.
    gain_db: f64,
    /// `tau`.
    delay_s: f64,
    /// Lead filters for the output and the input.
    leads: [Option<LeadFilter>; 2],
}

impl GainDelay {
    /// No correction: gain 1, no delay, no lead filters.
    pub const NONE: Self = Self {
        gain_db: 0.0,
        delay_s: 0.0,
        leads: [None; 2],
    };

    /// Creates a correction without lead filters from a positive gain (ratio, not dB) and a delay
    /// \[s\].
    pub fn new(gain: f64, delay_s: f64) -> Self {
        Self {
            gain_db: ratio_to_db(gain),
            delay_s,
            leads: [None; 2],
        }
    }

    /// Returns the correction with its lead filters (for output and input) replaced.
    pub fn with_leads(self, leads: [Option<LeadFilter>; 2]) -> Self {
        Self { leads, ..self }
    }

    /// Returns the complex correction factor at `omega` \[rad/s\].
    pub fn at(self, omega: f64) -> Complex<f64> {
        let mut value = Complex::from_polar(db_to_ratio(self.gain_db), -omega * self.delay_s);
        for filter in self.leads.iter().flatten() {
            value *= filter.at(omega);
        }
        value
    }

    /// Returns the corrected magnitudes \[dB\] at `omega`: adds `20 log10 k` and the filter
    /// magnitudes.
    pub fn magnitudes_db(self, magnitudes_db: &[f64], omega: &[f64]) -> impl Iterator<Item = f64> {
        magnitudes_db
            .iter()
            .zip(omega)
            .map(move |(magnitude, omega)| {
                let mut corrected = magnitude + self.gain_db;
                for filter in self.leads.iter().flatten() {
                    corrected += filter.magnitude_db(*omega);
                }
                corrected
            })
    }

    /// Returns the corrected phases \[rad\] at `omega`: subtracts `omega tau` and adds the filter
    /// phases.
    pub fn phases(self, phases: &[f64], omega: &[f64]) -> impl Iterator<Item = f64> {
        phases.iter().zip(omega).map(move |(phase, omega)| {
            let mut corrected = phase - omega * self.delay_s;
            for filter in self.leads.iter().flatten() {
                corrected += filter.phase(*omega);
            }
            corrected
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::LeadOrder;

    #[test]
    fn a_correction_multiplies_the_magnitude_and_delays_the_phase() {
        let correction = GainDelay::new(10.0, 0.05);
        assert_eq!(
            correction
                .magnitudes_db(&[-6.0], &[10.0])
                .collect::<Vec<_>>(),
            [14.0]
        );
        assert_eq!(
            correction
                .phases(&[1.0, 1.0], &[10.0, 20.0])
                .collect::<Vec<_>>(),
            [0.5, 0.0]
        );
        assert_eq!(GainDelay::new(1.0, 0.0), GainDelay::NONE);
    }

    #[test]
    fn the_filters_of_both_channels_add_up() {
        let filter = |lead_s: f64| LeadFilter::new(LeadOrder::Second, lead_s, 0.03);
        let both = GainDelay::NONE.with_leads([Some(filter(0.02)), Some(filter(0.05))]);
        let expected = filter(0.02).phase(9.0) + filter(0.05).phase(9.0);
        assert_eq!(both.phases(&[0.0], &[9.0]).collect::<Vec<_>>(), [expected]);
    }
}
