//! Models fitted without one record each, by a damped step (M14.5).

use gdcm_model::executor::each;

use super::blocks::BlockModel;
use super::cost::Likelihood;
use super::normal_system::{NormalSystem, system_of_record};
use super::refinement::{DampedStart, FIRST_DAMPING, Fit};

/// A model fitted to all records but one.
pub(crate) struct ModelWithoutRecord {
    /// Index of the record, counted from 0.
    pub(crate) record: usize,
    pub(crate) model: BlockModel,
}

/// Computes a model for each record, fitted without that record, by a damped step with the given
/// normal systems.
///
/// ```text
/// (G - G_r + lambda diag) d = g - g_r
/// lambda = 1e-4, times 8 until the cost over the other records falls
/// ```
///
/// An undamped step diverges in weakly determined directions. Returns no models for a single
/// record.
pub(crate) fn without_each_record(
    likelihood: &Likelihood,
    fit: &Fit,
    systems: &[NormalSystem],
) -> Vec<ModelWithoutRecord> {
    let records = likelihood.records();
    if records.len() < 2 {
        return Vec::new();
    }
    let whole = NormalSystem::sum(fit.model.parameters(), systems);
    each(likelihood.executor, records, |record| {
        let system = whole.without(&system_of_record(likelihood, record, systems));
        let cost = likelihood
            .segments
            .iter()
            .zip(&fit.parts)
            .filter(|(segment, _)| segment.record != record)
            .map(|(_, part)| part.cost)
            .sum();
        let start = DampedStart {
            model: &fit.model,
            system: &system,
            cost,
            damping: FIRST_DAMPING,
        };
        // If no step lowers the cost, the full model is also the best without the record.
        let model = match start.step(&likelihood.without(record)) {
            Some(step) => step.model,
            None => fit.model.clone(),
        };
        ModelWithoutRecord { record, model }
    })
}
