//! Context menus of a curve and of the empty ground between curves.

use egui::{
    Button, Id, Key, Popup, PopupCloseBehavior, Response, RichText, Role as WidgetRole, TextEdit,
    Ui, WidgetInfo,
};

use gdcm_words::ExplainTarget;

use super::bode::{BodeEvent, BodeScene};
use super::bode_view::BodeView;
use super::curve_style::Role;
use super::drawn_curves::{BodeCurve, CurveId};
use super::quantity::{BodeQuantity, PhaseUnit};
use crate::gui::panels::explanation::QUESTION;
use crate::gui::state::curve_display::CurveCommand;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Action on a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveWish {
    /// Reject its model, or restore it.
    RejectOrRestore,
    /// Make its model the representative of the bundle.
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

/// Subject of a menu: a curve or the ground, and the frequency there \[rad/s\].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MenuSubject {
    pub(super) curve: Option<CurveId>,
    pub(super) omega: f64,
    /// Reason of the rejection, as typed so far.
    pub(super) reason: String,
}

/// Shows the menu of a pane while it is open.
pub(super) fn menu_ui(
    response: &Response,
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    events: &mut Vec<BodeEvent>,
    palette: &Palette,
) {
    let Some(mut subject) = view.menu_subject.take() else {
        return;
    };
    let curve = subject
        .curve
        .as_ref()
        .and_then(|id| scene.curves.iter().find(|curve| curve.id == *id));
    // A click into the field for the reason must not close the menu.
    let menu =
        Popup::context_menu(response).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    menu.show(|ui| match curve {
        Some(curve) => curve_menu_ui(ui, scene, (curve, &mut subject.reason), events, palette),
        None => ground_menu_ui(ui, scene, &subject, view, events),
    });
    view.menu_subject = Some(subject);
}

fn entry(ui: &mut Ui, text: &str, hint: &str) -> bool {
    let clicked = ui.button(text).on_hover_text(hint).clicked();
    if clicked {
        ui.close();
    }
    clicked
}

/// Draws the field for the reason of a rejection; returns whether the rejection was confirmed.
fn reason_ui(ui: &mut Ui, reason: &mut String) -> bool {
    let field = ui.add(
        TextEdit::singleline(reason)
            .hint_text("reason")
            .desired_width(150.0),
    );
    field.widget_info(|| {
        WidgetInfo::labeled(WidgetRole::TextInput, true, "Reason of the rejection")
    });
    let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    field.on_hover_text("Why the model is rejected, in words: kept in the study; Enter rejects it");
    let is_clicked = ui
        .add_enabled(!reason.trim().is_empty(), Button::new("Reject with reason"))
        .clicked();
    let is_wanted = (is_entered || is_clicked) && !reason.trim().is_empty();
    if is_wanted {
        ui.close();
    }
    is_wanted
}

fn curve_menu_ui(
    ui: &mut Ui,
    scene: &BodeScene<'_>,
    (curve, reason): (&BodeCurve, &mut String),
    events: &mut Vec<BodeEvent>,
    palette: &Palette,
) {
    ui.label(RichText::new(&curve.label).strong());
    if !curve.detail.is_empty() {
        ui.label(
            RichText::new(&curve.detail)
                .size(SMALL_SIZE)
                .color(palette.dim_text),
        );
    }
    ui.separator();
    if matches!(curve.id, CurveId::Model(_)) && !curve.rejected && reason_ui(ui, reason) {
        events.push(BodeEvent::RejectedBecause(curve.id.clone(), reason.clone()));
    }
    let wished = model_wishes_ui(ui, curve);
    events.extend(wished.map(|wish| BodeEvent::Wished(curve.id.clone(), wish)));
    let mut wish = |ui: &mut Ui, text: &str, hint: &str, wish: CurveWish| {
        if entry(ui, text, hint) {
            events.push(BodeEvent::Wished(curve.id.clone(), wish));
        }
    };
    wish(
        ui,
        "Copy values",
        "Frequencies and values as text, with their units",
        CurveWish::CopyValues,
    );
    if let BodeQuantity::Response {
        phase: PhaseUnit::Unwrapped,
        ..
    } = scene.quantity
    {
        ui.separator();
        wish(
            ui,
            "Phase +360°",
            "Draw this curve's phase 360° higher",
            CurveWish::Turn(1),
        );
        wish(
            ui,
            "Phase −360°",
            "Draw this curve's phase 360° lower",
            CurveWish::Turn(-1),
        );
    }
}

/// Draws the actions on a curve's model, in whichever plot; nothing if the curve has no model.
pub(super) fn model_wishes_ui(ui: &mut Ui, curve: &BodeCurve) -> Option<CurveWish> {
    if !matches!(curve.id, CurveId::Model(_)) {
        return None;
    }
    let represents = matches!(
        curve.role,
        Role::Representative | Role::IdentifiedRepresentative
    );
    let reject = match curve.rejected {
        true => ("Restore model", "Put the model back into its bundle"),
        false => ("Reject model", "Take the model out of its bundle"),
    };
    let pin = (
        "Use as representative",
        "Use this model as the representative of its bundle, whatever the medoid is",
    );
    let isolate = (
        "Isolate model",
        "Only this model beside the representatives, or all again",
    );
    let hide = (
        "Hide curve",
        "Do not draw this model; it counts all the same",
    );
    let wishes = [
        (reject, CurveWish::RejectOrRestore, true),
        (pin, CurveWish::Pin, !curve.rejected && !represents),
        (isolate, CurveWish::Isolate, true),
        (hide, CurveWish::Hide, true),
    ];
    let mut wished = None;
    for ((text, hint), wish, _) in wishes.into_iter().filter(|(.., is_possible)| *is_possible) {
        if entry(ui, text, hint) {
            wished = Some(wish);
        }
    }
    wished
}

fn ground_menu_ui(
    ui: &mut Ui,
    scene: &BodeScene<'_>,
    subject: &MenuSubject,
    view: &mut BodeView,
    events: &mut Vec<BodeEvent>,
) {
    if entry(ui, "Fit plot", "Bring every curve into view") {
        view.request_fit();
    }
    if entry(
        ui,
        "Mark frequency",
        "Leave a cursor at this frequency; two show what changes between them",
    ) {
        events.push(BodeEvent::Display(CurveCommand::PinCursor(subject.omega)));
    }
    if !(scene.pinned.is_empty() && scene.crossings.is_empty())
        && entry(ui, "Remove marks", "Take the marks of frequencies away")
    {
        events.push(BodeEvent::Display(CurveCommand::UnpinCursors));
    }
}

/// Value with a derivation, and its name.
pub type NamedFigure = (String, ExplainTarget);

/// Values listed in an open menu.
#[derive(Clone, Debug, Default)]
pub(super) struct Questions {
    /// Clicked plot, and the values under the pointer.
    asked_of: Option<(Id, Vec<NamedFigure>)>,
}

impl Questions {
    /// Opens the menu of a plot on a secondary click on `pointed`; returns the value chosen in it.
    pub(super) fn ui(
        &mut self,
        response: &Response,
        pointed: &[NamedFigure],
    ) -> Option<ExplainTarget> {
        if response.secondary_clicked() {
            self.asked_of = (!pointed.is_empty()).then(|| (response.id, pointed.to_vec()));
        }
        let (_, figures) = self
            .asked_of
            .as_ref()
            .filter(|(plot, _)| *plot == response.id)?;
        let mut chosen = None;
        response.context_menu(|ui| {
            ui.label(QUESTION);
            for (name, asked) in figures {
                if ui.button(name).clicked() {
                    chosen = Some(asked.clone());
                    ui.close();
                }
            }
        });
        chosen
    }
}
