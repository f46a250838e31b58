//! Delta gain and delta delay: what one gain and one delay of a response would have to be, eq. (5), (9).

use crate::dataset::PairTable;
use crate::fidelity::Mismatch;
use crate::response::{PolarResponse, median};
use crate::units::db_to_ratio;

/// `G = median |H_ref| / |H_sim|` and `D = median Delta phi(H_sim, H_ref) / omega` of every response (M6).
///
/// `None` where the ratio is zero or not finite at some frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Delta {
    /// G, `[output, input]`, dimensionless.
    pub gain: PairTable<Option<f64>>,
    /// D, `[output, input]` \[s\]; positive where the physics model leads, so that delay must be added.
    pub delay_s: PairTable<Option<f64>>,
}

impl Delta {
    /// G and D of the mismatch of two representatives.
    pub fn of(mismatch: &PairTable<Option<Mismatch>>, omega: &[f64]) -> Self {
        let gain = mismatch.map(|_, entry| entry.as_ref().map(|entry| median(&mut ratios(entry))));
        let delay_s = mismatch.map(|_, entry| entry.as_ref().map(|entry| median(&mut delays(entry, omega))));
        Self { gain, delay_s }
    }
}

/// Ratios beyond this (1e300 and 1e-300) are not finite or zero (M6).
const LARGEST_DB: f64 = 6000.0;

/// The mismatch of every response that both models have and whose ratio is finite and not zero.
pub fn mismatch_table(simulated: &PolarResponse, reference: &PolarResponse) -> PairTable<Option<Mismatch>> {
    simulated.curves().map(|pair, simulated| {
        let mismatch = Mismatch::new(simulated.as_ref()?, reference.curves()[pair].as_ref()?);
        mismatch.magnitude_db.iter().all(|error| error.abs() < LARGEST_DB).then_some(mismatch)
    })
}

/// `|H_ref| / |H_sim|` at each frequency.
pub(super) fn ratios(mismatch: &Mismatch) -> Vec<f64> {
    mismatch.magnitude_db.iter().map(|error| db_to_ratio(-error)).collect()
}

/// `Delta phi(H_sim, H_ref) / omega` \[s\] at each frequency, on the branch nearest to a pure delay (M6b).
pub(super) fn delays(mismatch: &Mismatch, omega: &[f64]) -> Vec<f64> {
    mismatch.phase_difference(omega).iter().zip(omega).map(|(phase, omega)| phase / omega).collect()
}
