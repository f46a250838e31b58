//! The Bode plot, magnitude over phase of every model of a condition for one pair; and the same of what the fit sees of them.

use std::collections::BTreeSet;

use egui::{Align2, CursorIcon, Rect, Response, Ui, UiBuilder, pos2, vec2};
use egui_plot::PlotPoint;

use super::axes::{FrequencyUnit, caption_font, message_ui, use_frame_colors};
use super::bode_pane::{BandChange, Emphasis, band_handles_ui, pane_ui};
use super::bode_view::BodeView;
use super::curve::{BodeCurve, CurveId, Pane};
use super::curve_menu::{CurveWish, MenuSubject, menu_ui};
use super::curve_style::Role;
use super::legend::{self, Chip, chips_ui};
use super::picking::{Hit, nearest, touched};
use super::quantity::BodeQuantity;
use super::readout::{Readout, curve_tooltip_ui, readout_box_ui};
use super::rule::{BodeBand, ReferenceLine};
use crate::view::palette::Palette;

/// Part of the height that the magnitude plot gets.
const MAGNITUDE_PART: f32 = 0.55;
/// Space around and between the plots \[pt\]: tick labels at the ends of an axis stand out over its frame.
const EDGE: f32 = 8.0;
/// Below this, there is no room for two plots \[pt\].
const LEAST_SIZE: egui::Vec2 = vec2(140.0, 130.0);

/// What a Bode plot shows.
#[derive(Clone, Copy, Debug)]
pub struct BodeScene<'a> {
    /// Responses, or what the fit sees of them.
    pub quantity: BodeQuantity<'a>,
    /// The pair, as a title: "LON → Q".
    pub pair_title: &'a str,
    /// The curves, in any order.
    pub curves: &'a [BodeCurve],
    /// Labelled lines across the panes.
    pub rules: &'a [ReferenceLine],
    /// Areas around curves.
    pub bands: &'a [BodeBand],
    /// Frequencies marked along the lower edge of each pane \[rad/s\].
    pub strips: &'a [(f64, f64)],
    /// The frequencies that fitting shows \[rad/s\]; those of the curves where there are none.
    pub omega_range: Option<(f64, f64)>,
    /// Where a cursor stands that is led elsewhere \[rad/s\].
    pub cursor: Option<f64>,
    /// Marked frequencies \[rad/s\].
    pub pinned: &'a [f64],
    /// What every role has at the cursor.
    pub readout: Option<&'a Readout>,
    /// Roles whose curves are not drawn.
    pub hidden_roles: &'a BTreeSet<Role>,
    /// What holds for the plot now.
    pub chips: &'a [Chip],
    /// The band of comparison: lower and upper end \[rad/s\].
    pub band: (f64, f64),
    /// The unit of the frequency axis.
    pub unit: FrequencyUnit,
    /// Whether the curves are older than the settings: they are dimmed until new ones arrive.
    pub stale: bool,
    /// What to say where there is nothing to draw.
    pub message: Option<&'a str>,
}

static NO_ROLES: BTreeSet<Role> = BTreeSet::new();

impl<'a> BodeScene<'a> {
    /// Responses of a pair in decibels, degrees and rad/s, and nothing else.
    pub fn of(pair_title: &'a str, curves: &'a [BodeCurve], band: (f64, f64)) -> Self {
        Self {
            quantity: BodeQuantity::RESPONSE,
            pair_title,
            curves,
            rules: &[],
            bands: &[],
            strips: &[],
            omega_range: None,
            cursor: None,
            pinned: &[],
            readout: None,
            hidden_roles: &NO_ROLES,
            chips: &[],
            band,
            unit: FrequencyUnit::RadPerSecond,
            stale: false,
            message: None,
        }
    }
}

/// What the engineer did in a Bode plot.
#[derive(Clone, Debug, PartialEq)]
pub enum BodeEvent {
    /// The pointer came to mean another curve, or none.
    Hovered(Option<CurveId>),
    /// A curve was clicked.
    Clicked(CurveId),
    /// The last click was the first of a double click: it is to be as if it had not been.
    TakenBack(CurveId),
    /// A curve was clicked with Alt held.
    Isolated(CurveId),
    /// The band is being dragged to these ends \[rad/s\].
    BandDragged {
        /// Lower end.
        min: f64,
        /// Upper end.
        max: f64,
    },
    /// The band was let go after dragging.
    BandReleased,
    /// The legend's switch of a role was clicked.
    RoleToggled(Role),
    /// The model of a curve is to be rejected, for a reason.
    RejectedBecause(CurveId, String),
    /// Something was chosen from a curve's menu.
    Wished(CurveId, CurveWish),
    /// A box was drawn over these curves.
    Boxed(Vec<CurveId>),
    /// A frequency \[rad/s\] is to be marked.
    CursorPinned(f64),
    /// The marks of frequencies are to be taken away.
    CursorsUnpinned,
    /// A chip was clicked, by its index.
    ChipClicked(usize),
}

/// Draws a Bode plot into the space that is left in `ui`.
pub fn bode_ui(ui: &mut Ui, scene: &BodeScene<'_>, view: &mut BodeView, palette: &Palette) -> Vec<BodeEvent> {
    let rect = ui.available_rect_before_wrap();
    let mut events = Vec::new();
    if rect.width() < LEAST_SIZE.x || rect.height() < LEAST_SIZE.y {
        return events;
    }
    if !has_data(scene.curves) {
        message_ui(ui, rect, scene.message.unwrap_or("Nothing to draw"), palette);
        set_hovered(view, None, &mut events);
        view.pointed_omega = None;
        return events;
    }
    let drawn: Vec<BodeCurve>;
    let mut visible = *scene;
    if scene.curves.iter().any(|curve| curve.hidden) {
        drawn = scene.curves.iter().filter(|curve| !curve.hidden).cloned().collect();
        visible.curves = &drawn;
    }
    view.fit_if_requested(&visible);
    ui.scope_builder(UiBuilder::new().id_salt(scene.quantity.salt()).max_rect(rect), |ui| {
        use_frame_colors(ui, palette);
        panes_ui(ui, rect, &visible, view, palette, &mut events);
        captions_ui(ui, &visible, scene.curves, view, palette, &mut events);
    });
    ui.advance_cursor_after_rect(rect);
    events
}

fn has_data(curves: &[BodeCurve]) -> bool {
    let is_finite = |curve: &BodeCurve| curve.points(Pane::Magnitude).any(|point| point.iter().all(|c| c.is_finite()));
    curves.iter().any(is_finite)
}

fn panes_ui(
    ui: &mut Ui,
    rect: Rect,
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    palette: &Palette,
    events: &mut Vec<BodeEvent>,
) {
    let pointing = Pointing::find(ui, scene, view);
    let hit = pointing.and_then(|pointing| pointing.hit);
    let meant = hit.map(|hit| scene.curves[hit.curve].id.clone());
    set_hovered(view, meant.clone(), events);
    view.pointed_omega = pointing.map(|pointing| 10f64.powf(pointing.log_omega));
    let cursor = pointing.map(|pointing| pointing.log_omega).or(scene.cursor.map(f64::log10));
    let emphasis = Emphasis { curve: meant, cursor };
    for (pane, rect) in pane_rects(rect) {
        let response = pane_ui(ui, (pane, rect), scene, view, &emphasis, palette);
        click(pane, scene, &response, view, events);
        drag_band(ui, pane, scene, view, palette, events);
        if let Some(Pointing { pane: pointed, hit: Some(hit), .. }) = pointing
            && pointed == pane
        {
            curve_tooltip_ui(&response, scene, &scene.curves[hit.curve], hit.omega, palette);
        }
        ask_for_menu(&response, scene, pointing, view);
        menu_ui(&response, scene, view, events, palette);
        set_cursor_icon(response, hit);
    }
    if let Some((pane, area)) = view.selection.take()
        && let Some(transform) = view.transform(pane)
    {
        events.push(BodeEvent::Boxed(touched(scene.curves, pane, area, transform)));
    }
}

/// A secondary click asks what can be done with the curve there, or with the ground.
fn ask_for_menu(response: &Response, scene: &BodeScene<'_>, pointing: Option<Pointing>, view: &mut BodeView) {
    if response.secondary_clicked()
        && let Some(pointing) = pointing
    {
        let curve = pointing.hit.map(|hit| scene.curves[hit.curve].id.clone());
        view.menu_subject = Some(MenuSubject { curve, omega: 10f64.powf(pointing.log_omega), reason: String::new() });
    }
}

/// Where the panes go: enough space around them for the tick labels at their edges.
fn pane_rects(rect: Rect) -> [(Pane, Rect); 2] {
    let inner = Rect::from_min_max(rect.min + vec2(0.0, EDGE), rect.max - vec2(1.5 * EDGE, 0.0));
    let split = inner.top() + MAGNITUDE_PART * inner.height();
    let magnitude = Rect::from_min_max(inner.min, pos2(inner.right(), split - 0.5 * EDGE));
    let phase = Rect::from_min_max(pos2(inner.left(), split + 0.5 * EDGE), inner.max);
    [(Pane::Magnitude, magnitude), (Pane::Phase, phase)]
}

/// Where the pointer is in the plots, as they were drawn in the last frame.
#[derive(Clone, Copy, Debug)]
struct Pointing {
    pane: Pane,
    log_omega: f64,
    hit: Option<Hit>,
}

impl Pointing {
    fn find(ui: &Ui, scene: &BodeScene<'_>, view: &BodeView) -> Option<Self> {
        let pointer = ui.input(|input| input.pointer.hover_pos())?;
        let is_inside = |rect: Rect| rect.contains(pointer) && ui.rect_contains_pointer(rect);
        if view.legend.rect.is_some_and(is_inside) {
            return None;
        }
        let is_dragging = ui.input(|input| input.pointer.is_decidedly_dragging());
        [Pane::Magnitude, Pane::Phase].into_iter().find_map(|pane| {
            let transform = view.transform(pane).filter(|transform| is_inside(*transform.frame()))?;
            let log_omega = transform.value_from_position(pointer).x;
            // While something is dragged, curves passing under the pointer are not meant.
            let hit = if is_dragging { None } else { nearest(scene.curves, pane, pointer, transform) };
            Some(Self { pane, log_omega, hit })
        })
    }
}

fn set_hovered(view: &mut BodeView, hovered: Option<CurveId>, events: &mut Vec<BodeEvent>) {
    if view.hovered != hovered {
        view.hovered.clone_from(&hovered);
        events.push(BodeEvent::Hovered(hovered));
    }
}

/// A click means the nearest curve. The second of a double click takes the first one back where that meant a curve, and fits the
/// plot on empty ground.
fn click(pane: Pane, scene: &BodeScene<'_>, response: &Response, view: &mut BodeView, events: &mut Vec<BodeEvent>) {
    if !response.clicked() {
        return;
    }
    let pointer = response.interact_pointer_pos();
    let hit = pointer.zip(view.transform(pane)).and_then(|(at, transform)| nearest(scene.curves, pane, at, transform));
    let id = hit.map(|hit| scene.curves[hit.curve].id.clone());
    let before = view.last_clicked.take();
    match (response.double_clicked(), before, id) {
        (true, Some(before), _) => events.push(BodeEvent::TakenBack(before)),
        (true, None, None) => {
            view.request_fit();
            response.ctx.request_repaint();
        }
        (true, None, Some(_)) | (false, _, None) => {}
        (false, _, Some(id)) if response.ctx.input(|input| input.modifiers.alt) => events.push(BodeEvent::Isolated(id)),
        (false, _, Some(id)) => {
            view.last_clicked = Some(id.clone());
            events.push(BodeEvent::Clicked(id));
        }
    }
}

fn drag_band(
    ui: &Ui,
    pane: Pane,
    scene: &BodeScene<'_>,
    view: &BodeView,
    palette: &Palette,
    events: &mut Vec<BodeEvent>,
) {
    let Some(transform) = view.transform(pane) else { return };
    let place = scene.quantity.place(pane);
    events.extend(band_handles_ui(ui, &place, scene.band, transform, scene.unit, palette).map(|change| match change {
        BandChange::Dragged { min, max } => BodeEvent::BandDragged { min, max },
        BandChange::Released => BodeEvent::BandReleased,
    }));
}

fn set_cursor_icon(response: Response, hit: Option<Hit>) {
    let icon = if hit.is_some() { CursorIcon::PointingHand } else { CursorIcon::Crosshair };
    response.on_hover_cursor(icon);
}

/// What lies over the curves: the legend of all of them, hidden ones too, chips, the read-out, and whether newer curves are on their
/// way.
fn captions_ui(
    ui: &Ui,
    scene: &BodeScene<'_>,
    all: &[BodeCurve],
    view: &mut BodeView,
    palette: &Palette,
    events: &mut Vec<BodeEvent>,
) {
    let Some(transform) = view.magnitude_transform().copied() else {
        return;
    };
    let frame = *transform.frame();
    let plot = scene.quantity.label_suffix();
    let entries = legend::entries(all, scene.hidden_roles, palette);
    let points = || scene.curves.iter().flat_map(|curve| curve.points(Pane::Magnitude));
    let position = |[x, y]: [f64; 2]| transform.position_from_point(&PlotPoint::new(x, y));
    let covered = |place: Rect| points().filter(|point| place.contains(position(*point))).count();
    let toggled = legend::legend_ui(ui, (frame, plot), &entries, &mut view.legend, covered, palette);
    events.extend(toggled.map(BodeEvent::RoleToggled));
    if let Some(readout) = scene.readout {
        let labelled = !scene.rules.is_empty();
        readout_box_ui(ui, frame, readout, (view.legend.rect, labelled), palette);
    }
    events.extend(chips_ui(ui, (frame, plot), scene.chips, palette).map(BodeEvent::ChipClicked));
    if scene.stale {
        // The other corner below where the legend stands in this one.
        let taken = view.legend.corner.is_some_and(|(corner, _)| corner == Align2::LEFT_BOTTOM);
        let corner = if taken { Align2::RIGHT_BOTTOM } else { Align2::LEFT_BOTTOM };
        let at = corner.pos_in_rect(&frame.shrink2(vec2(8.0, 6.0)));
        let text = scene.message.unwrap_or("updating…");
        ui.painter().with_clip_rect(frame).text(at, corner, text, caption_font(), palette.dim_text);
    }
}
