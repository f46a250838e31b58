//! The result of one condition.

use std::sync::Arc;

use crate::correction::{ChannelCorrection, GainBounds, Problem, ProblemError, Solution};
use crate::dataset::PairTable;
use crate::schedule::CostChange;

use super::caution::Caution;
use super::comparison::{BundleFigures, Comparison};

/// Everything the analysis says of one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionAnalysis {
    /// Distances and discontinuity ratios of the bundles.
    pub figures: Arc<BundleFigures>,
    /// Representatives, G and D.
    pub comparison: Arc<Comparison>,
    /// What the gains were asked to do.
    pub gain_problem: Arc<Problem>,
    /// What the delays were asked to do.
    pub delay_problem: Arc<Problem>,
    /// Optimal gains, eq. (7).
    pub gains: Arc<Solution>,
    /// Optimal delays, eq. (11).
    pub delays: Arc<Solution>,
    /// Both as one correction.
    pub correction: ChannelCorrection,
    /// J of the physics representative before and after this correction.
    pub cost: Arc<PairTable<Option<CostChange>>>,
    /// What the engineer has to know about the result.
    pub cautions: Vec<Caution>,
}

impl ConditionAnalysis {
    /// Responses held: the constrained ones that are defined.
    pub fn held(&self) -> &PairTable<bool> {
        &self.gain_problem.constrained
    }

    /// Bounds of every channel gain.
    pub fn gain_bounds(&self) -> GainBounds {
        self.gain_problem.bounds
    }

    /// Upper bound of every channel delay \[s\].
    pub fn delay_upper_s(&self) -> f64 {
        self.delay_problem.bounds.upper
    }

    /// Indices of the physics models suggested as outliers, whatever is rejected.
    pub fn suggested(&self) -> Vec<usize> {
        self.figures.discontinuity.as_ref().map(crate::fidelity::Discontinuity::suggested).unwrap_or_default()
    }
}

/// Why a condition has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConditionFailure {
    /// The two representatives share no response that both have over the whole band.
    #[error(
        "no response of \"{physics}\" can be compared with \"{identified}\" over the whole band: each is zero or not \
         finite somewhere; choose another representative, or another band"
    )]
    NothingToCompare {
        /// Name of the physics representative.
        physics: String,
        /// Name of the identified representative.
        identified: String,
    },
    /// The gains could not be computed.
    #[error("the gains could not be computed: {0}")]
    Gains(ProblemError),
    /// The delays could not be computed.
    #[error("the delays could not be computed: {0}")]
    Delays(ProblemError),
}
