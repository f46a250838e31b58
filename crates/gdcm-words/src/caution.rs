//! Sentences about cautions, and about conditions without a result.

use std::collections::BTreeMap;

use gdcm_model::dataset::{Dataset, Pair};
use gdcm_model::number_format::counted;
use gdcm_model::units::number;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::results::caution::{Caution, GainOutOfRange, NotFinite, USUAL_GAINS, Undefined};

/// Clause on the range in which gains can be computed.
const GAIN_RANGE: &str = "the computable range is 1e-50 to 1e50";

/// Clause that explains which responses count as numerically zero (M6a).
const NUMERICALLY_ZERO: &str = "over the band, below 1e-6 of the largest response of the same \
                                output and of the same input";

/// Maximum number of models or responses that are listed by name.
const MOST_LISTED: usize = 3;

/// Returns why a condition has no result; if nothing can be compared, with the cautions that
/// explain it.
pub fn failure_text(failure: &ConditionFailure, dataset: &Dataset) -> String {
    let mut text = failure.to_string();
    if let ConditionFailure::NothingToCompare { cautions, .. } = failure {
        for caution in cautions {
            text.push_str("; ");
            text.push_str(&caution_text(caution, |pair| dataset.pair_name(pair)));
        }
    }
    text
}

/// Returns a caution in words; `pair_name` names a response.
pub fn caution_text(caution: &Caution, pair_name: impl Fn(Pair) -> String) -> String {
    match caution {
        Caution::HeldButUndefined { pair, why } => {
            format!("{} is not held: {}", pair_name(*pair), undefined_text(*why))
        }
        Caution::NoSuggestions(error) => error.to_string(),
        Caution::SetAside {
            model,
            lacks,
            zero,
            why,
            pinned,
        } => {
            let missing = names(lacks, &pair_name);
            let reason = lacking_reason(lacks, zero, why.as_ref(), &pair_name);
            let pin = if *pinned {
                "; although it was chosen as representative, it is not used"
            } else {
                ""
            };
            format!(
                "{model} is set aside: it has no {missing}, which another model of its bundle has \
                ({reason}){pin}"
            )
        }
        Caution::NotFinite {
            model,
            responses,
            why,
        } => format!(
            "{model} has no finite value of {} at some or all frequencies of the band: {}",
            names(responses, &pair_name),
            not_finite_text(why)
        ),
        Caution::MissingResponses { model, responses } => format!(
            "{model} has no {}: every value in its file is zero; the response may not have been \
            measured, or its channels have other names. Add the response, or reject the model",
            names(responses, &pair_name)
        ),
        Caution::GainsOutOfRange {
            physics,
            identified,
            responses,
        } => gains_out_of_range_text(physics, identified, responses, &pair_name),
        Caution::NumericallyZero { model, responses } => format!(
            "{model}: numerically zero responses are treated as zero and have no G and no D: {} \
            ({NUMERICALLY_ZERO})",
            names(responses, &pair_name)
        ),
        Caution::NotCoherent {
            threshold,
            weighed,
            left_out,
            points,
        } => format!(
            "weighted by coherence: J, G and D of {}; left out of the {points} frequencies: {} \
            (coherence below {}, or outside the valid band)",
            counted(*weighed, "response"),
            left_out_words(left_out, &pair_name),
            number(*threshold)
        ),
        Caution::CoherenceNotUsed => {
            "the identified representative is measured with coherence, but weighting by coherence \
            is switched off: all frequencies count equally; switch it on (--coherence on, or \
            Coherence among the settings)"
                .to_owned()
        }
        Caution::ChannelsByPosition { bundle, models } => format!(
            "the channels of {bundle} models were assigned by position, because their files do \
            not name them: check that their order is the same as in the dataset ({})",
            first_names(models)
        ),
        Caution::ParametersNotApplied(omission) => format!(
            "the physics parameters are not applied to the physics models: {}",
            omission
        ),
        Caution::ModelsNotMoved(models) => {
            let mut names_by_reason: BTreeMap<String, Vec<&str>> = BTreeMap::new();
            for model in models {
                let names = names_by_reason.entry(model.why.to_string()).or_default();
                names.push(&model.model);
            }
            let mut reasons = Vec::with_capacity(names_by_reason.len());
            for (why, names) in names_by_reason {
                reasons.push(format!("{why} ({})", names.join(", ")));
            }
            format!(
                "physics parameters not applied to {}: {}",
                counted(models.len(), "physics model"),
                reasons.join("; ")
            )
        }
        Caution::ParametersBend(bends) => {
            let names: Vec<&str> = bends.iter().map(|bend| bend.name.as_str()).collect();
            match names.as_slice() {
                [only] => format!(
                    "the effect of {only} is not linear up to the applied value; add a physics \
                    model linearised at that value"
                ),
                names => format!(
                    "the effects of {} are not linear up to the applied values; for each, add a \
                    physics model linearised at its applied value",
                    names.join(", ")
                ),
            }
        }
        Caution::UnusualGain { pair, gain } => format!(
            "{}: delta gain G = {} is outside the usual range {} to {}; if it is not physically \
            meaningful, ignore this response (in the window, or under \"ignored\" in the study file)",
            pair_name(*pair),
            gain_words(*gain),
            USUAL_GAINS.start(),
            USUAL_GAINS.end()
        ),
    }
}

/// Lists response names, separated by commas.
fn names(pairs: &[Pair], pair_name: &impl Fn(Pair) -> String) -> String {
    let names: Vec<String> = pairs.iter().map(|pair| pair_name(*pair)).collect();
    names.join(", ")
}

/// Returns why a model lacks the responses `lacks`, which another model in its bundle has. Those in
/// `zero` are zero at every frequency with a value; `not_finite` is the reason why others are not
/// finite. If it is `None`, all others are zero somewhere.
fn lacking_reason(
    lacks: &[Pair],
    zero: &[Pair],
    not_finite: Option<&NotFinite>,
    pair_name: &impl Fn(Pair) -> String,
) -> String {
    match not_finite {
        None if zero == lacks => "zero over the whole band".to_owned(),
        None => "zero somewhere in the band".to_owned(),
        Some(why) if zero.is_empty() => not_finite_text(why),
        Some(why) => format!(
            "zero at every frequency that has a value: {}; for the others, {}",
            names(zero, pair_name),
            not_finite_text(why)
        ),
    }
}

/// Describes gains between two models that are outside the computable range.
fn gains_out_of_range_text(
    physics: &str,
    identified: &str,
    responses: &[GainOutOfRange],
    pair_name: &impl Fn(Pair) -> String,
) -> String {
    let gains: Vec<String> = responses
        .iter()
        .map(|gain| format!("1e{} for {}", gain.power_of_ten, pair_name(gain.pair)))
        .collect();
    format!(
        "the gain between physics model \"{physics}\" and identified model \"{identified}\" is \
         about {}, but {GAIN_RANGE}: these responses are not compared; check the units and the \
         matrices of both models",
        gains.join(", ")
    )
}

/// Returns why a response has no G and no D; begins with "the response".
pub fn undefined_text(why: Undefined) -> String {
    match why {
        Undefined::Zero(bundle) => {
            format!("the response is zero over the whole band in the {bundle} model")
        }
        Undefined::ZeroSomewhere(bundle) => {
            format!("the response is zero at some frequency of the band in the {bundle} model")
        }
        Undefined::NotFinite(bundle) => {
            format!(
                "the response is not finite at some frequency of the band in the {bundle} model"
            )
        }
        Undefined::GainOutOfRange(power_of_ten) => format!(
            "the response has a gain of about 1e{power_of_ten} between the physics and the \
            identified model, but {GAIN_RANGE}: check the units and the matrices of both"
        ),
        Undefined::NotCoherent => {
            "the response was not measured reliably: no frequency of the band is coherent enough, \
            or all lie outside the valid band"
                .to_owned()
        }
        Undefined::NotMeasured => {
            "the response was not measured: the identified model contains no values of it"
                .to_owned()
        }
        Undefined::NumericallyZero(bundle) => {
            format!("the response is numerically zero in the {bundle} model: {NUMERICALLY_ZERO}")
        }
    }
}

/// Returns why a model has responses that are not finite.
fn not_finite_text(why: &NotFinite) -> String {
    match why {
        NotFinite::Entry(entry) => format!("{entry}: correct the file, or reject the model"),
        NotFinite::Measured { min, max } => format!(
            "it is measured from {} to {} rad/s only: narrow the band, or reject the model",
            six_decimals(*min),
            six_decimals(*max)
        ),
        NotFinite::Sampled {
            sample_time_s,
            nyquist_rad_s,
        } => format!(
            "it is a discrete-time model with T = {} s, and has no response from π/T = \
            {nyquist_rad_s:.4} rad/s upwards: narrow the band, or reject the model",
            number(*sample_time_s)
        ),
        NotFinite::Pole => {
            "a pole lies on a frequency of the grid, or the response overflows: change the band \
            or the number of frequencies, or reject the model"
                .to_owned()
        }
    }
}

/// Rounds a frequency \[rad/s\] to six decimals, which suffice in a message.
fn six_decimals(omega: f64) -> f64 {
    (omega * 1e6).round() / 1e6
}

/// Joins names: "nominal, roll+5, roll-5 and 6 more".
fn first_names(names: &[String]) -> String {
    let listed = names[..names.len().min(MOST_LISTED)].join(", ");
    match names.len().saturating_sub(MOST_LISTED) {
        0 => listed,
        rest => format!("{listed} and {rest} more"),
    }
}

/// Counts omitted frequencies by response: "31 in PED → P, 12 in COL → Q, and some in 5 more
/// responses".
fn left_out_words(left_out: &[(Pair, usize)], pair_name: &impl Fn(Pair) -> String) -> String {
    let mut parts: Vec<String> = left_out
        .iter()
        .take(MOST_LISTED)
        .map(|(pair, count)| format!("{count} in {}", pair_name(*pair)))
        .collect();
    let rest = left_out.len().saturating_sub(MOST_LISTED);
    if rest > 0 {
        parts.push(format!("and some in {}", counted(rest, "more response")));
    }
    parts.join(", ")
}

/// Formats a gain: three decimals, or an exponent below 1e-3 and at 1e4 or above.
fn gain_words(gain: f64) -> String {
    if (1e-3..1e4).contains(&gain) {
        format!("{gain:.3}")
    } else {
        format!("{gain:.2e}")
    }
}
