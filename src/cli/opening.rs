//! Opening what a command is about.

use std::path::Path;

use crate::io::{Opened, load_any, open_study_of, plain, plain_path};

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
            say_error(&format!("{}: {}", plain_path(file), plain(&difference.to_string())));
        }
        if arguments.strict && !study.differences.is_empty() {
            return Err(Failure::Different { path: plain_path(file), count: study.differences.len() });
        }
    }
    Ok(opened)
}
