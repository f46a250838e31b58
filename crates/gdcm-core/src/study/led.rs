//! What lead filters leave of the difference between two representatives (M15.5).

use std::sync::Arc;

use crate::correction::{ChannelLeads, delta_gains};
use crate::dataset::{Pair, PairTable};
use crate::fidelity::{Cost, CostAverage, Mismatch};
use crate::response::GainDelay;

/// The physics representative with the leads of its channels against the identified one: what the gains are found on.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadCompensated {
    /// The signed delays with their filters.
    pub leads: ChannelLeads,
    /// Difference of every response that both models have; the pure delays among the leads are not in it.
    pub mismatch: PairTable<Option<Mismatch>>,
    /// G of the led representative, `[output, input]`.
    pub gain: PairTable<Option<f64>>,
}

impl LeadCompensated {
    pub(super) fn of(mismatch: &PairTable<Option<Mismatch>>, leads: &ChannelLeads) -> Arc<Self> {
        let curves = leads.curves();
        let mismatch = mismatch.map(|pair, mismatch| {
            let lead = curves.on(pair);
            lead.map_or_else(
                || mismatch.clone(),
                |lead| mismatch.as_ref().map(|mismatch| mismatch.multiplied(&lead.magnitude_db, &lead.phase)),
            )
        });
        // A pure delay leaves every magnitude.
        let gain = delta_gains(&mismatch);
        Arc::new(Self { leads: leads.clone(), mismatch, gain })
    }

    /// J of every response under what the gains and the pure delays, `correction`, add to the leads.
    pub(super) fn cost(
        &self,
        correction: impl Fn(Pair) -> Option<GainDelay>,
        omega: &[f64],
        average: CostAverage,
    ) -> PairTable<Option<Cost>> {
        self.mismatch.map(|pair, mismatch| Some(mismatch.as_ref()?.cost(omega, correction(pair)?, average)))
    }
}
