//! The model order, by the Bayesian information criterion with estimated dispersion (M14.4,
//! M14.13).
//!
//! ```text
//! BIC(n) = J (1 + k ln N / (N - k)),   k = n (m + l) + m l parameters (no state basis),
//!                                      N degrees of freedom
//! 1  n0 = min(16, the order with the minimum BIC before any refinement)
//! 2  small, k(n0) <= 80:  all orders from two above n0 downwards, refined as long as each step
//!                         gains; each also from a second start: order n + 1 or n + 2 without the
//!                         mode whose removal changes the fit to the measured response least
//!    large:               n0 and its neighbours, three steps
//! 3  n = argmin BIC; further orders until two (small) or one (large) on each side are done
//! 4  a held-out record decides between orders whose BIC differ by less than 1 %; an order without
//!    an unstable pole above the lines used is preferred to one with such a pole within 3 %
//! ```

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::Complex;

use gdcm_model::executor::each;
use gdcm_model::progress::Shares;

use super::prepared_data::PreparedData;
use crate::identification_error::IdentificationError;
use crate::likelihood::blocks::BlockModel;
use crate::likelihood::cost::Likelihood;
use crate::likelihood::linear_model::LinearModel;
use crate::likelihood::refinement::{Fit, LEAST_GAIN};

/// Maximum order at which the search begins.
const FIRST: usize = 16;
/// Maximum number of parameters of a small model.
const SMALL: usize = 80;
/// The held-out record decides between orders whose criterion exceeds the minimum by at most this
/// share.
const NEAR: f64 = 0.01;
/// An order without a fast unstable pole is preferred if its criterion is worse by at most this
/// share.
const NEAR_UNSTABLE: f64 = 0.03;
/// Ratio of the cost of a neighbouring order to the cost of the chosen order above which the
/// neighbouring order does not enter the uncertainty.
const STARVED: f64 = 1.5;

/// Thoroughness of the comparison between orders.
#[derive(Clone, Copy)]
struct Thoroughness {
    /// Number of orders that must be evaluated on each side of the best order before the search
    /// ends.
    bracket: usize,
    /// Maximum number of refinement steps.
    steps: usize,
    /// Relative gain below which the refinement ends.
    least_gain: f64,
}

const FOR_SMALL_MODELS: Thoroughness = Thoroughness {
    bracket: 2,
    steps: 20,
    least_gain: LEAST_GAIN,
};

const FOR_LARGE_MODELS: Thoroughness = Thoroughness {
    bracket: 1,
    steps: 3,
    least_gain: 1e-3,
};

/// The orders that were compared.
#[derive(Clone, Debug)]
pub(crate) struct OrderSearch {
    pub(crate) fits: BTreeMap<usize, Fit>,
    /// BIC of each order.
    pub(crate) criteria: BTreeMap<usize, f64>,
    /// The chosen order.
    pub(crate) order: usize,
    /// Whether the criterion still decreases at the highest available order.
    pub(crate) still_falls: bool,
}

impl OrderSearch {
    /// Returns the unrefined model with which the search begins.
    pub(crate) fn first<'s>(
        starts: &'s BTreeMap<usize, Fit>,
        likelihood: &Likelihood,
    ) -> Option<&'s Fit> {
        starts.get(&first_order(starts, likelihood)?)
    }

    /// Returns the models of the next lower and the next higher order, without those whose cost is
    /// too high.
    pub(crate) fn neighbours(&self) -> Vec<&BlockModel> {
        let below = self.fits.range(..self.order).next_back();
        let above = self.fits.range(self.order + 1..).next();
        let most = STARVED
            * self
                .fits
                .get(&self.order)
                .map_or(f64::INFINITY, |fit| fit.cost);
        below
            .into_iter()
            .chain(above)
            .filter(|(_, fit)| fit.cost < most)
            .map(|(_, fit)| &fit.model)
            .collect()
    }
}

/// Returns the order at which the search begins.
fn first_order(starts: &BTreeMap<usize, Fit>, likelihood: &Likelihood) -> Option<usize> {
    let best = order_of_least(&criteria(starts, likelihood))?;
    starts
        .keys()
        .copied()
        .min_by_key(|order| order.abs_diff(best.min(FIRST)))
}

/// Computes the criterion of each fit that has fewer parameters than degrees of freedom.
fn criteria(fits: &BTreeMap<usize, Fit>, likelihood: &Likelihood) -> BTreeMap<usize, f64> {
    let mut criteria = BTreeMap::new();
    for (order, fit) in fits {
        if let Some(criterion) = criterion(fit, likelihood) {
            criteria.insert(*order, criterion);
        }
    }
    criteria
}

/// Computes the `BIC` of a fit; `None` if it has no more degrees of freedom than parameters.
fn criterion(fit: &Fit, likelihood: &Likelihood) -> Option<f64> {
    let k = fit.effective_parameters() as f64;
    let n = likelihood.freedom(fit.model.order()) as f64;
    if n > k {
        Some(fit.cost * (1.0 + k * n.ln() / (n - k)))
    } else {
        None
    }
}

/// Returns the lowest order with the minimum value.
fn order_of_least(values: &BTreeMap<usize, f64>) -> Option<usize> {
    values
        .iter()
        .min_by(|a, b| a.1.total_cmp(b.1))
        .map(|(order, _)| *order)
}

impl PreparedData<'_> {
    /// Searches the order from the unrefined models `starts`; `None` if the data do not support any
    /// model.
    pub(crate) fn search_order(
        &self,
        starts: &BTreeMap<usize, Fit>,
        progress: &Shares,
    ) -> Result<Option<OrderSearch>, IdentificationError> {
        let Some(begin) = first_order(starts, &self.likelihood) else {
            return Ok(None);
        };
        let is_small = starts
            .get(&begin)
            .is_some_and(|fit| fit.effective_parameters() <= SMALL);
        let mut comparison = Comparison {
            data: self,
            starts,
            progress,
            thoroughness: if is_small {
                FOR_SMALL_MODELS
            } else {
                FOR_LARGE_MODELS
            },
            fits: BTreeMap::new(),
        };
        let orders: Vec<usize> = starts.keys().copied().collect();
        let mut range = comparison.bracket(&orders, begin);
        if is_small {
            range.start = 0;
        }
        loop {
            comparison.refine(&orders[range.clone()])?;
            if is_small {
                comparison.start_from_above()?;
            }
            let criteria = criteria(&comparison.fits, &self.likelihood);
            let Some(best) = order_of_least(&criteria) else {
                return Ok(None);
            };
            let bracket = comparison.bracket(&orders, best);
            let wanted = range.start.min(bracket.start)..range.end.max(bracket.end);
            if wanted == range {
                return Ok(Some(OrderSearch {
                    order: comparison.decide(&criteria, best),
                    still_falls: orders.last() == Some(&best) && criteria.len() > 1,
                    fits: comparison.fits,
                    criteria,
                }));
            }
            range = wanted;
        }
    }
}

/// State of the comparison between orders.
struct Comparison<'s> {
    data: &'s PreparedData<'s>,
    /// The unrefined models.
    starts: &'s BTreeMap<usize, Fit>,
    progress: &'s Shares<'s>,
    thoroughness: Thoroughness,
    /// The refined models.
    fits: BTreeMap<usize, Fit>,
}

impl Comparison<'_> {
    /// Returns the index range of an order and its neighbours in `orders`.
    fn bracket(&self, orders: &[usize], order: usize) -> Range<usize> {
        let at = orders.partition_point(|other| *other < order);
        let reach = self.thoroughness.bracket;
        at.saturating_sub(reach)..(at + reach + 1).min(orders.len())
    }

    /// Refines the models in `orders` that are not refined yet.
    fn refine(&mut self, orders: &[usize]) -> Result<(), IdentificationError> {
        let likelihood = &self.data.likelihood;
        let new: Vec<usize> = orders
            .iter()
            .copied()
            .filter(|order| !self.fits.contains_key(order))
            .collect();
        let Thoroughness {
            steps, least_gain, ..
        } = self.thoroughness;
        let refined = each(likelihood.executor, &new, |order| {
            self.starts[order]
                .clone()
                .refined(likelihood, steps, least_gain, self.progress)
        });
        for (order, fit) in new.into_iter().zip(refined) {
            self.fits.insert(order, fit?);
        }
        Ok(())
    }

    /// Starts each order, from the highest down, a second time from the models of the two orders
    /// above it, and keeps the model with the lower cost.
    fn start_from_above(&mut self) -> Result<(), IdentificationError> {
        let likelihood = &self.data.likelihood;
        let Thoroughness {
            steps, least_gain, ..
        } = self.thoroughness;
        let orders: Vec<usize> = self.fits.keys().rev().copied().collect();
        for order in orders {
            let Some(start) = self.cheapest_from_above(order) else {
                continue;
            };
            let fit = start.refined(likelihood, steps, least_gain, self.progress)?;
            if self.fits.get(&order).is_some_and(|own| fit.cost < own.cost) {
                self.fits.insert(order, fit);
            }
        }
        Ok(())
    }

    /// Removes a real pole from the model one order higher, or a complex pair from the model two
    /// orders higher, and returns the result with the lower cost.
    fn cheapest_from_above(&self, order: usize) -> Option<Fit> {
        let mut starts = Vec::new();
        for size in [1, 2] {
            let Some(above) = self.fits.get(&(order + size)) else {
                continue;
            };
            let Some(model) = above.model.without_least_mode(size, &self.data.measured) else {
                continue;
            };
            starts.extend(Fit::start(&self.data.likelihood, model));
        }
        starts.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// Decides between orders with nearly the same criterion as `best` (step 4).
    fn decide(&self, criteria: &BTreeMap<usize, f64>, best: usize) -> usize {
        let near = within(criteria, best, NEAR_UNSTABLE);
        let sound: BTreeMap<usize, f64> = near
            .into_iter()
            .filter(|(order, _)| self.is_sound(*order))
            .collect();
        let best = order_of_least(&sound).unwrap_or(best);
        if self.data.held_out.segments.is_empty() {
            return best;
        }
        let mut held_out_costs = BTreeMap::new();
        for order in within(criteria, best, NEAR).into_keys() {
            if self.is_sound(order) != self.is_sound(best) {
                continue;
            }
            if let Some(cost) = self.held_out_cost(order) {
                held_out_costs.insert(order, cost);
            }
        }
        order_of_least(&held_out_costs).unwrap_or(best)
    }

    /// Returns whether the model of an order exists and has no fast unstable pole.
    fn is_sound(&self, order: usize) -> bool {
        self.fits
            .get(&order)
            .is_some_and(|fit| fast_unstable_pole(&fit.model, self.data.highest).is_none())
    }

    /// Computes the held-out cost per degree of freedom of an order.
    fn held_out_cost(&self, order: usize) -> Option<f64> {
        let model = &self.fits.get(&order)?.model;
        let held_out = &self.data.held_out;
        Some(held_out.cost(model)? / held_out.freedom(model.order()).max(1) as f64)
    }
}

/// Returns the criteria that exceed the criterion of `best` by at most the relative `share`.
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
pub(crate) fn fast_unstable_pole(model: &BlockModel, highest: f64) -> Option<Complex<f64>> {
    model
        .blocks
        .iter()
        .flat_map(|block| block.poles())
        .find(|pole| pole.re > 0.0 && pole.norm() > highest)
}
