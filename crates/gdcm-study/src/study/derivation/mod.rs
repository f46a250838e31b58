//! How a figure was computed: the equation with what its symbols stand for, the same with its numbers in place, and what it rests on.

mod channels;
mod costs;
mod deltas;

use gdcm_method::correction::{Channel, GainObjective};
use gdcm_method::fidelity::{CostAverage, Mismatch};
use gdcm_model::dataset::{BundleKind, ConditionId, ModelId, Pair};
use gdcm_model::units::six_digits;

use super::analysis::{Analysis, ConditionAnalysis};
use super::assessment_table::AssessmentChoice;
use super::settings::Settings;

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
    /// The condition, where it has a result.
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

    /// "LON → Q".
    fn pair(&self, pair: Pair) -> String {
        self.analysis.study.dataset.pair_name(pair)
    }

    /// "LON".
    fn channel(&self, channel: Channel) -> String {
        channel.name_in(&self.analysis.study.dataset)
    }

    /// "what of whom, condition 3".
    fn title(&self, what: &str) -> String {
        format!("{what}, condition {}", self.result.condition.id())
    }

    /// The mismatch of the two representatives.
    fn mismatch(&self, pair: Pair) -> Option<&'a Mismatch> {
        self.result
            .comparison
            .representative
            .mismatch
            .get(pair)?
            .as_ref()
    }

    /// The same after the leads of the channels, where there are any (M15.5).
    fn compensated_mismatch(&self, pair: Pair) -> Option<&'a Mismatch> {
        match &self.result.compensated {
            Some(compensated) => compensated.mismatch.get(pair)?.as_ref(),
            None => self.mismatch(pair),
        }
    }

    /// The two representatives.
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

    /// The band and its frequencies.
    fn band(&self) -> String {
        band_words(self.settings())
    }

    /// The two representatives, the band, and which of its frequencies count for a response.
    fn models_and_frequencies(&self, mismatch: &Mismatch) -> Vec<String> {
        let mut words = self.models();
        words.push(self.band());
        words.extend(counted_words(mismatch));
        words
    }

    /// The marked responses in words.
    fn pairs(&self, pairs: impl Iterator<Item = Pair>) -> String {
        let names: Vec<String> = pairs.map(|pair| self.pair(pair)).collect();
        if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        }
    }

    /// The responses that bounds and distances are taken over.
    fn measuring(&self) -> String {
        let measuring = self.analysis.study.dataset.measuring_pairs();
        format!("responses {}", self.pairs(measuring.marked()))
    }

    /// The responses held in this condition.
    fn held(&self) -> String {
        format!("held {}", self.pairs(self.result.held().marked()))
    }
}

/// How many frequencies count and how much, where coherence says that.
fn counted_words(mismatch: &Mismatch) -> Option<String> {
    let count = mismatch.weights()?.len();
    Some(format!(
        "{count} of the frequencies, each by its coherence: W = [1.58 (1 − e^(−γ²))]² (M4a)"
    ))
}

/// The band and its frequencies.
fn band_words(settings: &Settings) -> String {
    let min = six_digits(settings.band.min());
    let max = six_digits(settings.band.max());
    format!(
        "{} frequencies from {min} to {max} rad/s, logarithmically spaced",
        settings.points
    )
}

/// Five significant digits, with a true minus sign.
fn digits(value: f64) -> String {
    const SIGNIFICANT: i32 = 5;
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 {
            "0".to_owned()
        } else {
            value.to_string()
        };
    }
    let exponent = value.abs().log10().floor() as i32;
    let text = match exponent {
        -5..=7 => format!("{value:.*}", (SIGNIFICANT - 1 - exponent).max(0) as usize),
        _ => format!("{value:.4e}"),
    };
    text.replace('-', "−")
}

/// The least, the middle and the greatest of some values in words.
fn spread(values: &[f64]) -> String {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.as_slice() {
        [] => "no values".to_owned(),
        [only] => digits(*only),
        [least, .., most] => format!(
            "{} values from {} to {}",
            sorted.len(),
            digits(*least),
            digits(*most)
        ),
    }
}

/// How the median of some values comes about.
fn median_words(values: &[f64]) -> String {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => "no values".to_owned(),
        count if count % 2 == 1 => format!(
            "the middle one of {}: {}",
            spread(values),
            digits(sorted[middle])
        ),
        _ => {
            let below = digits(sorted[middle - 1]);
            let above = digits(sorted[middle]);
            format!(
                "the mean of the middle two of {}: ({below} + {above}) / 2",
                spread(values)
            )
        }
    }
}

/// Every symbol that equations here are written with, its meaning, and its unit where it has one (docs/method.md).
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
    /// The symbols of the equation with what they stand for, in the order in which they come in it.
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

/// Where a symbol stands in an equation by itself, not as a part of another.
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
    fn a_figure_has_five_digits() {
        let figures = [1.234_567, -0.012_345_6, 123_456.7, 0.0, 1e-9, 2.0];
        assert_eq!(
            figures.map(digits),
            ["1.2346", "−0.012346", "123457", "0", "1.0000e−9", "2.0000"]
        );
    }

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
