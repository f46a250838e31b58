//! Lead filters: the filter of a signed delay (M15.3), the filters of all channels (M15.5), and
//! their cost: the frequency above which a corrected model is no longer valid, and the gain that
//! the filters add above it (M15.6). Screens and files take the cost from here.

use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::Pair;
use gdcm_model::response::{LeadFilter, LeadOrder};
use gdcm_model::units::{number, signed};

use super::channels::{Channel, Channels};
use super::delta::band_delay_s;

/// Settings shared by the lead filters of all channels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeadSettings {
    pub order: LeadOrder,
    /// `n`: the lag time constant is `b = 1 / (n omega_B)`, `omega_B` the top of the band.
    #[serde(rename = "n")]
    pub pole: f64,
    /// `R_max`: greatest gain of one channel's filter at high frequency (ratio).
    #[serde(rename = "r_max")]
    pub limit: f64,
}

impl Default for LeadSettings {
    /// Second order, n = 3, R_max = 10 (20 dB).
    fn default() -> Self {
        Self {
            order: LeadOrder::Second,
            pole: 3.0,
            limit: 10.0,
        }
    }
}

/// The lead filters that a band allows: exactly one for each signed delay below zero (M15.3).
#[derive(Clone, Debug, PartialEq)]
pub struct LeadDesign {
    settings: LeadSettings,
    omega: Arc<[f64]>,
    lower_s: f64,
}

impl LeadDesign {
    /// The design over these frequencies \[rad/s\], rising and positive; at least one.
    pub fn new(settings: LeadSettings, omega: Arc<[f64]>) -> Self {
        let mut design = Self {
            settings,
            omega,
            lower_s: 0.0,
        };
        design.lower_s = design.band_delay_s(design.longest_lead_s());
        design
    }

    /// Settings shared by the filters.
    pub fn settings(&self) -> LeadSettings {
        self.settings
    }

    /// The frequencies \[rad/s\] over which a filter's band delay is taken.
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// `omega_B` \[rad/s\], the top of the band.
    pub fn band_top_rad_s(&self) -> f64 {
        self.omega.last().copied().unwrap_or(1.0)
    }

    /// `b` \[s\].
    pub fn lag_s(&self) -> f64 {
        1.0 / (self.settings.pole * self.band_top_rad_s())
    }

    /// `l_max` \[s\], the lead time at which `R = R_max`.
    pub fn longest_lead_s(&self) -> f64 {
        let LeadSettings { order, limit, .. } = self.settings;
        match order {
            LeadOrder::First => self.lag_s() * (limit - 1.0),
            LeadOrder::Second => std::f64::consts::SQRT_2 * self.lag_s() * (limit.sqrt() - 1.0),
        }
    }

    /// `LB_tau = d(l_max)` \[s\]: the least signed delay of a channel.
    pub fn lower_s(&self) -> f64 {
        self.lower_s
    }

    /// Returns the filter of a lead time \[s\].
    pub fn filter_of(&self, lead_s: f64) -> LeadFilter {
        LeadFilter::new(self.settings.order, lead_s, self.lag_s())
    }

    /// `d(l) = - sum omega arg L / sum omega^2` \[s\], the band delay of the filter of lead time
    /// `l` (M15.2): 0 at 0, strictly falling.
    pub fn band_delay_s(&self, lead_s: f64) -> f64 {
        let filter = self.filter_of(lead_s);
        -band_delay_s(
            self.omega.iter().map(|&omega| filter.phase(omega)),
            &self.omega,
            None,
        )
    }

    /// `-d d(l) / d l`, dimensionless: with `x = a omega` the mean of `(1 + x^2) / (1 + x^4)`, or
    /// of `1 / (1 + x^2)` for the first order.
    fn falling(&self, lead_s: f64) -> f64 {
        let a = self.filter_of(lead_s).zero_s;
        let of = |omega: f64| {
            let square = (a * omega).powi(2);
            match self.settings.order {
                LeadOrder::First => omega / (1.0 + square),
                LeadOrder::Second => omega * (1.0 + square) / (1.0 + square * square),
            }
        };
        band_delay_s(self.omega.iter().map(|&omega| of(omega)), &self.omega, None)
    }

    /// Returns the filter of a negative signed delay, otherwise `None`. A signed delay below the
    /// bound gets the filter of `R_max`.
    pub fn filter(&self, tau_s: f64) -> Option<LeadFilter> {
        (tau_s < 0.0).then(|| self.filter_of(self.lead_s(tau_s)))
    }

    /// The lead time `l` with `d(l) = tau` \[s\], to 1e-14 of it; `l_max` of a `tau` below the
    /// bound.
    ///
    /// ```text
    /// low, high = 0, l_max;  l = tau / d'(0), cut to them
    /// repeat
    ///     miss = d(l) - tau;  low or high = l, by the sign of miss: d falls
    ///     l' = l - miss / d'(l);  the middle of low and high where l' is not between them
    ///     l = l';  end where it changed by less than 1e-9 of itself: Newton's error is then the square of that
    /// ```
    ///
    /// Newton's method kept inside a bracket (Press et al., "Numerical Recipes", 3rd ed. 2007,
    /// 9.4).
    pub fn lead_s(&self, tau_s: f64) -> f64 {
        const STEPS: usize = 100;
        const SMALL: f64 = 1e-9;
        let mut low = 0.0;
        let mut high = self.longest_lead_s();
        if tau_s >= 0.0 {
            return 0.0;
        }
        if tau_s <= self.lower_s {
            return high;
        }
        let mut lead_s = (-tau_s / self.falling(0.0)).min(high);
        for _ in 0..STEPS {
            let miss_s = self.band_delay_s(lead_s) - tau_s;
            if miss_s > 0.0 {
                low = lead_s;
            } else {
                high = lead_s;
            }
            let newton_s = lead_s + miss_s / self.falling(lead_s);
            let next_s = if (low..=high).contains(&newton_s) {
                newton_s
            } else {
                0.5 * (low + high)
            };
            let step_s = (next_s - lead_s).abs();
            lead_s = next_s;
            if step_s <= SMALL * lead_s {
                break;
            }
        }
        lead_s
    }
}

/// One signed delay for each channel: a pure delay where positive, a lead filter where negative
/// (M15.5).
///
/// Filters, and their curves over the band, are computed on first use, once for all clones.
#[derive(Clone, Debug)]
pub struct ChannelLeads {
    /// Design that gives the filter of a signed delay.
    pub design: Arc<LeadDesign>,
    /// Signed delay of each channel \[s\].
    pub taus_s: Channels<f64>,
    filters: Arc<OnceLock<Channels<Option<LeadFilter>>>>,
    curves: Arc<OnceLock<Channels<Option<LeadCurve>>>>,
}

impl PartialEq for ChannelLeads {
    /// Cached filters follow from these two fields.
    fn eq(&self, other: &Self) -> bool {
        (&self.taus_s, &self.design) == (&other.taus_s, &other.design)
    }
}

impl ChannelLeads {
    /// Signed delays \[s\] with the filters of `design`.
    pub fn new(design: Arc<LeadDesign>, taus_s: Channels<f64>) -> Self {
        Self {
            design,
            taus_s,
            filters: Arc::default(),
            curves: Arc::default(),
        }
    }

    /// Lead filter of each channel; `None` where its signed delay is not negative.
    pub fn filters(&self) -> &Channels<Option<LeadFilter>> {
        self.filters
            .get_or_init(|| self.taus_s.map(|_, &tau_s| self.design.filter(tau_s)))
    }

    /// Pure delay of each channel \[s\], the positive part of its signed delay.
    pub fn delays_s(&self) -> Channels<f64> {
        self.taus_s.map(|_, tau_s| tau_s.max(0.0))
    }

    /// Effect of the filters of a response's two channels at each frequency of the design's band;
    /// `None` where neither has a filter.
    pub fn curve(&self, pair: Pair) -> Option<LeadCurve> {
        let of_filter = |filter: LeadFilter| LeadCurve::of(filter, self.design.omega());
        let curves = self
            .curves
            .get_or_init(|| self.filters().map(|_, filter| filter.map(of_filter)));
        match (&curves.inputs[pair.input], &curves.outputs[pair.output]) {
            (Some(input), Some(output)) => Some(input.in_series(output)),
            (one, other) => one.as_ref().or(other.as_ref()).cloned(),
        }
    }
}

/// Magnitude \[dB\] and phase \[rad\] of a filter or of two in series.
#[derive(Clone, Debug)]
pub struct LeadCurve {
    /// `20 log10 |L|` at each frequency.
    pub magnitude_db: Vec<f64>,
    /// `arg L` at each frequency, continuous.
    pub phase: Vec<f64>,
}

impl LeadCurve {
    fn of(filter: LeadFilter, omega: &[f64]) -> Self {
        Self {
            magnitude_db: omega
                .iter()
                .map(|&omega| filter.magnitude_db(omega))
                .collect(),
            phase: omega.iter().map(|&omega| filter.phase(omega)).collect(),
        }
    }

    fn in_series(&self, other: &Self) -> Self {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Self {
            magnitude_db: sum(&self.magnitude_db, &other.magnitude_db),
            phase: sum(&self.phase, &other.phase),
        }
    }
}

/// Multiple of the band's top at which the gain above the band is reported (M15.6).
pub const ABOVE_BAND: f64 = 10.0;
/// Gain that counts as zero when rounded to a tenth of a decibel.
const NOTHING_DB: f64 = 0.05;

/// Validity limit of a model with leads, and the gain at ten times that frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadPrice {
    /// Top of the band \[rad/s\]: above it the corrected model is not valid.
    pub limit_rad_s: f64,
    /// `20 log10 |L|` at [`LeadPrice::above_rad_s`] for each channel \[dB\]; 0 for a channel
    /// without a filter.
    pub gains_db: Channels<f64>,
}

impl LeadPrice {
    /// Computes the price of these leads; `None` where no channel has a filter.
    pub fn of(leads: &ChannelLeads) -> Option<Self> {
        let limit_rad_s = leads.design.band_top_rad_s();
        let gain_db = |filter: LeadFilter| filter.magnitude_db(ABOVE_BAND * limit_rad_s);
        let has_filter = leads.filters().iter().any(|(_, filter)| filter.is_some());
        has_filter.then(|| Self {
            limit_rad_s,
            gains_db: leads.filters().map(|_, filter| filter.map_or(0.0, gain_db)),
        })
    }

    /// Returns the greater of both gains for each channel, as needed by a schedule whose leads
    /// follow the airspeed.
    #[must_use]
    pub fn or_more(self, other: &Self) -> Self {
        let gains_db = self
            .gains_db
            .map(|channel, gain_db| gain_db.max(other.gains_db[channel]));
        Self { gains_db, ..self }
    }

    /// Ten times the band's top \[rad/s\].
    pub fn above_rad_s(&self) -> f64 {
        ABOVE_BAND * self.limit_rad_s
    }

    /// Gain \[dB\] that the filters of a response's two channels add at `above_rad_s`.
    pub fn of_pair_db(&self, pair: Pair) -> f64 {
        Channel::of(pair)
            .map(|channel| self.gains_db[channel])
            .iter()
            .sum()
    }

    /// "not valid above 12 rad/s".
    pub fn limit_words(&self) -> String {
        format!("not valid above {} rad/s", number(self.limit_rad_s))
    }

    /// Describes the limit and the gain of each channel with a filter: "not valid above 12 rad/s:
    /// at 120 rad/s the leads add +9.1 dB on LON, +11.3 dB on LAT; a response gets that of its
    /// input and of its output".
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let with_gain = self
            .gains_db
            .iter()
            .filter(|(_, gain_db)| **gain_db > NOTHING_DB);
        let gains: Vec<String> = with_gain
            .map(|(channel, &gain_db)| {
                format!(
                    "{} dB on {}",
                    signed(gain_db, 1),
                    channel.name(inputs, outputs)
                )
            })
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

    /// Added gain of a response: "+18.9 dB at 120 rad/s"; `None` where its channels add nothing.
    pub fn pair_words(&self, pair: Pair) -> Option<String> {
        let gain_db = self.of_pair_db(pair);
        (gain_db > NOTHING_DB).then(|| {
            format!(
                "{} dB at {} rad/s",
                signed(gain_db, 1),
                number(self.above_rad_s())
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use gdcm_model::dataset::Band;
    use gdcm_model::response::FrequencyGrid;

    use super::{LeadDesign, LeadSettings, *};

    fn design(order: LeadOrder, pole: f64) -> LeadDesign {
        let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 200);
        LeadDesign::new(
            LeadSettings {
                order,
                pole,
                limit: 10.0,
            },
            grid.omega().into(),
        )
    }

    #[test]
    fn the_least_signed_delay_is_that_of_the_filter_at_the_limit_of_its_gain() {
        // From independent numpy code: second order, n = 3, 0.5 to 12 rad/s.
        let design = design(LeadOrder::Second, 3.0);
        assert!((design.lower_s() + 0.095_616_050_448_4).abs() < 1e-12);
        assert!((design.longest_lead_s() - 0.084_942_288_684_1).abs() < 1e-12);
        assert!(
            (design.filter_of(design.longest_lead_s()).gain_at_infinity() - 10.0).abs() < 1e-13
        );
        assert_eq!(design.lead_s(-1.0), design.longest_lead_s(), "beyond reach");
        assert_eq!((design.filter(0.0), design.filter(0.01)), (None, None));
    }

    proptest! {
        #[test]
        fn the_filter_of_a_signed_delay_has_that_band_delay(
            share in 1e-9_f64..1.0, pole in 2.0_f64..10.0, second in any::<bool>(),
        ) {
            let design = design(if second { LeadOrder::Second } else { LeadOrder::First }, pole);
            let tau_s = share * design.lower_s();
            let lead_s = design.lead_s(tau_s);
            // Rounding of a sum of 200 phases, whose errors may all have the same sign: 200 times
            // 2.2e-16, and the same for the divisor. For a lead far below the lag b of its filter
            // the difference a - b has lost digits: 2.2e-16 b, against a lead of about share times
            // b.
            let tolerance = 1e-13 + 1e-15 / share;
            prop_assert!((design.band_delay_s(lead_s) / tau_s - 1.0).abs() < tolerance, "{tau_s}");
        }
    }

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
        let price = LeadPrice::of(&leads).expect("both have a filter");
        let pair = Pair {
            output: 0,
            input: 0,
        };
        let of = |channel: Channel| leads.filters()[channel].expect("a lead").at(120.0).norm();
        let expected = 20.0 * (of(Channel::Input(0)) * of(Channel::Output(0))).log10();
        // Rounding of a response against the closed form of its magnitude.
        assert!(
            (price.of_pair_db(pair) - expected).abs() < 1e-9,
            "{price:?}"
        );
        assert!(
            (price.limit_rad_s, price.above_rad_s()) == (12.0, 120.0),
            "{price:?}"
        );
        let words = price.words(&["LON".to_owned()], &["Q".to_owned()]);
        assert!(
            words.starts_with("not valid above 12 rad/s: at 120 rad/s the leads add +"),
            "{words}"
        );
        assert!(
            words.contains(" dB on LON, +") && words.contains(" dB on Q;"),
            "{words}"
        );
    }

    #[test]
    fn delays_cost_nothing_and_a_schedule_costs_the_most_of_its_airspeeds() {
        assert_eq!(LeadPrice::of(&leads(0.01, 0.0)), None);
        let [one, other] =
            [leads(-0.04, -0.01), leads(-0.02, -0.03)].map(|of| LeadPrice::of(&of).expect("leads"));
        let most = one.clone().or_more(&other);
        assert_eq!(
            (most.gains_db.inputs[0], most.gains_db.outputs[0]),
            (one.gains_db.inputs[0], other.gains_db.outputs[0])
        );
    }
}
