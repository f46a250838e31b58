//! Requirement files (M17): `requirements.json` and `requirements.csv`, which hold the same values.

mod requirements_csv;
mod requirements_json;

use std::path::{Path, PathBuf};

use self::requirements_csv::write_rows;
use self::requirements_json::requirements_json;
use crate::file_error::FileError;
use crate::json_writing::write_pretty;
use crate::output_set::{OutputSet, make_directory};

pub use self::requirements_json::RequirementResults;

/// Names of the two requirement files, in the order JSON, CSV.
pub const REQUIREMENT_FILES: [&str; 2] = ["requirements.json", "requirements.csv"];

/// Returns the paths to the JSON and the CSV file in a directory.
pub fn requirement_paths(directory: &Path) -> [PathBuf; 2] {
    REQUIREMENT_FILES.map(|name| directory.join(name))
}

/// Writes the JSON and the CSV file, or neither, into a directory, which is created if missing.
pub fn write_requirements(
    results: RequirementResults<'_>,
    directory: &Path,
    mut outputs: OutputSet,
) -> Result<(), FileError> {
    let [json, table] = requirement_paths(directory);
    outputs.check(&[&json, &table])?;
    make_directory(directory)?;
    outputs.add(&json, |file| {
        write_pretty(&requirements_json(results)?, file)
    })?;
    outputs.add(&table, |file| {
        let levels = &results.settings.levels;
        write_rows(results.requirements, results.time_histories, levels, file)
    })?;
    outputs.persist()
}
