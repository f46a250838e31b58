//! Results whose derivation can be displayed.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_study::results::assessment_table::AssessmentChoice;

/// A result in an analysis whose derivation can be displayed.
#[derive(Clone, Debug, PartialEq)]
pub enum ExplainTarget {
    /// A response's delta gain `G`.
    DeltaGain(ConditionId, Pair),
    /// A response's delta delay `D`.
    DeltaDelay(ConditionId, Pair),
    NetGain(ConditionId, Pair),
    NetDelay(ConditionId, Pair),
    Gain(ConditionId, Channel),
    Delay(ConditionId, Channel),
    GainBounds(ConditionId),
    DelayBound(ConditionId),
    /// The uncorrected physics representative's J in a response.
    CostBefore(ConditionId, Pair),
    /// The physics representative's J in a response, with the condition's own correction.
    CostAfter(ConditionId, Pair),
    /// Change in a response's J in an assessment.
    CostChange(ConditionId, Pair, AssessmentChoice),
    DiscontinuityRatio(ModelId),
    Score(ModelId),
    GainObjective(ConditionId),
    DelayObjective(ConditionId),
    /// A channel's scheduled gain at an airspeed \[kt\].
    ScheduledGain(Channel, f64),
}
