//! `gdcm check`.

use gdcm_core::message_text::{sanitized, sanitized_path};
use std::collections::BTreeMap;
use std::path::Path;

use gdcm_core::dataset::{BundleKind, Channel, Condition, ConditionRecord, Dataset, Dynamics, Model, RecordKind};
use gdcm_core::study::{Execution, Study, Table, Unobserved, cautions_of_models, doubts_of_models};
use gdcm_core::units::number;
use gdcm_files::{FileError, LoadedDataset, Opened, OpenedStudy, dataset_faults};

use super::{
    Failure, LABEL, OpeningArguments, SaidSign, by_words, doubt_words, error, indented, labelled, listed_conditions,
    open, say, turn,
};

/// Says what a dataset or a study holds.
pub(super) fn check(file: &Path, arguments: &OpeningArguments, signs: &[SaidSign]) -> Result<(), Failure> {
    let opened = match open(file, arguments) {
        Err(Failure::File(error @ FileError::Content { .. })) => return Err(all_faults(file, error)),
        opened => opened?,
    };
    let (decided, mut study, loaded) = match opened {
        Opened::Dataset(loaded) => (String::new(), Study::new(loaded.dataset.clone()), loaded),
        Opened::Study(OpenedStudy { study, loaded, .. }) => (decisions(file, &study), study, loaded),
    };
    turn(&mut study, signs)?;
    say(&(decided + &contents(&loaded) + &model_cautions(&study)?))
}

/// Tells every fault of a dataset, and gives what the command ends with: the only one itself, else their number.
fn all_faults(file: &Path, first: FileError) -> Failure {
    match dataset_faults(file) {
        Ok(faults) if faults.len() > 1 => {
            faults.iter().for_each(|fault| error(&fault.to_string()));
            Failure::Faulty { path: sanitized_path(file), count: faults.len() }
        }
        // One, or a study: what was said first is all there is.
        _ => Failure::File(first),
    }
}

fn contents(loaded: &LoadedDataset) -> String {
    let dataset = &loaded.dataset;
    let on_axis: Vec<String> = dataset.on_axis().marked().map(|pair| sanitized(&dataset.pair_name(pair))).collect();
    let on_axis = if on_axis.is_empty() { "none given: every response counts".to_owned() } else { on_axis.join(", ") };
    let band = format!("{} to {} rad/s", number(dataset.band().min()), number(dataset.band().max()));
    let name = format!("{}, {}", sanitized(dataset.name()), loaded.origin);
    let mut text = labelled(0, "Dataset", LABEL, &name);
    for (label, words) in [
        ("SHA-256", loaded.sha256.clone()),
        ("About", sanitized(dataset.description())),
        ("Inputs", channel_words(dataset.inputs())),
        ("Outputs", channel_words(dataset.outputs())),
        ("On-axis", on_axis),
        ("Band", band),
    ] {
        text.push_str(&labelled(0, label, LABEL, &words));
    }
    text.push_str(&labelled(0, "Conditions", LABEL, &dataset.conditions().len().to_string()));
    text.push_str(&condition_table(dataset));
    text.push_str(&timings(dataset));
    text.push_str(&records(dataset));
    for caution in &loaded.cautions {
        text.push_str(&caution_line(caution));
    }
    text
}

/// What an analysis would say of the models by themselves.
fn model_cautions(study: &Study) -> Result<String, Failure> {
    let execution = Execution::new(&crate::executor::Pool, &Unobserved, 0);
    // Signs and units first: what follows may come of them.
    let doubts = doubts_of_models(study, &execution)?;
    let mut text: String = doubts.iter().map(|doubt| caution_line(&doubt_words(doubt, &study.dataset))).collect();
    let pair_name = |pair| study.dataset.pair_name(pair);
    let cautions = cautions_of_models(study, &execution)?;
    for (conditions, words) in by_words(cautions.into_iter().map(|(id, caution)| (id, caution.words(pair_name)))) {
        text.push_str(&caution_line(&format!("{}: {words}", listed_conditions(&conditions))));
    }
    Ok(text)
}

fn caution_line(words: &str) -> String {
    labelled(0, "Caution", LABEL, &sanitized(words))
}

fn channel_words(channels: &[Channel]) -> String {
    let words = channels.iter().map(|channel| format!("{} [{}]", sanitized(&channel.name), sanitized(&channel.unit)));
    words.collect::<Vec<_>>().join(", ")
}

fn condition_table(dataset: &Dataset) -> String {
    let mut table =
        Table::new("", ["id", "airspeed", "altitude", "mass", "physics", "states", "identified", "states", "name"]);
    for condition in dataset.conditions() {
        table.row(condition_row(condition));
    }
    indented(&table, 2)
}

/// Sample times and delays, for each bundle the models that share them (M2a).
fn timings(dataset: &Dataset) -> String {
    let mut text = String::new();
    for condition in dataset.conditions() {
        for kind in BundleKind::BOTH {
            let mut named: BTreeMap<String, Vec<String>> = BTreeMap::new();
            for model in condition.bundle(kind) {
                let Dynamics::StateSpace(matrices) = &model.dynamics else { continue };
                if !matrices.timing().is_plain() {
                    named.entry(matrices.timing().words()).or_default().push(sanitized(&model.name));
                }
            }
            for (words, names) in named {
                let words = format!("condition {}, {kind} {}: {words}", condition.id(), names.join(", "));
                text.push_str(&labelled(0, "Timing", LABEL, &words));
            }
        }
    }
    text
}

/// The flight records of each condition that has some: how many, of which manoeuvre, and what is done with them.
fn records(dataset: &Dataset) -> String {
    let mut text = String::new();
    for condition in dataset.conditions().iter().filter(|condition| !condition.records().is_empty()) {
        let count = |is_it: &dyn Fn(&ConditionRecord) -> bool, what: &str| {
            let count = condition.records().iter().filter(|record| is_it(record)).count();
            (count > 0).then(|| format!("{count} {what}"))
        };
        let kinds = RecordKind::ALL.into_iter().filter_map(|kind| count(&|record| record.kind == kind, kind.word()));
        let rest = [count(&|record| record.held_out, "held out"), count(&|record| !record.used, "not used")];
        let words: Vec<String> = kinds.chain(rest.into_iter().flatten()).collect();
        text.push_str(&labelled(0, "Records", LABEL, &format!("condition {}: {}", condition.id(), words.join(", "))));
    }
    text
}

fn condition_row(condition: &Condition) -> [String; 9] {
    let state = condition.flight_state();
    let with_unit =
        |value: Option<f64>, unit: &str| value.map_or("-".to_owned(), |value| format!("{} {unit}", number(value)));
    let count = |kind| condition.bundle(kind).len().to_string();
    [
        state.id.to_string(),
        format!("{} kt", number(state.airspeed_kt)),
        with_unit(state.altitude_ft, "ft"),
        with_unit(state.mass_kg, "kg"),
        count(BundleKind::Physics),
        order_words(condition.bundle(BundleKind::Physics)),
        count(BundleKind::Identified),
        order_words(condition.bundle(BundleKind::Identified)),
        sanitized(&state.name),
    ]
}

/// The models' numbers of states: "39", "11-14", "measured", "12, measured".
fn order_words(models: &[Model]) -> String {
    let orders = models.iter().filter_map(|model| match &model.dynamics {
        Dynamics::StateSpace(matrices) => Some(matrices.order()),
        Dynamics::Measured(_) => None,
    });
    let orders: Vec<usize> = orders.collect();
    let measured = (orders.len() < models.len()).then(|| "measured".to_owned());
    let range = orders
        .iter()
        .min()
        .zip(orders.iter().max())
        .map(|(least, most)| if least == most { least.to_string() } else { format!("{least}-{most}") });
    range.into_iter().chain(measured).collect::<Vec<_>>().join(", ")
}

/// What a study has decided.
fn decisions(file: &Path, study: &Study) -> String {
    let mut text = labelled(0, "Study", LABEL, &sanitized_path(file));
    for condition in study.dataset.conditions() {
        let choice = study.choice(condition.id());
        let rejected: Vec<String> = study.rejected_names(condition.id()).into_iter().map(sanitized).collect();
        if !rejected.is_empty() {
            let words = format!("condition {}: {}", condition.id(), rejected.join(", "));
            text.push_str(&labelled(0, "Rejected", LABEL, &words));
        }
        for kind in BundleKind::BOTH {
            if let Some(name) = &choice.bundle(kind).pinned {
                let words = format!("condition {}: {}", condition.id(), sanitized(name));
                text.push_str(&labelled(0, "Pinned", LABEL, &words));
            }
        }
        if choice.held_out {
            text.push_str(&labelled(0, "Held out", LABEL, &format!("condition {}", condition.id())));
        }
        if !choice.scheduled {
            text.push_str(&labelled(0, "Unscheduled", LABEL, &format!("condition {}", condition.id())));
        }
    }
    text
}
