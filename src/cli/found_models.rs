//! Models read from files and folders in any supported format.

use std::path::PathBuf;

use gdcm_io::import::model_files::{EVERY_TABLE, FoundModels};
use gdcm_io::read_models;
use gdcm_model::assembly::Headings;

use super::failure::Failure;
use super::progress::ReadingProgress;
use super::terminal::{caution, note};

/// Reads the models from files and folders; reports skipped content on standard error.
pub(super) fn found_models(paths: &[PathBuf], headings: &Headings) -> Result<FoundModels, Failure> {
    let found = read_models(paths, headings, &ReadingProgress::new())?;
    for fault in &found.faults {
        caution("not-read", &format!("not read: {fault}"));
    }
    for words in &found.ignored {
        note("no-model", &format!("no model: {words}"));
    }
    for words in found.unused_variable_lines() {
        note("unused-variables", &words);
    }
    Ok(found)
}

/// Returns the column headings given on the command line; they apply to every table with equally
/// many columns.
pub(super) fn given_headings(headings: &[String]) -> Headings {
    if headings.is_empty() {
        return Headings::new();
    }
    let trimmed = headings
        .iter()
        .map(|heading| heading.trim().to_owned())
        .collect();
    Headings::from([(EVERY_TABLE.to_owned(), trimmed)])
}
