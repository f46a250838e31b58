//! The command line of `gdcm identify`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};

use gdcm_core::identification::SearchSpace;
use gdcm_core::records::{ChannelList, RecordChannels, SaidChannel, SaidConversion};
use gdcm_core::study::OfferedModels;

use super::{Failure, real_number, whole_number};

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
    #[arg(long, value_name = "CHANNEL=TOPIC.FIELD")]
    pub topic: Vec<ChannelTopic>,
    /// Samples in a second that the records are brought to, every channel through the same low-pass; without it, topics with clocks of their own are brought to a rate that the band takes, and nothing else is resampled.
    #[arg(long, value_name = "HZ", value_parser = positive_rate, allow_negative_numbers = true)]
    pub resample: Option<f64>,
    /// An input that acts as it was logged until its next sample (sample and hold); may be repeated.
    #[arg(long, value_name = "CHANNEL")]
    pub held: Vec<String>,
    /// A part of the records, from A to B seconds on their own clock, is a record of its own; of one record alone with its name before (RECORD:A:B); may be repeated, and --hold-out A:B holds one out.
    #[arg(long, value_name = "A:B", allow_hyphen_values = true)]
    pub part: Vec<RecordPart>,
    /// Samples in a second, in place of a column of the time.
    #[arg(long, value_name = "HZ", value_parser = real_number, conflicts_with = "time", allow_negative_numbers = true)]
    pub sample_rate: Option<f64>,
    /// A record to validate with, kept from identification: its file or its name; may be repeated. Without it, those whose names say so.
    #[arg(long, value_name = "FILE")]
    pub hold_out: Vec<String>,
    /// A known delay of a channel, in seconds, positive where it is logged late; in one record alone with its name before (RECORD:CHANNEL=SECONDS); may be repeated.
    #[arg(long, value_name = "CHANNEL=SECONDS", allow_hyphen_values = true)]
    pub delay: Vec<ChannelDelay>,
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
    #[arg(long, value_name = "CHANNEL=UNIT", value_parser = said_unit)]
    pub unit: Vec<ChannelConversion>,
    /// What a channel's samples are multiplied by, negative where the sign is the other one; in one record alone with its name before (RECORD:CHANNEL=X); may be repeated.
    #[arg(long, value_name = "CHANNEL=X", value_parser = said_factor, allow_hyphen_values = true)]
    pub factor: Vec<ChannelConversion>,
    /// Dataset that the models are put into; it is written anew, beside identified.json.
    #[arg(long, value_name = "DATASET", requires = "where")]
    pub into: Option<PathBuf>,
    /// The condition of the dataset, by its id.
    #[arg(long, value_name = "ID", requires = "into", allow_negative_numbers = true, group = "where")]
    pub condition: Option<i64>,
    /// Every condition of the dataset: each record goes to the one that its name, or that of its folder, says.
    #[arg(long, requires = "into", group = "where")]
    pub every_condition: bool,
    /// Which of the models are put into the dataset.
    #[arg(long, value_enum, value_name = "WHICH", default_value_t, requires = "into")]
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
    /// The references, each with its column where one is said.
    pub fn references(&self) -> &[SaidChannel] {
        self.reference.as_ref().map_or(&[], |list| &list.channels)
    }

    /// What is tried in place of the defaults.
    pub fn search(&self) -> SearchSpace {
        SearchSpace { orders: self.order.clone(), pasts: self.past.clone(), poles: self.pole.clone() }
    }
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
    /// The models.
    pub fn offered(self) -> OfferedModels {
        match self {
            Self::Refined => OfferedModels::REFINED,
            Self::WithUnrefined => OfferedModels::WITH_UNREFINED,
            Self::Measured => OfferedModels::MEASURED,
        }
    }
}

/// What is said of the samples of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelConversion {
    /// The channel.
    pub channel: String,
    /// Its unit or factor.
    pub said: SaidConversion,
}

/// Takes what an option says of the samples of channels, once of each.
pub(super) fn say_conversions<'c>(
    option: &'static str,
    said: impl IntoIterator<Item = &'c ChannelConversion>,
    channels: &mut RecordChannels,
) -> Result<(), Failure> {
    for ChannelConversion { channel, said } in said {
        let refused = |reason: String| Err(Failure::Option { option, reason });
        if !channels.inputs.iter().chain(&channels.outputs).any(|rule| rule.name == *channel) {
            return refused(format!("{channel} is none of the channels"));
        }
        if channels.said.insert(channel.clone(), said.clone()).is_some() {
            return refused(format!("{channel} has a unit or a factor already"));
        }
    }
    Ok(())
}

/// A channel with the unit of its samples: "P=rad/s".
pub(super) fn said_unit(text: &str) -> Result<ChannelConversion, String> {
    match text.split_once('=').map(|(channel, unit)| (channel.trim(), unit.trim())) {
        Some((channel, unit)) if !channel.is_empty() && !unit.is_empty() => {
            Ok(ChannelConversion { channel: channel.to_owned(), said: SaidConversion::Unit(unit.to_owned()) })
        }
        _ => Err(format!("expected CHANNEL=UNIT, as P=rad/s, found \"{text}\"")),
    }
}

fn said_factor(text: &str) -> Result<ChannelConversion, String> {
    let said = text.split_once('=').and_then(|(channel, factor)| Some((channel.trim(), factor.trim().parse().ok()?)));
    match said.filter(|(channel, factor): &(&str, f64)| !channel.is_empty() && factor.is_finite() && *factor != 0.0) {
        Some((channel, factor)) => {
            Ok(ChannelConversion { channel: channel.to_owned(), said: SaidConversion::Factor(factor) })
        }
        None => Err(format!("expected CHANNEL=X with X a number other than 0, as LON=25 or NZ=-1, found \"{text}\"")),
    }
}

/// Where a channel is found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelTopic {
    /// The channel.
    pub channel: String,
    /// The topic and its field, or a column.
    pub column: String,
}

impl FromStr for ChannelTopic {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let said = text.split_once('=').map(|(channel, column)| (channel.trim(), column.trim().trim_matches('"')));
        match said.filter(|(channel, column)| !channel.is_empty() && !column.is_empty()) {
            Some((channel, column)) => Ok(Self { channel: channel.to_owned(), column: column.to_owned() }),
            None => {
                Err(format!("expected CHANNEL=TOPIC.FIELD, as P=vehicle_angular_velocity.xyz[0], found \"{text}\""))
            }
        }
    }
}

fn positive_rate(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(rate) if rate.is_finite() && rate > 0.0 => Ok(rate),
        _ => Err(format!("expected a positive number of samples in a second, found \"{text}\"")),
    }
}

/// A part of a record, by its own clock.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordPart {
    /// The record; none for all that hold some of that time.
    pub record: Option<String>,
    /// First and last time \[s\].
    pub part_s: [f64; 2],
}

impl FromStr for RecordPart {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || format!("expected A:B, as 29:58, or RECORD:A:B, with A less than B, found \"{text}\"");
        let (rest, to) = text.rsplit_once(':').ok_or_else(expected)?;
        let (record, from) = rest.rsplit_once(':').map_or((None, rest), |(record, from)| (Some(record), from));
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        match number(from).zip(number(to)) {
            Some((from, to)) if from < to && record.is_none_or(|record| !record.trim().is_empty()) => {
                Ok(Self { record: record.map(|record| record.trim().to_owned()), part_s: [from, to] })
            }
            _ => Err(expected()),
        }
    }
}

/// A channel with what stands before it, where that is a record: "sweep.csv:P".
pub fn of_one_record(said: &str) -> Option<(&str, &str)> {
    said.rsplit_once(':').filter(|(record, channel)| !record.is_empty() && !channel.is_empty())
}

/// A known delay of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelDelay {
    /// The channel.
    pub channel: String,
    /// The delay \[s\], positive where the channel is logged late.
    pub delay_s: f64,
}

impl FromStr for ChannelDelay {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        /// Beyond this a delay is no delay of a sensor or a bus \[s\].
        const MOST_S: f64 = 2.0;
        let expected = || format!("expected CHANNEL=SECONDS, as P=0.02, found \"{text}\"");
        let (channel, seconds) = text.split_once('=').ok_or_else(expected)?;
        let delay_s: f64 = seconds.trim().parse().map_err(|_| expected())?;
        if !(-MOST_S..=MOST_S).contains(&delay_s) || channel.trim().is_empty() {
            return Err(format!("{}; a delay is from -{MOST_S} to {MOST_S} s", expected()));
        }
        Ok(Self { channel: channel.trim().to_owned(), delay_s })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_or_a_factor_is_of_a_channel() {
        assert_eq!(said_unit("P = rad/s").unwrap().said, SaidConversion::Unit("rad/s".into()));
        assert_eq!(said_factor("NZ=-1").unwrap().said, SaidConversion::Factor(-1.0));
        assert!(["P", "P=", "=1"].iter().all(|wrong| said_unit(wrong).is_err()));
        assert!(["P", "P=x", "P=0", "P=NaN", "=1"].iter().all(|wrong| said_factor(wrong).is_err()));
    }

    #[test]
    fn a_part_is_of_all_records_or_of_one() {
        assert_eq!("29:58".parse(), Ok(RecordPart { record: None, part_s: [29.0, 58.0] }));
        assert_eq!("log:1:-1:5".parse(), Ok(RecordPart { record: Some("log:1".into()), part_s: [-1.0, 5.0] }));
        assert!(
            ["29", "58:29", "5:5", ":1:2", "a:b", "0:inf"].iter().all(|wrong| wrong.parse::<RecordPart>().is_err())
        );
        assert!(positive_rate("50") == Ok(50.0) && ["0", "-1", "x"].iter().all(|wrong| positive_rate(wrong).is_err()));
        let topic: ChannelTopic = "P = a.b[0]".parse().unwrap();
        assert_eq!((topic.channel.as_str(), topic.column.as_str()), ("P", "a.b[0]"));
    }

    #[test]
    fn a_delay_is_of_a_channel_and_short() {
        assert_eq!("P=-0.02".parse(), Ok(ChannelDelay { channel: "P".into(), delay_s: -0.02 }));
        for wrong in ["P", "P=x", "P=20", "=0.1", "P=NaN"] {
            assert!(wrong.parse::<ChannelDelay>().is_err(), "{wrong}");
        }
    }
}
