//! The order of the model, by the Bayesian information criterion with estimated dispersion (M14, section 4).
//!
//! ```text
//! BIC(n) = J (1 + k ln N / (N - k)),   k = n q + m l parameters that matter,   N degrees of freedom
//! 1  n = 16, or the nearest there is
//! 2  refinement n - 2, n, n + 2; n = argmin BIC; until n stays
//! ```
//!
//! A record that was held out decides between orders whose BIC differ by less than 1 %.

use super::*;
use crate::executor::each;
use std::collections::BTreeMap;

/// Order at which the search begins.
const FIRST: usize = 16;
/// Distance of neighbours.
const STEP: usize = 2;
/// Steps of the refinement while orders are compared.
const STEPS: usize = 3;
/// Orders whose criteria differ by less, relatively, are told apart by the held-out record.
const NEAR: f64 = 0.01;

/// Fits of the orders that were compared.
#[derive(Clone, Debug)]
pub(super) struct OrderSearch {
    /// By order.
    pub(super) fits: BTreeMap<usize, Fit>,
    /// BIC by order.
    pub(super) criteria: BTreeMap<usize, f64>,
    /// The chosen order.
    pub(super) order: usize,
    /// Whether the criterion still falls at the highest order there is.
    pub(super) still_falls: bool,
}

impl OrderSearch {
    /// The unrefined model with which the search begins.
    pub(super) fn first(starts: &BTreeMap<usize, Fit>) -> Option<&Fit> {
        starts.get(&first(starts)?)
    }

    /// The models of the orders n - 2 and n + 2, as far as they are there.
    pub(super) fn neighbours(&self) -> Vec<&BlockModel> {
        let near = [self.order.checked_sub(STEP), self.order.checked_add(STEP)];
        near.iter().flatten().filter_map(|order| self.fits.get(order)).map(|fit| &fit.model).collect()
    }
}

/// The order nearest to 16.
fn first(starts: &BTreeMap<usize, Fit>) -> Option<usize> {
    starts.keys().copied().min_by_key(|order| order.abs_diff(FIRST))
}

/// Parameters that matter: n (inputs + outputs) + inputs outputs.
pub(super) fn effective_parameters(fit: &Fit) -> usize {
    let (order, inputs, outputs) = (fit.model.order(), fit.model.b.ncols(), fit.model.c.nrows());
    order * (inputs + outputs) + inputs * outputs
}

/// `BIC` of a fit; none where it has more parameters than degrees of freedom.
fn criterion(fit: &Fit, likelihood: &Likelihood) -> Option<f64> {
    let (k, n) = (effective_parameters(fit) as f64, likelihood.freedom(fit.model.order()) as f64);
    (n > k).then(|| fit.cost * (1.0 + k * n.ln() / (n - k)))
}

/// Searches the order from the unrefined models `starts`; none where no model can be afforded.
pub(super) fn search_order(
    starts: &BTreeMap<usize, Fit>,
    likelihood: &Likelihood,
    held_out: &Likelihood,
    progress: &Shares,
) -> Result<Option<OrderSearch>, IdentificationError> {
    let Some(mut order) = first(starts) else { return Ok(None) };
    let (mut fits, mut criteria) = (BTreeMap::<usize, Fit>::new(), BTreeMap::new());
    loop {
        let near = [Some(order), order.checked_sub(STEP), order.checked_add(STEP)];
        let new: Vec<usize> =
            near.into_iter().flatten().filter(|n| starts.contains_key(n) && !fits.contains_key(n)).collect();
        let refinement = |n: &usize| starts[n].clone().refined(likelihood, STEPS, progress);
        for (&n, fit) in new.iter().zip(each(likelihood.executor, &new, refinement)) {
            let fit = fit?;
            if let Some(value) = criterion(&fit, likelihood) {
                criteria.insert(n, value);
            }
            fits.insert(n, fit);
        }
        let Some((&best, _)) = criteria.iter().min_by(|a, b| a.1.total_cmp(b.1)) else { return Ok(None) };
        let last = best == order || new.is_empty();
        order = best;
        if last {
            break;
        }
    }
    let still_falls = starts.keys().last() == Some(&order) && criteria.len() > 1;
    let order = by_held_out(&fits, &criteria, order, held_out);
    Ok(Some(OrderSearch { fits, criteria, order, still_falls }))
}

/// Of the orders whose criterion is as good as that of `best`, the one with the least cost on what was held out.
fn by_held_out(
    fits: &BTreeMap<usize, Fit>,
    criteria: &BTreeMap<usize, f64>,
    best: usize,
    held_out: &Likelihood,
) -> usize {
    if held_out.segments.is_empty() {
        return best;
    }
    let Some(least) = criteria.get(&best) else { return best };
    let near = criteria.iter().filter(|(_, value)| **value <= (1.0 + NEAR) * least);
    let costs = near.filter_map(|(order, _)| {
        let model = &fits.get(order)?.model;
        Some((*order, held_out.cost(model)? / held_out.freedom(model.order()).max(1) as f64))
    });
    costs.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(best, |(order, _)| order)
}
