//! What is wrong, or odd, in the columns chosen from a record.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::units::{number, telling};

use crate::identification::topics::TopicError;

/// Why the columns chosen from a record cannot be used as they are.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayoutProblem {
    /// Nothing says when the samples were taken; the columns there are.
    #[error("no column gives the time; say which does, or the sample rate (columns: {0})")]
    NoTime(String),
    /// There is no column of the name asked for.
    #[error("there is no column \"{name}\"; there are {found}")]
    NoSuchColumn {
        /// The name.
        name: String,
        /// The columns there are.
        found: String,
    },
    /// Stamps stand still or fall.
    #[error(
        "the time in column {column} does not increase at {count} of {samples} samples, first at sample {sample} ({} s follows \
         {} s); choose another column, give the sample rate in its place, or cut the file there",
        number(*after), number(*before)
    )]
    TimeOrder {
        /// The column, in quotation marks.
        column: String,
        /// How many stamps.
        count: usize,
        /// Of how many.
        samples: usize,
        /// The first of them, counted from 1.
        sample: usize,
        /// The stamp before it \[s\].
        before: f64,
        /// The stamp \[s\].
        after: f64,
    },
    /// Steps of time are too long for a manoeuvre.
    #[error(
        "the time in column {column} goes in steps of {} s: its unit is another, or it is no time",
        telling(*step_s, 3)
    )]
    TimeStep {
        /// The column, in quotation marks.
        column: String,
        /// The median step \[s\].
        step_s: f64,
    },
    /// A sample time that is not positive.
    #[error("the sample time is {} s; it must be a positive number of seconds", number(*.0))]
    SampleTime(f64),
    /// No column is this channel.
    #[error("no column is the {side} {channel}; say which is (columns: {found})")]
    NoColumn {
        /// Input or output.
        side: ChannelSide,
        /// The channel.
        channel: String,
        /// The columns there are.
        found: String,
    },
    /// Several columns can be this channel.
    #[error("several columns can be the {side} {channel}: {found}; say which is")]
    SeveralColumns {
        /// Input or output.
        side: ChannelSide,
        /// The channel.
        channel: String,
        /// Their names.
        found: String,
    },
    /// Columns without names.
    #[error(
        "the file has {found} columns without names; say which column is which channel, by its number: {channel}=#2, and so on for \
         each"
    )]
    Unnamed {
        /// The first channel.
        channel: String,
        /// Columns of the file.
        found: usize,
    },
    /// A name that leaves the sign open.
    #[error(
        "nothing says whether column \"{column}\" is positive in the direction in which {channel} is; say it: {channel}={plain} \
         takes the column as it is, {channel}=-{plain} turns it"
    )]
    Sign {
        /// The channel.
        channel: String,
        /// The column.
        column: String,
        /// Its name without marks.
        plain: String,
    },
    /// A unit that neither the file nor the samples say.
    #[error(
        "the file does not say the unit of {channel} (column {column}), and its samples can be in {units}; say which: \
         --unit \"{channel}={unit}\", or page Columns"
    )]
    UnsaidUnit {
        /// The channel.
        channel: String,
        /// The column, in quotation marks.
        column: String,
        /// The channel's unit.
        unit: String,
        /// The units that the samples can be in, in words.
        units: String,
    },
    /// A unit that cannot be converted.
    #[error(
        "{channel} has the unit \"{from}\" in the file (column {column}) and \"{to}\" is wanted: there is no factor from one to the other; say one"
    )]
    Conversion {
        /// The channel.
        channel: String,
        /// The column, in quotation marks.
        column: String,
        /// The file's unit.
        from: String,
        /// The unit wanted.
        to: String,
    },
    /// Two channels are one column.
    #[error(
        "{first} and {second} are both taken from column {column}; choose another for one of them"
    )]
    OneColumn {
        /// One channel.
        first: String,
        /// The other, or "the time".
        second: String,
        /// The column, in quotation marks.
        column: String,
    },
    /// A column has no numbers.
    #[error("{channel}: column {column} has no sample that is a number; choose another")]
    Empty {
        /// The channel.
        channel: String,
        /// The column, in quotation marks.
        column: String,
    },
    /// A factor that is zero or not finite.
    #[error("{channel}: samples cannot be multiplied by {}", number(*factor))]
    Factor {
        /// The channel.
        channel: String,
        /// The factor.
        factor: f64,
    },
    /// A delay that is none of a sensor or a bus.
    #[error("{channel}: a delay of {} s in one record is not possible; at most 10 s", number(*delay_s))]
    Delay {
        /// The channel.
        channel: String,
        /// The delay \[s\].
        delay_s: f64,
    },
    /// Samples that no helicopter has in this unit.
    #[error(
        "{channel} (column {column}) reaches {} {unit}, and no helicopter more than {} {unit}: the column or its unit is wrong{hint}",
        telling(*value, 0), number(*most)
    )]
    Magnitude {
        /// The channel.
        channel: String,
        /// The column, in quotation marks.
        column: String,
        /// The greatest sample, converted.
        value: f64,
        /// The most there can be.
        most: f64,
        /// The channel's unit.
        unit: String,
        /// What it may be, in words; empty where nothing is known.
        hint: String,
    },
    /// Topics with clocks of their own do not make a record.
    #[error("{0}")]
    Topics(TopicError),
}

impl LayoutProblem {
    /// Whether a channel has no column.
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::NoColumn { .. } | Self::Unnamed { .. })
    }
}

/// What is odd in the columns chosen from a record, and can be right.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayoutCaution {
    /// A channel does not change.
    #[error("{channel} (column {column}) does not change in this record")]
    Constant {
        /// The channel.
        channel: String,
        /// The column, in quotation marks.
        column: String,
    },
    /// Two channels have the same samples.
    #[error("{first} and {second} have the same samples")]
    Same {
        /// One channel.
        first: String,
        /// The other.
        second: String,
    },
    /// A record is another under a second name.
    #[error("its samples are those of {first}: left out, for evidence counts once")]
    Copy {
        /// The name of the other.
        first: String,
    },
    /// Samples are missing.
    #[error("{channel} (column {column}): {count} of {samples} samples are missing")]
    Missing {
        /// The channel.
        channel: String,
        /// The column, in quotation marks.
        column: String,
        /// How many.
        count: usize,
        /// Of how many.
        samples: usize,
    },
    /// Stamps are missing.
    #[error("{count} of {samples} stamps of time are missing")]
    MissingTime {
        /// How many.
        count: usize,
        /// Of how many.
        samples: usize,
    },
}
