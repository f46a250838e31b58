//! Models in files of whatever format: MATLAB, NumPy, JSON, text.
//!
//! ```text
//! bytes -> format, by what they begin with                      (never by the name alone)
//!       -> variables, or a table of columns                     (mat, mat73, npy, text, JSON)
//!       -> models                                               (recognise)
//! folder -> files -> models; matrices in files of their own go together by name: A.csv, B.csv, C.csv, D.csv
//! ```

pub(crate) mod contents;
mod dataset_models;
pub(crate) mod folder;
mod format;
pub(crate) mod json_value;
mod loose_matrices;
mod table_models;

use std::path::Path;

use sha2::{Digest, Sha256};

use gdcm_core::assembly::{FoundModel, Headings};
use gdcm_core::dataset::Provenance;

use super::file_error::FileError;
use super::recognise::{Recognised, recognise};
use super::source::read_bytes;
use super::variables::{MemoryBudget, Variable};

use contents::{Contents, contents_of};
use loose_matrices::LooseMatrix;

pub use folder::{FolderProgress, read_models, sources_folder};
pub use format::FileFormat;

/// Memory that the variables of one file may take \[bytes\].
const MOST_MEMORY: u64 = 1 << 30;
/// Largest file of models \[bytes\].
const LARGEST_FILE: u64 = 512 << 20;

/// What was found in files.
#[derive(Clone, Debug, Default)]
pub struct FoundModels {
    /// The models, in the order of their files.
    pub models: Vec<FoundModel>,
    /// What could not be taken: files, and what looks like a model in them, each with its place and why.
    pub faults: Vec<String>,
    /// What is no model, in words.
    pub passed_over: Vec<String>,
    /// The tables of columns among the files, with the headings that they were read by.
    pub tables: Headings,
    /// Number of files that were read.
    pub files: usize,
}

/// What one file holds.
#[derive(Default)]
struct FileModels {
    recognised: Recognised,
    /// A matrix that has a file to itself.
    loose: Option<LooseMatrix>,
    /// The headings of a table of columns.
    headings: Option<Vec<String>>,
}

/// The models in the bytes of a file of this name, in no more than `most` bytes of memory for its variables.
pub fn models_of_bytes(bytes: &[u8], name: &str, most: u64) -> Result<FoundModels, FileError> {
    let found = of_bytes(bytes, Path::new(name), (name, None), &MemoryBudget::new(most, &|_| false))?;
    let Recognised { mut models, mut faults, passed_over } = found.recognised;
    let of_matrices = loose_matrices::models_of(found.loose.into_iter().collect());
    models.extend(of_matrices.models);
    faults.extend(of_matrices.faults);
    let tables = found.headings.map(|headings| (name.to_owned(), headings)).into_iter().collect();
    Ok(FoundModels { models, faults, passed_over, tables, files: 1 })
}

/// The models of one file; its name is how the dataset calls it, relative to what was asked for, and its headings are those said of
/// its columns.
fn read_file(
    path: &Path,
    named: (&str, Option<&Vec<String>>),
    stop: &dyn Fn(u64) -> bool,
) -> Result<FileModels, FileError> {
    let bytes = read_bytes(path, LARGEST_FILE)?;
    of_bytes(&bytes, path, named, &MemoryBudget::new(MOST_MEMORY, stop))
}

fn of_bytes(
    bytes: &[u8],
    path: &Path,
    (name, headings): (&str, Option<&Vec<String>>),
    meter: &MemoryBudget<'_>,
) -> Result<FileModels, FileError> {
    let wrong = |fault| FileError::Variables { path: path.to_owned(), fault };
    let mut found = match contents_of(bytes, path, meter)? {
        Contents::Variables { variables, notes } => of_variables(&variables, notes, name),
        Contents::Table(table) => {
            let table = match headings {
                Some(said) => table.with_headings(said).map_err(wrong)?,
                None => *table,
            };
            let recognised = table_models::models_of(&table, name).map_err(wrong)?;
            FileModels { recognised, headings: Some(table.headings()), ..FileModels::default() }
        }
        Contents::Dataset(dataset) => {
            let recognised = Recognised { models: dataset_models::models_of(&dataset, name), ..Recognised::default() };
            FileModels { recognised, ..FileModels::default() }
        }
    };
    let sha256: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    for model in &mut found.recognised.models {
        let source = model.draft.source.get_or_insert_with(Provenance::default);
        source.file = Some(name.to_owned());
        source.sha256 = Some(sha256.clone());
        source.note = Some(model.notes.join("; ")).filter(|note| !note.is_empty());
    }
    if let Some(loose) = &mut found.loose {
        loose.sha256 = sha256;
    }
    Ok(found)
}

fn of_variables(variables: &[Variable], notes: Vec<String>, name: &str) -> FileModels {
    if let Some(loose) = LooseMatrix::of(variables, name) {
        return FileModels { loose: Some(loose), ..FileModels::default() };
    }
    let mut recognised = recognise(variables);
    for model in &mut recognised.models {
        model.notes.extend(notes.iter().cloned());
    }
    FileModels { recognised, ..FileModels::default() }
}
