//! Bode plot for one response: magnitude above phase of every model in a condition, or the ratio
//! and phase difference between the identified and the other models.
//!
//! A scene ([`BodeScene`]) describes what is drawn, a view ([`BodeView`]) is the plot's state
//! between frames, and events ([`BodeEvent`]) report the engineer's actions. A pane ([`Pane`]) is
//! the upper or the lower of the two plots.

use std::borrow::Cow;

use egui::{CursorIcon, Rect, Ui, UiBuilder, Vec2, vec2};

use super::band_handles::band_handles_ui;
use super::bode_event::BodeEvent;
use super::bode_headings::BodeHeadings;
use super::bode_keys::pressed_role;
use super::bode_layout::BodeLayout;
use super::bode_pane::pane_ui;
use super::bode_pointer::{Pointing, handle_click, open_menu, takes_clicks};
use super::bode_scene::BodeScene;
use super::bode_view::BodeView;
use super::chips::{Chips, role_chips};
use super::curve_layer::CurveLooks;
use super::curve_menu::menu_ui;
use super::drawn_curves::{BodeCurve, CurveId, PANES, Pane};
use super::nearest_curve::curves_in;
use super::pane_scene::PaneScene;
use super::panel_painter::use_frame_colors;
use super::panel_text::message_ui;
use super::steady_range::AxisUpdate;
use super::thinning::is_finite;
use crate::gui::widgets::palette::Palette;

/// Minimum size with room for two plots \[pt\].
const LEAST_SIZE: Vec2 = vec2(140.0, 130.0);

/// Draws a Bode plot into the remaining space in `ui`:
///
/// 1. nothing if the space is too small; only the message if no curve has a point to draw;
/// 2. leave out the hidden curves;
/// 3. move the axes: request a fit if the curves' frequency range has changed, carry out requested
///    fits, and let the value axes follow new curves as far as the [`AxisUpdate`] permits;
/// 4. draw chips, panes and headings (`BodePlot::ui`), with the events on them.
pub fn bode_ui(
    ui: &mut Ui,
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    palette: &Palette,
) -> Vec<BodeEvent> {
    let rect = ui.available_rect_before_wrap();
    let mut events = Vec::new();
    // Step 1.
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
    // Step 2.
    let curves = visible_curves(scene.curves);
    let visible = BodeScene {
        curves: &curves,
        ..*scene
    };
    // Step 3.
    // While a band end is dragged, the view must not move under the pointer.
    if scene.omega_range.is_none() && !ui.input(|input| input.pointer.any_down()) {
        view.follow_frequencies(scene.curves);
    }
    view.fit_if_requested(&visible);
    view.follow_values(scene, &visible, axis_update(ui, scene));
    // Step 4.
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

/// Returns how far the value axes may follow new curves: not while the curves are older than the
/// settings, and only by growing while something is dragged.
fn axis_update(ui: &Ui, scene: &BodeScene<'_>) -> AxisUpdate {
    if scene.stale {
        AxisUpdate::Pending
    } else if ui.input(|input| input.pointer.any_down()) {
        AxisUpdate::Dragging
    } else {
        AxisUpdate::Complete
    }
}

/// Plot in which at least one curve has data.
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

/// Returns chips for all roles, including hidden roles, and the plot's command chips.
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
        shows_uncertainty: scene.shows_uncertainty,
        command_chips: scene.command_chips,
        is_tight: false,
    }
}

/// Returns whether a curve has a finite magnitude to draw.
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
    /// Draws the panes and handles their interaction:
    ///
    /// 1. find the curve under the pointer, in the panes as drawn in the last frame;
    /// 2. draw each pane, then handle clicks, its band ends, and the context menu on it;
    /// 3. report the curves in a finished selection box.
    ///
    /// The cursor is at the frequency under the pointer, or else where another plot has set it.
    fn ui(&self, ui: &mut Ui, view: &mut BodeView) -> PanesResponse {
        let scene = self.scene;
        let mut events = Vec::new();
        // Step 1.
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
        // Step 2.
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
        // Step 3.
        if let Some(selection) = view.selection.take()
            && let Some(transform) = view.transform(selection.pane)
        {
            let curves = curves_in(scene.curves, selection.pane, selection.area, transform);
            events.push(BodeEvent::Boxed(curves));
        }
        PanesResponse { events, has_focus }
    }
}

fn set_hovered(view: &mut BodeView, hovered: Option<CurveId>, events: &mut Vec<BodeEvent>) {
    if view.hovered != hovered {
        view.hovered.clone_from(&hovered);
        events.push(BodeEvent::Hovered(hovered));
    }
}
