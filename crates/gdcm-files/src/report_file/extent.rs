//! How much of a long list a report shows: a page is to be read.

use std::collections::BTreeSet;

use gdcm_core::dataset::{BundleKind, ModelId};
use gdcm_core::study::{ConditionAnalysis, Study};

/// Conditions that have figures; all have tables.
pub(super) const CONDITIONS_DRAWN: usize = 60;
/// Responses of a kind that have figures.
pub(super) const PAIRS_DRAWN: usize = 40;
/// Responses that a table of all of them may have; beyond, it has the on-axis and the held ones.
pub(super) const PAIRS_LISTED: usize = 48;
/// Models of a bundle that are listed and drawn.
pub(super) const MODELS_SHOWN: usize = 40;
/// Names in a sentence.
pub(super) const NAMES_SHOWN: usize = 12;

/// Names with commas; of many, the first, and how many more there are.
pub(super) fn names<S: AsRef<str>>(all: &[S]) -> String {
    let shown = all.iter().take(NAMES_SHOWN).map(AsRef::as_ref).collect::<Vec<_>>().join(", ");
    match all.len().saturating_sub(NAMES_SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// The models of a bundle that are listed and drawn, by their places: all of a short one; of a long one the representative, the nominal
/// and the suggested ones, the rejected ones, then the others, evenly over the bundle.
pub(super) fn models_shown(study: &Study, result: &ConditionAnalysis, kind: BundleKind) -> BTreeSet<usize> {
    let models = result.condition.bundle(kind);
    if models.len() <= MODELS_SHOWN {
        return (0..models.len()).collect();
    }
    let suggested = result.suggested();
    let id = |index: usize| ModelId::new(result.condition.id(), kind, &models[index].name);
    let matters = |index: &usize| {
        let name = &models[*index].name;
        let is_suggested = kind == BundleKind::Physics && suggested.contains(name);
        models[*index].is_nominal() || result.representative_name(kind) == name || is_suggested
    };
    let rejected = (0..models.len()).filter(|&index| study.is_rejected(&id(index))).take(MODELS_SHOWN / 2);
    let first = (0..models.len()).filter(matters).chain(rejected);
    let evenly = (0..MODELS_SHOWN).map(|part| part * models.len() / MODELS_SHOWN);
    let mut shown = BTreeSet::new();
    for index in first.chain(evenly) {
        if shown.len() < MODELS_SHOWN {
            shown.insert(index);
        }
    }
    shown
}

/// The models of a condition that are not drawn.
pub(super) fn models_hidden(study: &Study, result: &ConditionAnalysis) -> BTreeSet<ModelId> {
    let of_bundle = |kind: BundleKind| {
        let shown = models_shown(study, result, kind);
        let models = result.condition.bundle(kind).iter().enumerate();
        let hidden = models.filter(move |(index, _)| !shown.contains(index));
        hidden.map(move |(_, model)| ModelId::new(result.condition.id(), kind, &model.name))
    };
    BundleKind::BOTH.into_iter().flat_map(of_bundle).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_names_the_first_are_given_and_the_others_counted() {
        assert_eq!(names(&["a", "b"]), "a, b");
        let many: Vec<String> = (0..1000).map(|number| number.to_string()).collect();
        assert!(names(&many).ends_with("10, 11 and 988 more"), "{}", names(&many));
    }
}
