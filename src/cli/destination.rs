//! Where in a dataset identified models go.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_core::dataset::{ConditionId, ConditionRecord, Dataset};
use gdcm_core::records::LaidOutRecord;
use gdcm_core::study::AdoptedModels;
use gdcm_files::variables::ReadingBudget;
use gdcm_files::{Opened, OutputSet, add_dataset, load_any, relative_folder};

use super::{Failure, IdentifyArguments, caution, condition_of, ids, listed_conditions, note};

/// Records that models are identified from together, and the condition that they are of; none without a dataset.
pub(super) type Group = (Option<ConditionId>, Vec<LaidOutRecord>);

/// A dataset that models are put into.
pub(super) struct Destination {
    pub(super) dataset: Arc<Dataset>,
    /// Where it is written.
    pub(super) path: PathBuf,
    /// The condition; none where each record goes to the one that its name says.
    condition: Option<ConditionId>,
}

impl Destination {
    /// The dataset that the command line names, if any.
    pub(super) fn asked(arguments: &IdentifyArguments) -> Result<Option<Self>, Failure> {
        let Some(path) = arguments.into.as_deref() else { return Ok(None) };
        let dataset = match load_any(path, &ReadingBudget::default())? {
            Opened::Dataset(loaded) => loaded.dataset,
            Opened::Study(_) => {
                let reason = "expected a dataset, found a study; give the study's dataset".to_owned();
                return Err(Failure::Option { option: "--into", reason });
            }
        };
        let condition = arguments.condition.map(|id| condition_of(&dataset, id)).transpose()?;
        let written = arguments.out.join(path.file_name().unwrap_or_default());
        let folder = relative_folder(path.parent().unwrap_or(Path::new("")), &written);
        let dataset = Arc::new(moved(&dataset, &folder, arguments.description.as_deref())?);
        Ok(Some(Self { dataset, path: written, condition }))
    }

    /// The records of each condition, in the order of the dataset; what is left out is told on standard error.
    pub(super) fn groups(&self, records: Vec<LaidOutRecord>) -> Result<Vec<Group>, Failure> {
        if let Some(wanted) = self.condition {
            let is_of = |record: &LaidOutRecord| record.guess.condition.is_none_or(|said| ConditionId(said) == wanted);
            let count = records.len();
            let (own, others): (Vec<_>, Vec<_>) = records.into_iter().partition(is_of);
            if !others.is_empty() {
                caution(&format!(
                    "{} of {count} records left out: their names say condition {}, not {wanted}",
                    others.len(),
                    said_conditions(&others)
                ));
            }
            if own.is_empty() {
                let reason = format!("no record is left for condition {wanted}; rename what belongs to it");
                return Err(Failure::Option { option: "--condition", reason });
            }
            return Ok(vec![(self.condition, own)]);
        }
        let mut groups: Vec<(ConditionId, Vec<LaidOutRecord>)> =
            self.dataset.conditions().iter().map(|condition| (condition.id(), Vec::new())).collect();
        for record in records {
            let id = record.guess.condition_of(&self.dataset);
            match groups.iter_mut().find(|(condition, _)| Some(*condition) == id) {
                Some((_, of_condition)) => of_condition.push(record),
                None => caution(&format!("{}: left out: its name says no condition of the dataset", record.table.name)),
            }
        }
        let without: Vec<ConditionId> =
            groups.iter().filter(|(_, records)| records.is_empty()).map(|(id, _)| *id).collect();
        if !without.is_empty() {
            let of = listed_conditions(&without);
            note(&format!("{of}: no records; the identified models there stay as they are"));
        }
        groups.retain(|(_, records)| !records.is_empty());
        if groups.is_empty() {
            let reason = format!("no name says a condition of the dataset ({}), as cond03 does", ids(&self.dataset));
            return Err(Failure::Option { option: "--every-condition", reason });
        }
        Ok(groups.into_iter().map(|(id, records)| (Some(id), records)).collect())
    }

    /// Puts models and records into a condition.
    pub(super) fn take(&mut self, condition: ConditionId, taken: &AdoptedModels) -> Result<(), Failure> {
        let refused =
            |reason: String| Failure::NoModels { reason: format!("the dataset does not take the models: {reason}") };
        let dataset = taken.put_into(&self.dataset, condition).map_err(|error| refused(error.to_string()))?;
        self.dataset = Arc::new(dataset);
        Ok(())
    }

    /// Adds the dataset to what is written.
    pub(super) fn add(&self, outputs: &mut OutputSet) -> Result<&Path, Failure> {
        add_dataset(&self.dataset, &self.path, outputs)?;
        Ok(&self.path)
    }
}

/// The conditions that names of records say, as "3, 7".
pub(super) fn said_conditions(records: &[LaidOutRecord]) -> String {
    let said: BTreeSet<i64> = records.iter().filter_map(|record| record.guess.condition).collect();
    said.iter().map(i64::to_string).collect::<Vec<_>>().join(", ")
}

/// The dataset as it is written elsewhere: its records are found by way of `folder` from there, and it is described as asked.
fn moved(dataset: &Dataset, folder: &str, description: Option<&str>) -> Result<Dataset, Failure> {
    let mut header = dataset.header();
    header.description = description.map_or(header.description, ToOwned::to_owned);
    let refused = |reason: String| Failure::Option { option: "--description", reason };
    let found = |record: &ConditionRecord| {
        let stays = folder.is_empty() || folder == "." || Path::new(&record.file).is_absolute();
        let file = if stays { record.file.clone() } else { format!("{folder}/{}", record.file) };
        ConditionRecord { file, ..record.clone() }
    };
    let conditions = dataset
        .conditions()
        .iter()
        .map(|condition| condition.as_ref().clone().with_records(condition.records().iter().map(found).collect()));
    let conditions = conditions.collect::<Result<_, _>>().map_err(|error| refused(error.to_string()))?;
    Dataset::new(header, conditions).map_err(|error| refused(error.to_string()))
}
