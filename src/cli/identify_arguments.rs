//! Options for `gdcm identify`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use gdcm_study::decisions::adopted_models::AdoptionChoice;
use gdcm_sysid::identification::SearchSpace;
use gdcm_sysid::records::TimeSettings;
use gdcm_sysid::records::channel_list::{ChannelList, RequestedChannel};

use super::channel_values::{
    ChannelValue, channel_delay, channel_factor, channel_topic, channel_unit,
};
use super::option_values::{RecordPart, positive_rate, real_number, record_part, whole_number};

/// Flight records, their channels, and the search for a model.
#[derive(Debug, Args)]
pub struct RecordArguments {
    /// Flight records at one condition, or with --every-condition at many: files, or folders with their subfolders (text, MATLAB, NumPy, JSON, zip; logs of PX4, ArduPilot and Betaflight).
    #[arg(value_name = "RECORD", required = true)]
    pub records: Vec<PathBuf>,
    /// Inputs, separated by commas (LON,LAT), each as CHANNEL, with its unit in square brackets if necessary, or CHANNEL=COLUMN (the column's name, in quotation marks if it contains a comma, or #3 for the third column) [default: the dataset's].
    #[arg(long, value_name = "NAMES", required_unless_present = "into")]
    pub inputs: Option<ChannelList>,
    /// Outputs, in the syntax of --inputs.
    #[arg(long, value_name = "NAMES", required_unless_present = "into")]
    pub outputs: Option<ChannelList>,
    /// Band to identify, in rad/s [default: the dataset's].
    #[arg(
        long,
        num_args = 2,
        value_names = ["LO", "HI"],
        value_parser = real_number,
        allow_negative_numbers = true,
        required_unless_present = "into"
    )]
    pub band: Option<Vec<f64>>,
    /// Time column [default: recognised by its name and values].
    #[arg(long, value_name = "NAME")]
    pub time: Option<String>,
    /// Channel location: its topic and field (TOPIC.FIELD), or its column; may be repeated.
    #[arg(long, value_name = "CHANNEL=TOPIC.FIELD", value_parser = channel_topic)]
    pub topic: Vec<ChannelValue<String>>,
    /// Sample rate for all records, with the same low-pass filter for every channel; by default only topics with their own time stamps are resampled, at a rate that suits the band.
    #[arg(long, value_name = "HZ", value_parser = positive_rate, allow_negative_numbers = true)]
    pub resample: Option<f64>,
    /// Input that keeps its logged value until the next sample (sample and hold); may be repeated.
    #[arg(long, value_name = "CHANNEL")]
    pub held: Vec<String>,
    /// Part of each record to be used, A:B in seconds on the record's time axis, +A:+B from its start, or RECORD:A:B for a single record; may be repeated, and --hold-out A:B holds out a part.
    #[arg(long, value_name = "A:B", value_parser = record_part, allow_hyphen_values = true)]
    pub part: Vec<RecordPart>,
    /// Sample rate for records without a time column.
    #[arg(long, value_name = "HZ", value_parser = real_number, conflicts_with = "time", allow_negative_numbers = true)]
    pub sample_rate: Option<f64>,
    /// Record for validation, excluded from identification: its file or its name; may be repeated [default: records named as validation].
    #[arg(long, value_name = "FILE")]
    pub hold_out: Vec<String>,
    /// Known channel delay in seconds, positive if it is logged late; in one record as RECORD:CHANNEL=SECONDS; may be repeated.
    #[arg(long, value_name = "CHANNEL=SECONDS", value_parser = channel_delay, allow_hyphen_values = true)]
    pub delay: Vec<ChannelValue<f64>>,
    /// Recorded references that drove the loop from outside (a chirp, a position reference), in the syntax of --inputs. With them, gusts that reach the inputs through the feedback do not bias the response.
    #[arg(long, value_name = "NAMES")]
    pub reference: Option<ChannelList>,
    /// Model order [default: the orders that the records support]; may be repeated.
    #[arg(long, value_name = "N", value_parser = whole_number::<1, 60>)]
    pub order: Vec<usize>,
    /// Past window: number of Laguerre projections that predict the next [default: those that the records support]; may be repeated.
    #[arg(long, value_name = "N", value_parser = whole_number::<1, 60>)]
    pub past: Vec<usize>,
    /// Laguerre pole in rad/s [default: 0.375, 0.54 and 0.75 times the upper end of the band]; may be repeated.
    #[arg(long, value_name = "RAD/S", value_parser = real_number)]
    pub pole: Vec<f64>,
    /// Unit of a channel's samples, which overrides the file; may be repeated.
    #[arg(long, value_name = "CHANNEL=UNIT", value_parser = channel_unit)]
    pub unit: Vec<ChannelValue<String>>,
    /// Factor of a channel's samples, negative for the opposite sign; in one record as RECORD:CHANNEL=X; may be repeated.
    #[arg(long, value_name = "CHANNEL=X", value_parser = channel_factor, allow_hyphen_values = true)]
    pub factor: Vec<ChannelValue<f64>>,
    /// Dataset that gives channels, units and band; `identify` adds the models to a copy beside identified.json.
    #[arg(long, value_name = "DATASET", requires = "where")]
    pub into: Option<PathBuf>,
    /// Condition in the dataset, by its id.
    #[arg(
        long,
        value_name = "ID",
        requires = "into",
        allow_negative_numbers = true,
        group = "where"
    )]
    pub condition: Option<i64>,
    /// Every condition of the dataset: each record goes to the condition in its name or its folder's name.
    #[arg(long, requires = "into", group = "where")]
    pub every_condition: bool,
}

/// Flight records, and where their models go.
#[derive(Debug, Args)]
pub struct IdentifyArguments {
    #[command(flatten)]
    pub source: RecordArguments,
    /// Models to add to the dataset.
    #[arg(
        long,
        value_enum,
        value_name = "WHICH",
        default_value_t,
        requires = "into"
    )]
    pub take: OfferedChoice,
    /// Description for the new dataset [default: unchanged].
    #[arg(long, value_name = "TEXT", requires = "into")]
    pub description: Option<String>,
    /// Directory for identified.json (identified-condition-ID.json with --every-condition), created if missing.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Overwrite existing files.
    #[arg(long)]
    pub force: bool,
}

impl RecordArguments {
    /// Returns the recorded references; empty if none are given.
    pub fn references(&self) -> &[RequestedChannel] {
        match &self.reference {
            Some(list) => &list.channels,
            None => &[],
        }
    }

    /// Returns the search settings given on the command line; they replace the defaults.
    pub fn search(&self) -> SearchSpace {
        SearchSpace {
            orders: self.order.clone(),
            pasts: self.past.clone(),
            poles: self.pole.clone(),
        }
    }

    /// Returns the requested time column or sample rate.
    pub fn time_wish(&self) -> TimeSettings {
        TimeSettings {
            column: self.time.clone(),
            sample_time_s: self.sample_rate.map(|rate| 1.0 / rate),
        }
    }
}

/// Identified models that are added to a dataset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum OfferedChoice {
    /// The refined model, the models of neighbouring orders, and the models identified without one record each.
    #[default]
    Refined,
    /// The models of "refined", and the unrefined CT-PBSID model.
    #[value(alias = "with-plain")]
    WithUnrefined,
    /// Only the measured response.
    Measured,
}

impl OfferedChoice {
    /// Returns the corresponding choice of identified models.
    pub fn offered(self) -> AdoptionChoice {
        match self {
            Self::Refined => AdoptionChoice::REFINED,
            Self::WithUnrefined => AdoptionChoice::WITH_UNREFINED,
            Self::Measured => AdoptionChoice::MEASURED,
        }
    }
}
