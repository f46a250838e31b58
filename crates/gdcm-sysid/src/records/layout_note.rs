//! Notes on the columns proposed for a record's time and channels.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::number_format::counted;
use gdcm_model::units::{number, telling};

/// Note on a choice in a proposed layout. Columns are given as displayed, in quotation marks.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayoutNote {
    #[error("time from the time stamps of each topic")]
    TopicStamps,
    #[error("sample time {} s, as requested", number(*step_s))]
    RequestedStep {
        /// Sample time \[s\].
        step_s: f64,
    },
    #[error("sample time {} s, from the file", number(*step_s))]
    StepOfFile {
        /// Sample time \[s\].
        step_s: f64,
    },
    #[error("time from column {column}, in {unit}{reason}")]
    TimeColumn {
        column: String,
        unit: &'static str,
        reason: TimeUnitReason,
    },
    #[error(
        "no column has the name of an {side}: the {side}s are assigned in file order to the {} \
        that the file marks as such",
        counted(*count, "column")
    )]
    MarkedInOrder { side: ChannelSide, count: usize },
    /// A column with the conversion to a channel's unit.
    #[error("{channel}: column {column}{conversion}")]
    Column {
        channel: String,
        column: String,
        conversion: ColumnConversion,
    },
    #[error(
        "{channel}: sign of column {column} reversed, {}",
        if *is_requested { "as requested" } else { "as its name indicates" }
    )]
    SignReversed {
        channel: String,
        column: String,
        /// Whether the channel's alias asks for the reversal.
        is_requested: bool,
    },
    #[error(
        "resampled to {} Hz; every channel is filtered by the same low-pass at {} rad/s (logged: \
        {})",
        telling(*rate_hz, 2),
        telling(*cut_off_rad_s, 1),
        rate_list(logged)
    )]
    Resampled {
        /// The common clock's rate \[Hz\].
        rate_hz: f64,
        /// The low-pass filter's cut-off frequency \[rad/s\].
        cut_off_rad_s: f64,
        logged: Vec<LoggedRate>,
    },
    #[error(
        "{}: treated as held between samples, and therefore moved later by half a sample time",
        channels.join(", ")
    )]
    Held { channels: Vec<String> },
}

/// Why a time column has its unit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TimeUnitReason {
    /// The file or the column name gives the unit.
    #[error("")]
    Given,
    /// Seconds, because no unit makes the steps plausible.
    #[error("")]
    NoPlausibleUnit,
    /// Seconds, because the file does not state another unit.
    #[error(" (assumed: the file gives no unit)")]
    NotStated,
    /// The steps would be implausible in seconds.
    #[error(
        " (because steps of {} s would be too {})",
        telling(*step, 3),
        if *step > 1.0 { "long" } else { "short" }
    )]
    Steps {
        /// Median step, in the column's unit.
        step: f64,
    },
}

/// How a column is converted to its channel's unit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ColumnConversion {
    #[error(", × {} as requested", number(*.0))]
    RequestedFactor(f64),
    /// The channel has no unit; the file may give one.
    #[error("{}, not converted because the channel has no unit", unit_words(.0.as_deref()))]
    NoUnitOfChannel(Option<String>),
    #[error(", {from} → {to} (× {})", number(*factor))]
    Converted {
        from: String,
        to: String,
        factor: f64,
    },
    /// The column has the channel's unit, according to the file or the user.
    #[error(", in {0}")]
    SameUnit(String),
    /// The column has the channel's unit, according to the rule for files without units.
    #[error(", in {0} as set for the channel")]
    UnitOfRule(String),
    /// The samples are plausible in a single unit.
    #[error(
        ", assumed to be in {unit}: the file gives no unit, and the samples are plausible in no \
        other unit{}",
        factor_words(*factor)
    )]
    OnlyPlausibleUnit { unit: String, factor: f64 },
    /// The file gives no unit, and the samples do not tell which it is.
    #[error(
        ", taken in the channel's unit, because the file gives none and the samples fit no usual \
        unit; if that is wrong, set the unit of the column"
    )]
    NoUnitOfFile,
}

/// Rate at which a channel was logged.
#[derive(Clone, Debug, PartialEq)]
pub struct LoggedRate {
    pub channel: String,
    pub rate_hz: f64,
}

impl LayoutNote {
    /// Returns the stable code by which scripts and tests distinguish the notes.
    pub fn code(&self) -> &'static str {
        match self {
            Self::TopicStamps => "topic-stamps",
            Self::RequestedStep { .. } => "requested-sample-time",
            Self::StepOfFile { .. } => "sample-time-of-file",
            Self::TimeColumn { .. } => "time-column",
            Self::MarkedInOrder { .. } => "marked-in-order",
            Self::Column { .. } => "channel-column",
            Self::SignReversed { .. } => "sign-reversed",
            Self::Resampled { .. } => "resampled",
            Self::Held { .. } => "held-inputs",
        }
    }
}

fn rate_list(rates: &[LoggedRate]) -> String {
    let mut shown = Vec::with_capacity(rates.len());
    for LoggedRate { channel, rate_hz } in rates {
        shown.push(format!("{channel} {} Hz", telling(*rate_hz, 1)));
    }
    shown.join(", ")
}

fn unit_words(unit: Option<&str>) -> String {
    match unit {
        Some(unit) => format!(", in {unit}"),
        None => String::new(),
    }
}

fn factor_words(factor: f64) -> String {
    if factor == 1.0 {
        String::new()
    } else {
        format!(" (× {})", number(factor))
    }
}
