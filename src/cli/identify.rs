//! `gdcm identify`: models from flight records, optionally added to a dataset.

use std::path::PathBuf;

use gdcm_io::output_set::OutputSet;
use gdcm_model::dataset::Band;
use gdcm_sysid::identification::{Hold, Preparation};
use gdcm_sysid::records::sample_step::median_step;
use gdcm_sysid::records::stamped_channel::is_held;
use gdcm_sysid::records::{LaidOutRecord, RecordChannels};

use super::existing;
use super::failure::Failure;
use super::flight_records::{Duplicate, ReadRecords, laid_out_records};
use super::held_out_records::hold_out;
use super::identification_task::{IDENTIFIED_FILE, IdentificationTask};
use super::identifications::{IdentificationBasis, Identifications};
use super::identify_arguments::{IdentifyArguments, RecordArguments};
use super::printed_lines::listed_paths;
use super::receiving_dataset::{ReceivingDataset, RecordGroup, named_conditions};
use super::record_remedies::apply_record_remedies;
use super::requested_channels::{requested_band, requested_channels, requested_preparation};
use super::terminal::caution;

/// Identifies models from flight records and writes them; with `--into`, also a copy of the dataset
/// that contains them.
///
/// 1. Open the dataset, if any; check the output files whose names are known; determine band and
///    channels.
/// 2. Read the records as tasks: one for all, or one for each condition ([`identification_tasks`]).
/// 3. Identify ([`Identifications::run`]), then write and print the results
///    ([`Identifications::finish`]).
///
/// # Errors
/// An option or a file is wrong; no task has a result; the work was stopped. Also returned, after
/// all files are written, if the records identify no input, or if some records were not read.
pub(super) fn identify(arguments: &IdentifyArguments) -> Result<(), Failure> {
    let source = &arguments.source;
    // Step 1.
    let read = source.records.iter().chain(&source.into);
    let outputs = OutputSet::new(existing(arguments.force), read.cloned().collect());
    let destination =
        ReceivingDataset::open(source, &arguments.out, arguments.description.as_deref())?;
    check_known_outputs(arguments, destination.as_ref(), &outputs)?;
    let dataset = destination.as_ref().map(|place| place.dataset.as_ref());
    let band = requested_band(source, dataset)?;
    let mut channels = requested_channels(source, dataset, band)?;
    // Step 2.
    let tasks = identification_tasks(source, destination.as_ref(), &mut channels, band)?;
    let basis = IdentificationBasis {
        arguments,
        channels: &channels,
        reading: &tasks.reading,
        duplicates: &tasks.duplicates,
    };
    // Step 3.
    let mut identifications = Identifications::new(basis, destination, outputs);
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
    destination: Option<&ReceivingDataset>,
    outputs: &OutputSet,
) -> Result<(), Failure> {
    let mut places: Vec<PathBuf> = Vec::new();
    if !arguments.source.every_condition {
        places.push(arguments.out.join(IDENTIFIED_FILE));
    }
    places.extend(destination.map(|place| place.path.clone()));
    Ok(outputs.check(&places)?)
}

/// The identifications to be run, and what was reported while reading.
pub(super) struct IdentificationTasks {
    pub(super) tasks: Vec<IdentificationTask>,
    /// Requested files that could not be read completely.
    pub(super) unread: Vec<PathBuf>,
    /// Notes about assumptions made while the records were read.
    pub(super) reading: Vec<String>,
    pub(super) duplicates: Vec<Duplicate>,
}

/// Creates the identification tasks: one for all records, or with a dataset one for each condition
/// with records.
///
/// 1. The records, with their columns assigned to channels.
/// 2. Held-out records; delays and factors of single records.
/// 3. The preparation of the channels, common to all records: delays, and how held inputs act.
/// 4. Groups by condition, each a task.
pub(super) fn identification_tasks(
    arguments: &RecordArguments,
    destination: Option<&ReceivingDataset>,
    channels: &mut RecordChannels,
    band: Band,
) -> Result<IdentificationTasks, Failure> {
    let dataset = destination.map(|place| place.dataset.as_ref());
    // Step 1.
    let ReadRecords {
        mut records,
        unread,
        reading,
        duplicates,
        wholes,
    } = laid_out_records(arguments, channels, dataset)?;
    // Step 2.
    hold_out(&arguments.hold_out, &mut records, &wholes)?;
    apply_record_remedies(arguments, &mut records, channels)?;
    // Step 3.
    let mut preparation = requested_preparation(arguments, channels)?;
    set_holds(&mut preparation, &records, channels);
    // Step 4.
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
        let text = format!(
            "the records belong to conditions {conditions} by their names, but are fitted together; \
            to fit each condition separately, use --into DATASET --every-condition"
        );
        caution("records-of-several-conditions", &text);
    }
    RecordGroup {
        condition: None,
        records,
    }
}

/// Sets how each input given by `--held` acts between its samples, judged from the first record
/// that was not resampled, because resampling already shifts the time stamps.
///
/// First, if most samples repeat their predecessor (a staircase), the input acts as logged; else
/// each sample is a command that is held for one sample step. Without a record that was not
/// resampled, nothing is set.
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
