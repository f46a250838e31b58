//! One gain and one delay or lead for each channel, and what they make of a response (M10, M11).

use crate::dataset::Pair;
use crate::response::{GainDelay, LeadFilter};

use super::channel::Channel;
use super::channel_leads::ChannelLeads;

/// The correction `M_O H M_I`, each channel `k e^(-tau s)`, eq. (12), or `k L(s)` (M15).
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
    /// Signed delays, of which the delays above are the positive part, and the filters of the negative ones; none where leads are
    /// not asked for (M15).
    pub leads: Option<ChannelLeads>,
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

/// The delay of a response with its parts; a negative one is a lead (M15).
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

    /// Delay of a channel \[s\]; a negative one is a lead (M15).
    pub fn delay_s(&self, channel: Channel) -> f64 {
        match (&self.leads, channel) {
            (Some(leads), _) => leads.tau_s(channel),
            (None, Channel::Input(input)) => self.input_delays_s[input],
            (None, Channel::Output(output)) => self.output_delays_s[output],
        }
    }

    /// Delay of each input and of each output \[s\]; a negative one is a lead (M15).
    pub fn signed_delays_s(&self) -> [&[f64]; 2] {
        match &self.leads {
            Some(leads) => [leads.inputs_s(), leads.outputs_s()],
            None => [&self.input_delays_s, &self.output_delays_s],
        }
    }

    /// The lead filter of a channel, where it has one (M15).
    pub fn lead(&self, channel: Channel) -> Option<LeadFilter> {
        self.leads.as_ref()?.filter(channel)
    }

    /// The same without its lead filters: its gains and what is positive of its delays.
    pub fn without_leads(self) -> Self {
        Self { leads: None, ..self }
    }

    /// Net delay of a response.
    pub fn net_delay(&self, pair: Pair) -> NetDelay {
        let (output, input) = (Channel::Output(pair.output), Channel::Input(pair.input));
        NetDelay { output_s: self.delay_s(output), input_s: self.delay_s(input) }
    }

    /// What the correction multiplies a response by; `None` where its net gain is not positive (a schedule of `k` itself can give
    /// that).
    pub fn on(&self, pair: Pair) -> Option<GainDelay> {
        let leads = [Channel::Output(pair.output), Channel::Input(pair.input)].map(|channel| self.lead(channel));
        Some(self.without_leads_on(pair)?.led(leads))
    }

    /// As [`ChannelCorrection::on`], without the lead filters: what is left to do where those have done their part.
    pub fn without_leads_on(&self, pair: Pair) -> Option<GainDelay> {
        let gain = self.net_gain(pair).value();
        let delay_s = self.output_delays_s[pair.output] + self.input_delays_s[pair.input];
        (gain > 0.0).then(|| GainDelay::new(gain, delay_s))
    }
}
