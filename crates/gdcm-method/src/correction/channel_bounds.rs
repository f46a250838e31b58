//! Bounds on the channel gains and delays: quantiles, over the band, of the gains and delays that
//! the responses need (M7).
//!
//! ```text
//! gains    LB = min(1, q-quantile),  UB = max(1, (1-q)-quantile)   of |H_ref| / |H_sim|
//! delays                             UB = max(0, (1-q)-quantile)   of Delta phi / omega
//! ```
//!
//! `H_sim` is the physics model's response, `H_ref` the identified model's, `Delta phi` the phase
//! by which the physics model leads, `q` the share of values that may lie beyond each bound. The
//! quantiles pool the frequencies of the on-axis responses, which the table `measuring` marks. The
//! lower bound on a signed delay follows from the lead filters instead (`lead_design`).

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::statistics::quantile;

use super::delta::{delays, ratios};
use crate::fidelity::Mismatch;

/// Minimum and maximum value, the same for every channel (M7): gains `0 < lower <= upper`; delays
/// \[s\], with `lower` zero; signed delays \[s\], `lower <= 0 <= upper` (M15.4).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct Bounds {
    pub lower: f64,
    pub upper: f64,
}

impl From<[f64; 2]> for Bounds {
    fn from([lower, upper]: [f64; 2]) -> Self {
        Self { lower, upper }
    }
}

impl From<Bounds> for [f64; 2] {
    fn from(bounds: Bounds) -> Self {
        [bounds.lower, bounds.upper]
    }
}

/// Computes the gain bounds `LB = min(1, q-quantile)` and `UB = max(1, (1-q)-quantile)` of
/// `|H_ref| / |H_sim|`, pooled over the frequencies and the responses in `measuring` (over all
/// responses if none of these has a mismatch), M7. Both are 1 if no response has a mismatch.
pub fn gain_bounds(
    mismatch: &PairTable<Option<Mismatch>>,
    measuring: &PairTable<bool>,
    q: f64,
) -> Bounds {
    let mut pool: Vec<f64> = pooled(mismatch, measuring).flat_map(ratios).collect();
    // Without values the quantiles are NaN, which `min` and `max` ignore.
    let lower = quantile(&mut pool, q).min(1.0);
    let upper = quantile(&mut pool, 1.0 - q).max(1.0);
    Bounds { lower, upper }
}

/// Computes the upper delay bound `UB = max(0, (1-q)-quantile)` \[s\] of `Delta phi / omega`,
/// pooled like the ratios in [`gain_bounds`] (M7); 0 if no response has a mismatch.
pub fn delay_upper_s(
    mismatch: &PairTable<Option<Mismatch>>,
    measuring: &PairTable<bool>,
    omega: &[f64],
    q: f64,
) -> f64 {
    let mut pool = Vec::new();
    for mismatch in pooled(mismatch, measuring) {
        // With coherence weights, both have only the weighted frequencies of `omega`.
        let phase = mismatch.phase_difference(omega);
        pool.extend(delays(&phase, mismatch.omega(omega)));
    }
    // Without values the quantile is NaN, which `max` ignores.
    quantile(&mut pool, 1.0 - q).max(0.0)
}

/// Selects the mismatches to be pooled: those for the responses in `measuring`, or all if none of
/// these is defined.
fn pooled<'a>(
    mismatch: &'a PairTable<Option<Mismatch>>,
    measuring: &PairTable<bool>,
) -> impl Iterator<Item = &'a Mismatch> + use<'a> {
    let marked: Vec<Pair> = measuring
        .marked()
        .filter(|&pair| mismatch[pair].is_some())
        .collect();
    let pairs = if marked.is_empty() {
        mismatch.pairs().collect()
    } else {
        marked
    };
    pairs.into_iter().filter_map(|pair| mismatch[pair].as_ref())
}
