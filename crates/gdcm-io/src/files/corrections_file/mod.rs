//! Result files: `corrections.json`, `corrections.csv`, `assessment.csv`, with physics parameters
//! also `physics.csv`, and their checksums.

mod assessment_csv;
mod condition_json;
mod corrections_csv;
mod corrections_json;
mod couplings;
mod csv_condition;
mod labelled_analysis;
mod pair_rows;
mod physics;
mod physics_csv;
mod schedule;
mod solutions;
mod uncertainty;

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use gdcm_model::dataset::ConditionId;
use gdcm_study::Analysis;

use crate::file_error::FileError;
use crate::json_writing::write_pretty;
use crate::output_set::{OutputSet, make_directory};

pub use self::assessment_csv::write_assessment_csv;
pub use self::corrections_csv::write_corrections_csv;
pub use self::corrections_json::{channel_correction, corrections};
pub(crate) use self::physics_csv::write_physics_csv;

const NAME: &str = "gdcm-corrections";
const VERSION: u64 = 1;

/// Result file names; the last file contains checksums for the others.
pub const RESULT_FILES: [&str; 4] = [
    "corrections.json",
    "corrections.csv",
    "assessment.csv",
    "corrections.sha256",
];

/// Name of the physics parameter table, which is written with the result files if physics
/// parameters are applied.
pub const PHYSICS_FILE: &str = "physics.csv";

/// Returns the paths of the result files in a directory.
pub fn result_paths(directory: &Path) -> [PathBuf; 4] {
    RESULT_FILES.map(|name| directory.join(name))
}

/// Writes the result files for the chosen conditions into a directory, which is created if missing,
/// with [`PHYSICS_FILE`] if physics parameters are applied. Either all files are written or none.
/// The checksums, written last, show whether the files belong together.
///
/// `sha256` is the dataset file's hash.
pub fn write_results(
    analysis: &Analysis,
    sha256: &str,
    chosen: &BTreeSet<ConditionId>,
    directory: &Path,
    mut outputs: OutputSet,
) -> Result<(), FileError> {
    let [json, channels, responses, checksums] = result_paths(directory);
    let parameters = directory.join(PHYSICS_FILE);
    let mut paths = vec![json.as_path(), &channels, &responses, &checksums];
    if analysis.applied_physics().is_some() {
        paths.push(&parameters);
    }
    outputs.check(&paths)?;
    make_directory(directory)?;
    outputs.add(&json, |file| {
        write_corrections(analysis, sha256, chosen, file)
    })?;
    outputs.add(&channels, |file| {
        write_corrections_csv(analysis, chosen, file)
    })?;
    outputs.add(&responses, |file| {
        write_assessment_csv(analysis, chosen, file)
    })?;
    if let Some(applied) = analysis.applied_physics() {
        outputs.add(&parameters, |file| write_physics_csv(Some(applied), file))?;
    }
    outputs.add_checksums(&checksums)?;
    outputs.persist()
}

/// Writes `corrections.json`: all results for the chosen conditions.
pub(crate) fn write_corrections(
    analysis: &Analysis,
    sha256: &str,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    write_pretty(&corrections(analysis, sha256, chosen), file)
}
