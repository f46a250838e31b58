//! Study files, `*.gdcm-study.json`: the decisions of a study, with a reference to its dataset.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::limits::{MOST_CHANNELS, MOST_CONDITIONS, MOST_MODELS, MOST_RECORDS};
use gdcm_model::dataset::location::Location;
use gdcm_model::dataset::{Condition, ConditionId, Dataset};
use gdcm_model::whole_number::whole;
use gdcm_study::Study;
use gdcm_study::decisions::adopted_models::AdoptedModels;
use gdcm_study::decisions::choices::{BundleChoice, ConditionChoice};
use gdcm_study::decisions::dataset_differences::{Difference, Inventory};
use gdcm_study::decisions::named_decisions::Decisions;
use gdcm_study::decisions::requirement_settings::RequirementSettings;
use gdcm_study::decisions::settings::{ResponseNames, Settings};
use gdcm_study::decisions::signs::TurnedChannel;

use super::dataset_file::{
    DatasetOrigin, LoadedDataset, ModelText, RecordText, dataset_from, embedded_example,
    load_dataset_within,
};
use crate::file_error::{ContentError, ContentFault, FileError};
use crate::json_text::{Format, list, write_pretty};
use crate::location::Outline;
use crate::output_set::{Existing, OutputSet};
use crate::reading_budget::ReadingBudget;
use crate::source::Source;

/// Maximum number of variants in a study file.
pub(crate) const MOST_VARIANTS: usize = 1000;

/// Format and version of a study file.
const FORMAT: Format = Format {
    name: "gdcm-study",
    version: 1,
};

/// File extension of a study.
pub const STUDY_EXTENSION: &str = "gdcm-study.json";
/// Dataset name in a study of the embedded example, whose dataset has no path.
const EMBEDDED: &str = "embedded example";

/// A study read from a file, with its dataset and the changes of the dataset since the study was
/// saved.
#[derive(Clone, Debug)]
pub struct OpenedStudy {
    /// The study, with all decisions that still apply to the dataset.
    pub study: Study,
    pub loaded: LoadedDataset,
    pub path: PathBuf,
    /// Changes in the dataset, and decisions that no longer apply; empty if the dataset is
    /// unchanged.
    pub differences: Vec<Difference>,
}

/// Content of a study file.
#[derive(Deserialize, Serialize)]
struct StudyText {
    format: String,
    #[serde(deserialize_with = "whole")]
    version: u64,
    software: String,
    dataset: DatasetReference,
    settings: Settings<ResponseNames>,
    #[serde(deserialize_with = "list::<MOST_CONDITIONS, _, _>")]
    conditions: Vec<ConditionText>,
    /// Identified models that replace those of the dataset.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "list::<MOST_CONDITIONS, _, _>"
    )]
    taken: Vec<TakenText>,
    /// Channels whose sign is reversed in some models.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "list::<MOST_CHANNELS, _, _>"
    )]
    signs: Vec<TurnedChannel>,
    /// Decisions about the requirements; omitted if they are the defaults.
    #[serde(default, skip_serializing_if = "is_default")]
    requirements: RequirementSettings,
    /// Named alternatives to the decisions; absent in older studies.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "list::<MOST_VARIANTS, _, _>"
    )]
    variants: Vec<VariantText>,
}

/// Identified models adopted in a condition, and their flight records.
#[derive(Deserialize, Serialize)]
struct TakenText {
    #[serde(deserialize_with = "whole")]
    condition: i64,
    #[serde(deserialize_with = "list::<MOST_MODELS, _, _>")]
    identified_models: Vec<ModelText>,
    #[serde(default, deserialize_with = "list::<MOST_RECORDS, _, _>")]
    records: Vec<RecordText>,
}

/// A named alternative to the decisions.
#[derive(Deserialize, Serialize)]
struct VariantText {
    name: String,
    settings: Settings<ResponseNames>,
    #[serde(deserialize_with = "list::<MOST_CONDITIONS, _, _>")]
    conditions: Vec<ConditionText>,
}

/// Reference from a study to its dataset.
#[derive(Clone, Deserialize, Serialize)]
struct DatasetReference {
    /// Path relative to the study's directory, with `/` between its parts; `None` for the embedded
    /// example.
    path: Option<String>,
    /// Name of the dataset, for display only.
    name: String,
    sha256: String,
    /// Summary of the dataset's contents, used to find changes; absent in older studies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    holds: Option<Inventory>,
}

/// Decisions about a condition.
#[derive(Deserialize, Serialize)]
struct ConditionText {
    #[serde(deserialize_with = "whole")]
    id: i64,
    physics: BundleChoice,
    identified: BundleChoice,
    scheduled: bool,
    /// Whether the condition is held out for validation; absent in older studies.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    held_out: bool,
}

impl ConditionText {
    fn from_condition(condition: &Condition, study: &Study) -> Self {
        let ConditionChoice {
            physics,
            identified,
            scheduled,
            held_out,
        } = study.choice(condition.id()).clone();
        Self {
            id: condition.id().0,
            physics,
            identified,
            scheduled,
            held_out,
        }
    }

    /// Returns the decisions about all conditions.
    fn from_study(study: &Study) -> Vec<Self> {
        let conditions = study.dataset.conditions().iter();
        conditions
            .map(|condition| Self::from_condition(condition, study))
            .collect()
    }
}

impl StudyText {
    fn new(study: &Study, dataset: DatasetReference) -> Self {
        let mut variants = Vec::new();
        for variant in &study.variants {
            if let Some(variant_study) = study.of_variant(&variant.name) {
                variants.push(VariantText {
                    name: variant.name.clone(),
                    settings: variant.settings.named(&study.dataset),
                    conditions: ConditionText::from_study(&variant_study),
                });
            }
        }
        let mut taken = Vec::new();
        for (condition, adopted) in study.taken_models() {
            taken.push(TakenText {
                condition: condition.0,
                identified_models: adopted.models.iter().map(ModelText::of_model).collect(),
                records: adopted
                    .records
                    .iter()
                    .map(RecordText::from_record)
                    .collect(),
            });
        }
        Self {
            format: FORMAT.name.to_owned(),
            version: FORMAT.version,
            software: concat!("gdcm ", env!("CARGO_PKG_VERSION")).to_owned(),
            dataset,
            settings: study.settings.named(&study.dataset),
            conditions: ConditionText::from_study(study),
            taken,
            signs: study.turned_channels(),
            requirements: study.requirements.as_ref().clone(),
            variants,
        }
    }
}

fn is_default(settings: &RequirementSettings) -> bool {
    *settings == RequirementSettings::default()
}

/// Converts the content of a study file to decisions, checked against the dataset.
fn decisions_of(text: StudyText, dataset: &Dataset) -> Result<Decisions, ContentError> {
    let mut decisions = present_decisions(text.settings, text.conditions, dataset)?;
    decisions.taken = adopted_models(text.taken, dataset)?;
    for variant in text.variants {
        let VariantText {
            name,
            settings,
            conditions,
        } = variant;
        match present_decisions(settings, conditions, dataset) {
            Ok(variant) => decisions.variants.push((name, variant)),
            Err(mut error) => {
                error.place.entry = format!("variant \"{name}\", {}", error.place.entry);
                return Err(error);
            }
        }
    }
    decisions.signs = text.signs;
    decisions.requirements = Arc::new(text.requirements);
    Ok(decisions)
}

/// Returns the decisions in effect, without the variants.
///
/// # Errors
/// [`ContentError`] for a setting outside its range, or a condition that appears twice.
fn present_decisions(
    mut settings: Settings<ResponseNames>,
    conditions: Vec<ConditionText>,
    dataset: &Dataset,
) -> Result<Decisions, ContentError> {
    settings.complete_delay_scheduling();
    let start = Settings::for_dataset(dataset);
    settings
        .with_responses(|_, _| start.ignored.clone())
        .check()
        .map_err(|(setting, refusal)| {
            ContentError::new(
                Location::entry(format!("settings, {}", setting.key.replace('.', ", "))),
                refusal,
            )
        })?;
    let mut choices = BTreeMap::new();
    for (index, condition) in conditions.into_iter().enumerate() {
        let ConditionText {
            id,
            physics,
            identified,
            scheduled,
            held_out,
        } = condition;
        let choice = ConditionChoice {
            physics,
            identified,
            scheduled,
            held_out,
        };
        if choices.insert(ConditionId(id), choice).is_some() {
            return Err(ContentError::new(
                Location::condition(index + 1, id),
                ContentFault::DuplicateCondition { id },
            ));
        }
    }
    Ok(Decisions {
        settings,
        choices,
        taken: Vec::new(),
        signs: Vec::new(),
        requirements: Arc::default(),
        variants: Vec::new(),
    })
}

/// Returns the models adopted by a study, checked against its dataset.
fn adopted_models(
    texts: Vec<TakenText>,
    dataset: &Dataset,
) -> Result<Vec<(ConditionId, Arc<AdoptedModels>)>, ContentError> {
    let mut adopted = Vec::with_capacity(texts.len());
    for (index, text) in texts.into_iter().enumerate() {
        let mut place = Location::condition(index + 1, text.condition);
        place.entry = "taken".to_owned();
        let mut models = Vec::with_capacity(text.identified_models.len());
        for model in text.identified_models {
            let (model, _) = dataset.identified_model(model.into_identified())?;
            models.push(model);
        }
        let mut records = Vec::with_capacity(text.records.len());
        for (index, record) in text.records.into_iter().enumerate() {
            records.push(record.into_record(&place, index + 1)?);
        }
        adopted.push((
            ConditionId(text.condition),
            Arc::new(AdoptedModels { models, records }),
        ));
    }
    Ok(adopted)
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
        slashed(&settled_or_absolute(dataset), path)
    })
}

/// Returns the absolute path of a dataset with links resolved. If its directory is inaccessible,
/// links stay unresolved, so that the decisions can still be saved.
fn settled_or_absolute(dataset: &Path) -> PathBuf {
    if let Ok(settled) = settled(dataset) {
        return settled;
    }
    std::path::absolute(dataset).unwrap_or(dataset.into())
}

fn save(
    study: &Study,
    loaded: &LoadedDataset,
    path: &Path,
    path_text: impl FnOnce(&Path) -> Result<String, FileError>,
) -> Result<(), FileError> {
    let sha256 = loaded.sha256.clone();
    let holds = Some(Inventory::from_dataset(study.file_dataset()));
    let reference = match &loaded.origin {
        DatasetOrigin::EmbeddedExample => DatasetReference {
            path: None,
            name: EMBEDDED.to_owned(),
            sha256,
            holds,
        },
        DatasetOrigin::File(dataset) => DatasetReference {
            path: Some(path_text(dataset)?),
            name: study.dataset.name().to_owned(),
            sha256,
            holds,
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

/// Returns the file name of the dataset to which a study file refers, for display. Returns `None`
/// if the study file cannot be read.
pub(crate) fn dataset_of_study(path: &Path) -> Option<String> {
    let budget = ReadingBudget::default();
    let source = Source::read(path, &budget).ok()?;
    let (text, _) = FORMAT
        .decode::<StudyText>(source.text(), path, &budget)
        .ok()?;
    match text.dataset.path {
        None => Some(format!("the {EMBEDDED}")),
        Some(path) => {
            let name = Path::new(&path).file_name()?;
            Some(name.to_string_lossy().into_owned())
        }
    }
}

/// Opens a study and its dataset, which is expected at the path given in the study, otherwise in
/// the directory of the study file.
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
pub(crate) fn study_from(
    source: &Source<'_>,
    path: &Path,
    moved: Option<&Path>,
    budget: &ReadingBudget<'_>,
) -> Result<OpenedStudy, FileError> {
    let (text, unknown) = FORMAT.decode::<StudyText>(source.text(), path, budget)?;
    let mut loaded = load_referenced(&text.dataset, path, moved, budget)?;
    let DatasetReference { sha256, holds, .. } = text.dataset.clone();
    let decisions =
        decisions_of(text, &loaded.dataset).map_err(|error| FileError::content(path, error))?;
    let (study, not_applied) = decisions.applied_to(loaded.dataset.clone());
    let mut differences = match holds {
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

/// Loads the dataset of a study from `moved` if given, otherwise from the path given in the study.
fn load_referenced(
    reference: &DatasetReference,
    study: &Path,
    moved: Option<&Path>,
    budget: &ReadingBudget<'_>,
) -> Result<LoadedDataset, FileError> {
    let path = match (moved, &reference.path) {
        (Some(moved), _) => moved.to_owned(),
        (None, None) => return embedded_example(),
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

/// Returns the path of the dataset: as given in the study, or in the directory of the study file if
/// the dataset exists only there.
fn referenced_path(study: &Path, relative: &str) -> PathBuf {
    let directory = study.parent().unwrap_or(Path::new(""));
    let referenced = directory.join(relative);
    if let Some(name) = referenced.file_name() {
        let beside = directory.join(name);
        if !referenced.exists() && beside.exists() {
            return beside;
        }
    }
    referenced
}

/// Returns the path of the dataset as written in the study file `study`: relative if possible.
fn path_text(dataset: &Path, study: &Path) -> Result<String, FileError> {
    let dataset = settled(dataset)?;
    let directory = settled(study)?;
    // There is no relative path to another drive: use the absolute path.
    let relative = directory
        .parent()
        .and_then(|directory| pathdiff::diff_paths(&dataset, directory))
        .unwrap_or(dataset);
    slashed(&relative, study)
}

/// Returns the relative path from the directory of `file` to `folder`, with `/` as the separator.
/// An empty `folder` is the current directory; without a relative path, `folder` itself is
/// returned.
pub fn relative_folder(folder: &Path, file: &Path) -> String {
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let relative = relative_path(folder, file);
    let path = relative.as_deref().unwrap_or(folder);
    path.to_string_lossy()
        .replace(std::path::MAIN_SEPARATOR, "/")
}

/// Returns the relative path from the directory of `file` to `folder`; `None` if there is none.
fn relative_path(folder: &Path, file: &Path) -> Option<PathBuf> {
    let folder = std::path::absolute(folder).ok()?;
    let file = std::path::absolute(file).ok()?;
    pathdiff::diff_paths(folder, file.parent()?)
}

/// Returns a path as text with `/` as the separator.
///
/// # Errors
/// [`FileError`] if the path is not valid Unicode.
fn slashed(path: &Path, study: &Path) -> Result<String, FileError> {
    match path.to_str() {
        Some(text) => Ok(text.replace(std::path::MAIN_SEPARATOR, "/")),
        None => Err(FileError::unwritable(
            study,
            "the dataset's path is not valid Unicode; rename the dataset or its folder",
        )),
    }
}

/// Returns the absolute path of a file, with links in its directory resolved: `..` after an
/// unresolved link would lead elsewhere.
fn settled(path: &Path) -> Result<PathBuf, FileError> {
    let failed = |error: std::io::Error| FileError::writing(path, &error);
    let absolute = std::path::absolute(path).map_err(failed)?;
    match (absolute.parent(), absolute.file_name()) {
        (Some(directory), Some(name)) => {
            Ok(fs::canonicalize(directory).map_err(failed)?.join(name))
        }
        _ => Err(FileError::unwritable(
            path,
            "the path does not end in a file name",
        )),
    }
}

/// Content of a file opened by the user.
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
    /// Returns the study, its dataset and the changes of the dataset. For a dataset, the study is
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

/// Returns whether the first character of a file other than blanks opens a JSON object.
fn begins_an_object(path: &Path) -> bool {
    let mut first = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(64).read_to_end(&mut first));
    read.is_ok() && first.trim_ascii_start().starts_with(b"{")
}

/// Opens a dataset or a study, depending on the content of the file.
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
            expected: "gdcm-dataset\" or \"gdcm-study",
            found: found.to_owned(),
        }),
    }
}
