//! Report sections on where the results come from: study and dataset files, and the models' source
//! files.

use std::collections::BTreeMap;

use gdcm_model::dataset::model::Provenance;
use gdcm_model::dataset::{BundleKind, Channel};
use gdcm_model::number_format::counted;
use gdcm_study::Study;
use gdcm_words::Table;

use super::ReportSource;
use super::page::Page;
use super::wording::names;
use crate::software::software;

/// Adds the section on the study and dataset files.
pub(super) fn add_files(page: &mut Page, study: &Study, source: &ReportSource) {
    page.section("Provenance");
    let dataset = &study.dataset;
    let study_file = match &source.study {
        Some(file) => file.clone(),
        None => "not saved in a file".to_owned(),
    };
    page.facts([
        ("Dataset", dataset.name().to_owned()),
        ("Dataset file", source.dataset.clone()),
        ("SHA-256 of the dataset file", source.sha256.clone()),
        ("Study", study_file),
        ("Program", software()),
        ("Inputs", channel_words(dataset.inputs())),
        ("Outputs", channel_words(dataset.outputs())),
    ]);
    for line in dataset.description().lines() {
        if !line.trim().is_empty() {
            page.paragraph(line);
        }
    }
    let cautions = source.cautions.iter();
    page.list(cautions.map(|caution| format!("Caution about the file: {caution}.")));
}

/// Lists channels with their units: "LON [%], LAT [%]".
fn channel_words(channels: &[Channel]) -> String {
    let words: Vec<String> = channels
        .iter()
        .map(|channel| format!("{} [{}]", channel.name, channel.unit))
        .collect();
    words.join(", ")
}

/// Adds the appendix on the models' source files: a table, or a sentence if the dataset states
/// none.
pub(super) fn add_models(page: &mut Page, study: &Study) {
    let mut models: BTreeMap<[String; 5], Vec<String>> = BTreeMap::new();
    let mut unknown = 0;
    for condition in study.dataset.conditions() {
        for kind in BundleKind::BOTH {
            for model in condition.bundle(kind) {
                let Some(source) = &model.source else {
                    unknown += 1;
                    continue;
                };
                let models_of_file = models.entry(source_cells(source)).or_default();
                models_of_file.push(format!("{}: {}", condition.id(), model.name));
            }
        }
    }
    page.appendix("Sources of the models");
    if models.is_empty() {
        page.paragraph("The dataset does not state the source files of its models.");
        return;
    }
    let columns = [
        "file",
        "SHA-256",
        "variable",
        "made",
        "note",
        "models, by condition",
    ];
    let mut table = Table::new("Source files of the models", columns);
    for (cells, models) in models {
        table.row(cells.into_iter().chain([names(&models)]));
    }
    page.table(&table);
    if unknown > 0 {
        page.paragraph(&format!(
            "The dataset does not state the source of {}.",
            counted(unknown, "model")
        ));
    }
}

/// Returns the table cells for a model's source: file, hash, variable (or records), date and note.
fn source_cells(source: &Provenance) -> [String; 5] {
    let Provenance {
        file,
        sha256,
        variable,
        made,
        note,
        records,
        ..
    } = source;
    let mut variable = variable.clone();
    if variable.is_none() && !records.is_empty() {
        variable = Some(format!("records {}", records.join(", ")));
    }
    [file, sha256, &variable, made, note].map(|part| part.clone().unwrap_or_default())
}
