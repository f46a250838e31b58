//! Opening what a command is about.

use gdcm_core::message_text::{sanitized, sanitized_path};
use std::path::Path;

use gdcm_files::{Opened, load_any, open_study_of};

use super::arguments::OpeningArguments;
use super::failure::Failure;
use super::terminal::say_error;

/// Opens a dataset or a study; what is different in a study's dataset is told on standard error, a line each.
pub(super) fn open(file: &Path, arguments: &OpeningArguments) -> Result<Opened, Failure> {
    let opened = match &arguments.dataset {
        Some(dataset) => Opened::Study(open_study_of(file, dataset)?),
        None => load_any(file)?,
    };
    if let Opened::Study(study) = &opened {
        for difference in &study.differences {
            say_error(&format!("{}: {}", sanitized_path(file), sanitized(&difference.to_string())));
        }
        if arguments.strict && !study.differences.is_empty() {
            return Err(Failure::Different { path: sanitized_path(file), count: study.differences.len() });
        }
    }
    Ok(opened)
}
