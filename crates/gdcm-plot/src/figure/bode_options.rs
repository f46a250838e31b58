//! Options for figures over frequency: contents, units and ranges.

use std::collections::{BTreeMap, BTreeSet};

use gdcm_model::dataset::{ConditionId, ModelId, Pair};

use super::axis::{Axis, FrequencyUnit, MagnitudeUnit, PhaseErrorUnit, PhaseUnit, Range};
use super::bode_curve::CurveId;
use super::role::Role;

/// Options for a figure over frequency.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodeOptions {
    pub unit: FrequencyUnit,
    pub magnitude: MagnitudeUnit,
    pub phase: PhaseUnit,
    pub phase_error: PhaseErrorUnit,
    pub hidden: BTreeSet<Role>,
    pub hidden_models: BTreeSet<ModelId>,
    /// Model to be shown alone, besides the representatives; `None` shows all models.
    pub isolated: Option<ModelId>,
    /// Full turns (360°) by which the engineer shifts a curve's phase.
    pub turns: BTreeMap<(ConditionId, Pair, CurveId), i32>,
    /// Whether to show the envelopes for maximum unnoticeable added dynamics (MUAD), about the
    /// identified response and in the error plots.
    pub shows_muad: bool,
    /// Response whose zeros are shown in the pole plot; `None` shows no zeros.
    pub zeros_of: Option<Pair>,
    /// Names and values \[rad/s\] of the frequencies at which a bandwidth is read, marked by
    /// vertical lines.
    pub crossings: Vec<(&'static str, f64)>,
    /// Displayed frequency range \[rad/s\]; fitted to the curves if `None`.
    pub omega: Option<Range>,
    /// Displayed ranges of the upper panel \[dB\] and the lower panel (\[deg\], for errors also
    /// \[ms\]); fitted to the curves within the band if `None`.
    pub values: [Option<Range>; 2],
}

impl BodeOptions {
    /// Returns the logarithmic frequency axis in the displayed unit, with the chosen range if there
    /// is one.
    pub(super) fn frequency_axis(&self) -> Axis {
        Axis::logarithmic(self.unit.axis_label())
            .showing(self.omega.map(|range| self.in_unit(range.min, range.max)))
    }

    /// Returns the range between two frequencies \[rad/s\] in the displayed unit.
    pub(super) fn in_unit(&self, from: f64, to: f64) -> Range {
        Range::new(self.unit.of_omega(from), self.unit.of_omega(to))
    }
}
