//! Benefit of leads for a study that does not use them: J with lead filters in the channels that
//! need them (M15.5).

use gdcm_method::correction::ChannelCorrection;
use gdcm_method::correction::channel_leads::ChannelLeads;
use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::CostChange;
use gdcm_method::schedule::assessment::corrected_cost;
use gdcm_model::dataset::PairTable;

use super::comparison::Mismatches;

/// Mean J over the constrained responses, all of which need lead: under the present correction, and
/// with leads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadOffer {
    /// J under the present correction.
    pub without: f64,
    /// J with a lead filter in each channel that needs one; the gains are kept, because such
    /// filters change them little.
    pub with: f64,
}

impl LeadOffer {
    /// Leads are recommended below this ratio of J with leads to J without.
    const WORTH: f64 = 0.9;

    /// Returns J without and with these leads if they would reduce J over the constrained responses
    /// by more than a tenth. `mismatch` contains the constrained responses only; `now` is J under
    /// the present correction.
    pub(crate) fn new(
        leads: ChannelLeads,
        mismatch: &Mismatches,
        now: &PairTable<Option<CostChange>>,
        omega: &[f64],
        average: CostAverage,
    ) -> Option<Self> {
        let phase_alone = ChannelCorrection::of_leads(leads.taus_s.map(|_, _| 1.0), leads);
        let left = corrected_cost(mismatch, &phase_alone, omega, average);
        let mut without = 0.0;
        let mut with = 0.0;
        let mut count = 0;
        for (pair, left) in left.iter() {
            if let (Some(left), Some(now)) = (left, now[pair]) {
                without += now.corrected.total();
                with += now.corrected.magnitude + left.phase;
                count += 1;
            }
        }
        if count == 0 {
            return None;
        }
        let offer = Self {
            without: without / f64::from(count),
            with: with / f64::from(count),
        };
        if offer.with < Self::WORTH * offer.without {
            Some(offer)
        } else {
            None
        }
    }
}
