//! Texts with numbers: tables in columns, frequency responses, matrices and MATLAB literals.

mod column_meaning;
pub(crate) mod columns;
pub mod frequency_columns;
mod heading;
mod literals;
mod matlab_scanner;
pub(crate) mod matrix_text;
pub(crate) mod separator;
pub(crate) mod word_columns;

use crate::file_error::FileError;
use crate::formats::text::separator::decode;
use crate::formats::{Contents, Importer};

pub(crate) use columns::{TextTable, read_table};
pub use frequency_columns::UnsaidUnit;
pub(crate) use frequency_columns::{
    FrequencyColumns, RecognisedResponse, ResponsePoints, Unrecognised,
};
pub(crate) use matrix_text::{read_matrices, read_matrix};

pub(crate) use word_columns::{NumberedText, numbered_words, split_complex};

/// MATLAB and Octave statements.
pub(crate) const LITERALS: Importer = Importer {
    name: "MATLAB statements",
    endings: &["m"],
    recognises: |bytes, ending| {
        ending == "m" && !begins_with_numbers(bytes)
            || TEXT.endings.contains(&ending) && begins_with_statement(bytes)
    },
    read: |bytes, path, budget| {
        let read = decode(bytes, budget).and_then(|text| literals::read_literals(&text, budget));
        let literals::Statements { variables, notes } =
            read.map_err(|fault| FileError::variables(path, fault))?;
        Ok(Contents::Variables {
            variables,
            notes,
            pages_first: false,
        })
    },
};

/// Returns the first lines of a text, without MATLAB comments and empty lines.
fn first_lines(bytes: &[u8]) -> impl Iterator<Item = String> {
    /// Length of the examined beginning \[bytes\].
    const HEAD: usize = 4000;
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]).into_owned();
    let lines: Vec<String> = head.lines().map(|line| line.trim().to_owned()).collect();
    lines
        .into_iter()
        .filter(|line| !line.is_empty() && !line.starts_with(['%', '#']))
}

/// Whether a text begins with an assignment of numbers or texts to a name, such as `A = [1 2` or
/// `Ts = 0.02;`. A table may begin with `Fs = 50`.
fn begins_with_statement(bytes: &[u8]) -> bool {
    first_lines(bytes).next().is_some_and(|line| {
        let Some((name, value)) = line.split_once('=') else {
            return false;
        };
        let value = value.trim();
        let begins_name = name.starts_with(|letter: char| letter.is_ascii_alphabetic());
        let is_name = name
            .trim()
            .chars()
            .all(|letter| letter.is_ascii_alphanumeric() || "_.(){}".contains(letter));
        begins_name && is_name && (value.starts_with(['[', '{', '\'']) || value.ends_with(';'))
    })
}

/// Whether a text begins with a row of numbers, or with column names and such a row; statements
/// never do.
fn begins_with_numbers(bytes: &[u8]) -> bool {
    first_lines(bytes)
        .take(2)
        .take_while(|line| !line.contains('='))
        .any(|line| {
            let mut cells = line
                .split([',', ';', '\t', ' '])
                .filter(|cell| !cell.is_empty())
                .peekable();
            cells.peek().is_some() && cells.all(|cell| cell.parse::<f64>().is_ok())
        })
}

/// Numbers in columns, or matrices.
pub(crate) const TEXT: Importer = Importer {
    name: "a text",
    endings: &["csv", "txt", "tsv", "dat", "asc", "prn", "log", "out"],
    recognises: |_, _| true,
    read: |bytes, path, budget| {
        decode(bytes, budget)
            .map(Contents::Text)
            .map_err(|fault| FileError::variables(path, fault))
    },
};
