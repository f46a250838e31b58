//! A dataset's contents, as printed by `gdcm check`.

use std::collections::BTreeMap;

use gdcm_io::LoadedDataset;
use gdcm_model::dataset::condition::{ConditionRecord, RecordKind};
use gdcm_model::dataset::{BundleKind, Channel, Dataset, Dynamics, Model};
use gdcm_model::message_text::sanitized;
use gdcm_model::number_format::NO_VALUE;
use gdcm_model::units::number;
use gdcm_words::Table;

use super::printed_lines::{caution_line, indented, line};
use super::terminal::keep_caution;

/// Returns a dataset's contents: its header, conditions, timings, records and cautions. The
/// cautions are also added to the JSON object.
pub(super) fn contents(loaded: &LoadedDataset) -> String {
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
    for caution in &loaded.cautions {
        let words = caution.to_string();
        keep_caution(caution.code(), &[], &words);
        text += &caution_line(&words);
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
        "none marked: distances and bounds are computed from all responses".to_owned()
    } else {
        pairs.join(", ")
    }
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

/// Formats a number with its unit; "–" for `None`.
fn with_unit(value: Option<f64>, unit: &str) -> String {
    match value {
        Some(value) => format!("{} {unit}", number(value)),
        None => NO_VALUE.to_owned(),
    }
}

/// Describes the model orders: "39", "11-14", "measured", "12, measured".
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

/// Returns the sample times and delays in each bundle, with the models that have them (M2a:
/// docs/method.md). Omits models in continuous time without delays.
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

/// Returns each condition's flight records: their number, manoeuvres and use.
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
