//! How far a schedule of `ln k` may be off, and where another condition would fall (M13.6).

use std::sync::Arc;

use super::least_squares::Design;
use super::quantiles::student_quantile;
use super::scatter::VarianceDecomposition;

/// Half-widths of the two bands about a scheduled `ln k` at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandWidths {
    /// Of the schedule itself.
    pub confidence: f64,
    /// Of another condition's figure.
    pub scatter: f64,
}

/// The bands of one figure's schedule: `t(n - r) S' sqrt(h)` and `t(n - r) S' sqrt(1 + h)`, `S'^2 = max(S^2, B)`.
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduleBand {
    design: Arc<Design>,
    /// `t(n - r) S'`.
    half: f64,
}

impl ScheduleBand {
    /// The bands about the fit whose scatter is split so.
    pub fn of(design: &Arc<Design>, split: &VarianceDecomposition, level: f64) -> Self {
        let deviation = split.scatter.max(split.explained()).sqrt();
        Self { design: Arc::clone(design), half: student_quantile(level, split.freedom as f64) * deviation }
    }

    /// The half-widths at the place that has this row of the design.
    pub fn at(&self, row: &[f64]) -> BandWidths {
        let h = self.design.leverage(row);
        BandWidths { confidence: self.half * h.sqrt(), scatter: self.half * (1.0 + h).sqrt() }
    }
}
