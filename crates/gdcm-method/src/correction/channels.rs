//! Input and output channels, their names, and tables with a value for each channel.

use std::ops::Index;

use gdcm_model::dataset::{Dataset, Pair};

/// An input or an output channel, identified by its index; each has a gain and a delay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    Input(usize),
    Output(usize),
}

impl Channel {
    /// Iterates over all inputs, then all outputs.
    pub fn inputs_then_outputs(inputs: usize, outputs: usize) -> impl Iterator<Item = Self> {
        (0..inputs)
            .map(Self::Input)
            .chain((0..outputs).map(Self::Output))
    }

    /// Returns a response's output and input.
    pub fn of_pair(pair: Pair) -> [Self; 2] {
        [Self::Output(pair.output), Self::Input(pair.input)]
    }

    /// Returns whether the channel is the input or the output of the response.
    pub fn belongs_to(self, pair: Pair) -> bool {
        Self::of_pair(pair).contains(&self)
    }

    /// Returns the channel name; "input 1" or "output 1", counted from 1, if the name list is too
    /// short.
    pub fn name(self, inputs: &[String], outputs: &[String]) -> String {
        match self {
            Channel::Input(index) => inputs
                .get(index)
                .cloned()
                .unwrap_or_else(|| format!("input {}", index + 1)),
            Channel::Output(index) => outputs
                .get(index)
                .cloned()
                .unwrap_or_else(|| format!("output {}", index + 1)),
        }
    }

    /// Iterates over a dataset's channels, the inputs first.
    pub fn of_dataset(dataset: &Dataset) -> impl Iterator<Item = Self> + use<> {
        Self::inputs_then_outputs(dataset.inputs().len(), dataset.outputs().len())
    }

    /// Returns the channel's name in a dataset.
    pub fn name_in(self, dataset: &Dataset) -> String {
        let (inputs, outputs) = dataset.input_and_output_names();
        self.name(&inputs, &outputs)
    }
}

/// Names a response, the input first: "PED → NY".
pub fn pair_name(pair: Pair, inputs: &[String], outputs: &[String]) -> String {
    let input = Channel::Input(pair.input).name(inputs, outputs);
    let output = Channel::Output(pair.output).name(inputs, outputs);
    format!("{input} → {output}")
}

/// Names several responses: "A, B and C".
pub fn pair_names(pairs: &[Pair], inputs: &[String], outputs: &[String]) -> String {
    let names: Vec<String> = pairs
        .iter()
        .map(|&pair| pair_name(pair, inputs, outputs))
        .collect();
    match names.as_slice() {
        [] => String::new(),
        [only] => only.clone(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

/// A value for each input and each output channel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channels<T> {
    /// Input values, m of them.
    pub inputs: Vec<T>,
    /// Output values, p of them.
    pub outputs: Vec<T>,
}

impl<T> Channels<T> {
    /// Computes a value for each channel, the inputs first.
    pub fn from_fn(inputs: usize, outputs: usize, mut value: impl FnMut(Channel) -> T) -> Self {
        Self {
            inputs: (0..inputs)
                .map(|index| value(Channel::Input(index)))
                .collect(),
            outputs: (0..outputs)
                .map(|index| value(Channel::Output(index)))
                .collect(),
        }
    }

    /// Converts every value, the inputs first.
    pub fn map<U>(&self, mut convert: impl FnMut(Channel, &T) -> U) -> Channels<U> {
        Channels::from_fn(self.inputs.len(), self.outputs.len(), |channel| {
            convert(channel, &self[channel])
        })
    }

    /// Converts every value as [`Channels::map`] does, but stops at the first error.
    pub fn try_map<U, E>(
        &self,
        mut convert: impl FnMut(Channel, &T) -> Result<U, E>,
    ) -> Result<Channels<U>, E> {
        let mut converted = Channels {
            inputs: Vec::with_capacity(self.inputs.len()),
            outputs: Vec::with_capacity(self.outputs.len()),
        };
        for (index, value) in self.inputs.iter().enumerate() {
            converted
                .inputs
                .push(convert(Channel::Input(index), value)?);
        }
        for (index, value) in self.outputs.iter().enumerate() {
            converted
                .outputs
                .push(convert(Channel::Output(index), value)?);
        }
        Ok(converted)
    }

    /// Returns a channel's value; `None` if there is no such channel.
    pub fn get(&self, channel: Channel) -> Option<&T> {
        match channel {
            Channel::Input(input) => self.inputs.get(input),
            Channel::Output(output) => self.outputs.get(output),
        }
    }

    /// Iterates over the channels with their values, the inputs first.
    pub fn iter(&self) -> impl Iterator<Item = (Channel, &T)> {
        Channel::inputs_then_outputs(self.inputs.len(), self.outputs.len())
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
