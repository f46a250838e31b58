//! The models of one bundle.

use gdcm_core::dataset::{BundleKind, ModelId};
use gdcm_core::fidelity::SUGGESTION_RATIO;
use gdcm_core::study::{ConditionAnalysis, Study, Table};

use super::extent::models_shown;
use super::page::Page;
use crate::figure::decimals;

/// Adds the table of a bundle's models; of a long bundle, of those that matter most.
pub(super) fn add_models(page: &mut Page, study: &Study, result: &ConditionAnalysis, kind: BundleKind) {
    let models = result.condition.bundle(kind);
    let shown = models_shown(study, result, kind);
    let is_physics = kind == BundleKind::Physics;
    let columns = ["model", "kept", "order", "mean distance [√J]", "discontinuity ratio"];
    let columns = if is_physics { &columns[..] } else { &columns[..4] };
    let mut table = Table::new(format!("Condition {}: {kind} models", result.condition.id()), columns.iter().copied());
    for &index in &shown {
        let model = &models[index];
        let ratio = result.discontinuity_ratio(&model.name).filter(|_| is_physics);
        let mark = if ratio.is_some_and(|ratio| ratio > SUGGESTION_RATIO) { " (suspect)" } else { "" };
        table.row([
            model.name.clone(),
            kept_word(study, result, kind, &model.name).to_owned(),
            model.order().map_or("–".to_owned(), |order| order.to_string()),
            result.score(kind, &model.name).map_or("–".to_owned(), |score| decimals(score, 2)),
            ratio.map_or("–".to_owned(), |ratio| format!("{}{mark}", decimals(ratio, 2))),
        ]);
    }
    page.table(&table);
    if shown.len() < models.len() {
        page.paragraph(&format!("{} of {} {kind} models are listed and drawn.", shown.len(), models.len()));
    }
}

fn kept_word(study: &Study, result: &ConditionAnalysis, kind: BundleKind, name: &str) -> &'static str {
    let id = ModelId::new(result.condition.id(), kind, name);
    if study.is_rejected(&id) {
        "rejected"
    } else if result.cautions.iter().any(|caution| caution.is_set_aside(kind, name)) {
        "set aside"
    } else if result.representative_name(kind) == name {
        "represents"
    } else {
        "yes"
    }
}
