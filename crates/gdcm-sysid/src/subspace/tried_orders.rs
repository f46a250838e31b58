//! Chooses the orders and past windows to try, as far as the amount of data allows (M14.13).
//!
//! ```text
//! n order, m inputs, l outputs, q = m + l;   w2 upper end of the band [rad/s]
//! data matrix (`data_matrix`): (p + 1) q columns, a row every 1.2 / w2 s;   p past window, the
//!     number of projections from which the next is predicted
//! map to the future (`ct_pbsid`): f l rows, at least n;   f = min(p, max(12, 30 / l rounded up))
//! p   8, 10, 12, 16, also 24 for q <= 4, if there are 2 rows for each column;
//!     if none is left, the longest with 1.5 rows for each column, but at least 3
//! n   1 to 8, without 5 and 7 for q > 6, then 10, 12 ... 24, if n <= f l and there are 5 real
//!     values for each of the n q + m l parameters
//! ```
//!
//! Tried on 256 simulated flights with 2 to 13 channels, all of which gave a model.

use std::ops::RangeInclusive;

/// Low orders: the even ones are always tried, the odd ones above `LAST_ODD_ORDER` only for few
/// channels.
const LOW_ORDERS: RangeInclusive<usize> = 1..=8;
/// Higher orders: only the even ones are tried.
const HIGH_ORDERS: RangeInclusive<usize> = 10..=24;
/// Largest odd order that is tried however many channels there are.
const LAST_ODD_ORDER: usize = 3;
/// Up to this channel count, higher odd orders are tried too.
const ODD_ORDERS_CHANNELS: usize = 6;
/// Past windows to try however many channels there are.
const PASTS: [usize; 4] = [8, 10, 12, 16];
/// Further past window to try for few channels.
const LONG_PAST: usize = 24;
/// Up to this channel count, `LONG_PAST` is tried.
const LONG_PAST_CHANNELS: usize = 4;
/// Shortest past window, for the shortest records.
const LEAST_PAST: usize = 3;
/// Minimum number of rows per column in a data matrix.
const ROWS_PER_COLUMN: f64 = 2.0;
/// Minimum number of rows per column if no past window reaches `ROWS_PER_COLUMN`.
const ROWS_PER_COLUMN_SHORT: f64 = 1.5;
/// Number of states for which the map to the future has enough rows: more than the highest order,
/// so that a single output has models of all orders too.
const FUTURE_STATES: usize = 30;
/// Minimum of [`DataExtent::longest_future`].
const LEAST_FUTURE: usize = 12;
/// Time between instants (rows of the data matrix) times the upper end of the band \[rad\]: about
/// five rows in a period.
pub(crate) const SPACING: f64 = 1.2;
/// Minimum number of real values in the spectral lines for each model parameter (M14.13).
pub(crate) const VALUES_PER_PARAMETER: usize = 5;

/// Counts a model's parameters at this order, `n (m + l) + m l` for n states, m inputs and l
/// outputs: those that only change the state basis do not count.
pub(crate) fn parameters_of_order(order: usize, inputs: usize, outputs: usize) -> usize {
    order * (inputs + outputs) + inputs * outputs
}

/// The channel counts and the amount of data.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DataExtent {
    pub(crate) inputs: usize,
    pub(crate) outputs: usize,
    /// Number of real values in all lines, less those that determine the transients.
    pub(crate) real_values: usize,
    /// Total length without gaps times the upper end of the band \[rad\].
    pub(crate) radians: f64,
}

impl DataExtent {
    fn channels(self) -> usize {
        self.inputs + self.outputs
    }

    /// Returns the maximum number of block rows in the map to the future: enough for 30 states, and
    /// at least 12.
    pub(crate) fn longest_future(self) -> usize {
        FUTURE_STATES
            .div_ceil(self.outputs.max(1))
            .max(LEAST_FUTURE)
    }

    /// Returns the past windows that the amount of data allows: those with 2 rows per column; if
    /// there are none, the longest with 1.5 rows per column, but at least 3.
    pub(crate) fn pasts(self) -> Vec<usize> {
        let rows = self.radians / SPACING;
        let mut pasts = PASTS.to_vec();
        if self.channels() <= LONG_PAST_CHANNELS {
            pasts.push(LONG_PAST);
        }
        pasts.retain(|past| {
            let columns = ((past + 1) * self.channels()) as f64;
            rows >= ROWS_PER_COLUMN * columns
        });
        if pasts.is_empty() {
            let block_columns = (rows / (ROWS_PER_COLUMN_SHORT * self.channels() as f64)) as usize;
            pasts.push(block_columns.saturating_sub(1).max(LEAST_PAST));
        }
        pasts
    }

    /// Returns the orders that the amount of data allows, with past windows up to `longest_past`.
    pub(crate) fn orders(self, longest_past: usize) -> Vec<usize> {
        let future_rows = longest_past.min(self.longest_future()) * self.outputs;
        let tries_odd = self.channels() <= ODD_ORDERS_CHANNELS;
        LOW_ORDERS
            .chain(HIGH_ORDERS.step_by(2))
            .filter(|order| *order <= LAST_ODD_ORDER || order.is_multiple_of(2) || tries_odd)
            .filter(|order| *order <= future_rows && self.determines(*order))
            .collect()
    }

    /// Returns whether there are enough real values for the parameters at an order.
    fn determines(self, order: usize) -> bool {
        let parameters = parameters_of_order(order, self.inputs, self.outputs);
        VALUES_PER_PARAMETER * parameters <= self.real_values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_axis_of_thirty_seconds_carries_orders_to_14_and_all_past_windows() {
        // 74 lines of one output: value from independent code (identification-real.json,
        // short_siso).
        let extent = DataExtent {
            inputs: 1,
            outputs: 1,
            real_values: 2 * 74 - 2,
            radians: 30.0 * 12.0,
        };
        assert_eq!(extent.pasts(), [8, 10, 12, 16, 24]);
        assert_eq!(extent.orders(24), [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14]);
    }

    #[test]
    fn many_channels_have_even_orders_and_short_records_short_windows() {
        let extent = DataExtent {
            inputs: 8,
            outputs: 12,
            real_values: 100_000,
            radians: 60.0 * 12.0,
        };
        assert_eq!(
            extent.orders(8),
            [1, 2, 3, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24]
        );
        // 600 rows and 20 channels: the ratio of rows to columns is 1.5 for p = 19 and 2 for p =
        // 14.
        assert_eq!(extent.pasts(), [8, 10, 12]);
        let short = DataExtent {
            radians: 20.0 * 12.0,
            ..extent
        };
        assert_eq!(short.pasts(), [5]);
        // 340 rows: a ratio of 2 would need 360 rows for p = 8; a ratio of 1.5 allows p up to 10.
        let between = DataExtent {
            radians: 34.0 * 12.0,
            ..extent
        };
        assert_eq!(between.pasts(), [10]);
    }
}
