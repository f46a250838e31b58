//! The order of the model, by the Bayesian information criterion with estimated dispersion (M14, section 4, and M14.13).
//!
//! ```text
//! BIC(n) = J (1 + k ln N / (N - k)),   k = n (m + l) + m l parameters that matter,   N degrees of freedom
//! 1  n0 = min(16, the order of the least BIC before any refinement)
//! 2  small, k(n0) <= 80:  all orders from two above n0 downwards, refined as long as it gains;
//!                         each from a second start as well: order n + 1 or n + 2 without the mode that is missed least
//!    large:               n0 and its neighbours, three steps
//! 3  n = argmin BIC; further orders until two (small) or one (large) on each side are known
//! ```
//!
//! A record that was held out decides between orders whose BIC differ by less than 1 %. An unstable pole above the lines used is no finding: an
//! order within 3 % without one goes first.

use std::collections::BTreeMap;

use gdcm_model::executor::each;
use gdcm_model::progress::Shares;

use super::blocks::BlockModel;
use super::identify::IdentificationError;
use super::likelihood::Likelihood;
use super::prepared_data::{FIGURES_AN_UNKNOWN, PreparedData};
use super::refinement::Fit;

/// The highest order at which the search begins.
const FIRST: usize = 16;
/// Parameters up to which a model is small.
const SMALL: usize = 80;
/// Orders on each side of the best that are known in the end, of small models and of large ones.
const BRACKET: (usize, usize) = (2, 1);
/// Steps of the refinement while orders are compared, of small models and of large ones.
const STEPS: (usize, usize) = (20, 3);
/// Relative gain below which the refinement of small models, and of the chosen one, is at its end.
pub(super) const LEAST_GAIN: f64 = 1e-4;
/// The same of large models while orders are compared.
const LEAST_GAIN_COMPARED: f64 = 1e-3;
/// Orders whose criteria differ by less, relatively, are told apart by the held-out record.
const NEAR: f64 = 0.01;
/// An order without a fast unstable pole goes before one with such a pole whose criterion is better by less, relatively.
const NEAR_UNSTABLE: f64 = 0.03;
/// Cost of a neighbouring order over that of the chosen one, beyond which it says nothing of how sure the order is.
const STARVED: f64 = 1.5;

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
    pub(super) fn first<'s>(
        starts: &'s BTreeMap<usize, Fit>,
        likelihood: &Likelihood,
    ) -> Option<&'s Fit> {
        starts.get(&first(starts, likelihood)?)
    }

    /// The models of the next lower and the next higher order, as far as they are there and not starved.
    pub(super) fn neighbours(&self) -> Vec<&BlockModel> {
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

/// The order at which the search begins.
fn first(starts: &BTreeMap<usize, Fit>, likelihood: &Likelihood) -> Option<usize> {
    let of = |(order, fit): (&usize, &Fit)| Some((*order, criterion(fit, likelihood)?));
    let (best, _) = starts
        .iter()
        .filter_map(of)
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    starts
        .keys()
        .copied()
        .min_by_key(|order| order.abs_diff(best.min(FIRST)))
}

/// Parameters that matter of a model of an order: `n (m + l) + m l`.
pub(super) fn parameters_of_order(order: usize, inputs: usize, outputs: usize) -> usize {
    order * (inputs + outputs) + inputs * outputs
}

/// Parameters that matter of a fit.
pub(super) fn effective_parameters(fit: &Fit) -> usize {
    parameters_of_order(fit.model.order(), fit.model.b.ncols(), fit.model.c.nrows())
}

/// `BIC` of a fit; none where it has more parameters than degrees of freedom.
fn criterion(fit: &Fit, likelihood: &Likelihood) -> Option<f64> {
    let k = effective_parameters(fit) as f64;
    let n = likelihood.freedom(fit.model.order()) as f64;
    (n > k).then(|| fit.cost * (1.0 + k * n.ln() / (n - k)))
}

impl PreparedData<'_> {
    /// Searches the order from the unrefined models `starts`; none where no model can be afforded.
    pub(super) fn search_order(
        &self,
        starts: &BTreeMap<usize, Fit>,
        progress: &Shares,
    ) -> Result<Option<OrderSearch>, IdentificationError> {
        let likelihood = &self.likelihood;
        let Some(begin) = first(starts, likelihood) else {
            return Ok(None);
        };
        let is_small = starts
            .get(&begin)
            .is_some_and(|fit| effective_parameters(fit) <= SMALL);
        let orders: Vec<usize> = starts.keys().copied().collect();
        let at = orders.partition_point(|order| *order < begin);
        let reach = if is_small { BRACKET.0 } else { BRACKET.1 };
        let mut range = (
            if is_small {
                0
            } else {
                at.saturating_sub(reach)
            },
            (at + reach + 1).min(orders.len()),
        );
        let mut fits = BTreeMap::new();
        loop {
            let new: Vec<usize> = orders[range.0..range.1]
                .iter()
                .copied()
                .filter(|n| !fits.contains_key(n))
                .collect();
            let (steps, gain) = if is_small {
                (STEPS.0, LEAST_GAIN)
            } else {
                (STEPS.1, LEAST_GAIN_COMPARED)
            };
            let refinement =
                |n: &usize| starts[n].clone().refined(likelihood, steps, gain, progress);
            for (&n, fit) in new.iter().zip(each(likelihood.executor, &new, refinement)) {
                fits.insert(n, fit?);
            }
            if is_small {
                self.start_from_above(&mut fits, progress)?;
            }
            let criteria: BTreeMap<usize, f64> = fits
                .iter()
                .filter_map(|(n, fit)| Some((*n, criterion(fit, likelihood)?)))
                .collect();
            let Some((&best, _)) = criteria.iter().min_by(|a, b| a.1.total_cmp(b.1)) else {
                return Ok(None);
            };
            let at = orders.partition_point(|order| *order < best);
            let wanted = (
                range.0.min(at.saturating_sub(reach)),
                range.1.max((at + reach + 1).min(orders.len())),
            );
            if wanted == range {
                let still_falls = starts.keys().last() == Some(&best) && criteria.len() > 1;
                let order = self.decided(&fits, &criteria, best);
                return Ok(Some(OrderSearch {
                    fits,
                    criteria,
                    order,
                    still_falls,
                }));
            }
            range = wanted;
        }
    }

    /// Gives each order, the higher ones first, a second start out of the two orders above it, and keeps the cheaper model.
    fn start_from_above(
        &self,
        fits: &mut BTreeMap<usize, Fit>,
        progress: &Shares,
    ) -> Result<(), IdentificationError> {
        let orders: Vec<usize> = fits.keys().rev().copied().collect();
        for order in orders {
            let above = [1, 2]
                .into_iter()
                .filter_map(|size| Some((size, &fits.get(&(order + size))?.model)));
            let models =
                above.filter_map(|(size, model)| model.without_least_mode(size, &self.measured));
            let started = models.filter_map(|model| Fit::start(&self.likelihood, model));
            let Some(start) = started.min_by(|a, b| a.cost.total_cmp(&b.cost)) else {
                continue;
            };
            let fit = start.refined(&self.likelihood, STEPS.0, LEAST_GAIN, progress)?;
            if fits.get(&order).is_some_and(|own| fit.cost < own.cost) {
                fits.insert(order, fit);
            }
        }
        Ok(())
    }

    /// Of the orders whose criterion is about as good as that of `best` one without a fast unstable pole, and among those the one with the
    /// least cost on what was held out.
    fn decided(
        &self,
        fits: &BTreeMap<usize, Fit>,
        criteria: &BTreeMap<usize, f64>,
        best: usize,
    ) -> usize {
        let is_sound = |order: &usize| {
            fits.get(order)
                .is_some_and(|fit| fast_unstable_pole(&fit.model, self.highest).is_none())
        };
        let least = |among: &mut dyn Iterator<Item = (usize, f64)>| {
            among.min_by(|a, b| a.1.total_cmp(&b.1))
        };
        let near = |of: f64, share: f64| {
            let most = (1.0 + share) * of;
            criteria
                .iter()
                .filter(move |(_, value)| **value <= most)
                .map(|(order, value)| (*order, *value))
        };
        let Some(&value) = criteria.get(&best) else {
            return best;
        };
        let sound = least(&mut near(value, NEAR_UNSTABLE).filter(|(order, _)| is_sound(order)));
        let (best, value) = sound.unwrap_or((best, value));
        if self.held_out.segments.is_empty() {
            return best;
        }
        let cost = |order: usize| {
            let model = &fits.get(&order)?.model;
            Some((
                order,
                self.held_out.cost(model)? / self.held_out.freedom(model.order()).max(1) as f64,
            ))
        };
        let mut costs = near(value, NEAR)
            .filter(|(order, _)| is_sound(order) == is_sound(&best))
            .filter_map(|(order, _)| cost(order));
        least(&mut costs).map_or(best, |(order, _)| order)
    }
}

/// An unstable pole faster than `highest` \[rad/s\], which no line shows.
pub(super) fn fast_unstable_pole(
    model: &BlockModel,
    highest: f64,
) -> Option<nalgebra::Complex<f64>> {
    let mut poles = model.blocks.iter().flat_map(|block| block.poles());
    poles.find(|pole| pole.re > 0.0 && pole.norm() > highest)
}

// What is tried for any number of channels and any length of the records (M14.13).

/// Orders that are tried one by one, and those beyond.
const LOW_ORDERS: std::ops::RangeInclusive<usize> = 1..=8;
const HIGH_ORDERS: std::ops::RangeInclusive<usize> = 10..=24;
/// Channels up to which odd orders above 3 are tried.
const ODD_ORDERS: usize = 6;
/// Past windows, the last only for few channels.
const PASTS: [usize; 4] = [8, 10, 12, 16];
const LONG_PAST: (usize, usize) = (24, 4);
/// The shortest past window.
const LEAST_PAST: usize = 3;
/// Rows over columns of a data matrix at least; where no past window has so many, this many.
const LEAST_ROWS: (f64, f64) = (2.0, 1.5);
/// Time between instants is this over the upper end of the band.
pub(super) const SPACING: f64 = 1.2;

/// Channels and how much there is of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Inputs.
    pub(super) inputs: usize,
    /// Outputs.
    pub(super) outputs: usize,
    /// Real figures of all lines less the transients of the records.
    pub(super) figures: usize,
    /// Length of the records times the upper end of the band \[rad\].
    pub(super) radians: f64,
}

impl Extent {
    fn channels(self) -> usize {
        self.inputs + self.outputs
    }

    /// Block rows of the map to the future at most: enough for 30 states.
    pub(super) fn longest_future(self) -> usize {
        30_usize.div_ceil(self.outputs.max(1)).max(12)
    }

    /// Past windows that the records can carry.
    pub(super) fn pasts(self) -> Vec<usize> {
        let rows = self.radians / SPACING;
        let columns = |past: usize| ((past + 1) * self.channels()) as f64;
        let long = Some(LONG_PAST.0).filter(|_| self.channels() <= LONG_PAST.1);
        let pasts: Vec<usize> = PASTS
            .into_iter()
            .chain(long)
            .filter(|past| rows >= LEAST_ROWS.0 * columns(*past))
            .collect();
        if pasts.is_empty() {
            let block_columns = (rows / (LEAST_ROWS.1 * self.channels() as f64)) as usize;
            return vec![block_columns.saturating_sub(1).max(LEAST_PAST)];
        }
        pasts
    }

    /// Orders that the records can carry, with past windows up to `longest_past`.
    pub(super) fn orders(self, longest_past: usize) -> Vec<usize> {
        let most = longest_past.min(self.longest_future()) * self.outputs;
        let is_tried =
            |order: &usize| *order <= 3 || order.is_multiple_of(2) || self.channels() <= ODD_ORDERS;
        let is_carried = |order: &usize| {
            FIGURES_AN_UNKNOWN * parameters_of_order(*order, self.inputs, self.outputs)
                <= self.figures
                && *order <= most
        };
        LOW_ORDERS
            .chain(HIGH_ORDERS.step_by(2))
            .filter(|order| is_tried(order) && is_carried(order))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_axis_of_thirty_seconds_carries_orders_to_14_and_all_past_windows() {
        // 74 lines of one output: known answer of independent code (identification-real.json, short_siso).
        let extent = Extent {
            inputs: 1,
            outputs: 1,
            figures: 2 * 74 - 2,
            radians: 30.0 * 12.0,
        };
        assert_eq!(extent.pasts(), [8, 10, 12, 16, 24]);
        assert_eq!(extent.orders(24), [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14]);
    }

    #[test]
    fn many_channels_have_even_orders_and_short_records_short_windows() {
        let extent = Extent {
            inputs: 8,
            outputs: 12,
            figures: 100_000,
            radians: 60.0 * 12.0,
        };
        assert_eq!(
            extent.orders(8),
            [1, 2, 3, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24]
        );
        // 600 rows of 20 channels: 1.5 (p + 1) 20 of them for p = 19, two for p = 14.
        assert_eq!(extent.pasts(), [8, 10, 12]);
        let short = Extent {
            radians: 20.0 * 12.0,
            ..extent
        };
        assert_eq!(short.pasts(), [5]);
        // 340 rows: two for each column would take 360 of p = 8, and one and a half are there up to p = 10.
        let between = Extent {
            radians: 34.0 * 12.0,
            ..extent
        };
        assert_eq!(between.pasts(), [10]);
    }
}
