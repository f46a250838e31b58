//! Search for apparent sign and unit differences between the two bundles.
//!
//! ```text
//! phi  phase difference of a response between identified and physics model
//! W    weight of a frequency, as in J (M4a)
//! G    ratio of their gains (M6)
//!
//! sign  reversed: the weighted majority of frequencies has |phi| within 20 deg of half a turn.
//!       Attributed to the channel of the response with the larger share of *opposed* responses,
//!       which match better with the other sign: sum W cos phi < 0
//! unit  |ln G| > ln 5. Attributed to the channel of the response with the nearer median of ln G;
//!       all such responses of the channel agree within a factor of 2 of their median
//! ```
//!
//! Every response with a difference counts once, for its output or for its input; the output is
//! chosen where both are equally likely. The limits are those of M6c (`docs/method.md`).

use std::collections::BTreeSet;
use std::f64::consts::PI;

use gdcm_method::correction::Channel;
use gdcm_method::correction::delta::delta_gains;
use gdcm_method::fidelity::Mismatch;
use gdcm_model::dataset::{BundleKind, ConditionId, Pair, PairTable};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::FrequencyGrid;
use gdcm_model::statistics::median;

use super::compared_model::{ComparedModel, ComparisonGrid};
use super::condition_responses::ConditionResponses;
use crate::decisions::study::Study;
use crate::execution::Execution;
use crate::results::comparison::Mismatches;
use crate::results::convention_doubt::{Convention, ConventionDoubt};

/// A phase difference this close to half a turn \[rad\] indicates a reversed sign.
const NEAR_HALF_A_TURN: f64 = 20.0 / 180.0 * PI;
/// Maximum usual factor between gains, up or down; a larger factor suggests another unit.
const USUAL_FACTOR: f64 = 5.0;
/// Maximum ratio between a single response's factor and its channel's median factor if a unit is
/// the cause: models differ by this much for other reasons.
const LARGEST_RATIO: f64 = 2.0;

/// A condition's mismatches.
struct Sample<'a> {
    condition: ConditionId,
    mismatch: &'a Mismatches,
    /// G, response by response.
    gains: PairTable<Option<f64>>,
}

impl Sample<'_> {
    /// Returns a channel's responses that have a mismatch.
    fn of_channel(&self, channel: Channel) -> impl Iterator<Item = (Pair, &Mismatch)> {
        self.mismatch
            .iter()
            .filter(move |(pair, _)| channel.belongs_to(*pair))
            .filter_map(|(pair, mismatch)| Some((pair, mismatch.as_ref()?)))
    }

    /// Returns the share of a channel's responses that are closer to flight with the opposite sign.
    fn opposed_share(&self, channel: Channel) -> f64 {
        let mut responses = 0;
        let mut opposed = 0;
        for (_, mismatch) in self.of_channel(channel) {
            responses += 1;
            if weighted_sum(mismatch, f64::cos) < 0.0 {
                opposed += 1;
            }
        }
        f64::from(opposed) / f64::from(responses.max(1))
    }

    /// Returns `ln G` for a channel's responses.
    fn ln_gains(&self, channel: Channel) -> Vec<f64> {
        self.of_channel(channel)
            .filter_map(|(pair, _)| Some(self.gains[pair]?.ln()))
            .collect()
    }

    /// Returns whether a response's reversed sign is attributed to this channel rather than to the
    /// response's other channel. The channel with the larger share of opposed responses is chosen;
    /// the output if the shares are equal.
    fn attributes_sign_to(&self, channel: Channel, pair: Pair) -> bool {
        let here = self.opposed_share(channel);
        let there = self.opposed_share(other_channel(channel, pair));
        here > there || (here == there && matches!(channel, Channel::Output(_)))
    }

    /// Returns whether a response's unusual factor is attributed to this channel's unit rather than
    /// to that of the response's other channel. The channel whose median factor is nearer is
    /// chosen; the output if both are equally near.
    fn attributes_factor_to(&self, channel: Channel, pair: Pair, ln_gain: f64) -> bool {
        let distance = |channel| (median(&mut self.ln_gains(channel)) - ln_gain).abs();
        let here = distance(channel);
        let there = distance(other_channel(channel, pair));
        here < there || (here == there && matches!(channel, Channel::Output(_)))
    }
}

/// Returns a response's other channel.
fn other_channel(channel: Channel, pair: Pair) -> Channel {
    let [output, input] = Channel::of_pair(pair);
    if channel == output { input } else { output }
}

/// Sums a function of the phase difference over frequency, weighted as in J (M4a).
fn weighted_sum(mismatch: &Mismatch, function: impl Fn(f64) -> f64) -> f64 {
    let weights = mismatch.weights();
    mismatch
        .phase
        .iter()
        .enumerate()
        .map(|(index, phase)| {
            let weight = match weights {
                Some(weights) => weights[index],
                None => 1.0,
            };
            weight * function(*phase)
        })
        .sum()
}

/// Returns whether the phase difference is near half a turn at the weighted majority of
/// frequencies.
fn is_reversed(mismatch: &Mismatch) -> bool {
    let weight_near = weighted_sum(mismatch, |phase| {
        if PI - phase.abs() <= NEAR_HALF_A_TURN {
            1.0
        } else {
            0.0
        }
    });
    let whole_weight = weighted_sum(mismatch, |_| 1.0);
    weight_near > 0.5 * whole_weight
}

/// Evidence for a difference in a channel, from one condition.
struct Evidence {
    condition: ConditionId,
    /// The responses that show the difference.
    pairs: Vec<Pair>,
    /// Whether all the channel's responses support the difference, not only `pairs`.
    is_everywhere: bool,
}

/// Collects the suspected sign and unit differences from all conditions, sign differences first.
/// `measuring` marks the responses that can indicate a difference: the on-axis responses, or all if
/// none is on-axis.
pub(crate) fn convention_doubts(
    conditions: &[(ConditionId, &Mismatches)],
    measuring: &PairTable<bool>,
) -> Vec<ConventionDoubt> {
    let samples: Vec<Sample<'_>> = conditions
        .iter()
        .map(|(condition, mismatch)| Sample {
            condition: *condition,
            mismatch,
            gains: delta_gains(mismatch),
        })
        .collect();
    let channels: Vec<Channel> =
        Channel::inputs_then_outputs(measuring.inputs(), measuring.outputs()).collect();
    let mut doubts = Vec::new();
    for channel in &channels {
        doubts.extend(sign_doubt(&samples, measuring, *channel));
    }
    for channel in &channels {
        doubts.extend(factor_doubt(&samples, measuring, *channel));
    }
    doubts
}

/// Returns the suspicion that a channel's sign is reversed; `None` without evidence.
fn sign_doubt(
    samples: &[Sample<'_>],
    measuring: &PairTable<bool>,
    channel: Channel,
) -> Option<ConventionDoubt> {
    let evidence = samples.iter().map(|sample| Evidence {
        condition: sample.condition,
        pairs: sample
            .of_channel(channel)
            .filter(|(pair, mismatch)| {
                measuring[*pair]
                    && is_reversed(mismatch)
                    && sample.attributes_sign_to(channel, *pair)
            })
            .map(|(pair, _)| pair)
            .collect(),
        is_everywhere: sample.opposed_share(channel) == 1.0,
    });
    doubt_from(Convention::Sign, channel, evidence.collect())
}

/// Returns the suspicion that a channel's unit differs; `None` without evidence, or if the factors
/// differ too much for a unit.
fn factor_doubt(
    samples: &[Sample<'_>],
    measuring: &PairTable<bool>,
    channel: Channel,
) -> Option<ConventionDoubt> {
    let mut ln_gains = Vec::new();
    let mut evidence = Vec::new();
    for sample in samples {
        let mut pairs = Vec::new();
        for (pair, _) in sample.of_channel(channel) {
            let Some(gain) = sample.gains[pair] else {
                continue;
            };
            let ln_gain = gain.ln();
            if measuring[pair]
                && is_unusual(ln_gain)
                && sample.attributes_factor_to(channel, pair, ln_gain)
            {
                pairs.push(pair);
                ln_gains.push(ln_gain);
            }
        }
        evidence.push(Evidence {
            condition: sample.condition,
            pairs,
            is_everywhere: sample.ln_gains(channel).into_iter().all(is_unusual),
        });
    }
    let ln_factor = median(&mut ln_gains);
    // A unit acts as a single factor: different factors have another cause.
    let is_spread = ln_gains
        .iter()
        .any(|ln_gain| (ln_gain - ln_factor).abs() > LARGEST_RATIO.ln());
    if is_spread {
        return None;
    }
    doubt_from(Convention::Factor(ln_factor.exp()), channel, evidence)
}

/// Returns whether a factor exceeds the usual factor, up or down.
fn is_unusual(ln_gain: f64) -> bool {
    ln_gain.abs() > USUAL_FACTOR.ln()
}

/// Returns the difference suggested by the evidence from several conditions; `None` without
/// evidence.
fn doubt_from(
    convention: Convention,
    channel: Channel,
    mut evidence: Vec<Evidence>,
) -> Option<ConventionDoubt> {
    evidence.retain(|evidence| !evidence.pairs.is_empty());
    if evidence.is_empty() {
        return None;
    }
    let pairs: BTreeSet<Pair> = evidence
        .iter()
        .flat_map(|evidence| &evidence.pairs)
        .copied()
        .collect();
    Some(ConventionDoubt {
        convention,
        channel,
        pairs: pairs.into_iter().collect(),
        all_responses: evidence.iter().all(|evidence| evidence.is_everywhere),
        conditions: evidence.iter().map(|evidence| evidence.condition).collect(),
    })
}

/// Finds sign and unit differences before any analysis: compares the nominal physics model with the
/// first kept identified model in each condition.
///
/// # Errors
/// [`Cancelled`] where `execution` is cancelled.
pub fn doubts_of_models(
    study: &Study,
    execution: &Execution<'_>,
) -> Result<Vec<ConventionDoubt>, Cancelled> {
    let settings = &study.settings;
    let grid = FrequencyGrid::logarithmic(settings.band, settings.points);
    let comparison_grid = ComparisonGrid {
        grid: &grid,
        coherence: settings.coherence_threshold,
    };
    let mut mismatches = Vec::new();
    for condition in study.dataset.conditions() {
        let key = (settings.band, settings.points);
        let responses = ConditionResponses::compute(condition, key, execution)?;
        let rejected = &study.choice(condition.id()).identified.rejected;
        let kept = condition
            .bundle(BundleKind::Identified)
            .iter()
            .position(|model| !rejected.contains(&model.name));
        let compared =
            |kind, model| ComparedModel::new(condition, &responses, kind, model, comparison_grid);
        if let Some(kept) = kept {
            let physics = compared(BundleKind::Physics, condition.nominal());
            let identified = compared(BundleKind::Identified, kept);
            mismatches.push((condition.id(), physics.mismatches(&identified)));
        }
    }
    let samples: Vec<(ConditionId, &Mismatches)> = mismatches
        .iter()
        .map(|(id, mismatch)| (*id, mismatch))
        .collect();
    Ok(convention_doubts(
        &samples,
        &study.dataset.measuring_pairs(),
    ))
}
