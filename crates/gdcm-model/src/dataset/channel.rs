//! Channels of the helicopter, one response of a dataset, and a table with one entry for each response.

use std::fmt;
use std::ops::{Index, IndexMut};

use serde::{Deserialize, Serialize};

use crate::message_text::quoted;
use crate::whole_number::whole;

/// An input (a control position) or an output (a measured motion), as the dataset names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Short name, unique among the inputs or among the outputs ("LON", "NY").
    pub name: String,
    /// Unit as the dataset writes it ("%", "deg/s").
    pub unit: String,
    /// What the channel is and which way is positive.
    pub description: String,
}

impl Channel {
    /// A channel with a name and a unit, and no description.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            description: String::new(),
        }
    }
}

/// One response: from an input channel to an output channel.
///
/// The index order is `[output, input]` everywhere (M1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Pair {
    /// Index of the output channel, in the dataset's order.
    pub output: usize,
    /// Index of the input channel, in the dataset's order.
    pub input: usize,
}

impl Pair {
    /// The response of output channel `output` to input channel `input`.
    pub fn new(output: usize, input: usize) -> Self {
        Self { output, input }
    }
}

/// A table with one entry for each response: `p` rows (outputs) by `m` columns (inputs).
#[derive(Clone, Debug, PartialEq)]
pub struct PairTable<T> {
    outputs: usize,
    inputs: usize,
    entries: Vec<T>,
}

impl<T> PairTable<T> {
    /// The table whose entry of each response is `entry(pair)`.
    pub fn from_fn(outputs: usize, inputs: usize, mut entry: impl FnMut(Pair) -> T) -> Self {
        let entries = pairs(outputs, inputs).map(&mut entry).collect();
        Self {
            outputs,
            inputs,
            entries,
        }
    }

    /// Number of output channels, `p`.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Number of input channels, `m`.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Where the entry of a response stands.
    fn place(&self, pair: Pair) -> usize {
        let outputs = self.outputs;
        let inputs = self.inputs;
        assert!(
            pair.output < outputs && pair.input < inputs,
            "{pair:?} is outside a {outputs} x {inputs} table"
        );
        pair.output * inputs + pair.input
    }

    /// The entry of a response; `None` where the table has no such response.
    pub fn get(&self, pair: Pair) -> Option<&T> {
        (pair.output < self.outputs() && pair.input < self.inputs()).then(|| &self[pair])
    }

    /// Every response, row by row.
    pub fn pairs(&self) -> impl Iterator<Item = Pair> + use<T> {
        pairs(self.outputs, self.inputs)
    }

    /// Every response with its entry, row by row.
    pub fn iter(&self) -> impl Iterator<Item = (Pair, &T)> {
        self.pairs().zip(&self.entries)
    }

    /// Every response with its entry to change, row by row.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (Pair, &mut T)> {
        self.pairs().zip(&mut self.entries)
    }

    /// The table of `f(pair, entry)`.
    pub fn map<U>(&self, mut f: impl FnMut(Pair, &T) -> U) -> PairTable<U> {
        PairTable::from_fn(self.outputs, self.inputs, |pair| f(pair, &self[pair]))
    }
}

fn pairs(outputs: usize, inputs: usize) -> impl Iterator<Item = Pair> {
    (0..outputs).flat_map(move |output| (0..inputs).map(move |input| Pair { output, input }))
}

impl<T: Clone> PairTable<T> {
    /// The table with the same entry everywhere.
    pub fn filled(outputs: usize, inputs: usize, entry: T) -> Self {
        Self {
            outputs,
            inputs,
            entries: vec![entry; outputs * inputs],
        }
    }
}

impl PairTable<bool> {
    /// The responses marked `true`, row by row.
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

/// Whether a channel goes into the aircraft or comes out of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ChannelSide {
    /// A stick, a pedal.
    Input,
    /// A rate, an acceleration.
    Output,
}

impl ChannelSide {
    /// What is of this side, out of what is of the inputs and what is of the outputs.
    pub fn of<T>(self, inputs: T, outputs: T) -> T {
        match self {
            Self::Input => inputs,
            Self::Output => outputs,
        }
    }
}

impl std::fmt::Display for ChannelSide {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.of("input", "output"))
    }
}

// What conditions and models are called, whatever their order in a file, and where in a dataset something stands.

/// A condition of a dataset that is being read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConditionPlace {
    /// Its position, counted from 1.
    pub position: usize,
    /// Its id, where that can be read.
    pub id: Option<i64>,
}

/// A model of a dataset that is being read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelPlace {
    /// Which bundle of the condition.
    pub bundle: BundleKind,
    /// Its position in the bundle, counted from 1.
    pub position: usize,
    /// Its name, where that can be read.
    pub name: Option<String>,
}

/// Where something stands: the condition, the model, and the entry (matrix, row, column), each where it applies.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Location {
    /// The condition.
    pub condition: Option<ConditionPlace>,
    /// The model.
    pub model: Option<ModelPlace>,
    /// The entry, in words; empty for the whole.
    pub entry: String,
}

impl Location {
    /// A place in words: "on-axis pair 3".
    pub fn entry(words: impl Into<String>) -> Self {
        Self {
            entry: words.into(),
            ..Self::default()
        }
    }

    /// A condition; `position` counts from 1.
    pub fn condition(position: usize, id: i64) -> Self {
        Self {
            condition: Some(ConditionPlace {
                position,
                id: Some(id),
            }),
            ..Self::default()
        }
    }

    /// A model of this condition; `position` counts from 1.
    pub fn model(&self, bundle: BundleKind, position: usize, name: &str) -> Self {
        let model = Some(ModelPlace {
            bundle,
            position,
            name: Some(name.to_owned()),
        });
        Self {
            condition: self.condition.clone(),
            model,
            entry: String::new(),
        }
    }

    /// An entry of this condition or model.
    pub fn at(&self, words: impl Into<String>) -> Self {
        Self {
            entry: words.into(),
            ..self.clone()
        }
    }

    /// The place followed by a colon and a space; nothing for the file as a whole.
    pub fn before(&self) -> String {
        let words = self.to_string();
        if words.is_empty() {
            words
        } else {
            words + ": "
        }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let condition = self
            .condition
            .as_ref()
            .map(|ConditionPlace { position, id }| match id {
                Some(id) => format!("condition {id} (number {position} in the file)"),
                None => format!("condition number {position} in the file"),
            });
        let model = self.model.as_ref().map(
            |ModelPlace {
                 bundle,
                 position,
                 name,
             }| match name {
                Some(name) => format!("{bundle} model {} (number {position})", quoted(name)),
                None => format!("{bundle} model number {position}"),
            },
        );
        let entry = Some(self.entry.clone()).filter(|entry| !entry.is_empty());
        let words: Vec<String> = [condition, model, entry].into_iter().flatten().collect();
        formatter.write_str(&words.join(", "))
    }
}

/// Which of a condition's two bundles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BundleKind {
    /// The physics models: one nominal, the others at perturbed trims.
    Physics,
    /// The models identified from flight.
    Identified,
}

impl BundleKind {
    /// Both bundles, the physics models first.
    pub const BOTH: [BundleKind; 2] = [BundleKind::Physics, BundleKind::Identified];

    /// Which of two things is of this bundle.
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

/// A flight condition: the id that its dataset gives it.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
pub struct ConditionId(#[serde(deserialize_with = "whole")] pub i64);

impl fmt::Display for ConditionId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.0)
    }
}

/// A model of a dataset: it stays the same model when others are added, removed, replaced or put in another order.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ModelId {
    /// Its condition.
    pub condition: ConditionId,
    /// Its bundle in that condition.
    pub bundle: BundleKind,
    /// Its name in that bundle.
    pub name: String,
}

impl ModelId {
    /// The model of this name in a bundle of a condition.
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
