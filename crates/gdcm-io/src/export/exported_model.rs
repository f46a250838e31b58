//! A corrected model with its accuracy, ready to be written to files.
//!
//! `requested_models` makes it from an analysis, `model_description` describes it in words.
//!
//! The *band* is the range of frequencies over which models are compared. *Delay states* and *lead
//! states* are the states that delays and lead filters add to the model. The correction's delays
//! are those of its channels, the model's *own* delays those of the physics model. *Couplings* are
//! an input mixing and an output feedback (M16). The *price* of leads is the gain that they add
//! above the band, and the frequency above which the model is not valid (M15.6).

use gdcm_method::correction::LeadPrice;
use gdcm_model::dataset::{ConditionId, StateSpace};

use crate::files::export_contents::{ExportContents, PartSource};

/// A corrected model, with the facts that describe it.
pub(super) struct ExportedModel {
    pub(super) condition: ConditionId,
    /// True airspeed \[kt\].
    pub(super) airspeed_kt: f64,
    pub(super) name: String,
    /// Applied correction in words
    /// ([`correction_words`](super::model_description::correction_words)), such as "scheduled" or
    /// "own".
    pub(super) correction: &'static str,
    pub(super) model: StateSpace,
    /// State names, in the order used by `model`.
    pub(super) states: Vec<String>,
    pub(super) delay_states: usize,
    pub(super) lead_states: usize,
    /// Order of the Padé approximants for delays; 0 in discrete time, where delays are exact.
    pub(super) pade_order: usize,
    /// Maximum phase error \[deg\] at the band's upper end due to the Padé approximants or, in
    /// discrete time, to Tustin's rule.
    pub(super) approximation_error_deg: f64,
    /// Maximum phase lag \[deg\] at the band's upper end due to omitted delays: those in the
    /// condition's own correction that the schedule lacks.
    pub(super) omitted_delay_deg: f64,
    pub(super) contents: ExportContents,
    /// The band's upper end, the highest compared frequency \[rad/s\].
    pub(super) band_top_rad_s: f64,
    /// `None` without lead filters.
    pub(super) price: Option<DescribedPrice>,
    pub(super) couplings: ModelCouplings,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ModelCouplings {
    None,
    /// Mixing, exact.
    Mixing,
    /// Mixing and feedback, exact.
    MixingAndFeedback,
    /// Mixing and feedback; the model's own delays are Padé approximants inside the loop.
    FeedbackAroundDelays,
}

/// Accuracy of the parts in an exported model: everything is exact, except for lead filters in
/// discrete time (Tustin's rule), and delays in continuous time (Padé approximants).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ModelAccuracy {
    /// Discrete time: lead filters follow Tustin's rule; delays, if any, are exact.
    SampledLeads,
    /// Exact, with lead filters.
    ExactLeads,
    /// Exact, with delays in the correction.
    ExactDelays,
    /// Exact, without delays.
    WithoutDelays,
    /// Exact, with delays only in the physics model: in discrete time, these are whole samples.
    ExactOwnDelays,
    /// Continuous time: delays, among them the correction's, are Padé approximants.
    PadeDelays,
    /// Continuous time: delays, only the physics model's own, are Padé approximants.
    PadeOwnDelays,
}

pub(super) struct DescribedPrice {
    pub(super) price: LeadPrice,
    pub(super) words: String,
}

impl ExportedModel {
    /// Returns the maximum phase error \[deg\] at the band's upper end due to the export, that is,
    /// to Padé approximants or Tustin's rule, and to omitted delays.
    pub(super) fn phase_error_deg(&self) -> f64 {
        self.approximation_error_deg + self.omitted_delay_deg
    }

    /// Returns the accuracy of the parts; omitted delays do not count.
    pub(super) fn accuracy(&self) -> ModelAccuracy {
        let is_sampled = self.pade_order == 0;
        let is_approximated = if is_sampled {
            self.lead_states > 0
        } else {
            self.delay_states > 0
        };
        let corrects_delays = self.contents.delays != PartSource::None;
        if !is_approximated {
            self.exact_accuracy(corrects_delays)
        } else if is_sampled {
            ModelAccuracy::SampledLeads
        } else if corrects_delays {
            ModelAccuracy::PadeDelays
        } else {
            ModelAccuracy::PadeOwnDelays
        }
    }

    /// Returns the accuracy of a model without approximated parts. A correction may have delays
    /// without states, if all are zero.
    fn exact_accuracy(&self, corrects_delays: bool) -> ModelAccuracy {
        if self.lead_states > 0 {
            ModelAccuracy::ExactLeads
        } else if corrects_delays {
            ModelAccuracy::ExactDelays
        } else if self.delay_states > 0 {
            ModelAccuracy::ExactOwnDelays
        } else {
            ModelAccuracy::WithoutDelays
        }
    }

    /// Returns the frequency \[rad/s\] above which the lead filters make the model invalid;
    /// infinity without lead filters.
    pub(super) fn not_valid_above_rad_s(&self) -> f64 {
        match &self.price {
            Some(described) => described.price.limit_rad_s,
            None => f64::INFINITY,
        }
    }

    /// Returns the gain \[dB\] that the leads add to the most affected response at ten times the
    /// band's upper end; 0 without leads.
    pub(super) fn gain_above_band_db(&self) -> f64 {
        match &self.price {
            Some(DescribedPrice { price, .. }) => {
                greatest(&price.gains_db.inputs) + greatest(&price.gains_db.outputs)
            }
            None => 0.0,
        }
    }
}

/// Returns the greatest gain \[dB\], at least 0.
fn greatest(gains_db: &[f64]) -> f64 {
    gains_db.iter().copied().fold(0.0, f64::max)
}
