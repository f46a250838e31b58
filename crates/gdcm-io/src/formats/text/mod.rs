//! Text files with numbers: tables in columns, frequency responses, matrices, and MATLAB
//! statements.
//!
//! ```text
//! bytes -> text                              (encoding)
//!       -> table: columns, names, units      (table_reader, with layout, heading, cell_number)
//!            -> frequency responses          (frequency_columns)
//!       -> table, after complex numbers, words or clock times are replaced by plain numbers
//!                                            (complex_columns, numbered_words)
//!       -> matrices with names               (matrix_text)
//!       -> variables of MATLAB statements    (matlab_statements)
//! ```
//!
//! The importers in this file read only MATLAB statements; they return any other text as
//! `Contents::Text`, for which the module `crate::import` calls the other readers.

mod cell_number;
mod clock_time;
mod column_meaning;
mod complex_columns;
pub(crate) mod encoding;
mod frequency_columns;
mod heading;
mod heading_cells;
mod heading_units;
mod layout;
mod lines;
mod matlab_brackets;
mod matlab_functions;
mod matlab_number_syntax;
mod matlab_scanner;
mod matlab_statement_values;
mod matlab_statements;
mod matlab_value_position;
mod matlab_workspace;
mod matrix_lines;
mod matrix_text;
mod numbered_words;
mod quantity_words;
mod response_columns;
mod response_group;
mod response_label;
mod response_recognition;
pub(crate) mod sections;
mod separator;
mod table_reader;
mod text_table;
mod unrecognised;

use crate::file_error::FileError;
use crate::formats::text::encoding::decode;
use crate::formats::text::matlab_statements::{Statements, read_statements};
use crate::formats::variables::PageIndex;
use crate::formats::{Contents, Importer};

pub(crate) use complex_columns::split_complex;
pub(crate) use frequency_columns::FrequencyColumns;
pub(crate) use matrix_text::{read_matrices, read_matrix};
pub(crate) use numbered_words::{NumberedText, numbered_words};
pub(crate) use response_columns::{RecognisedResponse, ResponsePoints};
pub(crate) use table_reader::read_table;
pub(crate) use text_table::TextTable;
pub use unrecognised::UnitNotGiven;
pub(crate) use unrecognised::Unrecognised;

/// Importer for MATLAB and Octave statements.
pub(crate) const MATLAB_STATEMENTS: Importer = Importer {
    name: "MATLAB statements",
    endings: &["m"],
    recognises: |bytes, ending| {
        if ending == "m" {
            // A file with this ending may also hold only numbers: `TEXT` then takes it.
            !begins_with_numbers(bytes)
        } else {
            TEXT.endings.contains(&ending) && begins_with_statement(bytes)
        }
    },
    read: |bytes, path, budget| {
        let read = decode(bytes, budget).and_then(|text| read_statements(&text, budget));
        let Statements { variables, notes } =
            read.map_err(|fault| FileError::variables(path, fault))?;
        Ok(Contents::Variables {
            variables,
            notes,
            // Without effect: arrays in statements have two dimensions.
            page_index: PageIndex::Last,
        })
    },
};

/// Importer for text files with numbers in columns, or matrices.
pub(crate) const TEXT: Importer = Importer {
    name: "a text",
    endings: &["csv", "txt", "tsv", "dat", "asc", "prn", "log", "out"],
    // Tried last: takes every file that no other importer recognises, whatever its ending.
    recognises: |_, _| true,
    read: |bytes, path, budget| {
        decode(bytes, budget)
            .map(Contents::Text)
            .map_err(|fault| FileError::variables(path, fault))
    },
};

/// Returns a text's first lines, without empty lines and comments (`%`, `#`).
fn first_lines(bytes: &[u8]) -> Vec<String> {
    /// Number of bytes examined at the beginning.
    const HEAD: usize = 4000;
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
    head.lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with(['%', '#']))
        .map(str::to_owned)
        .collect()
}

/// Returns whether a text begins with an assignment of numbers or strings, such as `A = [1 2` or
/// `Ts = 0.02;`. A line such as `Fs = 50` does not count, because it may begin a table.
fn begins_with_statement(bytes: &[u8]) -> bool {
    let lines = first_lines(bytes);
    let Some((name, value)) = lines.first().and_then(|line| line.split_once('=')) else {
        return false;
    };
    let value = value.trim();
    let begins_name = name.starts_with(|letter: char| letter.is_ascii_alphabetic());
    let is_name = name
        .trim()
        .chars()
        .all(|letter| letter.is_ascii_alphanumeric() || "_.(){}".contains(letter));
    begins_name && is_name && (value.starts_with(['[', '{', '\'']) || value.ends_with(';'))
}

/// Returns whether a text begins with a row of numbers, or with column names followed by such a
/// row, unlike MATLAB statements.
fn begins_with_numbers(bytes: &[u8]) -> bool {
    for line in first_lines(bytes).iter().take(2) {
        if line.contains('=') {
            return false;
        }
        if is_row_of_plain_numbers(line) {
            return true;
        }
    }
    false
}

/// Returns whether a line holds only numbers in Rust's notation, with any separator.
fn is_row_of_plain_numbers(line: &str) -> bool {
    let mut has_number = false;
    for cell in line.split([',', ';', '\t', ' ']) {
        if cell.is_empty() {
            continue;
        }
        if cell.parse::<f64>().is_err() {
            return false;
        }
        has_number = true;
    }
    has_number
}
