//! How near the loop of a feedback is to ringing, and what it does above the band (M16.4).

use nalgebra::{Complex, DMatrix};

use super::CouplingMatrices;
use crate::dataset::{Pair, PairTable};
use crate::response::FrequencyResponse;
use crate::units::ratio_to_db;

/// The least singular value of `I - K H` over some frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopMargin {
    /// The least: 1 of no feedback, 0 where a pole of the closed loop is at `j omega`.
    pub least: f64,
    /// Where it is \[rad/s\].
    pub omega_rad_s: f64,
}

impl LoopMargin {
    /// Under this the loop is close to ringing.
    pub const CAUTION: f64 = 0.5;

    /// The least of these singular values at `omega` \[rad/s\]; none where no value is finite.
    pub fn of(singular_values: &[f64], omega: &[f64]) -> Option<Self> {
        let known = singular_values.iter().zip(omega).filter(|(least, _)| least.is_finite());
        let (&least, &omega_rad_s) = known.min_by(|a, b| a.0.total_cmp(b.0))?;
        Some(Self { least, omega_rad_s })
    }

    /// Whether it is a caution.
    pub fn is_close_to_ringing(&self) -> bool {
        self.least < Self::CAUTION
    }
}

impl CouplingMatrices {
    /// The least singular value of `I - K H` (m x m, at the sticks, where all channels have one unit) at each frequency of `H`; not a
    /// number where `H` lacks a response of an output that is fed back.
    pub fn least_singular_values(&self, physics: &FrequencyResponse) -> Vec<f64> {
        let points = physics.curve(Pair::new(0, 0)).len();
        (0..points).map(|k| self.least_singular_value(physics, k)).collect()
    }

    fn least_singular_value(&self, physics: &FrequencyResponse, k: usize) -> f64 {
        let (inputs, outputs) = self.feedback().shape();
        let fed = |input: usize, of: usize| -> Complex<f64> {
            let terms = (0..outputs).map(|output| (self.feedback()[(input, output)], output));
            // A response that is not fed back need not be there.
            let terms = terms.filter(|(entry, _)| *entry != 0.0);
            terms.map(|(entry, output)| physics.curve(Pair::new(output, of))[k] * entry).sum()
        };
        let unit = |input: usize, of: usize| if input == of { 1.0 } else { 0.0 };
        let difference = DMatrix::from_fn(inputs, inputs, |input, of| -fed(input, of) + unit(input, of));
        if !difference.iter().all(|entry| entry.is_finite()) {
            return f64::NAN;
        }
        difference.singular_values().min()
    }
}

/// `20 log10 |H~ - H| / |H|` of each response at the `k`-th frequency, p x m; none where one is not finite or `H` is zero,
/// minus infinity where nothing changes.
pub fn relative_change_db(
    physics: &FrequencyResponse,
    coupled: &FrequencyResponse,
    k: usize,
) -> PairTable<Option<f64>> {
    physics.curves().map(|pair, curve| {
        let (before, after) = (curve.get(k)?, coupled.curve(pair).get(k)?);
        let ratio = (after - before).norm() / before.norm();
        ratio.is_finite().then(|| ratio_to_db(ratio))
    })
}
