//! Figures that can be explained.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_study::results::assessment_table::AssessmentChoice;

/// A figure of an analysis to be explained.
#[derive(Clone, Debug, PartialEq)]
pub enum ExplainTarget {
    /// Delta gain `G` of a response.
    DeltaGain(ConditionId, Pair),
    /// Delta delay `D` of a response.
    DeltaDelay(ConditionId, Pair),
    NetGain(ConditionId, Pair),
    NetDelay(ConditionId, Pair),
    Gain(ConditionId, Channel),
    Delay(ConditionId, Channel),
    GainBounds(ConditionId),
    DelayBound(ConditionId),
    /// J of a response of the uncorrected physics representative.
    CostBefore(ConditionId, Pair),
    /// J of a response of the physics representative, under the condition's own correction.
    CostAfter(ConditionId, Pair),
    /// Change of J of a response in an assessment.
    CostChange(ConditionId, Pair, AssessmentChoice),
    DiscontinuityRatio(ModelId),
    Score(ModelId),
    GainObjective(ConditionId),
    DelayObjective(ConditionId),
    /// Scheduled gain of a channel at an airspeed \[kt\].
    ScheduledGain(Channel, f64),
}
