//! G, D and J of the responses of one condition.

use gdcm_core::dataset::Pair;
use gdcm_core::study::{ConditionAnalysis, Study, Table};
use gdcm_core::units::{s_to_ms, signed};

use super::extent::{PAIRS_LISTED, names};
use super::page::Page;
use crate::figure::decimals;

const COLUMNS: [&str; 11] = [
    "response",
    "on-axis",
    "treated as",
    "G",
    "net gain",
    "D [ms]",
    "net delay [ms]",
    "J before",
    "J after",
    "ΔJ magnitude",
    "ΔJ phase",
];

/// Adds the table of the responses, and why some of them have no G and no D.
pub(super) fn add_responses(page: &mut Page, study: &Study, result: &ConditionAnalysis) {
    let all: Vec<Pair> = study.dataset.on_axis().pairs().collect();
    let measuring = study.dataset.measuring_pairs();
    let matters = |pair: &Pair| all.len() <= PAIRS_LISTED || measuring[*pair] || study.settings.constrained[*pair];
    let shown: Vec<Pair> = all.iter().copied().filter(matters).collect();
    let id = result.condition.id();
    let title = format!("Condition {id}: G, D and J of the representative before and after its own correction");
    let mut table = Table::new(title, COLUMNS);
    shown.iter().for_each(|pair| table.row(cells(study, result, *pair)));
    page.table(&table);
    if shown.len() < all.len() {
        page.paragraph(&format!(
            "Not listed: {} responses that are neither on-axis nor held.",
            all.len() - shown.len()
        ));
    }
    page.list(undefined(study, result));
}

fn cells(study: &Study, result: &ConditionAnalysis, pair: Pair) -> [String; 11] {
    let cost = result.cost[pair];
    let is_defined = result.wanted_gain(pair).is_some();
    let treated = match (is_defined, result.held()[pair], !study.settings.ignored[pair]) {
        (false, ..) => "no G, no D",
        (true, true, _) => "held",
        (true, false, true) => "fitted",
        (true, false, false) => "ignored",
    };
    let of = |value: Option<f64>, digits: usize| value.map_or("–".to_owned(), |value| decimals(value, digits));
    let change = |value: Option<f64>| value.map_or("–".to_owned(), |value| signed(value, 1));
    [
        study.dataset.pair_name(pair),
        if study.dataset.on_axis()[pair] { "yes" } else { "no" }.to_owned(),
        treated.to_owned(),
        of(result.wanted_gain(pair), 3),
        of(Some(result.correction.net_gain(pair).value()), 3),
        of(result.wanted_delay_s(pair).map(s_to_ms), 1),
        of(Some(s_to_ms(result.correction.net_delay(pair).value_s())), 1),
        of(cost.map(|cost| cost.uncorrected.total()), 1),
        of(cost.map(|cost| cost.corrected.total()), 1),
        change(cost.map(|cost| cost.magnitude())),
        change(cost.map(|cost| cost.phase())),
    ]
}

/// A sentence for each reason why responses have no G and no D.
fn undefined(study: &Study, result: &ConditionAnalysis) -> Vec<String> {
    let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
    for (pair, why) in result.comparison.undefined.iter() {
        let Some(why) = why.map(|why| why.words()) else { continue };
        let name = study.dataset.pair_name(pair);
        match reasons.iter_mut().find(|(known, _)| *known == why) {
            Some((_, pairs)) => pairs.push(name),
            None => reasons.push((why, vec![name])),
        }
    }
    let sentence = |(why, pairs): (String, Vec<String>)| format!("No G and no D of {}: {why}.", names(&pairs));
    reasons.into_iter().map(sentence).collect()
}
