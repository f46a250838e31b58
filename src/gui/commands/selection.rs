//! Commands about selected and highlighted parts.

use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_words::derivation::ExplainTarget;

/// Selects or highlights a condition, a response, a model or a value.
#[derive(Clone, Debug, PartialEq)]
pub enum SelectionCommand {
    SelectCondition(ConditionId),
    /// Shows a response in the large plot.
    FocusPair(Pair),
    /// Highlights a model in every view; sent again in each frame.
    Hover(ModelId),
    /// Highlights a condition for this frame.
    HoverCondition(ConditionId),
    /// Describes the plot element under the pointer in the status bar, for this frame.
    ShowStatus(String),
    /// Shows only this model beside the representatives; a second command with the same model shows
    /// all models again.
    Isolate(ModelId),
    /// Shows a value's derivation, or closes it.
    Explain(Option<ExplainTarget>),
    /// Shows all models again and clears the selection.
    EndIsolation,
}
