//! Faults in a text line. To each message, [`VariableFault::Line`](super::VariableFault::Line) adds
//! the variable and the line number.

use gdcm_model::number_format::counted;

use crate::variable_fault::column_place::ColumnPlace;
use crate::variable_fault::octave_fault::OctaveFault;

/// Fault in a text line; the message contains its remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LineFault {
    #[error(
        "text among the rows (\"{start}\"); put # before it, or split the file if another table \
        follows"
    )]
    TextAmongRows {
        /// Beginning of the line, quoted in the message.
        start: String,
    },
    #[error(
        "column {column} holds \"{cell}\", which is not a number{}; correct it, or leave the cell \
        empty",
        decimal_mark_words(*is_decimal_comma)
    )]
    NotANumber {
        /// Column number, from 1.
        column: usize,
        /// Beginning of the cell, quoted in the message.
        cell: String,
        /// Whether the cell has a decimal point in a table with decimal commas.
        is_decimal_comma: bool,
    },
    #[error(
        "{}, but the table has {expected} (separated by {separator}); complete the line, or split \
        the file where the columns change",
        counted(*found, "column")
    )]
    ColumnCount {
        found: usize,
        expected: usize,
        /// Separator name, as displayed in the message.
        separator: &'static str,
    },
    /// A matrix line has a single number, but other rows have several.
    #[error("a single number, but other rows have {columns}; complete the row")]
    SingleNumber { columns: usize },
    #[error("\"{start}\" is not a row of numbers; correct it")]
    NotARow {
        /// Beginning of the line, quoted in the message.
        start: String,
    },
    #[error("\"{start}\" is not a row like the others; complete it")]
    UnlikeOtherRows {
        /// Beginning of the line, quoted in the message.
        start: String,
    },
    #[error("numbers without a name; write the name of the matrix on a line above them")]
    UnnamedNumbers,
    /// A matrix is printed in parts, and these have different row counts.
    #[error("parts of this matrix have {first} and {other} rows; print it in one part")]
    PartRows { first: usize, other: usize },
    #[error("the bracket {bracket} in column {column} is never closed; close it")]
    OpenBracket {
        bracket: char,
        /// Column with the bracket, from 1.
        column: usize,
    },
    #[error("the comment opened here is never closed; write %}} on a line of its own")]
    OpenComment,
    #[error("invalid JSON ({message}); correct it")]
    Json { message: String },
    #[error("the frequency in {place} {fault}")]
    Frequency {
        place: ColumnPlace,
        fault: FrequencyFault,
    },
    /// A complex number has only one part, or an infinite part.
    #[error(
        "{place} has no finite number; complete it, or also empty the other part of the complex \
        number"
    )]
    IncompleteResponse { place: ColumnPlace },
    #[error("{place} is too large for a magnitude; if it is in dB, write [dB] in the heading")]
    Magnitude { place: ColumnPlace },
    #[error("{0}: the file is damaged; save it again in Octave")]
    Octave(#[from] OctaveFault),
}

/// Reason why a frequency in a table is invalid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FrequencyFault {
    #[error("is missing or infinite; complete it or remove the line")]
    NotFinite,
    #[error("is negative ({value}); remove the line")]
    Negative { value: f64 },
    #[error("occurs on two lines ({value}); remove one of the lines")]
    Repeated { value: f64 },
    #[error(
        "is below the preceding frequency ({value} after {before}); sort the lines by frequency"
    )]
    Decreasing { value: f64, before: f64 },
}

impl LineFault {
    /// Returns the stable code by which scripts and tests distinguish faults in lines.
    pub fn code(&self) -> &'static str {
        match self {
            Self::TextAmongRows { .. } => "text-among-rows",
            Self::NotANumber { .. } => "not-a-number",
            Self::ColumnCount { .. } => "column-count",
            Self::SingleNumber { .. } => "single-number",
            Self::NotARow { .. } => "not-a-row",
            Self::UnlikeOtherRows { .. } => "unlike-other-rows",
            Self::UnnamedNumbers => "unnamed-numbers",
            Self::PartRows { .. } => "part-rows",
            Self::OpenBracket { .. } => "open-bracket",
            Self::OpenComment => "open-comment",
            Self::Json { .. } => "invalid-json",
            Self::Frequency { fault, .. } => fault.code(),
            Self::IncompleteResponse { .. } => "half-number",
            Self::Magnitude { .. } => "magnitude-too-large",
            Self::Octave(_) => "invalid-octave-text",
        }
    }
}

impl FrequencyFault {
    fn code(self) -> &'static str {
        match self {
            Self::NotFinite => "frequency-not-finite",
            Self::Negative { .. } => "frequency-negative",
            Self::Repeated { .. } => "frequency-repeated",
            Self::Decreasing { .. } => "frequency-decreasing",
        }
    }
}

fn decimal_mark_words(is_decimal_comma: bool) -> &'static str {
    if is_decimal_comma {
        " (the decimal mark is the comma)"
    } else {
        ""
    }
}
