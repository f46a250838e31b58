//! Context menus: on a curve, and on the empty ground between curves.
//!
//! A bundle is all physics models, or all identified models, in a condition. Its representative
//! stands for it in comparisons: the medoid, unless the engineer has chosen another model (M5:
//! docs/method.md). The subject of a menu is the curve under the click, or the frequency there.

use egui::{
    Button, Key, Popup, PopupCloseBehavior, Response, RichText, Role as WidgetRole, TextEdit, Ui,
    WidgetInfo,
};

use super::bode_event::{BodeEvent, CurveAction};
use super::bode_scene::BodeScene;
use super::bode_view::BodeView;
use super::curve_command::CurveCommand;
use super::curve_style::Role;
use super::drawn_curves::{BodeCurve, CurveId};
use super::quantity::{BodeQuantity, PhaseUnit};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Shows a pane's menu while it is open; returns the chosen action.
pub(super) fn menu_ui(
    response: &Response,
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    palette: &Palette,
) -> Option<BodeEvent> {
    let mut subject = view.menu_subject.take()?;
    let curve = scene
        .curves
        .iter()
        .find(|curve| subject.curve.as_ref() == Some(&curve.id));
    // A click into the field for the reason must not close the menu.
    let menu =
        Popup::context_menu(response).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let mut chosen = None;
    menu.show(|ui| {
        chosen = match curve {
            Some(curve) => {
                name_ui(ui, curve, palette);
                curve_menu_ui(ui, curve, scene.quantity, &mut subject.reason)
            }
            None => ground_menu_ui(ui, scene, subject.omega, view),
        };
    });
    view.menu_subject = Some(subject);
    chosen
}

/// Draws the menu on a curve; returns the chosen action.
fn curve_menu_ui(
    ui: &mut Ui,
    curve: &BodeCurve,
    quantity: BodeQuantity<'_>,
    reason: &mut String,
) -> Option<BodeEvent> {
    let mut chosen = None;
    if reason_ui(ui, curve, reason) {
        chosen = Some(BodeEvent::RejectedBecause(curve.id.clone(), reason.clone()));
    }
    if let Some(action) = curve_actions_ui(ui, curve, quantity) {
        chosen = Some(BodeEvent::ActionChosen(curve.id.clone(), action));
    }
    chosen
}

/// Draws an entry; returns whether it was chosen.
fn entry_ui(ui: &mut Ui, text: &str, hint: &str) -> bool {
    let clicked = ui.button(text).on_hover_text(hint).clicked();
    if clicked {
        ui.close();
    }
    clicked
}

fn name_ui(ui: &mut Ui, curve: &BodeCurve, palette: &Palette) {
    ui.label(RichText::new(&curve.label).strong());
    if !curve.detail.is_empty() {
        let detail = RichText::new(&curve.detail).size(SMALL_SIZE);
        ui.label(detail.color(palette.dim_text));
    }
    ui.separator();
}

/// Draws the field for the rejection reason, if the curve belongs to a model that can be rejected;
/// returns whether the rejection was confirmed.
fn reason_ui(ui: &mut Ui, curve: &BodeCurve, reason: &mut String) -> bool {
    if !matches!(curve.id, CurveId::Model(_)) || curve.rejected {
        return false;
    }
    let field = ui.add(
        TextEdit::singleline(reason)
            .hint_text("reason")
            .desired_width(150.0),
    );
    field.widget_info(|| WidgetInfo::labeled(WidgetRole::TextInput, true, "Rejection reason"));
    let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    field.on_hover_text("Saved in the study; Enter rejects the model");
    let has_reason = !reason.trim().is_empty();
    let is_clicked = ui
        .add_enabled(has_reason, Button::new("Reject with reason"))
        .clicked();
    let is_confirmed = (is_entered || is_clicked) && has_reason;
    if is_confirmed {
        ui.close();
    }
    is_confirmed
}

/// Draws the actions on a curve; returns the chosen action.
fn curve_actions_ui(
    ui: &mut Ui,
    curve: &BodeCurve,
    quantity: BodeQuantity<'_>,
) -> Option<CurveAction> {
    let mut chosen = model_actions_ui(ui, curve);
    if entry_ui(
        ui,
        "Copy values",
        "Frequencies and values as text, with their units",
    ) {
        chosen = Some(CurveAction::CopyValues);
    }
    if let BodeQuantity::Response {
        phase: PhaseUnit::Unwrapped,
        ..
    } = quantity
    {
        ui.separator();
        if entry_ui(
            ui,
            "Phase +360°",
            "Shifts the drawn curve by a whole turn; no result changes",
        ) {
            chosen = Some(CurveAction::Turn(1));
        }
        if entry_ui(
            ui,
            "Phase −360°",
            "Shifts the drawn curve by a whole turn; no result changes",
        ) {
            chosen = Some(CurveAction::Turn(-1));
        }
    }
    chosen
}

/// Draws the actions that every plot offers for a curve's model; nothing if the curve has no model.
/// Returns the chosen action.
pub(super) fn model_actions_ui(ui: &mut Ui, curve: &BodeCurve) -> Option<CurveAction> {
    if !matches!(curve.id, CurveId::Model(_)) {
        return None;
    }
    let mut chosen = None;
    let is_chosen = if curve.rejected {
        entry_ui(ui, "Restore model", "Returns the model to its bundle")
    } else {
        entry_ui(ui, "Reject model", "Removes the model from its bundle")
    };
    if is_chosen {
        chosen = Some(CurveAction::RejectOrRestore);
    }
    let represents = matches!(
        curve.role,
        Role::Representative | Role::IdentifiedRepresentative
    );
    if !curve.rejected
        && !represents
        && entry_ui(
            ui,
            "Use as representative",
            "Represents the bundle instead of the medoid, or of the model chosen before",
        )
    {
        chosen = Some(CurveAction::Pin);
    }
    if entry_ui(
        ui,
        "Isolate model",
        "Draws only this model and the representatives; again: all models",
    ) {
        chosen = Some(CurveAction::Isolate);
    }
    if entry_ui(ui, "Hide curve", "The model still counts in every result") {
        chosen = Some(CurveAction::Hide);
    }
    chosen
}

/// Draws the menu on empty ground at `omega` \[rad/s\]; returns the chosen action, except a fit,
/// which is requested from `view` at once.
fn ground_menu_ui(
    ui: &mut Ui,
    scene: &BodeScene<'_>,
    omega: f64,
    view: &mut BodeView,
) -> Option<BodeEvent> {
    let mut chosen = None;
    if entry_ui(ui, "Fit plot", "Or double-click an empty area") {
        view.request_fit();
    }
    let hint = "Two marks show the change between them";
    if entry_ui(ui, "Mark frequency", hint) {
        chosen = Some(BodeEvent::Display(CurveCommand::PinCursor(omega)));
    }
    let has_marks = !(scene.pinned.is_empty() && scene.crossings.is_empty());
    if has_marks && entry_ui(ui, "Remove marks", "All marked frequencies") {
        chosen = Some(BodeEvent::Display(CurveCommand::RemoveFrequencyMarks));
    }
    chosen
}
