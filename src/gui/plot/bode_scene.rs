//! Content for a Bode plot of one response: magnitude and phase of every model in a condition, or
//! the ratio and phase difference between the identified and the other models.
//!
//! A role ([`Role`]) is the meaning of a curve, such as nominal, identified or corrected model; it
//! sets the style. The band is the range of frequencies over which models are compared, and J the
//! cost of their mismatch there (M4: docs/method.md). Leads are filters that advance the phase
//! (M15: docs/lead.md).

use std::collections::BTreeSet;

use gdcm_model::units::signed;
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::bode::CoherenceCurve;
pub use gdcm_plot::figure::responses::{BodeBand, ReferenceLine};

use super::chips::CommandChip;
use super::curve_style::Role;
use super::drawn_curves::{BodeCurve, CurveId};
use super::quantity::BodeQuantity;
use super::readout_strip::Readout;

#[derive(Clone, Copy, Debug, Default)]
pub struct BodeScene<'a> {
    /// Responses, or ratio and phase difference.
    pub quantity: BodeQuantity<'a>,
    /// Name of the response, such as "LON → Q".
    pub pair_title: &'a str,
    /// Curves, in any order.
    pub curves: &'a [BodeCurve],
    /// Labelled lines across the panes, such as bounds and envelopes.
    pub reference_lines: &'a [ReferenceLine],
    /// Curve with which the others are compared; clicking it does not reject or restore its model.
    pub reference: Option<&'a CurveId>,
    /// Confidence intervals of the identified responses over frequency.
    pub uncertainty_bands: &'a [BodeBand],
    /// Measured coherence, in a strip below the panes.
    pub coherence: &'a [CoherenceCurve],
    /// Minimum coherence at which a frequency counts.
    pub least_coherence: f64,
    /// Frequency ranges at which a pilot would notice the remaining error \[rad/s\], marked along
    /// the lower edge of each pane.
    pub noticed_ranges: &'a [(f64, f64)],
    /// Frequency range after fitting \[rad/s\]; the curves' range if `None`.
    pub omega_range: Option<(f64, f64)>,
    /// Cursor set by another plot \[rad/s\].
    pub cursor: Option<f64>,
    /// Marked frequencies \[rad/s\].
    pub pinned: &'a [f64],
    /// Names and frequencies \[rad/s\] of the points from which a bandwidth is computed.
    pub crossings: &'a [(&'static str, f64)],
    /// Every role's values at the cursor.
    pub readout: Option<&'a Readout>,
    /// Note at the right above each pane: J and the verdict on the correction.
    pub notes: [Option<&'a PaneNote>; 2],
    /// Remaining phase error: the area between the corrected and the identified curve, within the
    /// band; nothing in the magnitude pane.
    pub remaining_phase: Option<&'a BodeBand>,
    /// Range between the smallest and the largest error at the conditions' optima, that is, of the
    /// models with their condition's own correction.
    pub optima_range: Option<&'a BodeBand>,
    /// Names of groups of curves, in the right margin beside the ends of the curves.
    pub group_names: &'a [GroupName],
    /// Whether the read-out's room stays free, because another part draws it.
    pub reserves_readout: bool,
    /// Frequencies above the band, where the corrected curves are not valid and only show the
    /// magnitude added by the leads; `None` without leads.
    pub invalid: Option<&'a InvalidRegion>,
    /// Whether `uncertainty_bands` are drawn; `None` if there are none.
    pub shows_uncertainty: Option<bool>,
    /// Role drawn above all others.
    pub raised: Option<Role>,
    /// Whether the right margin names the roles in `bode_headings::NAMED_ROLES`, beside the ends of
    /// their curves.
    pub names_roles: bool,
    /// Roles whose curves are hidden; `None` if there are none.
    pub hidden_roles: Option<&'a BTreeSet<Role>>,
    /// Chips that carry out a command when clicked.
    pub command_chips: &'a [CommandChip],
    /// Lower and upper end of the comparison band \[rad/s\].
    pub band: (f64, f64),
    pub unit: FrequencyUnit,
    /// Whether the curves are older than the settings; they are dimmed until new curves arrive.
    pub stale: bool,
    /// Message shown if there is nothing to draw, and above the magnitudes while the curves are
    /// stale.
    pub message: Option<&'a str>,
}

/// Name of a group of curves, in the right margin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroupName {
    /// Name, such as "140 kt × 2".
    pub text: String,
    /// Role in whose colour the name is written.
    pub role: Role,
    /// Curves that the name labels, at their mean end value.
    pub curves: Vec<CurveId>,
}

/// Note at the right above a pane.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PaneNote {
    /// J before and after the correction, such as "J 13.4 → 0.3", or another short text.
    pub cost: String,
    /// Result of the correction in the pane, such as "matched" or "lags by 66 ms, 46° at 12 rad/s".
    pub verdict: String,
    /// Whether the verdict is a warning.
    pub warns: bool,
}

/// Frequencies above the band, where the corrected model is not valid and only shows the magnitude
/// added by the leads.
#[derive(Clone, Debug, PartialEq)]
pub struct InvalidRegion {
    /// Upper end, where the curves end too \[rad/s\].
    pub up_to: f64,
    /// Text in the strip along the upper edge, such as "not valid above 12 rad/s".
    pub words: String,
    /// Corrected magnitudes with and without leads at the upper end \[dB\].
    pub ends_db: Option<[f64; 2]>,
}

impl<'a> BodeScene<'a> {
    /// Returns the magnitude added by the leads where the curves end, such as "+19.4 dB"; `None`
    /// without leads.
    pub(super) fn price_words(&self) -> Option<String> {
        let [with, without] = self.invalid?.ends_db?;
        Some(format!("{} dB", signed(with - without, 1)))
    }

    /// Creates a scene with a pair's responses in decibels, degrees and rad/s, without optional
    /// elements.
    pub fn new(pair_title: &'a str, curves: &'a [BodeCurve], band: (f64, f64)) -> Self {
        Self {
            pair_title,
            curves,
            band,
            ..Self::default()
        }
    }
}
