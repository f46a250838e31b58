//! A dataset's responses, and tables with an entry per response.

use std::ops::{Index, IndexMut};

/// A response from an input channel to an output channel.
///
/// The index order is `[output, input]` everywhere (M1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Pair {
    /// Output index, in the dataset's order.
    pub output: usize,
    /// Input index, in the dataset's order.
    pub input: usize,
}

impl Pair {
    /// Creates the response from channel `input` to channel `output`.
    pub fn new(output: usize, input: usize) -> Self {
        Self { output, input }
    }
}

/// A table with an entry per response: `p` rows (outputs) by `m` columns (inputs), stored row by
/// row.
#[derive(Clone, Debug, PartialEq)]
pub struct PairTable<T> {
    outputs: usize,
    inputs: usize,
    entries: Vec<T>,
}

impl<T> PairTable<T> {
    /// Creates the table with entry `entry(pair)` for each response.
    pub fn from_fn(outputs: usize, inputs: usize, mut entry: impl FnMut(Pair) -> T) -> Self {
        let entries = pairs(outputs, inputs).map(&mut entry).collect();
        Self {
            outputs,
            inputs,
            entries,
        }
    }

    /// Returns the output count, `p`.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Returns the input count, `m`.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    fn place(&self, pair: Pair) -> usize {
        let outputs = self.outputs;
        let inputs = self.inputs;
        assert!(
            pair.output < outputs && pair.input < inputs,
            "{pair:?} is outside a {outputs} x {inputs} table"
        );
        pair.output * inputs + pair.input
    }

    /// Returns a response's entry; `None` where the table has no such response.
    pub fn get(&self, pair: Pair) -> Option<&T> {
        if pair.output < self.outputs && pair.input < self.inputs {
            Some(&self[pair])
        } else {
            None
        }
    }

    /// Iterates over the responses, row by row.
    pub fn pairs(&self) -> impl Iterator<Item = Pair> + use<T> {
        pairs(self.outputs, self.inputs)
    }

    /// Iterates over the responses with their entries, row by row.
    pub fn iter(&self) -> impl Iterator<Item = (Pair, &T)> {
        self.pairs().zip(&self.entries)
    }

    /// Iterates over the responses with mutable entries, row by row.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (Pair, &mut T)> {
        self.pairs().zip(&mut self.entries)
    }

    /// Returns the table with entries `f(pair, entry)`.
    pub fn map<U>(&self, mut f: impl FnMut(Pair, &T) -> U) -> PairTable<U> {
        PairTable::from_fn(self.outputs, self.inputs, |pair| f(pair, &self[pair]))
    }
}

/// Iterates over the responses in a table, row by row.
fn pairs(outputs: usize, inputs: usize) -> impl Iterator<Item = Pair> {
    (0..outputs).flat_map(move |output| (0..inputs).map(move |input| Pair { output, input }))
}

impl<T: Clone> PairTable<T> {
    /// Creates a table with the same entry everywhere.
    pub fn filled(outputs: usize, inputs: usize, entry: T) -> Self {
        Self {
            outputs,
            inputs,
            entries: vec![entry; outputs * inputs],
        }
    }
}

impl PairTable<bool> {
    /// Iterates over the responses marked `true`, row by row.
    pub fn marked(&self) -> impl Iterator<Item = Pair> + '_ {
        self.iter()
            .filter(|(_, marked)| **marked)
            .map(|(pair, _)| pair)
    }
}

impl<T> PairTable<Vec<T>> {
    /// Returns output, input and frequency count for a table of curves: `expected` frequencies if
    /// every curve has them, otherwise the length of the first curve that differs.
    pub fn curve_shape(&self, expected: usize) -> [usize; 3] {
        let other = self
            .iter()
            .map(|(_, curve)| curve.len())
            .find(|&points| points != expected);
        [self.outputs, self.inputs, other.unwrap_or(expected)]
    }
}

impl<T> Index<Pair> for PairTable<T> {
    type Output = T;

    fn index(&self, pair: Pair) -> &T {
        &self.entries[self.place(pair)]
    }
}

impl<T> IndexMut<Pair> for PairTable<T> {
    fn index_mut(&mut self, pair: Pair) -> &mut T {
        let place = self.place(pair);
        &mut self.entries[place]
    }
}
