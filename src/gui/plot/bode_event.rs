//! Bode events: gestures and chosen menu entries, for the plot's owner to handle.

use super::curve_command::CurveCommand;
use super::drawn_curves::CurveId;

#[derive(Clone, Debug, PartialEq)]
pub enum BodeEvent {
    /// Another curve, or none, is under the pointer.
    Hovered(Option<CurveId>),
    Clicked(CurveId),
    /// A curve was double-clicked: the effect of the first click is to be undone.
    ClickUndone(CurveId),
    /// A curve was clicked with Alt pressed.
    Isolated(CurveId),
    /// The band is being dragged to these ends \[rad/s\].
    BandDragged {
        min: f64,
        max: f64,
    },
    /// The dragged band end was released.
    BandReleased,
    /// A change to the curve display or to the marked frequencies was requested.
    Display(CurveCommand),
    /// A curve's model is to be rejected for the entered reason.
    RejectedBecause(CurveId, String),
    /// An entry in a curve's menu was chosen.
    ActionChosen(CurveId, CurveAction),
    /// A box was drawn over these curves.
    Boxed(Vec<CurveId>),
    /// A command chip was clicked; the argument is its index in `BodeScene::command_chips`.
    CommandChipClicked(usize),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveAction {
    /// Rejects the curve's model, or restores it.
    RejectOrRestore,
    /// Makes the curve's model the bundle's representative.
    Pin,
    /// Shows the curve's model alone beside the representatives, or all models again.
    Isolate,
    Hide,
    /// Copies the curve's frequencies and values to the clipboard.
    CopyValues,
    /// Shifts the curve's phase by whole turns, upwards if positive.
    Turn(i32),
}
