//! What a correction is worth: J before and after (M12).

use crate::correction::ChannelCorrection;
use crate::dataset::PairTable;
use crate::fidelity::{Cost, CostAverage, Mismatch};

/// J of one response before and after a correction; negative changes are better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostChange {
    /// J of the physics model as it is.
    pub uncorrected: Cost,
    /// J of the corrected physics model.
    pub corrected: Cost,
}

impl CostChange {
    /// `Delta J = J(corrected) - J(uncorrected)`.
    pub fn total(self) -> f64 {
        self.corrected.total() - self.uncorrected.total()
    }

    /// `Delta J_mag`.
    pub fn magnitude(self) -> f64 {
        self.corrected.magnitude - self.uncorrected.magnitude
    }

    /// `Delta J_phase`.
    pub fn phase(self) -> f64 {
        self.corrected.phase - self.uncorrected.phase
    }
}

/// J of every response of a model before and after `correction`, against the model it was compared with in `mismatch`.
///
/// `None` where a response is not defined, or where its net gain is not positive (a schedule of `k` itself can give that).
pub fn assess(
    mismatch: &PairTable<Option<Mismatch>>,
    uncorrected: &PairTable<Option<Cost>>,
    correction: &ChannelCorrection,
    omega: &[f64],
    average: CostAverage,
) -> PairTable<Option<CostChange>> {
    let corrected = corrected_cost(mismatch, correction, omega, average);
    corrected.map(|pair, corrected| Some(CostChange { uncorrected: uncorrected[pair]?, corrected: (*corrected)? }))
}

/// J of every response of a model after `correction`, against the model it was compared with in `mismatch`; none where [`assess`]
/// has none.
pub fn corrected_cost(
    mismatch: &PairTable<Option<Mismatch>>,
    correction: &ChannelCorrection,
    omega: &[f64],
    average: CostAverage,
) -> PairTable<Option<Cost>> {
    mismatch.map(|pair, mismatch| {
        let (mismatch, leads) = (mismatch.as_ref()?, correction.leads.as_ref());
        let led = leads.and_then(|leads| leads.curve(pair));
        let led = led.map(|lead| mismatch.multiplied(&lead.magnitude_db, &lead.phase));
        Some(led.as_ref().unwrap_or(mismatch).cost(omega, correction.without_leads_on(pair)?, average))
    })
}
