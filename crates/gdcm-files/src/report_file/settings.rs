//! Every setting that changes a result.

use gdcm_core::dataset::{Pair, PairTable};
use gdcm_core::fidelity::CostAverage;
use gdcm_core::schedule::{ScheduleKind, ScheduleSettings, ScheduledQuantity};
use gdcm_core::study::{SETTINGS, Study, setting};
use gdcm_core::units::number;

use super::assessment::capital;
use super::extent::names;
use super::page::Page;

/// Adds the section: which responses are held and ignored, then every setting that has an effect.
pub(super) fn add(page: &mut Page, study: &Study) {
    page.section("Settings");
    let (settings, dataset) = (&study.settings, &study.dataset);
    let pairs = |marked: &PairTable<bool>| {
        let found: Vec<String> = marked.marked().map(|pair: Pair| dataset.pair_name(pair)).collect();
        if found.is_empty() { "none".to_owned() } else { names(&found) }
    };
    page.facts([
        ("On-axis responses", pairs(dataset.on_axis())),
        ("Held exactly", pairs(&settings.constrained)),
        ("Ignored in the objective", pairs(&settings.ignored)),
    ]);
    let in_effect = SETTINGS.into_iter().filter(|setting| (setting.control.applies)(study));
    let words = in_effect.map(|row| {
        let words = if *row == setting::GAIN_SOURCE { settings.gain_source_words() } else { row.words(settings) };
        (capital(row.name), words)
    });
    let words: Vec<(String, String)> = words.collect();
    page.facts(words.iter().map(|(name, words)| (name.as_str(), words.clone())));
}

/// `the median`, or `the mean`.
pub(super) fn average_word(average: CostAverage) -> &'static str {
    match average {
        CostAverage::Median => "the median",
        CostAverage::Mean => "the mean",
    }
}

/// The form of a schedule in words.
pub(super) fn schedule_words(settings: &ScheduleSettings) -> String {
    let kind = match settings.kind {
        ScheduleKind::Polynomial { degree } => format!("polynomial of degree {degree} in airspeed"),
        ScheduleKind::Table => "table over airspeed, linear between its points".to_owned(),
    };
    let of = match settings.quantity {
        ScheduledQuantity::LnGain => "ln k",
        ScheduledQuantity::Gain => "k",
    };
    let delays = if settings.delays { "delays are scheduled too" } else { "delays are not scheduled" };
    let second = settings.second.map_or_else(String::new, |variable| format!(" and {variable}"));
    format!("{kind}{second}, of {of}; airspeeds within {} kt are one; {delays}", number(settings.airspeed_tolerance_kt))
}
