//! A realisable filter that gives a channel phase lead (M15.3).

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::units::ratio_to_db;

/// Lead filter order (numerator and denominator).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
// Read from `f64`, because a file may contain a whole number as `2.0`.
#[serde(try_from = "f64", into = "usize")]
pub enum LeadOrder {
    /// `(1 + a s) / (1 + b s)`: the logarithm of its gain rises with `omega^2` while `a omega` is
    /// small, hence already within the comparison band.
    First,
    /// Butterworth damping: nearly constant gain within the comparison band.
    #[default]
    Second,
}

impl LeadOrder {
    /// Returns the order as a number, 1 or 2.
    pub fn number(self) -> usize {
        match self {
            LeadOrder::First => 1,
            LeadOrder::Second => 2,
        }
    }

    /// Evaluates numerator or denominator at `x = a omega` or `b omega`: `1 + j x` for first order,
    /// `1 + sqrt(2) j x - x^2` for second order.
    fn polynomial(self, x: f64) -> Complex<f64> {
        match self {
            LeadOrder::First => Complex::new(1.0, x),
            LeadOrder::Second => Complex::new(1.0 - x * x, SQRT_2 * x),
        }
    }
}

impl TryFrom<f64> for LeadOrder {
    type Error = String;

    fn try_from(order: f64) -> Result<Self, String> {
        if order == 1.0 {
            Ok(Self::First)
        } else if order == 2.0 {
            Ok(Self::Second)
        } else {
            Err(format!(
                "order of the lead filters: expected 1 or 2, found {order}"
            ))
        }
    }
}

impl From<LeadOrder> for usize {
    fn from(order: LeadOrder) -> Self {
        order.number()
    }
}

/// Lead filter `L(s) = (1 + sqrt(2) a s + a^2 s^2) / (1 + sqrt(2) b s + b^2 s^2)`, or
/// `(1 + a s) / (1 + b s)` for first order, with `a >= b > 0`. It cancels a servo with the
/// bandwidth `1 / a` rad/s and introduces one with `1 / b` rad/s (M15.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadFilter {
    pub order: LeadOrder,
    /// Numerator time constant, `a` \[s\].
    pub zero_s: f64,
    /// Denominator time constant, `b` \[s\].
    pub lag_s: f64,
}

impl LeadFilter {
    /// Creates the filter from the lead time `l >= 0` at low frequency and the lag time constant
    /// `b > 0`, both in s: `a = b + l / sqrt(2)`, or `a = b + l` for first order.
    pub fn new(order: LeadOrder, lead_s: f64, lag_s: f64) -> Self {
        // a - b.
        let difference_s = match order {
            LeadOrder::First => lead_s,
            LeadOrder::Second => lead_s * FRAC_1_SQRT_2,
        };
        Self {
            order,
            zero_s: lag_s + difference_s,
            lag_s,
        }
    }

    /// Returns the lead time at low frequency, `l` \[s\].
    pub fn lead_s(self) -> f64 {
        match self.order {
            LeadOrder::First => self.zero_s - self.lag_s,
            LeadOrder::Second => SQRT_2 * (self.zero_s - self.lag_s),
        }
    }

    /// Returns `omega_1 = 1 / a` \[rad/s\], the bandwidth of the servo that the filter cancels.
    pub fn zero_rad_s(self) -> f64 {
        1.0 / self.zero_s
    }

    /// Returns `omega_2 = 1 / b` \[rad/s\], the bandwidth of the servo that the filter introduces.
    pub fn lag_rad_s(self) -> f64 {
        1.0 / self.lag_s
    }

    /// Returns the gain at infinite frequency, `R = L(j inf) = (a / b)^order`.
    pub fn gain_at_infinity(self) -> f64 {
        (self.zero_s / self.lag_s).powi(self.order.number() as i32)
    }

    /// Returns the gain at infinite frequency in dB, `20 log10 R`.
    pub fn gain_at_infinity_db(self) -> f64 {
        ratio_to_db(self.gain_at_infinity())
    }

    /// Returns the phase `arg L(j omega)` \[rad\], continuous in `omega`, from 0 to less than pi.
    /// Computed from the argument of the numerator times the conjugate denominator, because a
    /// difference between two arguments would cancel.
    pub fn phase(self, omega: f64) -> f64 {
        let x = self.zero_s * omega;
        let y = self.lag_s * omega;
        match self.order {
            LeadOrder::First => ((x - y) / (1.0 + x * y)).atan(),
            LeadOrder::Second => (SQRT_2 * (x - y) * (1.0 + x * y))
                .atan2((1.0 - x * x) * (1.0 - y * y) + 2.0 * x * y),
        }
    }

    /// Returns the magnitude `20 log10 |L(j omega)|` \[dB\];
    /// `|L|^2 = (1 + (a omega)^4) / (1 + (b omega)^4)` for second order.
    pub fn magnitude_db(self, omega: f64) -> f64 {
        let power = 2 * self.order.number() as i32;
        let numerator = 1.0 + (self.zero_s * omega).powi(power);
        let denominator = 1.0 + (self.lag_s * omega).powi(power);
        10.0 * (numerator / denominator).log10()
    }

    /// Returns the frequency response `L(j omega)`.
    pub fn at(self, omega: f64) -> Complex<f64> {
        self.order.polynomial(self.zero_s * omega) / self.order.polynomial(self.lag_s * omega)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_zero_lead_leaves_the_response_unchanged() {
        let filter = LeadFilter::new(LeadOrder::Second, 0.0, 0.02);
        assert_eq!(
            (
                filter.phase(7.0),
                filter.magnitude_db(7.0),
                filter.gain_at_infinity()
            ),
            (0.0, 0.0, 1.0)
        );
    }

    proptest! {
        #[test]
        fn magnitude_and_phase_are_those_of_the_response(
            lead_s in 0.0_f64..0.5, lag_s in 1e-3_f64..0.3, omega in 1e-2_f64..300.0, second in any::<bool>(),
        ) {
            let order = if second { LeadOrder::Second } else { LeadOrder::First };
            let filter = LeadFilter::new(order, lead_s, lag_s);
            let value = Complex::from_polar(10f64.powf(filter.magnitude_db(omega) / 20.0), filter.phase(omega));
            // Tolerance: rounding errors of a few operations.
            prop_assert!((value / filter.at(omega) - 1.0).norm() < 1e-13);
            prop_assert!((0.0..std::f64::consts::PI).contains(&filter.phase(omega)));
            // Tolerance: cancellation in the difference between two times of up to 0.8 s.
            prop_assert!((filter.lead_s() - lead_s).abs() < 1e-15);
        }
    }
}
