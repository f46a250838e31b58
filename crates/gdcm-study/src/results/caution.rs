//! Cautions about results that are available nevertheless.

use std::fmt;
use std::sync::Arc;

use gdcm_method::correction::delta::LARGEST_GAIN_DB;
use gdcm_method::fidelity::distance::{DiscontinuityError, MeasuredPairs};
use gdcm_model::dataset::{BundleKind, Condition, Dynamics, Model, Pair};
use gdcm_model::response::large_entry::LargeEntry;
use gdcm_model::response::{FrequencyResponse, PolarResponse};
use gdcm_model::units::number;

use crate::decisions::study::BundleChoice;

/// A caution attached to a result.
#[derive(Clone, Debug, PartialEq)]
pub enum Caution {
    /// A constrained response has no G and no D in this condition, and is not constrained there.
    HeldButUndefined { pair: Pair, why: Undefined },
    /// No outliers can be suggested.
    NoSuggestions(DiscontinuityError),
    /// A model is excluded from distances, suggestions and representatives (M5b).
    SetAside {
        model: BundleModel,
        /// The measuring responses that it lacks and another model of its bundle has.
        lacks: Vec<Pair>,
        /// The missing responses that are zero wherever they have values.
        zero: Vec<Pair>,
        /// Why other responses are not finite; the rest is zero somewhere in the band.
        why: Option<NotFinite>,
        /// Whether it was pinned, without effect.
        pinned: bool,
    },
    NotFinite {
        model: BundleModel,
        responses: Vec<Pair>,
        why: NotFinite,
    },
    /// A measured model has responses that are zero at every measured frequency: not measured, or
    /// not found by name.
    MissingResponses {
        model: BundleModel,
        responses: Vec<Pair>,
    },
    /// Two models differ in some responses by a factor that cannot be a gain: beyond 1e50 or 1e-50
    /// (M6).
    GainsOutOfRange {
        physics: String,
        identified: String,
        responses: Vec<GainOutOfRange>,
    },
    /// Responses of a representative treated as structurally zero (M6a).
    NumericallyNothing {
        model: BundleModel,
        responses: Vec<Pair>,
    },
    /// Frequencies of the identified representative's responses have no weight, because it was not
    /// measured there (M4a).
    NotCoherent {
        /// Least coherence of a frequency that counts.
        threshold: f64,
        /// Number of responses weighted by coherence.
        weighed: usize,
        /// Number of omitted frequencies of each response, in descending order.
        left_out: Vec<(Pair, usize)>,
        points: usize,
    },
    /// The identified representative has measured coherence, and weighting by coherence is switched
    /// off (M4a).
    CoherenceNotUsed,
    /// The channels of models were assigned by position, because their files do not name them.
    ChannelsByPosition {
        bundle: BundleKind,
        models: Vec<String>,
    },
    /// The objective fits a response whose G is far from one.
    UnusualGain { pair: Pair, gain: f64 },
}

/// A response whose gain, flight over physics, is out of the computable range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GainOutOfRange {
    pub pair: Pair,
    /// The gain farthest from one within the band, as the nearest power of ten.
    pub power_of_ten: i32,
}

impl GainOutOfRange {
    /// Returns the out-of-range gains of two models.
    pub(crate) fn of_models(physics: &PolarResponse, identified: &PolarResponse) -> Vec<Self> {
        physics
            .curves()
            .pairs()
            .filter_map(|pair| Self::of_pair(physics, identified, pair))
            .collect()
    }

    /// Returns the out-of-range gain of one response; `None` where a model lacks it, or its gain is
    /// in range.
    pub(crate) fn of_pair(
        physics: &PolarResponse,
        identified: &PolarResponse,
        pair: Pair,
    ) -> Option<Self> {
        let physics = physics.curves()[pair].as_ref()?;
        let identified = identified.curves()[pair].as_ref()?;
        let gains_db = identified
            .magnitude_db
            .iter()
            .zip(&physics.magnitude_db)
            .map(|(flight, model)| flight - model);
        let farthest_db = gains_db.max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        if farthest_db.abs() < LARGEST_GAIN_DB {
            return None;
        }
        Some(Self {
            pair,
            power_of_ten: (farthest_db / 20.0).round() as i32,
        })
    }
}

/// Returns the computable range of gains in words.
const GAIN_RANGE: &str = "gains are computed with from 1e-50 to 1e50";

/// A model by its bundle and its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BundleModel {
    pub bundle: BundleKind,
    pub name: String,
}

impl BundleModel {
    pub(crate) fn of(condition: &Condition, bundle: BundleKind, model: usize) -> Self {
        Self {
            bundle,
            name: condition.bundle(bundle)[model].name.clone(),
        }
    }
}

impl fmt::Display for BundleModel {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} model \"{}\"", self.bundle, self.name)
    }
}

/// Why a response has no G and no D.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Undefined {
    /// Zero over the whole band in the representative of this bundle.
    Zero(BundleKind),
    /// Zero at some frequency of the band in the representative of this bundle.
    ZeroSomewhere(BundleKind),
    /// Not finite somewhere in the band in the representative of this bundle.
    NotFinite(BundleKind),
    /// The gain, flight over physics, is about this power of ten: beyond 1e50 or 1e-50.
    GainOutOfRange(i32),
    /// Numerically zero in the representative of this bundle (M6a).
    NumericallyNothing(BundleKind),
    /// No frequency of the identified representative's response is coherent enough, or all lie
    /// outside its valid band (M4a).
    NotCoherent,
    /// The identified representative is measured, and none of its files contains this response.
    NotMeasured,
}

impl Undefined {
    /// Returns the stable code.
    pub fn code(self) -> &'static str {
        match self {
            Self::Zero(_) => "response-zero",
            Self::ZeroSomewhere(_) => "response-zero-somewhere",
            Self::NotFinite(_) => "response-not-finite",
            Self::GainOutOfRange(_) => "gain-out-of-range",
            Self::NumericallyNothing(_) => "response-numerically-nothing",
            Self::NotCoherent => "response-not-coherent",
            Self::NotMeasured => "response-not-measured",
        }
    }
}

impl fmt::Display for Undefined {
    /// Returns the reason in words that begin with "its response".
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Undefined::Zero(bundle) => {
                write!(formatter, "its response is zero over the whole band in the {bundle} model")
            }
            Undefined::ZeroSomewhere(bundle) => {
                write!(formatter, "its response is zero at some frequency of the band in the {bundle} model")
            }
            Undefined::NotFinite(bundle) => {
                write!(formatter, "its response is not finite at some frequency of the band in the {bundle} model")
            }
            Undefined::GainOutOfRange(power_of_ten) => write!(
                formatter,
                "its response has a gain of about 1e{power_of_ten} between the physics and the identified model, and {GAIN_RANGE}: \
                 check the units and the matrices of both"
            ),
            Undefined::NotCoherent => formatter.write_str(
                "its response was not measured: no frequency of the band is coherent enough, or lies in the valid band",
            ),
            Undefined::NotMeasured => {
                formatter.write_str("its response was not measured: the identified model has no numbers of it")
            }
            Undefined::NumericallyNothing(bundle) => {
                write!(formatter, "its response is numerically nothing in the {bundle} model: {NOTHING}")
            }
        }
    }
}

/// Definition of "numerically nothing" (M6a).
const NOTHING: &str =
    "over the band less than 1e-6 of the greatest response of its output and of its input";

/// Why a model has responses that are not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotFinite {
    /// An entry of its matrices is too large to compute with.
    Entry(LargeEntry),
    /// The model is measured over a part of the band only.
    Measured {
        /// First measured frequency \[rad/s\].
        min: f64,
        /// Last measured frequency \[rad/s\].
        max: f64,
    },
    /// The model is discrete-time, and the band extends beyond its Nyquist frequency (M2a).
    Sampled {
        /// Sample time \[s\].
        sample_time_s: f64,
        /// Upper end of its response, `pi / T` \[rad/s\].
        nyquist_rad_s: f64,
    },
    /// A pole on the imaginary axis, or an overflow.
    Pole,
}

impl NotFinite {
    /// Returns why a model with these dynamics has a response that is not finite in a band that
    /// ends at `top` \[rad/s\].
    fn of(dynamics: &Dynamics, top: f64) -> Self {
        match dynamics {
            Dynamics::StateSpace(model) => {
                let timing = model.timing();
                let sampled = timing
                    .sample_time_s
                    .zip(timing.nyquist_rad_s().filter(|nyquist| top >= *nyquist));
                let sampled = sampled.map(|(sample_time_s, nyquist_rad_s)| Self::Sampled {
                    sample_time_s,
                    nyquist_rad_s,
                });
                LargeEntry::find(model)
                    .map(NotFinite::Entry)
                    .or(sampled)
                    .unwrap_or(NotFinite::Pole)
            }
            Dynamics::Measured(response) => {
                let omega = response.omega();
                NotFinite::Measured {
                    min: omega[0],
                    max: omega[omega.len() - 1],
                }
            }
        }
    }
}

impl fmt::Display for NotFinite {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotFinite::Entry(entry) => write!(formatter, "{entry}: correct the file, or reject the model"),
            NotFinite::Measured { min, max } => {
                // Six decimals suffice in a message.
                let round = |omega: f64| (omega * 1e6).round() / 1e6;
                let min = round(*min);
                let max = round(*max);
                write!(formatter, "it is measured from {min} to {max} rad/s only: narrow the band, or reject the model")
            }
            NotFinite::Sampled { sample_time_s, nyquist_rad_s } => write!(
                formatter,
                "it is of discrete time, T = {} s, and has no response from π/T = {nyquist_rad_s:.4} rad/s on: narrow the \
                 band, or reject the model",
                number(*sample_time_s)
            ),
            NotFinite::Pole => formatter.write_str(
                "a pole lies on a frequency of the grid, or its numbers overflow: change the band or the \
                 number of frequencies, or reject the model",
            ),
        }
    }
}

/// Range of usual G; beyond it, suspect a change of units or the sign of a meaningless response.
const USUAL_GAINS: std::ops::RangeInclusive<f64> = 0.1..=10.0;

impl Caution {
    /// Returns the caution about a fitted G outside the usual range, if it is.
    pub(crate) fn of_gain(pair: Pair, gain: f64) -> Option<Self> {
        (!USUAL_GAINS.contains(&gain)).then_some(Caution::UnusualGain { pair, gain })
    }

    /// Returns the stable code.
    pub fn code(&self) -> &'static str {
        match self {
            Caution::HeldButUndefined { .. } => "held-but-undefined",
            Caution::NoSuggestions(_) => "no-suggestions",
            Caution::SetAside { .. } => "set-aside",
            Caution::NotFinite { .. } => "response-not-finite",
            Caution::MissingResponses { .. } => "response-missing",
            Caution::GainsOutOfRange { .. } => "gain-out-of-range",
            Caution::NumericallyNothing { .. } => "response-numerically-nothing",
            Caution::NotCoherent { .. } => "not-coherent",
            Caution::CoherenceNotUsed => "coherence-not-used",
            Caution::ChannelsByPosition { .. } => "channels-by-position",
            Caution::UnusualGain { .. } => "unusual-gain",
        }
    }

    /// Returns whether the caution reports a model set aside.
    pub fn is_set_aside(&self, bundle: BundleKind, name: &str) -> bool {
        matches!(self, Caution::SetAside { model, .. } if model.bundle == bundle && model.name == name)
    }

    /// Returns the caution about kept models of a bundle whose channels were assigned by position,
    /// if any.
    pub(crate) fn of_positions(
        condition: &Condition,
        choice: &BundleChoice,
        bundle: BundleKind,
    ) -> Option<Self> {
        let kept = condition
            .bundle(bundle)
            .iter()
            .filter(|model| !choice.rejected.contains(&model.name));
        let by_position = kept.filter(|model| {
            model
                .source
                .as_ref()
                .is_some_and(|source| !source.by_position.is_empty())
        });
        let models: Vec<String> = by_position.map(|model| model.name.clone()).collect();
        if models.is_empty() {
            return None;
        }
        Some(Caution::ChannelsByPosition { bundle, models })
    }

    /// Returns the response to consider ignoring in the objective.
    pub fn offers_to_ignore(&self) -> Option<Pair> {
        match self {
            Caution::UnusualGain { pair, .. } => Some(*pair),
            _ => None,
        }
    }

    /// Returns the caution in words; `pair_name` names a response.
    pub fn words(&self, pair_name: impl Fn(Pair) -> String) -> String {
        let names = |pairs: &[Pair]| {
            pairs
                .iter()
                .map(|pair| pair_name(*pair))
                .collect::<Vec<_>>()
                .join(", ")
        };
        match self {
            Caution::HeldButUndefined { pair, why } => format!("{} is not held: {}", pair_name(*pair), why),
            Caution::NoSuggestions(error) => error.to_string(),
            Caution::SetAside { model, lacks, zero, why, pinned } => {
                let why = match why {
                    None if zero == lacks => "zero over the whole band".to_owned(),
                    None => "zero somewhere in the band".to_owned(),
                    Some(why) if zero.is_empty() => why.to_string(),
                    Some(why) => format!("{} zero wherever it has values; of the others, {why}", names(zero)),
                };
                let pin = if *pinned { "; it is not used as representative, as was chosen" } else { "" };
                let lacks = names(lacks);
                format!("{model} is set aside: it has no {lacks}, which another model of its bundle has ({why}){pin}")
            }
            Caution::NotFinite { model, responses, why } => {
                format!("{} has no {} over the whole band: {}", model, names(responses), why)
            }
            Caution::MissingResponses { model, responses } => format!(
                "{model} has no {}: every value in its file is zero, as where a response was not measured or its channels have other \
                 names; give the response, or reject the model",
                names(responses)
            ),
            Caution::GainsOutOfRange { physics, identified, responses } => {
                let gains = responses.iter().map(|of| format!("1e{} in {}", of.power_of_ten, pair_name(of.pair)));
                format!(
                    "the gain between physics model \"{physics}\" and identified model \"{identified}\" is about {}, and {GAIN_RANGE}: \
                     these responses are not compared; check the units and the matrices of both models",
                    gains.collect::<Vec<_>>().join(", ")
                )
            }
            Caution::NumericallyNothing { model, responses } => format!(
                "of {model}, {} are numerically nothing ({NOTHING}): they have no G and no D, as if they were zero",
                names(responses)
            ),
            Caution::NotCoherent { threshold, weighed, left_out, points } => format!(
                "coherence weighs J, G and D of {weighed} responses; of {points} frequencies, {} are left out: their coherence is \
                 under {}, or they lie outside the valid band",
                left_out_words(left_out, &pair_name),
                number(*threshold)
            ),
            Caution::CoherenceNotUsed => {
                "the identified representative is measured with coherence, which is switched off: every frequency counts alike"
                    .to_owned()
            }
            Caution::ChannelsByPosition { bundle, models } => format!(
                "the channels of {bundle} models were taken by their position, as their files have no names for them: check that their \
                 order is that of the dataset ({})",
                few(models)
            ),
            Caution::UnusualGain { pair, gain } => format!(
                "{} has a G of {}, outside {} to {}, and is fitted like the others: ignore it in the objective if it means \
                 nothing (in a study file: \"ignored\")",
                pair_name(*pair),
                short(*gain),
                USUAL_GAINS.start(),
                USUAL_GAINS.end()
            ),
        }
    }
}

/// Joins names: "nominal, roll+5, roll-5 and 6 more".
fn few(names: &[String]) -> String {
    /// Number of names listed in full.
    const NAMED: usize = 3;
    let listed = names[..names.len().min(NAMED)].join(", ");
    match names.len().saturating_sub(NAMED) {
        0 => listed,
        rest => format!("{listed} and {rest} more"),
    }
}

/// Joins counts: "31 of PED → P, 12 of COL → Q, and some of 5 more responses".
fn left_out_words(left_out: &[(Pair, usize)], pair_name: &impl Fn(Pair) -> String) -> String {
    /// Number of responses listed by name.
    const NAMED: usize = 3;
    let named = left_out
        .iter()
        .take(NAMED)
        .map(|(pair, count)| format!("{count} of {}", pair_name(*pair)));
    let rest = left_out.len().saturating_sub(NAMED);
    let more = (rest > 0).then(|| format!("and some of {rest} more"));
    named.chain(more).collect::<Vec<_>>().join(", ")
}

/// Formats with three significant digits.
fn short(gain: f64) -> String {
    if (1e-3..1e4).contains(&gain) {
        format!("{gain:.3}")
    } else {
        format!("{gain:.2e}")
    }
}

/// Returns the cautions about the kept models of a bundle in a band that ends at `top` \[rad/s\]:
/// models set aside, models with responses that are not finite, and measured models with missing
/// responses.
pub(crate) fn of_models(
    condition: &Condition,
    choice: &BundleChoice,
    bundle: BundleKind,
    responses: &[Arc<FrequencyResponse>],
    measured: &MeasuredPairs,
    top: f64,
) -> Vec<Caution> {
    let mut cautions = Vec::new();
    for (index, response) in responses.iter().enumerate() {
        let Model { name, dynamics, .. } = &condition.bundle(bundle)[index];
        if choice.rejected.contains(name) {
            continue;
        }
        let model = BundleModel::of(condition, bundle, index);
        let zero = response.zero_where_finite();
        // A response that is zero wherever it has values is absent: a wider measurement would not
        // add it.
        let mut not_finite = response.not_finite();
        not_finite.retain(|pair| !zero.contains(pair));
        let why = NotFinite::of(dynamics, top);
        let lacks = measured.lacks[index].clone();
        if matches!(dynamics, Dynamics::Measured(_)) {
            let missing: Vec<Pair> = zero
                .iter()
                .copied()
                .filter(|pair| !lacks.contains(pair))
                .collect();
            if !missing.is_empty() {
                cautions.push(Caution::MissingResponses {
                    model: model.clone(),
                    responses: missing,
                });
            }
        }
        if !lacks.is_empty() {
            cautions.push(Caution::SetAside {
                model,
                zero: lacks
                    .iter()
                    .copied()
                    .filter(|pair| zero.contains(pair))
                    .collect(),
                why: if lacks.iter().any(|pair| not_finite.contains(pair)) {
                    Some(why)
                } else {
                    None
                },
                lacks,
                pinned: choice.pinned.as_ref() == Some(name),
            });
        } else if !not_finite.is_empty() {
            cautions.push(Caution::NotFinite {
                model,
                responses: not_finite,
                why,
            });
        }
    }
    cautions
}
