//! A dataset or a study, opened depending on its file's content.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use gdcm_study::Study;
use gdcm_study::decisions::dataset_differences::Difference;

use super::dataset_file::{DatasetOrigin, LoadedDataset, dataset_from};
use super::study_file::{OpenedStudy, study_from};
use crate::file_error::FileError;
use crate::file_reading::Source;
use crate::json_outline::Outline;
use crate::reading_budget::ReadingBudget;

/// Content of a file that the user opened.
#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "created once for an opened file and taken apart immediately"
)]
pub enum Opened {
    Dataset(LoadedDataset),
    Study(OpenedStudy),
}

impl Opened {
    /// Returns the study, its dataset and the changes in the dataset. For a dataset, the study is
    /// new and there are no changes.
    pub fn into_study(self) -> (Study, LoadedDataset, Vec<Difference>) {
        match self {
            Opened::Dataset(loaded) => (Study::new(loaded.dataset.clone()), loaded, Vec::new()),
            Opened::Study(OpenedStudy {
                study,
                loaded,
                differences,
                ..
            }) => (study, loaded, differences),
        }
    }
}

/// Returns whether a path can hold only models, neither a dataset nor a study: true for a folder,
/// and for a file that by its name and first character is not JSON.
pub fn holds_models(path: &Path) -> bool {
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase());
    let is_json = matches!(extension.as_deref(), Some("json" | "gz"));
    path.is_dir() || path.is_file() && !is_json && !begins_an_object(path)
}

/// Returns whether a file's first non-blank character opens a JSON object.
fn begins_an_object(path: &Path) -> bool {
    let mut first = Vec::new();
    let read = File::open(path).and_then(|file| file.take(64).read_to_end(&mut first));
    read.is_ok() && first.trim_ascii_start().starts_with(b"{")
}

/// Opens a dataset or a study, depending on the stated format; a file without one is read as a
/// dataset.
pub fn load_any(path: &Path, budget: &ReadingBudget<'_>) -> Result<Opened, FileError> {
    let source = Source::read(path, budget)?;
    match Outline::format_of(source.text(), budget).as_deref() {
        Some("\"gdcm-study\"") => Ok(Opened::Study(study_from(&source, path, None, budget)?)),
        Some("\"gdcm-dataset\"") | None => Ok(Opened::Dataset(dataset_from(
            &source,
            DatasetOrigin::File(path.to_owned()),
            budget,
        )?)),
        Some(found) => Err(FileError::Format {
            path: path.to_owned(),
            // The message adds the outer quotation marks.
            expected: "gdcm-dataset\" or \"gdcm-study",
            found: found.to_owned(),
        }),
    }
}
