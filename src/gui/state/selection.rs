//! Selected and highlighted elements.

use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_words::derivation::ExplainTarget;

/// Elements in focus, selected or under the pointer.
#[derive(Debug, Default)]
pub struct Selection {
    pub condition: ConditionId,
    /// Response shown in the large plot.
    pub pair: Pair,
    /// Model under the pointer.
    pub hovered: Option<ModelId>,
    /// Condition under the pointer, in the list or as a dot.
    pub hovered_condition: Option<ConditionId>,
    /// Describes the plot element under the pointer. It is shown in the status bar, because a
    /// tooltip would cover curves.
    pub pointed_words: Option<String>,
    /// The only model shown beside the representatives.
    pub isolated: Option<ModelId>,
    /// Value whose derivation is shown.
    pub explained: Option<ExplainTarget>,
}
