//! Context for a computation on a study's conditions.

use gdcm_method::correction::ProofBudget;
use gdcm_model::response::FrequencyGrid;

use super::compared_model::ComparisonGrid;
use super::known_models::GridKey;
use crate::decisions::study::Study;
use crate::execution::Execution;

/// An analysis's study, grid, proof budget and execution.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a> {
    pub(crate) study: &'a Study,
    /// The comparison frequencies.
    pub(crate) grid: &'a FrequencyGrid,
    /// Proof budget for each condition's gains.
    pub(crate) proofs: ProofBudget,
    pub(crate) execution: &'a Execution<'a>,
}

impl<'a> Run<'a> {
    /// Returns the band and the number of frequencies in it.
    pub(crate) fn grid_key(&self) -> GridKey {
        (self.study.settings.band, self.study.settings.points)
    }

    /// Returns the comparison frequencies and the minimum coherence.
    pub(crate) fn comparison_grid(&self) -> ComparisonGrid<'a> {
        ComparisonGrid {
            grid: self.grid,
            coherence: self.study.settings.coherence_threshold,
        }
    }
}
