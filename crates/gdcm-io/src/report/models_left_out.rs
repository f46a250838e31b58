//! Report section on the models that do not enter the results, and on those suggested as outliers.
//!
//! A model does not enter the results if the analyst *rejects* it, or if the analysis *sets it
//! aside*, because it lacks a response that other models have (M5). A physics model's
//! *discontinuity ratio* compares its distances from the other models with those that the
//! perturbations explain (M5); a model above the limit is suggested as an outlier.

use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_model::dataset::{BundleKind, Condition, ModelId};
use gdcm_model::number_format::decimals;
use gdcm_study::Analysis;
use gdcm_study::results::caution::Caution;
use gdcm_words::Table;
use gdcm_words::caution::caution_text;

use super::page::Page;
use super::wording::{MISSING, NAMES_SHOWN, counted_are, names};

/// Adds the section on models left out: rejected ones with the analyst's reasons, those set aside,
/// those kept although suggested as outliers, and those that the analyst chose as representatives.
pub(super) fn add_models_left_out(page: &mut Page, analysis: &Analysis) {
    page.section("Models left out");
    let rejected = rejected_table(analysis);
    if rejected.rows.is_empty() {
        page.paragraph("No model is rejected.");
    } else {
        page.paragraph(&format!(
            "Only the analyst can reject a model. A model with a discontinuity ratio above \
            {SUGGESTION_RATIO} is suggested as an outlier."
        ));
    }
    page.table(&rejected);
    let mut lines = Vec::new();
    for condition in analysis.study.dataset.conditions() {
        lines.extend(left_out_lines(analysis, condition));
    }
    page.list(lines);
}

/// Reason in the table for a model that was rejected without one.
const NO_REASON: &str = "no reason was given";

fn rejected_table(analysis: &Analysis) -> Table {
    let columns = [
        "condition",
        "bundle",
        "model",
        "discontinuity ratio",
        "analyst's reason",
    ];
    let mut table = Table::new("Rejected models", columns);
    for condition in analysis.study.dataset.conditions() {
        for kind in BundleKind::BOTH {
            rejected_rows(analysis, condition, kind, &mut table);
        }
    }
    table
}

/// Adds a row for each rejected model. Only the first [`NAMES_SHOWN`] models without a reason are
/// listed; the others are counted.
fn rejected_rows(analysis: &Analysis, condition: &Condition, kind: BundleKind, table: &mut Table) {
    let study = &analysis.study;
    let result = analysis.condition(condition.id());
    let mut without_reason = 0;
    for model in condition.bundle(kind) {
        let id = ModelId::new(condition.id(), kind, &model.name);
        if !study.is_rejected(&id) {
            continue;
        }
        let reason = study.reason(&id);
        if reason.is_none() {
            without_reason += 1;
            if without_reason > NAMES_SHOWN {
                continue;
            }
        }
        let ratio = match result {
            Some(result) if kind == BundleKind::Physics => result.discontinuity_ratio(&model.name),
            _ => None,
        };
        table.row([
            condition.id().to_string(),
            kind.to_string(),
            model.name.clone(),
            ratio.map_or(MISSING.to_owned(), |ratio| decimals(ratio, 2)),
            reason.unwrap_or(NO_REASON).to_owned(),
        ]);
    }
    if without_reason > NAMES_SHOWN {
        table.row([
            condition.id().to_string(),
            kind.to_string(),
            format!("{} more", without_reason - NAMES_SHOWN),
            MISSING.to_owned(),
            NO_REASON.to_owned(),
        ]);
    }
}

/// Describes a condition's models that are set aside, kept although suggested as outliers, or
/// pinned by the analyst, that is, chosen as representatives.
fn left_out_lines(analysis: &Analysis, condition: &Condition) -> Vec<String> {
    let study = &analysis.study;
    let id = condition.id();
    let Some(result) = analysis.condition(id) else {
        return Vec::new();
    };
    let mut lines = Vec::new();
    let mut set_aside = 0;
    for caution in &result.cautions {
        if let Caution::SetAside { .. } = caution {
            set_aside += 1;
            if set_aside <= NAMES_SHOWN {
                let words = caution_text(caution, |pair| study.dataset.pair_name(pair));
                lines.push(format!("Condition {id}: {words}."));
            }
        }
    }
    if set_aside > NAMES_SHOWN {
        let more = set_aside - NAMES_SHOWN;
        lines.push(format!(
            "Condition {id}: {} set aside.",
            counted_are(more, "more model")
        ));
    }
    let rejected = &study.choice(id).physics.rejected;
    let mut kept = result.suggested();
    kept.retain(|name| !rejected.contains(name));
    if !kept.is_empty() {
        lines.push(format!(
            "Condition {id}: models kept although they are suggested as outliers: {}.",
            names(&kept)
        ));
    }
    for kind in BundleKind::BOTH {
        if let Some(pinned) = &study.choice(id).bundle(kind).pinned {
            lines.push(format!(
                "Condition {id}: the analyst chose \"{pinned}\" to represent the {kind} models."
            ));
        }
    }
    lines
}
