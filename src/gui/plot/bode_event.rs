//! Bode events: gestures and menu entries, as requests to the owner.

use super::curve_style::Role;
use super::drawn_curves::CurveId;

/// Event in a Bode plot.
#[derive(Clone, Debug, PartialEq)]
pub enum BodeEvent {
    /// Another curve, or none, is under the pointer.
    Hovered(Option<CurveId>),
    Clicked(CurveId),
    /// The last click began a double click: its effect is to be undone.
    TakenBack(CurveId),
    /// A curve was clicked with Alt pressed.
    Isolated(CurveId),
    /// The band is being dragged to these ends \[rad/s\].
    BandDragged {
        min: f64,
        max: f64,
    },
    /// The band was released after dragging.
    BandReleased,
    /// Another display of curves, or marks at frequencies, were requested.
    Display(DisplayRequest),
    /// The model is to be rejected, with a reason.
    RejectedBecause(CurveId, String),
    /// An entry of a curve's menu was chosen.
    Wished(CurveId, CurveWish),
    /// A box was drawn over these curves.
    Boxed(Vec<CurveId>),
    /// A chip was clicked; the argument is its index.
    ChipClicked(usize),
}

/// Request to change how curves are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DisplayRequest {
    /// Hides or shows the curves of a role.
    ToggleRole(Role),
    /// Draws the curves of this role alone; repeated, draws all of them.
    ShowRoleAlone(Role),
    /// Draws the curves of this role above all others; repeated, restores the usual order.
    RaiseRole(Role),
    /// Shows or hides the identified models' bands.
    ShowBands(bool),
    /// Marks a frequency \[rad/s\].
    PinCursor(f64),
    /// Removes the marked frequencies.
    UnpinCursors,
}

/// Action on a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveWish {
    /// Reject its model, or restore it.
    RejectOrRestore,
    /// Make its model the bundle's representative.
    Pin,
    /// Show it alone beside the representatives, or show all again.
    Isolate,
    /// Hide it.
    Hide,
    /// Copy its frequencies and values to the clipboard.
    CopyValues,
    /// Shift its phase by whole turns.
    Turn(i32),
}
