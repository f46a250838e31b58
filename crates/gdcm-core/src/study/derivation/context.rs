//! What the figures of one condition are computed from, and how they are written.

use crate::correction::Channel;
use crate::dataset::{BundleKind, ConditionId, Pair};
use crate::fidelity::Mismatch;
use crate::study::analysis::Analysis;
use crate::study::condition_analysis::ConditionAnalysis;
use crate::study::settings::Settings;
use crate::units::number;

/// A condition of an analysis.
pub(super) struct Context<'a> {
    pub(super) analysis: &'a Analysis,
    pub(super) result: &'a ConditionAnalysis,
}

impl<'a> Context<'a> {
    /// The condition, where it has a result.
    pub(super) fn of(analysis: &'a Analysis, condition: ConditionId) -> Option<Self> {
        Some(Self { analysis, result: analysis.condition(condition)? })
    }

    pub(super) fn settings(&self) -> &'a Settings {
        &self.analysis.study.settings
    }

    pub(super) fn omega(&self) -> &'a [f64] {
        &self.analysis.omega
    }

    /// "LON → Q".
    pub(super) fn pair(&self, pair: Pair) -> String {
        self.analysis.study.dataset.pair_name(pair)
    }

    /// "LON".
    pub(super) fn channel(&self, channel: Channel) -> String {
        let (inputs, outputs) = self.analysis.study.dataset.names_of_channels();
        channel.name(&inputs, &outputs)
    }

    /// "what of whom, condition 3".
    pub(super) fn title(&self, what: &str) -> String {
        format!("{what}, condition {}", self.result.condition.id())
    }

    /// The mismatch of the two representatives.
    pub(super) fn mismatch(&self, pair: Pair) -> Option<&'a Mismatch> {
        self.result.comparison.representative.mismatch.get(pair)?.as_ref()
    }

    /// The same after the leads of the channels, where there are any (M15.5).
    pub(super) fn led_mismatch(&self, pair: Pair) -> Option<&'a Mismatch> {
        match &self.result.led {
            Some(led) => led.mismatch.get(pair)?.as_ref(),
            None => self.mismatch(pair),
        }
    }

    /// The two representatives.
    pub(super) fn models(&self) -> Vec<String> {
        let of = |kind| self.result.representative_name(kind);
        vec![
            format!("physics representative {} (H_sim)", of(BundleKind::Physics)),
            format!("identified representative {} (H_ref)", of(BundleKind::Identified)),
        ]
    }

    /// The band and its frequencies.
    pub(super) fn band(&self) -> String {
        band_words(self.settings())
    }

    /// The two representatives, the band, and which of its frequencies count for a response.
    pub(super) fn models_and_frequencies(&self, mismatch: &Mismatch) -> Vec<String> {
        let mut words = self.models();
        words.push(self.band());
        words.extend(counted_words(mismatch));
        words
    }

    /// The marked responses in words.
    pub(super) fn pairs(&self, pairs: impl Iterator<Item = Pair>) -> String {
        let names: Vec<String> = pairs.map(|pair| self.pair(pair)).collect();
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    }

    /// The responses that bounds and distances are taken over.
    pub(super) fn measuring(&self) -> String {
        let measuring = self.analysis.study.dataset.measuring_pairs();
        format!("responses {}", self.pairs(measuring.marked()))
    }

    /// The responses held in this condition.
    pub(super) fn held(&self) -> String {
        format!("held {}", self.pairs(self.result.held().marked()))
    }
}

/// How many frequencies count and how much, where coherence says that.
pub(super) fn counted_words(mismatch: &Mismatch) -> Option<String> {
    let count = mismatch.counted.as_ref()?.len();
    Some(format!("{count} of the frequencies, each by its coherence: W = [1.58 (1 − e^(−γ²))]² (M4a)"))
}

/// The band and its frequencies.
pub(super) fn band_words(settings: &Settings) -> String {
    let (min, max) = (number(settings.band.min()), number(settings.band.max()));
    format!("{} frequencies from {min} to {max} rad/s, logarithmically spaced", settings.points)
}

/// Five significant digits, with a true minus sign.
pub(super) fn digits(value: f64) -> String {
    const SIGNIFICANT: i32 = 5;
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    let exponent = value.abs().log10().floor() as i32;
    let text = match exponent {
        -5..=7 => format!("{value:.*}", (SIGNIFICANT - 1 - exponent).max(0) as usize),
        _ => format!("{value:.4e}"),
    };
    text.replace('-', "−")
}

/// The least, the middle and the greatest of some values in words.
pub(super) fn spread(values: &[f64]) -> String {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.as_slice() {
        [] => "no values".to_owned(),
        [only] => digits(*only),
        [least, .., most] => format!("{} values from {} to {}", sorted.len(), digits(*least), digits(*most)),
    }
}

/// How the median of some values comes about.
pub(super) fn median_words(values: &[f64]) -> String {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => "no values".to_owned(),
        count if count % 2 == 1 => format!("the middle one of {}: {}", spread(values), digits(sorted[middle])),
        _ => {
            let (below, above) = (digits(sorted[middle - 1]), digits(sorted[middle]));
            format!("the mean of the middle two of {}: ({below} + {above}) / 2", spread(values))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_has_five_digits() {
        let figures = [1.234_567, -0.012_345_6, 123_456.7, 0.0, 1e-9, 2.0];
        assert_eq!(figures.map(digits), ["1.2346", "−0.012346", "123457", "0", "1.0000e−9", "2.0000"]);
    }

    #[test]
    fn a_median_is_told_from_its_middle_values() {
        assert_eq!(median_words(&[3.0, 1.0, 2.0]), "the middle one of 3 values from 1.0000 to 3.0000: 2.0000");
        let even = median_words(&[4.0, 1.0, 3.0, 2.0]);
        assert_eq!(even, "the mean of the middle two of 4 values from 1.0000 to 4.0000: (2.0000 + 3.0000) / 2");
    }
}
