//! What leads cost: where a corrected model ends to be valid, and the gain that the filters add above (M15.6). Whoever tells the price,
//! on the screen or in a file, takes it from here.

use super::{Channel, ChannelLeads, Channels};
use crate::dataset::Pair;
use crate::response::LeadFilter;
use crate::units::{number, signed};

/// Multiple of the band's top at which the gain above the band is told (M15.6).
pub const ABOVE_BAND: f64 = 10.0;
/// What is no gain in a tenth of a decibel.
const NOTHING_DB: f64 = 0.05;

/// Where a model with leads ends to be valid, and the gain at ten times that.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadPrice {
    /// Top of the band \[rad/s\]: above it the corrected model is not valid.
    pub limit_rad_s: f64,
    /// `20 log10 |L|` at [`LeadPrice::above_rad_s`] of each channel \[dB\]; 0 of a channel without a filter.
    pub gains_db: Channels<f64>,
}

impl LeadPrice {
    /// The price of these leads; none where no channel has a filter.
    pub fn of(leads: &ChannelLeads) -> Option<Self> {
        let limit_rad_s = leads.design.band_top_rad_s();
        let gain_db = |filter: LeadFilter| filter.magnitude_db(ABOVE_BAND * limit_rad_s);
        let has_filter = leads.filters().iter().any(|(_, filter)| filter.is_some());
        has_filter.then(|| Self { limit_rad_s, gains_db: leads.filters().map(|_, filter| filter.map_or(0.0, gain_db)) })
    }

    /// The greater of both in every channel: of a schedule, whose leads follow the airspeed.
    #[must_use]
    pub fn or_more(self, other: &Self) -> Self {
        let gains_db = self.gains_db.map(|channel, gain_db| gain_db.max(other.gains_db[channel]));
        Self { gains_db, ..self }
    }

    /// Ten times the band's top \[rad/s\].
    pub fn above_rad_s(&self) -> f64 {
        ABOVE_BAND * self.limit_rad_s
    }

    /// What the filters of a response's two channels add there \[dB\].
    pub fn of_pair_db(&self, pair: Pair) -> f64 {
        Channel::of(pair).map(|channel| self.gains_db[channel]).iter().sum()
    }

    /// "not valid above 12 rad/s".
    pub fn limit_words(&self) -> String {
        format!("not valid above {} rad/s", number(self.limit_rad_s))
    }

    /// The limit, and what each channel with a filter adds: "not valid above 12 rad/s: at 120 rad/s the leads add +9.1 dB on LON, +11.3
    /// dB on LAT; a response gets that of its input and of its output".
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let with_gain = self.gains_db.iter().filter(|(_, gain_db)| **gain_db > NOTHING_DB);
        let gains: Vec<String> = with_gain
            .map(|(channel, &gain_db)| format!("{} dB on {}", signed(gain_db, 1), channel.name(inputs, outputs)))
            .collect();
        if gains.is_empty() {
            return self.limit_words();
        }
        format!(
            "{}: at {} rad/s the leads add {}; a response gets that of its input and of its output",
            self.limit_words(),
            number(self.above_rad_s()),
            gains.join(", ")
        )
    }

    /// "+18.9 dB at 120 rad/s" of a response; none where its channels add nothing.
    pub fn pair_words(&self, pair: Pair) -> Option<String> {
        let gain_db = self.of_pair_db(pair);
        (gain_db > NOTHING_DB).then(|| format!("{} dB at {} rad/s", signed(gain_db, 1), number(self.above_rad_s())))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::correction::{LeadDesign, LeadSettings};

    fn leads(input_s: f64, output_s: f64) -> ChannelLeads {
        let design = LeadDesign::new(LeadSettings::default(), (1..=120).map(|tenth| 0.1 * f64::from(tenth)).collect());
        ChannelLeads::new(Arc::new(design), Channels { inputs: vec![input_s], outputs: vec![output_s] })
    }

    #[test]
    fn a_response_pays_for_the_filters_of_both_its_channels_at_ten_times_the_band() {
        let leads = leads(-0.04, -0.02);
        let price = LeadPrice::of(&leads).expect("both have a filter");
        let pair = Pair { output: 0, input: 0 };
        let of = |channel: Channel| leads.filters()[channel].expect("a lead").at(120.0).norm();
        let expected = 20.0 * (of(Channel::Input(0)) * of(Channel::Output(0))).log10();
        // Roundings of a response against the closed form of its magnitude.
        assert!((price.of_pair_db(pair) - expected).abs() < 1e-9, "{price:?}");
        assert!((price.limit_rad_s, price.above_rad_s()) == (12.0, 120.0), "{price:?}");
        let words = price.words(&["LON".to_owned()], &["Q".to_owned()]);
        assert!(words.starts_with("not valid above 12 rad/s: at 120 rad/s the leads add +"), "{words}");
        assert!(words.contains(" dB on LON, +") && words.contains(" dB on Q;"), "{words}");
    }

    #[test]
    fn delays_cost_nothing_and_a_schedule_costs_the_most_of_its_airspeeds() {
        assert_eq!(LeadPrice::of(&leads(0.01, 0.0)), None);
        let [one, other] = [leads(-0.04, -0.01), leads(-0.02, -0.03)].map(|of| LeadPrice::of(&of).expect("leads"));
        let most = one.clone().or_more(&other);
        assert_eq!(
            (most.gains_db.inputs[0], most.gains_db.outputs[0]),
            (one.gains_db.inputs[0], other.gains_db.outputs[0])
        );
    }
}
