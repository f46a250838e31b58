//! The channels' quantity (a gain, a delay or a signed delay), its residuals, and the coordinate in
//! which the net value is a sum.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Distance measure between `k_o k_i` and G.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum GainObjective {
    /// `sum w (G - k_o k_i)^2 + alpha sum (k_o - 1)^2`, eq. (7), with the weight `w` 1 for a fitted
    /// entry and 0 for an ignored one.
    #[default]
    #[serde(rename = "ratio")]
    Ratio,
    /// `sum w (20 log10 G - 20 log10 k_o k_i)^2 + alpha sum (20 log10 k_o)^2`: gains too high and
    /// too low by the same factor count alike, and an entry with a large `G` counts no more than
    /// another. Convex.
    #[serde(rename = "dB")]
    Decibel,
}

/// Quantity of the channels. Gains of two channels multiply, delays add.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Gains, dimensionless, compared by the given objective (eq. (7), M8).
    Gain(GainObjective),
    /// Delays in seconds (eq. (11), M9).
    Delay,
    /// Signed delays in seconds; a negative delay is a lead. Inputs and outputs are both
    /// regularised (M15.4).
    SignedDelay,
}

/// dB per unit of natural logarithm.
const DECIBEL: f64 = 20.0 / std::f64::consts::LN_10;

/// `(20 / ln 10)^2`: squared dB per unit of squared natural logarithm.
pub(crate) const SQUARED_DECIBEL: f64 = DECIBEL * DECIBEL;

impl Quantity {
    /// Whether the quantity is a gain.
    pub fn is_gain(self) -> bool {
        matches!(self, Self::Gain(_))
    }

    /// Returns the value of a channel without effect: gain 1, delay 0.
    pub(crate) fn neutral(self) -> f64 {
        if self.is_gain() { 1.0 } else { 0.0 }
    }

    /// Whether departures on the inputs are regularised besides those on the outputs.
    pub(crate) fn regularises_inputs(self) -> bool {
        self == Quantity::SignedDelay
    }

    /// Whether the lower bound is adjustable: for delays it is fixed at 0.
    pub(crate) fn has_lower_bound(self) -> bool {
        self != Quantity::Delay
    }

    /// Computes the net value, `k_o k_i` or `tau_o + tau_i`.
    pub(crate) fn net(self, output: f64, input: f64) -> f64 {
        if self.is_gain() {
            output * input
        } else {
            output + input
        }
    }

    /// Computes a channel's value from the net value and the other channel.
    pub(crate) fn without(self, net: f64, other: f64) -> f64 {
        if self.is_gain() {
            net / other
        } else {
            net - other
        }
    }

    /// Computes an entry's residual, whose square the objective sums: a ratio, dB or seconds.
    pub(crate) fn miss(self, delta: f64, output: f64, input: f64) -> f64 {
        match self {
            Quantity::Gain(GainObjective::Ratio) => delta - output * input,
            Quantity::Gain(GainObjective::Decibel) => 20.0 * (delta / (output * input)).log10(),
            Quantity::Delay | Quantity::SignedDelay => delta - output - input,
        }
    }

    /// Computes the derivative of the squared residual with respect to a logarithmic gain or a
    /// delay.
    pub(crate) fn slope(self, delta: f64, output: f64, input: f64) -> f64 {
        let net = self.net(output, input);
        match self {
            Quantity::Gain(GainObjective::Ratio) => 2.0 * net * (net - delta),
            Quantity::Gain(GainObjective::Decibel) => 2.0 * SQUARED_DECIBEL * (net / delta).ln(),
            Quantity::Delay | Quantity::SignedDelay => 2.0 * (net - delta),
        }
    }

    /// Converts a coordinate difference to dB or seconds.
    pub(crate) fn difference(self, difference: f64, coordinate: Coordinate) -> f64 {
        if self.is_gain() {
            difference * DECIBEL
        } else {
            coordinate.value(difference)
        }
    }

    /// Converts a slope per unit logarithm to a slope per dB, or per second to per millisecond.
    pub(crate) fn per_unit(self, slope: f64) -> f64 {
        if self.is_gain() {
            slope / DECIBEL
        } else {
            1e-3 * slope
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Quantity::Gain(_) => "gain",
            Quantity::Delay => "delay",
            Quantity::SignedDelay => "signed delay",
        })
    }
}

/// Coordinate in which the net value is a sum over two channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Coordinate {
    /// Natural logarithm.
    Logarithm,
    /// Delay in this unit.
    Time { unit_s: f64 },
}

impl Coordinate {
    /// Converts a gain, or a delay in seconds, to its coordinate.
    pub(crate) fn coordinate(self, value: f64) -> f64 {
        match self {
            Coordinate::Logarithm => value.ln(),
            Coordinate::Time { unit_s } => value / unit_s,
        }
    }

    /// Converts a coordinate to a gain, or to a delay in seconds.
    pub(crate) fn value(self, coordinate: f64) -> f64 {
        match self {
            Coordinate::Logarithm => coordinate.exp(),
            Coordinate::Time { unit_s } => coordinate * unit_s,
        }
    }

    /// Converts an objective in this coordinate to the unit of the gains' objective, or to s².
    pub(crate) fn objective(self, objective: f64) -> f64 {
        match self {
            Coordinate::Logarithm => objective,
            Coordinate::Time { unit_s } => objective * unit_s * unit_s,
        }
    }
}
