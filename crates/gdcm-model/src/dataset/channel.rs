//! Channels, responses and model bundles of a dataset; tables with an entry per response;
//! identifiers of conditions and models.

use std::fmt;
use std::ops::{Index, IndexMut};

use serde::{Deserialize, Serialize};

use crate::whole_number::whole;

/// An input (a control position) or an output (a measured motion).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Short name, unique among the inputs or among the outputs ("LON", "NY").
    pub name: String,
    /// Unit in the dataset's spelling ("%", "deg/s").
    pub unit: String,
    /// Meaning and positive direction.
    pub description: String,
}

impl Channel {
    /// Creates a channel with a name and a unit, and no description.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            description: String::new(),
        }
    }
}

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

    /// Returns the entry of a response; `None` where the table has no such response.
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

/// Iterates over the responses of a table, row by row.
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

/// Whether a channel is an aircraft input or output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ChannelSide {
    /// A control position, such as stick or pedal.
    Input,
    /// A measured motion, such as a rate or an acceleration.
    Output,
}

impl ChannelSide {
    /// Returns `inputs` or `outputs`, whichever belongs to this side.
    pub fn pick<T>(self, inputs: T, outputs: T) -> T {
        match self {
            Self::Input => inputs,
            Self::Output => outputs,
        }
    }
}

impl std::fmt::Display for ChannelSide {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.pick("input", "output"))
    }
}

/// A bundle of models in a flight condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BundleKind {
    /// The physics models: one nominal, the others at perturbed trims.
    Physics,
    /// The models identified from flight tests.
    Identified,
}

impl BundleKind {
    /// Both bundles, the physics models first.
    pub const BOTH: [BundleKind; 2] = [BundleKind::Physics, BundleKind::Identified];

    /// Returns `physics` or `identified`, whichever belongs to this bundle.
    pub fn pick<T>(self, physics: T, identified: T) -> T {
        match self {
            BundleKind::Physics => physics,
            BundleKind::Identified => identified,
        }
    }
}

impl fmt::Display for BundleKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            BundleKind::Physics => "physics",
            BundleKind::Identified => "identified",
        })
    }
}

/// Identifier of a flight condition in its dataset.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
pub struct ConditionId(#[serde(deserialize_with = "whole")] pub i64);

impl fmt::Display for ConditionId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.0)
    }
}

/// Identifier of a model in a dataset, unaffected when other models are added, removed, replaced or
/// reordered.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ModelId {
    pub condition: ConditionId,
    pub bundle: BundleKind,
    pub name: String,
}

impl ModelId {
    /// Creates the identifier of the model called `name` in a bundle of a condition.
    pub fn new(condition: ConditionId, bundle: BundleKind, name: impl Into<String>) -> Self {
        Self {
            condition,
            bundle,
            name: name.into(),
        }
    }
}

impl fmt::Display for ModelId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "condition {}, {} model \"{}\"",
            self.condition, self.bundle, self.name
        )
    }
}
