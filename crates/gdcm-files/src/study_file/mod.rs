//! Study files, `*.gdcm-study.json`.

mod build;
mod export;
mod schema;

use std::fs;
use std::path::{Path, PathBuf};

use gdcm_core::study::{Decisions, Difference, Inventory, Settings, Study};

use super::dataset_file::{DatasetOrigin, LoadedDataset, dataset_from, embedded_example};
use super::file_error::FileError;
use super::output_set::{Existing, OutputSet};
use super::source::Source;

use build::{decisions_of, inventory_of, taken_of};
use export::{inventory_text, text_of};
use schema::{DatasetReference, FORMAT, StudyText};

/// How the name of a study file ends.
pub const STUDY_EXTENSION: &str = "gdcm-study.json";
/// What stands for a path where a study is about the embedded example.
const EMBEDDED: &str = "embedded example";

/// A study with the dataset it is about, and what is different in that from when the study was saved.
#[derive(Clone, Debug)]
pub struct OpenedStudy {
    /// The study, with every decision that still applies.
    pub study: Study,
    /// Its dataset.
    pub loaded: LoadedDataset,
    /// The study's file.
    pub path: PathBuf,
    /// What has changed in the dataset, and the decisions that no longer apply; none where it is the same.
    pub differences: Vec<Difference>,
}

/// Saves a study of a loaded dataset, in place of what is there; whole, or not at all. The dataset itself is never replaced.
pub fn save_study(study: &Study, loaded: &LoadedDataset, path: &Path) -> Result<(), FileError> {
    save(study, loaded, path, |dataset| path_text(dataset, path))
}

/// Saves a study with its dataset's absolute path: for a file that lies nowhere near it.
pub(super) fn save_recovery(study: &Study, loaded: &LoadedDataset, path: &Path) -> Result<(), FileError> {
    // Its directory may be out of reach just now: the decisions are kept all the same.
    let absolute =
        |dataset: &Path| settled(dataset).or_else(|_| Ok(std::path::absolute(dataset).unwrap_or(dataset.into())));
    save(study, loaded, path, |dataset| slashed(&absolute(dataset)?, path))
}

fn save(
    study: &Study,
    loaded: &LoadedDataset,
    path: &Path,
    path_text: impl FnOnce(&Path) -> Result<String, FileError>,
) -> Result<(), FileError> {
    let (sha256, holds) = (loaded.sha256.clone(), Some(inventory_text(&Inventory::of(study.file_dataset()))));
    let reference = match &loaded.origin {
        DatasetOrigin::EmbeddedExample => DatasetReference { path: None, name: EMBEDDED.to_owned(), sha256, holds },
        DatasetOrigin::File(dataset) => {
            DatasetReference { path: Some(path_text(dataset)?), name: study.dataset.name().to_owned(), sha256, holds }
        }
    };
    let text = text_of(study, reference);
    let mut output = OutputSet::new(Existing::Replace, loaded.origin.file().into_iter().collect());
    output.add(path, |file| {
        serde_json::to_writer_pretty(&mut *file, &text)?;
        file.write_all(b"\n")
    })?;
    output.persist()
}

/// What a study file says its dataset is, in words: the name of its file. None where the study cannot be read.
pub(super) fn dataset_of_study(path: &Path) -> Option<String> {
    let source = Source::read(path).ok()?;
    let (text, _) = FORMAT.decode::<StudyText>(source.text(), path).ok()?;
    Some(match text.dataset.path {
        None => format!("the {EMBEDDED}"),
        Some(path) => Path::new(&path).file_name()?.to_string_lossy().into_owned(),
    })
}

/// Opens a study and the dataset it is about: where the study says, or else beside the study.
pub fn open_study(path: &Path) -> Result<OpenedStudy, FileError> {
    study_from(&Source::read(path)?, path, None)
}

/// Opens a study whose dataset has moved to `dataset`.
pub fn open_study_of(path: &Path, dataset: &Path) -> Result<OpenedStudy, FileError> {
    study_from(&Source::read(path)?, path, Some(dataset))
}

/// The study that a source holds; its dataset is at `moved`, or where the study says.
pub(super) fn study_from(source: &Source<'_>, path: &Path, moved: Option<&Path>) -> Result<OpenedStudy, FileError> {
    let (text, unknown) = FORMAT.decode::<StudyText>(source.text(), path)?;
    FORMAT.check_read(&text.format, text.version, path)?;
    let mut loaded = load_referenced(&text.dataset, path, moved)?;
    let start = Settings::of(&loaded.dataset);
    let decisions = decisions_of(&start, text.settings, text.conditions, text.variants)
        .and_then(|decisions| Ok(Decisions { taken: taken_of(text.taken, &loaded.dataset)?, ..decisions }))
        .map_err(|flaw| FileError::content(path, flaw))?;
    let (study, not_applied) = decisions.applied_to(loaded.dataset.clone());
    let mut differences = match text.dataset.holds {
        _ if text.dataset.sha256 == loaded.sha256 => Vec::new(),
        Some(held) => inventory_of(held).differences(&loaded.dataset),
        None => vec![Difference::AnotherFile { expected: text.dataset.sha256, found: loaded.sha256.clone() }],
    };
    differences.extend(not_applied);
    loaded.cautions.extend(unknown);
    Ok(OpenedStudy { study, loaded, path: path.to_owned(), differences })
}

fn load_referenced(
    reference: &DatasetReference,
    study: &Path,
    moved: Option<&Path>,
) -> Result<LoadedDataset, FileError> {
    let path = match (moved, &reference.path) {
        (Some(moved), _) => moved.to_owned(),
        (None, None) => return embedded_example(),
        (None, Some(relative)) => referenced_path(study, relative),
    };
    let load = |path: PathBuf| dataset_from(&Source::read(&path)?, DatasetOrigin::File(path));
    load(path).map_err(|error| FileError::StudyDataset { path: study.to_owned(), dataset: Box::new(error) })
}

/// Where the study says that its dataset is, or beside the study if it is only there.
fn referenced_path(study: &Path, relative: &str) -> PathBuf {
    let directory = study.parent().unwrap_or(Path::new(""));
    let said = directory.join(relative);
    let beside = said.file_name().map(|name| directory.join(name));
    beside.filter(|beside| !said.exists() && beside.exists()).unwrap_or(said)
}

/// The dataset's path as the study at `study` has to write it.
fn path_text(dataset: &Path, study: &Path) -> Result<String, FileError> {
    let (dataset, directory) = (settled(dataset)?, settled(study)?);
    // No way leads to another drive: there the path is the dataset's own.
    let relative =
        directory.parent().and_then(|directory| pathdiff::diff_paths(&dataset, directory)).unwrap_or(dataset);
    slashed(&relative, study)
}

/// The way from the folder of `file` to `folder`, with `/` between its parts; the folder as it is where there is none.
pub fn relative_folder(folder: &Path, file: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).ok();
    let base = absolute(file).and_then(|file| file.parent().map(Path::to_owned));
    let way = absolute(folder).zip(base).and_then(|(folder, base)| pathdiff::diff_paths(folder, base));
    way.as_deref().unwrap_or(folder).to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/")
}

/// A path with `/` between its parts.
fn slashed(path: &Path, study: &Path) -> Result<String, FileError> {
    let unreadable = || FileError::unwritable(study, "the dataset's path is not valid Unicode");
    let text = path.to_str().ok_or_else(unreadable)?;
    Ok(if std::path::MAIN_SEPARATOR == '/' { text.to_owned() } else { text.replace(std::path::MAIN_SEPARATOR, "/") })
}

/// The absolute path of a file, its directory's links followed: `..` after a link would lead elsewhere.
fn settled(path: &Path) -> Result<PathBuf, FileError> {
    let failed = |error: std::io::Error| FileError::writing(path, &error);
    let absolute = std::path::absolute(path).map_err(failed)?;
    match (absolute.parent(), absolute.file_name()) {
        (Some(directory), Some(name)) => Ok(fs::canonicalize(directory).map_err(failed)?.join(name)),
        _ => Err(FileError::unwritable(path, "this is not the name of a file")),
    }
}
