//! What a correction improves: J before and after (M12). J is the cost of the errors in magnitude
//! and phase of a model's response against its reference; a *mismatch* holds these errors
//! (`fidelity`).

use gdcm_model::dataset::{Pair, PairTable};

use crate::correction::ChannelCorrection;
use crate::fidelity::{Cost, CostAverage, Mismatch};

/// J for a response before and after a correction; a negative change is an improvement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostChange {
    pub uncorrected: Cost,
    pub corrected: Cost,
}

impl CostChange {
    /// Returns `Delta J = J(corrected) - J(uncorrected)`.
    pub fn total(self) -> f64 {
        self.corrected.total() - self.uncorrected.total()
    }

    /// Returns `Delta J_mag`.
    pub fn magnitude(self) -> f64 {
        self.corrected.magnitude - self.uncorrected.magnitude
    }

    /// Returns `Delta J_phase`.
    pub fn phase(self) -> f64 {
        self.corrected.phase - self.uncorrected.phase
    }
}

/// Computes J for every model response before and after `correction`, against the model that it was
/// compared with in `mismatch`, at the frequencies `omega` \[rad/s\].
///
/// `None` if a response is not defined, or if its net gain is not positive (possible if `k` itself
/// is regressed).
pub fn assess(
    mismatch: &PairTable<Option<Mismatch>>,
    uncorrected: &PairTable<Option<Cost>>,
    correction: &ChannelCorrection,
    omega: &[f64],
    average: CostAverage,
) -> PairTable<Option<CostChange>> {
    let corrected = corrected_cost(mismatch, correction, omega, average);
    corrected.map(|pair, corrected| {
        Some(CostChange {
            uncorrected: uncorrected[pair]?,
            corrected: (*corrected)?,
        })
    })
}

/// Computes J for every model response after `correction`, against the model that it was compared
/// with in `mismatch`; `None` in the same cases as [`assess`].
pub fn corrected_cost(
    mismatch: &PairTable<Option<Mismatch>>,
    correction: &ChannelCorrection,
    omega: &[f64],
    average: CostAverage,
) -> PairTable<Option<Cost>> {
    mismatch.map(|pair, mismatch| {
        corrected_cost_on(mismatch.as_ref()?, correction, pair, omega, average)
    })
}

/// Computes J for a model response after `correction`; `None` if its net gain is not positive.
pub fn corrected_cost_on(
    mismatch: &Mismatch,
    correction: &ChannelCorrection,
    pair: Pair,
    omega: &[f64],
    average: CostAverage,
) -> Option<Cost> {
    let lead = correction
        .leads
        .as_ref()
        .and_then(|leads| leads.curve(pair));
    let gain_delay = correction.without_leads_on(pair)?;
    let cost = match lead {
        Some(lead) => mismatch
            .multiplied(&lead.magnitude_db, &lead.phase)
            .cost(omega, gain_delay, average),
        None => mismatch.cost(omega, gain_delay, average),
    };
    Some(cost)
}
