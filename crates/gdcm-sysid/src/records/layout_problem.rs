//! Problems and cautions about the columns chosen from a record.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::units::{number, telling};

use crate::identification::topics::TopicError;

/// Reasons why the chosen columns cannot be used as they are.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayoutProblem {
    /// The time of the samples is missing; lists the available columns.
    #[error("no column gives the time; say which does, or the sample rate (columns: {0})")]
    NoTime(String),
    /// A requested column does not exist.
    #[error("there is no column \"{name}\"; there are {found}")]
    NoSuchColumn {
        name: String,
        /// The available columns.
        found: String,
    },
    /// Stamps repeat or decrease.
    #[error(
        "the time in column {column} does not increase at {count} of {samples} samples, first at sample {sample} ({} s follows \
         {} s); choose another column, give the sample rate in its place, or cut the file there",
        number(*after), number(*before)
    )]
    TimeOrder {
        /// In quotation marks.
        column: String,
        /// Number of such stamps.
        count: usize,
        /// Total number.
        samples: usize,
        /// The first of them, counted from 1.
        sample: usize,
        /// The stamp before it \[s\].
        before: f64,
        /// Its stamp \[s\].
        after: f64,
    },
    /// Time steps are too long for a manoeuvre.
    #[error(
        "the time in column {column} goes in steps of {} s: its unit is another, or it is no time",
        telling(*step_s, 3)
    )]
    TimeStep {
        /// In quotation marks.
        column: String,
        /// The median step \[s\].
        step_s: f64,
    },
    /// The sample time is not positive.
    #[error("the sample time is {} s; it must be a positive number of seconds", number(*.0))]
    SampleTime(f64),
    /// No column matches this channel.
    #[error("no column is the {side} {channel}; say which is (columns: {found})")]
    NoColumn {
        side: ChannelSide,
        channel: String,
        /// The available columns.
        found: String,
    },
    /// Several columns match this channel.
    #[error("several columns can be the {side} {channel}: {found}; say which is")]
    SeveralColumns {
        side: ChannelSide,
        channel: String,
        /// The names of these columns.
        found: String,
    },
    /// The columns have no names.
    #[error(
        "the file has {found} columns without names; say which column is which channel, by its number: {channel}=#2, and so on for \
         each"
    )]
    Unnamed {
        /// The first channel.
        channel: String,
        /// Number of columns in the file.
        found: usize,
    },
    /// The column name leaves the sign open.
    #[error(
        "nothing says whether column \"{column}\" is positive in the direction in which {channel} is; say it: {channel}={plain} \
         takes the column as it is, {channel}=-{plain} turns it"
    )]
    Sign {
        channel: String,
        column: String,
        /// The column name without sign marks.
        plain: String,
    },
    /// Neither the file nor the samples determine the unit.
    #[error(
        "the file does not say the unit of {channel} (column {column}), and its samples can be in {units}; say which: \
         --unit \"{channel}={unit}\", or page Columns"
    )]
    UnsaidUnit {
        channel: String,
        /// In quotation marks.
        column: String,
        /// Unit of the channel.
        unit: String,
        /// Possible units of the samples, as a list.
        units: String,
    },
    #[error(
        "{channel} has the unit \"{from}\" in the file (column {column}) and \"{to}\" is wanted: there is no factor from one to the other; say one"
    )]
    Conversion {
        channel: String,
        /// In quotation marks.
        column: String,
        /// Unit in the file.
        from: String,
        /// Requested unit.
        to: String,
    },
    /// Two channels use the same column.
    #[error(
        "{first} and {second} are both taken from column {column}; choose another for one of them"
    )]
    OneColumn {
        first: String,
        /// The other channel, or "the time".
        second: String,
        /// In quotation marks.
        column: String,
    },
    /// The column has no numbers.
    #[error("{channel}: column {column} has no sample that is a number; choose another")]
    Empty {
        channel: String,
        /// In quotation marks.
        column: String,
    },
    /// The factor is zero or not finite.
    #[error("{channel}: samples cannot be multiplied by {}", number(*factor))]
    Factor {
        channel: String,
        /// Zero, infinite or NaN.
        factor: f64,
    },
    /// The delay is not plausible for a sensor or a bus.
    #[error("{channel}: a delay of {} s in one record is not possible; at most 10 s", number(*delay_s))]
    Delay {
        channel: String,
        /// The delay \[s\].
        delay_s: f64,
    },
    /// The samples exceed the range of helicopters in this unit.
    #[error(
        "{channel} (column {column}) reaches {} {unit}, and no helicopter more than {} {unit}: the column or its unit is wrong{hint}",
        telling(*value, 0), number(*most)
    )]
    Magnitude {
        channel: String,
        /// In quotation marks.
        column: String,
        /// The largest absolute sample, converted.
        value: f64,
        /// The largest plausible value.
        most: f64,
        /// Unit of the channel.
        unit: String,
        /// A guess at the cause; empty without one.
        hint: String,
    },
    /// Topics with separate clocks cannot be combined into a record.
    #[error("{0}")]
    Topics(TopicError),
}

impl LayoutProblem {
    /// Whether a channel has no column.
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::NoColumn { .. } | Self::Unnamed { .. })
    }
}

/// Unusual features of the chosen columns, which may be correct.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayoutCaution {
    /// A channel is constant.
    #[error("{channel} (column {column}) does not change in this record")]
    Constant {
        channel: String,
        /// In quotation marks.
        column: String,
    },
    /// Two channels have the same samples.
    #[error("{first} and {second} have the same samples")]
    Same {
        /// Name of one channel.
        first: String,
        /// Name of the other channel.
        second: String,
    },
    /// The record is a copy of another under a different name.
    #[error("its samples are those of {first}: left out, for evidence counts once")]
    Copy {
        /// Name of the other record.
        first: String,
    },
    /// Samples are missing.
    #[error("{channel} (column {column}): {count} of {samples} samples are missing")]
    Missing {
        channel: String,
        /// In quotation marks.
        column: String,
        /// Number of missing samples.
        count: usize,
        /// Total number.
        samples: usize,
    },
    /// Stamps are missing.
    #[error("{count} of {samples} stamps of time are missing")]
    MissingTime {
        /// Number of missing stamps.
        count: usize,
        /// Total number.
        samples: usize,
    },
}
