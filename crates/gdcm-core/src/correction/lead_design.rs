//! From a signed delay to the lead filter that gives it (M15.3).

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::band_delay_s;
use crate::response::{LeadFilter, LeadOrder};

/// What the lead filters of all channels have in common.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeadSettings {
    /// Order of the filters.
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
        Self { order: LeadOrder::Second, pole: 3.0, limit: 10.0 }
    }
}

/// The lead filters that a band allows: of each signed delay below zero there is exactly one (M15.3).
#[derive(Clone, Debug, PartialEq)]
pub struct LeadDesign {
    settings: LeadSettings,
    omega: Arc<[f64]>,
    lag_s: f64,
    lower_s: f64,
}

impl LeadDesign {
    /// The design over these frequencies \[rad/s\], rising and positive; at least one.
    pub fn new(settings: LeadSettings, omega: Arc<[f64]>) -> Self {
        let top = omega.last().copied().unwrap_or(1.0);
        let mut design = Self { settings, omega, lag_s: 1.0 / (settings.pole * top), lower_s: 0.0 };
        design.lower_s = design.band_delay_s(design.longest_lead_s());
        design
    }

    /// What the filters have in common.
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
        self.lag_s
    }

    /// `l_max` \[s\], the lead time at which `R = R_max`.
    pub fn longest_lead_s(&self) -> f64 {
        let LeadSettings { order, limit, .. } = self.settings;
        match order {
            LeadOrder::First => self.lag_s * (limit - 1.0),
            LeadOrder::Second => std::f64::consts::SQRT_2 * self.lag_s * (limit.sqrt() - 1.0),
        }
    }

    /// `LB_tau = d(l_max)` \[s\]: the least signed delay of a channel.
    pub fn lower_s(&self) -> f64 {
        self.lower_s
    }

    /// The filter of a lead time \[s\].
    pub fn filter_of(&self, lead_s: f64) -> LeadFilter {
        LeadFilter::new(self.settings.order, lead_s, self.lag_s)
    }

    /// `d(l) = - sum omega arg L / sum omega^2` \[s\], the band delay of the filter of lead time `l` (M15.2): 0 at 0, strictly
    /// falling.
    pub fn band_delay_s(&self, lead_s: f64) -> f64 {
        let filter = self.filter_of(lead_s);
        -band_delay_s(self.omega.iter().map(|&omega| filter.phase(omega)), &self.omega, None)
    }

    /// `-d d(l) / d l`, dimensionless: with `x = a omega` it is `(1 + x^2) / (1 + x^4)` in the mean, of first order
    /// `1 / (1 + x^2)`.
    fn falling(&self, lead_s: f64) -> f64 {
        let a = self.filter_of(lead_s).zero_s();
        let of = |omega: f64| {
            let square = (a * omega).powi(2);
            match self.settings.order {
                LeadOrder::First => omega / (1.0 + square),
                LeadOrder::Second => omega * (1.0 + square) / (1.0 + square * square),
            }
        };
        band_delay_s(self.omega.iter().map(|&omega| of(omega)), &self.omega, None)
    }

    /// The filter of a signed delay below zero, none of any other. What no filter reaches gets the filter of `R_max`.
    pub fn filter(&self, tau_s: f64) -> Option<LeadFilter> {
        (tau_s < 0.0).then(|| self.filter_of(self.lead_s(tau_s)))
    }

    /// The lead time `l` with `d(l) = tau` \[s\], to 1e-14 of it; `l_max` of a `tau` below the bound.
    ///
    /// ```text
    /// low, high = 0, l_max;  l = tau / d'(0), cut to them
    /// repeat
    ///     miss = d(l) - tau;  low or high = l, by the sign of miss: d falls
    ///     l' = l - miss / d'(l);  the middle of low and high where l' is not between them
    ///     l = l';  end where it changed by less than 1e-9 of itself: Newton's error is then the square of that
    /// ```
    ///
    /// Newton's method kept inside a bracket (Press et al., "Numerical Recipes", 3rd ed. 2007, 9.4).
    pub fn lead_s(&self, tau_s: f64) -> f64 {
        const STEPS: usize = 100;
        const SMALL: f64 = 1e-9;
        let (mut low, mut high) = (0.0, self.longest_lead_s());
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
            let next_s = if (low..=high).contains(&newton_s) { newton_s } else { 0.5 * (low + high) };
            let step_s = (next_s - lead_s).abs();
            lead_s = next_s;
            if step_s <= SMALL * lead_s {
                break;
            }
        }
        lead_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Band;
    use crate::response::FrequencyGrid;
    use proptest::prelude::*;

    fn design(order: LeadOrder, pole: f64) -> LeadDesign {
        let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 200);
        LeadDesign::new(LeadSettings { order, pole, limit: 10.0 }, grid.omega().into())
    }

    #[test]
    fn the_least_signed_delay_is_that_of_the_filter_at_the_limit_of_its_gain() {
        // From independent numpy code: second order, n = 3, 0.5 to 12 rad/s.
        let design = design(LeadOrder::Second, 3.0);
        assert!((design.lower_s() + 0.095_616_050_448_4).abs() < 1e-12);
        assert!((design.longest_lead_s() - 0.084_942_288_684_1).abs() < 1e-12);
        assert!((design.filter_of(design.longest_lead_s()).gain_at_infinity() - 10.0).abs() < 1e-13);
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
            // Rounding of a sum of 200 phases, whose errors may all have one sign: 200 times 2.2e-16, and the same of what divides it. Of a
            // lead far below the lag b of its filter the difference a - b has lost digits: 2.2e-16 b, against a lead of share times b or so.
            let tolerance = 1e-13 + 1e-15 / share;
            prop_assert!((design.band_delay_s(lead_s) / tau_s - 1.0).abs() < tolerance, "{tau_s}");
        }
    }
}
