//! Options of figures over frequency: contents, units and ranges.

use std::collections::{BTreeMap, BTreeSet};

use gdcm_model::dataset::{ConditionId, ModelId, Pair};

use super::axis::{Axis, FrequencyUnit, MagnitudeUnit, PhaseErrorUnit, PhaseUnit, Range};
use super::bode_curve::CurveId;
use super::role::Role;

/// Options of a figure over frequency: contents, units and ranges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodeOptions {
    pub unit: FrequencyUnit,
    pub magnitude: MagnitudeUnit,
    pub phase: PhaseUnit,
    pub phase_error: PhaseErrorUnit,
    pub hidden: BTreeSet<Role>,
    pub hidden_models: BTreeSet<ModelId>,
    /// The only model shown besides the representatives.
    pub isolated: Option<ModelId>,
    /// Whole turns added to phases by hand.
    pub turns: BTreeMap<(ConditionId, Pair, CurveId), i32>,
    /// Whether the envelopes of maximum unnoticeable added dynamics are shown, about the identified
    /// response and among the errors.
    pub shows_muad: bool,
    /// Response whose zeros are shown among the poles.
    pub zeros_of: Option<Pair>,
    /// Names and frequencies \[rad/s\] at which a bandwidth is read, marked by vertical lines.
    pub crossings: Vec<(&'static str, f64)>,
    /// Displayed frequency range \[rad/s\]; fitted to the curves if `None`.
    pub omega: Option<Range>,
    /// Ranges in the upper panel \[dB\] and the lower panel \[deg\]; fitted to the band if `None`.
    pub values: [Option<Range>; 2],
}

impl BodeOptions {
    /// Returns the frequency axis.
    pub(super) fn frequency_axis(&self) -> Axis {
        Axis::logarithmic(self.unit.axis_label())
            .showing(self.omega.map(|range| self.in_unit(range.min, range.max)))
    }

    /// Returns the range between two frequencies \[rad/s\] in the displayed unit.
    pub(super) fn in_unit(&self, from: f64, to: f64) -> Range {
        Range::new(self.unit.of_omega(from), self.unit.of_omega(to))
    }
}
