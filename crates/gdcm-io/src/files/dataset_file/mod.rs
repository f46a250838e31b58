//! Dataset files, `*.json` and `*.json.gz`.
//!
//! A dataset holds, for each flight condition, a bundle of physics models, a bundle of identified
//! models, and flight records. A *draft* is a dataset before its checks; *cautions* are
//! irregularities in the file that do not prevent its use.

mod conversion;
mod json_form;
mod model_conversion;

use std::fmt;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use flate2::Compression;
use flate2::write::GzEncoder;

use gdcm_model::dataset::Dataset;
use gdcm_model::message_text::{sanitized, sanitized_path};

use self::conversion::CautionedDraft;
use self::json_form::{DatasetText, FORMAT};
use super::example::Example;
use crate::content_fault::ContentError;
use crate::file_caution::FileCaution;
use crate::file_error::FileError;
use crate::file_reading::Source;
use crate::json_writing::write_compact;
use crate::output_set::{Existing, OutputSet};
use crate::reading_budget::ReadingBudget;

pub(crate) use self::json_form::{LabelText, ModelText, RecordText};

/// Where a dataset comes from: a file, or an example in the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DatasetOrigin {
    File(PathBuf),
    EmbeddedExample(Example),
}

impl fmt::Display for DatasetOrigin {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DatasetOrigin::File(path) => formatter.write_str(&sanitized_path(path)),
            DatasetOrigin::EmbeddedExample(example) => write!(formatter, "({})", example.name()),
        }
    }
}

impl DatasetOrigin {
    /// Returns the example; `None` for a file.
    pub fn example(&self) -> Option<Example> {
        match self {
            DatasetOrigin::File(_) => None,
            DatasetOrigin::EmbeddedExample(example) => Some(*example),
        }
    }

    /// Returns the file path; `None` for an embedded example.
    pub fn file(&self) -> Option<PathBuf> {
        match self {
            DatasetOrigin::File(path) => Some(path.clone()),
            DatasetOrigin::EmbeddedExample(_) => None,
        }
    }

    /// Returns the path by which error messages name the dataset.
    pub(crate) fn message_path(&self) -> PathBuf {
        match self {
            DatasetOrigin::File(path) => path.clone(),
            DatasetOrigin::EmbeddedExample(_) => PathBuf::from(self.to_string()),
        }
    }
}

/// A dataset with its file hash, and cautions about the file.
#[derive(Clone, Debug)]
pub struct LoadedDataset {
    pub dataset: Arc<Dataset>,
    /// SHA-256 of the stored file, in lower-case hexadecimal.
    pub sha256: String,
    pub origin: DatasetOrigin,
    /// Unknown keys and other irregularities, each with its place.
    pub cautions: Vec<FileCaution>,
}

impl LoadedDataset {
    /// Returns the dataset file's path; `None` for an embedded example.
    pub fn path(&self) -> Option<&Path> {
        match &self.origin {
            DatasetOrigin::File(path) => Some(path),
            DatasetOrigin::EmbeddedExample(_) => None,
        }
    }

    /// Returns the dataset file's name, or the embedded example's name in parentheses.
    pub fn file_name(&self) -> String {
        match self.path().and_then(Path::file_name) {
            Some(name) => sanitized(&name.to_string_lossy()),
            None => self.origin.to_string(),
        }
    }
}

/// Loads a dataset from a file, which may be compressed with gzip. A file with any fault is
/// rejected as a whole.
pub fn load_dataset(path: &Path) -> Result<LoadedDataset, FileError> {
    load_dataset_within(path, &ReadingBudget::default())
}

/// Loads a dataset within a reading budget, through which the caller can stop the reading.
pub fn load_dataset_within(
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Result<LoadedDataset, FileError> {
    dataset_from(
        &Source::read(path, budget)?,
        DatasetOrigin::File(path.to_owned()),
        budget,
    )
}

/// Loads a dataset from bytes in memory; error messages name `origin` as the source.
pub fn load_dataset_bytes(bytes: &[u8], origin: DatasetOrigin) -> Result<LoadedDataset, FileError> {
    let budget = ReadingBudget::default();
    dataset_from(
        &Source::from_bytes(bytes, &origin.message_path(), &budget)?,
        origin,
        &budget,
    )
}

/// Loads the simulated example's dataset.
pub fn embedded_example() -> Result<LoadedDataset, FileError> {
    load_example(Example::Simulated)
}

/// Loads an example's dataset.
pub fn load_example(example: Example) -> Result<LoadedDataset, FileError> {
    load_dataset_bytes(example.dataset(), DatasetOrigin::EmbeddedExample(example))
}

/// Loads a dataset from text in a file or in memory; all other loaders call this one.
pub(crate) fn dataset_from(
    source: &Source<'_>,
    origin: DatasetOrigin,
    budget: &ReadingBudget<'_>,
) -> Result<LoadedDataset, FileError> {
    let path = origin.message_path();
    let error = |fault| FileError::content_with_line(&path, fault, source.text());
    // Cautions concern unknown keys, keys that have no meaning in their place, and unusual values.
    let (text, mut cautions) = FORMAT.decode::<DatasetText>(source.text(), &path, budget)?;
    let CautionedDraft {
        draft,
        cautions: misplaced,
    } = text.into_draft().map_err(error)?;
    cautions.extend(misplaced);
    let (dataset, oddities) = draft
        .checked()
        .map_err(|fault| error(ContentError::from(fault)))?;
    for odd in oddities {
        cautions.push(FileCaution::Oddity(odd));
    }
    Ok(LoadedDataset {
        dataset: Arc::new(dataset),
        sha256: source.sha256.clone(),
        origin,
        cautions,
    })
}

/// Returns the faults in a dataset file, up to a maximum number, each with its place; empty if the
/// dataset can be loaded.
///
/// # Errors
/// Fails if the file or its structure cannot be read, or an entry spelled as a word (unit, role,
/// kind) is missing or invalid: further faults cannot be found then.
pub fn dataset_faults(path: &Path) -> Result<Vec<FileError>, FileError> {
    let budget = ReadingBudget::default();
    let source = Source::read(path, &budget)?;
    let (text, _) = FORMAT.decode::<DatasetText>(source.text(), path, &budget)?;
    let error = |fault| FileError::content_with_line(path, fault, source.text());
    let CautionedDraft { draft, .. } = text.into_draft().map_err(error)?;
    let faults = draft.faults().into_iter();
    Ok(faults
        .map(|fault| error(ContentError::from(fault)))
        .collect())
}

/// Checks the structure of a dataset file's text; the text may be incomplete.
///
/// # Errors
/// [`FileError::CutOff`] if the text ends early, otherwise the first structural error.
pub(crate) fn check_dataset_text(
    text: &[u8],
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Result<(), FileError> {
    FORMAT.decode::<DatasetText>(text, path, budget).map(drop)
}

/// Saves a dataset, replacing an existing file; compressed with gzip if the name ends in `.gz`.
pub fn save_dataset(dataset: &Dataset, path: &Path) -> Result<(), FileError> {
    let mut outputs = OutputSet::new(Existing::Replace, Vec::new());
    add_dataset(dataset, path, &mut outputs)?;
    outputs.persist()
}

/// Returns a dataset as uncompressed text for a dataset file.
///
/// # Errors
/// Errors from the JSON writer; no value is known to cause one.
pub fn dataset_json(dataset: &Dataset) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_compact(&DatasetText::from_dataset(dataset), &mut bytes)?;
    Ok(bytes)
}

/// Adds a dataset to `outputs`; compressed with gzip if the name ends in `.gz`.
pub fn add_dataset(
    dataset: &Dataset,
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<(), FileError> {
    let text = DatasetText::from_dataset(dataset);
    let packed = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    outputs.add(path, |file| {
        if packed {
            // Buffered, because JSON is written in small pieces, each of which would cost a call of
            // the encoder.
            let mut pieces =
                BufWriter::with_capacity(1 << 16, GzEncoder::new(file, Compression::default()));
            write_compact(&text, &mut pieces)?;
            pieces.into_inner()?.finish()?;
            Ok(())
        } else {
            write_compact(&text, file)
        }
    })
}
