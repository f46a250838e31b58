//! Price paid for lead filters: the frequency up to which a corrected model is valid, and the gain
//! that the filters add above it (M15.6).

use gdcm_model::dataset::Pair;

use super::channel_leads::ChannelLeads;
use super::channels::Channels;

/// Frequency, relative to the upper band edge, at which the gain above the band is computed
/// (M15.6).
pub const ABOVE_BAND: f64 = 10.0;

/// Frequency limit for a model with leads, and the gain that the filters add at ten times this
/// frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadPrice {
    /// Upper band edge \[rad/s\]; above it the corrected model is not valid.
    pub limit_rad_s: f64,
    /// `20 log10 |L|` at [`LeadPrice::above_rad_s`] for each channel \[dB\]; 0 for a channel
    /// without a filter.
    pub gains_db: Channels<f64>,
}

impl LeadPrice {
    /// Computes the price paid for leads; `None` if no channel has a filter.
    pub fn new(leads: &ChannelLeads) -> Option<Self> {
        let filters = leads.filters();
        if filters.iter().all(|(_, filter)| filter.is_none()) {
            return None;
        }
        let limit_rad_s = leads.design.band_top_rad_s();
        let gains_db = filters.map(|_, filter| match filter {
            Some(filter) => filter.magnitude_db(ABOVE_BAND * limit_rad_s),
            None => 0.0,
        });
        Some(Self {
            limit_rad_s,
            gains_db,
        })
    }

    /// Returns the price with the larger of both gains for each channel; used for a schedule whose
    /// leads depend on airspeed.
    #[must_use]
    pub fn or_more(self, other: &Self) -> Self {
        let gains_db = self
            .gains_db
            .map(|channel, gain_db| gain_db.max(other.gains_db[channel]));
        Self { gains_db, ..self }
    }

    /// Returns ten times the upper band edge \[rad/s\].
    pub fn above_rad_s(&self) -> f64 {
        ABOVE_BAND * self.limit_rad_s
    }

    /// Returns the gain \[dB\] that the filters on a response's input and output add at
    /// [`LeadPrice::above_rad_s`].
    pub fn of_pair_db(&self, pair: Pair) -> f64 {
        self.gains_db.outputs[pair.output] + self.gains_db.inputs[pair.input]
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::channels::Channel;
    use super::super::lead_design::{LeadDesign, LeadSettings};
    use super::*;

    fn leads(input_s: f64, output_s: f64) -> ChannelLeads {
        let design = LeadDesign::new(
            LeadSettings::default(),
            (1..=120).map(|tenth| 0.1 * f64::from(tenth)).collect(),
        );
        ChannelLeads::new(
            Arc::new(design),
            Channels {
                inputs: vec![input_s],
                outputs: vec![output_s],
            },
        )
    }

    #[test]
    fn a_response_pays_for_the_filters_of_both_its_channels_at_ten_times_the_band() {
        let leads = leads(-0.04, -0.02);
        let price = LeadPrice::new(&leads).expect("both have a filter");
        let pair = Pair {
            output: 0,
            input: 0,
        };
        let [input, output] = [Channel::Input(0), Channel::Output(0)]
            .map(|channel| leads.filters()[channel].expect("a lead").at(120.0).norm());
        let expected = 20.0 * (input * output).log10();
        // Tolerance: rounding of a response compared with the closed form of its magnitude.
        assert!(
            (price.of_pair_db(pair) - expected).abs() < 1e-9,
            "{price:?}"
        );
        assert_eq!(price.limit_rad_s, 12.0);
        assert_eq!(price.above_rad_s(), 120.0);
    }

    #[test]
    fn delays_cost_nothing_and_a_schedule_costs_the_most_of_its_airspeeds() {
        assert_eq!(LeadPrice::new(&leads(0.01, 0.0)), None);
        let input_leads = LeadPrice::new(&leads(-0.04, -0.01)).expect("leads");
        let output_leads = LeadPrice::new(&leads(-0.02, -0.03)).expect("leads");
        let most = input_leads.clone().or_more(&output_leads);
        assert_eq!(most.gains_db.inputs[0], input_leads.gains_db.inputs[0]);
        assert_eq!(most.gains_db.outputs[0], output_leads.gains_db.outputs[0]);
    }
}
