//! A corrected model with its accuracy, ready to be written to files.
//!
//! `requested_models` makes it from an analysis, `model_description` describes it in words.
//!
//! The *band* is the range of frequencies over which models are compared. *Delay states* and *lead
//! states* are the states that delays and lead filters add to the model; *couplings* are an input
//! mixing and an output feedback (M16). The *price* of leads is the gain that they add above the
//! band, and the frequency above which the model is not valid (M15.6).

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
    /// Maximum phase lag \[deg\] at the band's upper end due to delays in the condition's own
    /// correction that the schedule omits.
    pub(super) left_out_deg: f64,
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

/// Accuracy of the parts in an exported model. In discrete time (`pade_order` 0), lead filters are
/// approximated by Tustin's rule; in continuous time, delays by Padé approximants. Everything else
/// is exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ModelAccuracy {
    /// Gains and delays are exact, lead filters follow Tustin's rule.
    SampledLeads,
    /// Gains and lead filters are exact.
    ExactLeads,
    /// Gains and delays are exact.
    ExactDelays,
    /// Gains are exact; there are no delays.
    WithoutDelays,
    /// Gains and the model's own delays are exact: in discrete time, these are whole samples.
    ExactOwnDelays,
    /// Delays are Padé approximants, everything else is exact.
    PadeDelays,
    /// The model's own delays are Padé approximants, everything else is exact.
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
        self.approximation_error_deg + self.left_out_deg
    }

    /// Returns the accuracy of the parts; omitted delays do not count. The first that applies:
    ///
    /// 1. leads in discrete time: by Tustin's rule;
    /// 2. leads without delay states: exact;
    /// 3. discrete time, or no delay states: exact delays, where there are any;
    /// 4. delay states: Padé approximants, for the correction's delays or only the model's own.
    pub(super) fn accuracy(&self) -> ModelAccuracy {
        let has_delays = self.contents.delays != PartSource::None;
        let has_leads = self.lead_states > 0;
        if self.pade_order == 0 && has_leads {
            ModelAccuracy::SampledLeads
        } else if has_leads && self.delay_states == 0 {
            ModelAccuracy::ExactLeads
        } else if self.pade_order == 0 || self.delay_states == 0 {
            match (has_delays, self.delay_states) {
                (true, _) => ModelAccuracy::ExactDelays,
                (false, 0) => ModelAccuracy::WithoutDelays,
                (false, _) => ModelAccuracy::ExactOwnDelays,
            }
        } else if has_delays {
            ModelAccuracy::PadeDelays
        } else {
            ModelAccuracy::PadeOwnDelays
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
