//! Study files, `*.gdcm-study.json`: a study's decisions, with a reference to its dataset.
//!
//! The decisions are kept by names, so that they can be applied to a dataset that has changed; an
//! [`Inventory`] of the dataset, stored in the study, shows the changes.

mod conversion;
mod json_form;
mod paths;

use std::path::{Path, PathBuf};

use gdcm_study::Study;
use gdcm_study::decisions::dataset_differences::{Difference, Inventory};

use self::conversion::decisions_of;
use self::json_form::{DatasetReference, FORMAT, StudyText};
use self::paths::{path_text, referenced_path, resolved_or_absolute, with_slashes};
use super::dataset_file::{DatasetOrigin, LoadedDataset, load_dataset_within, load_example};
use super::example::Example;
use crate::file_error::FileError;
use crate::file_reading::Source;
use crate::json_writing::write_pretty;
use crate::output_set::{Existing, OutputSet};
use crate::reading_budget::ReadingBudget;

#[cfg(test)]
pub(crate) use self::json_form::MOST_VARIANTS;

/// File extension of a study.
pub const STUDY_EXTENSION: &str = "gdcm-study.json";

/// A study read from a file, with its dataset and the changes of the dataset since the study was
/// saved.
#[derive(Clone, Debug)]
pub struct OpenedStudy {
    /// The study, with all decisions that still apply to the dataset.
    pub study: Study,
    pub loaded: LoadedDataset,
    pub path: PathBuf,
    /// Changes in the dataset, and decisions that do not apply to it; empty if there are neither.
    pub differences: Vec<Difference>,
}

/// Opens a study and its dataset, which is expected at the path given in the study, otherwise in
/// the directory of the study file. A study without a path uses an embedded example.
pub fn open_study(path: &Path) -> Result<OpenedStudy, FileError> {
    let budget = ReadingBudget::default();
    study_from(&Source::read(path, &budget)?, path, None, &budget)
}

/// Opens a study whose dataset has moved to `dataset`. The budget limits the reading of both files.
pub fn open_study_of(
    path: &Path,
    dataset: &Path,
    budget: &ReadingBudget<'_>,
) -> Result<OpenedStudy, FileError> {
    study_from(&Source::read(path, budget)?, path, Some(dataset), budget)
}

/// Checks the structure of the beginning of a study file.
///
/// # Errors
/// [`FileError::CutOff`] if the text ends early, otherwise the first error in it.
pub(crate) fn check_study_text(
    text: &[u8],
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Result<(), FileError> {
    FORMAT.decode::<StudyText>(text, path, budget).map(drop)
}

/// Opens the study in `source`; its dataset is at `moved` if given, otherwise at the path given in
/// the study.
///
/// 1. Decode the text; unknown keys become cautions.
/// 2. Load the dataset.
/// 3. Check the decisions, and apply those that suit the dataset.
/// 4. List the differences: none if the dataset has the same hash, otherwise against the inventory
///    in the study, or only the hashes in older studies without one; and the decisions that no
///    longer apply.
pub(crate) fn study_from(
    source: &Source<'_>,
    path: &Path,
    moved: Option<&Path>,
    budget: &ReadingBudget<'_>,
) -> Result<OpenedStudy, FileError> {
    // Step 1.
    let (text, unknown) = FORMAT.decode::<StudyText>(source.text(), path, budget)?;
    // Step 2.
    let mut loaded = load_referenced(&text.dataset, path, moved, budget)?;
    let DatasetReference {
        sha256, inventory, ..
    } = text.dataset.clone();
    // Step 3.
    let decisions =
        decisions_of(text, &loaded.dataset).map_err(|error| FileError::content(path, error))?;
    let (study, not_applied) = decisions.applied_to(loaded.dataset.clone());
    // Step 4.
    let mut differences = match inventory {
        _ if sha256 == loaded.sha256 => Vec::new(),
        Some(inventory) => inventory.differences(&loaded.dataset),
        None => vec![Difference::AnotherFile {
            expected: sha256,
            found: loaded.sha256.clone(),
        }],
    };
    differences.extend(not_applied);
    loaded.cautions.extend(unknown);
    Ok(OpenedStudy {
        study,
        loaded,
        path: path.to_owned(),
        differences,
    })
}

/// Loads the dataset of a study from `moved` if given; else an embedded example if the study gives
/// no path; else from that path, or from the study file's directory.
fn load_referenced(
    reference: &DatasetReference,
    study: &Path,
    moved: Option<&Path>,
    budget: &ReadingBudget<'_>,
) -> Result<LoadedDataset, FileError> {
    let path = match (moved, &reference.path) {
        (Some(moved), _) => moved.to_owned(),
        (None, None) => return load_example(Example::from_name(&reference.name)),
        (None, Some(relative)) => referenced_path(study, relative),
    };
    match load_dataset_within(&path, budget) {
        Ok(loaded) => Ok(loaded),
        // Cancelled reading does not mean that the dataset is missing.
        Err(error) if error.is_stopped() => Err(error),
        Err(error) => Err(FileError::StudyDataset {
            path: study.to_owned(),
            dataset: Box::new(error),
        }),
    }
}

/// Returns the file name of the dataset to which a study file refers, or the name of the embedded
/// example, for display. Returns `None` if the study file cannot be read.
pub(crate) fn dataset_of_study(path: &Path) -> Option<String> {
    let budget = ReadingBudget::default();
    let source = Source::read(path, &budget).ok()?;
    let (text, _) = FORMAT
        .decode::<StudyText>(source.text(), path, &budget)
        .ok()?;
    match text.dataset.path {
        None => Some(format!(
            "the {}",
            Example::from_name(&text.dataset.name).name()
        )),
        Some(path) => {
            let name = Path::new(&path).file_name()?;
            Some(name.to_string_lossy().into_owned())
        }
    }
}

/// Saves a study completely or not at all, replacing an existing file. Never overwrites the
/// dataset.
pub fn save_study(study: &Study, loaded: &LoadedDataset, path: &Path) -> Result<(), FileError> {
    save(study, loaded, path, |dataset| path_text(dataset, path))
}

/// Saves a recovery file of a study. The path of the dataset is absolute, because the recovery file
/// is not near the dataset.
pub(crate) fn save_recovery(
    study: &Study,
    loaded: &LoadedDataset,
    path: &Path,
) -> Result<(), FileError> {
    save(study, loaded, path, |dataset| {
        with_slashes(&resolved_or_absolute(dataset), path)
    })
}

/// Saves a study with a reference to its dataset; `path_text` writes the dataset's path.
fn save(
    study: &Study,
    loaded: &LoadedDataset,
    path: &Path,
    path_text: impl FnOnce(&Path) -> Result<String, FileError>,
) -> Result<(), FileError> {
    let sha256 = loaded.sha256.clone();
    let inventory = Some(Inventory::from_dataset(study.file_dataset()));
    let reference = match &loaded.origin {
        DatasetOrigin::EmbeddedExample(example) => DatasetReference {
            path: None,
            name: example.name().to_owned(),
            sha256,
            inventory,
        },
        DatasetOrigin::File(dataset) => DatasetReference {
            path: Some(path_text(dataset)?),
            name: study.dataset.name().to_owned(),
            sha256,
            inventory,
        },
    };
    let text = StudyText::new(study, reference);
    let mut output = OutputSet::new(
        Existing::Replace,
        loaded.origin.file().into_iter().collect(),
    );
    output.add(path, |file| write_pretty(&text, file))?;
    output.persist()
}
