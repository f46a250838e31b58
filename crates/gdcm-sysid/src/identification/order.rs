//! Searches the model order from above (M14.19), by the Bayesian information criterion with
//! estimated dispersion.
//!
//! ```text
//! BIC(n) = J (1 + k ln N / (N - k)),   k = n (m + l) + m l parameters (no coordinates),
//!                                      m inputs, l outputs, J cost, N degrees of freedom
//! delta^2 Newton decrement: the fall of J still expected in a descent (`descent`)
//! static part of removed states: their effect in steady state (`balancing`)
//!
//! 1  top = order of the minimum BIC before any refinement
//! 2  top model: noise from its residuals, descent, noise again, descent to the minimum (M14.20)
//! 3  with the same weights: one state less (two for m + l > 6 and n > 8), with or without its
//!    static part, whichever costs less; descent;  until BIC has exceeded the best twice in a row
//!    an order ends early if BIC(J - 3 delta^2) cannot reach the best
//! 4  if the top order is best: once more from the next available order
//! 5  of the orders within 3 % of the least BIC, the best without an unstable pole above the lines
//!    used; then the held-out records decide between the orders within 1 % of that; only orders
//!    that, like it, have or lack such a pole are compared
//! ```
//!
//! The weights remain those of the top order: a model that lacks a mode would take it for noise,
//! and hide it from BIC. With many records the search uses a part of them (`search_records`).

use std::collections::BTreeMap;

use nalgebra::Complex;

use gdcm_model::progress::{Cancelled, Shares};

use super::noise_weights::NoiseWeights;
use super::prepared_data::PreparedData;
use crate::identification_error::IdentificationError;
use crate::likelihood::balancing::without_last_states;
use crate::likelihood::cost::Likelihood;
use crate::likelihood::descent::{COMPARABLE, Fit, Limits, NEARLY_CONVERGED};
use crate::likelihood::schur_model::SchurModel;

/// The held-out records decide between orders whose criterion exceeds the best order's by at most
/// this share.
const NEAR: f64 = 0.01;
/// An order without a fast unstable pole is preferred to the best order if its criterion is worse
/// by at most this share.
const NEAR_UNSTABLE: f64 = 0.03;
/// Neighbouring orders count as equally plausible while their criterion exceeds the chosen order's
/// by at most this share (M14.5).
const NEIGHBOUR: f64 = 0.1;
/// Number of consecutive orders worse than the best after which the search ends.
const RISES: usize = 2;
/// Number of channels above which states are removed in pairs, from orders above [`SINGLE_ORDER`].
const SINGLE_CHANNELS: usize = 6;
/// Order up to which states are removed singly, however many channels there are.
const SINGLE_ORDER: usize = 8;

/// Result of comparing orders: the fit and the criterion for each, and the choice.
pub(crate) struct OrderSearch<'a> {
    /// Refined models by order, with the top order's weights.
    pub(crate) fits: BTreeMap<usize, Fit>,
    /// BIC by order.
    pub(crate) criteria: BTreeMap<usize, f64>,
    /// The chosen order.
    pub(crate) order: usize,
    /// Whether the criterion still decreases at the highest available order.
    pub(crate) still_falls: bool,
    /// The cost with the top order's weights.
    pub(crate) weights: NoiseWeights<'a>,
}

/// Fit of one order's refined model, with the weights from the order search.
///
/// Values at different orders are comparable. They differ slightly from the recommended model's
/// cost, because its weights are updated after the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderFit {
    pub order: usize,
    /// `J / (N - k)` over the records from which the order is searched.
    pub cost: f64,
    /// `J` per degree of freedom over the held-out records; `None` if no record is held out.
    pub held_out: Option<f64>,
}

impl OrderSearch<'_> {
    /// Returns the fit at each refined order. Orders that were given up before their minimum are
    /// left out.
    pub(crate) fn order_fits(&self, data: &PreparedData) -> Vec<OrderFit> {
        let mut order_fits = Vec::new();
        for (&order, fit) in &self.fits {
            if fit.decrement >= COMPARABLE {
                continue;
            }
            if let Some(cost) = fit.dispersion(&self.weights.likelihood) {
                order_fits.push(OrderFit {
                    order,
                    cost,
                    held_out: data.held_out_cost(&fit.model),
                });
            }
        }
        order_fits
    }

    /// Returns the order at which the search begins: the least criterion before any refinement;
    /// `None` without models.
    pub(crate) fn first(starts: &BTreeMap<usize, Fit>, likelihood: &Likelihood) -> Option<usize> {
        let mut criteria = BTreeMap::new();
        for (&order, fit) in starts {
            if let Some(value) = criterion(fit.cost, order, &fit.model, likelihood, likelihood) {
                criteria.insert(order, value);
            }
        }
        order_of_least(&criteria)
    }

    /// Returns, on each side, the model of the nearest order whose criterion is within 10 % of the
    /// chosen order's. Orders that were given up before their minimum are left out, because their
    /// models differ from the chosen one by more than the order.
    pub(crate) fn neighbours(&self) -> Vec<SchurModel> {
        let Some(best) = self.criteria.get(&self.order) else {
            return Vec::new();
        };
        let most = best * (1.0 + NEIGHBOUR);
        let near = |order: &usize| {
            self.fits
                .get(order)
                .is_some_and(|fit| fit.decrement < COMPARABLE)
                && self.criteria.get(order).is_some_and(|value| *value <= most)
        };
        let below = self
            .fits
            .keys()
            .rev()
            .find(|order| **order < self.order && near(order));
        let above = self
            .fits
            .keys()
            .find(|order| **order > self.order && near(order));
        let mut models = Vec::new();
        for order in below.into_iter().chain(above) {
            models.push(self.fits[order].model.clone());
        }
        models
    }
}

/// Returns k, or k' of M14.21 if inputs miss samples: half of the states of each segment's
/// transient then count as parameters as well. Beside a lightly damped mode, the transients of a
/// mode that does not exist and the missing inputs together follow the noise. The half was found on
/// 24 flights (seeds 5201 to 5224).
pub(super) fn counted_parameters(model: &SchurModel, likelihood: &Likelihood) -> f64 {
    let k = model.parameters() as f64;
    if !likelihood.misses_inputs() {
        return k;
    }
    k + 0.5 * (model.order() * likelihood.segments.len()) as f64
}

/// Computes a model's criterion from its cost over `likelihood`, extrapolated to the degrees of
/// freedom in `whole`; `None` if the parameters leave no degrees of freedom.
///
/// ```text
/// J over all records, estimated: r (J + k phi) - k phi
///     phi = J / (N - k),  r: N over all records / N, with J and N those of the likelihood
/// ```
///
/// k phi is the part of the noise that the parameters explain, with few records as with many; k is
/// that of [`counted_parameters`].
fn criterion(
    cost: f64,
    order: usize,
    model: &SchurModel,
    likelihood: &Likelihood,
    whole: &Likelihood,
) -> Option<f64> {
    let k = counted_parameters(model, likelihood);
    let used = likelihood.freedom(order) as f64;
    let n = whole.freedom(order) as f64;
    if used <= k {
        return None;
    }
    let explained = k * cost / (used - k);
    let whole_cost = n / used * (cost + explained) - explained;
    Some(whole_cost * (1.0 + k * n.ln() / (n - k)))
}

/// Returns the lowest order with the minimum value.
fn order_of_least(values: &BTreeMap<usize, f64>) -> Option<usize> {
    values
        .iter()
        .min_by(|a, b| a.1.total_cmp(b.1))
        .map(|(order, _)| *order)
}

impl<'a> PreparedData<'a> {
    /// Searches the order from the unrefined models `starts`; `None` if the data do not support any
    /// model.
    pub(crate) fn search_order(
        &self,
        starts: &BTreeMap<usize, Fit>,
        progress: &Shares,
    ) -> Result<Option<OrderSearch<'a>>, IdentificationError> {
        // Step 1.
        let Some(mut top) = OrderSearch::first(starts, &self.likelihood) else {
            return Ok(None);
        };
        loop {
            // Steps 2 and 3.
            let Some(descent) = self.descend_from(top, starts, progress)? else {
                return Ok(None);
            };
            let Some(best) = order_of_least(&descent.criteria) else {
                return Ok(None);
            };
            // Step 4.
            let higher = starts.range(top + 1..).next().map(|(order, _)| *order);
            let is_top_best = descent.fits.keys().next_back() == Some(&best);
            if let Some(higher) = higher
                && is_top_best
            {
                top = higher;
                continue;
            }
            // Step 5.
            return Ok(Some(OrderSearch {
                order: self.decide(&descent, best),
                still_falls: is_top_best && higher.is_none() && descent.criteria.len() > 1,
                fits: descent.fits,
                criteria: descent.criteria,
                weights: descent.weights,
            }));
        }
    }

    /// Converges the top order and removes states (steps 2 and 3).
    fn descend_from(
        &self,
        top: usize,
        starts: &BTreeMap<usize, Fit>,
        progress: &Shares,
    ) -> Result<Option<Descent<'a>>, Cancelled> {
        let Some((fit, weights)) = self.converge_top(&starts[&top].model, progress)? else {
            return Ok(None);
        };
        let mut descent = Descent {
            fits: BTreeMap::new(),
            criteria: BTreeMap::new(),
            weights,
            whole: self.likelihood.clone(),
        };
        // Not `top`: a start whose fast modes were removed has fewer states than the order it is
        // listed under.
        let mut order = fit.order();
        descent.insert(fit);
        let mut rises = 0;
        while let Some(next) = self.order_below(order, starts) {
            let best = descent.least();
            let Some(fit) = descent.reduced(order, order - next, progress)? else {
                break;
            };
            order = fit.order();
            descent.insert(fit);
            if descent
                .criteria
                .get(&order)
                .is_none_or(|value| *value > best)
            {
                rises += 1;
                if rises == RISES {
                    break;
                }
            } else {
                rises = 0;
            }
        }
        Ok(Some(descent))
    }

    /// Returns the order after `order` on the way down; `None` at the end.
    fn order_below(&self, order: usize, starts: &BTreeMap<usize, Fit>) -> Option<usize> {
        if self.are_orders_given {
            return starts.range(..order).next_back().map(|(next, _)| *next);
        }
        let channels = self.scales.inputs.len() + self.scales.outputs.len();
        let removed = if channels > SINGLE_CHANNELS && order > SINGLE_ORDER {
            2
        } else {
            1
        };
        order.checked_sub(removed).filter(|next| *next > 0)
    }

    /// Converges the top order's model, with noise from its own residuals (step 2).
    fn converge_top(
        &self,
        start: &SchurModel,
        progress: &Shares,
    ) -> Result<Option<(Fit, NoiseWeights<'a>)>, Cancelled> {
        let mut weights = NoiseWeights::measured(self);
        let Some(mut fit) = Fit::start(&weights.likelihood, start.clone()) else {
            return Ok(None);
        };
        for limit in [NEARLY_CONVERGED, COMPARABLE] {
            let Some(updated) = weights.updated(self, &fit) else {
                return Ok(None);
            };
            weights = updated;
            let Some(start) = Fit::start(&weights.likelihood, fit.model) else {
                return Ok(None);
            };
            fit = start.descended(&weights.likelihood, Limits::to(limit), progress)?;
        }
        Ok(Some((fit, weights)))
    }

    /// Decides between orders with nearly the same criterion as `best` (step 5).
    fn decide(&self, descent: &Descent, best: usize) -> usize {
        let near = within(&descent.criteria, best, NEAR_UNSTABLE);
        let sound: BTreeMap<usize, f64> = near
            .into_iter()
            .filter(|(order, _)| self.is_sound(descent, *order))
            .collect();
        let best = order_of_least(&sound).unwrap_or(best);
        if self.held_out.segments.is_empty() {
            return best;
        }
        let mut held_out_costs = BTreeMap::new();
        for order in within(&descent.criteria, best, NEAR).into_keys() {
            if self.is_sound(descent, order) != self.is_sound(descent, best) {
                continue;
            }
            if let Some(fit) = descent.fits.get(&order)
                && let Some(cost) = self.held_out_cost(&fit.model)
            {
                held_out_costs.insert(order, cost);
            }
        }
        order_of_least(&held_out_costs).unwrap_or(best)
    }

    /// Returns whether the model at an order has no fast unstable pole.
    fn is_sound(&self, descent: &Descent, order: usize) -> bool {
        descent
            .fits
            .get(&order)
            .is_some_and(|fit| fast_unstable_pole(fit.model.poles(), self.highest).is_none())
    }

    /// Computes a model's cost per degree of freedom over the held-out records; `None` without any.
    fn held_out_cost(&self, model: &SchurModel) -> Option<f64> {
        let held_out = &self.held_out;
        if held_out.segments.is_empty() {
            return None;
        }
        Some(held_out.cost(model)? / held_out.freedom(model.order()).max(1) as f64)
    }
}

/// Refined models of descending orders, with common weights.
struct Descent<'a> {
    fits: BTreeMap<usize, Fit>,
    criteria: BTreeMap<usize, f64>,
    weights: NoiseWeights<'a>,
    /// The cost over all fitted records.
    whole: Likelihood<'a>,
}

impl Descent<'_> {
    /// Adds a model and, if there is one, its criterion.
    fn insert(&mut self, fit: Fit) {
        let order = fit.order();
        let likelihood = &self.weights.likelihood;
        if let Some(value) = criterion(fit.cost, order, &fit.model, likelihood, &self.whole) {
            self.criteria.insert(order, value);
        }
        self.fits.insert(order, fit);
    }

    /// Returns the minimum criterion.
    fn least(&self) -> f64 {
        self.criteria
            .values()
            .copied()
            .fold(f64::INFINITY, f64::min)
    }

    /// Removes states from the refined model at `order` and refines the result (step 3); `None` if
    /// no model is left.
    fn reduced(
        &self,
        order: usize,
        removed: usize,
        progress: &Shares,
    ) -> Result<Option<Fit>, Cancelled> {
        let likelihood = &self.weights.likelihood;
        let mut cheapest: Option<Fit> = None;
        for model in without_last_states(&self.fits[&order].model, removed) {
            let Some(fit) = Fit::start(likelihood, model) else {
                continue;
            };
            if cheapest.as_ref().is_none_or(|other| fit.cost < other.cost) {
                cheapest = Some(fit);
            }
        }
        let Some(start) = cheapest else {
            return Ok(None);
        };
        // The cost at which this order's criterion equals the best: the criterion is proportional
        // to the cost.
        let of_unit_cost = criterion(1.0, start.order(), &start.model, likelihood, &self.whole);
        let hopeless_above = of_unit_cost.map_or(f64::INFINITY, |value| self.least() / value);
        let limits = Limits {
            decrement: COMPARABLE,
            hopeless_above,
        };
        Ok(Some(start.descended(likelihood, limits, progress)?))
    }
}

/// Returns the orders, with their criteria, that exceed the criterion at `best` by at most the
/// relative `share`.
fn within(criteria: &BTreeMap<usize, f64>, best: usize, share: f64) -> BTreeMap<usize, f64> {
    let Some(value) = criteria.get(&best) else {
        return BTreeMap::new();
    };
    let most = (1.0 + share) * value;
    let near = criteria.iter().filter(|(_, value)| **value <= most);
    near.map(|(order, value)| (*order, *value)).collect()
}

/// Returns an unstable pole faster than `highest` \[rad/s\], the highest spectral line: the data
/// cannot support such a pole.
pub(crate) fn fast_unstable_pole(
    poles: impl IntoIterator<Item = Complex<f64>>,
    highest: f64,
) -> Option<Complex<f64>> {
    poles
        .into_iter()
        .find(|pole| pole.re > 0.0 && pole.norm() > highest)
}
