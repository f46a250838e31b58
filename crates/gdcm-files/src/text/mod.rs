//! Texts that hold numbers: tables in columns, frequency responses, matrices and MATLAB literals.

mod column_meaning;
mod columns;
mod frequency_columns;
mod heading;
mod literals;
mod matrix_text;
mod separator;
mod word_columns;

use std::path::Path;

use crate::file_error::FileError;
use crate::importer::{Contents, Importer};
use crate::variables::ReadingBudget;

pub(crate) use column_meaning::says_quantity;
pub(crate) use columns::{TextTable, read_table};
pub(crate) use frequency_columns::{FrequencyColumns, RecognisedResponse, ResponsePoints};
pub(crate) use matrix_text::{read_matrices, read_matrix};
pub(crate) use separator::{decode, sections};
pub(crate) use word_columns::{NumberedText, numbered_words};

/// MATLAB's language.
pub(crate) struct Literals;

impl Importer for Literals {
    fn name(&self) -> &'static str {
        "MATLAB statements"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["m"]
    }

    fn recognises(&self, _: &[u8], ending: &str) -> bool {
        ending == "m"
    }

    fn read(&self, bytes: &[u8], path: &Path, budget: &ReadingBudget<'_>) -> Result<Contents, FileError> {
        let read = decode(bytes, budget).and_then(|text| literals::read_literals(&text, budget));
        let literals::Statements { variables, notes } = read.map_err(|fault| FileError::variables(path, fault))?;
        Ok(Contents::Variables { variables, notes })
    }
}

/// Numbers in columns, or matrices.
pub(crate) struct Text;

impl Importer for Text {
    fn name(&self) -> &'static str {
        "a text"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["csv", "txt", "tsv", "dat", "asc", "prn", "log", "out"]
    }

    fn recognises(&self, _: &[u8], _: &str) -> bool {
        true
    }

    fn read(&self, bytes: &[u8], path: &Path, budget: &ReadingBudget<'_>) -> Result<Contents, FileError> {
        decode(bytes, budget).map(Contents::Text).map_err(|fault| FileError::variables(path, fault))
    }
}
