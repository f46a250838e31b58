//! Bands about a scheduled `ln k` (M13.6).
//!
//! ```text
//! confidence band: t(f) S' sqrt(h),   band for a further condition: t(f) S' sqrt(1 + h),   S'^2 = max(S^2, B)
//! ```
//!
//! `h` is the airspeed's leverage; `f`, `S^2` and `B` are explained in `variance_decomposition`.

use std::sync::Arc;

use super::design::Design;
use super::distributions::student_quantile;
use super::variance_decomposition::VarianceDecomposition;

/// Bands about a schedule: `t(f) S' sqrt(h)` and `t(f) S' sqrt(1 + h)`, `S'^2 = max(S^2, B)`.
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduleBand {
    design: Arc<Design>,
    /// `t(f) S'`.
    scaled_deviation: f64,
}

impl ScheduleBand {
    /// Computes the bands from the scatter about the fit with `design`, for a confidence level.
    pub fn new(design: &Arc<Design>, split: &VarianceDecomposition, level: f64) -> Self {
        let deviation = split.scatter.max(split.explained()).sqrt();
        Self {
            design: Arc::clone(design),
            scaled_deviation: student_quantile(level, split.freedom as f64) * deviation,
        }
    }

    /// Returns the bands' half-widths at a design row.
    pub fn at(&self, row: &[f64]) -> BandWidths {
        let h = self.design.leverage(row);
        BandWidths {
            confidence: self.scaled_deviation * h.sqrt(),
            scatter: self.scaled_deviation * (1.0 + h).sqrt(),
        }
    }
}

/// Half-widths about a scheduled `ln k` at an airspeed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandWidths {
    /// Half-width: confidence band for the schedule itself.
    pub confidence: f64,
    /// Half-width: band that is expected to contain a further condition.
    pub scatter: f64,
}
