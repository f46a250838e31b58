//! The models that take no part: rejected ones with the analyst's reasons, those set aside, and those that are suspected.

use gdcm_core::dataset::{BundleKind, Condition, ModelId};
use gdcm_core::fidelity::SUGGESTION_RATIO;
use gdcm_core::study::{Analysis, Caution, Table};

use super::extent::{NAMES_SHOWN, names};
use super::page::Page;
use crate::figure::decimals;

const NO_REASON: &str = "no reason was given";

/// Adds the section.
pub(super) fn add(page: &mut Page, analysis: &Analysis) {
    page.section("Models left out");
    let rejected = rejected_table(analysis);
    if rejected.rows.is_empty() {
        page.paragraph("No model is rejected.");
    } else {
        page.paragraph(&format!(
            "Only the analyst rejects a model. A discontinuity ratio above {SUGGESTION_RATIO} makes it suspect."
        ));
    }
    page.table(&rejected);
    let lines: Vec<String> = analysis.study.dataset.conditions().iter().flat_map(|of| lines(analysis, of)).collect();
    page.list(lines);
}

fn rejected_table(analysis: &Analysis) -> Table {
    let columns = ["condition", "bundle", "model", "discontinuity ratio", "reason of the analyst"];
    let mut table = Table::new("Rejected models", columns);
    for condition in analysis.study.dataset.conditions() {
        for kind in BundleKind::BOTH {
            rows(analysis, condition, kind, &mut table);
        }
    }
    table
}

/// A row for each rejected model; of many without a reason the last are counted.
fn rows(analysis: &Analysis, condition: &Condition, kind: BundleKind, table: &mut Table) {
    let study = &analysis.study;
    let id = |name: &str| ModelId::new(condition.id(), kind, name);
    let result = analysis.condition(condition.id());
    let rejected = condition.bundle(kind).iter().filter(|model| study.is_rejected(&id(&model.name)));
    let (mut bare, mut more) = (0, 0);
    for model in rejected {
        let reason = study.reason(&id(&model.name));
        bare += usize::from(reason.is_none());
        if reason.is_none() && bare > NAMES_SHOWN {
            more += 1;
            continue;
        }
        let ratio = result.filter(|_| kind == BundleKind::Physics);
        let ratio = ratio.and_then(|result| result.discontinuity_ratio(&model.name));
        let ratio = ratio.map_or("–".to_owned(), |ratio| decimals(ratio, 2));
        let reason = reason.unwrap_or(NO_REASON).to_owned();
        table.row([condition.id().to_string(), kind.to_string(), model.name.clone(), ratio, reason]);
    }
    if more > 0 {
        let model = format!("{more} more");
        table.row([condition.id().to_string(), kind.to_string(), model, "–".to_owned(), NO_REASON.to_owned()]);
    }
}

/// What is set aside in a condition, what is suspected and kept all the same, and what was pinned.
fn lines(analysis: &Analysis, condition: &Condition) -> Vec<String> {
    let (study, id) = (&analysis.study, condition.id());
    let Some(result) = analysis.condition(id) else { return Vec::new() };
    let aside = result.cautions.iter().filter(|caution| matches!(caution, Caution::SetAside { .. }));
    let aside: Vec<String> = aside.map(|caution| caution.words(|pair| study.dataset.pair_name(pair))).collect();
    let more = aside.len().saturating_sub(NAMES_SHOWN);
    let mut lines: Vec<String> =
        aside.into_iter().take(NAMES_SHOWN).map(|words| format!("Condition {id}: {words}.")).collect();
    if more > 0 {
        lines.push(format!("Condition {id}: {more} more models are set aside."));
    }
    let rejected = &study.choice(id).physics.rejected;
    let kept: Vec<String> = result.suggested().into_iter().filter(|name| !rejected.contains(name)).collect();
    if !kept.is_empty() {
        lines.push(format!("Condition {id}: suspected by their discontinuity ratios, and kept: {}.", names(&kept)));
    }
    for kind in BundleKind::BOTH {
        if let Some(pinned) = &study.choice(id).bundle(kind).pinned {
            lines.push(format!("Condition {id}: the analyst chose \"{pinned}\" to represent the {kind} models."));
        }
    }
    lines
}
