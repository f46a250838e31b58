//! Study files, `*.gdcm-study.json`.

mod build;
mod export;
mod relative_path;
mod schema;

use std::fs;
use std::path::{Path, PathBuf};

use crate::study::Study;

use super::dataset_file::{DatasetOrigin, LoadedDataset, dataset_from, embedded_example};
use super::file_error::FileError;
use super::source::Source;
use super::whole_file::write_whole;

use build::study_of;
use export::text_of;
use relative_path::relative_path;
use schema::{DatasetReference, FORMAT, StudyText};

/// How the name of a study file ends.
pub const STUDY_EXTENSION: &str = "gdcm-study.json";
/// What stands for a path where a study is about the embedded example.
const EMBEDDED: &str = "embedded example";

/// Saves a study of a loaded dataset; replaced whole, or not at all.
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
    let sha256 = loaded.sha256.clone();
    let reference = match &loaded.origin {
        DatasetOrigin::EmbeddedExample => DatasetReference { path: None, name: EMBEDDED.to_owned(), sha256 },
        DatasetOrigin::File(dataset) => {
            DatasetReference { path: Some(path_text(dataset)?), name: study.dataset.name().to_owned(), sha256 }
        }
    };
    let text = text_of(study, reference);
    write_whole(path, |file| {
        serde_json::to_writer_pretty(&mut *file, &text)?;
        file.write_all(b"\n")
    })
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

/// Opens a study, and the dataset it is about, which must still be the one the study was saved with.
pub fn open_study(path: &Path) -> Result<(Study, LoadedDataset), FileError> {
    study_from(&Source::read(path)?, path)
}

/// The study that a source holds, with its dataset.
pub(super) fn study_from(source: &Source<'_>, path: &Path) -> Result<(Study, LoadedDataset), FileError> {
    let (text, unknown) = FORMAT.decode::<StudyText>(source.text(), path)?;
    FORMAT.check_read(&text.format, text.version, path)?;
    let mut loaded = load_referenced(&text.dataset, path)?;
    let study = study_of(loaded.dataset.clone(), &text.settings, &text.conditions)
        .map_err(|flaw| FileError::content(path, flaw))?;
    loaded.cautions.extend(unknown);
    Ok((study, loaded))
}

fn load_referenced(reference: &DatasetReference, study: &Path) -> Result<LoadedDataset, FileError> {
    let wrapped = |error| FileError::StudyDataset { path: study.to_owned(), dataset: Box::new(error) };
    let changed = |origin: &DatasetOrigin, found: &str| FileError::DatasetChanged {
        path: study.to_owned(),
        dataset: origin.to_string(),
        expected: reference.sha256.clone(),
        found: found.to_owned(),
    };
    let Some(relative) = &reference.path else {
        let loaded = embedded_example()?;
        let same = loaded.sha256 == reference.sha256;
        return if same { Ok(loaded) } else { Err(changed(&loaded.origin, &loaded.sha256)) };
    };
    let path = study.parent().unwrap_or(Path::new("")).join(relative);
    let source = Source::read(&path).map_err(wrapped)?;
    let origin = DatasetOrigin::File(path);
    // Before anything in it is complained of: what is wrong with it may be that it has changed.
    if source.sha256 != reference.sha256 {
        return Err(changed(&origin, &source.sha256));
    }
    dataset_from(&source, origin).map_err(wrapped)
}

/// The dataset's path as the study at `study` has to write it.
fn path_text(dataset: &Path, study: &Path) -> Result<String, FileError> {
    slashed(&relative_path(&settled(dataset)?, settled(study)?.parent().unwrap_or(Path::new("/"))), study)
}

/// A path with `/` between its parts.
fn slashed(path: &Path, study: &Path) -> Result<String, FileError> {
    let text = path.to_str().ok_or_else(|| FileError::writing(study, "the dataset's path is not valid Unicode"))?;
    Ok(if std::path::MAIN_SEPARATOR == '/' { text.to_owned() } else { text.replace(std::path::MAIN_SEPARATOR, "/") })
}

/// The absolute path of a file, its directory's links followed: `..` after a link would lead elsewhere.
fn settled(path: &Path) -> Result<PathBuf, FileError> {
    let failed = |error: std::io::Error| FileError::writing(path, error);
    let absolute = std::path::absolute(path).map_err(failed)?;
    match (absolute.parent(), absolute.file_name()) {
        (Some(directory), Some(name)) => Ok(fs::canonicalize(directory).map_err(failed)?.join(name)),
        _ => Err(FileError::writing(path, "this is not the name of a file")),
    }
}
