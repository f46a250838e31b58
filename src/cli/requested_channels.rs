//! Channels requested by `gdcm identify` and `gdcm plan`, with the declarations about their
//! samples: columns, topics, units and factors. Declarations for a single record
//! (`RECORD:CHANNEL=…`) are applied later, to that record (`record_remedies`). A *reference* is a
//! signal that drove the control loop from outside, such as a chirp.

use gdcm_model::dataset::{Band, Dataset};
use gdcm_model::names::channel_rule::ChannelRule;
use gdcm_sysid::identification::{ChannelPreparation, Preparation};
use gdcm_sysid::records::RecordChannels;
use gdcm_sysid::records::channel_list::{ChannelList, RequestedChannel};
use gdcm_sysid::records::record_channels::{DeclaredConversion, ResamplingSettings};

use super::channel_values::{ChannelValue, RecordChannel, first_duplicate};
use super::failure::Failure;
use super::identify_arguments::RecordArguments;

/// Returns the identification band: that on the command line, or else the dataset's.
///
/// # Errors
/// The band on the command line is not valid, or there is no band.
pub(super) fn requested_band(
    arguments: &RecordArguments,
    dataset: Option<&Dataset>,
) -> Result<Band, Failure> {
    match (arguments.band.as_deref(), dataset) {
        (Some(&[min, max]), _) => {
            Band::new(min, max).map_err(|error| Failure::option("--band", error))
        }
        (_, Some(dataset)) => Ok(dataset.band()),
        _ => Err(Failure::option(
            "--band",
            "expected two frequencies in rad/s",
        )),
    }
}

/// Returns the requested channels, with the declarations about their samples.
///
/// 1. Inputs and outputs: with a dataset its channels, else those on the command line.
/// 2. References, behind the inputs.
/// 3. Columns or topics of single channels.
/// 4. Resampling: highest frequency of interest, requested sample rate, and inputs that keep their
///    logged value until the next sample (held).
/// 5. Units, then factors; a channel has either.
///
/// # Errors
/// An option names an unknown channel or one twice, contradicts the dataset's unit, or gives an
/// input or output as reference.
pub(super) fn requested_channels(
    arguments: &RecordArguments,
    dataset: Option<&Dataset>,
    band: Band,
) -> Result<RecordChannels, Failure> {
    // Step 1.
    let mut channels = match dataset {
        Some(dataset) => channels_of_dataset(arguments, dataset)?,
        None => named_channels(arguments),
    };
    // Step 2.
    add_references(arguments, &mut channels)?;
    // Step 3.
    set_locations(arguments, &mut channels)?;
    // Step 4.
    check_held(arguments, &channels)?;
    channels.resampling = ResamplingSettings {
        band_end: Some(band.max()),
        rate_hz: arguments.resample,
        held: arguments.held.iter().cloned().collect(),
    };
    // Step 5.
    declare_conversions(
        "--unit",
        &arguments.unit,
        DeclaredConversion::Unit,
        &mut channels,
    )?;
    declare_conversions(
        "--factor",
        for_all_records(&arguments.factor),
        DeclaredConversion::Factor,
        &mut channels,
    )?;
    Ok(channels)
}

/// Returns the declarations without a record name, which apply to all records.
fn for_all_records<T>(declarations: &[ChannelValue<T>]) -> Vec<&ChannelValue<T>> {
    declarations
        .iter()
        .filter(|declaration| RecordChannel::parse(&declaration.channel).is_none())
        .collect()
}

fn listed(list: &Option<ChannelList>) -> &[RequestedChannel] {
    match list {
        Some(list) => &list.channels,
        None => &[],
    }
}

/// Returns the channels listed on the command line; channels without a unit take the first record's
/// unit.
fn named_channels(arguments: &RecordArguments) -> RecordChannels {
    let inputs = listed(&arguments.inputs).iter();
    let outputs = listed(&arguments.outputs).iter();
    RecordChannels {
        inputs: inputs.map(RequestedChannel::rule).collect(),
        outputs: outputs.map(RequestedChannel::rule).collect(),
        ..RecordChannels::default()
    }
}

/// Returns the dataset's channels, in its units; columns may be given on the command line.
fn channels_of_dataset(
    arguments: &RecordArguments,
    dataset: &Dataset,
) -> Result<RecordChannels, Failure> {
    let mut channels = RecordChannels::of_dataset(dataset);
    for channel in listed(&arguments.inputs) {
        set_column("--inputs", channel, &mut channels.inputs)?;
    }
    for channel in listed(&arguments.outputs) {
        set_column("--outputs", channel, &mut channels.outputs)?;
    }
    Ok(channels)
}

/// Sets the column for a channel in the dataset; rejects a unit that differs from the dataset's.
fn set_column(
    option: &'static str,
    channel: &RequestedChannel,
    rules: &mut [ChannelRule],
) -> Result<(), Failure> {
    let RequestedChannel { name, unit, column } = channel;
    let Some(index) = rules.iter().position(|rule| rule.name == *name) else {
        let names: Vec<&str> = rules.iter().map(|rule| rule.name.as_str()).collect();
        let reason = format!(
            "the dataset has no {name} among these channels: {}",
            names.join(", ")
        );
        return Err(Failure::coded_option(option, "unknown-channel", reason));
    };
    let rule = &mut rules[index];
    if !unit.is_empty() && *unit != rule.unit {
        let reason = format!(
            "{name} is in {} in the dataset, not in {unit}; omit [{unit}] or, if the records are in \
            {unit}, add --unit {name}={unit}",
            rule.unit
        );
        return Err(Failure::option(option, reason));
    }
    rule.aliases = column.iter().cloned().collect();
    rule.unit_in_files = if unit.is_empty() {
        None
    } else {
        Some(unit.clone())
    };
    Ok(())
}

/// Adds the reference channels to the inputs, after the model's channels, because both are read in
/// the same way.
fn add_references(
    arguments: &RecordArguments,
    channels: &mut RecordChannels,
) -> Result<(), Failure> {
    for reference in arguments.references() {
        if has_channel(channels, &reference.name) {
            let reason = format!(
                "{} is already an input or an output; a reference must be another channel",
                reference.name
            );
            return Err(Failure::option("--reference", reason));
        }
        channels.inputs.push(reference.rule());
    }
    Ok(())
}

/// Sets the topics or columns given by `--topic`.
fn set_locations(
    arguments: &RecordArguments,
    channels: &mut RecordChannels,
) -> Result<(), Failure> {
    const OPTION: &str = "--topic";
    if let Some(channel) = first_duplicate(&arguments.topic) {
        return Err(Failure::given_twice(OPTION, channel));
    }
    for ChannelValue { channel, value } in &arguments.topic {
        if !has_channel(channels, channel) {
            return Err(unknown_channel(OPTION, channel, channels));
        }
        let rule = channels
            .inputs
            .iter_mut()
            .chain(&mut channels.outputs)
            .find(|rule| rule.name == *channel);
        if let Some(rule) = rule {
            rule.aliases = vec![value.clone()];
        }
    }
    Ok(())
}

/// Rejects names given by `--held` that are not inputs.
fn check_held(arguments: &RecordArguments, channels: &RecordChannels) -> Result<(), Failure> {
    for held in &arguments.held {
        if channels.inputs.iter().all(|rule| rule.name != *held) {
            let names = rule_names(&channels.inputs);
            let reason = format!("{held} is not an input; inputs are {names}");
            return Err(Failure::coded_option("--held", "unknown-channel", reason));
        }
    }
    Ok(())
}

/// Returns the channels' preparation, which removes the given delays.
pub(super) fn requested_preparation(
    arguments: &RecordArguments,
    channels: &RecordChannels,
) -> Result<Preparation, Failure> {
    const OPTION: &str = "--delay";
    let delays = for_all_records(&arguments.delay);
    for delay in &delays {
        if !has_channel(channels, &delay.channel) {
            return Err(unknown_channel(OPTION, &delay.channel, channels));
        }
    }
    if let Some(channel) = first_duplicate(delays.iter().copied()) {
        return Err(Failure::given_twice(OPTION, channel));
    }
    Ok(Preparation {
        inputs: without_delays(&channels.inputs, &delays),
        outputs: without_delays(&channels.outputs, &delays),
        ..Preparation::new(&[], &[])
    })
}

/// Returns each channel's preparation, which removes its delay if one is given.
fn without_delays(rules: &[ChannelRule], delays: &[&ChannelValue<f64>]) -> Vec<ChannelPreparation> {
    let mut prepared = Vec::new();
    for rule in rules {
        let mut channel = ChannelPreparation::named(rule.name.clone());
        channel.delay_s = match delays.iter().find(|delay| delay.channel == rule.name) {
            Some(delay) => delay.value,
            None => 0.0,
        };
        prepared.push(channel);
    }
    prepared
}

/// Returns whether an input or output has this name.
pub(super) fn has_channel(channels: &RecordChannels, name: &str) -> bool {
    let mut rules = channels.inputs.iter().chain(&channels.outputs);
    rules.any(|rule| rule.name == name)
}

/// Returns the failure for an option that names an unknown channel.
pub(super) fn unknown_channel(
    option: &'static str,
    channel: &str,
    channels: &RecordChannels,
) -> Failure {
    let reason = format!(
        "there is no channel {channel}; inputs are {}; outputs are {}",
        rule_names(&channels.inputs),
        rule_names(&channels.outputs)
    );
    Failure::coded_option(option, "unknown-channel", reason)
}

fn rule_names(rules: &[ChannelRule]) -> String {
    let names: Vec<&str> = rules.iter().map(|rule| rule.name.as_str()).collect();
    names.join(", ")
}

/// Applies an option's declarations to the channels; rejects unknown channels and duplicates.
pub(super) fn declare_conversions<'a, T: Clone + 'a>(
    option: &'static str,
    declarations: impl IntoIterator<Item = &'a ChannelValue<T>>,
    conversion: fn(T) -> DeclaredConversion,
    channels: &mut RecordChannels,
) -> Result<(), Failure> {
    for ChannelValue { channel, value } in declarations {
        if !has_channel(channels, channel) {
            return Err(unknown_channel(option, channel, channels));
        }
        let previous = channels
            .declared
            .insert(channel.clone(), conversion(value.clone()));
        if previous.is_some() {
            let reason = format!("{channel} already has a unit or a factor");
            return Err(Failure::coded_option(option, "given-twice", reason));
        }
    }
    Ok(())
}
