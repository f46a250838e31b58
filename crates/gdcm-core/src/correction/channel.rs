//! A channel of the correction, and what it is called.

use crate::dataset::Pair;

/// One channel: an input or an output, each with a gain and a delay of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// The input of this index.
    Input(usize),
    /// The output of this index.
    Output(usize),
}

impl Channel {
    /// The channel's name, or its number (from 1) where the list of names is too short.
    pub fn name(self, inputs: &[String], outputs: &[String]) -> String {
        let (names, index, kind) = match self {
            Channel::Input(index) => (inputs, index, "input"),
            Channel::Output(index) => (outputs, index, "output"),
        };
        names.get(index).cloned().unwrap_or_else(|| format!("{kind} {}", index + 1))
    }
}

/// The response in words: "PED → NY".
pub(crate) fn pair_name(pair: Pair, inputs: &[String], outputs: &[String]) -> String {
    let input = Channel::Input(pair.input).name(inputs, outputs);
    format!("{input} → {}", Channel::Output(pair.output).name(inputs, outputs))
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
