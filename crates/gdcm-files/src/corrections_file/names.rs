//! Results by the names of their channels and models.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserializer, MapAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};

use gdcm_core::correction::{self, ChannelLeads};
use gdcm_core::dataset::{Channel, Dataset, Pair, PairTable};
use gdcm_core::response::LeadFilter;

use super::schema::{Channels, LeadChannels, LeadEntry, Table};

/// One figure for each channel or model, by name, in the dataset's order: `{"LON": 1.1, "LAT": 1.0}`.
#[derive(Clone, Debug, PartialEq)]
pub struct ByName<T>(pub Vec<(String, T)>);

impl<T> ByName<T> {
    /// The figure of this name.
    pub fn get(&self, name: &str) -> Option<&T> {
        self.0.iter().find(|(named, _)| named == name).map(|(_, figure)| figure)
    }
}

impl<T: Serialize> Serialize for ByName<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, figure)| (name, figure)))
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for ByName<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries(PhantomData))
    }
}

struct Entries<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
    type Value = ByName<T>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object with a figure for each name")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<ByName<T>, A::Error> {
        let mut figures = Vec::new();
        while let Some(entry) = entries.next_entry()? {
            figures.push(entry);
        }
        Ok(ByName(figures))
    }
}

/// The names of a dataset's channels.
pub(super) struct ChannelNames {
    pub(super) inputs: Vec<String>,
    pub(super) outputs: Vec<String>,
}

impl ChannelNames {
    pub(super) fn of(dataset: &Dataset) -> Self {
        let names = |channels: &[Channel]| channels.iter().map(|channel| channel.name.clone()).collect();
        Self { inputs: names(dataset.inputs()), outputs: names(dataset.outputs()) }
    }

    /// The names of a pair, output first.
    pub(super) fn pair(&self, pair: Pair) -> (String, String) {
        (self.outputs[pair.output].clone(), self.inputs[pair.input].clone())
    }

    /// The name of a channel of the correction.
    pub(super) fn channel(&self, channel: correction::Channel) -> String {
        channel.name(&self.inputs, &self.outputs)
    }

    /// The names of the marked pairs.
    pub(super) fn marked(&self, table: &PairTable<bool>) -> Vec<(String, String)> {
        table.marked().map(|pair| self.pair(pair)).collect()
    }

    /// One figure for each input.
    pub(super) fn by_input<T>(&self, figures: impl IntoIterator<Item = T>) -> ByName<T> {
        ByName(self.inputs.iter().cloned().zip(figures).collect())
    }

    /// One figure for each output.
    pub(super) fn by_output<T>(&self, figures: impl IntoIterator<Item = T>) -> ByName<T> {
        ByName(self.outputs.iter().cloned().zip(figures).collect())
    }

    /// The signed delay and the filter of each channel.
    pub(super) fn leads(&self, leads: &ChannelLeads) -> LeadChannels {
        let entry = |(&tau_s, filter): (&f64, &Option<LeadFilter>)| LeadEntry {
            tau_s,
            lead_s: filter.map(LeadFilter::lead_s),
            zero_rad_s: filter.map(LeadFilter::zero_rad_s),
            lag_rad_s: filter.map(LeadFilter::lag_rad_s),
            gain_at_infinity_db: filter.map(LeadFilter::gain_at_infinity_db),
        };
        let [inputs, outputs] = leads.filters();
        LeadChannels {
            inputs: self.by_input(leads.inputs_s().iter().zip(inputs).map(entry)),
            outputs: self.by_output(leads.outputs_s().iter().zip(outputs).map(entry)),
        }
    }

    /// One figure for each channel.
    pub(super) fn channels(&self, inputs: &[f64], outputs: &[f64]) -> Channels {
        Channels { inputs: self.by_input(inputs.iter().copied()), outputs: self.by_output(outputs.iter().copied()) }
    }
}

/// A table as rows of outputs; what is not finite is left empty, for JSON has no such numbers.
pub(super) fn rows<T>(table: &PairTable<Option<T>>, figure: impl Fn(&T) -> f64) -> Table {
    let entry = |output, input| {
        let entry = table[Pair { output, input }].as_ref().map(&figure);
        entry.filter(|value| value.is_finite())
    };
    (0..table.outputs()).map(|output| (0..table.inputs()).map(|input| entry(output, input)).collect()).collect()
}
