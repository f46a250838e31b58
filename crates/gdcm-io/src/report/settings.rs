//! Report section on the study's settings.

use gdcm_model::dataset::{Dataset, PairTable};
use gdcm_study::Study;
use gdcm_study::decisions::setting_table;
use gdcm_study::decisions::setting_table::SETTINGS;
use gdcm_words::gain_source::gain_source_text;

use super::page::Page;
use super::wording::{capital, names};

/// Adds the section on the settings: on-axis, constrained and ignored responses, then every setting
/// that applies to the study.
pub(super) fn add_settings(page: &mut Page, study: &Study) {
    page.section("Settings");
    let settings = &study.settings;
    let dataset = &study.dataset;
    page.facts([
        ("On-axis responses", pair_names(dataset, dataset.on_axis())),
        ("Held", pair_names(dataset, &settings.constrained)),
        (
            "Ignored in the objective",
            pair_names(dataset, &settings.ignored),
        ),
    ]);
    let mut facts: Vec<(String, String)> = Vec::new();
    for row in SETTINGS {
        if !(row.control.applies)(study) {
            continue;
        }
        let words = if *row == setting_table::GAIN_SOURCE {
            gain_source_text(settings)
        } else {
            row.current_text(settings)
        };
        facts.push((capital(row.name), words));
    }
    page.facts(
        facts
            .iter()
            .map(|(name, words)| (name.as_str(), words.clone())),
    );
}

/// Lists the marked responses by name.
fn pair_names(dataset: &Dataset, marked: &PairTable<bool>) -> String {
    let pairs: Vec<String> = marked
        .marked()
        .map(|pair| dataset.pair_name(pair))
        .collect();
    if pairs.is_empty() {
        "none".to_owned()
    } else {
        names(&pairs)
    }
}
