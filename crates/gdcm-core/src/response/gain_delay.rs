//! What the correction of two channels does to a response, eq. (12), M15.5.

use crate::units::ratio_to_db;

use super::lead_filter::LeadFilter;

/// `k e^(-j omega tau) L_o L_i`: what the correction multiplies a response by (eq. (12), M10), with the lead filters of its output
/// and its input where they have one (M15). Exact in frequency, no Pade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainDelay {
    gain_db: f64,
    delay_s: f64,
    leads: [Option<LeadFilter>; 2],
}

impl GainDelay {
    /// Leaves a response as it is.
    pub const NONE: Self = Self { gain_db: 0.0, delay_s: 0.0, leads: [None; 2] };

    /// A positive gain (ratio) and a delay \[s\].
    pub fn new(gain: f64, delay_s: f64) -> Self {
        Self { gain_db: ratio_to_db(gain), delay_s, leads: [None; 2] }
    }

    /// With these lead filters in series.
    pub fn led(self, leads: [Option<LeadFilter>; 2]) -> Self {
        Self { leads, ..self }
    }

    /// Magnitudes \[dB\] at `omega` after it: `20 log10 k` more, and what the filters add.
    pub fn magnitudes_db(self, magnitudes_db: &[f64], omega: &[f64]) -> impl Iterator<Item = f64> {
        magnitudes_db.iter().zip(omega).map(move |(magnitude, omega)| {
            let filters = self.leads.iter().flatten();
            filters.fold(magnitude + self.gain_db, |sum, filter| sum + filter.magnitude_db(*omega))
        })
    }

    /// Phases \[rad\] at `omega` after it: `omega tau` less, and what the filters add.
    pub fn phases(self, phases: &[f64], omega: &[f64]) -> impl Iterator<Item = f64> {
        phases.iter().zip(omega).map(move |(phase, omega)| {
            let filters = self.leads.iter().flatten();
            filters.fold(phase - omega * self.delay_s, |sum, filter| sum + filter.phase(*omega))
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
        assert_eq!(correction.magnitudes_db(&[-6.0], &[10.0]).collect::<Vec<_>>(), [14.0]);
        assert_eq!(correction.phases(&[1.0, 1.0], &[10.0, 20.0]).collect::<Vec<_>>(), [0.5, 0.0]);
        assert_eq!(GainDelay::new(1.0, 0.0), GainDelay::NONE);
    }

    #[test]
    fn the_filters_of_both_channels_add_up() {
        let filter = |lead_s: f64| LeadFilter::new(LeadOrder::Second, lead_s, 0.03);
        let both = GainDelay::NONE.led([Some(filter(0.02)), Some(filter(0.05))]);
        let expected = filter(0.02).phase(9.0) + filter(0.05).phase(9.0);
        assert_eq!(both.phases(&[0.0], &[9.0]).collect::<Vec<_>>(), [expected]);
    }
}
