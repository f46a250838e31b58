//! The command line of `gdcm identify`, and the channels that it requests.

use std::collections::BTreeSet;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use gdcm_model::dataset::{Band, Dataset};
use gdcm_model::names::ChannelRule;
use gdcm_model::units::number;
use gdcm_study::decisions::adopted_models::OfferedModels;
use gdcm_sysid::identification::{ChannelPreparation, Preparation, SearchSpace};
use gdcm_sysid::records::RecordChannels;
use gdcm_sysid::records::channel_list::{ChannelList, SaidChannel};
use gdcm_sysid::records::record_channels::{ResamplingWish, SaidConversion};

use super::arguments::{OfChannel, real_number, whole_number};
use super::terminal::Failure;

/// Which flight records models are to be identified from, and how.
#[derive(Debug, Args)]
pub struct IdentifyArguments {
    /// Flight records of one condition, or with --every-condition of many: files, or folders with all that is in them (text, MATLAB, NumPy, JSON, zip; logs of PX4, ArduPilot and Betaflight).
    #[arg(value_name = "RECORD", required = true)]
    pub records: Vec<PathBuf>,
    /// Inputs, separated by commas (LON,LAT), each as CHANNEL, its unit behind it in square brackets where that is to be said, or as CHANNEL=COLUMN (its name, in quotation marks where it has a comma, or #3 for the third column); without it, those of the dataset.
    #[arg(long, value_name = "NAMES", required_unless_present = "into")]
    pub inputs: Option<ChannelList>,
    /// Outputs, in the same way.
    #[arg(long, value_name = "NAMES", required_unless_present = "into")]
    pub outputs: Option<ChannelList>,
    /// Band to identify, in rad/s; without it, that of the dataset.
    #[arg(
        long,
        num_args = 2,
        value_names = ["LO", "HI"],
        value_parser = real_number,
        allow_negative_numbers = true,
        required_unless_present = "into"
    )]
    pub band: Option<Vec<f64>>,
    /// Column of the time; without it, the one that looks like it.
    #[arg(long, value_name = "NAME")]
    pub time: Option<String>,
    /// Where a channel is found: its topic and the field of it (TOPIC.FIELD), or its column; may be repeated.
    #[arg(long, value_name = "CHANNEL=TOPIC.FIELD", value_parser = channel_topic)]
    pub topic: Vec<OfChannel<String>>,
    /// Samples in a second that the records are brought to, every channel through the same low-pass; without it, topics with clocks of their own are brought to a rate that the band takes, and nothing else is resampled.
    #[arg(long, value_name = "HZ", value_parser = positive_rate, allow_negative_numbers = true)]
    pub resample: Option<f64>,
    /// An input that acts as it was logged until its next sample (sample and hold); may be repeated.
    #[arg(long, value_name = "CHANNEL")]
    pub held: Vec<String>,
    /// A part of the records, from A to B seconds on their own clock, or as +A:+B from their start, is a record of its own; of one record alone with its name before (RECORD:A:B); may be repeated, and --hold-out A:B holds one out.
    #[arg(long, value_name = "A:B", value_parser = record_part, allow_hyphen_values = true)]
    pub part: Vec<RecordPart>,
    /// Samples in a second, in place of a column of the time.
    #[arg(long, value_name = "HZ", value_parser = real_number, conflicts_with = "time", allow_negative_numbers = true)]
    pub sample_rate: Option<f64>,
    /// A record to validate with, kept from identification: its file or its name; may be repeated. Without it, those whose names say so.
    #[arg(long, value_name = "FILE")]
    pub hold_out: Vec<String>,
    /// A known delay of a channel, in seconds, positive where it is logged late; in one record alone with its name before (RECORD:CHANNEL=SECONDS); may be repeated.
    #[arg(long, value_name = "CHANNEL=SECONDS", value_parser = channel_delay, allow_hyphen_values = true)]
    pub delay: Vec<OfChannel<f64>>,
    /// Recorded references that drove the loop from outside (a chirp, a position reference), in the same way as inputs: gusts fed back into the inputs no longer bias the response.
    #[arg(long, value_name = "NAMES")]
    pub reference: Option<ChannelList>,
    /// Order of the model, in place of those that the records can carry; may be repeated.
    #[arg(long, value_name = "N", value_parser = whole_number::<1, 60>)]
    pub order: Vec<usize>,
    /// Past window: so many Laguerre projections predict the next, in place of those that the records can carry; may be repeated.
    #[arg(long, value_name = "N", value_parser = whole_number::<1, 60>)]
    pub past: Vec<usize>,
    /// Laguerre pole, in rad/s, in place of 0.375, 0.54 and 0.75 times the upper end of the band; may be repeated.
    #[arg(long, value_name = "RAD/S", value_parser = real_number)]
    pub pole: Vec<f64>,
    /// The unit of a channel's samples, whatever their file says; may be repeated.
    #[arg(long, value_name = "CHANNEL=UNIT", value_parser = channel_unit)]
    pub unit: Vec<OfChannel<String>>,
    /// What a channel's samples are multiplied by, negative where the sign is the other one; in one record alone with its name before (RECORD:CHANNEL=X); may be repeated.
    #[arg(long, value_name = "CHANNEL=X", value_parser = channel_factor, allow_hyphen_values = true)]
    pub factor: Vec<OfChannel<f64>>,
    /// Dataset that the models are put into; it is written anew, beside identified.json.
    #[arg(long, value_name = "DATASET", requires = "where")]
    pub into: Option<PathBuf>,
    /// The condition of the dataset, by its id.
    #[arg(
        long,
        value_name = "ID",
        requires = "into",
        allow_negative_numbers = true,
        group = "where"
    )]
    pub condition: Option<i64>,
    /// Every condition of the dataset: each record goes to the one that its name, or that of its folder, says.
    #[arg(long, requires = "into", group = "where")]
    pub every_condition: bool,
    /// Which of the models are put into the dataset.
    #[arg(
        long,
        value_enum,
        value_name = "WHICH",
        default_value_t,
        requires = "into"
    )]
    pub take: OfferedChoice,
    /// Description of the dataset that is written; without it, as it was.
    #[arg(long, value_name = "TEXT", requires = "into")]
    pub description: Option<String>,
    /// Directory for identified.json (identified-condition-ID.json with --every-condition); made where there is none.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Overwrite files that are there already.
    #[arg(long)]
    pub force: bool,
}

impl IdentifyArguments {
    /// Returns the references, each with its column if one is given.
    pub fn references(&self) -> &[SaidChannel] {
        self.reference.as_ref().map_or(&[], |list| &list.channels)
    }

    /// Returns the search settings that replace the defaults.
    pub fn search(&self) -> SearchSpace {
        SearchSpace {
            orders: self.order.clone(),
            pasts: self.past.clone(),
            poles: self.pole.clone(),
        }
    }

    /// Returns the identification band; by default that of the dataset.
    pub(super) fn band(&self, dataset: Option<&Dataset>) -> Result<Band, Failure> {
        match (self.band.as_deref(), dataset) {
            (Some(&[min, max]), _) => {
                Band::new(min, max).map_err(|error| Failure::option("--band", error))
            }
            (_, Some(dataset)) => Ok(dataset.band()),
            _ => Err(Failure::option("--band", "expected two frequencies")),
        }
    }

    /// Returns the requested channels, with the declarations about their samples.
    pub(super) fn channels(
        &self,
        dataset: Option<&Dataset>,
        band: Band,
    ) -> Result<RecordChannels, Failure> {
        let mut channels = self.named_channels(dataset)?;
        for reference in self.references() {
            if has_channel(&channels, &reference.name) {
                let reason = format!(
                    "{} is an input or an output already; a reference is neither",
                    reference.name
                );
                return Err(Failure::option("--reference", reason));
            }
            // References are read like inputs, after those of the model.
            channels.inputs.push(reference.rule());
        }
        if let Some(channel) = said_twice(&self.topic) {
            return Err(Failure::option(
                "--topic",
                format!("{channel} stands twice; a channel is found in one place"),
            ));
        }
        for OfChannel { channel, said } in &self.topic {
            let rule = channels
                .inputs
                .iter_mut()
                .chain(&mut channels.outputs)
                .find(|rule| rule.name == *channel);
            rule.ok_or_else(|| unknown("--topic", channel))?.aliases = vec![said.clone()];
        }
        if let Some(held) = self
            .held
            .iter()
            .find(|held| channels.inputs.iter().all(|rule| rule.name != **held))
        {
            return Err(Failure::option(
                "--held",
                format!("{held} is none of the inputs"),
            ));
        }
        channels.resampling = ResamplingWish {
            band_end: Some(band.max()),
            rate_hz: self.resample,
            held: self.held.iter().cloned().collect(),
        };
        say_conversions("--unit", &self.unit, SaidConversion::Unit, &mut channels)?;
        let factors = self
            .factor
            .iter()
            .filter(|of| of_one_record(&of.channel).is_none());
        say_conversions("--factor", factors, SaidConversion::Factor, &mut channels)?;
        Ok(channels)
    }

    /// Returns the requested channels: the dataset's, in its units, or those of the command line,
    /// in the units of the first record.
    fn named_channels(&self, dataset: Option<&Dataset>) -> Result<RecordChannels, Failure> {
        fn said(list: &Option<ChannelList>) -> impl Iterator<Item = &SaidChannel> {
            list.iter().flat_map(|list| &list.channels)
        }
        let Some(dataset) = dataset else {
            let [inputs, outputs] = [&self.inputs, &self.outputs]
                .map(|list| said(list).map(SaidChannel::rule).collect());
            return Ok(RecordChannels {
                inputs,
                outputs,
                ..RecordChannels::default()
            });
        };
        let mut channels = RecordChannels::of_dataset(dataset);
        for (option, list, rules) in [
            ("--inputs", &self.inputs, &mut channels.inputs),
            ("--outputs", &self.outputs, &mut channels.outputs),
        ] {
            for SaidChannel { name, unit, column } in said(list) {
                let Some(rule) = rules.iter_mut().find(|rule| rule.name == *name) else {
                    let names: Vec<&str> = rules.iter().map(|rule| rule.name.as_str()).collect();
                    let reason = format!(
                        "the dataset has no {name} there; it has {}",
                        names.join(", ")
                    );
                    return Err(Failure::option(option, reason));
                };
                if !unit.is_empty() && *unit != rule.unit {
                    let reason = format!(
                        "{name} has the unit {} in the dataset, not {unit}",
                        rule.unit
                    );
                    return Err(Failure::option(option, reason));
                }
                rule.aliases = column.iter().cloned().collect();
                rule.unit_in_files = Some(unit.clone()).filter(|unit| !unit.is_empty());
            }
        }
        Ok(channels)
    }

    /// Returns the preparation of the channels, which removes their known delays.
    pub(super) fn preparation(&self, channels: &RecordChannels) -> Result<Preparation, Failure> {
        let delays: Vec<_> = self
            .delay
            .iter()
            .filter(|of| of_one_record(&of.channel).is_none())
            .collect();
        if let Some(of) = delays.iter().find(|of| !has_channel(channels, &of.channel)) {
            return Err(unknown("--delay", &of.channel));
        }
        if let Some(channel) = said_twice(delays.iter().copied()) {
            return Err(Failure::option(
                "--delay",
                format!("{channel} stands twice"),
            ));
        }
        let prepared = |rule: &ChannelRule| {
            let delay_s = delays
                .iter()
                .find(|of| of.channel == rule.name)
                .map_or(0.0, |of| of.said);
            ChannelPreparation {
                delay_s,
                ..ChannelPreparation::named(rule.name.clone())
            }
        };
        Ok(Preparation {
            inputs: channels.inputs.iter().map(prepared).collect(),
            outputs: channels.outputs.iter().map(prepared).collect(),
            ..Preparation::of(&[], &[])
        })
    }
}

/// Returns whether a channel with this name exists.
pub(super) fn has_channel(channels: &RecordChannels, name: &str) -> bool {
    channels
        .inputs
        .iter()
        .chain(&channels.outputs)
        .any(|rule| rule.name == name)
}

/// Returns the failure for an option about an unknown channel.
pub(super) fn unknown(option: &'static str, channel: &str) -> Failure {
    Failure::option(option, format!("{channel} is none of the channels"))
}

/// Returns the first channel with a duplicate declaration.
pub(super) fn said_twice<'a, T: 'a>(
    said: impl IntoIterator<Item = &'a OfChannel<T>>,
) -> Option<&'a str> {
    let mut seen = BTreeSet::new();
    said.into_iter()
        .map(|of| of.channel.as_str())
        .find(|channel| !seen.insert(*channel))
}

/// Which models of an identification are put into a dataset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum OfferedChoice {
    /// The refined model, its neighbours in order, and the models without each record.
    #[default]
    Refined,
    /// The same, and CT-PBSID without refinement.
    #[value(alias = "with-plain")]
    WithUnrefined,
    /// The measured response alone.
    Measured,
}

impl OfferedChoice {
    /// Returns the models that the choice offers.
    pub fn offered(self) -> OfferedModels {
        match self {
            Self::Refined => OfferedModels::REFINED,
            Self::WithUnrefined => OfferedModels::WITH_UNREFINED,
            Self::Measured => OfferedModels::MEASURED,
        }
    }
}

/// Applies the declarations of an option to the channels; rejects duplicates.
pub(super) fn say_conversions<'a, T: Clone + 'a>(
    option: &'static str,
    said: impl IntoIterator<Item = &'a OfChannel<T>>,
    conversion: fn(T) -> SaidConversion,
    channels: &mut RecordChannels,
) -> Result<(), Failure> {
    for OfChannel { channel, said } in said {
        if !has_channel(channels, channel) {
            return Err(unknown(option, channel));
        }
        if channels
            .said
            .insert(channel.clone(), conversion(said.clone()))
            .is_some()
        {
            return Err(Failure::option(
                option,
                format!("{channel} has a unit or a factor already"),
            ));
        }
    }
    Ok(())
}

/// Splits a channel from its value, parsed by `read`; `None` if the channel is empty or `read`
/// rejects the value.
fn of_channel<T>(text: &str, read: impl FnOnce(&str) -> Option<T>) -> Option<OfChannel<T>> {
    let (channel, said) = text.split_once('=')?;
    let channel = Some(channel.trim())
        .filter(|channel| !channel.is_empty())?
        .to_owned();
    Some(OfChannel {
        channel,
        said: read(said.trim())?,
    })
}

fn any_text(text: &str) -> Option<String> {
    Some(text.to_owned()).filter(|text| !text.is_empty())
}

/// Parses a channel with the unit of its samples: "P=rad/s".
pub(super) fn channel_unit(text: &str) -> Result<OfChannel<String>, String> {
    of_channel(text, any_text)
        .ok_or_else(|| format!("expected CHANNEL=UNIT, as P=rad/s, found \"{text}\""))
}

fn channel_factor(text: &str) -> Result<OfChannel<f64>, String> {
    of_channel(text, |factor| {
        factor
            .parse()
            .ok()
            .filter(|factor: &f64| factor.is_finite() && *factor != 0.0)
    })
    .ok_or_else(|| {
        format!(
            "expected CHANNEL=X with X a number other than 0, as LON=25 or NZ=-1, found \"{text}\""
        )
    })
}

/// Parses the location of a channel: topic and field, or a column.
fn channel_topic(text: &str) -> Result<OfChannel<String>, String> {
    of_channel(text, |column| any_text(column.trim_matches('"'))).ok_or_else(|| {
        format!(
            "expected CHANNEL=TOPIC.FIELD, as P=vehicle_angular_velocity.xyz[0], found \"{text}\""
        )
    })
}

/// Parses the known delay of a channel \[s\], positive if the channel is logged late.
fn channel_delay(text: &str) -> Result<OfChannel<f64>, String> {
    /// Maximum plausible delay of a sensor or a bus \[s\].
    const MOST_S: f64 = 2.0;
    let expected = || format!("expected CHANNEL=SECONDS, as P=0.02, found \"{text}\"");
    let delay = of_channel(text, |seconds| seconds.parse().ok()).ok_or_else(expected)?;
    if (-MOST_S..=MOST_S).contains(&delay.said) {
        Ok(delay)
    } else {
        Err(format!(
            "{}; a delay is from -{MOST_S} to {MOST_S} s",
            expected()
        ))
    }
}

fn positive_rate(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(rate) if rate.is_finite() && rate > 0.0 => Ok(rate),
        _ => Err(format!(
            "expected a positive number of samples in a second, found \"{text}\""
        )),
    }
}

/// A part of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordPart {
    /// Name of the record; `None` for all records with samples at that time.
    pub record: Option<String>,
    /// First and last time \[s\].
    pub part_s: [f64; 2],
    /// Whether the times count from the record's first sample instead of its own clock.
    pub is_from_start: bool,
}

impl RecordPart {
    /// Returns the first and last time \[s\] on the clock of a record that starts at `start_s`.
    pub(super) fn on_clock_s(&self, start_s: f64) -> [f64; 2] {
        if self.is_from_start {
            self.part_s.map(|time_s| start_s + time_s)
        } else {
            self.part_s
        }
    }

    /// Returns the times as given: `5:34`, `+5:+34`.
    pub(super) fn words(&self) -> String {
        let sign = if self.is_from_start { "+" } else { "" };
        let [from, to] = self.part_s.map(number);
        format!("{sign}{from}:{sign}{to}")
    }
}

pub(super) fn record_part(text: &str) -> Result<RecordPart, String> {
    let expected = || {
        format!(
            "expected A:B, as 29:58, or +A:+B from the start of a record, or RECORD:A:B, with A less than B, found \"{text}\""
        )
    };
    let (rest, to) = text.rsplit_once(':').ok_or_else(expected)?;
    let (record, from) = rest
        .rsplit_once(':')
        .map_or((None, rest), |(record, from)| (Some(record.trim()), from));
    let [from, to] = [from, to].map(str::trim);
    let is_from_start = from.starts_with('+');
    let number = |text: &str| text.parse::<f64>().ok().filter(|number| number.is_finite());
    match number(from).zip(number(to)) {
        Some((first, last))
            if first < last && record != Some("") && is_from_start == to.starts_with('+') =>
        {
            Ok(RecordPart {
                record: record.map(ToOwned::to_owned),
                part_s: [first, last],
                is_from_start,
            })
        }
        _ => Err(expected()),
    }
}

/// Splits a channel from a preceding record name: "sweep.csv:P"; `None` without one.
pub fn of_one_record(said: &str) -> Option<(&str, &str)> {
    said.rsplit_once(':')
        .filter(|(record, channel)| !record.is_empty() && !channel.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_or_a_factor_is_of_a_channel() {
        assert_eq!(channel_unit("P = rad/s").unwrap().said, "rad/s");
        assert_eq!(channel_factor("NZ=-1").unwrap().said, -1.0);
        assert!(
            ["P", "P=", "=1"]
                .iter()
                .all(|wrong| channel_unit(wrong).is_err())
        );
        assert!(
            ["P", "P=x", "P=0", "P=NaN", "=1"]
                .iter()
                .all(|wrong| channel_factor(wrong).is_err())
        );
    }

    #[test]
    fn a_part_is_of_all_records_or_of_one() {
        let part = |record: Option<&str>, part_s, is_from_start| {
            Ok(RecordPart {
                record: record.map(str::to_owned),
                part_s,
                is_from_start,
            })
        };
        assert_eq!(record_part("29:58"), part(None, [29.0, 58.0], false));
        assert_eq!(
            record_part("log:1:-1:5"),
            part(Some("log:1"), [-1.0, 5.0], false)
        );
        assert_eq!(
            record_part("prbs: +5 : +34"),
            part(Some("prbs"), [5.0, 34.0], true)
        );
        assert_eq!(
            record_part("+5:+34").unwrap().on_clock_s(42.3),
            [47.3, 76.3]
        );
        let wrong = [
            "29", "58:29", "5:5", ":1:2", "a:b", "0:inf", "+5:34", "5:+34", "++5:+34", "+5:-34",
        ];
        assert!(wrong.iter().all(|wrong| record_part(wrong).is_err()));
        assert!(
            positive_rate("50") == Ok(50.0)
                && ["0", "-1", "x"]
                    .iter()
                    .all(|wrong| positive_rate(wrong).is_err())
        );
        assert_eq!(
            channel_topic("P = a.b[0]"),
            Ok(OfChannel {
                channel: "P".into(),
                said: "a.b[0]".into()
            })
        );
    }

    #[test]
    fn a_delay_is_of_a_channel_and_short() {
        assert_eq!(
            channel_delay("P=-0.02"),
            Ok(OfChannel {
                channel: "P".into(),
                said: -0.02
            })
        );
        for wrong in ["P", "P=x", "P=20", "=0.1", "P=NaN"] {
            assert!(channel_delay(wrong).is_err(), "{wrong}");
        }
    }
}
