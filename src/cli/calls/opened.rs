//! Datasets and studies that the callers of this module (the Python package) hold in memory: read
//! from files, assembled, or made from text.
//!
//! [`called`] runs each function, and collects its messages for the caller instead of printing them.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_io::files::dataset_file::{add_dataset, dataset_json};
use gdcm_io::files::rules_file::rules_json;
use gdcm_io::formats::sources_folder;
use gdcm_io::output_set::OutputSet;
use gdcm_io::{
    DatasetOrigin, LoadedDataset, load_dataset, load_dataset_bytes, load_example, save_study,
};
use gdcm_model::dataset::{BundleKind, Dataset};
use gdcm_model::message_text::sanitized;
use gdcm_study::Study;

use super::options::parsed;
use super::{CallError, Called, Responses, called, response_of};
use crate::cli::assemble::{assembled_models, report_missing_references};
use crate::cli::dataset_lookup::{condition_of, model_names};
use crate::cli::failure::Failure;
use crate::cli::model_arguments::AssembleArguments;
use crate::cli::study_arguments::OpeningArguments;
use crate::cli::terminal::{caution, error};
use crate::cli::{chosen_example, existing, open};

/// A dataset with a study's decisions about it.
#[derive(Clone)]
pub struct OpenedData {
    pub(super) study: Study,
    pub(super) loaded: LoadedDataset,
    /// Whether the dataset can be loaded again from its origin: a file, or an example in the
    /// program.
    pub(super) is_stored: bool,
}

impl OpenedData {
    /// Returns an example that is part of the program: the real aircraft if `is_real`, else the
    /// simulated one.
    ///
    /// # Errors
    /// The example is damaged.
    pub fn example(is_real: bool) -> Result<Called<Self>, CallError> {
        called(|| {
            let loaded = load_example(chosen_example(is_real))?;
            Ok(Self::from_loaded(loaded, true))
        })
    }

    /// Opens a dataset or a study, whose dataset is at `dataset` if it has moved. With `is_strict`,
    /// a dataset that has changed since the study was saved is an error.
    ///
    /// # Errors
    /// The files cannot be read, or the dataset has changed and `is_strict` is set.
    pub fn load(
        file: &Path,
        dataset: Option<PathBuf>,
        is_strict: bool,
    ) -> Result<Called<Self>, CallError> {
        let opening = OpeningArguments {
            dataset,
            strict: is_strict,
        };
        called(|| {
            let (study, loaded, _) = open(file, &opening)?.into_study();
            report_file_cautions(&loaded);
            Ok(Self {
                study,
                loaded,
                is_stored: true,
            })
        })
    }

    /// Reads a dataset from the text of a dataset file; messages name `name` as its source.
    ///
    /// # Errors
    /// The text is not a valid dataset.
    pub fn from_json(text: &[u8], name: &str) -> Result<Called<Self>, CallError> {
        called(|| {
            // The name takes the place of a path in messages.
            let origin = DatasetOrigin::File(PathBuf::from(name));
            let loaded = load_dataset_bytes(text, origin)?;
            report_file_cautions(&loaded);
            Ok(Self::from_loaded(loaded, false))
        })
    }

    pub(super) fn from_loaded(loaded: LoadedDataset, is_stored: bool) -> Self {
        Self {
            study: Study::new(Arc::clone(&loaded.dataset)),
            loaded,
            is_stored,
        }
    }

    /// Takes a dataset that is not in a file; `name` is its source in messages. Its text is read
    /// back, so that it has the checks and the checksum of a dataset file; cautions about the text
    /// are not reported.
    pub(super) fn from_dataset(dataset: &Dataset, name: &str) -> Result<Self, Failure> {
        let text = dataset_text(dataset)?;
        let loaded = load_dataset_bytes(&text, DatasetOrigin::File(PathBuf::from(name)))?;
        Ok(Self::from_loaded(loaded, false))
    }

    pub fn dataset(&self) -> &Arc<Dataset> {
        &self.loaded.dataset
    }

    /// Returns the dataset's source: the path to its file, the name from [`Self::from_json`], or a
    /// description in parentheses.
    pub fn source(&self) -> String {
        self.loaded.origin.to_string()
    }

    /// Returns the dataset as the text of a dataset file.
    ///
    /// # Errors
    /// The dataset cannot be written.
    pub fn dataset_json(&self) -> Result<Vec<u8>, CallError> {
        Ok(called(|| dataset_text(&self.loaded.dataset))?.value)
    }

    /// Writes the dataset to a file, compressed if the name ends in `.gz`.
    ///
    /// # Errors
    /// The file exists and is not to be replaced, or cannot be written.
    pub fn save_dataset(&self, path: &Path, may_replace: bool) -> Result<(), CallError> {
        let mut outputs = OutputSet::new(existing(may_replace), Vec::new());
        called(|| {
            outputs.check(&[path])?;
            add_dataset(&self.loaded.dataset, path, &mut outputs)?;
            outputs.persist()?;
            Ok(())
        })?;
        Ok(())
    }

    /// Saves the study, and beside it its dataset if that is not in a file; existing files are
    /// replaced.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn save_study(&self, path: &Path) -> Result<(), CallError> {
        called(|| save(&self.study, &self.loaded, self.is_stored, path))?;
        Ok(())
    }

    /// Returns a response of a model in the dataset at the frequencies `omega` \[rad/s\], by output
    /// and input. Delays are exact.
    ///
    /// # Errors
    /// The dataset has no such model; the error names the option `--model` of the command line.
    pub fn response(
        &self,
        condition: i64,
        bundle: BundleKind,
        model: &str,
        omega: &[f64],
    ) -> Result<Responses, CallError> {
        let dataset = &self.loaded.dataset;
        let response = called(|| {
            let id = condition_of(dataset, condition)?;
            let condition = dataset.condition(id);
            if let Some(found) = condition.and_then(|condition| condition.model(bundle, model)) {
                return Ok(response_of(&found.dynamics, omega));
            }
            let names = match condition {
                Some(condition) => model_names(condition, bundle),
                None => "none".to_owned(),
            };
            let reason = sanitized(&format!(
                "condition {id} has no {bundle} model \"{model}\"; {bundle} models: {names}"
            ));
            Err(Failure::coded_option("--model", "unknown-model", reason))
        });
        Ok(response?.value)
    }
}

/// Saves a study, and beside it its dataset if that is not yet in a file.
///
/// The dataset file gets the dataset as loaded, without adopted models and reversed signs: these are
/// decisions, which the study file holds. It is read back, because the study file states the path
/// and the checksum of that file.
fn save(
    study: &Study,
    loaded: &LoadedDataset,
    is_stored: bool,
    path: &Path,
) -> Result<(), Failure> {
    if is_stored {
        save_study(study, loaded, path)?;
        return Ok(());
    }
    let dataset = path_of_dataset(path);
    let mut outputs = OutputSet::new(existing(true), Vec::new());
    add_dataset(study.file_dataset(), &dataset, &mut outputs)?;
    outputs.persist()?;
    save_study(study, &load_dataset(&dataset)?, path)?;
    Ok(())
}

/// Returns the path for the dataset that is written beside a study: "aw 1.2.dataset.json.gz" for
/// "aw 1.2.gdcm-study.json".
fn path_of_dataset(study: &Path) -> PathBuf {
    let name = match study.file_name() {
        Some(name) => name.to_string_lossy().into_owned(),
        None => String::new(),
    };
    let stem = [".gdcm-study.json", ".json"]
        .iter()
        .find_map(|ending| name.strip_suffix(ending))
        .unwrap_or(&name);
    study.with_file_name(format!("{stem}.dataset.json.gz"))
}

pub(super) fn dataset_text(dataset: &Dataset) -> Result<Vec<u8>, Failure> {
    dataset_json(dataset).map_err(|error| Failure::NoResult {
        reason: error.to_string(),
    })
}

fn report_file_cautions(loaded: &LoadedDataset) {
    for found in &loaded.cautions {
        caution(found.code(), &format!("{}: {found}", loaded.origin));
    }
}

/// A dataset assembled from model files, with its rules.
pub struct Assembled {
    pub data: OpenedData,
    /// Rules by which the files were read, as the text of a rules file.
    pub rules: Vec<u8>,
}

/// Assembles a dataset from model files. The options are those of `gdcm assemble`; `--out`, which it
/// requires, has no effect here: nothing is written.
///
/// # Errors
/// The files cannot be read, or the rules are incomplete; the errors among the messages then list
/// the missing items.
pub fn assemble(options: Vec<OsString>) -> Result<Called<Assembled>, CallError> {
    called(|| {
        let arguments: AssembleArguments = parsed(options)?;
        let assembly = assembled_models(&arguments)?;
        for found in assembly.cautions() {
            caution(found.code(), &assembly.caution_words(&found));
        }
        let rules = rules_json(assembly.rules()).map_err(|error| Failure::NoResult {
            reason: error.to_string(),
        })?;
        let folder = sources_folder(&arguments.folders);
        let Some(dataset) = assembly.dataset(&folder.to_string_lossy()) else {
            let problems = assembly.problem_lines();
            for problem in &problems {
                error(problem.code, &problem.text);
            }
            return Err(Failure::Incomplete {
                count: problems.len(),
                rules: "the rules".to_owned(),
            });
        };
        report_missing_references(&dataset);
        let name = format!("({})", sanitized(dataset.name()));
        Ok(Assembled {
            data: OpenedData::from_dataset(&dataset, &name)?,
            rules,
        })
    })
}
