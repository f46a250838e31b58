//! The models in use, with their indices: all, or grouped by condition.

use std::collections::BTreeMap;

use super::part::Part;

/// A model that is not left out, and its index among all models.
#[derive(Clone, Copy)]
pub(super) struct IndexedPart<'p> {
    pub index: usize,
    pub part: &'p Part,
}

/// Returns the models that are not left out.
pub(super) fn parts_in_use(parts: &[Part]) -> Vec<IndexedPart<'_>> {
    let mut in_use = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        if !part.row.left_out {
            in_use.push(IndexedPart { index, part });
        }
    }
    in_use
}

/// Groups the models in use by condition, in ascending order; models without a condition are
/// skipped.
pub(super) fn parts_by_condition(parts: &[Part]) -> BTreeMap<i64, Vec<IndexedPart<'_>>> {
    let mut conditions: BTreeMap<i64, Vec<IndexedPart<'_>>> = BTreeMap::new();
    for part in parts_in_use(parts) {
        if let Some(condition) = part.part.row.condition {
            conditions.entry(condition).or_default().push(part);
        }
    }
    conditions
}
