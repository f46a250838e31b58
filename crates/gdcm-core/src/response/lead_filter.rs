//! A filter that gives one channel phase lead and can be built (M15.3).

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use serde::{Deserialize, Serialize};

use nalgebra::Complex;

use crate::units::ratio_to_db;

/// Order of a lead filter's numerator and denominator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "usize", into = "usize")]
pub enum LeadOrder {
    /// `(1 + a s) / (1 + b s)`: its gain rises with `omega^2` within the band.
    First,
    /// Butterworth damping: the gain within the band stays.
    #[default]
    Second,
}

impl LeadOrder {
    /// The order as a number.
    pub fn number(self) -> usize {
        match self {
            LeadOrder::First => 1,
            LeadOrder::Second => 2,
        }
    }
}

impl TryFrom<usize> for LeadOrder {
    type Error = String;

    fn try_from(order: usize) -> Result<Self, String> {
        let orders = [Self::First, Self::Second];
        let found = orders.into_iter().find(|known| known.number() == order);
        found.ok_or_else(|| format!("order of the lead filters: expected 1 or 2, found {order}"))
    }
}

impl From<LeadOrder> for usize {
    fn from(order: LeadOrder) -> Self {
        order.number()
    }
}

/// `L(s) = (1 + sqrt(2) a s + a^2 s^2) / (1 + sqrt(2) b s + b^2 s^2)`, or of first order `(1 + a s) / (1 + b s)`, `a >= b > 0`: a
/// servo of `1 / b` rad/s put in the place of one of `1 / a` rad/s (M15.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadFilter {
    order: LeadOrder,
    zero_s: f64,
    lag_s: f64,
}

impl LeadFilter {
    /// The filter of this lead time `l >= 0` at low frequency and this lag time constant `b > 0` \[s\]: `a = b + l / sqrt(2)`, of
    /// first order `a = b + l`.
    pub fn new(order: LeadOrder, lead_s: f64, lag_s: f64) -> Self {
        let apart_s = match order {
            LeadOrder::First => lead_s,
            LeadOrder::Second => lead_s * FRAC_1_SQRT_2,
        };
        Self { order, zero_s: lag_s + apart_s, lag_s }
    }

    /// Its order.
    pub fn order(self) -> LeadOrder {
        self.order
    }

    /// Lead time at low frequency, `l` \[s\].
    pub fn lead_s(self) -> f64 {
        match self.order {
            LeadOrder::First => self.zero_s - self.lag_s,
            LeadOrder::Second => SQRT_2 * (self.zero_s - self.lag_s),
        }
    }

    /// Time constant of its numerator, `a` \[s\].
    pub fn zero_s(self) -> f64 {
        self.zero_s
    }

    /// Time constant of its denominator, `b` \[s\].
    pub fn lag_s(self) -> f64 {
        self.lag_s
    }

    /// `omega_1 = 1 / a` \[rad/s\]: the servo that it takes out.
    pub fn zero_rad_s(self) -> f64 {
        1.0 / self.zero_s
    }

    /// `omega_2 = 1 / b` \[rad/s\]: the servo that it puts in.
    pub fn lag_rad_s(self) -> f64 {
        1.0 / self.lag_s
    }

    /// `R = L(j inf) = (a / b)^order`.
    pub fn gain_at_infinity(self) -> f64 {
        (self.zero_s / self.lag_s).powi(self.order.number() as i32)
    }

    /// `20 log10 R`.
    pub fn gain_at_infinity_db(self) -> f64 {
        ratio_to_db(self.gain_at_infinity())
    }

    /// `arg L(j omega)` \[rad\], continuous in `omega`, from 0 to less than pi: that of the numerator times the conjugate of the
    /// denominator, in which no near equals are taken from one another.
    pub fn phase(self, omega: f64) -> f64 {
        let (x, y) = (self.zero_s * omega, self.lag_s * omega);
        match self.order {
            LeadOrder::First => ((x - y) / (1.0 + x * y)).atan(),
            LeadOrder::Second => (SQRT_2 * (x - y) * (1.0 + x * y)).atan2((1.0 - x * x) * (1.0 - y * y) + 2.0 * x * y),
        }
    }

    /// `20 log10 |L(j omega)|`; of second order `|L|^2 = (1 + (a omega)^4) / (1 + (b omega)^4)`.
    pub fn magnitude_db(self, omega: f64) -> f64 {
        let power = 2 * self.order.number() as i32;
        let square = |time_s: f64| 1.0 + (time_s * omega).powi(power);
        10.0 * (square(self.zero_s) / square(self.lag_s)).log10()
    }

    /// `L(j omega)`.
    pub fn at(self, omega: f64) -> Complex<f64> {
        let side = |time_s: f64| {
            let x = time_s * omega;
            match self.order {
                LeadOrder::First => Complex::new(1.0, x),
                LeadOrder::Second => Complex::new(1.0 - x * x, SQRT_2 * x),
            }
        };
        side(self.zero_s) / side(self.lag_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_lead_of_nothing_leaves_everything() {
        let filter = LeadFilter::new(LeadOrder::Second, 0.0, 0.02);
        assert_eq!((filter.phase(7.0), filter.magnitude_db(7.0), filter.gain_at_infinity()), (0.0, 0.0, 1.0));
    }

    proptest! {
        #[test]
        fn magnitude_and_phase_are_those_of_the_response(
            lead_s in 0.0_f64..0.5, lag_s in 1e-3_f64..0.3, omega in 1e-2_f64..300.0, second in any::<bool>(),
        ) {
            let order = if second { LeadOrder::Second } else { LeadOrder::First };
            let filter = LeadFilter::new(order, lead_s, lag_s);
            let value = Complex::from_polar(10f64.powf(filter.magnitude_db(omega) / 20.0), filter.phase(omega));
            // A handful of roundings.
            prop_assert!((value / filter.at(omega) - 1.0).norm() < 1e-13);
            prop_assert!((0.0..std::f64::consts::PI).contains(&filter.phase(omega)));
            // What is lost where two times of up to 0.8 s are taken from one another.
            prop_assert!((filter.lead_s() - lead_s).abs() < 1e-15);
        }
    }
}
