//! One gain and one delay for each channel, and what they make of a response (M10, M11).

use crate::dataset::Pair;
use crate::response::GainDelay;

/// The correction `M_O H M_I`, each channel `k e^(-tau s)`, eq. (12).
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelCorrection {
    /// Gain of each input channel, m values.
    pub input_gains: Vec<f64>,
    /// Gain of each output channel, p values.
    pub output_gains: Vec<f64>,
    /// Delay of each input channel \[s\], m values.
    pub input_delays_s: Vec<f64>,
    /// Delay of each output channel \[s\], p values.
    pub output_delays_s: Vec<f64>,
}

/// The gain of a response with its parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetGain {
    /// Gain of the output channel, `k_o`.
    pub output: f64,
    /// Gain of the input channel, `k_i`.
    pub input: f64,
}

impl NetGain {
    /// `k_o k_i` (M11).
    pub fn value(self) -> f64 {
        self.output * self.input
    }
}

/// The delay of a response with its parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetDelay {
    /// Delay of the output channel, `tau_o` \[s\].
    pub output_s: f64,
    /// Delay of the input channel, `tau_i` \[s\].
    pub input_s: f64,
}

impl NetDelay {
    /// `tau_o + tau_i` \[s\].
    pub fn value_s(self) -> f64 {
        self.output_s + self.input_s
    }
}

impl ChannelCorrection {
    /// Net gain of a response.
    pub fn net_gain(&self, pair: Pair) -> NetGain {
        NetGain { output: self.output_gains[pair.output], input: self.input_gains[pair.input] }
    }

    /// Net delay of a response.
    pub fn net_delay(&self, pair: Pair) -> NetDelay {
        NetDelay { output_s: self.output_delays_s[pair.output], input_s: self.input_delays_s[pair.input] }
    }

    /// What the correction multiplies a response by; `None` where its net gain is not positive (a schedule of `k` itself can give
    /// that).
    pub fn on(&self, pair: Pair) -> Option<GainDelay> {
        let gain = self.net_gain(pair).value();
        (gain > 0.0).then(|| GainDelay::new(gain, self.net_delay(pair).value_s()))
    }
}
