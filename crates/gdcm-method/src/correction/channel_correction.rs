//! Correction with a gain and a delay or lead filter for each channel (M10, M15), and its effect on
//! a response.

use gdcm_model::dataset::Pair;
use gdcm_model::response::{GainDelay, LeadFilter};

use super::channel_leads::ChannelLeads;
use super::channels::{Channel, Channels};

/// The correction `M_O H M_I`; each channel contributes `k e^(-tau s)`, eq. (12), or `k L(s)`
/// (M15). `H` is the physics model's response with `m` inputs and `p` outputs; the diagonal
/// matrices `M_I` and `M_O` hold the contributions of the input and output channels.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelCorrection {
    /// Input channel gains, m values.
    pub input_gains: Vec<f64>,
    /// Output channel gains, p values.
    pub output_gains: Vec<f64>,
    /// Input channel delays \[s\], m values; not negative.
    pub input_delays_s: Vec<f64>,
    /// Output channel delays \[s\], p values; not negative.
    pub output_delays_s: Vec<f64>,
    /// Signed delays and their lead filters. The positive signed delays equal the delays above;
    /// each negative one is realised by a filter. `None` if leads are not requested (M15).
    pub leads: Option<ChannelLeads>,
}

impl ChannelCorrection {
    /// Creates a correction from gains and delays \[s\], without leads.
    pub fn of_delays(gains: Channels<f64>, delays_s: Channels<f64>) -> Self {
        Self {
            input_gains: gains.inputs,
            output_gains: gains.outputs,
            input_delays_s: delays_s.inputs,
            output_delays_s: delays_s.outputs,
            leads: None,
        }
    }

    /// Creates a correction from gains and signed delays (M15).
    pub fn of_leads(gains: Channels<f64>, leads: ChannelLeads) -> Self {
        let delays_s = leads.delays_s();
        Self {
            leads: Some(leads),
            ..Self::of_delays(gains, delays_s)
        }
    }

    /// Returns a response's net gain, `k_o k_i` (M11).
    pub fn net_gain(&self, pair: Pair) -> f64 {
        self.output_gains[pair.output] * self.input_gains[pair.input]
    }

    /// Returns a response's net delay, `tau_o + tau_i` \[s\]; a negative net delay is a lead (M15).
    pub fn net_delay_s(&self, pair: Pair) -> f64 {
        self.delay_s(Channel::Output(pair.output)) + self.delay_s(Channel::Input(pair.input))
    }

    /// Returns a channel's gain `k`; a ratio, not in dB.
    pub fn gain(&self, channel: Channel) -> f64 {
        match channel {
            Channel::Input(input) => self.input_gains[input],
            Channel::Output(output) => self.output_gains[output],
        }
    }

    /// Returns a channel's delay \[s\]; a negative delay is a lead (M15).
    pub fn delay_s(&self, channel: Channel) -> f64 {
        match &self.leads {
            Some(leads) => leads.taus_s[channel],
            None => self.pure_delay_s(channel),
        }
    }

    /// Returns a channel's delay \[s\], zero instead of a lead.
    pub fn pure_delay_s(&self, channel: Channel) -> f64 {
        match channel {
            Channel::Input(input) => self.input_delays_s[input],
            Channel::Output(output) => self.output_delays_s[output],
        }
    }

    /// Returns all channel delays \[s\]; a negative delay is a lead (M15).
    pub fn signed_delays_s(&self) -> Channels<f64> {
        self.channels(|channel| self.delay_s(channel))
    }

    /// Computes a value for each channel in this correction, the inputs first.
    pub fn channels<T>(&self, value: impl FnMut(Channel) -> T) -> Channels<T> {
        Channels::from_fn(self.input_gains.len(), self.output_gains.len(), value)
    }

    /// Returns a channel's lead filter; `None` if it has no lead (M15).
    pub fn lead(&self, channel: Channel) -> Option<LeadFilter> {
        self.leads.as_ref()?.filters()[channel]
    }

    /// Returns the correction without its lead filters: its gains and its positive delays.
    pub fn without_leads(self) -> Self {
        Self {
            leads: None,
            ..self
        }
    }

    /// Returns the gain, delay and lead filters that correct a response; `None` if its net gain is
    /// not positive, which is possible if `k`, not `ln k`, is scheduled.
    pub fn on(&self, pair: Pair) -> Option<GainDelay> {
        let leads = Channel::of_pair(pair).map(|channel| self.lead(channel));
        Some(self.without_leads_on(pair)?.with_leads(leads))
    }

    /// Returns the same as [`ChannelCorrection::on`], but without the lead filters; used for a
    /// response to which the filters have already been applied.
    pub fn without_leads_on(&self, pair: Pair) -> Option<GainDelay> {
        let gain = self.net_gain(pair);
        let delay_s = self.output_delays_s[pair.output] + self.input_delays_s[pair.input];
        if gain > 0.0 {
            Some(GainDelay::new(gain, delay_s))
        } else {
            None
        }
    }
}
