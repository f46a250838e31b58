//! Difference between two representatives after the lead filters (M15.5).

use std::sync::Arc;

use gdcm_method::correction::channel_leads::ChannelLeads;
use gdcm_method::correction::delta::delta_gains;
use gdcm_model::dataset::PairTable;

use super::comparison::Mismatches;

/// The physics representative with its channels' lead filters, against the identified
/// representative; the gains are fitted to this difference.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadCompensated {
    /// The signed delays with their filters.
    pub leads: ChannelLeads,
    /// Difference in every response that both models have; signed delays without a filter (pure
    /// delays) are not applied.
    pub mismatch: Mismatches,
    /// The compensated representative's G, `[output, input]`.
    pub gain: PairTable<Option<f64>>,
}

impl LeadCompensated {
    pub(crate) fn new(mismatch: &Mismatches, leads: ChannelLeads) -> Arc<Self> {
        let mismatch = mismatch.map(|pair, mismatch| match leads.curve(pair) {
            None => mismatch.clone(),
            Some(lead) => mismatch
                .as_ref()
                .map(|mismatch| mismatch.multiplied(&lead.magnitude_db, &lead.phase)),
        });
        // A pure delay does not change magnitudes.
        let gain = delta_gains(&mismatch);
        Arc::new(Self {
            leads,
            mismatch,
            gain,
        })
    }
}
