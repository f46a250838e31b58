//! Channels of a correction, their names and values for each channel; one gain and one delay or
//! lead for each (M10, M11, M15), and their effect on a response.

use std::ops::Index;

use gdcm_model::dataset::{Dataset, Pair};
use gdcm_model::response::{GainDelay, LeadFilter};

use super::leads::ChannelLeads;

/// One channel: an input or an output, each with a gain and a delay of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    Input(usize),
    Output(usize),
}

impl Channel {
    /// All inputs, then all outputs.
    pub fn all(inputs: usize, outputs: usize) -> impl Iterator<Item = Self> {
        (0..inputs)
            .map(Self::Input)
            .chain((0..outputs).map(Self::Output))
    }

    /// The output and the input of a response.
    pub fn of(pair: Pair) -> [Self; 2] {
        [Self::Output(pair.output), Self::Input(pair.input)]
    }

    /// Whether the response uses the channel.
    pub fn is_of(self, pair: Pair) -> bool {
        Self::of(pair).contains(&self)
    }

    /// Name of the channel, or its number (from 1) where the list of names is too short.
    pub fn name(self, inputs: &[String], outputs: &[String]) -> String {
        let (names, index, kind) = match self {
            Channel::Input(index) => (inputs, index, "input"),
            Channel::Output(index) => (outputs, index, "output"),
        };
        names
            .get(index)
            .cloned()
            .unwrap_or_else(|| format!("{kind} {}", index + 1))
    }

    /// All channels of a dataset, the inputs first.
    pub fn all_of(dataset: &Dataset) -> impl Iterator<Item = Self> + use<> {
        Self::all(dataset.inputs().len(), dataset.outputs().len())
    }

    /// Name of the channel in a dataset.
    pub fn name_in(self, dataset: &Dataset) -> String {
        let (inputs, outputs) = dataset.names_of_channels();
        self.name(&inputs, &outputs)
    }
}

/// Name of the response: "PED → NY".
pub fn pair_name(pair: Pair, inputs: &[String], outputs: &[String]) -> String {
    let [output, input] = Channel::of(pair).map(|channel| channel.name(inputs, outputs));
    format!("{input} → {output}")
}

/// Names of several responses: "A, B and C".
pub fn pair_names(pairs: &[Pair], inputs: &[String], outputs: &[String]) -> String {
    let names: Vec<String> = pairs
        .iter()
        .map(|&pair| pair_name(pair, inputs, outputs))
        .collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        Some((last, _)) => last.clone(),
        None => String::new(),
    }
}

/// One value for each channel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channels<T> {
    /// Values of the inputs, m.
    pub inputs: Vec<T>,
    /// Values of the outputs, p.
    pub outputs: Vec<T>,
}

impl<T> Channels<T> {
    /// Calls `of` for each channel, the inputs first.
    pub fn from_fn(inputs: usize, outputs: usize, of: impl FnMut(Channel) -> T) -> Self {
        Self::split(Channel::all(inputs, outputs).map(of).collect(), inputs)
    }

    /// Splits a list of the inputs' values followed by the outputs'.
    fn split(mut all: Vec<T>, inputs: usize) -> Self {
        let outputs = all.split_off(inputs);
        Self {
            inputs: all,
            outputs,
        }
    }

    /// Applies `of` to the value of each channel.
    pub fn map<U>(&self, mut of: impl FnMut(Channel, &T) -> U) -> Channels<U> {
        Channels::split(
            self.iter()
                .map(|(channel, value)| of(channel, value))
                .collect(),
            self.inputs.len(),
        )
    }

    /// Like [`Channels::map`], but stops at the first failure.
    pub fn try_map<U, E>(
        &self,
        mut of: impl FnMut(Channel, &T) -> Result<U, E>,
    ) -> Result<Channels<U>, E> {
        let all = self
            .iter()
            .map(|(channel, value)| of(channel, value))
            .collect::<Result<Vec<U>, E>>()?;
        Ok(Channels::split(all, self.inputs.len()))
    }

    /// Value of a channel; `None` where there is no such channel.
    pub fn get(&self, channel: Channel) -> Option<&T> {
        match channel {
            Channel::Input(input) => self.inputs.get(input),
            Channel::Output(output) => self.outputs.get(output),
        }
    }

    /// Each channel with its value, the inputs first.
    pub fn iter(&self) -> impl Iterator<Item = (Channel, &T)> {
        Channel::all(self.inputs.len(), self.outputs.len())
            .zip(self.inputs.iter().chain(&self.outputs))
    }
}

impl<T> Index<Channel> for Channels<T> {
    type Output = T;

    fn index(&self, channel: Channel) -> &T {
        match channel {
            Channel::Input(input) => &self.inputs[input],
            Channel::Output(output) => &self.outputs[output],
        }
    }
}

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
    /// Signed delays, whose positive parts are the delays above, and the filters of the negative
    /// ones; `None` where leads are not requested (M15).
    pub leads: Option<ChannelLeads>,
}

impl ChannelCorrection {
    /// Correction by these gains and delays \[s\].
    pub fn of_delays(gains: Channels<f64>, delays_s: Channels<f64>) -> Self {
        Self {
            input_gains: gains.inputs,
            output_gains: gains.outputs,
            input_delays_s: delays_s.inputs,
            output_delays_s: delays_s.outputs,
            leads: None,
        }
    }

    /// Correction by these gains and signed delays (M15).
    pub fn of_leads(gains: Channels<f64>, leads: ChannelLeads) -> Self {
        let delays_s = leads.delays_s();
        Self {
            leads: Some(leads),
            ..Self::of_delays(gains, delays_s)
        }
    }

    /// Net gain of a response, `k_o k_i` (M11).
    pub fn net_gain(&self, pair: Pair) -> f64 {
        self.output_gains[pair.output] * self.input_gains[pair.input]
    }

    /// Net delay of a response, `tau_o + tau_i` \[s\]; a negative one is a lead (M15).
    pub fn net_delay_s(&self, pair: Pair) -> f64 {
        let [output_s, input_s] = Channel::of(pair).map(|channel| self.delay_s(channel));
        output_s + input_s
    }

    /// Gain of a channel.
    pub fn gain(&self, channel: Channel) -> f64 {
        match channel {
            Channel::Input(input) => self.input_gains[input],
            Channel::Output(output) => self.output_gains[output],
        }
    }

    /// Delay of a channel \[s\]; a negative one is a lead (M15).
    pub fn delay_s(&self, channel: Channel) -> f64 {
        self.leads
            .as_ref()
            .map_or_else(|| self.pure_delay_s(channel), |leads| leads.taus_s[channel])
    }

    /// Delay of a channel without its lead \[s\].
    pub fn pure_delay_s(&self, channel: Channel) -> f64 {
        match channel {
            Channel::Input(input) => self.input_delays_s[input],
            Channel::Output(output) => self.output_delays_s[output],
        }
    }

    /// Delay of each channel \[s\]; a negative one is a lead (M15).
    pub fn signed_delays_s(&self) -> Channels<f64> {
        self.channels(|channel| self.delay_s(channel))
    }

    /// Calls `of` for each channel.
    pub fn channels<T>(&self, of: impl FnMut(Channel) -> T) -> Channels<T> {
        Channels::from_fn(self.input_gains.len(), self.output_gains.len(), of)
    }

    /// Lead filter of a channel, if it has one (M15).
    pub fn lead(&self, channel: Channel) -> Option<LeadFilter> {
        self.leads.as_ref()?.filters()[channel]
    }

    /// Returns the correction without its lead filters: its gains and the positive parts of its
    /// delays.
    pub fn without_leads(self) -> Self {
        Self {
            leads: None,
            ..self
        }
    }

    /// Factor that the correction applies to a response; `None` where its net gain is not positive
    /// (possible in a schedule of `k` itself).
    pub fn on(&self, pair: Pair) -> Option<GainDelay> {
        let leads = Channel::of(pair).map(|channel| self.lead(channel));
        Some(self.without_leads_on(pair)?.led(leads))
    }

    /// Like [`ChannelCorrection::on`], without the lead filters: the remaining factor after the
    /// filters are applied.
    pub fn without_leads_on(&self, pair: Pair) -> Option<GainDelay> {
        let gain = self.net_gain(pair);
        let delay_s = self.output_delays_s[pair.output] + self.input_delays_s[pair.input];
        (gain > 0.0).then(|| GainDelay::new(gain, delay_s))
    }
}
