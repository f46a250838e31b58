//! Bode plot: magnitude above phase of every model of a condition for one response, or the ratio
//! and phase difference between the identified and the other models.

use std::borrow::Cow;

use egui::{CursorIcon, Pos2, Rect, Response, Ui, UiBuilder, Vec2, vec2};
use egui_plot::PlotTransform;

use super::band_handles::band_handles_ui;
use super::bode_event::BodeEvent;
use super::bode_headings::BodeHeadings;
use super::bode_layout::BodeLayout;
use super::bode_pane::pane_ui;
use super::bode_scene::BodeScene;
use super::bode_view::{BodeView, MenuSubject};
use super::chips::{Chips, role_chips};
use super::curve_command::CurveCommand;
use super::curve_layer::CurveLooks;
use super::curve_menu::menu_ui;
use super::drawn_curves::{BodeCurve, CurveId, PANES, Pane};
use super::navigation::pressed_digit;
use super::nearest_curve::{Hit, curves_in, nearest_curve};
use super::painter::use_frame_colors;
use super::pane_scene::PaneScene;
use super::panel_text::message_ui;
use super::reference_lines::PaneLines;
use super::thinning::is_finite;
use crate::gui::widgets::palette::Palette;

/// Minimum size with room for two plots \[pt\].
const LEAST_SIZE: Vec2 = vec2(140.0, 130.0);
/// Distance from a reference line within which the pointer counts as on the line, even over a curve
/// \[pt\].
const ON_LINE: f32 = 1.0;

/// Draws a Bode plot into the remaining space in `ui`.
pub fn bode_ui(
    ui: &mut Ui,
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    palette: &Palette,
) -> Vec<BodeEvent> {
    let rect = ui.available_rect_before_wrap();
    let mut events = Vec::new();
    if rect.width() < LEAST_SIZE.x || rect.height() < LEAST_SIZE.y {
        return events;
    }
    if !has_data(scene.curves) {
        message_ui(
            ui,
            rect,
            scene.message.unwrap_or("Nothing to draw"),
            palette,
        );
        set_hovered(view, None, &mut events);
        view.pointed_omega = None;
        return events;
    }
    let curves = visible_curves(scene.curves);
    let visible = BodeScene {
        curves: &curves,
        ..*scene
    };
    // While a band end is dragged, the view must not move under the pointer.
    if scene.omega_range.is_none() && !ui.input(|input| input.pointer.any_down()) {
        view.follow_curves(scene.curves);
    }
    view.fit_if_requested(&visible);
    let builder = UiBuilder::new().id_salt(scene.quantity.salt());
    ui.scope_builder(builder.max_rect(rect), |ui| {
        use_frame_colors(ui, palette);
        let plot = BodePlot {
            scene,
            visible: &visible,
            palette,
        };
        plot.ui(ui, rect, view, &mut events);
    });
    ui.advance_cursor_after_rect(rect);
    events
}

/// Plot with data.
struct BodePlot<'a> {
    /// Scene with all curves, including hidden curves, which still have chips.
    scene: &'a BodeScene<'a>,
    /// Scene without hidden curves, which the panes show.
    visible: &'a BodeScene<'a>,
    palette: &'a Palette,
}

impl BodePlot<'_> {
    /// Draws the chips, the panes below, and the texts around the panes.
    fn ui(&self, ui: &mut Ui, rect: Rect, view: &mut BodeView, events: &mut Vec<BodeEvent>) {
        let Self {
            scene,
            visible,
            palette,
        } = *self;
        let mut chips = plot_chips(scene, view, palette);
        if chips.width(ui) > rect.width() {
            chips.tighten();
        }
        let chips = chips.ui(ui, rect, palette);
        events.extend(chips.event);
        let layout = BodeLayout::new(rect.with_min_y(rect.top() + chips.height), scene);
        let panes = Panes {
            layout: &layout,
            scene: visible,
            palette,
        };
        let panes = panes.ui(ui, view);
        events.extend(panes.events);
        if panes.has_focus
            && let Some(request) = pressed_role(ui, scene, palette)
        {
            events.push(BodeEvent::Display(request));
        }
        let headings = BodeHeadings {
            scene: visible,
            view,
            palette,
        };
        headings.ui(ui, &layout);
    }
}

/// Returns the curves that are not hidden; borrowed if none is hidden.
fn visible_curves(curves: &[BodeCurve]) -> Cow<'_, [BodeCurve]> {
    if !curves.iter().any(|curve| curve.hidden) {
        return Cow::Borrowed(curves);
    }
    let visible = curves.iter().filter(|curve| !curve.hidden);
    Cow::Owned(visible.cloned().collect())
}

/// Returns the request for a pressed digit, which toggles the role chip with this number.
fn pressed_role(ui: &Ui, scene: &BodeScene<'_>, palette: &Palette) -> Option<CurveCommand> {
    let digit = pressed_digit(ui)?;
    let chips = role_chips(scene.curves, scene.hidden_roles, palette);
    let chip = chips.get(digit - 1)?;
    Some(CurveCommand::ToggleRole(chip.role))
}

/// Returns the chips of all roles, including hidden roles, and of the current restrictions of the
/// plot.
fn plot_chips<'a>(scene: &BodeScene<'a>, view: &BodeView, palette: &Palette) -> Chips<'a> {
    let mut roles = role_chips(scene.curves, scene.hidden_roles, palette);
    let hovered = view.hovered.as_ref();
    if let Some(curve) = scene.curves.iter().find(|curve| Some(&curve.id) == hovered) {
        let role = curve.role.shown(curve.rejected);
        for chip in &mut roles {
            chip.lit |= chip.role == role;
        }
    }
    Chips {
        plot: scene.quantity.label_suffix(),
        roles,
        bands: scene.shows_bands,
        states: scene.chips,
        is_tight: false,
    }
}

/// Returns whether a curve has a point that can be drawn.
fn has_data(curves: &[BodeCurve]) -> bool {
    curves
        .iter()
        .any(|curve| curve.points(Pane::Magnitude).any(|point| is_finite(&point)))
}

/// Events in the panes, and their focus.
struct PanesResponse {
    events: Vec<BodeEvent>,
    /// Whether either pane has the focus.
    has_focus: bool,
}

/// Panes to be drawn.
struct Panes<'a> {
    layout: &'a BodeLayout,
    scene: &'a BodeScene<'a>,
    palette: &'a Palette,
}

impl Panes<'_> {
    /// Draws the panes and handles their interaction.
    fn ui(&self, ui: &mut Ui, view: &mut BodeView) -> PanesResponse {
        let scene = self.scene;
        let mut events = Vec::new();
        let pointing = Pointing::find(ui, scene, view);
        let hit = pointing.and_then(|pointing| pointing.hit);
        let pointed = hit.map(|hit| scene.curves[hit.curve].id.clone());
        set_hovered(view, pointed.clone(), &mut events);
        view.pointed_omega = pointing.map(|pointing| 10f64.powf(pointing.log_omega));
        let cursor = match pointing {
            Some(pointing) => Some(pointing.log_omega),
            None => scene.cursor.map(f64::log10),
        };
        let icon = match hit {
            Some(hit) if takes_clicks(scene, hit) => CursorIcon::PointingHand,
            _ => CursorIcon::Crosshair,
        };
        let mut has_focus = false;
        for pane in PANES {
            let pane_scene = PaneScene {
                pane,
                rect: self.layout.panes[pane as usize],
                scene,
                looks: CurveLooks {
                    pointed: pointed.as_ref(),
                    raised: scene.raised,
                    is_stale: scene.stale,
                    is_miniature: false,
                },
                cursor,
                palette: self.palette,
            };
            let response = pane_ui(ui, pane_scene, view);
            events.extend(handle_click(pane, scene, &response, view));
            events.extend(band_handles_ui(ui, pane_scene, view));
            open_menu(&response, scene, pointing, view);
            has_focus |= response.has_focus();
            events.extend(menu_ui(&response, scene, view, self.palette));
            response.on_hover_cursor(icon);
        }
        if let Some(selection) = view.selection.take()
            && let Some(transform) = view.transform(selection.pane)
        {
            let curves = curves_in(scene.curves, selection.pane, selection.area, transform);
            events.push(BodeEvent::Boxed(curves));
        }
        PanesResponse { events, has_focus }
    }
}

/// Opens the menu for the curve, or for the empty ground, on a secondary click.
fn open_menu(
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

/// Pointer position in the plots as drawn in the last frame.
#[derive(Clone, Copy, Debug)]
struct Pointing {
    log_omega: f64,
    hit: Option<Hit>,
}

impl Pointing {
    fn find(ui: &Ui, scene: &BodeScene<'_>, view: &BodeView) -> Option<Self> {
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

/// Returns the curve under the pointer: the nearest curve; `None` if a reference line is as near or
/// within [`ON_LINE`], because reference lines are drawn on top.
fn curve_at(
    scene: &BodeScene<'_>,
    pane: Pane,
    pointer: Pos2,
    transform: &PlotTransform,
) -> Option<Hit> {
    let hit = nearest_curve(scene.curves, pane, pointer, transform)?;
    let lines = PaneLines {
        lines: scene.rules,
        pane,
        transform,
    };
    match lines.distance(pointer) {
        Some(distance) if distance <= hit.distance.max(ON_LINE) => None,
        _ => Some(hit),
    }
}

/// Returns whether a click on the curve has an effect: on every curve except the reference.
fn takes_clicks(scene: &BodeScene<'_>, hit: Hit) -> bool {
    scene.reference != Some(&scene.curves[hit.curve].id)
}

fn set_hovered(view: &mut BodeView, hovered: Option<CurveId>, events: &mut Vec<BodeEvent>) {
    if view.hovered != hovered {
        view.hovered.clone_from(&hovered);
        events.push(BodeEvent::Hovered(hovered));
    }
}

/// Returns the event of a click on the nearest curve; a click on the reference has no effect. The
/// second click of a double click undoes the first if the first was on a curve; on empty ground, it
/// fits the plot.
fn handle_click(
    pane: Pane,
    scene: &BodeScene<'_>,
    response: &Response,
    view: &mut BodeView,
) -> Option<BodeEvent> {
    if !response.clicked() {
        return None;
    }
    let clicked = clicked_curve(pane, scene, response, view);
    let before = view.last_clicked.take();
    if response.double_clicked() {
        if before.is_none() && clicked.is_none() {
            view.request_fit();
            response.ctx.request_repaint();
        }
        return before.map(BodeEvent::ClickUndone);
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
