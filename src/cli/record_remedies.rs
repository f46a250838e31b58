//! Delays and factors given for a channel in a single record (`--delay RECORD:CHANNEL=SECONDS`,
//! `--factor RECORD:CHANNEL=X`).
//!
//! A record's *layout* assigns its columns to channels, with unit, factor and delay; a record with
//! a remedy is laid out again.

use std::collections::BTreeMap;

use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_sysid::records::{LaidOutRecord, RecordChannels};

use super::channel_values::RecordChannel;
use super::failure::Failure;
use super::identify_arguments::RecordArguments;
use super::record_parts::is_called;
use super::requested_channels::{has_channel, unknown_channel};

/// Applies the delays and factors given for single records.
///
/// # Errors
/// The channel or the record is unknown, a value is given twice, or the record cannot be used with
/// the value.
pub(super) fn apply_record_remedies(
    arguments: &RecordArguments,
    records: &mut [LaidOutRecord],
    channels: &RecordChannels,
) -> Result<(), Failure> {
    // Option, full record name and channel for each value so far: a record can be identified in
    // several ways, but may have each value only once.
    let mut applied: Vec<(&str, String, &str)> = Vec::new();
    for RecordRemedy {
        option,
        record: name,
        channel,
        remedy,
    } in record_remedies(arguments)
    {
        if !has_channel(channels, channel) {
            return Err(unknown_channel(option, channel, channels));
        }
        let mut is_found = false;
        for record in records.iter_mut() {
            if !is_called(&record.table, name) {
                continue;
            }
            is_found = true;
            let key = (option, record.table.name.clone(), channel);
            if applied.contains(&key) {
                let subject = format!("{channel} of {name}");
                return Err(Failure::given_twice(option, &subject));
            }
            applied.push(key);
            let mut layout = record.layout.clone();
            layout.add_remedies(&BTreeMap::from([(channel.to_owned(), remedy)]), channels);
            *record = record.laid_out(layout, channels);
            if let Some(problem) = record.problems.first() {
                return Err(Failure::option(option, format!("{name}: {problem}")));
            }
        }
        if !is_found {
            let names: Vec<&str> = records
                .iter()
                .map(|record| record.table.name.as_str())
                .collect();
            return Err(Failure::unknown_record(option, name, &names));
        }
    }
    Ok(())
}

/// Delay or factor that an option gives for a channel in a single record.
struct RecordRemedy<'a> {
    option: &'static str,
    record: &'a str,
    channel: &'a str,
    remedy: ChannelRemedy,
}

/// Returns the options that give a delay or a factor for a channel in a single record.
fn record_remedies(arguments: &RecordArguments) -> Vec<RecordRemedy<'_>> {
    let mut remedies = Vec::new();
    for delay in &arguments.delay {
        if let Some(RecordChannel { record, channel }) = RecordChannel::parse(&delay.channel) {
            remedies.push(RecordRemedy {
                option: "--delay",
                record,
                channel,
                remedy: ChannelRemedy {
                    delay_s: delay.value,
                    ..ChannelRemedy::NONE
                },
            });
        }
    }
    for factor in &arguments.factor {
        if let Some(RecordChannel { record, channel }) = RecordChannel::parse(&factor.channel) {
            remedies.push(RecordRemedy {
                option: "--factor",
                record,
                channel,
                remedy: ChannelRemedy {
                    factor: factor.value,
                    ..ChannelRemedy::NONE
                },
            });
        }
    }
    remedies
}
