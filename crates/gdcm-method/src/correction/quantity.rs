//! Channel quantity (gain, delay or signed delay), its residuals, and the coordinate in which a
//! response's net value is a sum:
//!
//! ```text
//! net value     k_o k_i                       tau_o + tau_i
//! residual      G - k_o k_i, or in dB         D - tau_o - tau_i
//! coordinate    ln k                          tau / unit
//! ```
//!
//! `k_o`, `k_i` and `tau_o`, `tau_i` are the gains and delays of a response's output and input
//! channel, `G` and `D` the gain and the delay that the response needs.

use std::fmt;

use serde::{Deserialize, Serialize};

/// How `k_o k_i` is compared with G.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum GainObjective {
    /// `sum w (G - k_o k_i)^2 + alpha sum (k_o - 1)^2`, eq. (7), with the weight `w` 1 for a fitted
    /// entry and 0 for an ignored one.
    #[default]
    #[serde(rename = "ratio")]
    Ratio,
    /// `sum w (20 log10 G - 20 log10 k_o k_i)^2 + alpha sum (20 log10 k_o)^2`. Gains that are too
    /// high or too low by the same factor have the same weight, and entries with large `G` do not
    /// dominate. Convex.
    #[serde(rename = "dB")]
    Decibel,
}

/// Quantity that a channel's value represents. In a response, the gains of input and output
/// multiply; their delays add.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Gains, dimensionless, compared as given by the objective (eq. (7), M8).
    Gain(GainObjective),
    /// Delays \[s\] (eq. (11), M9).
    Delay,
    /// Signed delays \[s\]; a negative delay is a lead. Both inputs and outputs are regularised
    /// (M15.4).
    SignedDelay,
}

/// dB per natural logarithm unit.
const DECIBEL: f64 = 20.0 / std::f64::consts::LN_10;

const SECONDS_PER_MS: f64 = 1e-3;

/// `(20 / ln 10)^2`: squared dB per squared natural logarithm unit.
pub(crate) const SQUARED_DECIBEL: f64 = DECIBEL * DECIBEL;

impl Quantity {
    /// Returns whether the quantity is a gain, whichever its objective.
    pub fn is_gain(self) -> bool {
        matches!(self, Self::Gain(_))
    }

    /// Returns the channel value without effect: gain 1, delay 0.
    pub(crate) fn neutral(self) -> f64 {
        if self.is_gain() { 1.0 } else { 0.0 }
    }

    /// Returns whether input deviations are regularised in addition to output deviations.
    pub(crate) fn regularises_inputs(self) -> bool {
        self == Quantity::SignedDelay
    }

    /// Returns whether the lower bound can be changed; for delays it is fixed at 0.
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

    /// Computes a channel's value from the net value and the other channel's value.
    pub(crate) fn other_channel(self, net: f64, channel: f64) -> f64 {
        if self.is_gain() {
            net / channel
        } else {
            net - channel
        }
    }

    /// Computes an entry's residual against `delta` (G or D), whose square is summed in the
    /// objective: a difference in ratio, dB or seconds.
    pub(crate) fn residual(self, delta: f64, output: f64, input: f64) -> f64 {
        match self {
            Quantity::Gain(GainObjective::Ratio) => delta - output * input,
            Quantity::Gain(GainObjective::Decibel) => 20.0 * (delta / (output * input)).log10(),
            Quantity::Delay | Quantity::SignedDelay => delta - output - input,
        }
    }

    /// Computes the derivative of an entry's squared residual with respect to a gain's logarithm,
    /// or to a delay; it is the same for the output and the input.
    pub(crate) fn squared_residual_slope(self, delta: f64, output: f64, input: f64) -> f64 {
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

    /// Converts a slope per natural logarithm unit to a slope per dB, or a slope per second to a
    /// slope per millisecond.
    pub(crate) fn per_unit(self, slope: f64) -> f64 {
        if self.is_gain() {
            slope / DECIBEL
        } else {
            SECONDS_PER_MS * slope
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

/// Coordinate in which the net value is the sum over two channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Coordinate {
    /// Natural logarithm (gains).
    Logarithm,
    /// Delay divided by `unit_s`.
    Time { unit_s: f64 },
}

impl Coordinate {
    /// Converts a gain, or a delay in seconds, to its coordinate.
    pub(crate) fn transform(self, value: f64) -> f64 {
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

    /// Converts an objective in this coordinate to the gain objective's unit, or to s².
    pub(crate) fn objective(self, objective: f64) -> f64 {
        match self {
            Coordinate::Logarithm => objective,
            Coordinate::Time { unit_s } => objective * unit_s * unit_s,
        }
    }
}
