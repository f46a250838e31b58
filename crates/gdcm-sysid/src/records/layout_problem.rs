//! Problems and cautions about the columns chosen from a record.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::number_format::counted;
use gdcm_model::units::{number, telling};

use super::record_table::shortened_list;
use super::resampling_error::ResamplingError;

/// Reasons why the chosen columns cannot be used as they are.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayoutProblem {
    /// The layout has no time; lists the available columns.
    #[error(
        "no time column; choose one with --time or on the Columns page, or give the sample rate with \
        --sample-rate (columns: {})",
        shortened_list(.0)
    )]
    NoTime(Vec<String>),
    /// A requested column does not exist.
    #[error(
        "there is no column \"{name}\"; choose one of these: {}",
        shortened_list(found)
    )]
    NoSuchColumn {
        name: String,
        /// The available columns.
        found: Vec<String>,
    },
    /// Stamps repeat or decrease.
    #[error(
        "the time in column {column} does not increase at {count} of {samples} samples, first at sample {sample} ({} s follows \
         {} s); choose another column, give the sample rate instead, or cut the file there",
        number(*after), number(*before)
    )]
    TimeOrder {
        /// Column name in quotation marks.
        column: String,
        /// Number of stamps that repeat or decrease.
        count: usize,
        samples: usize,
        /// The first repeated or decreasing stamp, counted from 1.
        sample: usize,
        /// The preceding stamp \[s\].
        before: f64,
        /// The repeated or decreasing stamp \[s\].
        after: f64,
    },
    /// Time steps are too long for a manoeuvre.
    #[error(
        "the time in column {column} has steps of {} s: its unit is wrong, or it is not a time; \
        correct the unit in the file or on the Columns page, or choose another column",
        telling(*step_s, 3)
    )]
    TimeStep {
        /// Column name in quotation marks.
        column: String,
        /// The median step \[s\].
        step_s: f64,
    },
    /// The sample time is not positive.
    #[error("sample time: expected a positive number of seconds, found {}; give the sample rate (--sample-rate)", number(*.0))]
    SampleTime(f64),
    /// No column matches this channel.
    #[error(
        "no column for the {side} {channel}; choose one with --topic \
        {channel}=COLUMN or on the Columns page (columns: {})",
        shortened_list(found)
    )]
    NoColumn {
        side: ChannelSide,
        channel: String,
        /// The available columns.
        found: Vec<String>,
    },
    /// Several columns match this channel.
    #[error("several columns match the {side} {channel}: {}; choose one with --topic {channel}=COLUMN or on the Columns page", found.join(", "))]
    SeveralColumns {
        side: ChannelSide,
        channel: String,
        /// Column names in quotation marks.
        found: Vec<String>,
    },
    /// The columns have no names, and no channel has an alias.
    #[error(
        "the file has {} without names; give the column number of each channel, for example \
        {channel}=#2",
        counted(*found, "column")
    )]
    Unnamed {
        /// The first channel, for the example in the message.
        channel: String,
        found: usize,
    },
    /// The column name leaves the sign open.
    #[error(
        "the sign of column \"{column}\" relative to {channel} is unknown; {channel}={plain} keeps the sign, \
         {channel}=-{plain} reverses it"
    )]
    Sign {
        channel: String,
        column: String,
        /// The column name without sign marks.
        plain: String,
    },
    /// Neither file nor samples determine the unit.
    #[error(
        "the file does not give the unit of {channel} (column {column}), and its samples can be \
        in {}; choose the unit with --unit \"{channel}={unit}\" or on the Columns page",
        alternatives(units)
    )]
    UnitNotGiven {
        channel: String,
        /// Column name in quotation marks.
        column: String,
        /// The channel's unit.
        unit: String,
        /// Units in which the samples are plausible.
        units: Vec<String>,
    },
    /// The unit from the file, the user or the channel's rule cannot be converted to the channel's
    /// unit.
    #[error(
        "{channel}: the unit \"{from}\" of column {column} cannot be converted to \"{to}\"; \
         give a factor with --factor {channel}=X or on the Columns page"
    )]
    Conversion {
        channel: String,
        /// Column name in quotation marks.
        column: String,
        /// Unit from the file, the user or the channel's rule.
        from: String,
        /// The channel's unit.
        to: String,
    },
    /// Two channels, or a channel and the time, use the same column.
    #[error(
        "{first} and {second} are both taken from column {column}; choose another column for one of them"
    )]
    OneColumn {
        first: String,
        /// The other channel, or "the time".
        second: String,
        /// Column name in quotation marks.
        column: String,
    },
    /// The column has no finite values.
    #[error("{channel}: column {column} has no numeric sample; choose another column")]
    Empty {
        channel: String,
        /// Column name in quotation marks.
        column: String,
    },
    /// The factor is zero or not finite.
    #[error("{channel}: expected a finite factor other than 0, found {}", number(*factor))]
    Factor {
        channel: String,
        /// Zero, infinite or NaN.
        factor: f64,
    },
    /// The delay is not plausible for a sensor or a bus.
    #[error("{channel}: expected a delay from -10 to 10 s, found {} s", number(*delay_s))]
    Delay { channel: String, delay_s: f64 },
    /// Samples exceed the plausible range for a helicopter in this unit.
    #[error(
        "{channel} (column {column}) reaches {} {unit}, above the limit of {} {unit} for a helicopter: the column or its unit is wrong{}; \
         choose another column, or set the unit with --unit \"{channel}=UNIT\" or on the Columns page",
        telling(*value, 0), number(*most), likely_unit_words(*likely_unit)
    )]
    Magnitude {
        channel: String,
        /// Column name in quotation marks.
        column: String,
        /// Largest absolute sample, in the channel's unit.
        value: f64,
        /// Largest plausible value, in the channel's unit.
        most: f64,
        /// The channel's unit.
        unit: String,
        /// Unit that the samples are more likely to have.
        likely_unit: Option<&'static str>,
    },
    /// Topics with separate clocks cannot be combined into a record.
    #[error("{0}")]
    Topics(ResamplingError),
}

impl LayoutProblem {
    /// Returns the stable code by which scripts and tests distinguish the problems.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoTime(..) => "no-time",
            Self::NoSuchColumn { .. } => "no-such-column",
            Self::TimeOrder { .. } => "time-order",
            Self::TimeStep { .. } => "time-step",
            Self::SampleTime(..) => "sample-time",
            Self::NoColumn { .. } => "no-column",
            Self::SeveralColumns { .. } => "several-columns",
            Self::Unnamed { .. } => "unnamed-columns",
            Self::Sign { .. } => "sign",
            Self::UnitNotGiven { .. } => "unit-not-given",
            Self::Conversion { .. } => "unit-conversion",
            Self::OneColumn { .. } => "one-column",
            Self::Empty { .. } => "empty-table",
            Self::Factor { .. } => "factor",
            Self::Delay { .. } => "delay",
            Self::Magnitude { .. } => "magnitude",
            Self::Topics(error) => error.code(),
        }
    }

    /// Returns whether no column was found for a channel; several matching columns do not count.
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::NoColumn { .. } | Self::Unnamed { .. })
    }
}

/// Joins alternatives: "deg/s or rad/s".
fn alternatives(units: &[String]) -> String {
    match units.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}

fn likely_unit_words(unit: Option<&str>) -> String {
    match unit {
        Some(unit) => format!(" (the samples look like {unit})"),
        None => String::new(),
    }
}

/// Unusual features in the chosen columns, which may be correct.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayoutCaution {
    /// A channel is constant.
    #[error("{channel} (column {column}) does not change in this record")]
    Constant {
        channel: String,
        /// Column name in quotation marks.
        column: String,
    },
    /// Two channels have the same samples.
    #[error(
        "{first} and {second} have the same samples; choose another column for one of them, or leave one out"
    )]
    Same { first: String, second: String },
    /// The record has the same samples as an earlier record.
    #[error("same samples as {first}: left out, so that no measurement counts twice")]
    Copy {
        /// The earlier record, by name.
        first: String,
    },
    /// Neither file nor samples determine the unit, so the channel's unit was assumed.
    #[error(
        "the file does not give the unit of {channel} (column {column}); the samples \
        can be in {}; {unit} was assumed: confirm it on the Columns page, or choose another there",
        alternatives(units)
    )]
    UnitAssumed {
        channel: String,
        /// Column name in quotation marks.
        column: String,
        /// The assumed unit, which is the channel's.
        unit: String,
        /// Units in which the samples are plausible.
        units: Vec<String>,
    },
    /// Samples are missing.
    #[error("{channel} (column {column}): {count} of {samples} samples missing")]
    Missing {
        channel: String,
        /// Column name in quotation marks.
        column: String,
        /// Number of missing samples.
        count: usize,
        samples: usize,
    },
    /// Stamps are missing.
    #[error("{count} of {samples} time stamps missing")]
    MissingTime {
        /// Number of missing stamps.
        count: usize,
        samples: usize,
    },
}

impl LayoutCaution {
    /// Returns the stable code by which scripts and tests distinguish the cautions.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Constant { .. } => "constant-column",
            Self::Same { .. } => "same-column",
            Self::Copy { .. } => "copied-channel",
            Self::UnitAssumed { .. } => "unit-assumed",
            Self::Missing { .. } => "missing-samples",
            Self::MissingTime { .. } => "missing-time",
        }
    }
}
