//! Apparent differences of sign and unit between the two sides, reported first: before a delay,
//! zero or mode is blamed for their effect.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use gdcm_method::correction::Channel;
use gdcm_method::correction::delta::delta_gains;
use gdcm_method::fidelity::Mismatch;
use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, Pair, PairTable};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::FrequencyGrid;
use gdcm_model::statistics::median;
use gdcm_model::units::number;

use crate::decisions::study::Study;
use crate::stages::comparison::{Compared, Mismatches};
use crate::stages::condition_responses::ConditionResponses;
use crate::stages::execution::Execution;

/// A phase difference within this \[rad\] of half a turn indicates a reversed sign.
const NEAR_HALF_A_TURN: f64 = 20.0 / 180.0 * PI;
/// Usual limit of scale factors of channels, up or down; beyond it, a unit is suspected.
const USUAL_FACTOR: f64 = 5.0;
/// Greatest ratio of the factors of single responses to their median: models differ by that much
/// besides a unit.
const MOST_SPREAD: f64 = 2.0;
/// Tolerance for a factor to match a known one, as a ratio.
const NEAR_FACTOR: f64 = 1.08;
/// Known conversion factors between units, with their names.
const KNOWN_FACTORS: [(f64, &str); 6] = [
    (9.806_65, "g and m/s²"),
    (32.174, "g and ft/s²"),
    (180.0 / PI, "radians and degrees"),
    (100.0, "a fraction and percent"),
    (12.0, "feet and inches"),
    (1000.0, "a unit and its thousandth"),
];

/// The difference of convention between the two sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Convention {
    Sign,
    /// The unit: ratio of the identified models' values to the physics models' values.
    Factor(f64),
}

/// A channel with an apparent difference of convention between the identified and the physics
/// models.
#[derive(Clone, Debug, PartialEq)]
pub struct ConventionDoubt {
    pub convention: Convention,
    /// The responsible channel.
    pub channel: Channel,
    /// The measuring responses with the difference.
    pub pairs: Vec<Pair>,
    /// Whether all responses of the channel show it.
    pub all_responses: bool,
    /// The conditions with the difference, in file order.
    pub conditions: Vec<ConditionId>,
}

impl ConventionDoubt {
    /// Describes the suspected difference and how to settle it.
    pub fn words(&self, dataset: &Dataset) -> String {
        let channel = self.channel.name_in(dataset);
        let pairs: Vec<String> = self
            .pairs
            .iter()
            .map(|&pair| dataset.pair_name(pair))
            .collect();
        let ids: Vec<String> = self.conditions.iter().map(ToString::to_string).collect();
        let place = match self.conditions.len() {
            count if count == dataset.conditions().len() => "in every condition".to_owned(),
            1 => format!("in condition {}", ids[0]),
            _ => format!("in conditions {}", ids.join(", ")),
        };
        let alike = if self.all_responses {
            format!(", like all responses of {channel},")
        } else {
            String::new()
        };
        match self.convention {
            Convention::Sign => format!(
                "{} {} by half a turn at all frequencies{alike} {place}: {channel} of the identified models has the other sign. \
                 Turn it?",
                pairs.join(", "),
                if pairs.len() == 1 {
                    "differs"
                } else {
                    "differ"
                }
            ),
            Convention::Factor(factor) => {
                let near = KNOWN_FACTORS
                    .iter()
                    .find(|(known, _)| is_near(factor, *known));
                let units = near.map_or_else(String::new, |(known, units)| {
                    format!(
                        ", near {}: {units}",
                        if factor < 1.0 {
                            format!("1/{}", short(*known))
                        } else {
                            short(*known)
                        }
                    )
                });
                format!(
                    "{} of the identified models {} {} times that of the physics model{alike} {place}{units}. Check the unit of \
                     {channel}",
                    pairs.join(", "),
                    if pairs.len() == 1 { "is" } else { "are" },
                    short(factor)
                )
            }
        }
    }

    /// Returns the channel to reverse, where the sign is in doubt.
    pub fn turns(&self) -> Option<Channel> {
        (self.convention == Convention::Sign).then_some(self.channel)
    }
}

fn short(factor: f64) -> String {
    let digits = 10_f64.powf(2.0 - factor.log10().floor());
    number((factor * digits).round() / digits)
}

fn is_near(factor: f64, known: f64) -> bool {
    let ratio = if factor < 1.0 {
        factor * known
    } else {
        factor / known
    };
    (1.0 / NEAR_FACTOR..=NEAR_FACTOR).contains(&ratio)
}

/// The mismatches of one condition's models; quantities such as G are computed on demand, for few
/// responses.
struct Sample<'a> {
    condition: ConditionId,
    mismatch: &'a Mismatches,
    gains: PairTable<Option<f64>>,
}

impl Sample<'_> {
    /// Returns the responses of a channel that have a mismatch.
    fn of_channel(&self, channel: Channel) -> impl Iterator<Item = (Pair, &Mismatch)> {
        let own = self
            .mismatch
            .iter()
            .filter(move |(pair, _)| channel.is_of(*pair));
        own.filter_map(|(pair, mismatch)| Some((pair, mismatch.as_ref()?)))
    }

    /// Returns the share of a channel's responses that the opposite sign would bring nearer.
    fn opposed(&self, channel: Channel) -> f64 {
        let opposed: Vec<f64> = self
            .of_channel(channel)
            .map(|(_, mismatch)| {
                if weighted_sum(mismatch, f64::cos) < 0.0 {
                    1.0
                } else {
                    0.0
                }
            })
            .collect();
        opposed.iter().sum::<f64>() / opposed.len().max(1) as f64
    }

    /// Returns the natural logarithms of G of the responses of a channel.
    fn ln_gains(&self, channel: Channel) -> Vec<f64> {
        self.of_channel(channel)
            .filter_map(|(pair, _)| Some(self.gains[pair]?.ln()))
            .collect()
    }
}

/// Sums over frequency with the weights of J (M4a).
fn weighted_sum(mismatch: &Mismatch, of: impl Fn(f64) -> f64) -> f64 {
    let weight = |place: usize| mismatch.weights().map_or(1.0, |weights| weights[place]);
    mismatch
        .phase
        .iter()
        .enumerate()
        .map(|(place, phase)| weight(place) * of(*phase))
        .sum()
}

/// Returns whether the phase difference is near half a turn over most of the band.
fn is_turned(mismatch: &Mismatch) -> bool {
    let near = |phase: f64| {
        if PI - phase.abs() <= NEAR_HALF_A_TURN {
            1.0
        } else {
            0.0
        }
    };
    weighted_sum(mismatch, near) > 0.5 * weighted_sum(mismatch, |_| 1.0)
}

/// Collects the suspected sign and unit differences of each condition's representatives; signs
/// first.
pub(crate) fn convention_doubts(
    conditions: &[(ConditionId, &Mismatches)],
    measuring: &PairTable<bool>,
) -> Vec<ConventionDoubt> {
    let samples = conditions.iter().map(|(condition, mismatch)| Sample {
        condition: *condition,
        mismatch,
        gains: delta_gains(mismatch),
    });
    let samples: Vec<Sample<'_>> = samples.collect();
    let channels = || Channel::all(measuring.inputs(), measuring.outputs());
    let signs = channels().filter_map(|channel| sign_doubt(&samples, measuring, channel));
    signs
        .chain(channels().filter_map(|channel| factor_doubt(&samples, measuring, channel)))
        .collect()
}

/// Returns the other channel of a response.
fn other(channel: Channel, pair: Pair) -> Channel {
    let [output, input] = Channel::of(pair);
    if channel == output { input } else { output }
}

/// Evidence for a channel in one sample: the condition, the responses, and whether all responses of
/// the channel show it.
type Shown = (ConditionId, Vec<Pair>, bool);

fn sign_doubt(
    samples: &[Sample<'_>],
    measuring: &PairTable<bool>,
    channel: Channel,
) -> Option<ConventionDoubt> {
    let shown = samples.iter().map(|sample| {
        // Of the two channels of a response, blame the channel whose other responses are also
        // opposed; the output where both are.
        let is_to_blame = |pair: Pair| {
            let own = sample.opposed(channel);
            let of_other = sample.opposed(other(channel, pair));
            own > of_other || (own == of_other && matches!(channel, Channel::Output(_)))
        };
        let turned = sample
            .of_channel(channel)
            .filter(|(pair, mismatch)| measuring[*pair] && is_turned(mismatch));
        let turned = turned
            .map(|(pair, _)| pair)
            .filter(|pair| is_to_blame(*pair))
            .collect();
        (sample.condition, turned, sample.opposed(channel) == 1.0)
    });
    ConventionDoubt::of(Convention::Sign, channel, shown)
}

fn factor_doubt(
    samples: &[Sample<'_>],
    measuring: &PairTable<bool>,
    channel: Channel,
) -> Option<ConventionDoubt> {
    let is_far = |ln_gain: f64| ln_gain.abs() > USUAL_FACTOR.ln();
    let mut ln_gains = Vec::new();
    let shown = samples.iter().map(|sample| {
        // Of the two channels of a response, blame the channel whose other responses have about the
        // same factor.
        let is_to_blame = |pair: Pair, ln_gain: f64| {
            let apart = |channel| (median(&mut sample.ln_gains(channel)) - ln_gain).abs();
            let here = apart(channel);
            let there = apart(other(channel, pair));
            here < there || (here == there && matches!(channel, Channel::Output(_)))
        };
        let measured = sample
            .of_channel(channel)
            .filter(|(pair, _)| measuring[*pair]);
        let far = measured
            .filter_map(|(pair, _)| Some((pair, sample.gains[pair]?.ln())))
            .filter(|of| is_far(of.1));
        let (pairs, gains): (Vec<Pair>, Vec<f64>) = far
            .filter(|(pair, ln_gain)| is_to_blame(*pair, *ln_gain))
            .unzip();
        ln_gains.extend(gains);
        (
            sample.condition,
            pairs,
            sample.ln_gains(channel).into_iter().all(is_far),
        )
    });
    let shown: Vec<Shown> = shown.collect();
    let factor = median(&mut ln_gains);
    // A unit is a single factor: responses with different factors differ for another reason.
    if ln_gains
        .iter()
        .any(|ln_gain| (ln_gain - factor).abs() > MOST_SPREAD.ln())
    {
        return None;
    }
    ConventionDoubt::of(Convention::Factor(factor.exp()), channel, shown)
}

impl ConventionDoubt {
    /// Returns the suspected difference from the evidence of several conditions; `None` without
    /// evidence.
    fn of(
        convention: Convention,
        channel: Channel,
        shown: impl IntoIterator<Item = Shown>,
    ) -> Option<Self> {
        let shown: Vec<Shown> = shown
            .into_iter()
            .filter(|(_, pairs, _)| !pairs.is_empty())
            .collect();
        let pairs: BTreeSet<Pair> = shown
            .iter()
            .flat_map(|(_, pairs, _)| pairs)
            .copied()
            .collect();
        (!shown.is_empty()).then(|| Self {
            convention,
            channel,
            pairs: pairs.into_iter().collect(),
            all_responses: shown.iter().all(|(.., all)| *all),
            conditions: shown.iter().map(|(condition, ..)| *condition).collect(),
        })
    }
}

/// Compares the nominal physics model with the first kept identified model in each condition,
/// before any analysis.
///
/// # Errors
/// [`Cancelled`] where `execution` is cancelled.
pub fn doubts_of_models(
    study: &Study,
    execution: &Execution<'_>,
) -> Result<Vec<ConventionDoubt>, Cancelled> {
    let band = study.settings.band;
    let points = study.settings.points;
    let grid = FrequencyGrid::logarithmic(band, points);
    let mut tables = Vec::new();
    for condition in study.dataset.conditions() {
        let responses = ConditionResponses::of(condition, (band, points), execution)?;
        let rejected = &study.choice(condition.id()).identified.rejected;
        let models = condition.bundle(BundleKind::Identified).iter();
        let kept = models
            .enumerate()
            .find(|(_, model)| !rejected.contains(&model.name));
        let compared = |kind, model| {
            Compared::of(
                condition,
                &responses,
                (kind, model),
                (&grid, study.settings.coherence_threshold),
            )
        };
        let physics = compared(BundleKind::Physics, condition.nominal());
        let mismatch =
            kept.map(|(model, _)| physics.against(&compared(BundleKind::Identified, model)));
        tables.extend(mismatch.map(|mismatch| (condition.id(), mismatch)));
    }
    let tables: Vec<(ConditionId, &Mismatches)> = tables
        .iter()
        .map(|(id, mismatch)| (*id, mismatch))
        .collect();
    Ok(convention_doubts(&tables, &study.dataset.measuring_pairs()))
}
