//! Problem for the channel values: eq. (7) for gains, eq. (11) for delays, M15.4 for signed delays.
//! An *entry* is a response of output `o` to input `i`; its *delta* is the gain or delay that it
//! needs, its *net value* what its two channels give it.

use std::ops::RangeInclusive;

use gdcm_model::dataset::{Pair, PairTable};

pub use super::problem_error::ProblemError;

use super::channel_bounds::Bounds;
use super::interval::Interval;
use super::quantity::{Coordinate, GainObjective, Quantity};

/// Valid delta gains: their squares, and products of such squares, stay clear of overflow and
/// underflow.
const GAINS: RangeInclusive<f64> = 1e-50..=1e50;

/// Valid gain bounds (-180 to 180 dB): products in the search for a proof stay clear of overflow
/// and underflow.
const GAIN_BOUNDS: RangeInclusive<f64> = 1e-9..=1e9;

/// Maximum magnitude of a delta delay or a delay bound \[s\]: squares, and products of squares,
/// stay clear of overflow.
const MOST_DELAY_S: f64 = 1e50;

/// Valid weights on the deviations from neutral.
const ALPHAS: RangeInclusive<f64> = 0.0..=1e12;

/// Deviation \[s\] up to which constrained delays in a loop are accepted as consistent: half a unit
/// in the last displayed digit.
pub const DELAY_AGREEMENT_S: f64 = 5e-5;

/// Problem for the gains (M8), delays \[s\] (M9) or signed delays \[s\] (M15.4) in a condition's
/// correction.
///
/// ```text
/// eq. 7   min  sum w_oi (G_oi - k_o k_i)^2 + alpha sum (k_o - 1)^2
///              subject to k_o k_i = G_oi in constrained entries
/// eq. 11  min  sum w_oi (D_oi - tau_o - tau_i)^2 + alpha sum tau_o^2
///              subject to tau_o + tau_i = D_oi in constrained entries
/// M15.4   as eq. 11, with alpha (sum tau_o^2 + sum tau_i^2), and bounds that permit tau < 0
/// ```
///
/// and subject to `lower <= k, tau <= upper` for every channel. The weight `w_oi` is 1 for a fitted
/// entry and 0 for an ignored one.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    pub quantity: Quantity,
    /// Delta gain `G` or delta delay `D` \[s\] per response, p x m; `None` is ignored in the
    /// objective.
    pub delta: PairTable<Option<f64>>,
    /// Entries whose net value is constrained to equal their delta, p x m.
    pub constrained: PairTable<bool>,
    /// Entries that count in the objective (`w = 1`), p x m.
    pub fitted: PairTable<bool>,
    pub bounds: Bounds,
    /// Weight on the deviations from neutral: output gains from 1, output delays from 0, or all
    /// signed delays from 0; `alpha = 0` means the limit `alpha -> 0+`.
    pub alpha: f64,
    /// Deviation, in dB or seconds, up to which constrained entries in a loop are accepted as
    /// consistent.
    pub agreement: f64,
}

/// A response and its delta gain or delta delay.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) pair: Pair,
    pub(crate) delta: f64,
}

impl Problem {
    /// Creates the problem in eq. (7) with every entry fitted, `alpha = 1`, gains compared as
    /// ratios and no tolerance for loops.
    pub fn gains(
        delta: PairTable<Option<f64>>,
        constrained: PairTable<bool>,
        bounds: Bounds,
    ) -> Self {
        let fitted = PairTable::filled(delta.outputs(), delta.inputs(), true);
        let quantity = Quantity::Gain(GainObjective::Ratio);
        Self {
            quantity,
            delta,
            constrained,
            fitted,
            bounds,
            alpha: 1.0,
            agreement: 0.0,
        }
    }

    /// Creates the problem in eq. (11) with every entry fitted, `alpha = 1` and no tolerance for
    /// loops; all times are in seconds.
    pub fn delays(
        delta_s: PairTable<Option<f64>>,
        constrained: PairTable<bool>,
        upper_s: f64,
    ) -> Self {
        let bounds = Bounds {
            lower: 0.0,
            upper: upper_s,
        };
        Self {
            quantity: Quantity::Delay,
            ..Self::gains(delta_s, constrained, bounds)
        }
    }

    /// Creates the problem for signed delays (M15.4) with every entry fitted, `alpha = 1` and no
    /// tolerance for loops; all times are in seconds.
    pub fn signed_delays(
        delta_s: PairTable<Option<f64>>,
        constrained: PairTable<bool>,
        bounds: Bounds,
    ) -> Self {
        Self {
            quantity: Quantity::SignedDelay,
            ..Self::gains(delta_s, constrained, bounds)
        }
    }

    /// Checks shapes and values.
    ///
    /// # Errors
    /// The first [`ProblemError`] found.
    pub fn check(&self) -> Result<(), ProblemError> {
        self.check_shape("constrained", &self.constrained)?;
        self.check_shape("fitted", &self.fitted)?;
        for (pair, delta) in self.delta.iter() {
            self.check_delta(pair, *delta)?;
        }
        self.check_bounds()?;
        if ALPHAS.contains(&self.alpha) {
            Ok(())
        } else {
            Err(ProblemError::Alpha { alpha: self.alpha })
        }
    }

    /// Checks that a table has the same shape as `delta`.
    fn check_shape(
        &self,
        table: &'static str,
        entries: &PairTable<bool>,
    ) -> Result<(), ProblemError> {
        let expected = (self.delta.outputs(), self.delta.inputs());
        let found = (entries.outputs(), entries.inputs());
        if found == expected {
            return Ok(());
        }
        Err(ProblemError::Shape {
            quantity: self.quantity,
            table,
            found,
            expected,
        })
    }

    fn check_delta(&self, pair: Pair, delta: Option<f64>) -> Result<(), ProblemError> {
        let quantity = self.quantity;
        match (delta, quantity) {
            (None, _) if self.constrained[pair] => {
                Err(ProblemError::ConstrainedUndefined { quantity, pair })
            }
            (Some(gain), Quantity::Gain(_)) if !GAINS.contains(&gain) => {
                Err(ProblemError::Gain { pair, gain })
            }
            (Some(delay_s), Quantity::Delay | Quantity::SignedDelay)
                if !(-MOST_DELAY_S..=MOST_DELAY_S).contains(&delay_s) =>
            {
                Err(ProblemError::Delay { pair, delay_s })
            }
            _ => Ok(()),
        }
    }

    fn check_bounds(&self) -> Result<(), ProblemError> {
        let Bounds { lower, upper } = self.bounds;
        let delays = 0.0..=MOST_DELAY_S;
        let are_valid = match self.quantity {
            Quantity::Gain(_) => {
                GAIN_BOUNDS.contains(&lower) && GAIN_BOUNDS.contains(&upper) && lower <= upper
            }
            Quantity::Delay => lower == 0.0 && delays.contains(&upper),
            Quantity::SignedDelay => delays.contains(&-lower) && delays.contains(&upper),
        };
        if are_valid {
            return Ok(());
        }
        Err(ProblemError::Bounds {
            quantity: self.quantity,
            bounds: self.bounds,
        })
    }

    /// Computes the objective for the given channel values (m inputs, p outputs): in squared
    /// ratios, squared dB or s².
    pub fn objective_at(&self, inputs: &[f64], outputs: &[f64]) -> f64 {
        let fit: f64 = self
            .fit_entries()
            .map(|Entry { pair, delta }| {
                self.quantity
                    .residual(delta, outputs[pair.output], inputs[pair.input])
                    .powi(2)
            })
            .sum();
        // Without the regularisation if alpha is 0: it would only add rounding errors.
        if self.alpha == 0.0 {
            return fit;
        }
        let regularised_inputs = if self.quantity.regularises_inputs() {
            inputs
        } else {
            &[]
        };
        let neutral = self.quantity.neutral();
        let departures: f64 = outputs
            .iter()
            .chain(regularised_inputs)
            .map(|value| self.quantity.residual(neutral, *value, neutral).powi(2))
            .sum();
        fit + self.alpha * departures
    }

    /// Iterates over the entries that count in the objective (`w = 1`), each with its delta.
    pub(crate) fn fit_entries(&self) -> impl Iterator<Item = Entry> + '_ {
        self.delta.iter().filter_map(|(pair, delta)| {
            if self.fitted[pair] {
                delta.map(|delta| Entry { pair, delta })
            } else {
                None
            }
        })
    }

    /// Iterates over the constrained entries, each with its delta.
    pub(crate) fn constrained_entries(&self) -> impl Iterator<Item = Entry> + '_ {
        self.constrained
            .marked()
            .filter_map(|pair| self.delta[pair].map(|delta| Entry { pair, delta }))
    }

    /// Returns the coordinate in which a constrained entry is a sum. Delays are divided by the
    /// largest magnitude among the deltas (or the bounds, if every delta is 0; or 1 s), so that the
    /// values are around 1; this scaling does not change the solution.
    pub(crate) fn coordinate(&self) -> Coordinate {
        if self.quantity.is_gain() {
            return Coordinate::Logarithm;
        }
        let longest_delta_s = self
            .delta
            .iter()
            .filter_map(|(_, delay_s)| *delay_s)
            .fold(0.0_f64, |most, delay_s| most.max(delay_s.abs()));
        // Use the deltas rather than a bound, which may be far above any value that a channel can
        // take.
        let unit_s = if longest_delta_s > 0.0 {
            longest_delta_s
        } else {
            self.bounds.upper.max(-self.bounds.lower)
        };
        Coordinate::Time {
            unit_s: if unit_s > 0.0 { unit_s } else { 1.0 },
        }
    }

    /// Returns the permitted range of the coordinate, the same for every channel.
    pub(crate) fn range(&self) -> Interval {
        let coordinate = self.coordinate();
        let low = coordinate.transform(self.bounds.lower);
        let high = coordinate.transform(self.bounds.upper);
        match coordinate {
            Coordinate::Logarithm => Interval { low, high },
            // Limit the range: along a path through constrained entries, channels differ by at most
            // one unit per entry, so that a bound beyond this sum is never active.
            Coordinate::Time { .. } => {
                let channels = (self.delta.outputs() + self.delta.inputs()) as f64;
                Interval {
                    low: low.max(-channels),
                    high: high.min(channels),
                }
            }
        }
    }
}
