//! Derivations of figures: the equation with its symbols explained, the equation with numbers, and
//! the underlying models and choices.

mod channels;
mod costs;
mod deltas;

use gdcm_method::correction::{Channel, GainObjective};
use gdcm_method::fidelity::{CostAverage, Mismatch};
use gdcm_model::dataset::{BundleKind, ConditionId, ModelId, Pair};
use gdcm_model::number_format::five_digits;
use gdcm_model::units::six_digits;
use gdcm_study::decisions::settings::Settings;
use gdcm_study::results::assessment_table::AssessmentChoice;
use gdcm_study::{Analysis, ConditionAnalysis};

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

/// Derivation of one figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Derivation {
    /// Name of the figure: "G of LON → Q, condition 3".
    pub title: String,
    /// The equation, as in the method's description.
    pub equation: String,
    /// The equation with numbers, step by step; the last step ends in the figure.
    pub with_numbers: Vec<String>,
    /// The underlying models, band, points and choices.
    pub rests_on: Vec<String>,
    /// Section in the method's description: "M6, eq. (5)".
    pub section: &'static str,
    /// The figure, in the unit that the steps name; for bounds the upper bound.
    pub value: f64,
}

/// Derives a figure of `analysis`; `None` where it has no such figure. Computes at most a few
/// medians over frequency.
pub fn derivation(analysis: &Analysis, target: &ExplainTarget) -> Option<Derivation> {
    let of = |condition: &ConditionId| Context::of(analysis, *condition);
    let of_pair = |condition: &ConditionId, pair: &Pair| {
        analysis.study.dataset.on_axis().get(*pair)?;
        of(condition)
    };
    let found = match target {
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
        ExplainTarget::CostBefore(id, pair) => costs::cost(&of_pair(id, pair)?, *pair, false),
        ExplainTarget::CostAfter(id, pair) => costs::cost(&of_pair(id, pair)?, *pair, true),
        ExplainTarget::CostChange(id, pair, choice) => {
            costs::change(&of_pair(id, pair)?, *pair, *choice)
        }
        ExplainTarget::DiscontinuityRatio(model) => costs::ratio(&of(&model.condition)?, model),
        ExplainTarget::Score(model) => costs::score(&of(&model.condition)?, model),
        ExplainTarget::ScheduledGain(channel, airspeed_kt) => {
            deltas::scheduled_gain(analysis, *channel, *airspeed_kt)
        }
    };
    found.map(|mut found| {
        found.rests_on.extend(deltas::sure(analysis, target));
        found
    })
}

/// Returns the notation of the average over frequency.
fn average_word(average: CostAverage) -> &'static str {
    match average {
        CostAverage::Median => "median",
        CostAverage::Mean => "mean",
    }
}

/// Returns the objective of the gains as an equation, with the unit of its value.
fn gain_objective_equation(objective: GainObjective) -> (&'static str, &'static str) {
    match objective {
        GainObjective::Ratio => ("Σ w (G − k_o k_i)² + α Σ (k_o − 1)²", ""),
        GainObjective::Decibel => (
            "Σ w (20 log10 G − 20 log10 k_o k_i)² + α Σ (20 log10 k_o)²",
            " dB²",
        ),
    }
}

/// A condition of an analysis.
struct Context<'a> {
    analysis: &'a Analysis,
    result: &'a ConditionAnalysis,
}

impl<'a> Context<'a> {
    /// Returns the context of a condition, where it has a result.
    fn of(analysis: &'a Analysis, condition: ConditionId) -> Option<Self> {
        Some(Self {
            analysis,
            result: analysis.condition(condition)?,
        })
    }

    fn settings(&self) -> &'a Settings {
        &self.analysis.study.settings
    }

    fn omega(&self) -> &'a [f64] {
        &self.analysis.omega
    }

    /// Names a response: "LON → Q".
    fn pair(&self, pair: Pair) -> String {
        self.analysis.study.dataset.pair_name(pair)
    }

    /// Names a channel: "LON".
    fn channel(&self, channel: Channel) -> String {
        channel.name_in(&self.analysis.study.dataset)
    }

    /// Writes a title: `what`, then the condition, "…, condition 3".
    fn title(&self, what: &str) -> String {
        format!("{what}, condition {}", self.result.condition.id())
    }

    /// Returns the mismatch of the two representatives.
    fn mismatch(&self, pair: Pair) -> Option<&'a Mismatch> {
        self.result
            .comparison
            .representative
            .mismatch
            .get(pair)?
            .as_ref()
    }

    /// Returns the mismatch after the leads of the channels, where there are any (M15.5).
    fn compensated_mismatch(&self, pair: Pair) -> Option<&'a Mismatch> {
        match &self.result.compensated {
            Some(compensated) => compensated.mismatch.get(pair)?.as_ref(),
            None => self.mismatch(pair),
        }
    }

    /// Describes the two representatives.
    fn models(&self) -> Vec<String> {
        let of = |kind| self.result.representative_name(kind);
        let couplings = self.result.coupled.as_ref().map_or_else(String::new, |_| {
            format!(", with {} (M16)", self.settings().couplings.name())
        });
        vec![
            format!(
                "physics representative {}{couplings} (H_sim)",
                of(BundleKind::Physics)
            ),
            format!(
                "identified representative {} (H_ref)",
                of(BundleKind::Identified)
            ),
        ]
    }

    /// Describes the band and its frequencies.
    fn band(&self) -> String {
        band_words(self.settings())
    }

    /// Describes the two representatives, the band, and the frequencies with weight in a response.
    fn models_and_frequencies(&self, mismatch: &Mismatch) -> Vec<String> {
        let mut words = self.models();
        words.push(self.band());
        words.extend(counted_words(mismatch));
        words
    }

    /// Lists the marked responses.
    fn pairs(&self, pairs: impl Iterator<Item = Pair>) -> String {
        let names: Vec<String> = pairs.map(|pair| self.pair(pair)).collect();
        if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        }
    }

    /// Lists the responses used for bounds and distances.
    fn measuring(&self) -> String {
        let measuring = self.analysis.study.dataset.measuring_pairs();
        format!("responses {}", self.pairs(measuring.marked()))
    }

    /// Lists the responses constrained in this condition.
    fn held(&self) -> String {
        format!("held {}", self.pairs(self.result.held().marked()))
    }
}

/// Describes the number of frequencies with weight and their weights, where coherence is used.
fn counted_words(mismatch: &Mismatch) -> Option<String> {
    let count = mismatch.weights()?.len();
    Some(format!(
        "{count} of the frequencies, each by its coherence: W = [1.58 (1 − e^(−γ²))]² (M4a)"
    ))
}

/// Describes the band and its frequencies.
fn band_words(settings: &Settings) -> String {
    let min = six_digits(settings.band.min());
    let max = six_digits(settings.band.max());
    format!(
        "{} frequencies from {min} to {max} rad/s, logarithmically spaced",
        settings.points
    )
}

/// Describes the least, the median and the greatest of some values.
fn spread(values: &[f64]) -> String {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.as_slice() {
        [] => "no values".to_owned(),
        [only] => five_digits(*only),
        [least, .., most] => format!(
            "{} values from {} to {}",
            sorted.len(),
            five_digits(*least),
            five_digits(*most)
        ),
    }
}

/// Describes how the median of some values is found.
fn median_words(values: &[f64]) -> String {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => "no values".to_owned(),
        count if count % 2 == 1 => format!(
            "the middle one of {}: {}",
            spread(values),
            five_digits(sorted[middle])
        ),
        _ => {
            let below = five_digits(sorted[middle - 1]);
            let above = five_digits(sorted[middle]);
            format!(
                "the mean of the middle two of {}: ({below} + {above}) / 2",
                spread(values)
            )
        }
    }
}

/// Every symbol used in these equations, its meaning, and its unit where it has one
/// (docs/method.md).
const TERMS: [(&str, &str); 30] = [
    ("G", "gain that the response wants, a ratio"),
    ("D", "delay that the response wants [s]"),
    ("H_ref", "response of the identified representative"),
    ("H_sim", "response of the physics representative"),
    (
        "Δφ",
        "phase of H_ref less that of H_sim, unwrapped [rad; in J deg]",
    ),
    ("ΔdB", "magnitude of H_sim less that of H_ref [dB]"),
    ("ω", "frequency [rad/s]"),
    (
        "W",
        "weight of a frequency, by coherence where that is used",
    ),
    ("k_o", "gain of the output channel"),
    ("k_i", "gain of the input channel"),
    ("τ_o", "delay of the output channel [s]"),
    ("τ_i", "delay of the input channel [s]"),
    ("τ", "delay of a channel [s]"),
    ("k", "gain of a channel"),
    ("L_o", "lead filter of the output channel"),
    ("L_i", "lead filter of the input channel"),
    ("w", "weight of a response, 0 where it is ignored"),
    ("w_k", "weight of coordinate k of the trim"),
    ("α", "weight of the corrections of the outputs"),
    ("LB", "lower bound of the channels"),
    ("UB", "upper bound of the channels"),
    ("q", "quantile that sets the bounds"),
    (
        "J",
        "cost of a response: what is left of magnitude and phase",
    ),
    ("ΔJ", "what the correction changes of J"),
    (
        "d",
        "distance of two models: root of the mean J of one against the other",
    ),
    (
        "s_a",
        "score of a model: how far the others of its bundle are",
    ),
    (
        "r_a",
        "discontinuity ratio: the distance found over the one that the trims explain",
    ),
    ("p_ak", "coordinate k of the trim of model a"),
    ("v", "airspeed, from −1 to 1 over the conditions"),
    ("V", "airspeed [kt]"),
];

impl Derivation {
    /// Returns the symbols of the equation with their meanings, in order of appearance.
    pub fn terms(&self) -> Vec<(&'static str, &'static str)> {
        let mut found: Vec<(usize, (&str, &str))> = TERMS
            .into_iter()
            .filter_map(|(symbol, meaning)| {
                Some((place_of(symbol, &self.equation)?, (symbol, meaning)))
            })
            .collect();
        found.sort_by_key(|(place, _)| *place);
        found.into_iter().map(|(_, term)| term).collect()
    }
}

/// Returns the position of a symbol in an equation, where it is not a part of another symbol.
fn place_of(symbol: &str, equation: &str) -> Option<usize> {
    let is_part =
        |neighbour: Option<char>| neighbour.is_some_and(|c| c.is_alphabetic() || c == '_');
    equation
        .match_indices(symbol)
        .map(|(place, _)| place)
        .find(|&place| {
            let before = equation[..place].chars().next_back();
            let after = equation[place + symbol.len()..].chars().next();
            !is_part(before) && !is_part(after)
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_is_told_from_its_middle_values() {
        assert_eq!(
            median_words(&[3.0, 1.0, 2.0]),
            "the middle one of 3 values from 1.0000 to 3.0000: 2.0000"
        );
        let even = median_words(&[4.0, 1.0, 3.0, 2.0]);
        assert_eq!(
            even,
            "the mean of the middle two of 4 values from 1.0000 to 4.0000: (2.0000 + 3.0000) / 2"
        );
    }

    fn terms(equation: &str) -> Vec<&'static str> {
        let found = Derivation {
            title: String::new(),
            equation: equation.to_owned(),
            with_numbers: Vec::new(),
            rests_on: Vec::new(),
            section: "",
            value: 0.0,
        };
        found
            .terms()
            .into_iter()
            .map(|(symbol, _)| symbol)
            .collect()
    }

    #[test]
    fn the_symbols_of_an_equation_are_found_and_no_part_of_another() {
        assert_eq!(
            terms("G = median_ω |H_ref| / |L_o H_sim L_i|"),
            ["G", "H_ref", "L_o", "H_sim", "L_i"]
        );
        let gains = terms(
            "min Σ w (G − k_o k_i)² + α Σ (k_o − 1)², subject to k_o k_i = G (held), LB ≤ k ≤ UB",
        );
        assert_eq!(gains, ["w", "G", "k_o", "k_i", "α", "LB", "k", "UB"]);
        assert_eq!(
            terms("D = Σ W ω Δφ(H_sim, H_ref) / Σ W ω²"),
            ["D", "W", "ω", "Δφ", "H_sim", "H_ref"]
        );
        assert_eq!(terms("ΔJ = J(corrected) − J(uncorrected)"), ["ΔJ", "J"]);
    }
}
