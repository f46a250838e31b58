//! Chooses which models of a long bundle the report lists and draws.

use std::collections::BTreeSet;

use gdcm_model::dataset::{BundleKind, ModelId};
use gdcm_study::{ConditionAnalysis, Study};

use super::limits::MODELS_SHOWN;

/// Returns the indices of a bundle's models that are listed and drawn: all models if there are at
/// most [`MODELS_SHOWN`]; otherwise, up to this number, the representative, the nominal model and
/// suspected outliers, then rejected models (at most half), then models spread evenly over the
/// bundle.
pub(super) fn models_shown(
    study: &Study,
    result: &ConditionAnalysis,
    kind: BundleKind,
) -> BTreeSet<usize> {
    let models = result.condition.bundle(kind);
    if models.len() <= MODELS_SHOWN {
        return (0..models.len()).collect();
    }
    let suggested = result.suggested();
    let mut important = Vec::new();
    let mut rejected = Vec::new();
    for (index, model) in models.iter().enumerate() {
        let is_suggested = kind == BundleKind::Physics && suggested.contains(&model.name);
        let is_representative = result.representative_name(kind) == model.name;
        if model.is_nominal() || is_representative || is_suggested {
            important.push(index);
        }
        if study.is_rejected(&ModelId::new(result.condition.id(), kind, &model.name)) {
            rejected.push(index);
        }
    }
    rejected.truncate(MODELS_SHOWN / 2);
    let evenly = (0..MODELS_SHOWN).map(|part| part * models.len() / MODELS_SHOWN);
    let mut shown = BTreeSet::new();
    for index in important.into_iter().chain(rejected).chain(evenly) {
        if shown.len() < MODELS_SHOWN {
            shown.insert(index);
        }
    }
    shown
}

/// Returns a condition's models that are not drawn.
pub(super) fn models_hidden(study: &Study, result: &ConditionAnalysis) -> BTreeSet<ModelId> {
    let mut hidden = BTreeSet::new();
    for kind in BundleKind::BOTH {
        let shown = models_shown(study, result, kind);
        for (index, model) in result.condition.bundle(kind).iter().enumerate() {
            if !shown.contains(&index) {
                hidden.insert(ModelId::new(result.condition.id(), kind, &model.name));
            }
        }
    }
    hidden
}
