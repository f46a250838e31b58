//! Selected and highlighted parts.

use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_words::derivation::ExplainTarget;

/// Parts in focus, selected or under the pointer.
#[derive(Debug, Default)]
pub struct Selection {
    pub condition: ConditionId,
    /// Response in the large plot.
    pub pair: Pair,
    /// Model under the pointer.
    pub hovered: Option<ModelId>,
    /// Condition under the pointer, in the list or as a dot.
    pub hovered_condition: Option<ConditionId>,
    /// Description, in a single line, for the plot element under the pointer: nothing floats over
    /// curves.
    pub told: Option<String>,
    /// The only model shown beside the representatives.
    pub isolated: Option<ModelId>,
    /// Value whose derivation is shown.
    pub asked: Option<ExplainTarget>,
}
