//! Lead filter design for a negative signed delay (M15.3): a channel with a negative delay needs
//! phase lead, and the filter's *band delay*, the delay that fits its phase over the band best,
//! equals that delay.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use gdcm_model::response::{LeadFilter, LeadOrder};

use super::delta::band_delay_s;

/// Settings shared by all lead filters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeadSettings {
    pub order: LeadOrder,
    /// `n`: pole frequency of the filters relative to the upper band edge `omega_B`; their lag time
    /// constant is `b = 1 / (n omega_B)`.
    #[serde(rename = "n")]
    pub pole: f64,
    /// `R_max`: limit on the filters' gain at high frequency (ratio, not dB).
    #[serde(rename = "r_max")]
    pub limit: f64,
}

impl Default for LeadSettings {
    /// Returns second order, n = 3, R_max = 10 (20 dB).
    fn default() -> Self {
        Self {
            order: LeadOrder::Second,
            pole: 3.0,
            limit: 10.0,
        }
    }
}

/// Lead filter design for a band; assigns exactly one filter to each negative signed delay (M15.3).
///
/// With `b = 1 / (n omega_B)` and the lead time `l >= 0`:
///
/// ```text
/// second order   L(s) = (1 + sqrt(2) a s + a^2 s^2) / (1 + sqrt(2) b s + b^2 s^2)
///                a = b + l / sqrt(2)
/// first order    L(s) = (1 + a s) / (1 + b s)
///                a = b + l
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LeadDesign {
    settings: LeadSettings,
    /// Frequencies in the band \[rad/s\].
    omega: Arc<[f64]>,
    /// `LB_tau`, lower bound on a signed delay \[s\].
    lower_s: f64,
}

impl LeadDesign {
    /// Creates the design for the frequencies in a band \[rad/s\], which must be rising, positive
    /// and not empty.
    pub fn new(settings: LeadSettings, omega: Arc<[f64]>) -> Self {
        let mut design = Self {
            settings,
            omega,
            lower_s: 0.0,
        };
        design.lower_s = design.band_delay_s(design.longest_lead_s());
        design
    }

    /// Returns the settings shared by the filters.
    pub fn settings(&self) -> LeadSettings {
        self.settings
    }

    /// Returns the frequencies \[rad/s\] over which a filter's band delay is computed.
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// Returns `omega_B` \[rad/s\], the upper band edge.
    pub fn band_top_rad_s(&self) -> f64 {
        self.omega.last().copied().unwrap_or(1.0)
    }

    /// Returns the lag time constant `b` \[s\].
    pub fn lag_s(&self) -> f64 {
        1.0 / (self.settings.pole * self.band_top_rad_s())
    }

    /// Returns the maximum lead time `l_max` \[s\], for which `R = R_max`.
    pub fn longest_lead_s(&self) -> f64 {
        let LeadSettings { order, limit, .. } = self.settings;
        match order {
            LeadOrder::First => self.lag_s() * (limit - 1.0),
            LeadOrder::Second => std::f64::consts::SQRT_2 * self.lag_s() * (limit.sqrt() - 1.0),
        }
    }

    /// Returns `LB_tau = d(l_max)` \[s\], the lower bound on a channel's signed delay.
    pub fn lower_s(&self) -> f64 {
        self.lower_s
    }

    /// Creates the filter with the lead time `lead_s` \[s\].
    pub fn filter_for_lead(&self, lead_s: f64) -> LeadFilter {
        LeadFilter::new(self.settings.order, lead_s, self.lag_s())
    }

    /// Computes the band delay for the filter with lead time `l`, `d(l) = - sum omega arg L / sum
    /// omega^2` \[s\] (M15.2): 0 at `l = 0`, and strictly decreasing.
    pub fn band_delay_s(&self, lead_s: f64) -> f64 {
        let filter = self.filter_for_lead(lead_s);
        -band_delay_s(
            self.omega.iter().map(|&omega| filter.phase(omega)),
            &self.omega,
            None,
        )
    }

    /// Computes `-d'(l)`, by how much the band delay falls with the lead time, dimensionless. With
    /// `x = a omega` it is the mean, weighted by `omega^2`, of `(1 + x^2) / (1 + x^4)` (second
    /// order) or `1 / (1 + x^2)` (first order).
    fn band_delay_fall(&self, lead_s: f64) -> f64 {
        let zero_s = self.filter_for_lead(lead_s).zero_s;
        let slopes = self.omega.iter().map(|&omega| {
            let square = (zero_s * omega).powi(2);
            match self.settings.order {
                LeadOrder::First => omega / (1.0 + square),
                LeadOrder::Second => omega * (1.0 + square) / (1.0 + square * square),
            }
        });
        band_delay_s(slopes, &self.omega, None)
    }

    /// Returns the filter for a negative signed delay \[s\]; `None` for others. A signed delay
    /// below the lower bound is given the filter with the gain `R_max`.
    pub fn filter(&self, tau_s: f64) -> Option<LeadFilter> {
        if tau_s < 0.0 {
            Some(self.filter_for_lead(self.lead_s(tau_s)))
        } else {
            None
        }
    }

    /// Finds the lead time `l` \[s\] with `d(l) = tau`, to a relative accuracy of 1e-14. Returns
    /// `l_max` for a `tau` below the lower bound, and 0 for one that is not negative.
    ///
    /// ```text
    /// 1  bracket: low = 0, high = l_max;  l = tau / d'(0), at most l_max
    /// 2  miss = d(l) - tau;  replace low by l if it is positive (d decreases), otherwise high
    /// 3  l' = l - miss / d'(l);  if l' is not between low and high, use the midpoint
    /// 4  l = l', repeat from 2, until l changes by less than a relative 1e-9
    ///    (the error is then about its square)
    /// ```
    ///
    /// Newton's method within a bracket (Press et al., "Numerical Recipes", 3rd ed. 2007, 9.4).
    pub fn lead_s(&self, tau_s: f64) -> f64 {
        /// Far more steps than necessary; a few are typical.
        const STEPS: usize = 100;
        /// Relative change in `l` at which the iteration ends (step 4).
        const RELATIVE_CHANGE: f64 = 1e-9;
        if tau_s >= 0.0 {
            return 0.0;
        }
        if tau_s <= self.lower_s {
            return self.longest_lead_s();
        }
        // Step 1
        let mut low = 0.0;
        let mut high = self.longest_lead_s();
        let mut lead_s = (-tau_s / self.band_delay_fall(0.0)).min(high);
        for _ in 0..STEPS {
            // Step 2
            let miss_s = self.band_delay_s(lead_s) - tau_s;
            if miss_s > 0.0 {
                low = lead_s;
            } else {
                high = lead_s;
            }
            // Step 3
            let newton_s = lead_s + miss_s / self.band_delay_fall(lead_s);
            let next_s = if (low..=high).contains(&newton_s) {
                newton_s
            } else {
                0.5 * (low + high)
            };
            // Step 4
            let step_s = (next_s - lead_s).abs();
            lead_s = next_s;
            if step_s <= RELATIVE_CHANGE * lead_s {
                break;
            }
        }
        lead_s
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use gdcm_model::dataset::Band;
    use gdcm_model::response::FrequencyGrid;

    use super::*;

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
        // Reference: independent numpy code; second order, n = 3, 0.5 to 12 rad/s.
        let design = design(LeadOrder::Second, 3.0);
        assert!((design.lower_s() + 0.095_616_050_448_4).abs() < 1e-12);
        assert!((design.longest_lead_s() - 0.084_942_288_684_1).abs() < 1e-12);
        assert!(
            (design
                .filter_for_lead(design.longest_lead_s())
                .gain_at_infinity()
                - 10.0)
                .abs()
                < 1e-13
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
            // Tolerance: rounding of a sum of 200 phases, whose errors may all have the same sign:
            // 200 times 2.2e-16, and as much for the divisor. For a lead far below the filter's lag
            // b, the difference a - b loses digits: 2.2e-16 b, compared with a lead of about share
            // times b.
            let tolerance = 1e-13 + 1e-15 / share;
            prop_assert!((design.band_delay_s(lead_s) / tau_s - 1.0).abs() < tolerance, "{tau_s}");
        }
    }
}
