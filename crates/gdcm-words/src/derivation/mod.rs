//! Derivations of results: the equation with its symbols explained, the same with numbers, and the
//! underlying models and choices.

mod bounds;
mod channels;
mod context;
mod costs;
mod deltas;
mod distances;
mod error_bars;
mod explain_target;
mod sample_words;
mod scheduled_gain;
mod terms;

use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_study::Analysis;

use context::Context;
pub use error_bars::SPREAD_ALONE;
pub use explain_target::ExplainTarget;

/// A result's derivation: equation, equation with numbers, and the models and choices on which the
/// result rests.
#[derive(Clone, Debug, PartialEq)]
pub struct Derivation {
    /// The result's name with its condition: "G of LON → Q, condition 3".
    pub title: String,
    /// The equation, as in the method description.
    pub equation: String,
    /// The equation with numbers, step by step; the last step contains the result.
    pub with_numbers: Vec<String>,
    /// Models, band, points and choices on which the result rests.
    pub rests_on: Vec<String>,
    /// Section in the method description: "M6, eq. (5)".
    pub section: &'static str,
    /// The result, in the unit that the steps have; for bounds, the upper bound.
    pub value: f64,
}

impl Derivation {
    /// Returns the equation's symbols with their meanings, in order of appearance.
    pub fn terms(&self) -> Vec<(&'static str, &'static str)> {
        terms::terms_of(&self.equation)
    }
}

/// Derives a result in `analysis`; `None` if the result does not exist. This is cheap: at most a
/// few medians over frequency are computed.
pub fn derivation(analysis: &Analysis, target: &ExplainTarget) -> Option<Derivation> {
    let mut derivation = derivation_without_bar(analysis, target)?;
    derivation
        .rests_on
        .extend(error_bars::error_bar_lines(analysis, target));
    Some(derivation)
}

fn derivation_without_bar(analysis: &Analysis, target: &ExplainTarget) -> Option<Derivation> {
    let condition = |id: &ConditionId| Context::new(analysis, *id);
    let response = |id: &ConditionId, pair: &Pair| {
        // `pair` may come from another dataset and may not exist in this one.
        analysis.study.dataset.on_axis().get(*pair)?;
        Context::new(analysis, *id)
    };
    match target {
        ExplainTarget::DeltaGain(id, pair) => deltas::gain(&response(id, pair)?, *pair),
        ExplainTarget::DeltaDelay(id, pair) => deltas::delay(&response(id, pair)?, *pair),
        ExplainTarget::GainBounds(id) => Some(bounds::gain_bounds(&condition(id)?)),
        ExplainTarget::DelayBound(id) => Some(bounds::delay_bound(&condition(id)?)),
        ExplainTarget::NetGain(id, pair) => Some(channels::net_gain(&response(id, pair)?, *pair)),
        ExplainTarget::NetDelay(id, pair) => Some(channels::net_delay(&response(id, pair)?, *pair)),
        ExplainTarget::Gain(id, channel) => channels::gain(&condition(id)?, *channel),
        ExplainTarget::Delay(id, channel) => channels::delay(&condition(id)?, *channel),
        ExplainTarget::GainObjective(id) => Some(channels::gain_objective(&condition(id)?)),
        ExplainTarget::DelayObjective(id) => Some(channels::delay_objective(&condition(id)?)),
        ExplainTarget::CostBefore(id, pair) => costs::cost_before(&response(id, pair)?, *pair),
        ExplainTarget::CostAfter(id, pair) => costs::cost_after(&response(id, pair)?, *pair),
        ExplainTarget::CostChange(id, pair, choice) => {
            costs::change(&response(id, pair)?, *pair, *choice)
        }
        ExplainTarget::DiscontinuityRatio(model) => {
            distances::ratio(&condition(&model.condition)?, model)
        }
        ExplainTarget::Score(model) => distances::score(&condition(&model.condition)?, model),
        ExplainTarget::ScheduledGain(channel, airspeed_kt) => {
            scheduled_gain::scheduled_gain(analysis, *channel, *airspeed_kt)
        }
    }
}
