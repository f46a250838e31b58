//! Runs the identifications for `gdcm identify` and writes their results: a file for each, and the
//! dataset that receives the models.
//!
//! 1. [`Identifications::run`] identifies the models of each task; `add_result` puts them into the
//!    output files and the receiving dataset, with a description ([`Identifications::describe`]).
//! 2. [`Identifications::finish`] writes the files and prints the results.
//!
//! The library call, which writes nothing, uses only [`Identifications::describe`].

use std::mem::take;
use std::path::{Path, PathBuf};

use gdcm_io::files::dataset_file::add_dataset;
use gdcm_io::files::identified_models::{IdentifiedModels, add_identified};
use gdcm_io::import::record_files::relative_entry;
use gdcm_io::output_set::{OutputSet, make_directory};
use gdcm_model::dataset::condition::ConditionRecord;
use gdcm_model::message_text::sanitized_path;
use gdcm_model::number_format::counted;
use gdcm_study::decisions::adopted_models::AdoptedModels;
use gdcm_sysid::identification::{CautionNote, Identification};
use gdcm_sysid::records::RecordChannels;
use gdcm_words::input_limit_text::input_limit_texts;

use super::condition_messages::{ConditionMessage, shared_messages};
use super::failure::Failure;
use super::flight_records::Duplicate;
use super::identification_task::IdentificationTask;
use super::identify_arguments::IdentifyArguments;
use super::progress::ProgressReceiver;
use super::receiving_dataset::ReceivingDataset;
use super::terminal::{caution_for, note, print};
use crate::message::Message;

/// Command line, channels and record messages on which all identifications are based.
#[derive(Clone, Copy)]
pub(super) struct IdentificationBasis<'a> {
    pub(super) arguments: &'a IdentifyArguments,
    pub(super) channels: &'a RecordChannels,
    /// Notes about assumptions made while the records were read.
    pub(super) reading: &'a [String],
    pub(super) duplicates: &'a [Duplicate],
}

/// Results from the identifications so far, and the output files.
pub(super) struct Identifications<'a> {
    basis: IdentificationBasis<'a>,
    /// Dataset that receives the models.
    destination: Option<ReceivingDataset>,
    outputs: OutputSet,
    /// Lines to be printed about the results.
    lines: String,
    /// Number of successful identifications.
    count: usize,
    /// Whether any task's records identify at least one input.
    identifies_input: bool,
    cautions: Vec<ConditionMessage>,
}

impl<'a> Identifications<'a> {
    /// Begins without results; `destination` is the dataset that receives the models.
    pub(super) fn new(
        basis: IdentificationBasis<'a>,
        destination: Option<ReceivingDataset>,
        outputs: OutputSet,
    ) -> Self {
        Self {
            basis,
            destination,
            outputs,
            lines: String::new(),
            count: 0,
            identifies_input: false,
            cautions: Vec::new(),
        }
    }

    /// Checks the output files, prints the records, and runs all tasks. Cancellation, or a failed
    /// identification if there is a single task, ends the command; other failed identifications
    /// become cautions about their conditions.
    pub(super) fn run(&mut self, tasks: &[IdentificationTask]) -> Result<(), Failure> {
        let files: Vec<PathBuf> = tasks
            .iter()
            .map(|task| task.output_path(self.basis.arguments))
            .collect();
        let mut paths: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
        paths.extend(
            self.destination
                .iter()
                .map(|dataset| dataset.path.as_path()),
        );
        self.outputs.check(&paths)?;
        let tables: String = tasks.iter().map(IdentificationTask::table).collect();
        print(&tables)?;
        for (task, file) in tasks.iter().zip(&files) {
            match task.run(ProgressReceiver::Terminal) {
                Ok(found) => self.add_result(task, file, &found)?,
                Err(failure @ Failure::NoModels { .. }) if tasks.len() > 1 => {
                    self.cautions.push(ConditionMessage::new(
                        task.condition,
                        failure.code(),
                        failure.to_string(),
                    ));
                }
                Err(failure) => return Err(failure),
            }
        }
        Ok(())
    }

    /// Adds a task's result to the output files and to the receiving dataset, if there is one;
    /// prints its notes, and keeps its cautions and its line for the end.
    fn add_result(
        &mut self,
        task: &IdentificationTask,
        file: &Path,
        found: &Identification,
    ) -> Result<(), Failure> {
        let described = self.describe(task, found);
        make_directory(&self.basis.arguments.out)?;
        add_identified(&described.models(found), file, &mut self.outputs)?;
        if let (Some(destination), Some(condition)) = (&mut self.destination, task.condition) {
            let entries = described.records.into_iter().map(|entry| {
                relative_entry(
                    entry,
                    &self.basis.arguments.source.records,
                    &destination.path,
                )
            });
            let offered = self.basis.arguments.take.offered();
            let models = AdoptedModels::from_identification(found, offered, entries.collect());
            destination.adopt(condition, &models)?;
        }
        self.lines += &task.outcome(file, found);
        self.count += 1;
        Ok(())
    }

    /// Returns the description written beside a task's models; prints its notes, keeps its
    /// cautions, and records whether an input is identified.
    pub(super) fn describe(
        &mut self,
        task: &IdentificationTask,
        found: &Identification,
    ) -> DescribedIdentification {
        let mut records: Vec<ConditionRecord> = Vec::new();
        for (record, used) in task.records.iter().zip(&found.record_uses) {
            records.push(record.entry(used, self.basis.channels));
        }
        let facts: Vec<String> = found
            .record_uses
            .iter()
            .flat_map(input_limit_texts)
            .collect();
        for fact in &facts {
            note("record-preparation", fact);
        }
        let channels = self.model_channels();
        self.identifies_input |= identifies_any_input(found, &channels);
        DescribedIdentification {
            records,
            cautions: self.cautions_of(task, found),
            reading: [self.basis.reading, &facts].concat(),
            channels,
        }
    }

    /// Returns the failure for records that identify no input; `None` if they identify one.
    pub(super) fn without_input(&self) -> Option<Failure> {
        if self.identifies_input {
            return None;
        }
        let inputs = &self.basis.channels.inputs;
        let inputs: Vec<&str> = inputs.iter().map(|rule| rule.name.as_str()).collect();
        Some(Failure::NotIdentified {
            inputs: inputs.join(", "),
        })
    }

    /// Returns a task's cautions, and keeps them to be printed at the end. Those about duplicates
    /// are not kept: they have already been printed.
    fn cautions_of(
        &mut self,
        task: &IdentificationTask,
        found: &Identification,
    ) -> Vec<CautionNote> {
        let dataset = self
            .destination
            .as_ref()
            .map(|receiving| &*receiving.dataset);
        let mut cautions = task.cautions(found, self.basis.channels, dataset);
        for caution in &cautions {
            let message = ConditionMessage::new(task.condition, caution.code, caution.text.clone());
            self.cautions.push(message);
        }
        for duplicate in self.basis.duplicates {
            if task.has_record(&duplicate.original) {
                cautions.push(duplicate.caution.clone());
            }
        }
        cautions
    }

    /// Returns the model's channels, that is, without the reference channels that follow the
    /// inputs.
    fn model_channels(&self) -> RecordChannels {
        let mut channels = self.basis.channels.clone();
        let references = self.basis.arguments.source.references().len();
        channels.inputs.truncate(channels.inputs.len() - references);
        channels
    }

    /// Writes the output files and prints the cautions and the lines about the results.
    ///
    /// # Errors
    /// No task has a result; a file cannot be written. Also returned, after all files are written,
    /// if the records identify no input.
    pub(super) fn finish(mut self, task_count: usize) -> Result<(), Failure> {
        for shared in shared_messages(take(&mut self.cautions)) {
            let Message { code, text } = &shared.message;
            caution_for(code, &shared.conditions, text);
        }
        if self.count == 0 {
            return Err(Failure::NoModels {
                reason: format!("no model was identified: all {task_count} conditions failed"),
            });
        }
        if let Some(destination) = &self.destination {
            add_dataset(&destination.dataset, &destination.path, &mut self.outputs)?;
            self.lines += &format!(
                "{}: identified models of {}\n",
                sanitized_path(&destination.path),
                counted(self.count, "condition")
            );
        }
        let failure = self.without_input();
        self.outputs.persist()?;
        print(&self.lines)?;
        match failure {
            None => Ok(()),
            Some(failure) => Err(failure),
        }
    }
}

/// Description written beside the models from an identification.
pub(super) struct DescribedIdentification {
    /// The models' channels, without references.
    pub(super) channels: RecordChannels,
    pub(super) records: Vec<ConditionRecord>,
    pub(super) cautions: Vec<CautionNote>,
    /// Notes about assumptions made while the records were read and prepared.
    pub(super) reading: Vec<String>,
}

impl DescribedIdentification {
    /// Returns the models with their description, as written to a file.
    pub(super) fn models<'d>(&'d self, found: &'d Identification) -> IdentifiedModels<'d> {
        IdentifiedModels {
            identification: found,
            channels: &self.channels,
            records: &self.records,
            cautions: &self.cautions,
            reading: &self.reading,
        }
    }
}

/// Returns whether the records identify at least one input.
fn identifies_any_input(found: &Identification, channels: &RecordChannels) -> bool {
    let outputs = channels.outputs.len();
    (0..channels.inputs.len()).any(|input| is_identified(found, input, outputs))
}

/// Returns whether the records identify an input: the other inputs do not explain it, and at least
/// one response to it is identified (M14).
fn is_identified(found: &Identification, input: usize, outputs: usize) -> bool {
    let excitation = found.measured.excitation();
    if excitation.not_identified().any(|other| other == input) {
        return false;
    }
    (0..outputs).any(|output| !found.not_identified.contains(&(output, input)))
}
