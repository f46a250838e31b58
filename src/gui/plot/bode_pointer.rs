//! Pointer in a Bode plot: the curve under it, clicks on curves, and the subject of the context
//! menu.

use egui::{Pos2, Response, Ui};
use egui_plot::PlotTransform;

use super::bode_event::BodeEvent;
use super::bode_scene::BodeScene;
use super::bode_view::{BodeView, MenuSubject};
use super::drawn_curves::{CurveId, PANES, Pane};
use super::nearest_curve::{Hit, nearest_curve};
use super::reference_lines::PaneLines;

/// Distance from a reference line within which the pointer counts as on the line, even over a curve
/// \[pt\].
const ON_LINE: f32 = 1.0;

/// Pointer position in the plots as drawn in the last frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pointing {
    /// `log10 omega` under the pointer.
    pub(super) log_omega: f64,
    /// Curve under the pointer, if any.
    pub(super) hit: Option<Hit>,
}

impl Pointing {
    /// Finds the pane and the curve under the pointer; `None` outside the panes.
    pub(super) fn find(ui: &Ui, scene: &BodeScene<'_>, view: &BodeView) -> Option<Self> {
        let pointer = ui.input(|input| input.pointer.hover_pos())?;
        let is_dragging = ui.input(|input| input.pointer.is_decidedly_dragging());
        for pane in PANES {
            let Some(transform) = view.transform(pane) else {
                continue;
            };
            let frame = *transform.frame();
            if !frame.contains(pointer) || !ui.rect_contains_pointer(frame) {
                continue;
            }
            // During dragging, curves that pass under the pointer are ignored.
            let mut hit = None;
            if !is_dragging {
                hit = curve_at(scene, pane, pointer, transform);
            }
            let log_omega = transform.value_from_position(pointer).x;
            return Some(Self { log_omega, hit });
        }
        None
    }
}

/// Returns the curve nearest to the pointer; `None` if no curve is near, or if a reference line is
/// as near or within [`ON_LINE`], because reference lines are drawn on top.
fn curve_at(
    scene: &BodeScene<'_>,
    pane: Pane,
    pointer: Pos2,
    transform: &PlotTransform,
) -> Option<Hit> {
    let hit = nearest_curve(scene.curves, pane, pointer, transform)?;
    let lines = PaneLines {
        lines: scene.reference_lines,
        pane,
        transform,
    };
    match lines.distance(pointer) {
        Some(distance) if distance <= hit.distance.max(ON_LINE) => None,
        _ => Some(hit),
    }
}

/// Returns whether a click on the curve has an effect: on every curve except the reference.
pub(super) fn takes_clicks(scene: &BodeScene<'_>, hit: Hit) -> bool {
    scene.reference != Some(&scene.curves[hit.curve].id)
}

/// Returns the event for a click on the nearest curve; a click on the reference has no effect.
///
/// egui reports both clicks in a double click, so the first has already taken effect. The second
/// click of a double click: undoes the first if that was on a curve; else, if it is on empty ground
/// too, fits the plot. Any other click on a curve: with Alt isolates its model; otherwise is
/// remembered, so that a second click can undo it.
pub(super) fn handle_click(
    pane: Pane,
    scene: &BodeScene<'_>,
    response: &Response,
    view: &mut BodeView,
) -> Option<BodeEvent> {
    if !response.clicked() {
        return None;
    }
    let clicked = clicked_curve(pane, scene, response, view);
    let first_clicked = view.last_clicked.take();
    if response.double_clicked() {
        if first_clicked.is_none() && clicked.is_none() {
            view.request_fit();
            response.ctx.request_repaint();
        }
        return first_clicked.map(BodeEvent::ClickUndone);
    }
    let id = clicked?;
    if response.ctx.input(|input| input.modifiers.alt) {
        Some(BodeEvent::Isolated(id))
    } else {
        view.last_clicked = Some(id.clone());
        Some(BodeEvent::Clicked(id))
    }
}

/// Returns the clicked curve; `None` for the reference, on which a click has no effect.
fn clicked_curve(
    pane: Pane,
    scene: &BodeScene<'_>,
    response: &Response,
    view: &BodeView,
) -> Option<CurveId> {
    let pointer = response.interact_pointer_pos()?;
    let hit = curve_at(scene, pane, pointer, view.transform(pane)?)?;
    if takes_clicks(scene, hit) {
        Some(scene.curves[hit.curve].id.clone())
    } else {
        None
    }
}

/// Sets the context menu's subject on a secondary click: the curve under the pointer, or the empty
/// ground. `menu_ui` shows the menu.
pub(super) fn open_menu(
    response: &Response,
    scene: &BodeScene<'_>,
    pointing: Option<Pointing>,
    view: &mut BodeView,
) {
    if response.secondary_clicked()
        && let Some(pointing) = pointing
    {
        let curve = pointing.hit.map(|hit| scene.curves[hit.curve].id.clone());
        view.menu_subject = Some(MenuSubject {
            curve,
            omega: 10f64.powf(pointing.log_omega),
            reason: String::new(),
        });
    }
}
