//! The condition of an explained result, and texts about its models and choices. Leads are the
//! channels' lead filters.

use gdcm_method::correction::Channel;
use gdcm_method::fidelity::Mismatch;
use gdcm_model::dataset::{BundleKind, ConditionId, Pair};
use gdcm_model::units::six_digits;
use gdcm_study::decisions::settings::Settings;
use gdcm_study::{Analysis, ConditionAnalysis};

/// A condition in an analysis, with its result.
pub(super) struct Context<'a> {
    pub(super) analysis: &'a Analysis,
    pub(super) result: &'a ConditionAnalysis,
}

impl<'a> Context<'a> {
    /// Returns the context for a condition; `None` if it has no result.
    pub(super) fn new(analysis: &'a Analysis, condition: ConditionId) -> Option<Self> {
        Some(Self {
            analysis,
            result: analysis.condition(condition)?,
        })
    }

    pub(super) fn settings(&self) -> &'a Settings {
        &self.analysis.study.settings
    }

    pub(super) fn omega(&self) -> &'a [f64] {
        &self.analysis.omega
    }

    /// Names a response: "LON → Q".
    pub(super) fn pair(&self, pair: Pair) -> String {
        self.analysis.study.dataset.pair_name(pair)
    }

    /// Names a channel: "LON".
    pub(super) fn channel(&self, channel: Channel) -> String {
        channel.name_in(&self.analysis.study.dataset)
    }

    /// Returns a title from a result's name: "net gain of LON → Q, condition 3".
    pub(super) fn title(&self, result_name: &str) -> String {
        format!("{result_name}, condition {}", self.result.condition.id())
    }

    /// Returns the mismatch between the two representatives in a response, without leads; `None` if
    /// the response cannot be compared.
    pub(super) fn mismatch(&self, pair: Pair) -> Option<&'a Mismatch> {
        self.result
            .comparison
            .representative
            .mismatch
            .get(pair)?
            .as_ref()
    }

    /// Returns the mismatch with the channels' leads applied, or without leads if there are none
    /// (M15.5); `None` if the response cannot be compared.
    pub(super) fn compensated_mismatch(&self, pair: Pair) -> Option<&'a Mismatch> {
        match &self.result.compensated {
            Some(compensated) => compensated.mismatch.get(pair)?.as_ref(),
            None => self.mismatch(pair),
        }
    }

    /// Describes the physics and the identified representative.
    pub(super) fn models(&self) -> Vec<String> {
        let couplings = if self.result.coupled.is_some() {
            format!(", with {} (M16)", self.settings().couplings.name())
        } else {
            String::new()
        };
        let [physics, identified] =
            BundleKind::BOTH.map(|kind| self.result.representative_name(kind));
        vec![
            format!("physics representative {physics}{couplings} (H_sim)"),
            format!("identified representative {identified} (H_ref)"),
        ]
    }

    /// Describes the frequencies at which responses are compared: their number, and the band ends.
    pub(super) fn band(&self) -> String {
        let settings = self.settings();
        format!(
            "{} frequencies from {} to {} rad/s, logarithmically spaced",
            settings.points,
            six_digits(settings.band.min()),
            six_digits(settings.band.max())
        )
    }

    /// Describes the two representatives, the band, and the frequencies with nonzero weight in a
    /// response.
    pub(super) fn models_and_frequencies(&self, mismatch: &Mismatch) -> Vec<String> {
        let mut words = self.models();
        words.push(self.band());
        words.extend(weight_words(mismatch));
        words
    }

    /// Lists response names; "none" if there are none.
    pub(super) fn pairs(&self, pairs: impl Iterator<Item = Pair>) -> String {
        let names: Vec<String> = pairs.map(|pair| self.pair(pair)).collect();
        if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        }
    }

    /// Lists the responses from which the models' distances (M5) are computed.
    pub(super) fn measured_responses(&self) -> String {
        let measuring = self.analysis.study.dataset.measuring_pairs();
        format!("responses {}", self.pairs(measuring.marked()))
    }

    /// Lists the responses held (constrained) in this condition.
    pub(super) fn held(&self) -> String {
        format!("held: {}", self.pairs(self.result.held().marked()))
    }
}

/// Describes the weights, and the number of frequencies with nonzero weight; `None` if coherence is
/// not used.
pub(super) fn weight_words(mismatch: &Mismatch) -> Option<String> {
    // A mismatch does not cover frequencies with zero weight.
    let count = mismatch.weights()?.len();
    Some(format!(
        "{count} of the frequencies, weighted by their coherence γ²: W = [1.58 (1 − e^(−γ²))]² (M4a)"
    ))
}
