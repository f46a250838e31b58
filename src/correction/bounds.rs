//! Bounds of the channel gains and delays (M7).

use crate::dataset::{Pair, PairTable};
use crate::fidelity::Mismatch;
use crate::response::quantile;

use super::GainBounds;
use super::delta::{delays, ratios};

/// The mismatches that are pooled: those marked in `measuring`, or all where none of the marked is defined.
fn pooled<'a>(
    mismatch: &'a PairTable<Option<Mismatch>>,
    measuring: &PairTable<bool>,
) -> impl Iterator<Item = &'a Mismatch> + use<'a> {
    let marked: Vec<Pair> = measuring.marked().filter(|&pair| mismatch[pair].is_some()).collect();
    let pairs = if marked.is_empty() { mismatch.pairs().collect() } else { marked };
    pairs.into_iter().filter_map(|pair| mismatch[pair].as_ref())
}

/// `LB = min(1, q-quantile)`, `UB = max(1, (1-q)-quantile)` of `|H_ref| / |H_sim|` pooled over frequency and pairs.
pub fn gain_bounds(mismatch: &PairTable<Option<Mismatch>>, measuring: &PairTable<bool>, q: f64) -> GainBounds {
    let mut pool: Vec<f64> = pooled(mismatch, measuring).flat_map(ratios).collect();
    let lower = quantile(&mut pool, q).min(1.0);
    let upper = quantile(&mut pool, 1.0 - q).max(1.0);
    GainBounds { lower, upper }
}

/// `UB = max(0, (1-q)-quantile)` \[s\] of `Delta phi / omega` pooled over frequency and pairs.
pub fn delay_upper_s(
    mismatch: &PairTable<Option<Mismatch>>,
    measuring: &PairTable<bool>,
    omega: &[f64],
    q: f64,
) -> f64 {
    let mut pool: Vec<f64> = pooled(mismatch, measuring).flat_map(|mismatch| delays(mismatch, omega)).collect();
    quantile(&mut pool, 1.0 - q).max(0.0)
}
