//! Notes on choices made while a file was read. The *rules* in a note are those of the engineer for
//! the files in a folder ([`Rules`](gdcm_model::assembly::Rules)).

use std::fmt::{Display, Formatter, Result};

use gdcm_model::number_format::counted;
use gdcm_sysid::records::ModeSpan;

use crate::formats::reading_reason::{QuantityReason, UnitReason};
use crate::variable_fault::column_place::ColumnPlace;

/// Maximum number of numbered words listed in a note.
const SHOWN_WORDS: usize = 12;
/// Maximum number of flight modes listed in a note.
const SHOWN_MODES: usize = 8;

/// Note for the user on a choice made while a file was read, or on a part that was skipped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadingNote {
    // Tables.
    #[error("line {line} repeats a heading: the rows after it continue the table")]
    RepeatedHeading { line: usize },
    #[error("line {line} is skipped: one number, but the table has {columns} columns")]
    SingleNumber { line: usize, columns: usize },
    #[error(
        "each line has one comma between whole numbers, which is read as the separator of two \
        columns; if it is a decimal comma, write a decimal point instead"
    )]
    CommaSeparates,
    #[error(
        "line {line} has {found} entries for {}: it is not read as column names",
        counted(*columns, "column")
    )]
    HeadingMisfit {
        line: usize,
        found: usize,
        columns: usize,
    },
    #[error("{column} has times of day, which are read as seconds since the first")]
    TimesOfDay { column: NamedColumn },
    #[error("{column} has too many different words and is ignored")]
    TooManyWords { column: NamedColumn },
    #[error("{column} has words, which are numbered: {}", word_list(words))]
    NumberedWords {
        column: NamedColumn,
        /// The words ordered by their numbers, which begin at 1.
        words: Vec<String>,
    },
    #[error("line {line} gives the units")]
    UnitsLine { line: usize },
    #[error("line {line} gives the column names")]
    NamesLine { line: usize },
    #[error("the column headings are taken from the rules")]
    HeadingsFromRules,
    #[error("the first line contains column numbers and was skipped")]
    ColumnNumbers,
    #[error("one of {count} tables in the file, from line {line}")]
    OneOfTables { count: usize, line: usize },

    // Frequency responses in columns.
    #[error("{place} is read as {reading}: {}", reason_words(quantity, unit))]
    ReadAs {
        place: ColumnPlace,
        reading: ColumnReading,
        quantity: QuantityReason,
        unit: UnitReason,
    },
    #[error("{place} is ignored: its name is not recognised")]
    UnknownName { place: ColumnPlace },
    /// A column with part of a complex number is not used because the other column is missing.
    #[error(
        "{place} is ignored: the matching column is missing (real and imaginary part, or magnitude \
        and phase, are both needed)"
    )]
    HalfResponse { place: ColumnPlace },
    #[error(
        "magnitude and phase in columns {magnitude} and {phase} agree with the real and imaginary \
        parts, which are used"
    )]
    FormsAgree {
        /// Magnitude column, from 1.
        magnitude: usize,
        /// Phase column, from 1.
        phase: usize,
    },
    #[error(
        "magnitude and phase in columns {magnitude} and {phase} differ from the real and imaginary \
        parts, first in line {line}; the real and imaginary parts are used"
    )]
    FormsDiffer {
        /// Magnitude column, from 1.
        magnitude: usize,
        /// Phase column, from 1.
        phase: usize,
        /// First line with a difference.
        line: usize,
    },
    #[error("the frequencies decrease: the rows are read in reverse order")]
    DecreasingFrequencies,

    // Named matrices and statements.
    #[error("line {line} (\"{start}\") is skipped: neither a matrix name nor a row of numbers")]
    LineSkipped { line: usize, start: String },
    #[error("line {line} (\"{start}\") is read as column names")]
    ColumnNames { line: usize, start: String },
    #[error("line {line} (\"{name}\") is skipped: no numbers follow")]
    NameWithoutNumbers { line: usize, name: String },
    #[error("{name} is printed with the common factor {factor:e}, and therefore with few digits")]
    PrintedWithFactor { name: String, factor: f64 },
    #[error("line {line} (\"{start}\") {reason}")]
    StatementSkipped {
        line: usize,
        start: String,
        reason: SkippedStatement,
    },

    // Autopilot logs.
    #[error("a PX4 log; time in seconds since the start of the autopilot")]
    Px4Log,
    #[error("an ArduPilot log; time in seconds since the start of the autopilot")]
    ArduPilotLog,
    #[error("an ArduPilot log as text; time in seconds since the start of the autopilot")]
    ArduPilotText,
    #[error("a Betaflight log; axisSum is the sum of the controller terms")]
    BetaflightLog,
    #[error(
        "channels proposed from the documentation of the logging system: {}; {signs}",
        assignment_list(assignments)
    )]
    DocumentedChannels {
        assignments: Vec<ChannelAssignment>,
        /// Sign conventions in the logging system.
        signs: &'static str,
    },
    #[error("{}", modes_words(.0))]
    FlightModes(Vec<ModeSpan>),
    #[error(
        "{} of the logger, {lost_s:.2} s in total: the columns have gaps",
        counted(*count, "dropout")
    )]
    Dropouts {
        count: usize,
        /// Total duration \[s\].
        lost_s: f64,
    },
    #[error("{} omitted, without a subscribed topic or shorter than the format of the topic", counted(*count, "data message"))]
    MessagesOmitted { count: usize },
    #[error("the file is truncated: it was read up to the last complete message")]
    Truncated,
    #[error("{} outside complete messages skipped", counted(*count, "byte"))]
    BytesSkipped { count: usize },
    #[error("{omitted} of {count} flights in the file omitted: fewer than {fewest} frames")]
    FlightsOmitted {
        omitted: usize,
        count: usize,
        fewest: usize,
    },
    #[error(
        "gyro_scale in the log is not 1: the unit of gyroADC is unknown, so no channels are proposed; choose columns and units"
    )]
    GyroScale,
    #[error(
        "{}: the frames up to the next frame with complete values (intra frame) are omitted",
        counted(*count, "damaged frame")
    )]
    DamagedFrames { count: usize },

    // Records among variables.
    #[error("clock times: converted to seconds since the first sample")]
    ClockTimes,
    #[error(
        "{}: omitted, because the number of samples differs from that of the record",
        names.join(", ")
    )]
    OtherLengths { names: Vec<String> },

    // Models among variables.
    #[error("the file has no matrix D: D = 0 is assumed")]
    NoD,
    #[error("transfer functions, each converted to a state-space model of its own")]
    TransferFunctions,
    #[error("the frequencies are in Hz")]
    FrequenciesInHertz,
    #[error("the coherence is read as magnitude-squared (γ²)")]
    CoherenceSquared,
    #[error("{name} is counted in samples, as in MATLAB for discrete time")]
    DelayInSamples { name: String },
    #[error("{name} is assumed to be in s, because its name contains no unit")]
    DelayInSeconds { name: String },
    #[error("{name} is split into input delays and output delays")]
    DelaysSplit { name: String },
}

/// Interpretation of a column in a frequency response table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ColumnReading {
    #[error("the frequency in {unit}")]
    Frequency { unit: &'static str },
    #[error("a standard deviation, which is not used")]
    StandardDeviation,
    #[error("the real part")]
    Real,
    #[error("the imaginary part")]
    Imaginary,
    #[error("the magnitude in dB")]
    MagnitudeInDb,
    #[error("the magnitude as a ratio")]
    AbsoluteMagnitude,
    #[error("the phase in {unit}")]
    Phase { unit: &'static str },
    #[error("the coherence")]
    Coherence,
    #[error("the coherence in percent")]
    CoherenceInPercent,
}

/// Column by its name or, without a name, by its number.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NamedColumn {
    #[error("column \"{0}\"")]
    Name(String),
    /// Number, from 1.
    #[error("column {0}")]
    Number(usize),
}

/// Joins the reasons for a quantity and its unit; a unit that gives both is named once.
fn reason_words(quantity: &QuantityReason, unit: &UnitReason) -> String {
    match (quantity, unit) {
        (QuantityReason::Unit(_) | QuantityReason::UnitOfAngle, UnitReason::Unit(name)) => {
            format!("its unit is {name}")
        }
        _ => format!("{quantity}{unit}"),
    }
}

/// Reason why a statement was skipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SkippedStatement {
    #[error("is skipped: not an assignment")]
    NotUnderstood,
    #[error("is not executed: only assignments are read")]
    NotExecuted,
    /// A word such as `if`, `for` or `try` begins a block.
    #[error("is not executed, and values set in it are not read")]
    Block,
}

/// Channel for a logged column, according to the logging system's documentation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelAssignment {
    pub channel: &'static str,
    pub column: &'static str,
}

impl Display for ChannelAssignment {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        write!(out, "{} = {}", self.channel, self.column)
    }
}

impl ReadingNote {
    /// Returns the stable code by which tests distinguish notes.
    pub fn code(&self) -> &'static str {
        match self {
            Self::RepeatedHeading { .. } => "repeated-heading",
            Self::SingleNumber { .. } => "single-number",
            Self::CommaSeparates => "comma-separates",
            Self::HeadingMisfit { .. } => "heading-misfit",
            Self::TimesOfDay { .. } => "times-of-day",
            Self::TooManyWords { .. } => "too-many-words",
            Self::NumberedWords { .. } => "numbered-words",
            Self::UnitsLine { .. } => "units-line",
            Self::NamesLine { .. } => "names-line",
            Self::HeadingsFromRules => "headings-from-rules",
            Self::ColumnNumbers => "column-numbers",
            Self::OneOfTables { .. } => "one-of-tables",
            Self::ReadAs { .. } => "read-as",
            Self::UnknownName { .. } => "unknown-name",
            Self::HalfResponse { .. } => "half-response",
            Self::FormsAgree { .. } => "forms-agree",
            Self::FormsDiffer { .. } => "forms-differ",
            Self::DecreasingFrequencies => "decreasing-frequencies",
            Self::LineSkipped { .. } => "line-skipped",
            Self::ColumnNames { .. } => "column-names",
            Self::NameWithoutNumbers { .. } => "name-without-numbers",
            Self::PrintedWithFactor { .. } => "printed-with-factor",
            Self::StatementSkipped { .. } => "statement-skipped",
            Self::Px4Log => "px4-log",
            Self::ArduPilotLog => "ardupilot-log",
            Self::ArduPilotText => "ardupilot-text",
            Self::BetaflightLog => "betaflight-log",
            Self::DocumentedChannels { .. } => "documented-channels",
            Self::FlightModes(_) => "flight-modes",
            Self::Dropouts { .. } => "dropouts",
            Self::MessagesOmitted { .. } => "messages-omitted",
            Self::Truncated => "truncated",
            Self::BytesSkipped { .. } => "bytes-skipped",
            Self::FlightsOmitted { .. } => "flights-omitted",
            Self::GyroScale => "gyro-scale",
            Self::DamagedFrames { .. } => "damaged-frames",
            Self::ClockTimes => "clock-times",
            Self::OtherLengths { .. } => "other-lengths",
            Self::NoD => "no-d",
            Self::TransferFunctions => "transfer-functions",
            Self::FrequenciesInHertz => "frequencies-in-hertz",
            Self::CoherenceSquared => "coherence-squared",
            Self::DelayInSamples { .. } => "delay-in-samples",
            Self::DelayInSeconds { .. } => "delay-in-seconds",
            Self::DelaysSplit { .. } => "delays-split",
        }
    }
}

pub(crate) fn note_texts(notes: &[ReadingNote]) -> Vec<String> {
    notes.iter().map(ToString::to_string).collect()
}

fn word_list(words: &[String]) -> String {
    let mut shown = Vec::new();
    for (index, word) in words.iter().take(SHOWN_WORDS).enumerate() {
        shown.push(format!("{} is {word}", index + 1));
    }
    if words.len() > SHOWN_WORDS {
        shown.push("…".to_owned());
    }
    shown.join(", ")
}

fn assignment_list(assignments: &[ChannelAssignment]) -> String {
    let assignments: Vec<String> = assignments.iter().map(ToString::to_string).collect();
    assignments.join(", ")
}

/// Returns the message on flight modes, such as "flight modes: armed 3.2 to 88.1 s"; lists at most
/// `SHOWN_MODES`.
fn modes_words(spans: &[ModeSpan]) -> String {
    let mut shown = Vec::new();
    for span in spans.iter().take(SHOWN_MODES) {
        let [begin_s, end_s] = span.ends_s;
        shown.push(format!("{} {begin_s:.1} to {end_s:.1} s", span.name));
    }
    let mut words = format!("flight modes: {}", shown.join(", "));
    if spans.len() > SHOWN_MODES {
        words.push_str(&format!(" and {} more", spans.len() - SHOWN_MODES));
    }
    words
}
