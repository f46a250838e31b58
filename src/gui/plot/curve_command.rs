//! Requests to change the display of curves over frequency.

use std::collections::BTreeSet;

use gdcm_model::dataset::{ConditionId, ModelId, Pair};

use super::quantity::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
use super::{CurveId, Role};

/// Request to change the display of curves.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveCommand {
    /// Changes the unit of magnitudes.
    ReadMagnitudes(MagnitudeUnit),
    /// Changes the representation of phases.
    DrawPhases(PhaseUnit),
    /// Changes the unit of phase errors.
    DrawPhaseErrors(PhaseErrorUnit),
    /// Hides or shows the curves of a role.
    ToggleRole(Role),
    /// Shows the curves of this role alone; repeated, shows the curves of all roles.
    ShowRoleAlone(Role),
    /// Draws the curves of this role above all others; repeated, restores the usual order.
    RaiseRole(Role),
    /// Shows or hides the uncertainty bands of the identified models.
    ShowBands(bool),
    HideModel(ModelId),
    /// Shows every model, and the roles visible by default.
    ShowHidden,
    /// Shifts the phase of a curve.
    Turn {
        condition: ConditionId,
        pair: Pair,
        curve: CurveId,
        /// Number of whole turns upwards.
        turns: i32,
    },
    /// Shows the cursor at a frequency \[rad/s\] in every plot; sent again in each frame.
    PointAt(f64),
    /// Marks a frequency \[rad/s\]; a third mark replaces the first.
    PinCursor(f64),
    /// Sets the names and frequencies \[rad/s\] from which the bandwidth of the displayed response
    /// is computed.
    MarkCrossings(Vec<(&'static str, f64)>),
    /// Removes the marked frequencies.
    UnpinCursors,
    /// Shows or hides the list of values at the cursor.
    ListValues(bool),
    /// Shows or hides the envelopes of maximum unnoticeable added dynamics in the Bode and error
    /// plots.
    ShowMuad(bool),
    /// Selects these models instead of the current selection.
    Select(BTreeSet<ModelId>),
}
