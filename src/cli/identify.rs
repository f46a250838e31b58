//! `gdcm identify`: models out of flight records.

use gdcm_core::message_text::{sanitized, sanitized_path};
use std::path::{Path, PathBuf};

use gdcm_core::assembly::ChannelRule;
use gdcm_core::dataset::Band;
use gdcm_core::identification::Identification;
use gdcm_core::records::RecordChannels;
use gdcm_core::study::identified_bundle;
use gdcm_files::{IdentifiedModels, OutputSet, add_identified, make_directory};

use super::destination::Destination;
use super::existing;
use super::failure::Failure;
use super::identification_task::{IdentificationTask, preparation};
use super::identify_arguments::{ChannelList, IdentifyArguments};
use super::models::counted;
use super::read_record::{hold_out, laid_out};
use super::terminal::{say, say_error};

/// The file of what was found.
const IDENTIFIED: &str = "identified.json";

/// Identifies models from flight records and writes them, beside a dataset with them in it where one is given.
pub(super) fn identify(arguments: &IdentifyArguments) -> Result<(), Failure> {
    let inputs = arguments.records.iter().chain(&arguments.into).cloned().collect();
    let mut outputs = OutputSet::new(existing(arguments.force), inputs);
    let mut destination = Destination::asked(arguments)?;
    let mut channels = channels(arguments, destination.as_ref())?;
    let tasks = tasks(arguments, destination.as_ref(), &mut channels)?;
    let files: Vec<PathBuf> = tasks.iter().map(|task| identified_path(arguments, task)).collect();
    let dataset = destination.iter().map(|of| of.path.as_path());
    outputs.check(&files.iter().map(PathBuf::as_path).chain(dataset).collect::<Vec<&Path>>())?;
    say(&tasks.iter().map(IdentificationTask::table).collect::<String>())?;
    let (mut lines, mut taken) = (String::new(), 0);
    for (task, file) in tasks.iter().zip(&files) {
        let found = match task.run() {
            Ok(found) => found,
            Err(error) if tasks.len() == 1 => return Err(Failure::NoModels { reason: error.to_string() }),
            Err(error) => {
                say_error(&format!("{}no model was identified: {error}", task.label()));
                continue;
            }
        };
        let mut models = task.models(&found, &channels);
        models.cautions.extend(destination.as_ref().and_then(|of| task.late_channel(&found, &of.dataset)));
        models.cautions.iter().for_each(|caution| say_error(&format!("{}{}", task.label(), sanitized(caution))));
        make_directory(&arguments.out)?;
        add_identified(&models, file, &mut outputs)?;
        if let (Some(destination), Some(condition)) = (&mut destination, task.condition) {
            let entries = task.entries(&found, &arguments.records, &destination.path);
            destination.take(condition, &identified_bundle(&found, arguments.take.offered(), entries))?;
        }
        lines += &outcome(task, file, &found, &models);
        taken += 1;
    }
    if taken == 0 {
        return Err(Failure::NoModels { reason: format!("in none of {} conditions", tasks.len()) });
    }
    if let Some(destination) = &destination {
        let path = sanitized_path(destination.add(&mut outputs)?);
        lines += &format!("{path}: identified models of {}\n", counted(taken, "condition"));
    }
    outputs.persist()?;
    say(&lines)
}

/// What is to be identified: all records together, or those of each condition.
fn tasks(
    arguments: &IdentifyArguments,
    destination: Option<&Destination>,
    channels: &mut RecordChannels,
) -> Result<Vec<IdentificationTask>, Failure> {
    let band = band(arguments, destination)?;
    let mut records = laid_out(arguments, channels)?;
    hold_out(&arguments.hold_out, &mut records)?;
    let preparation = preparation(channels, &arguments.delay)?;
    let groups = match destination {
        Some(destination) => destination.groups(records)?,
        None => vec![(None, records)],
    };
    groups.into_iter().map(|group| IdentificationTask::new(group, channels, &preparation, band)).collect()
}

/// Where what was found is written: a file for each condition where there are many.
fn identified_path(arguments: &IdentifyArguments, task: &IdentificationTask) -> PathBuf {
    let of_many = task.condition.filter(|_| arguments.every_condition);
    arguments.out.join(of_many.map_or_else(|| IDENTIFIED.to_owned(), |id| format!("identified-condition-{id}.json")))
}

/// One line of what was found and where it is.
fn outcome(task: &IdentificationTask, file: &Path, found: &Identification, models: &IdentifiedModels) -> String {
    let held_out = found.held_out_cost.map_or_else(String::new, |cost| format!(", of what is held out {cost:.2}"));
    format!(
        "{}{}: {}; order {}, J per degree of freedom {:.2}{held_out}\n",
        task.label(),
        sanitized_path(file),
        counted(models.models.len(), "model"),
        found.refined.matrices.order(),
        found.cost,
    )
}

/// The channels asked for: the dataset's, in its units, or those of the command line, in the units of the first record.
fn channels(arguments: &IdentifyArguments, destination: Option<&Destination>) -> Result<RecordChannels, Failure> {
    let Some(destination) = destination else {
        let rules = |list: &Option<ChannelList>| {
            let channels = list.iter().flat_map(|list| &list.channels);
            channels.map(|(name, column)| with_column(ChannelRule::named(name.clone()), column.as_ref())).collect()
        };
        return Ok(RecordChannels { inputs: rules(&arguments.inputs), outputs: rules(&arguments.outputs) });
    };
    let mut channels = RecordChannels::of_dataset(&destination.dataset);
    for (option, list, rules) in [
        ("--inputs", &arguments.inputs, &mut channels.inputs),
        ("--outputs", &arguments.outputs, &mut channels.outputs),
    ] {
        for (name, column) in list.iter().flat_map(|list| &list.channels) {
            let Some(rule) = rules.iter_mut().find(|rule| rule.name == *name) else {
                let names: Vec<&str> = rules.iter().map(|rule| rule.name.as_str()).collect();
                let reason = format!("the dataset has no {name} there; it has {}", names.join(", "));
                return Err(Failure::Option { option, reason });
            };
            *rule = with_column(std::mem::take(rule), column.as_ref());
        }
    }
    Ok(channels)
}

/// The rule of a channel that is this column, where one is said.
fn with_column(rule: ChannelRule, column: Option<&String>) -> ChannelRule {
    ChannelRule { aliases: column.cloned().into_iter().collect(), ..rule }
}

fn band(arguments: &IdentifyArguments, destination: Option<&Destination>) -> Result<Band, Failure> {
    match (arguments.band.as_deref(), destination) {
        (Some(&[min, max]), _) => {
            Band::new(min, max).map_err(|error| Failure::Option { option: "--band", reason: error.to_string() })
        }
        (_, Some(destination)) => Ok(destination.dataset.band()),
        _ => Err(Failure::Option { option: "--band", reason: "expected two frequencies".to_owned() }),
    }
}
