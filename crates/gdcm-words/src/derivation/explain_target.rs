//! Results whose derivation can be displayed.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_study::results::assessment_table::AssessmentChoice;

/// A result of an analysis whose derivation can be displayed.
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
    /// J of the uncorrected physics representative in a response.
    CostBefore(ConditionId, Pair),
    /// J of the physics representative in a response, with the condition's own correction.
    CostAfter(ConditionId, Pair),
    /// Change in J of a response in an assessment.
    CostChange(ConditionId, Pair, AssessmentChoice),
    DiscontinuityRatio(ModelId),
    Score(ModelId),
    GainObjective(ConditionId),
    DelayObjective(ConditionId),
    /// Scheduled gain of a channel at an airspeed \[kt\].
    ScheduledGain(Channel, f64),
}
