//! Result files: `corrections.json`, `corrections.csv`, `assessment.csv`, and their checksums.

mod corrections;
mod couplings;
mod tables;
mod uncertainty;

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use gdcm_core::dataset::ConditionId;
use gdcm_core::study::Analysis;

use super::file_error::FileError;
use super::json_text::write_pretty;
use super::output_set::{OutputSet, make_directory};
use tables::response_table;

pub(super) use tables::channel_table;

pub use corrections::corrections;

const NAME: &str = "gdcm-corrections";
const VERSION: u64 = 1;

/// The names of the files of results; the last holds the checksums of the others.
pub const RESULT_FILES: [&str; 4] = ["corrections.json", "corrections.csv", "assessment.csv", "corrections.sha256"];

/// Where the files of results stand in a directory.
pub fn result_paths(directory: &Path) -> [PathBuf; 4] {
    RESULT_FILES.map(|name| directory.join(name))
}

/// Writes the results of the chosen conditions into a directory, made where there is none: all files, or none; last their checksums, which
/// tell whether they belong together.
///
/// `sha256` is that of the dataset's file.
pub fn write_results(
    analysis: &Analysis,
    sha256: &str,
    chosen: &BTreeSet<ConditionId>,
    directory: &Path,
    mut outputs: OutputSet,
) -> Result<(), FileError> {
    let [json, channels, responses, checksums] = result_paths(directory);
    outputs.check(&[&json, &channels, &responses, &checksums])?;
    make_directory(directory)?;
    outputs.add(&json, |file| write_corrections(analysis, sha256, chosen, file))?;
    outputs.add(&channels, |file| channel_table(analysis, chosen, file))?;
    outputs.add(&responses, |file| response_table(analysis, chosen, file))?;
    outputs.add_checksums(&checksums)?;
    outputs.persist()
}

/// `corrections.json`: everything that was found in the chosen conditions.
pub(super) fn write_corrections(
    analysis: &Analysis,
    sha256: &str,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    write_pretty(&corrections(analysis, sha256, chosen), file)
}
