//! Losses of the schedule relative to the conditions' own corrections: omitted delays, higher J.
//!
//! The schedule gives gains and delays as a function of airspeed, fitted to the corrections that
//! are optimal in each condition (M11). J is the mismatch cost (M4).

use gdcm_method::correction::{Channel, ChannelCorrection};
use gdcm_method::schedule::ScheduleCaution;
use gdcm_method::schedule::assessment::corrected_cost_on;
use gdcm_method::schedule::caution::ScheduledCost;
use gdcm_model::dataset::{BundleKind, ConditionId, Pair};

use super::analysis::{Analysis, ConditionAnalysis};
use super::comparison::ModelMismatch;

/// Delay \[s\] below which a channel counts as undelayed: it is displayed as 0.0 ms.
const NO_DELAY_S: f64 = 5e-5;

/// A channel with a delay in some conditions' own corrections.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayedChannel {
    pub channel: Channel,
    /// The channel's delay in each such condition, longest first.
    pub delays: Vec<OwnDelay>,
}

/// A channel's delay in a condition's own correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnDelay {
    pub condition: ConditionId,
    pub delay_s: f64,
}

impl Analysis {
    /// Returns the channels with a delay in these conditions' own corrections.
    pub fn delayed_channels(&self, conditions: &[ConditionId]) -> Vec<DelayedChannel> {
        let mut found = Vec::new();
        for channel in Channel::of_dataset(&self.study.dataset) {
            let mut delays = Vec::new();
            for &condition in conditions {
                let Some(result) = self.condition(condition) else {
                    continue;
                };
                let delay_s = result.correction.pure_delay_s(channel);
                if delay_s >= NO_DELAY_S {
                    delays.push(OwnDelay { condition, delay_s });
                }
            }
            if !delays.is_empty() {
                delays.sort_by(|a, b| b.delay_s.total_cmp(&a.delay_s));
                found.push(DelayedChannel { channel, delays });
            }
        }
        found
    }

    /// Returns the delays in the scheduled conditions' own corrections that the schedule omits;
    /// empty where the schedule has delays, and where there is no schedule.
    pub fn unscheduled_delays(&self) -> Vec<DelayedChannel> {
        match &self.schedule {
            Ok(schedule) if !schedule.has_delays() => self.delayed_channels(&self.scheduled()),
            _ => Vec::new(),
        }
    }
}

/// Returns a caution about each condition in which the mean on-axis J under the schedule is above 1
/// (an error of 0.22 dB) and more than twice that under its own correction
/// ([`ScheduledCost::is_notable`], M11).
pub(crate) fn schedule_cost_cautions(analysis: &Analysis) -> Vec<ScheduleCaution> {
    let mut cautions = Vec::new();
    for result in analysis
        .conditions
        .values()
        .filter_map(|outcome| outcome.as_ref().ok())
    {
        if let Some(cost) = scheduled_cost(analysis, result).filter(ScheduledCost::is_notable) {
            cautions.push(ScheduleCaution::CostsMore(cost));
        }
    }
    cautions
}

/// Returns a condition's mean J over the on-axis responses (over all responses if none is on-axis),
/// under the schedule and under its own correction. The model is the nominal one, or the
/// representative if the nominal model is rejected. `None` without a schedule, or if no such
/// response can be compared.
fn scheduled_cost(analysis: &Analysis, result: &ConditionAnalysis) -> Option<ScheduledCost> {
    let schedule = analysis.schedule.as_ref().ok()?;
    let condition = &result.condition;
    let nominal = &condition.bundle(BundleKind::Physics)[condition.nominal()].name;
    let is_rejected = analysis
        .study
        .choice(condition.id())
        .physics
        .rejected
        .contains(nominal);
    let (model, against_flight) = if is_rejected {
        (
            result.representative_name(BundleKind::Physics),
            &result.comparison.representative,
        )
    } else {
        (nominal.as_str(), &result.comparison.nominal)
    };
    let scheduled = schedule.at_state(condition.flight_state());
    let mut sum = CostSum::default();
    for pair in analysis.study.dataset.measuring_pairs().marked() {
        let scheduled = cost_of(analysis, against_flight, &scheduled, pair);
        let own = cost_of(analysis, against_flight, &result.correction, pair);
        if let (Some(scheduled), Some(own)) = (scheduled, own) {
            sum.add(scheduled, own);
        }
    }
    if sum.count == 0 {
        return None;
    }
    let count = sum.count as f64;
    Some(ScheduledCost {
        condition: condition.id(),
        model: model.to_owned(),
        scheduled: sum.scheduled / count,
        own: sum.own / count,
    })
}

/// Returns a model's J in a response under a correction, from its mismatch against the identified
/// representative.
fn cost_of(
    analysis: &Analysis,
    against_flight: &ModelMismatch,
    correction: &ChannelCorrection,
    pair: Pair,
) -> Option<f64> {
    let mismatch = against_flight.mismatch[pair].as_ref()?;
    let average = analysis.study.settings.cost_average;
    Some(corrected_cost_on(mismatch, correction, pair, &analysis.omega, average)?.total())
}

/// Sums of J over responses.
#[derive(Default)]
struct CostSum {
    scheduled: f64,
    own: f64,
    count: usize,
}

impl CostSum {
    fn add(&mut self, scheduled: f64, own: f64) {
        self.scheduled += scheduled;
        self.own += own;
        self.count += 1;
    }
}
