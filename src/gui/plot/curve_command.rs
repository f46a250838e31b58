//! Requests to change how curves over frequency are shown.

use std::collections::BTreeSet;

use gdcm_model::dataset::{ConditionId, ModelId, Pair};

use super::quantity::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
use super::{CurveId, Role};

/// Request to change how curves are shown.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveCommand {
    /// Changes the unit of magnitudes.
    ReadMagnitudes(MagnitudeUnit),
    /// Changes the form of phases.
    DrawPhases(PhaseUnit),
    /// Changes the form of phase differences.
    DrawPhaseErrors(PhaseErrorUnit),
    /// Hides or shows the curves of a role.
    ToggleRole(Role),
    /// Draws the curves of this role alone; repeated, draws all of them.
    ShowRoleAlone(Role),
    /// Draws the curves of this role above all others; repeated, restores the usual order.
    RaiseRole(Role),
    /// Shows or hides the bands of the identified models.
    ShowBands(bool),
    /// Hides a model.
    HideModel(ModelId),
    /// Shows every model, and the roles shown by default.
    ShowHidden,
    /// Shifts the phase of a curve by whole turns: condition, response, curve, turns up.
    Turn(ConditionId, Pair, CurveId, i32),
    /// Highlights a frequency \[rad/s\] in every plot; repeated in each frame.
    PointAt(f64),
    /// Marks a frequency \[rad/s\]; a third mark replaces the first.
    PinCursor(f64),
    /// Sets the frequencies, with their names, that define the bandwidth of the displayed response.
    MarkCrossings(Vec<(&'static str, f64)>),
    /// Removes the marked frequencies.
    UnpinCursors,
    /// Shows or hides the list of values at the cursor.
    ListValues(bool),
    /// Shows or hides the envelopes of maximum unnoticeable added dynamics in the plot of errors.
    ShowMuad(bool),
    /// Selects these models instead of the current selection.
    Select(BTreeSet<ModelId>),
}
