//! Files of either kind that the program opens.

use std::io::Read;
use std::path::Path;

use gdcm_core::study::{Difference, Study};

use super::dataset_file::{DatasetOrigin, LoadedDataset, dataset_from};
use super::file_error::FileError;
use super::source::Source;
use super::study_file::{OpenedStudy, study_from};
use crate::location::Outline;
use crate::variables::ReadingBudget;

/// What a file turned out to be.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "one is made when a file is opened, and taken apart at once")]
pub enum Opened {
    /// A dataset.
    Dataset(LoadedDataset),
    /// A study, with the dataset it is about.
    Study(OpenedStudy),
}

impl Opened {
    /// The study: the one opened, or that of the dataset before any decision; the dataset; and what is different in it.
    pub fn into_study(self) -> (Study, LoadedDataset, Vec<Difference>) {
        match self {
            Opened::Dataset(loaded) => (Study::new(loaded.dataset.clone()), loaded, Vec::new()),
            Opened::Study(OpenedStudy { study, loaded, differences, .. }) => (study, loaded, differences),
        }
    }
}

/// Whether a path is a folder, or a file that by its name and its first sign only models can be taken from: neither a dataset nor a
/// study.
pub fn holds_models(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let by_name = !matches!(extension.as_deref(), Some("json" | "gz"));
    path.is_dir() || path.is_file() && by_name && !begins_an_object(path)
}

/// Whether the first sign of a file opens an object of JSON.
fn begins_an_object(path: &Path) -> bool {
    let mut first = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(64).read_to_end(&mut first));
    read.is_ok() && first.trim_ascii_start().starts_with(b"{")
}

/// Opens a dataset or a study, whichever the file says it is, within a budget.
pub fn load_any(path: &Path, budget: &ReadingBudget<'_>) -> Result<Opened, FileError> {
    let source = Source::read(path, budget)?;
    match Outline::format_of(source.text(), budget).as_deref() {
        Some("\"gdcm-study\"") => Ok(Opened::Study(study_from(&source, path, None, budget)?)),
        Some("\"gdcm-dataset\"") | None => {
            Ok(Opened::Dataset(dataset_from(&source, DatasetOrigin::File(path.to_owned()), budget)?))
        }
        Some(found) => Err(FileError::Format {
            path: path.to_owned(),
            expected: "gdcm-dataset\" or \"gdcm-study",
            found: found.to_owned(),
        }),
    }
}
