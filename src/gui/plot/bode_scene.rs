//! Bode content: magnitude and phase of every model of a condition for a pair, or the
//! corresponding errors used by the fit.

use std::collections::BTreeSet;

use gdcm_model::units::signed;
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::bode::CoherenceCurve;
pub use gdcm_plot::figure::responses::{BodeBand, ReferenceLine};

use super::curve_style::Role;
use super::drawn_curves::{BodeCurve, CurveId};
use super::legend::Chip;
use super::quantity::BodeQuantity;
use super::readout::Readout;

/// Content of a Bode plot.
#[derive(Clone, Copy, Debug, Default)]
pub struct BodeScene<'a> {
    /// Responses, or the errors used by the fit.
    pub quantity: BodeQuantity<'a>,
    /// "LON → Q".
    pub pair_title: &'a str,
    /// Curves, in any order.
    pub curves: &'a [BodeCurve],
    /// Labelled reference lines across the panes.
    pub rules: &'a [ReferenceLine],
    /// Reference in the comparison: a click on it decides nothing.
    pub reference: Option<&'a CurveId>,
    pub bands: &'a [BodeBand],
    /// Measured coherence, in a strip below the panes.
    pub coherence: &'a [CoherenceCurve],
    /// Least coherence at which a frequency counts.
    pub least_coherence: f64,
    /// Frequencies marked along each lower edge \[rad/s\].
    pub strips: &'a [(f64, f64)],
    /// Frequency range after fitting \[rad/s\]; `None` for that covered by the curves.
    pub omega_range: Option<(f64, f64)>,
    /// Cursor controlled by another plot \[rad/s\].
    pub cursor: Option<f64>,
    /// Marked frequencies \[rad/s\].
    pub pinned: &'a [f64],
    /// Frequencies, with their names, at which the response is read \[rad/s\].
    pub crossings: &'a [(&'static str, f64)],
    /// Values at the cursor for every role.
    pub readout: Option<&'a Readout>,
    /// Note at the right above each pane: the correction's effect, and whether it is a warning.
    pub notes: [Option<&'a PaneNote>; 2],
    /// Remaining phase error: the area between the corrected and the identified model, within the
    /// band.
    pub missing: Option<&'a BodeBand>,
    /// Region where curves only illustrate the price paid for leads; `None` without leads.
    pub invalid: Option<&'a InvalidRegion>,
    /// Whether bands are drawn; `None` if there are no bands.
    pub shows_bands: Option<bool>,
    /// Role drawn above all others.
    pub raised: Option<Role>,
    /// Whether the heavy curves are named in the margin.
    pub names_curves: bool,
    /// Roles whose curves are hidden; `None` if there are none.
    pub hidden_roles: Option<&'a BTreeSet<Role>>,
    /// Current restrictions.
    pub chips: &'a [Chip],
    /// Lower and upper end of the comparison band \[rad/s\].
    pub band: (f64, f64),
    pub unit: FrequencyUnit,
    /// Whether the curves are older than the settings: they are dimmed until new curves arrive.
    pub stale: bool,
    /// Message shown if there is nothing to draw.
    pub message: Option<&'a str>,
}

/// Note at the right above a pane.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PaneNote {
    /// "J 13.4 → 0.3".
    pub cost: String,
    /// "matched", "lags by 66 ms, 46° at 12 rad/s".
    pub verdict: String,
    /// Whether the verdict is a warning.
    pub warns: bool,
}

/// Frequencies above the band, where the corrected model is invalid and shows the price of its
/// leads.
#[derive(Clone, Debug, PartialEq)]
pub struct InvalidRegion {
    /// Upper end, which is also where the curves end \[rad/s\].
    pub up_to: f64,
    /// "not valid above 12 rad/s".
    pub words: String,
    /// Corrected magnitudes with and without leads at its end \[dB\].
    pub ends_db: Option<[f64; 2]>,
}

impl<'a> BodeScene<'a> {
    /// Returns "+19.4 dB": the magnitude added by the leads where the curves end.
    pub(super) fn price_words(&self) -> Option<String> {
        let [with, without] = self.invalid?.ends_db?;
        Some(format!("{} dB", signed(with - without, 1)))
    }

    /// Creates a scene with a pair's responses in decibels, degrees and rad/s, and nothing
    /// else.
    pub fn new(pair_title: &'a str, curves: &'a [BodeCurve], band: (f64, f64)) -> Self {
        Self {
            pair_title,
            curves,
            band,
            ..Self::default()
        }
    }
}
