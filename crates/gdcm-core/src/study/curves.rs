//! Responses of one condition for drawing, over a wider band than that of comparison.

use std::sync::Arc;

use crate::dataset::{Band, BundleKind, Condition};
use crate::response::{FrequencyGrid, FrequencyResponse};

use super::condition_responses::ConditionResponses;

/// Responses of every model of a condition on a grid for drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionCurves {
    /// The condition: it names the models in whose order the responses are.
    pub condition: Arc<Condition>,
    /// The frequencies.
    pub grid: FrequencyGrid,
    /// Responses of the physics models.
    pub physics: Vec<Arc<FrequencyResponse>>,
    /// Responses of the identified models.
    pub identified: Vec<Arc<FrequencyResponse>>,
}

impl ConditionCurves {
    pub(super) fn new(condition: Arc<Condition>, grid: FrequencyGrid, responses: ConditionResponses) -> Self {
        Self { condition, grid, physics: responses.physics, identified: responses.identified }
    }

    /// The responses of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[Arc<FrequencyResponse>] {
        match kind {
            BundleKind::Physics => &self.physics,
            BundleKind::Identified => &self.identified,
        }
    }
}

/// Frequencies of drawn curves.
pub const CURVE_POINTS: usize = 500;

/// The band drawn around a band of comparison: a little more than half a decade's third on either side.
pub fn display_band(band: Band) -> Band {
    const MARGIN: f64 = 1.7;
    Band::beyond(band.min() / MARGIN, band.max() * MARGIN).unwrap_or(band)
}
