//! Content found in a file instead of the expected format, for the message of
//! [`VariableFault::Format`](super::VariableFault::Format): "expected …, found …". The *rules* in a
//! message are those of the engineer for the files in a folder
//! ([`Rules`](gdcm_model::assembly::Rules)).

use std::fmt::{Display, Formatter, Result};

use gdcm_model::number_format::counted;

use crate::variable_fault::column_place::ColumnPlace;

/// Content found in a file instead of the expected format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FoundContent {
    #[error("nothing")]
    Nothing,
    #[error("an empty file")]
    EmptyFile,
    #[error("another format")]
    OtherBytes,
    #[error("a binary file (byte {byte} is zero)")]
    Binary {
        /// Position of the first zero byte, from 0.
        byte: usize,
    },
    #[error("no row of numbers (the text begins with \"{start}\")")]
    NoRow { start: String },
    #[error("no name with numbers below it")]
    NoNamedNumbers,
    #[error("{} for {}", counted(*headings, "heading"), counted(*columns, "column"))]
    HeadingCount { headings: usize, columns: usize },
    #[error("an HDF5 file, as written by MATLAB with -v7.3")]
    Hdf5,
    #[error("a .mat file of unknown version {major}")]
    MatVersion { major: u8 },
    #[error("a text that begins with {start:?}")]
    Text { start: String },
    #[error("a file that begins with the bytes {}", hexadecimal(bytes))]
    Bytes { bytes: Vec<u8> },
    /// A table that is not recognised as a frequency response.
    #[error("a table without {lacking}")]
    NotAResponse { lacking: ResponseLack },
}

/// Remedy for missing or unrecognised columns: where and how to name the columns.
const NAME_COLUMNS: &str = "name each column in the first line, with --headings, or under \
    \"headings\" in the rules: \"omega [rad/s]\", \"mag Q/LON [dB]\", \"phase Q/LON [deg]\"";

/// Missing part without which a table cannot be read as a frequency response.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ResponseLack {
    Frequency,
    /// No response has both magnitude and phase, or both real and imaginary part.
    Parts,
    Units(Vec<MissingUnit>),
}

/// A column whose unit is not given, with the two units that it may have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingUnit {
    pub place: ColumnPlace,
    /// The two possible units, as written in a heading.
    pub units: [&'static str; 2],
}

impl Display for ResponseLack {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        match self {
            Self::Frequency => write!(out, "a frequency column; {NAME_COLUMNS}"),
            Self::Parts => write!(
                out,
                "a pair of columns for magnitude and phase, or for real and imaginary part; \
                {NAME_COLUMNS}"
            ),
            Self::Units(columns) => {
                let mut questions = Vec::with_capacity(columns.len());
                for MissingUnit { place, units } in columns {
                    questions.push(format!("{place}: write [{}] or [{}]", units[0], units[1]));
                }
                write!(
                    out,
                    "the unit of {} in the heading, with --headings, or under \"headings\" in the \
                    rules",
                    questions.join(", and of ")
                )
            }
        }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    let bytes: Vec<String> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    bytes.join(" ")
}
