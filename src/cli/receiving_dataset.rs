//! The dataset that receives identified models (`gdcm identify --into`), and the conditions to
//! which the records belong. A record's *guess* is what its name says, such as its condition.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::relative_folder::relative_folder;
use gdcm_io::{Opened, load_any};
use gdcm_model::dataset::condition::ConditionRecord;
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_study::decisions::adopted_models::AdoptedModels;
use gdcm_sysid::records::LaidOutRecord;

use super::condition_messages::listed_conditions;
use super::dataset_lookup::{condition_ids, condition_of};
use super::failure::Failure;
use super::identify_arguments::RecordArguments;
use super::terminal::{caution, note};

/// Records from which models are identified jointly.
pub(super) struct RecordGroup {
    /// The records' condition; `None` without a dataset.
    pub(super) condition: Option<ConditionId>,
    pub(super) records: Vec<LaidOutRecord>,
}

/// A dataset that receives identified models.
pub(super) struct ReceivingDataset {
    pub(super) dataset: Arc<Dataset>,
    /// Path for the extended dataset.
    pub(super) path: PathBuf,
    /// Condition that receives all records; `None` if each record goes to the condition in its
    /// name.
    condition: Option<ConditionId>,
}

impl ReceivingDataset {
    /// Opens the dataset given by `--into`; `None` without this option. Its copy with models is
    /// written to the directory `out`, with this description if there is one.
    pub(super) fn open(
        arguments: &RecordArguments,
        out: &Path,
        description: Option<&str>,
    ) -> Result<Option<Self>, Failure> {
        let Some(path) = arguments.into.as_deref() else {
            return Ok(None);
        };
        let Opened::Dataset(loaded) = load_any(path, &ReadingBudget::default())? else {
            let reason = "expected a dataset, found a study; give the study's dataset";
            return Err(Failure::option("--into", reason));
        };
        let condition = match arguments.condition {
            Some(id) => Some(condition_of(&loaded.dataset, id)?),
            None => None,
        };
        let written = out.join(path.file_name().unwrap_or_default());
        let folder = relative_folder(path.parent().unwrap_or(Path::new("")), &written);
        let dataset = moved_dataset(&loaded.dataset, &folder, description)?;
        Ok(Some(Self {
            dataset: Arc::new(dataset),
            path: written,
            condition,
        }))
    }

    /// Groups the records by condition, ordered as in the dataset: all in the condition given by
    /// `--condition`, or each in the condition in its name. Omitted records are reported on
    /// standard error.
    ///
    /// # Errors
    /// No record remains.
    pub(super) fn groups(&self, records: Vec<LaidOutRecord>) -> Result<Vec<RecordGroup>, Failure> {
        match self.condition {
            Some(condition) => Ok(vec![group_for_condition(condition, records)?]),
            None => self.groups_by_name(records),
        }
    }

    /// Groups the records by the conditions given in their names.
    fn groups_by_name(&self, records: Vec<LaidOutRecord>) -> Result<Vec<RecordGroup>, Failure> {
        let mut groups: Vec<RecordGroup> = Vec::new();
        for condition in self.dataset.conditions() {
            groups.push(RecordGroup {
                condition: Some(condition.id()),
                records: Vec::new(),
            });
        }
        for record in records {
            let condition = record.guess.condition_of(&self.dataset);
            let group = groups.iter_mut().find(|group| group.condition == condition);
            match group {
                Some(group) => group.records.push(record),
                None => {
                    let text = format!(
                        "{}: left out, because its name gives no condition of the dataset",
                        record.table.name
                    );
                    caution("record-without-condition", &text);
                }
            }
        }
        let without: Vec<ConditionId> = groups
            .iter()
            .filter(|group| group.records.is_empty())
            .filter_map(|group| group.condition)
            .collect();
        if !without.is_empty() {
            let text = format!(
                "{}: no records; the identified models remain unchanged",
                listed_conditions(&without)
            );
            note("no-record-of-condition", &text);
        }
        groups.retain(|group| !group.records.is_empty());
        if groups.is_empty() {
            let reason = format!(
                "no record name gives a condition of the dataset ({}); a name with cond03 gives \
                condition 3",
                condition_ids(&self.dataset)
            );
            return Err(Failure::coded_option(
                "--every-condition",
                "no-records",
                reason,
            ));
        }
        Ok(groups)
    }

    /// Adds identified models and their records to a condition.
    pub(super) fn adopt(
        &mut self,
        condition: ConditionId,
        models: &AdoptedModels,
    ) -> Result<(), Failure> {
        let dataset =
            models
                .put_into(&self.dataset, condition)
                .map_err(|error| Failure::NoModels {
                    reason: format!("the models cannot be added to the dataset: {error}"),
                })?;
        self.dataset = Arc::new(dataset);
        Ok(())
    }
}

/// Returns a condition's group: the records whose names give this condition or none. Records whose
/// names give another condition are omitted and reported on standard error.
///
/// # Errors
/// No record remains.
fn group_for_condition(
    condition: ConditionId,
    records: Vec<LaidOutRecord>,
) -> Result<RecordGroup, Failure> {
    let count = records.len();
    let mut own = Vec::new();
    let mut others = Vec::new();
    for record in records {
        match record.guess.condition {
            Some(id) if ConditionId(id) != condition => others.push(record),
            _ => own.push(record),
        }
    }
    if !others.is_empty() {
        let text = format!(
            "{} of {count} records left out for condition {condition}: their names give other \
            conditions ({})",
            others.len(),
            named_conditions(&others)
        );
        caution("records-of-other-condition", &text);
    }
    if own.is_empty() {
        let reason = format!(
            "no record is left for condition {condition}; rename the records of this condition: a \
            name with cond{:02} gives condition {condition}",
            condition.0
        );
        return Err(Failure::coded_option("--condition", "no-records", reason));
    }
    Ok(RecordGroup {
        condition: Some(condition),
        records: own,
    })
}

/// Lists the conditions given in record names: "3, 7".
pub(super) fn named_conditions(records: &[LaidOutRecord]) -> String {
    let named: BTreeSet<i64> = records
        .iter()
        .filter_map(|record| record.guess.condition)
        .collect();
    let named: Vec<String> = named.iter().map(i64::to_string).collect();
    named.join(", ")
}

/// Adapts a dataset to a file in another folder: prefixes the record paths with `folder`, and
/// replaces the description if a new one is given. Errors are attributed to `--description`.
fn moved_dataset(
    dataset: &Dataset,
    folder: &str,
    description: Option<&str>,
) -> Result<Dataset, Failure> {
    const OPTION: &str = "--description";
    let mut header = dataset.header();
    if let Some(description) = description {
        header.description = description.to_owned();
    }
    let mut conditions = Vec::new();
    for condition in dataset.conditions() {
        let mut records: Vec<ConditionRecord> = condition.records().to_vec();
        for record in &mut records {
            record.file = moved_file(&record.file, folder);
        }
        let condition = condition
            .as_ref()
            .clone()
            .with_records(records)
            .map_err(|error| Failure::option(OPTION, error))?;
        conditions.push(condition);
    }
    Dataset::new(header, conditions).map_err(|error| Failure::option(OPTION, error))
}

/// Returns the path prefixed with `folder`; an absolute path is unchanged.
fn moved_file(file: &str, folder: &str) -> String {
    if folder.is_empty() || folder == "." || Path::new(file).is_absolute() {
        file.to_owned()
    } else {
        format!("{folder}/{file}")
    }
}
