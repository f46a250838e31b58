//! A corrected model with its accuracy, ready to be written to files.
//!
//! `requested_models` makes it from an analysis, `model_description` describes it in words.

use gdcm_method::correction::LeadPrice;
use gdcm_model::dataset::{ConditionId, StateSpace};

use crate::files::export_contents::ExportContents;

/// A corrected model, with the facts that describe it.
pub(super) struct ExportedModel {
    pub(super) condition: ConditionId,
    /// True airspeed \[kt\].
    pub(super) airspeed_kt: f64,
    /// Name of the physics model.
    pub(super) name: String,
    /// "scheduled" or "own".
    pub(super) correction: &'static str,
    pub(super) model: StateSpace,
    /// A name for each state.
    pub(super) states: Vec<String>,
    /// Number of states that represent delays.
    pub(super) delay_states: usize,
    /// Number of states that represent lead filters.
    pub(super) lead_states: usize,
    /// Order of the Padé approximants of delays; 0 in discrete time, where delays are exact.
    pub(super) pade_order: usize,
    /// Maximum phase error \[deg\] at the upper end of the band due to the Padé approximants.
    pub(super) approximation_error_deg: f64,
    /// Phase lag \[deg\] at the upper end of the band due to delays in the condition's own
    /// correction that the schedule omits.
    pub(super) left_out_deg: f64,
    /// Parts of the correction that the model contains.
    pub(super) contents: ExportContents,
    /// Upper end of the band, the highest compared frequency \[rad/s\].
    pub(super) band_top_rad_s: f64,
    /// Cost of the lead filters; `None` without lead filters.
    pub(super) price: Option<DescribedPrice>,
    /// Description of the couplings; empty without couplings.
    pub(super) couplings: &'static str,
}

/// Cost of lead filters, with its description.
pub(super) struct DescribedPrice {
    pub(super) price: LeadPrice,
    pub(super) words: String,
}

impl ExportedModel {
    /// Returns the maximum phase error \[deg\] at the upper end of the band due to the export, that
    /// is, to Padé approximants and omitted delays.
    pub(super) fn phase_error_deg(&self) -> f64 {
        self.approximation_error_deg + self.left_out_deg
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
    /// upper end of the band; 0 without leads.
    pub(super) fn gain_above_band_db(&self) -> f64 {
        match &self.price {
            Some(DescribedPrice { price, .. }) => {
                greatest(&price.gains_db.inputs) + greatest(&price.gains_db.outputs)
            }
            None => 0.0,
        }
    }
}

/// Returns the greatest of some gains \[dB\], and at least 0.
fn greatest(gains_db: &[f64]) -> f64 {
    gains_db.iter().copied().fold(0.0, f64::max)
}
