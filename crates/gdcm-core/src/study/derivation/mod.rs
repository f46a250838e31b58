//! How a figure was computed: the equation, the same with its numbers in place, and what it rests on.

mod bundles;
mod channels;
mod context;
mod costs;
mod deltas;
mod schedules;
mod swaps;

use crate::correction::{Channel, GainObjective};
use crate::dataset::{ConditionId, ModelId, Pair};
use crate::fidelity::CostAverage;

use super::analysis::Analysis;
use super::assessment_table::AssessmentChoice;

use context::Context;

/// A figure of an analysis that is asked about.
#[derive(Clone, Debug, PartialEq)]
pub enum ExplainTarget {
    /// Delta gain `G` of a response.
    DeltaGain(ConditionId, Pair),
    /// Delta delay `D` of a response.
    DeltaDelay(ConditionId, Pair),
    /// Net gain of a response.
    NetGain(ConditionId, Pair),
    /// Net delay of a response.
    NetDelay(ConditionId, Pair),
    /// Gain of a channel.
    Gain(ConditionId, Channel),
    /// Delay of a channel.
    Delay(ConditionId, Channel),
    /// Lower and upper bound of the gains.
    GainBounds(ConditionId),
    /// Upper bound of the delays.
    DelayBound(ConditionId),
    /// J of a response of the physics representative, as it is.
    CostBefore(ConditionId, Pair),
    /// J of the same under the condition's own correction.
    CostAfter(ConditionId, Pair),
    /// Change of J of a response in an assessment.
    CostChange(ConditionId, Pair, AssessmentChoice),
    /// Discontinuity ratio of a physics model.
    DiscontinuityRatio(ModelId),
    /// Score of a model in its bundle.
    Score(ModelId),
    /// Objective of the gains.
    GainObjective(ConditionId),
    /// Objective of the delays.
    DelayObjective(ConditionId),
    /// Scheduled gain of a channel at an airspeed \[kt\].
    ScheduledGain(Channel, f64),
}

/// How one figure was computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Derivation {
    /// What it is: "G of LON → Q, condition 3".
    pub title: String,
    /// The equation, as in the method's description.
    pub equation: String,
    /// The equation with its numbers in place, step by step; the last step ends in the figure.
    pub with_numbers: Vec<String>,
    /// The models, the band, the points and the choices that it rests on.
    pub rests_on: Vec<String>,
    /// Where the method describes it: "M6, eq. (5)".
    pub section: &'static str,
    /// The figure itself, in the unit that the steps name; of bounds the upper one.
    pub value: f64,
}

/// How a figure of `analysis` was computed; `None` where it has no such figure. A few medians over frequency at most.
pub fn derivation(analysis: &Analysis, asked: &ExplainTarget) -> Option<Derivation> {
    let of = |condition: &ConditionId| Context::of(analysis, *condition);
    let of_pair = |condition: &ConditionId, pair: &Pair| {
        analysis.study.dataset.on_axis().get(*pair)?;
        of(condition)
    };
    let found = match asked {
        ExplainTarget::DeltaGain(id, pair) => deltas::gain(&of_pair(id, pair)?, *pair),
        ExplainTarget::DeltaDelay(id, pair) => deltas::delay(&of_pair(id, pair)?, *pair),
        ExplainTarget::GainBounds(id) => Some(deltas::gain_bounds(&of(id)?)),
        ExplainTarget::DelayBound(id) => Some(deltas::delay_bound(&of(id)?)),
        ExplainTarget::NetGain(id, pair) => Some(channels::net_gain(&of_pair(id, pair)?, *pair)),
        ExplainTarget::NetDelay(id, pair) => Some(channels::net_delay(&of_pair(id, pair)?, *pair)),
        ExplainTarget::Gain(id, channel) => channels::gain(&of(id)?, *channel),
        ExplainTarget::Delay(id, channel) => channels::delay(&of(id)?, *channel),
        ExplainTarget::GainObjective(id) => Some(channels::gain_objective(&of(id)?)),
        ExplainTarget::DelayObjective(id) => Some(channels::delay_objective(&of(id)?)),
        ExplainTarget::CostBefore(id, pair) => costs::before(&of_pair(id, pair)?, *pair),
        ExplainTarget::CostAfter(id, pair) => costs::after(&of_pair(id, pair)?, *pair),
        ExplainTarget::CostChange(id, pair, choice) => costs::change(&of_pair(id, pair)?, *pair, *choice),
        ExplainTarget::DiscontinuityRatio(model) => bundles::ratio(&of(&model.condition)?, model),
        ExplainTarget::Score(model) => bundles::score(&of(&model.condition)?, model),
        ExplainTarget::ScheduledGain(channel, airspeed_kt) => schedules::gain(analysis, *channel, *airspeed_kt),
    };
    found.map(|mut found| {
        found.rests_on.extend(swaps::sure(analysis, asked));
        found
    })
}

/// The average over frequency, as an equation writes it.
fn average_word(average: CostAverage) -> &'static str {
    match average {
        CostAverage::Median => "median",
        CostAverage::Mean => "mean",
    }
}

/// What the gains minimise, as an equation writes it: the equation, and the unit of its value.
fn gain_objective_equation(objective: GainObjective) -> (&'static str, &'static str) {
    match objective {
        GainObjective::Ratio => ("Σ w (G − k_o k_i)² + α Σ (k_o − 1)²", ""),
        GainObjective::Decibel => ("Σ w (20 log10 G − 20 log10 k_o k_i)² + α Σ (20 log10 k_o)²", " dB²"),
    }
}
