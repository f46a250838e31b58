//! Responses of one condition for drawing, over a wider band than that of comparison.

use crate::dataset::{Band, BundleKind, Condition};
use crate::response::{FrequencyGrid, FrequencyResponse};

/// Responses of every model of a condition on a grid for drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionCurves {
    /// The frequencies.
    pub grid: FrequencyGrid,
    /// Responses of the physics models, in file order.
    pub physics: Vec<FrequencyResponse>,
    /// Responses of the identified models, in file order.
    pub identified: Vec<FrequencyResponse>,
}

impl ConditionCurves {
    /// Evaluates every model on `points` frequencies of `band`.
    pub fn of(condition: &Condition, band: Band, points: usize) -> Self {
        let grid = FrequencyGrid::logarithmic(band, points);
        let respond = |kind: BundleKind| {
            condition.bundle(kind).iter().map(|model| FrequencyResponse::of(&model.dynamics, &grid)).collect()
        };
        let (physics, identified) = (respond(BundleKind::Physics), respond(BundleKind::Identified));
        Self { grid, physics, identified }
    }

    /// The responses of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[FrequencyResponse] {
        match kind {
            BundleKind::Physics => &self.physics,
            BundleKind::Identified => &self.identified,
        }
    }
}

/// The band drawn around a band of comparison: a little more than half a decade's third on either side.
pub fn display_band(band: Band) -> Band {
    const MARGIN: f64 = 1.7;
    Band::new(band.min() / MARGIN, band.max() * MARGIN).unwrap_or(band)
}
