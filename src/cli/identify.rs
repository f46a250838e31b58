//! `gdcm identify`: models from flight records, optionally added to a dataset.

use std::path::{Path, PathBuf};

use gdcm_io::files::dataset_file::add_dataset;
use gdcm_io::files::identified_models::{IdentifiedModels, add_identified};
use gdcm_io::import::record_files::relative_entry;
use gdcm_io::output_set::{OutputSet, make_directory};
use gdcm_model::dataset::Band;
use gdcm_model::dataset::condition::ConditionRecord;
use gdcm_model::message_text::sanitized_path;
use gdcm_model::number_format::counted;
use gdcm_study::decisions::adopted_models::AdoptedModels;
use gdcm_sysid::identification::{
    CautionNote, Hold, Identification, IdentificationError, Preparation,
};
use gdcm_sysid::records::sample_step::median_step;
use gdcm_sysid::records::stamped_channel::is_held;
use gdcm_sysid::records::{LaidOutRecord, RecordChannels};
use gdcm_sysid::spectra::record_use::RecordUse;

use super::condition_messages::{ConditionMessage, shared_messages};
use super::destination::{Destination, RecordGroup, named_conditions};
use super::existing;
use super::failure::Failure;
use super::flight_records::{Duplicate, ReadRecords, laid_out_records};
use super::held_out_records::hold_out;
use super::identification_task::{IDENTIFIED_FILE, IdentificationTask};
use super::identify_arguments::IdentifyArguments;
use super::record_remedies::apply_record_remedies;
use super::requested_channels::{requested_band, requested_channels, requested_preparation};
use super::terminal::{caution, caution_for, note, print};
use super::text::listed_paths;

/// Identifies models from flight records and writes them; with `--into`, also a copy of the dataset
/// that contains them.
pub(super) fn identify(arguments: &IdentifyArguments) -> Result<(), Failure> {
    let read = arguments.records.iter().chain(&arguments.into);
    let outputs = OutputSet::new(existing(arguments.force), read.cloned().collect());
    let destination = Destination::open(arguments)?;
    check_known_outputs(arguments, destination.as_ref(), &outputs)?;
    let dataset = destination.as_ref().map(|place| place.dataset.as_ref());
    let band = requested_band(arguments, dataset)?;
    let mut channels = requested_channels(arguments, dataset, band)?;
    let tasks = identification_tasks(arguments, destination.as_ref(), &mut channels, band)?;
    let mut identifications = Identifications {
        arguments,
        channels: &channels,
        reading: &tasks.reading,
        duplicates: &tasks.duplicates,
        destination,
        outputs,
        lines: String::new(),
        count: 0,
        identifies_input: false,
        cautions: Vec::new(),
    };
    identifications.run(&tasks.tasks)?;
    identifications.finish(tasks.tasks.len())?;
    if tasks.unread.is_empty() {
        Ok(())
    } else {
        Err(Failure::Unread {
            paths: listed_paths(&tasks.unread),
        })
    }
}

/// Checks the output paths that are known before the records are read.
fn check_known_outputs(
    arguments: &IdentifyArguments,
    destination: Option<&Destination>,
    outputs: &OutputSet,
) -> Result<(), Failure> {
    let mut places: Vec<PathBuf> = Vec::new();
    if !arguments.every_condition {
        places.push(arguments.out.join(IDENTIFIED_FILE));
    }
    places.extend(destination.map(|place| place.path.clone()));
    Ok(outputs.check(&places)?)
}

/// The identifications to be run, and what was reported while reading.
struct IdentificationTasks {
    tasks: Vec<IdentificationTask>,
    /// Requested files that could not be read completely.
    unread: Vec<PathBuf>,
    /// Notes about assumptions made while the records were read.
    reading: Vec<String>,
    duplicates: Vec<Duplicate>,
}

/// Creates the identification tasks: one for all records, or one per condition.
fn identification_tasks(
    arguments: &IdentifyArguments,
    destination: Option<&Destination>,
    channels: &mut RecordChannels,
    band: Band,
) -> Result<IdentificationTasks, Failure> {
    let dataset = destination.map(|place| place.dataset.as_ref());
    let ReadRecords {
        mut records,
        unread,
        reading,
        duplicates,
        wholes,
    } = laid_out_records(arguments, channels, dataset)?;
    hold_out(&arguments.hold_out, &mut records, &wholes)?;
    apply_record_remedies(arguments, &mut records, channels)?;
    let mut preparation = requested_preparation(arguments, channels)?;
    set_holds(&mut preparation, &records, channels);
    let groups = match destination {
        Some(destination) => destination.groups(records)?,
        None => vec![single_group(records)],
    };
    let mut tasks = Vec::new();
    for group in groups {
        let task = IdentificationTask::new(group, &preparation, band, arguments)?;
        tasks.push(task);
    }
    Ok(IdentificationTasks {
        tasks,
        unread,
        reading,
        duplicates,
    })
}

/// Puts all records into one group; prints a caution if their names give different conditions.
fn single_group(records: Vec<LaidOutRecord>) -> RecordGroup {
    let conditions = named_conditions(&records);
    if conditions.contains(',') {
        caution(&format!(
            "the names of the records give conditions {conditions}: all are fitted together"
        ));
    }
    RecordGroup {
        condition: None,
        records,
    }
}

/// Sets the hold of each input, judged from a record that was not resampled, because resampling
/// already shifts the time stamps.
fn set_holds(preparation: &mut Preparation, records: &[LaidOutRecord], channels: &RecordChannels) {
    let as_logged = records
        .iter()
        .find(|record| !record.layout.is_resampled(&record.table, channels));
    let Some(flight) = as_logged.and_then(|record| record.flight.as_ref()) else {
        return;
    };
    for (index, input) in preparation.inputs.iter_mut().enumerate() {
        if !channels.resampling.held.contains(&input.name) {
            continue;
        }
        // A signal logged as a staircase is used as logged; a command logged once per hold acts
        // half a hold later on average (M14.1).
        let values: Vec<f64> = flight.inputs.column(index).iter().copied().collect();
        input.hold = match median_step(&flight.time_s) {
            Some(hold_s) if !is_held(&values) => Hold::Command { hold_s },
            _ => Hold::Acts,
        };
    }
}

/// Results of the identifications so far, and the output files.
struct Identifications<'a> {
    arguments: &'a IdentifyArguments,
    channels: &'a RecordChannels,
    reading: &'a [String],
    duplicates: &'a [Duplicate],
    destination: Option<Destination>,
    outputs: OutputSet,
    /// Lines to be printed about the results.
    lines: String,
    /// Number of successful identifications.
    count: usize,
    /// Whether any records identify at least one input.
    identifies_input: bool,
    cautions: Vec<ConditionMessage>,
}

impl Identifications<'_> {
    /// Runs all tasks. A failure ends the command if there is a single task; otherwise it becomes a
    /// caution about the condition.
    fn run(&mut self, tasks: &[IdentificationTask]) -> Result<(), Failure> {
        let files: Vec<PathBuf> = tasks
            .iter()
            .map(|task| task.output_path(self.arguments))
            .collect();
        let mut places: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
        places.extend(self.destination.iter().map(|place| place.path.as_path()));
        self.outputs.check(&places)?;
        let tables: String = tasks.iter().map(IdentificationTask::table).collect();
        print(&tables)?;
        for (task, file) in tasks.iter().zip(&files) {
            match task.run() {
                Ok(found) => self.take(task, file, &found)?,
                Err(IdentificationError::Stopped(stopped)) => return Err(stopped.into()),
                Err(why) if tasks.len() == 1 => {
                    return Err(Failure::NoModels {
                        reason: why.to_string(),
                    });
                }
                Err(why) => self.cautions.push(ConditionMessage::new(
                    task.condition,
                    format!("no model was identified: {why}"),
                )),
            }
        }
        Ok(())
    }

    /// Adds the result of a task to the output files, and prints its notes and cautions.
    fn take(
        &mut self,
        task: &IdentificationTask,
        file: &Path,
        found: &Identification,
    ) -> Result<(), Failure> {
        let records: Vec<ConditionRecord> = task
            .records
            .iter()
            .zip(&found.record_uses)
            .map(|(record, used)| record.entry(used, self.channels))
            .collect();
        let facts: Vec<String> = found
            .record_uses
            .iter()
            .flat_map(RecordUse::facts)
            .collect();
        for fact in &facts {
            note(fact);
        }
        let reading = [self.reading, &facts].concat();
        let cautions = self.cautions_of(task, found);
        let channels = self.model_channels();
        self.identifies_input |= identifies_any_input(found, &channels);
        make_directory(&self.arguments.out)?;
        let models = IdentifiedModels {
            found,
            channels: &channels,
            records: &records,
            cautions: &cautions,
            reading: &reading,
        };
        add_identified(&models, file, &mut self.outputs)?;
        if let (Some(destination), Some(condition)) = (&mut self.destination, task.condition) {
            let entries = records
                .into_iter()
                .map(|entry| relative_entry(entry, &self.arguments.records, &destination.path));
            let offered = self.arguments.take.offered();
            let models = AdoptedModels::from_identification(found, offered, entries.collect());
            destination.adopt(condition, &models)?;
        }
        self.lines += &task.outcome(file, found);
        self.count += 1;
        Ok(())
    }

    /// Returns the cautions of a task, and stores them to be printed at the end. Those about
    /// duplicates are not stored: they have already been printed.
    fn cautions_of(
        &mut self,
        task: &IdentificationTask,
        found: &Identification,
    ) -> Vec<CautionNote> {
        let dataset = self.destination.as_ref().map(|place| &*place.dataset);
        let mut cautions = task.cautions(found, dataset);
        for caution in &cautions {
            let message = ConditionMessage::new(task.condition, caution.text.clone());
            self.cautions.push(message);
        }
        for duplicate in self.duplicates {
            if task.has_record(&duplicate.original) {
                cautions.push(duplicate.caution.clone());
            }
        }
        cautions
    }

    /// Returns the channels of the model, that is, without the reference channels that follow the
    /// inputs.
    fn model_channels(&self) -> RecordChannels {
        let mut channels = self.channels.clone();
        let references = self.arguments.references().len();
        channels.inputs.truncate(channels.inputs.len() - references);
        channels
    }

    /// Writes the output files and prints the cautions and the lines about the results.
    ///
    /// # Errors
    /// No task has a result, or the records identify no input.
    fn finish(mut self, task_count: usize) -> Result<(), Failure> {
        for message in shared_messages(self.cautions) {
            caution_for(&message.conditions, &message.text);
        }
        if self.count == 0 {
            return Err(Failure::NoModels {
                reason: format!("all {task_count} conditions failed"),
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
        self.outputs.persist()?;
        print(&self.lines)?;
        if self.identifies_input {
            return Ok(());
        }
        let inputs = self.channels.inputs.iter().map(|rule| rule.name.as_str());
        let inputs: Vec<&str> = inputs.collect();
        Err(Failure::NotIdentified {
            inputs: inputs.join(", "),
        })
    }
}

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
