//! Error bar for a requirement's metric from the bundles' other models (M13, M17.1): the metric is
//! computed again with each other model instead of the representative.

use crate::uncertainty::{Bar, IdentificationSource, VarianceComponent};

/// Computes the error bar for `value`, a non-negative metric from the two representatives (M13.1,
/// M13.3). The entries in `physics` and `identified` are the metric with that representative
/// replaced by another model from its bundle; `None` if the metric does not exist, which the bar
/// counts as left out.
pub fn substitution_bar(value: f64, physics: &[Option<f64>], identified: &[Option<f64>]) -> Bar {
    let left_out = physics
        .iter()
        .chain(identified)
        .filter(|other| other.is_none())
        .count();
    Bar {
        value,
        trim: substitution_variance(value, physics),
        identification: substitution_variance(value, identified),
        source: IdentificationSource::Spread,
        left_out,
        range: [0.0, f64::INFINITY],
    }
}

/// Returns the variance of the changes from `value` to each of `others`.
fn substitution_variance(value: f64, others: &[Option<f64>]) -> Option<VarianceComponent> {
    let changes: Vec<f64> = others.iter().flatten().map(|other| other - value).collect();
    VarianceComponent::from_changes(&changes)
}
