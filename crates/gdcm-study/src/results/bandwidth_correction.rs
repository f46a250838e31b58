//! A correction's effect on a single response, for the bandwidths under a correction (M17.1).

use gdcm_method::correction::channel_leads::ChannelLeads;
use gdcm_method::correction::{Channel, ChannelCorrection};
use gdcm_method::uncertainty::Scalar;
use gdcm_method::uncertainty::scalar::Figures;
use gdcm_model::dataset::Pair;
use gdcm_model::response::GainDelay;

/// A correction's effect on a response.
#[derive(Clone, Copy)]
pub(super) struct BandwidthCorrection {
    pub(super) multiplier: GainDelay,
    /// Whether a lead filter is included; the corrected response then does not represent the
    /// aircraft above the band.
    pub(super) has_leads: bool,
}

impl BandwidthCorrection {
    pub(super) const NONE: Self = Self {
        multiplier: GainDelay::NONE,
        has_leads: false,
    };

    /// Returns a correction's effect on a response; `None` where the net gain is not positive.
    pub(super) fn from_correction(correction: &ChannelCorrection, pair: Pair) -> Option<Self> {
        let has_leads = Channel::of_pair(pair)
            .into_iter()
            .any(|channel| correction.lead(channel).is_some());
        Some(Self {
            multiplier: correction.on(pair)?,
            has_leads,
        })
    }

    /// Returns the effect of the correction that results if another model replaces a
    /// representative, given by its scalars (M13) and the leads' common parameters; `None` where a
    /// gain or delay is missing.
    pub(super) fn from_scalars(
        scalars: &Figures,
        pair: Pair,
        leads: Option<&ChannelLeads>,
    ) -> Option<Self> {
        // Gains are stored as logarithms.
        let gain = scalars[Scalar::NetGain(pair)]?.exp();
        let [output, input] = Channel::of_pair(pair);
        let taus_s = [
            scalars[Scalar::ChannelDelay(output)]?,
            scalars[Scalar::ChannelDelay(input)]?,
        ];
        // A negative delay is realised by a lead filter (M15.3).
        let filters = taus_s.map(|tau_s| leads.and_then(|leads| leads.design.filter(tau_s)));
        let delay_s = taus_s.iter().map(|tau_s| tau_s.max(0.0)).sum();
        let has_leads = filters.iter().any(Option::is_some);
        Some(Self {
            multiplier: GainDelay::new(gain, delay_s).with_leads(filters),
            has_leads,
        })
    }
}
