//! The channels to read from records, from a dataset or a user's list.

use std::collections::{BTreeMap, BTreeSet};

use gdcm_model::dataset::{Channel, Dataset};
use gdcm_model::names::channel_rule::ChannelRule;

/// User-defined conversion; overrides the file.
#[derive(Clone, Debug, PartialEq)]
pub enum DeclaredConversion {
    /// The samples' unit.
    Unit(String),
    /// Channel units per column unit; negative for the opposite sign.
    Factor(f64),
}

/// Settings for combining topics with separate clocks into a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResamplingSettings {
    /// Upper band end \[rad/s\]; `None` if unknown.
    pub band_end: Option<f64>,
    /// Requested sample rate \[Hz\]; records with a single clock are then resampled too. With
    /// `None`, the rate follows from the channels and the band
    /// ([`CommonClock::choose`](super::common_clock::CommonClock::choose)), and records with a
    /// single clock are not resampled.
    pub rate_hz: Option<f64>,
    /// Inputs treated as constant between logged samples, even if they never repeat a sample.
    pub held: BTreeSet<String>,
}

/// Inputs and outputs to read from records. A channel without a unit takes the file's unit; a
/// channel with aliases is searched only by its aliases.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordChannels {
    pub inputs: Vec<ChannelRule>,
    pub outputs: Vec<ChannelRule>,
    /// User-defined conversions by channel name.
    pub declared: BTreeMap<String, DeclaredConversion>,
    pub resampling: ResamplingSettings,
}

impl RecordChannels {
    /// Returns a dataset's channels, in its units.
    pub fn of_dataset(dataset: &Dataset) -> Self {
        Self {
            inputs: dataset.inputs().iter().map(rule_of_channel).collect(),
            outputs: dataset.outputs().iter().map(rule_of_channel).collect(),
            declared: BTreeMap::new(),
            resampling: ResamplingSettings {
                band_end: Some(dataset.band().max()),
                ..ResamplingSettings::default()
            },
        }
    }

    /// Returns the channels for records that the dataset names: files without a unit are taken to
    /// be in the dataset's units.
    #[must_use]
    pub fn of_named_records(mut self) -> Self {
        for rule in self.inputs.iter_mut().chain(&mut self.outputs) {
            rule.unit_in_files = Some(rule.unit.clone());
        }
        self
    }
}

/// Returns the rule for a dataset's channel, in its unit.
fn rule_of_channel(channel: &Channel) -> ChannelRule {
    ChannelRule {
        unit: channel.unit.clone(),
        ..ChannelRule::named(channel.name.clone())
    }
}
