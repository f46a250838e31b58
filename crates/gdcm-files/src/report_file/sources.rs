//! Where the numbers come from: the dataset, the study, the program, and the files that the models were made from.

use std::collections::BTreeMap;

use gdcm_core::dataset::{BundleKind, Provenance};
use gdcm_core::study::{Study, Table};

use super::ReportSource;
use super::extent::names;
use super::page::Page;

const PROGRAM: &str = concat!("gdcm ", env!("CARGO_PKG_VERSION"));

/// What stands below the title.
pub(super) fn title_lines(source: &ReportSource) -> Vec<String> {
    let study = source.study.as_ref().map_or(String::new(), |study| format!("Study {study}. "));
    vec![format!("{study}Dataset {}. Made by {PROGRAM}.", source.dataset)]
}

/// Adds the section on the files of the study.
pub(super) fn add_files(page: &mut Page, study: &Study, source: &ReportSource) {
    page.section("Provenance");
    let channels = |all: &[gdcm_core::dataset::Channel]| {
        let all: Vec<String> = all.iter().map(|channel| format!("{} [{}]", channel.name, channel.unit)).collect();
        all.join(", ")
    };
    let dataset = &study.dataset;
    page.facts([
        ("Dataset", dataset.name().to_owned()),
        ("Its file", source.dataset.clone()),
        ("SHA-256 of that file", source.sha256.clone()),
        ("Study", source.study.clone().unwrap_or_else(|| "not saved in a file".to_owned())),
        ("Program", PROGRAM.to_owned()),
        ("Inputs", channels(dataset.inputs())),
        ("Outputs", channels(dataset.outputs())),
    ]);
    dataset.description().lines().filter(|line| !line.trim().is_empty()).for_each(|line| page.paragraph(line));
    page.list(source.cautions.iter().map(|caution| format!("Caution about the file: {caution}.")));
}

/// Adds the section on the files of the models, where any is known.
pub(super) fn add_models(page: &mut Page, study: &Study) {
    let mut models: BTreeMap<[String; 5], Vec<String>> = BTreeMap::new();
    let mut unknown = 0;
    for condition in study.dataset.conditions() {
        for model in BundleKind::BOTH.into_iter().flat_map(|kind| condition.bundle(kind)) {
            match &model.source {
                Some(source) => {
                    models.entry(cells(source)).or_default().push(format!("{}: {}", condition.id(), model.name));
                }
                None => unknown += 1,
            }
        }
    }
    page.section("Sources of the models");
    if models.is_empty() {
        page.paragraph("The dataset does not say which files its models were made from.");
        return;
    }
    let columns = ["file", "SHA-256", "variable", "made", "note", "models, by condition"];
    let mut table = Table::new("The files that the models were made from", columns);
    for (cells, of) in models {
        table.row(cells.into_iter().chain([names(&of)]));
    }
    page.table(&table);
    if unknown > 0 {
        page.paragraph(&format!("Of {unknown} models the dataset does not say."));
    }
}

fn cells(source: &Provenance) -> [String; 5] {
    let Provenance { file, sha256, variable, made, note, records } = source;
    let records = Some(format!("records {}", records.join(", "))).filter(|_| !records.is_empty());
    let variable = variable.clone().or(records);
    [file, sha256, &variable, made, note].map(|part| part.clone().unwrap_or_default())
}
