//! Study files, `*.gdcm-study.json`.

mod build;
mod export;
mod schema;

use std::fs;
use std::path::{Path, PathBuf};

use crate::study::Study;

use super::dataset_file::{DatasetOrigin, LoadedDataset, dataset_from, embedded_example};
use super::file_error::FileError;
use super::output_set::{Existing, OutputSet};
use super::source::Source;

use build::study_of;
use export::text_of;
use schema::{DatasetReference, FORMAT, StudyText};

/// How the name of a study file ends.
pub const STUDY_EXTENSION: &str = "gdcm-study.json";
/// What stands for a path where a study is about the embedded example.
const EMBEDDED: &str = "embedded example";

/// Saves a study of a loaded dataset, in place of what is there; whole, or not at all. The dataset itself is never replaced.
pub fn save_study(study: &Study, loaded: &LoadedDataset, path: &Path) -> Result<(), FileError> {
    let reference = match &loaded.origin {
        DatasetOrigin::EmbeddedExample => {
            DatasetReference { path: None, name: EMBEDDED.to_owned(), sha256: loaded.sha256.clone() }
        }
        DatasetOrigin::File(dataset) => DatasetReference {
            path: Some(path_text(dataset, path)?),
            name: study.dataset.name().to_owned(),
            sha256: loaded.sha256.clone(),
        },
    };
    let text = text_of(study, reference);
    let mut output = OutputSet::new(Existing::Replace, loaded.origin.file().into_iter().collect());
    output.add(path, |file| {
        serde_json::to_writer_pretty(&mut *file, &text)?;
        file.write_all(b"\n")
    })?;
    output.persist()
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
    let (dataset, directory) = (settled(dataset)?, settled(study)?);
    // No way leads to another drive: there the path is the dataset's own.
    let relative =
        directory.parent().and_then(|directory| pathdiff::diff_paths(&dataset, directory)).unwrap_or(dataset);
    let unreadable = || FileError::unwritable(study, "the dataset's path is not valid Unicode");
    let text = relative.to_str().ok_or_else(unreadable)?;
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
