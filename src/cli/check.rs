//! `gdcm check`: prints the contents and faults of a dataset or a study.

use std::collections::BTreeMap;
use std::path::Path;

use gdcm_io::file_error::ContentFault;
use gdcm_io::files::beginning::check_beginning;
use gdcm_io::files::dataset_file::dataset_faults;
use gdcm_io::files::opened_file::holds_models;
use gdcm_io::files::study_file::OpenedStudy;
use gdcm_io::{FileError, LoadedDataset, Opened};
use gdcm_model::dataset::condition::{ConditionRecord, RecordKind};
use gdcm_model::dataset::{BundleKind, Channel, Dataset, Dynamics, Model};
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::progress::Unobserved;
use gdcm_model::units::number;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::stages::convention_check::doubts_of_models;
use gdcm_study::stages::model_cautions::cautions_of_models;
use gdcm_study::{Execution, Study};
use gdcm_words::Table;
use gdcm_words::caution::caution_text;

use super::channel_values::ChannelSign;
use super::condition_messages::{ConditionMessage, shared_messages, with_conditions};
use super::failure::Failure;
use super::open;
use super::study_arguments::OpeningArguments;
use super::study_options::apply_signs;
use super::summary::doubt_words;
use super::terminal::{error, print};
use super::text::{indented, line};

/// Prints the contents of a dataset or study.
pub(super) fn check(
    file: &Path,
    arguments: &OpeningArguments,
    signs: &[ChannelSign],
) -> Result<(), Failure> {
    if file.is_file() && !holds_models(file) {
        // Reports structural errors before the whole of a large file is read.
        check_beginning(file)?;
    }
    let opened = match open(file, arguments) {
        Err(Failure::File(error)) if has_several_faults(&error) => {
            return Err(report_faults(file, error));
        }
        opened => opened?,
    };
    let (decided, mut study, loaded) = match opened {
        Opened::Dataset(loaded) => (String::new(), Study::new(loaded.dataset.clone()), loaded),
        Opened::Study(OpenedStudy { study, loaded, .. }) => {
            (decisions(file, &study), study, loaded)
        }
    };
    apply_signs(&mut study, signs)?;
    print(&(decided + &contents(&loaded) + &model_cautions(&study)?))
}

/// Returns whether an error concerns the content of a dataset, which may have further faults; after
/// a syntax error no others can be found.
fn has_several_faults(error: &FileError) -> bool {
    matches!(error, FileError::Content { fault, .. } if matches!(**fault, ContentFault::Dataset(_)))
}

/// Prints every fault in a dataset. Returns the failure with the number of faults; if there is only
/// one, the failure is that fault.
fn report_faults(file: &Path, first: FileError) -> Failure {
    match dataset_faults(file) {
        Ok(faults) if faults.len() > 1 => {
            for fault in &faults {
                error(&fault.to_string());
            }
            Failure::Faulty {
                path: sanitized_path(file),
                count: faults.len(),
            }
        }
        // If there is a single fault, or the file is a study, the first error is complete.
        _ => Failure::File(first),
    }
}

/// Returns the contents of a dataset: its header, conditions, timings, records and cautions.
fn contents(loaded: &LoadedDataset) -> String {
    let dataset = &loaded.dataset;
    let band = format!(
        "{} to {} rad/s",
        number(dataset.band().min()),
        number(dataset.band().max())
    );
    let name = format!("{}, {}", sanitized(dataset.name()), loaded.origin);
    let mut text = line("Dataset", &name);
    text += &line("SHA-256", &loaded.sha256);
    text += &line("About", &sanitized(dataset.description()));
    text += &line("Inputs", &channel_words(dataset.inputs()));
    text += &line("Outputs", &channel_words(dataset.outputs()));
    text += &line("On-axis", &on_axis_words(dataset));
    text += &line("Band", &band);
    text += &line("Conditions", &dataset.conditions().len().to_string());
    text += &condition_table(dataset);
    text += &timings(dataset);
    text += &records(dataset);
    for words in &loaded.cautions {
        text += &caution_line(words);
    }
    text
}

fn on_axis_words(dataset: &Dataset) -> String {
    let pairs: Vec<String> = dataset
        .on_axis()
        .marked()
        .map(|pair| sanitized(&dataset.pair_name(pair)))
        .collect();
    if pairs.is_empty() {
        "none marked: all responses enter the objective".to_owned()
    } else {
        pairs.join(", ")
    }
}

/// Returns the cautions of an analysis that concern only the models. Missing references come first,
/// then signs and units, because other cautions may result from them.
fn model_cautions(study: &Study) -> Result<String, Failure> {
    let execution = Execution::new(&crate::executor::Pool, &Unobserved, 0);
    let dataset = &study.dataset;
    let mut text = String::new();
    let without = dataset.without_reference();
    if !without.is_empty() {
        let words = ConditionFailure::NoReference.to_string();
        text += &caution_line(&with_conditions(&without, &words));
    }
    for doubt in doubts_of_models(study, &execution)? {
        text += &caution_line(&doubt_words(&doubt, dataset));
    }
    let cautions = cautions_of_models(study, &execution)?;
    let messages = cautions.into_iter().map(|(id, caution)| {
        let words = caution_text(&caution, |pair| dataset.pair_name(pair));
        ConditionMessage::new(id, words)
    });
    for message in shared_messages(messages) {
        text += &caution_line(&message.words());
    }
    Ok(text)
}

fn caution_line(words: &str) -> String {
    line("Caution", &sanitized(words))
}

/// Lists channels with their units: "LON [in], LAT [in]".
fn channel_words(channels: &[Channel]) -> String {
    let mut words = Vec::new();
    for channel in channels {
        let unit = sanitized(&channel.unit);
        words.push(format!("{} [{unit}]", sanitized(&channel.name)));
    }
    words.join(", ")
}

fn condition_table(dataset: &Dataset) -> String {
    let columns = [
        "id",
        "airspeed",
        "altitude",
        "mass",
        "physics",
        "states",
        "identified",
        "states",
        "name",
    ];
    let mut table = Table::new("", columns);
    for condition in dataset.conditions() {
        let state = condition.flight_state();
        let physics = condition.bundle(BundleKind::Physics);
        let identified = condition.bundle(BundleKind::Identified);
        table.row([
            state.id.to_string(),
            format!("{} kt", number(state.airspeed_kt)),
            with_unit(state.altitude_ft, "ft"),
            with_unit(state.mass_kg, "kg"),
            physics.len().to_string(),
            order_words(physics),
            identified.len().to_string(),
            order_words(identified),
            sanitized(&state.name),
        ]);
    }
    indented(&table, 2)
}

/// Formats a number with its unit; "-" for `None`.
fn with_unit(value: Option<f64>, unit: &str) -> String {
    match value {
        Some(value) => format!("{} {unit}", number(value)),
        None => "-".to_owned(),
    }
}

/// Returns the sample times and delays in each bundle, with the models that have them (M2a).
fn timings(dataset: &Dataset) -> String {
    let mut text = String::new();
    for condition in dataset.conditions() {
        for kind in BundleKind::BOTH {
            let mut named: BTreeMap<String, Vec<String>> = BTreeMap::new();
            for model in condition.bundle(kind) {
                let Dynamics::StateSpace(matrices) = &model.dynamics else {
                    continue;
                };
                if !matrices.timing().is_plain() {
                    named
                        .entry(matrices.timing().words())
                        .or_default()
                        .push(sanitized(&model.name));
                }
            }
            for (words, names) in named {
                let words = format!(
                    "condition {}, {kind} {}: {words}",
                    condition.id(),
                    names.join(", ")
                );
                text += &line("Timing", &words);
            }
        }
    }
    text
}

/// Returns the flight records of each condition: their number, manoeuvres and use.
fn records(dataset: &Dataset) -> String {
    let mut text = String::new();
    for condition in dataset.conditions() {
        if condition.records().is_empty() {
            continue;
        }
        let words = record_words(condition.records());
        text += &line("Records", &format!("condition {}: {words}", condition.id()));
    }
    text
}

/// Counts records by kind, and those held out or not used: "3 sweep, 1 doublet, 1 held out".
fn record_words(records: &[ConditionRecord]) -> String {
    let mut counts: Vec<(usize, &str)> = Vec::new();
    for kind in RecordKind::ALL {
        let count = records.iter().filter(|record| record.kind == kind).count();
        counts.push((count, kind.word()));
    }
    let held_out = records.iter().filter(|record| record.held_out).count();
    counts.push((held_out, "held out"));
    let unused = records.iter().filter(|record| !record.used).count();
    counts.push((unused, "not used"));
    let words: Vec<String> = counts
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, label)| format!("{count} {label}"))
        .collect();
    words.join(", ")
}

/// Describes the orders of the models: "39", "11-14", "measured", "12, measured".
fn order_words(models: &[Model]) -> String {
    let mut orders: Vec<usize> = Vec::new();
    for model in models {
        if let Dynamics::StateSpace(matrices) = &model.dynamics {
            orders.push(matrices.order());
        }
    }
    let mut words: Vec<String> = Vec::new();
    if let (Some(least), Some(most)) = (orders.iter().min(), orders.iter().max()) {
        words.push(if least == most {
            least.to_string()
        } else {
            format!("{least}-{most}")
        });
    }
    if orders.len() < models.len() {
        words.push("measured".to_owned());
    }
    words.join(", ")
}

/// Describes the decisions of a study.
fn decisions(file: &Path, study: &Study) -> String {
    let mut text = line("Study", &sanitized_path(file));
    for condition in study.dataset.conditions() {
        let id = condition.id();
        let choice = study.choice(id);
        let rejected = study.rejected_names(id);
        let rejected: Vec<String> = rejected.into_iter().map(sanitized).collect();
        if !rejected.is_empty() {
            let words = format!("condition {id}: {}", rejected.join(", "));
            text += &line("Rejected", &words);
        }
        for kind in BundleKind::BOTH {
            if let Some(name) = &choice.bundle(kind).pinned {
                text += &line("Pinned", &format!("condition {id}: {}", sanitized(name)));
            }
        }
        if choice.held_out {
            text += &line("Held out", &format!("condition {id}"));
        }
        if !choice.scheduled {
            text += &line("Unscheduled", &format!("condition {id}"));
        }
    }
    text
}
