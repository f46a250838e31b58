//! The figures of a condition that have a bar, and a table with one entry for each.

use std::ops::{Index, IndexMut};

use crate::correction::Channel;
use crate::dataset::Pair;

/// One figure of a condition's analysis, `q` of M13.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scalar {
    /// `ln G` of a response.
    Gain(Pair),
    /// `D` of a response \[s\].
    Delay(Pair),
    /// `ln k_o k_i` of a response.
    NetGain(Pair),
    /// `ln k` of a channel.
    ChannelGain(Channel),
    /// `tau` of a channel \[s\].
    ChannelDelay(Channel),
}

impl Scalar {
    /// Whether it is a time; otherwise it is the natural logarithm of a gain.
    pub fn is_delay(self) -> bool {
        matches!(self, Self::Delay(_) | Self::ChannelDelay(_))
    }
}

/// A table with one entry for each figure of a condition with `p` outputs and `m` inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalarTable<T> {
    outputs: usize,
    inputs: usize,
    entries: Vec<T>,
}

impl<T> ScalarTable<T> {
    /// The table whose entry of each figure is `entry(figure)`.
    pub fn from_fn(outputs: usize, inputs: usize, entry: impl FnMut(Scalar) -> T) -> Self {
        Self { outputs, inputs, entries: scalars(outputs, inputs).map(entry).collect() }
    }

    /// Every figure with its entry.
    pub fn iter(&self) -> impl Iterator<Item = (Scalar, &T)> {
        scalars(self.outputs, self.inputs).zip(&self.entries)
    }

    /// The table of `f(figure, entry)`.
    pub fn map<U>(&self, mut f: impl FnMut(Scalar, &T) -> U) -> ScalarTable<U> {
        let entries = self.iter().map(|(scalar, entry)| f(scalar, entry)).collect();
        ScalarTable { outputs: self.outputs, inputs: self.inputs, entries }
    }

    fn place(&self, scalar: Scalar) -> usize {
        let (p, m) = (self.outputs, self.inputs);
        let of_pair = |pair: Pair| {
            assert!(pair.output < p && pair.input < m, "{pair:?} is outside a {p} x {m} table");
            pair.output * m + pair.input
        };
        let of_channel = |channel| match channel {
            Channel::Input(input) => input,
            Channel::Output(output) => m + output,
        };
        match scalar {
            Scalar::Gain(pair) => of_pair(pair),
            Scalar::Delay(pair) => p * m + of_pair(pair),
            Scalar::NetGain(pair) => 2 * p * m + of_pair(pair),
            Scalar::ChannelGain(channel) => 3 * p * m + of_channel(channel),
            Scalar::ChannelDelay(channel) => 3 * p * m + p + m + of_channel(channel),
        }
    }
}

impl<T> Index<Scalar> for ScalarTable<T> {
    type Output = T;

    fn index(&self, scalar: Scalar) -> &T {
        &self.entries[self.place(scalar)]
    }
}

impl<T> IndexMut<Scalar> for ScalarTable<T> {
    fn index_mut(&mut self, scalar: Scalar) -> &mut T {
        let place = self.place(scalar);
        &mut self.entries[place]
    }
}

/// Every figure, in the order of the entries.
fn scalars(outputs: usize, inputs: usize) -> impl Iterator<Item = Scalar> {
    let pairs = move |of: fn(Pair) -> Scalar| {
        (0..outputs).flat_map(move |output| (0..inputs).map(move |input| of(Pair::new(output, input))))
    };
    let channels = move |of: fn(Channel) -> Scalar| {
        (0..inputs)
            .map(move |input| of(Channel::Input(input)))
            .chain((0..outputs).map(move |output| of(Channel::Output(output))))
    };
    pairs(Scalar::Gain)
        .chain(pairs(Scalar::Delay))
        .chain(pairs(Scalar::NetGain))
        .chain(channels(Scalar::ChannelGain))
        .chain(channels(Scalar::ChannelDelay))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_a_place_of_its_own() {
        let mut table = ScalarTable::from_fn(3, 2, |scalar| scalar);
        assert!(table.iter().all(|(scalar, entry)| scalar == *entry && table[scalar] == scalar));
        assert_eq!(table.iter().count(), 3 * 6 + 2 * 5);
        table[Scalar::ChannelDelay(Channel::Output(2))] = Scalar::Gain(Pair::new(0, 0));
        assert_eq!(table.iter().last().map(|(_, entry)| *entry), Some(Scalar::Gain(Pair::new(0, 0))));
    }
}
