//! Benefit of leads for a study that does not use them: J with lead filters in the channels that
//! need them (M15.5).
//!
//! J is the mismatch cost, the sum of a magnitude part and a phase part (M4). A lead filter
//! advances the phase in the band and hardly changes the magnitude there (M15.5), so that the
//! magnitude part is assumed to stay.

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
    /// J under the present correction, without leads.
    pub without: f64,
    /// J with a lead filter in each channel that needs one, and the present gains.
    pub with: f64,
}

impl LeadOffer {
    /// Leads are recommended below this ratio of J with leads to J without. A compromise: the
    /// larger the ratio, the smaller the benefit for which leads are recommended.
    const LARGEST_RATIO: f64 = 0.9;

    /// Returns J without and with these leads if they would reduce J over the constrained responses
    /// by more than a tenth.
    ///
    /// ```text
    /// 1  J of each response under the leads alone (gains of 1): its phase part is that with leads
    /// 2  J without leads: the present cost;  with leads: its magnitude part, and the phase part
    ///    from step 1
    /// 3  means over the responses that have both
    /// ```
    ///
    /// `constrained` contains the mismatches of the constrained responses only; `present` is J
    /// under the present correction.
    pub(crate) fn new(
        leads: ChannelLeads,
        constrained: &Mismatches,
        present: &PairTable<Option<CostChange>>,
        omega: &[f64],
        average: CostAverage,
    ) -> Option<Self> {
        // Step 1.
        let unit_gains = leads.taus_s.map(|_, _| 1.0);
        let leads_alone = ChannelCorrection::of_leads(unit_gains, leads);
        let cost_with_leads = corrected_cost(constrained, &leads_alone, omega, average);
        // Step 2.
        let mut sum_without = 0.0;
        let mut sum_with = 0.0;
        let mut count = 0;
        for (pair, with_leads) in cost_with_leads.iter() {
            if let (Some(with_leads), Some(present)) = (with_leads, present[pair]) {
                sum_without += present.corrected.total();
                sum_with += present.corrected.magnitude + with_leads.phase;
                count += 1;
            }
        }
        // Step 3.
        if count == 0 {
            return None;
        }
        let offer = Self {
            without: sum_without / f64::from(count),
            with: sum_with / f64::from(count),
        };
        if offer.with < Self::LARGEST_RATIO * offer.without {
            Some(offer)
        } else {
            None
        }
    }
}
