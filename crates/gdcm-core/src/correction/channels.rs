//! The channels of a correction: which there are, what they are called, and something of each.

use std::ops::Index;

use crate::dataset::{Dataset, Pair};

/// One channel: an input or an output, each with a gain and a delay of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// The input of this index.
    Input(usize),
    /// The output of this index.
    Output(usize),
}

impl Channel {
    /// All inputs, then all outputs.
    pub fn all(inputs: usize, outputs: usize) -> impl Iterator<Item = Self> {
        (0..inputs).map(Self::Input).chain((0..outputs).map(Self::Output))
    }

    /// The output and the input of a response.
    pub fn of(pair: Pair) -> [Self; 2] {
        [Self::Output(pair.output), Self::Input(pair.input)]
    }

    /// Whether a response goes through the channel.
    pub fn is_of(self, pair: Pair) -> bool {
        Self::of(pair).contains(&self)
    }

    /// The channel's name, or its number (from 1) where the list of names is too short.
    pub fn name(self, inputs: &[String], outputs: &[String]) -> String {
        let (names, index, kind) = match self {
            Channel::Input(index) => (inputs, index, "input"),
            Channel::Output(index) => (outputs, index, "output"),
        };
        names.get(index).cloned().unwrap_or_else(|| format!("{kind} {}", index + 1))
    }

    /// All channels of a dataset, the inputs first.
    pub fn all_of(dataset: &Dataset) -> impl Iterator<Item = Self> + use<> {
        Self::all(dataset.inputs().len(), dataset.outputs().len())
    }

    /// The channel's name in a dataset.
    pub fn name_in(self, dataset: &Dataset) -> String {
        let (inputs, outputs) = dataset.names_of_channels();
        self.name(&inputs, &outputs)
    }
}

/// The response in words: "PED → NY".
pub(crate) fn pair_name(pair: Pair, inputs: &[String], outputs: &[String]) -> String {
    let [output, input] = Channel::of(pair).map(|channel| channel.name(inputs, outputs));
    format!("{input} → {output}")
}

/// Several responses in words: "A, B and C".
pub(crate) fn pair_names(pairs: &[Pair], inputs: &[String], outputs: &[String]) -> String {
    let names: Vec<String> = pairs.iter().map(|&pair| pair_name(pair, inputs, outputs)).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        Some((last, _)) => last.clone(),
        None => String::new(),
    }
}

/// Something of each channel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channels<T> {
    /// Of each input, m values.
    pub inputs: Vec<T>,
    /// Of each output, p values.
    pub outputs: Vec<T>,
}

impl<T> Channels<T> {
    /// What `of` says of each channel, the inputs first.
    pub fn from_fn(inputs: usize, outputs: usize, of: impl FnMut(Channel) -> T) -> Self {
        Self::split(Channel::all(inputs, outputs).map(of).collect(), inputs)
    }

    /// `all` is of the inputs, then of the outputs.
    fn split(mut all: Vec<T>, inputs: usize) -> Self {
        let outputs = all.split_off(inputs);
        Self { inputs: all, outputs }
    }

    /// What `of` makes of each channel's.
    pub fn map<U>(&self, mut of: impl FnMut(Channel, &T) -> U) -> Channels<U> {
        Channels::split(self.iter().map(|(channel, value)| of(channel, value)).collect(), self.inputs.len())
    }

    /// As [`Channels::map`], up to the first that fails.
    pub fn try_map<U, E>(&self, mut of: impl FnMut(Channel, &T) -> Result<U, E>) -> Result<Channels<U>, E> {
        let all = self.iter().map(|(channel, value)| of(channel, value)).collect::<Result<Vec<U>, E>>()?;
        Ok(Channels::split(all, self.inputs.len()))
    }

    /// What a channel has; none where there is no such channel.
    pub fn get(&self, channel: Channel) -> Option<&T> {
        match channel {
            Channel::Input(input) => self.inputs.get(input),
            Channel::Output(output) => self.outputs.get(output),
        }
    }

    /// Each channel with what it has, the inputs first.
    pub fn iter(&self) -> impl Iterator<Item = (Channel, &T)> {
        Channel::all(self.inputs.len(), self.outputs.len()).zip(self.inputs.iter().chain(&self.outputs))
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
