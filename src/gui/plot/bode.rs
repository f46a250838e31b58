//! Bode plot: magnitude over phase of every model of a condition for a pair, or the corresponding
//! errors used by the fit.

use std::collections::BTreeSet;

use egui::{
    Align2, Color32, CursorIcon, Id, Pos2, Rect, Response, Sense, Shape, Stroke, StrokeKind, Ui,
    UiBuilder, pos2, vec2,
};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_model::units::signed;
use gdcm_plot::figure::bode::CoherenceCurve;

use super::axes::{FrequencyUnit, TICKS_HEIGHT, caption_font, message_ui, use_frame_colors};
use super::bode_pane::{
    BodeBand, Emphasis, ReferenceLine, VALUE_AXIS_WIDTH, band_handles_ui, distance_to_rules,
    pane_ui, rule_ends,
};
use super::bode_view::BodeView;
use super::curve_command::CurveCommand;
use super::curve_menu::{CurveWish, MenuSubject, menu_ui};
use super::curve_style::Role;
use super::drawn_curves::{BodeCurve, CurveId, Pane};
use super::legend::{Chip, Chips, role_chips};
use super::navigation::{Hit, nearest, pressed_digit, touched};
use super::quantity::BodeQuantity;
use super::readout::{Readout, STRIP_HEIGHT, readout_strip_ui};
use crate::gui::widgets::controls::{elided, named, painted_text, row_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, medium};

/// Share of the height taken by the magnitude plot.
const MAGNITUDE_PART: f32 = 0.52;
/// Height of the line above a pane \[pt\].
const HEADING: f32 = 20.0;
/// Space above and below the read-out \[pt\].
const GAP: f32 = 6.0;
/// Space at the right for the unit of the frequencies, for the names of curves, and for the names
/// of lines \[pt\].
const MARGINS: [f32; 3] = [36.0, 78.0, 118.0];
/// Least plot height with room for the values between the panes \[pt\].
const LEAST_WITH_STRIP: f32 = 300.0;
/// Height of the coherence strip, and least height of a plot with room for it \[pt\].
const COHERENCE_HEIGHT: f32 = 52.0;
const LEAST_WITH_COHERENCE: f32 = 380.0;
/// Least size with room for two plots \[pt\].
const LEAST_SIZE: egui::Vec2 = vec2(140.0, 130.0);

/// Content of a Bode plot.
#[derive(Clone, Copy, Debug, Default)]
pub struct BodeScene<'a> {
    /// Responses, or the errors used by the fit.
    pub quantity: BodeQuantity<'a>,
    /// Title of the pair: "LON → Q".
    pub pair_title: &'a str,
    /// Curves, in any order.
    pub curves: &'a [BodeCurve],
    /// Labelled reference lines across the panes.
    pub rules: &'a [ReferenceLine],
    /// Reference curve of the comparison: a click on it decides nothing.
    pub reference: Option<&'a CurveId>,
    pub bands: &'a [BodeBand],
    /// Coherence of measured responses, in a strip below the panes.
    pub coherence: &'a [CoherenceCurve],
    /// Least coherence at which a frequency counts.
    pub least_coherence: f64,
    /// Frequencies marked along the lower edge of each pane \[rad/s\].
    pub strips: &'a [(f64, f64)],
    /// Frequency range after fitting \[rad/s\]; `None` for the range of the curves.
    pub omega_range: Option<(f64, f64)>,
    /// Cursor controlled by another plot \[rad/s\].
    pub cursor: Option<f64>,
    /// Marked frequencies \[rad/s\].
    pub pinned: &'a [f64],
    /// Frequencies, with their names, at which values of the response are read \[rad/s\].
    pub crossings: &'a [(&'static str, f64)],
    /// Values of every role at the cursor.
    pub readout: Option<&'a Readout>,
    /// Note at the right above each pane: effect of the correction, and whether it is a warning.
    pub notes: [Option<&'a PaneNote>; 2],
    /// Remaining phase error: the area between the corrected and the identified model, within the
    /// band.
    pub missing: Option<&'a BodeBand>,
    /// Region where curves only illustrate the price of the leads; `None` without leads.
    pub invalid: Option<&'a InvalidRegion>,
    /// Whether bands are drawn; `None` if there are no bands.
    pub shows_bands: Option<bool>,
    /// Role drawn above all others.
    pub raised: Option<Role>,
    /// Whether the ends of the heavy curves are named in the margin.
    pub names_curves: bool,
    /// Roles whose curves are hidden; `None` if there are none.
    pub hidden_roles: Option<&'a BTreeSet<Role>>,
    /// Current restrictions of the plot.
    pub chips: &'a [Chip],
    /// Band of comparison: lower and upper end \[rad/s\].
    pub band: (f64, f64),
    pub unit: FrequencyUnit,
    /// Whether the curves are older than the settings: they are dimmed until new curves arrive.
    pub stale: bool,
    /// Message shown if there is nothing to draw.
    pub message: Option<&'a str>,
}

/// Note at the right above a pane.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PaneNote {
    /// "J 13.4 → 0.3".
    pub cost: String,
    /// "matched", "lags by 66 ms, 46° at 12 rad/s".
    pub verdict: String,
    /// Whether the verdict is a warning.
    pub warns: bool,
}

/// Frequencies above the band, where the corrected model is invalid and shows the price of its
/// leads.
#[derive(Clone, Debug, PartialEq)]
pub struct InvalidRegion {
    /// End of the region, which is the end of the curves \[rad/s\].
    pub up_to: f64,
    /// "not valid above 12 rad/s".
    pub words: String,
    /// Magnitudes of the corrected model with and without leads at its end \[dB\].
    pub ends_db: Option<[f64; 2]>,
}

impl<'a> BodeScene<'a> {
    /// Returns "+19.4 dB": the increase of the magnitude by the leads at the end of the curves.
    fn price_words(&self) -> Option<String> {
        let [with, without] = self.invalid?.ends_db?;
        Some(format!("{} dB", signed(with - without, 1)))
    }

    /// Creates a scene with the responses of a pair in decibels, degrees and rad/s, and nothing
    /// else.
    pub fn of(pair_title: &'a str, curves: &'a [BodeCurve], band: (f64, f64)) -> Self {
        Self {
            pair_title,
            curves,
            band,
            ..Self::default()
        }
    }
}

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
    Display(CurveCommand),
    /// Rejection of a curve's model was requested, with a reason.
    RejectedBecause(CurveId, String),
    /// An entry of a curve's menu was chosen.
    Wished(CurveId, CurveWish),
    /// A box was drawn over these curves.
    Boxed(Vec<CurveId>),
    /// A chip was clicked; the argument is its index.
    ChipClicked(usize),
}

/// Draws a Bode plot into the remaining space of `ui`.
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
    let drawn: Vec<BodeCurve>;
    let mut visible = *scene;
    if scene.curves.iter().any(|curve| curve.hidden) {
        drawn = scene
            .curves
            .iter()
            .filter(|curve| !curve.hidden)
            .cloned()
            .collect();
        visible.curves = &drawn;
    }
    // While an end of the band is dragged, the view must not move under the pointer.
    if scene.omega_range.is_none() && !ui.input(|input| input.pointer.any_down()) {
        view.follow_curves(scene.curves);
    }
    view.fit_if_requested(&visible);
    ui.scope_builder(
        UiBuilder::new()
            .id_salt(scene.quantity.salt())
            .max_rect(rect),
        |ui| {
            use_frame_colors(ui, palette);
            let height = chips_ui(
                ui,
                rect,
                (scene, view.hovered.as_ref()),
                palette,
                &mut events,
            );
            let places = Places::of(rect.with_min_y(rect.top() + height), scene);
            if panes_ui(ui, &places, &visible, view, palette, &mut events) {
                let roles = role_chips(scene.curves, scene.hidden_roles, palette);
                let pressed = pressed_digit(ui).and_then(|digit| roles.get(digit.checked_sub(1)?));
                events.extend(
                    pressed.map(|chip| BodeEvent::Display(CurveCommand::ToggleRole(chip.role))),
                );
            }
            headings_ui(ui, &places, &visible, view, palette);
        },
    );
    ui.advance_cursor_after_rect(rect);
    events
}

/// Draws the switches of all curves, including hidden curves, and the current restrictions of the
/// plot; returns their height.
fn chips_ui(
    ui: &Ui,
    rect: Rect,
    (scene, hovered): (&BodeScene<'_>, Option<&CurveId>),
    palette: &Palette,
    events: &mut Vec<BodeEvent>,
) -> f32 {
    let mut roles = role_chips(scene.curves, scene.hidden_roles, palette);
    if let Some(curve) = scene.curves.iter().find(|curve| Some(&curve.id) == hovered) {
        let of = curve.role.shown(curve.rejected);
        roles
            .iter_mut()
            .filter(|chip| chip.role == of)
            .for_each(|chip| chip.lit = true);
    }
    let plot = scene.quantity.label_suffix();
    let mut chips = Chips {
        plot,
        roles,
        bands: scene.shows_bands,
        states: scene.chips,
        is_tight: false,
    };
    if chips.width(ui) > rect.width() {
        chips.tighten();
    }
    let (height, event) = chips.ui(ui, rect, palette);
    events.extend(event);
    height
}

fn has_data(curves: &[BodeCurve]) -> bool {
    let is_finite = |curve: &BodeCurve| {
        curve
            .points(Pane::Magnitude)
            .any(|point| point.iter().all(|c| c.is_finite()))
    };
    curves.iter().any(is_finite)
}

/// Draws both panes and handles their interaction; returns whether one of them has the focus.
fn panes_ui(
    ui: &mut Ui,
    places: &Places,
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    palette: &Palette,
    events: &mut Vec<BodeEvent>,
) -> bool {
    let mut has_focus = false;
    let pointing = Pointing::find(ui, scene, view);
    let hit = pointing.and_then(|pointing| pointing.hit);
    let meant = hit.map(|hit| scene.curves[hit.curve].id.clone());
    set_hovered(view, meant.clone(), events);
    view.pointed_omega = pointing.map(|pointing| 10f64.powf(pointing.log_omega));
    let cursor = pointing
        .map(|pointing| pointing.log_omega)
        .or(scene.cursor.map(f64::log10));
    let emphasis = Emphasis {
        curve: meant,
        cursor,
    };
    for (pane, rect) in PANES.into_iter().zip(places.panes) {
        let response = pane_ui(ui, (pane, rect), scene, view, &emphasis, palette);
        click(pane, scene, &response, view, events);
        events.extend(band_handles_ui(ui, pane, scene, view, palette));
        ask_for_menu(&response, scene, pointing, view);
        has_focus |= response.has_focus();
        menu_ui(&response, scene, view, events, palette);
        let takes_click = hit.is_some_and(|hit| takes_clicks(scene, hit));
        response.on_hover_cursor(if takes_click {
            CursorIcon::PointingHand
        } else {
            CursorIcon::Crosshair
        });
    }
    if let Some((pane, area)) = view.selection.take()
        && let Some(transform) = view.transform(pane)
    {
        events.push(BodeEvent::Boxed(touched(
            scene.curves,
            pane,
            area,
            transform,
        )));
    }
    has_focus
}

/// Opens the menu of the curve, or of the empty ground, on a secondary click.
fn ask_for_menu(
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

/// Places of headings, panes and the read-out.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Places {
    headings: [Rect; 2],
    panes: [Rect; 2],
    strip: Option<Rect>,
    coherence: Option<Rect>,
}

impl Places {
    fn of(area: Rect, scene: &BodeScene<'_>) -> Self {
        let inner = area.with_max_x(area.right() - margin(scene));
        let has_coherence = !scene.coherence.is_empty() && inner.height() >= LEAST_WITH_COHERENCE;
        let coherence = has_coherence.then(|| {
            let foot = inner.with_min_y(inner.bottom() - COHERENCE_HEIGHT);
            foot.with_min_x(inner.left() + VALUE_AXIS_WIDTH)
        });
        let inner = coherence.map_or(inner, |strip| inner.with_max_y(strip.top() - GAP));
        // The strip keeps its room without values, so that nothing moves when the pointer arrives.
        let has_strip = scene.readout.is_some() && inner.height() >= LEAST_WITH_STRIP;
        let between = if has_strip {
            STRIP_HEIGHT + 2.0 * GAP
        } else {
            GAP
        };
        let plots = inner.height() - 2.0 * HEADING - between - TICKS_HEIGHT;
        let magnitude = Rect::from_min_size(
            pos2(inner.left(), inner.top() + HEADING),
            vec2(inner.width(), MAGNITUDE_PART * plots),
        );
        let strip = Rect::from_min_max(
            pos2(inner.left() + VALUE_AXIS_WIDTH, magnitude.bottom() + GAP),
            pos2(inner.right(), magnitude.bottom() + GAP + STRIP_HEIGHT),
        );
        let phase = inner.with_min_y(magnitude.bottom() + between + HEADING);
        let heading = |pane: Rect| {
            Rect::from_min_max(pos2(pane.left(), pane.top() - HEADING), pane.right_top())
        };
        Self {
            headings: [heading(magnitude), heading(phase)],
            panes: [magnitude, phase],
            strip: has_strip.then_some(strip),
            coherence,
        }
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
        let is_inside = |rect: Rect| rect.contains(pointer) && ui.rect_contains_pointer(rect);
        let is_dragging = ui.input(|input| input.pointer.is_decidedly_dragging());
        PANES.into_iter().find_map(|pane| {
            let transform = view
                .transform(pane)
                .filter(|transform| is_inside(*transform.frame()))?;
            let log_omega = transform.value_from_position(pointer).x;
            // During dragging, curves that pass under the pointer are ignored.
            let hit = if is_dragging {
                None
            } else {
                meant(scene, pane, pointer, transform)
            };
            Some(Self { log_omega, hit })
        })
    }
}

/// Distance from a reference line within which the pointer is on it, whatever lies below \[pt\].
const ON_RULE: f32 = 1.0;

/// Returns the curve under the pointer: the nearest curve, unless a reference line, which is drawn
/// on top, is as near or has the pointer on it.
fn meant(
    scene: &BodeScene<'_>,
    pane: Pane,
    pointer: Pos2,
    transform: &PlotTransform,
) -> Option<Hit> {
    let hit = nearest(scene.curves, pane, pointer, transform)?;
    let is_on_rule = distance_to_rules(scene.rules, pane, pointer, transform)
        .is_some_and(|rule| rule <= hit.distance.max(ON_RULE));
    if is_on_rule { None } else { Some(hit) }
}

fn takes_clicks(scene: &BodeScene<'_>, hit: Hit) -> bool {
    scene.reference != Some(&scene.curves[hit.curve].id)
}

/// Panes, from top to bottom.
pub(crate) const PANES: [Pane; 2] = [Pane::Magnitude, Pane::Phase];

fn set_hovered(view: &mut BodeView, hovered: Option<CurveId>, events: &mut Vec<BodeEvent>) {
    if view.hovered != hovered {
        view.hovered.clone_from(&hovered);
        events.push(BodeEvent::Hovered(hovered));
    }
}

/// Handles a click: it means the nearest curve, and nothing if this is the reference. The second
/// click of a double click undoes the first if that was on a curve, and fits the plot on empty
/// ground.
fn click(
    pane: Pane,
    scene: &BodeScene<'_>,
    response: &Response,
    view: &mut BodeView,
    events: &mut Vec<BodeEvent>,
) {
    if !response.clicked() {
        return;
    }
    let pointer = response.interact_pointer_pos();
    let hit = pointer
        .zip(view.transform(pane))
        .and_then(|(at, transform)| meant(scene, pane, at, transform));
    let id = hit
        .filter(|hit| takes_clicks(scene, *hit))
        .map(|hit| scene.curves[hit.curve].id.clone());
    let before = view.last_clicked.take();
    match (response.double_clicked(), before, id) {
        (true, Some(before), _) => events.push(BodeEvent::TakenBack(before)),
        (true, None, None) => {
            view.request_fit();
            response.ctx.request_repaint();
        }
        (true, None, Some(_)) | (false, _, None) => {}
        (false, _, Some(id)) if response.ctx.input(|input| input.modifiers.alt) => {
            events.push(BodeEvent::Isolated(id))
        }
        (false, _, Some(id)) => {
            view.last_clicked = Some(id.clone());
            events.push(BodeEvent::Clicked(id));
        }
    }
}

/// Draws the texts around the panes: their contents, the effect of the correction, the values at
/// the cursor, the names at the ends of the heavy curves, and whether newer curves are expected.
fn headings_ui(
    ui: &Ui,
    places: &Places,
    scene: &BodeScene<'_>,
    view: &BodeView,
    palette: &Palette,
) {
    for ((pane, line), note) in PANES.into_iter().zip(places.headings).zip(scene.notes) {
        let label = scene.quantity.axis_label(pane);
        let (name, unit) = label.split_once(" [").unwrap_or((&label, ""));
        let name = painted_text(ui, line, 0.0, name, medium(BODY_SIZE), palette.text);
        let unit = unit.trim_end_matches(']');
        let beside = name.right() - line.left() + 4.0;
        let unit = row_text(ui, line, beside, unit, BODY_SIZE, palette.dim_text);
        if let Some(note) = note {
            let color = if note.warns {
                palette.warning
            } else {
                palette.dim_text
            };
            let verdict = row_text(ui, line, -0.01, &note.verdict, BODY_SIZE, color);
            let mut rest = line.with_max_x(verdict.left() - 12.0);
            // Beside the bracket if there is a margin, otherwise here.
            if let Some(price) = scene
                .price_words()
                .filter(|_| pane == Pane::Magnitude && !scene.names_curves)
            {
                let words = format!("leads {price}");
                let place = row_text(ui, rest, -0.01, &words, BODY_SIZE, palette.warning);
                rest = rest.with_max_x(place.left() - 12.0);
            }
            let shown = elided(ui, &note.cost, rest.right() - unit.right() - 8.0, BODY_SIZE);
            row_text(ui, rest, -0.01, &shown, BODY_SIZE, palette.dim_text);
        } else if scene.stale && pane == Pane::Magnitude {
            row_text(
                ui,
                line,
                -0.01,
                scene.message.unwrap_or("updating…"),
                SMALL_SIZE,
                palette.dim_text,
            );
        }
        if scene.names_curves || !scene.rules.is_empty() {
            names_ui(ui, pane, scene, view, palette);
        }
    }
    if let Some(frame) = view
        .transform(Pane::Phase)
        .map(|transform| *transform.frame())
    {
        let at = pos2(frame.right() + 14.0, frame.bottom() + 0.5 * TICKS_HEIGHT);
        let unit = scene.unit.symbol();
        ui.painter().text(
            at,
            Align2::LEFT_CENTER,
            unit,
            caption_font(),
            palette.dim_text,
        );
    }
    if let (Some(strip), Some(readout)) = (places.strip, scene.readout) {
        readout_strip_ui(ui, strip, readout, palette);
    }
    if let (Some(strip), Some(transform)) = (places.coherence, view.transform(Pane::Phase)) {
        coherence_ui(ui, strip, scene, transform, palette);
    }
}

/// Draws the coherence of the measured responses over the frequencies of the panes, with the least
/// coherence that counts.
fn coherence_ui(
    ui: &Ui,
    strip: Rect,
    scene: &BodeScene<'_>,
    transform: &PlotTransform,
    palette: &Palette,
) {
    let strip = strip
        .with_min_x(transform.frame().left())
        .with_max_x(transform.frame().right());
    let y = |value: f64| strip.bottom() - strip.height() * (value / 1.05) as f32;
    let painter = ui.painter();
    painter.rect_stroke(
        strip,
        0.0,
        Stroke::new(1.0, palette.line),
        StrokeKind::Inside,
    );
    for value in [0.0, 1.0] {
        let at = pos2(
            strip.left() - 6.0,
            y(value).clamp(strip.top() + 5.0, strip.bottom() - 5.0),
        );
        painter.text(
            at,
            Align2::RIGHT_CENTER,
            format!("{value}"),
            caption_font(),
            palette.dim_text,
        );
    }
    painter.text(
        pos2(strip.left() - 6.0, y(0.5)),
        Align2::RIGHT_CENTER,
        "γ²",
        caption_font(),
        palette.text,
    );
    let least = [strip.left(), strip.right()].map(|x| pos2(x, y(scene.least_coherence)));
    painter.extend(Shape::dashed_line(
        &least,
        Stroke::new(1.0, palette.dim_text),
        4.0,
        3.0,
    ));
    let painter = painter.with_clip_rect(strip.intersect(ui.clip_rect()));
    for curve in scene.coherence {
        let place = |[omega, value]: &[f64; 2]| {
            pos2(
                transform
                    .position_from_point(&PlotPoint::new(omega.log10(), 0.0))
                    .x,
                y(*value),
            )
        };
        let style = palette
            .role_style(curve.role, curve.rejected)
            .in_miniature();
        let mut shapes = Vec::new();
        style.add_shapes(curve.points.iter().map(place).collect(), &mut shapes);
        painter.extend(shapes);
    }
    let name = format!(
        "Coherence of {}{}",
        scene.pair_title,
        scene.quantity.label_suffix()
    );
    named(ui.interact(strip, Id::unique(&name), Sense::hover()), egui::Role::Label, name)
        .on_hover_text("γ² of the measured responses; below the dashed line a frequency does not count, or is a guess");
}

/// Roles named at the ends of their curves.
const NAMED: [Role; 5] = [
    Role::IdentifiedRepresentative,
    Role::Corrected,
    Role::WithoutLeads,
    Role::Variant,
    Role::Nominal,
];
/// Least distance between two names \[pt\].
const NAME_GAP: f32 = 14.0;

/// Returns the width of the right margin \[pt\].
fn margin(scene: &BodeScene<'_>) -> f32 {
    match (scene.rules.is_empty(), scene.names_curves) {
        (false, _) => MARGINS[2],
        (true, true) => MARGINS[1],
        (true, false) => MARGINS[0],
    }
}

/// Draws the names of the heavy curves at their ends, and of the reference lines.
fn names_ui(ui: &Ui, pane: Pane, scene: &BodeScene<'_>, view: &BodeView, palette: &Palette) {
    let Some(transform) = view.transform(pane) else {
        return;
    };
    let frame = *transform.frame();
    let last = view.omega_range().1;
    let end = |role: Role| {
        let curve = scene.curves.iter().find(|curve| curve.role == role)?;
        let omega = curve.omega.last()?.min(last);
        let at = transform
            .position_from_point(&PlotPoint::new(omega.log10(), curve.value_at(pane, omega)?));
        Some((role, at.y.clamp(frame.top() + 5.0, frame.bottom() - 5.0)))
    };
    let named = |(role, y): (Role, f32)| {
        let color = palette.name_of(palette.role_style(role, false).color.to_opaque());
        (y, role.name().to_owned(), color)
    };
    let heavy = NAMED
        .into_iter()
        .filter(|_| scene.names_curves)
        .filter_map(end)
        .map(named);
    let mut ends: Vec<(f32, String, Color32)> = heavy
        .chain(rule_ends(scene.rules, pane, transform, palette))
        .collect();
    if let (Pane::Magnitude, Some([with, without])) =
        (pane, scene.invalid.and_then(|invalid| invalid.ends_db))
    {
        let at = transform.position_from_point(&PlotPoint::new(0.0, 0.5 * (with + without)));
        let y = at.y.clamp(frame.top() + 5.0, frame.bottom() - 5.0);
        ends.extend(scene.price_words().map(|words| (y, words, palette.warning)));
    }
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    spread(&mut ends, frame.bottom() - 5.0);
    for (y, name, color) in ends {
        ui.painter().text(
            pos2(frame.right() + 6.0, y),
            Align2::LEFT_CENTER,
            name,
            caption_font(),
            color,
        );
    }
}

/// Shifts labels down until they no longer overlap, then up again if they leave the plot.
fn spread<T, U>(ends: &mut [(f32, T, U)], bottom: f32) {
    for index in 1..ends.len() {
        ends[index].0 = ends[index].0.max(ends[index - 1].0 + NAME_GAP);
    }
    let mut limit = bottom;
    for (y, ..) in ends.iter_mut().rev() {
        *y = y.min(limit);
        limit = *y - NAME_GAP;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_clear_of_one_another_and_within_the_plot() {
        let mut ends = [80.0, 95.0, 96.0].map(|y| (y, (), ()));
        spread(&mut ends, 100.0);
        let places = ends.map(|(y, ..)| y);
        assert_eq!(places, [72.0, 86.0, 100.0]);
    }
}
