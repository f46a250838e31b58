//! `gdcm check`.

use std::collections::BTreeMap;
use std::path::Path;

use gdcm_io::file_error::ContentFault;
use gdcm_io::files::beginning::check_beginning;
use gdcm_io::files::dataset_file::dataset_faults;
use gdcm_io::files::study_file::{OpenedStudy, holds_models};
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

use super::arguments::{ChannelSign, OpeningArguments};
use super::open;
use super::study_options::turn;
use super::summary::doubt_words;
use super::terminal::{Failure, by_words, error, indented, line, of_conditions, say};

/// Prints the contents of a dataset or a study.
pub(super) fn check(
    file: &Path,
    arguments: &OpeningArguments,
    signs: &[ChannelSign],
) -> Result<(), Failure> {
    if file.is_file() && !holds_models(file) {
        // A wrong structure is found before a large file is read completely.
        check_beginning(file)?;
    }
    let opened = match open(file, arguments) {
        Err(Failure::File(error)) if has_several_faults(&error) => {
            return Err(all_faults(file, error));
        }
        opened => opened?,
    };
    let (decided, mut study, loaded) = match opened {
        Opened::Dataset(loaded) => (String::new(), Study::new(loaded.dataset.clone()), loaded),
        Opened::Study(OpenedStudy { study, loaded, .. }) => {
            (decisions(file, &study), study, loaded)
        }
    };
    turn(&mut study, signs)?;
    say(&(decided + &contents(&loaded) + &model_cautions(&study)?))
}

/// Returns whether an error concerns the content of a dataset, which may have further faults; a
/// syntax error is the only one reported.
fn has_several_faults(error: &FileError) -> bool {
    matches!(error, FileError::Content { fault, .. } if matches!(**fault, ContentFault::Dataset(_)))
}

/// Reports every fault of a dataset; returns the single fault itself, or a failure with their
/// number.
fn all_faults(file: &Path, first: FileError) -> Failure {
    match dataset_faults(file) {
        Ok(faults) if faults.len() > 1 => {
            faults.iter().for_each(|fault| error(&fault.to_string()));
            Failure::Faulty {
                path: sanitized_path(file),
                count: faults.len(),
            }
        }
        // A single fault, or a study: the first message is complete.
        _ => Failure::File(first),
    }
}

fn contents(loaded: &LoadedDataset) -> String {
    let dataset = &loaded.dataset;
    let on_axis: Vec<String> = dataset
        .on_axis()
        .marked()
        .map(|pair| sanitized(&dataset.pair_name(pair)))
        .collect();
    let on_axis = if on_axis.is_empty() {
        "none given: every response counts".to_owned()
    } else {
        on_axis.join(", ")
    };
    let band = format!(
        "{} to {} rad/s",
        number(dataset.band().min()),
        number(dataset.band().max())
    );
    let lines = [
        (
            "Dataset",
            format!("{}, {}", sanitized(dataset.name()), loaded.origin),
        ),
        ("SHA-256", loaded.sha256.clone()),
        ("About", sanitized(dataset.description())),
        ("Inputs", channel_words(dataset.inputs())),
        ("Outputs", channel_words(dataset.outputs())),
        ("On-axis", on_axis),
        ("Band", band),
        ("Conditions", dataset.conditions().len().to_string()),
    ];
    let text: String = lines
        .iter()
        .map(|(label, words)| line(label, words))
        .collect();
    let cautions: String = loaded
        .cautions
        .iter()
        .map(|words| caution_line(words))
        .collect();
    text + &condition_table(dataset) + &timings(dataset) + &records(dataset) + &cautions
}

/// Returns the cautions of an analysis that concern the models alone.
fn model_cautions(study: &Study) -> Result<String, Failure> {
    let execution = Execution::new(&crate::executor::Pool, &Unobserved, 0);
    // Signs and units come first, because other cautions may follow from them.
    let doubts = doubts_of_models(study, &execution)?;
    let doubts = doubts
        .iter()
        .map(|doubt| doubt_words(doubt, &study.dataset));
    let cautions = cautions_of_models(study, &execution)?;
    let cautions = cautions.into_iter().map(|(id, caution)| {
        (
            id,
            caution_text(&caution, |pair| study.dataset.pair_name(pair)),
        )
    });
    let cautions = by_words(cautions)
        .into_iter()
        .map(|(conditions, words)| of_conditions(&conditions, &words));
    let without = study.dataset.without_reference();
    let no_reference = (!without.is_empty())
        .then(|| of_conditions(&without, &ConditionFailure::NoReference.to_string()));
    Ok(no_reference
        .into_iter()
        .chain(doubts)
        .chain(cautions)
        .map(|words| caution_line(&words))
        .collect())
}

fn caution_line(words: &str) -> String {
    line("Caution", &sanitized(words))
}

fn channel_words(channels: &[Channel]) -> String {
    let words = channels.iter().map(|channel| {
        format!(
            "{} [{}]",
            sanitized(&channel.name),
            sanitized(&channel.unit)
        )
    });
    words.collect::<Vec<_>>().join(", ")
}

fn condition_table(dataset: &Dataset) -> String {
    let with_unit = |value: Option<f64>, unit: &str| {
        value.map_or("-".to_owned(), |value| format!("{} {unit}", number(value)))
    };
    let mut table = Table::new(
        "",
        [
            "id",
            "airspeed",
            "altitude",
            "mass",
            "physics",
            "states",
            "identified",
            "states",
            "name",
        ],
    );
    for condition in dataset.conditions() {
        let state = condition.flight_state();
        let [physics, identified] = BundleKind::BOTH.map(|of| condition.bundle(of));
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

/// Returns the sample times and delays, for each bundle with the models that share them (M2a).
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
    for condition in dataset
        .conditions()
        .iter()
        .filter(|condition| !condition.records().is_empty())
    {
        let count = |is_it: &dyn Fn(&ConditionRecord) -> bool, what: &str| {
            let count = condition
                .records()
                .iter()
                .filter(|record| is_it(record))
                .count();
            (count > 0).then(|| format!("{count} {what}"))
        };
        let kinds = RecordKind::ALL
            .into_iter()
            .filter_map(|kind| count(&|record| record.kind == kind, kind.word()));
        let rest = [
            count(&|record| record.held_out, "held out"),
            count(&|record| !record.used, "not used"),
        ];
        let words: Vec<String> = kinds.chain(rest.into_iter().flatten()).collect();
        text += &line(
            "Records",
            &format!("condition {}: {}", condition.id(), words.join(", ")),
        );
    }
    text
}

/// Returns the numbers of states of the models: "39", "11-14", "measured", "12, measured".
fn order_words(models: &[Model]) -> String {
    let orders = models.iter().filter_map(|model| match &model.dynamics {
        Dynamics::StateSpace(matrices) => Some(matrices.order()),
        Dynamics::Measured(_) => None,
    });
    let orders: Vec<usize> = orders.collect();
    let measured = (orders.len() < models.len()).then(|| "measured".to_owned());
    let ends = orders.iter().min().zip(orders.iter().max());
    let range = ends.map(|(least, most)| {
        if least == most {
            least.to_string()
        } else {
            format!("{least}-{most}")
        }
    });
    range
        .into_iter()
        .chain(measured)
        .collect::<Vec<_>>()
        .join(", ")
}

/// Returns the decisions in a study.
fn decisions(file: &Path, study: &Study) -> String {
    let mut text = line("Study", &sanitized_path(file));
    for condition in study.dataset.conditions() {
        let id = condition.id();
        let choice = study.choice(condition.id());
        let rejected: Vec<String> = study
            .rejected_names(id)
            .into_iter()
            .map(sanitized)
            .collect();
        if !rejected.is_empty() {
            text += &line(
                "Rejected",
                &format!("condition {id}: {}", rejected.join(", ")),
            );
        }
        for name in BundleKind::BOTH
            .iter()
            .filter_map(|kind| choice.bundle(*kind).pinned.as_ref())
        {
            text += &line("Pinned", &format!("condition {id}: {}", sanitized(name)));
        }
        for (label, is_so) in [
            ("Held out", choice.held_out),
            ("Unscheduled", !choice.scheduled),
        ] {
            if is_so {
                text += &line(label, &format!("condition {id}"));
            }
        }
    }
    text
}
