//! Sample statistics.

mod order_statistics;

pub use order_statistics::{mean, median, quantile, weighted_median};
