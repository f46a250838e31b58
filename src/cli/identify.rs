//! `gdcm identify`: models from flight records, optionally put into a dataset.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_io::files::dataset_file::add_dataset;
use gdcm_io::files::identified_models::{IdentifiedModels, add_identified};
use gdcm_io::files::study_file::relative_folder;
use gdcm_io::import::record_files::relative_entry;
use gdcm_io::output_set::{OutputSet, make_directory};
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::{Opened, load_any};
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::{ChannelRemedy, ConditionRecord};
use gdcm_model::dataset::{Band, BundleKind, ConditionId, Dataset};
use gdcm_model::message_text::sanitized_path;
use gdcm_model::simulation::Signal;
use gdcm_study::decisions::changed_models::AdoptedModels;
use gdcm_study::jobs::job::IdentificationRequest;
use gdcm_study::results::channel_time_skew::ChannelTimeSkew;
use gdcm_sysid::identification::preparation::RecordUse;
use gdcm_sysid::identification::topics::is_held;
use gdcm_sysid::identification::{
    CautionNote, ChannelPreparation, Hold, Identification, IdentificationCaution,
    IdentificationError, Preparation,
};
use gdcm_sysid::records::record_table::median_step;
use gdcm_sysid::records::{LaidOutRecord, RecordChannels};

use super::existing;
use super::flight_records::{ReadRecords, hold_out, is_called, laid_out, record_table};
use super::identify_arguments::{IdentifyArguments, has_channel, of_one_record, unknown};
use super::models::counted;
use super::study_options::{condition_of, ids};
use super::terminal::{
    Failure, TerminalProgress, by_words, caution, caution_of, listed_conditions, listed_paths,
    note, say,
};
use crate::executor::Pool;

/// File of the identified models.
const IDENTIFIED: &str = "identified.json";

/// Identifies models from flight records and writes them, with a copy of a dataset that contains
/// them if one is given.
pub(super) fn identify(arguments: &IdentifyArguments) -> Result<(), Failure> {
    let inputs = arguments
        .records
        .iter()
        .chain(&arguments.into)
        .cloned()
        .collect();
    let mut outputs = OutputSet::new(existing(arguments.force), inputs);
    let mut destination = Destination::asked(arguments)?;
    // Checked before the records are read, as far as the file names are known.
    let known = (!arguments.every_condition).then(|| arguments.out.join(IDENTIFIED));
    let known = known.iter().chain(destination.iter().map(|of| &of.path));
    outputs.check(&known.collect::<Vec<_>>())?;
    let dataset = destination.as_ref().map(|of| of.dataset.as_ref());
    let band = arguments.band(dataset)?;
    let mut channels = arguments.channels(dataset, band)?;
    let Tasks {
        tasks,
        unread,
        reading,
        copies,
    } = tasks(arguments, destination.as_ref(), &mut channels, band)?;
    let files: Vec<PathBuf> = tasks
        .iter()
        .map(|task| identified_path(arguments, task))
        .collect();
    let places = files.iter().chain(destination.iter().map(|of| &of.path));
    outputs.check(&places.map(PathBuf::as_path).collect::<Vec<&Path>>())?;
    say(&tasks
        .iter()
        .map(IdentificationTask::table)
        .collect::<String>())?;
    let mut lines = String::new();
    let mut taken = 0;
    let mut of_use = false;
    let mut cautions = Vec::new();
    for (task, file) in tasks.iter().zip(&files) {
        let found = match task.run() {
            Ok(found) => found,
            Err(IdentificationError::Stopped(stopped)) => return Err(stopped.into()),
            Err(why) if tasks.len() == 1 => {
                return Err(Failure::NoModels {
                    reason: why.to_string(),
                });
            }
            Err(why) => {
                cautions.push((task.condition, format!("no model was identified: {why}")));
                continue;
            }
        };
        let records: Vec<ConditionRecord> = task
            .records
            .iter()
            .zip(&found.record_uses)
            .map(|(record, used)| record.entry(used, &channels))
            .collect();
        let late = destination
            .as_ref()
            .and_then(|of| task.late_channel(&found, &of.dataset));
        let facts: Vec<String> = found
            .record_uses
            .iter()
            .flat_map(RecordUse::facts)
            .collect();
        facts.iter().for_each(|fact| note(fact));
        let reading: Vec<String> = reading.iter().cloned().chain(facts).collect();
        let of_task: Vec<CautionNote> = found
            .cautions
            .iter()
            .map(|of| task.note(of))
            .chain(late)
            .collect();
        cautions.extend(of_task.iter().map(|of| (task.condition, of.text.clone())));
        let is_here = |name: &str| task.records.iter().any(|record| record.table.name == name);
        let copies = copies
            .iter()
            .filter(|(first, _)| is_here(first))
            .map(|(_, note)| note.clone());
        let of_task: Vec<CautionNote> = of_task.into_iter().chain(copies).collect();
        let of_model = without_references(&channels, arguments);
        of_use |= (0..of_model.inputs.len())
            .any(|input| is_identified(&found, input, of_model.outputs.len()));
        make_directory(&arguments.out)?;
        let models = IdentifiedModels {
            found: &found,
            channels: &of_model,
            records: &records,
            cautions: &of_task,
            reading: &reading,
        };
        add_identified(&models, file, &mut outputs)?;
        if let (Some(destination), Some(condition)) = (&mut destination, task.condition) {
            let entries = records
                .into_iter()
                .map(|of| relative_entry(of, &arguments.records, &destination.path));
            destination.take(
                condition,
                &AdoptedModels::of(&found, arguments.take.offered(), entries.collect()),
            )?;
        }
        lines += &outcome(task, file, &found);
        taken += 1;
    }
    by_words(cautions)
        .iter()
        .for_each(|(conditions, words)| caution_of(conditions, words));
    if taken == 0 {
        return Err(Failure::NoModels {
            reason: format!("in none of {} conditions", tasks.len()),
        });
    }
    if let Some(destination) = &destination {
        add_dataset(&destination.dataset, &destination.path, &mut outputs)?;
        let path = sanitized_path(&destination.path);
        lines += &format!(
            "{path}: identified models of {}\n",
            counted(taken, "condition")
        );
    }
    outputs.persist()?;
    say(&lines)?;
    if !of_use {
        let names: Vec<&str> = channels
            .inputs
            .iter()
            .map(|rule| rule.name.as_str())
            .collect();
        return Err(Failure::NotIdentified {
            inputs: names.join(", "),
        });
    }
    if unread.is_empty() {
        Ok(())
    } else {
        Err(Failure::Unread {
            paths: listed_paths(&unread),
        })
    }
}

/// Returns the channels of the models, without the references.
fn without_references(channels: &RecordChannels, arguments: &IdentifyArguments) -> RecordChannels {
    let mut of_model = channels.clone();
    of_model
        .inputs
        .truncate(channels.inputs.len() - arguments.references().len());
    of_model
}

/// Returns whether the records identify an input: the other inputs do not explain it, and a
/// response to it is known (M14).
fn is_identified(found: &Identification, input: usize, outputs: usize) -> bool {
    let is_swept = found
        .measured
        .excitation()
        .not_identified()
        .all(|of| of != input);
    is_swept && (0..outputs).any(|output| !found.not_identified.contains(&(output, input)))
}

/// An identification of models from the records of a condition.
struct IdentificationTask {
    /// The condition in the dataset; `None` without a dataset.
    condition: Option<ConditionId>,
    records: Vec<LaidOutRecord>,
    request: IdentificationRequest,
}

impl IdentificationTask {
    /// Creates the task for a group of records.
    fn new(
        (condition, records): Group,
        preparation: &Preparation,
        band: Band,
        arguments: &IdentifyArguments,
    ) -> Result<Self, Failure> {
        let request = IdentificationRequest::of(
            records.iter(),
            preparation.clone(),
            [band.min(), band.max()],
        );
        let mut request = request
            .map_err(|why| Failure::option("--hold-out", format!("{}{why}", label(condition))))?;
        arguments.search().set(&mut request.options);
        request.options.references = arguments.references().len();
        Ok(Self {
            request,
            condition,
            records,
        })
    }

    /// Runs the identification, with progress on a terminal.
    fn run(&self) -> Result<Identification, IdentificationError> {
        let doing = self.condition.map_or_else(
            || "identifying".to_owned(),
            |id| format!("identifying condition {id}"),
        );
        self.request.identify(&Pool, &TerminalProgress::new(&doing))
    }

    /// Returns a caution for a channel that lags in all records compared with the nominal physics
    /// model of the condition, with the option that removes its delay.
    fn late_channel(&self, found: &Identification, dataset: &Dataset) -> Option<CautionNote> {
        let condition = dataset.condition(self.condition?)?;
        let options = &self.request.options;
        let late = ChannelTimeSkew::of_condition(&found.measured, options.band, condition)?;
        let signal = late.signal(dataset)?;
        let known = options.preparation.channel(&signal)?.delay_s;
        let words = late.words(
            &signal.name,
            &condition
                .bundle(BundleKind::Physics)
                .get(condition.nominal())?
                .name,
        );
        let text = format!(
            "{words} (--delay {}={:.3})",
            signal.name,
            known + late.delay_s
        );
        Some(CautionNote {
            code: "time-skew",
            channel: Some(signal.name),
            text,
            ..CautionNote::default()
        })
    }

    /// Returns a caution with the options that remedy it.
    fn note(&self, caution: &IdentificationCaution) -> CautionNote {
        let mut note = caution.note();
        let IdentificationCaution::Contradiction { records, .. } = caution else {
            return note;
        };
        let channels = self.request.options.preparation.outputs.iter().enumerate();
        let signal = |(index, channel): (usize, &ChannelPreparation)| {
            let role = ChannelSide::Output;
            let name = channel.name.clone();
            Signal { role, index, name }
        };
        let outputs: Vec<Signal> = channels.map(signal).collect();
        let options = records.iter().filter_map(|of| {
            let record = &of.name;
            let fault = of.fault.as_ref()?;
            let options = fault
                .remedies(&outputs)
                .into_iter()
                .map(|(signal, remedy)| match remedy.factor {
                    1.0 => format!("--delay {record}:{signal}={:.3}", remedy.delay_s),
                    factor => format!("--factor {record}:{signal}={factor:.2}"),
                });
            Some(options.collect::<Vec<_>>().join(" "))
        });
        let options = options.collect::<Vec<_>>().join(" or ");
        note.text += &if options.is_empty() {
            options
        } else {
            format!(" ({options})")
        };
        note
    }

    /// Returns a table with one line for each record, below the condition if there is one.
    fn table(&self) -> String {
        match self.condition {
            Some(id) => format!("condition {id}\n{}", record_table(&self.records, 2)),
            None => record_table(&self.records, 0),
        }
    }
}

/// Returns the prefix of messages about a condition.
fn label(condition: Option<ConditionId>) -> String {
    condition.map_or_else(String::new, |id| format!("condition {id}: "))
}

/// The identifications to run.
struct Tasks {
    tasks: Vec<IdentificationTask>,
    /// Files without records.
    unread: Vec<PathBuf>,
    /// Notes about choices made while the records were read.
    reading: Vec<String>,
    /// Duplicates of records: the name of the other record, and the caution.
    copies: Vec<(String, CautionNote)>,
}

/// Creates the identification tasks: one for all records, or one for each condition.
fn tasks(
    arguments: &IdentifyArguments,
    destination: Option<&Destination>,
    channels: &mut RecordChannels,
    band: Band,
) -> Result<Tasks, Failure> {
    let ReadRecords {
        mut records,
        unread,
        reading,
        copies,
        wholes,
    } = laid_out(
        arguments,
        channels,
        destination.map(|of| of.dataset.as_ref()),
    )?;
    hold_out(&arguments.hold_out, &mut records, &wholes)?;
    put_right(arguments, &mut records, channels)?;
    let mut preparation = arguments.preparation(channels)?;
    hold(&mut preparation, &records, channels);
    let groups = match destination {
        Some(destination) => destination.groups(records)?,
        None => {
            let conditions = said_conditions(&records);
            if conditions.contains(',') {
                caution(&format!(
                    "the names of the records say conditions {conditions}: all are fitted together"
                ));
            }
            vec![(None, records)]
        }
    };
    let tasks = groups
        .into_iter()
        .map(|group| IdentificationTask::new(group, &preparation, band, arguments));
    Ok(Tasks {
        tasks: tasks.collect::<Result<_, _>>()?,
        unread,
        reading,
        copies,
    })
}

/// Returns the path of the identified models: one file for each condition if there are several.
fn identified_path(arguments: &IdentifyArguments, task: &IdentificationTask) -> PathBuf {
    let of_many = task.condition.filter(|_| arguments.every_condition);
    arguments.out.join(of_many.map_or_else(
        || IDENTIFIED.to_owned(),
        |id| format!("identified-condition-{id}.json"),
    ))
}

/// Returns one line about the result and its file.
fn outcome(task: &IdentificationTask, file: &Path, found: &Identification) -> String {
    let held_out = found.held_out_cost.map_or_else(String::new, |cost| {
        format!(", of what is held out {cost:.2}")
    });
    format!(
        "{}{}: {}; order {}, J per degree of freedom {:.2}{held_out}\n",
        label(task.condition),
        sanitized_path(file),
        counted(2 + found.bundle.len(), "model"),
        found.refined.order().unwrap_or_default(),
        found.cost,
    )
}

/// Sets the preparation of the inputs with sample and hold, from a record that was not resampled:
/// resampling already shifts the time stamps.
fn hold(preparation: &mut Preparation, records: &[LaidOutRecord], channels: &RecordChannels) {
    let as_logged = |record: &&LaidOutRecord| !record.layout.is_resampled(&record.table, channels);
    let Some(flight) = records
        .iter()
        .find(as_logged)
        .and_then(|record| record.flight.as_ref())
    else {
        return;
    };
    for (index, input) in preparation.inputs.iter_mut().enumerate() {
        if !channels.resampling.held.contains(&input.name) {
            continue;
        }
        // A visible staircase acts as logged; a command logged once per hold acts half a hold later
        // (M14.1).
        let values: Vec<f64> = flight.inputs.column(index).iter().copied().collect();
        input.hold = match median_step(&flight.time_s) {
            Some(hold_s) if !is_held(&values) => Hold::Command { hold_s },
            _ => Hold::Acts,
        };
    }
}

/// Applies the requested delays and factors to channels of single records.
fn put_right(
    arguments: &IdentifyArguments,
    records: &mut [LaidOutRecord],
    channels: &RecordChannels,
) -> Result<(), Failure> {
    let delays = arguments.delay.iter().map(|of| {
        (
            "--delay",
            &of.channel,
            ChannelRemedy {
                delay_s: of.said,
                ..ChannelRemedy::NONE
            },
        )
    });
    let factors = arguments.factor.iter().map(|of| {
        (
            "--factor",
            &of.channel,
            ChannelRemedy {
                factor: of.said,
                ..ChannelRemedy::NONE
            },
        )
    });
    let mut done: Vec<(&str, String, &str)> = Vec::new();
    for (option, said, remedy) in delays.chain(factors) {
        let Some((record, channel)) = of_one_record(said) else {
            continue;
        };
        if !has_channel(channels, channel) {
            return Err(unknown(option, channel));
        }
        let mut of_it = records
            .iter_mut()
            .filter(|of| is_called(&of.table, record))
            .peekable();
        if of_it.peek().is_none() {
            return Err(Failure::option(
                option,
                format!("\"{record}\" is none of the records"),
            ));
        }
        for of in of_it {
            let of_channel = (option, of.table.name.clone(), channel);
            if done.contains(&of_channel) {
                return Err(Failure::option(
                    option,
                    format!("{channel} of {record} stands twice"),
                ));
            }
            done.push(of_channel);
            let mut layout = of.layout.clone();
            layout.put_right(&BTreeMap::from([(channel.to_owned(), remedy)]), channels);
            *of = of.laid_out(layout, channels);
            if let Some(problem) = of.problems.first() {
                return Err(Failure::option(option, format!("{record}: {problem}")));
            }
        }
    }
    Ok(())
}

/// Records for a joint identification, with their condition; `None` without a dataset.
type Group = (Option<ConditionId>, Vec<LaidOutRecord>);

/// A dataset that receives models.
struct Destination {
    dataset: Arc<Dataset>,
    /// Output path.
    path: PathBuf,
    /// The condition; `None` if each record goes to the condition in its name.
    condition: Option<ConditionId>,
}

impl Destination {
    /// Opens the dataset named on the command line, if any.
    fn asked(arguments: &IdentifyArguments) -> Result<Option<Self>, Failure> {
        let Some(path) = arguments.into.as_deref() else {
            return Ok(None);
        };
        let dataset = match load_any(path, &ReadingBudget::default())? {
            Opened::Dataset(loaded) => loaded.dataset,
            Opened::Study(_) => {
                return Err(Failure::option(
                    "--into",
                    "expected a dataset, found a study; give the study's dataset",
                ));
            }
        };
        let condition = arguments
            .condition
            .map(|id| condition_of(&dataset, id))
            .transpose()?;
        let written = arguments.out.join(path.file_name().unwrap_or_default());
        let folder = relative_folder(path.parent().unwrap_or(Path::new("")), &written);
        let dataset = Arc::new(moved(&dataset, &folder, arguments.description.as_deref())?);
        Ok(Some(Self {
            dataset,
            path: written,
            condition,
        }))
    }

    /// Groups the records by condition, in the order of the dataset; reports omitted records on
    /// standard error.
    fn groups(&self, records: Vec<LaidOutRecord>) -> Result<Vec<Group>, Failure> {
        if let Some(wanted) = self.condition {
            let is_of = |record: &LaidOutRecord| {
                record
                    .guess
                    .condition
                    .is_none_or(|said| ConditionId(said) == wanted)
            };
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
                let reason =
                    format!("no record is left for condition {wanted}; rename what belongs to it");
                return Err(Failure::option("--condition", reason));
            }
            return Ok(vec![(self.condition, own)]);
        }
        let mut groups: Vec<(ConditionId, Vec<LaidOutRecord>)> = self
            .dataset
            .conditions()
            .iter()
            .map(|condition| (condition.id(), Vec::new()))
            .collect();
        for record in records {
            let id = record.guess.condition_of(&self.dataset);
            match groups
                .iter_mut()
                .find(|(condition, _)| Some(*condition) == id)
            {
                Some((_, of_condition)) => of_condition.push(record),
                None => caution(&format!(
                    "{}: left out: its name says no condition of the dataset",
                    record.table.name
                )),
            }
        }
        let without: Vec<ConditionId> = groups
            .iter()
            .filter(|(_, records)| records.is_empty())
            .map(|(id, _)| *id)
            .collect();
        if !without.is_empty() {
            let of = listed_conditions(&without);
            note(&format!(
                "{of}: no records; the identified models there stay as they are"
            ));
        }
        groups.retain(|(_, records)| !records.is_empty());
        if groups.is_empty() {
            let reason = format!(
                "no name says a condition of the dataset ({}), as cond03 does",
                ids(&self.dataset)
            );
            return Err(Failure::option("--every-condition", reason));
        }
        Ok(groups
            .into_iter()
            .map(|(id, records)| (Some(id), records))
            .collect())
    }

    /// Puts models and records into a condition.
    fn take(&mut self, condition: ConditionId, taken: &AdoptedModels) -> Result<(), Failure> {
        let dataset =
            taken
                .put_into(&self.dataset, condition)
                .map_err(|error| Failure::NoModels {
                    reason: format!("the dataset does not take the models: {error}"),
                })?;
        self.dataset = Arc::new(dataset);
        Ok(())
    }
}

/// Returns the conditions in the names of records, as "3, 7".
fn said_conditions(records: &[LaidOutRecord]) -> String {
    let said: BTreeSet<i64> = records
        .iter()
        .filter_map(|record| record.guess.condition)
        .collect();
    said.iter()
        .map(i64::to_string)
        .collect::<Vec<_>>()
        .join(", ")
}

/// Returns the dataset for another folder: its records are referenced through `folder`, and its
/// description is replaced if one is given.
fn moved(dataset: &Dataset, folder: &str, description: Option<&str>) -> Result<Dataset, Failure> {
    let mut header = dataset.header();
    header.description = description.map_or(header.description, ToOwned::to_owned);
    let found = |record: &ConditionRecord| {
        let stays = folder.is_empty() || folder == "." || Path::new(&record.file).is_absolute();
        let file = if stays {
            record.file.clone()
        } else {
            format!("{folder}/{}", record.file)
        };
        ConditionRecord {
            file,
            ..record.clone()
        }
    };
    let conditions = dataset.conditions().iter().map(|condition| {
        condition
            .as_ref()
            .clone()
            .with_records(condition.records().iter().map(found).collect())
    });
    let conditions = conditions
        .collect::<Result<_, _>>()
        .map_err(|error| Failure::option("--description", error))?;
    Dataset::new(header, conditions).map_err(|error| Failure::option("--description", error))
}
