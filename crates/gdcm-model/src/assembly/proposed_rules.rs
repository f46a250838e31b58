//! Rules proposed from the models found, as long as the engineer has given none.
//!
//! *On-axis* responses are those that matter, such as the pitch rate Q to the stick LON (M1).

use std::cmp::Reverse;
use std::collections::BTreeSet;

use super::found_model::{ChannelLabel, FoundModel};
use super::rules::Rules;
use crate::dataset::channel::ChannelSide;
use crate::names::channel_alias::same_channel;
use crate::names::on_axis::STANDARD_ON_AXIS;
use crate::names::{ChannelRule, KnownChannels, SignedName};
use crate::units::physical_unit::conversion_factor;

/// Proposes rules: the models' channels with names and units, the standard patterns, and the
/// standard on-axis responses among these channels. Other rules remain unset.
pub fn proposed_rules(name: &str, models: &[FoundModel]) -> Rules {
    let models: Vec<LabelledModel<'_>> = models.iter().map(LabelledModel::new).collect();
    let inputs = proposed_channels(&models, ChannelSide::Input);
    let outputs = proposed_channels(&models, ChannelSide::Output);
    let mut on_axis = Vec::new();
    for (output, input) in STANDARD_ON_AXIS {
        if let Some(output) = find_channel(&outputs, output)
            && let Some(input) = find_channel(&inputs, input)
        {
            on_axis.push((output, input));
        }
    }
    Rules {
        name: name.to_owned(),
        inputs,
        outputs,
        on_axis,
        ..Rules::default()
    }
}

/// Returns the dataset's name for a channel given by any alias; `None` if the dataset does not have
/// it.
fn find_channel(channels: &[ChannelRule], name: &str) -> Option<String> {
    let channel = channels
        .iter()
        .find(|channel| same_channel(&channel.name, name))?;
    Some(channel.name.clone())
}

/// A model with its channel names: those stated in the file or, without any, those in the variable
/// name or file name.
struct LabelledModel<'m> {
    found: &'m FoundModel,
    /// Inputs and outputs.
    labels: [Vec<ChannelLabel>; 2],
}

impl<'m> LabelledModel<'m> {
    fn new(found: &'m FoundModel) -> Self {
        Self {
            found,
            labels: found.labels_with_name(KnownChannels::AliasTable).labels,
        }
    }

    fn labels(&self, side: ChannelSide) -> &[ChannelLabel] {
        let [inputs, outputs] = &self.labels;
        side.pick(inputs, outputs)
    }

    fn named_count(&self, side: ChannelSide) -> usize {
        self.labels(side)
            .iter()
            .filter(|label| label.name.is_some())
            .count()
    }

    /// Returns whether the file, rather than its name, names a channel on this side.
    fn names_itself(&self, side: ChannelSide) -> bool {
        side.pick(&self.found.inputs, &self.found.outputs)
            .iter()
            .any(|label| label.name.is_some())
    }

    fn is_measured(&self) -> bool {
        self.found.response().is_some()
    }
}

/// Proposes the dataset channels on a side, inputs or outputs.
///
/// 1. Start with the model with the most named channels; prefer names in files to file names.
/// 2. Take its channels. If it is a measured response, which may have a single channel, add the
///    channels of other measured responses; models with matrices have all channels.
/// 3. Give each channel the unit that is used by most files.
/// 4. If there are no channels, or no model with matrices names its channels, number the missing
///    channels, up to the largest number that a model has.
fn proposed_channels(models: &[LabelledModel<'_>], side: ChannelSide) -> Vec<ChannelRule> {
    // Step 1.
    let mut most_named_first: Vec<&LabelledModel<'_>> = models.iter().collect();
    most_named_first
        .sort_by_key(|model| (Reverse(model.named_count(side)), !model.names_itself(side)));
    let first_is_measured = most_named_first
        .first()
        .is_some_and(|model| model.is_measured());
    // Step 2; the units are counted meanwhile.
    let mut channels: Vec<ChannelRule> = Vec::new();
    let mut units: Vec<UnitCounts> = Vec::new();
    for model in most_named_first {
        let may_add = channels.is_empty() || (model.is_measured() && first_is_measured);
        for label in model.labels(side) {
            let Some(name) = &label.name else {
                continue;
            };
            let name = SignedName::parse(name).name;
            let known = channels
                .iter()
                .position(|channel| same_channel(&channel.name, &name));
            let index = match known {
                Some(index) => index,
                None if may_add => {
                    channels.push(ChannelRule::named(name));
                    units.push(UnitCounts::default());
                    channels.len() - 1
                }
                None => continue,
            };
            if let Some(unit) = label.unit.as_deref()
                && !unit.trim().is_empty()
            {
                units[index].add(unit, model.found.file());
            }
        }
    }
    // Step 3.
    for (channel, units) in channels.iter_mut().zip(units) {
        channel.unit = units.most_used();
    }
    // Step 4.
    let no_matrices_named = models
        .iter()
        .all(|model| model.is_measured() || model.named_count(side) == 0);
    if channels.is_empty() || no_matrices_named {
        let count = models.iter().map(|model| model.labels(side).len()).max();
        for number in channels.len() + 1..=count.unwrap_or(0) {
            channels.push(ChannelRule::named(format!("{side} {number}")));
        }
    }
    channels
}

/// A channel's units, each with the files that use it.
#[derive(Default)]
struct UnitCounts<'m> {
    units: Vec<UnitFiles<'m>>,
}

struct UnitFiles<'m> {
    unit: &'m str,
    files: BTreeSet<&'m str>,
}

impl<'m> UnitCounts<'m> {
    /// Adds a unit; spellings such as "deg/s" and "°/s" count as the same unit.
    fn add(&mut self, unit: &'m str, file: &'m str) {
        for known in &mut self.units {
            if conversion_factor(known.unit, unit) == Some(1.0) {
                known.files.insert(file);
                return;
            }
        }
        self.units.push(UnitFiles {
            unit,
            files: BTreeSet::from([file]),
        });
    }

    /// Returns the unit that most files use, the first if several are equally frequent; empty if no
    /// file gives a unit.
    fn most_used(&self) -> String {
        let most = self.units.iter().map(|unit| unit.files.len()).max();
        for unit in &self.units {
            if Some(unit.files.len()) == most {
                return unit.unit.to_owned();
            }
        }
        String::new()
    }
}
