//! Requests that change how curves over frequency are displayed.

use std::collections::BTreeSet;

use gdcm_model::dataset::{ConditionId, ModelId, Pair};

use super::quantity::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
use super::{CurveId, Role};

#[derive(Clone, Debug, PartialEq)]
pub enum CurveCommand {
    /// Changes the magnitude unit.
    ReadMagnitudes(MagnitudeUnit),
    /// Changes how phases are represented.
    DrawPhases(PhaseUnit),
    /// Changes the phase-error unit.
    DrawPhaseErrors(PhaseErrorUnit),
    /// Hides or shows a role's curves.
    ToggleRole(Role),
    /// Shows this role's curves alone; repeated, shows the roles visible by default.
    ShowRoleAlone(Role),
    /// Draws this role's curves above all others; repeated, restores the usual order.
    RaiseRole(Role),
    /// Shows or hides the identified models' uncertainty bands.
    ShowBands(bool),
    HideModel(ModelId),
    /// Shows every model, and the roles visible by default.
    ShowHidden,
    /// Shifts a curve's phase.
    Turn {
        condition: ConditionId,
        pair: Pair,
        curve: CurveId,
        /// Whole turns upwards, added to the present shift.
        turns: i32,
    },
    /// Shows the cursor at a frequency \[rad/s\] in every plot; sent again in each frame.
    PointAt(f64),
    /// Marks a frequency \[rad/s\]; a third mark replaces the first.
    PinCursor(f64),
    /// Sets the names and frequencies \[rad/s\] from which the displayed response's bandwidth is
    /// computed.
    MarkCrossings(Vec<(&'static str, f64)>),
    /// Removes the marked frequencies and the crossings.
    RemoveFrequencyMarks,
    /// Shows or hides the list of values at the cursor.
    ListValues(bool),
    /// Shows or hides the envelopes for maximum unnoticeable added dynamics in the Bode and error
    /// plots.
    ShowMuad(bool),
    /// Selects these models alone.
    Select(BTreeSet<ModelId>),
}
