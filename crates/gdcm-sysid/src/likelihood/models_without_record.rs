//! Models fitted without one record each, by a damped step (M14.5).

use gdcm_model::executor::each;

use super::cost::Likelihood;
use super::descent::Fit;
use super::local_system::{LocalSystem, LocalSystems};
use super::schur_model::SchurModel;

/// Damping at the first attempt.
const FIRST_DAMPING: f64 = 1e-4;
/// Factor on the damping after a step that does not lower the cost.
const DAMPING_FACTOR: f64 = 8.0;
/// Number of times that the damping is increased before giving up.
const FAILURES: usize = 8;

/// A model fitted to all records but one.
pub(crate) struct ModelWithoutRecord {
    /// Record index, from 0.
    pub(crate) record: usize,
    pub(crate) model: SchurModel,
}

/// Computes a model for each record, fitted without that record, by a damped step with the given
/// normal systems.
///
/// ```text
/// G, g normal equations of all records at the fitted model, G_r, g_r of record r (`local_system`)
/// (G' + lambda diag G') d = g - g_r,   G' = G - G_r: without the record r
/// lambda = 1e-4, times 8 until the cost over the other records falls, at most 8 times;
/// if it does not fall, the model is that fitted to all records
/// ```
///
/// An undamped step diverges in weakly determined directions. Returns no models for a single
/// record.
pub(crate) fn without_each_record(
    likelihood: &Likelihood,
    fit: &Fit,
    systems: &LocalSystems,
) -> Vec<ModelWithoutRecord> {
    let records = likelihood.records();
    if records.len() < 2 {
        return Vec::new();
    }
    let whole = systems.whole();
    each(likelihood.executor, records, |record| {
        let system = whole.without(&systems.of_record(record));
        let cost = likelihood
            .segments
            .iter()
            .zip(&fit.parts)
            .filter(|(segment, _)| segment.record != record)
            .map(|(_, part)| part.cost)
            .sum();
        let others = likelihood.without(record);
        let model = stepped(&others, fit, systems, &system, cost);
        ModelWithoutRecord {
            record,
            model: model.unwrap_or_else(|| fit.model.clone()),
        }
    })
}

/// Returns the model after the first damped step that lowers the cost over `others` below `cost`.
fn stepped(
    others: &Likelihood,
    fit: &Fit,
    systems: &LocalSystems,
    system: &LocalSystem,
    cost: f64,
) -> Option<SchurModel> {
    let mut damping = FIRST_DAMPING;
    for _ in 0..=FAILURES {
        if let Some(step) = system.damped_step(damping)
            && let Some(model) = fit.model.stepped(&systems.parameters.step(&step))
            && let Some(reached) = others.cost(&model)
            && reached < cost
        {
            return Some(model);
        }
        damping *= DAMPING_FACTOR;
    }
    None
}
