//! The bundle of models: the chosen order, its neighbours, and one model without each record (M14, section 5).

use super::blocks::BlockModel;
use super::likelihood::Likelihood;
use super::normal_system::NormalSystem;
use super::polish::{Fit, damped};
use crate::executor::each;

/// Damping at the beginning of a step that leaves a record out.
const FIRST_DAMPING: f64 = 1e-4;

/// The model that a record's absence leaves.
#[derive(Clone, Debug)]
pub(super) struct WithoutRecord {
    /// Which record, counted from 0.
    pub(super) record: usize,
    /// The model.
    pub(super) model: BlockModel,
}

/// The models without one record each, by one damped step with the systems that are there already.
///
/// ```text
/// (G - G_r + lambda diag) d = g - g_r;  lambda = 1e-4, times 8 until the cost over the other records falls
/// ```
///
/// An undamped step runs away in weak directions. With one record there is none.
pub(super) fn without_each_record(likelihood: &Likelihood, fit: &Fit, systems: &[NormalSystem]) -> Vec<WithoutRecord> {
    let records = likelihood.records();
    if records.len() < 2 {
        return Vec::new();
    }
    let sum = |keep: &dyn Fn(usize) -> bool| {
        let mut sum = NormalSystem::zero(fit.model.parameters());
        let pieces = likelihood.pieces.iter().zip(systems);
        pieces.filter(|(piece, _)| keep(piece.record)).for_each(|(_, system)| sum.add(system));
        sum
    };
    let all = sum(&|_| true);
    let without = |&record: &usize| {
        let rest = likelihood.without(record);
        let system = all.without(&sum(&|other| other == record));
        let pieces = likelihood.pieces.iter().zip(&fit.parts);
        let cost = pieces.filter(|(piece, _)| piece.record != record).map(|(_, part)| part.cost).sum();
        // Where no step lowers the cost the full model is the best without the record as well.
        let stepped = damped(&rest, &fit.model, &system, cost, FIRST_DAMPING);
        WithoutRecord { record, model: stepped.map_or_else(|| fit.model.clone(), |(model, ..)| model) }
    };
    each(likelihood.executor, &records, without)
}

/// How far two models are apart: the cost `J` of M4 (medians over frequency), averaged over the pairs that are identified.
///
/// ```text
/// J = 20 median (dB)^2 + 20 * 0.0175 median (deg)^2
/// ```
pub(super) fn distance(one: &BlockModel, other: &BlockModel, omegas: &[f64], identified: &[(usize, usize)]) -> f64 {
    const MODULUS_WEIGHT: f64 = 20.0;
    const PHASE_WEIGHT: f64 = 20.0 * 0.0175;
    let ratios: Vec<_> =
        omegas.iter().map(|&omega| one.response(omega).zip_map(&other.response(omega), |a, b| a / b)).collect();
    let of_pair = |pair: &(usize, usize)| {
        let decibels = median(ratios.iter().map(|ratio| (20.0 * ratio[*pair].norm().log10()).powi(2)).collect());
        let degrees = median(ratios.iter().map(|ratio| ratio[*pair].arg().to_degrees().powi(2)).collect());
        MODULUS_WEIGHT * decibels + PHASE_WEIGHT * degrees
    };
    identified.iter().map(of_pair).sum::<f64>() / identified.len().max(1) as f64
}

/// The middle value, of an even number the mean of the middle two; 0 of none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let count = values.len();
    match count {
        0 => 0.0,
        count if count % 2 == 1 => values[count / 2],
        count => 0.5 * (values[count / 2 - 1] + values[count / 2]),
    }
}
