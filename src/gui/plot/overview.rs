//! Every response at once: a table of small Bode plots with outputs in rows and inputs in columns.

use std::collections::BTreeMap;

use egui::{
    Align2, Button, CursorIcon, Painter, Pos2, Rect, Response, RichText, Sense, Stroke, StrokeKind,
    Ui, UiBuilder, Vec2, WidgetInfo, pos2, vec2,
};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::Range;

use super::bode_event::CurveWish;
use super::curve_layer::DrawnPane;
use super::curve_menu::model_wishes_ui;
use super::drawn_curves::{BodeCurve, CurveId, PANES, Pane};
use super::panel_text::{caption_font, message_ui};
use super::picking::{Hit, nearest};
use super::sketch::{Sketch, range_text};
use crate::gui::widgets::controls::{elided, row_text};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Width of the row names and height of the column names \[pt\].
const HEADER: Vec2 = vec2(52.0, 22.0);
/// Gap between two cells \[pt\].
const GAP: f32 = 4.0;
/// Share of a cell's height for the magnitude, if the phase is shown too.
const MAGNITUDE_PART: f32 = 0.58;
/// Minimum size of a cell with texts \[pt\].
const LEAST_WITH_TEXT: Vec2 = vec2(96.0, 54.0);
/// Height of the line above the curves of a cell \[pt\].
const CELL_HEAD: f32 = 16.0;

/// Response shown in a cell of the overview.
#[derive(Clone, Debug)]
pub struct OverviewCell<'a> {
    pub pair: Pair,
    pub curves: &'a [BodeCurve],
    pub constrained: bool,
    /// Whether the pair is in focus.
    pub selected: bool,
    /// Short text in the corner, such as J; may be empty.
    pub note: String,
}

/// Content of the overview.
#[derive(Clone, Copy, Debug)]
pub struct OverviewScene<'a> {
    /// Input names: the columns.
    pub inputs: &'a [String],
    /// Output names: the rows.
    pub outputs: &'a [String],
    /// Responses, in any order.
    pub cells: &'a [OverviewCell<'a>],
    /// Lower and upper end of the comparison band \[rad/s\].
    pub band: (f64, f64),
    /// Message shown if there is nothing to draw.
    pub message: Option<&'a str>,
}

/// Event in the overview.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OverviewEvent {
    PairClicked(Pair),
    /// A curve is under the pointer.
    Hovered(CurveId),
    /// Description of the element under the pointer.
    Told(String),
    /// A curve was clicked with Alt pressed.
    Isolated(CurveId),
    /// An entry of a curve's menu was chosen.
    Wished(CurveId, CurveWish),
}

/// Curve whose menu is open, and its cell.
#[derive(Clone, Debug)]
struct MenuCurve {
    pair: Pair,
    curve: CurveId,
}

/// State of the overview between frames.
#[derive(Clone, Debug, Default)]
pub struct OverviewView {
    /// Whether phases are shown below magnitudes.
    pub show_phase: bool,
    sketches: BTreeMap<(Pair, Pane), DrawnPane>,
    menu_curve: Option<MenuCurve>,
}

impl OverviewView {
    /// Returns the transform of a cell as last drawn.
    fn transform(&self, pair: Pair, pane: Pane) -> Option<&PlotTransform> {
        self.sketches.get(&(pair, pane))?.transform.as_ref()
    }

    /// Returns the cell's curve under the pointer, if any.
    fn curve_at<'c>(&self, cell: &OverviewCell<'c>, pointer: Pos2) -> Option<&'c BodeCurve> {
        let mut best: Option<Hit> = None;
        for pane in PANES {
            let Some(transform) = self.transform(cell.pair, pane) else {
                continue;
            };
            if !transform.frame().contains(pointer) {
                continue;
            }
            if let Some(hit) = nearest(cell.curves, pane, pointer, transform)
                && best.is_none_or(|best| hit.distance < best.distance)
            {
                best = Some(hit);
            }
        }
        cell.curves.get(best?.curve)
    }

    /// Returns the screen position of a magnitude, given as `log10 omega` and decibels.
    pub fn position_in(&self, pair: Pair, log_omega: f64, magnitude_db: f64) -> Option<Pos2> {
        let transform = self.transform(pair, Pane::Magnitude)?;
        Some(transform.position_from_point(&PlotPoint::new(log_omega, magnitude_db)))
    }

    /// Returns the screen centre of the magnitude in a cell.
    pub fn screen_position(&self, pair: Pair) -> Option<Pos2> {
        let transform = self.transform(pair, Pane::Magnitude)?;
        Some(transform.frame().center())
    }
}

/// Draws the overview into the remaining space in `ui`.
pub fn overview_ui(
    ui: &mut Ui,
    scene: &OverviewScene<'_>,
    view: &mut OverviewView,
    palette: &Palette,
) -> Vec<OverviewEvent> {
    let rect = ui.available_rect_before_wrap();
    let is_empty = scene.inputs.is_empty() || scene.outputs.is_empty();
    let (Some(log_omega), false) = (log_omega_of(scene.cells), is_empty) else {
        let message = scene.message.unwrap_or("Nothing to draw");
        message_ui(ui, rect, message, palette);
        return Vec::new();
    };
    let table = Table {
        rect,
        columns: scene.inputs.len(),
        rows: scene.outputs.len(),
    };
    let mut events = Vec::new();
    ui.scope_builder(UiBuilder::new().id_salt("overview").max_rect(rect), |ui| {
        phase_switch_ui(ui, &table, view);
        table.paint_names(ui, scene, palette);
        for cell in scene.cells {
            let placed = PlacedCell {
                cell,
                place: table.cell(cell.pair),
                name: cell_name(scene, cell),
                band: scene.band,
                log_omega,
                palette,
            };
            let response = placed.ui(ui, view);
            events.extend(placed.events(&response, view));
        }
    });
    ui.advance_cursor_after_rect(rect);
    events
}

/// Returns the range of `log10 omega` of all curves. Frequencies ascend, so the first and the last
/// suffice.
fn log_omega_of(cells: &[OverviewCell<'_>]) -> Option<Range> {
    let mut ends = Vec::new();
    for curve in cells.iter().flat_map(|cell| cell.curves) {
        if let (Some(first), Some(last)) = (curve.omega.first(), curve.omega.last()) {
            ends.extend([first.log10(), last.log10()]);
        }
    }
    Range::spanning(ends)
}

/// Returns "LON → Q: J 75".
fn cell_name(scene: &OverviewScene<'_>, cell: &OverviewCell<'_>) -> String {
    let input = &scene.inputs[cell.pair.input];
    let output = &scene.outputs[cell.pair.output];
    if cell.note.is_empty() {
        format!("{input} → {output}")
    } else {
        format!("{input} → {output}: {}", cell.note)
    }
}

/// Places of the cells.
struct Table {
    rect: Rect,
    columns: usize,
    rows: usize,
}

impl Table {
    fn cell(&self, pair: Pair) -> Rect {
        let area = Rect::from_min_max(self.rect.min + HEADER, self.rect.max);
        let size = vec2(
            area.width() / self.columns as f32,
            area.height() / self.rows as f32,
        );
        let offset = vec2(pair.input as f32 * size.x, pair.output as f32 * size.y);
        let inner = (size - vec2(GAP, GAP)).max(vec2(1.0, 1.0));
        Rect::from_min_size(area.min + offset, inner)
    }

    /// Paints input names above the columns and output names beside the rows.
    fn paint_names(&self, ui: &Ui, scene: &OverviewScene<'_>, palette: &Palette) {
        let mut names = Vec::new();
        for (input, name) in scene.inputs.iter().enumerate() {
            let x = self.cell(Pair::new(0, input)).center().x;
            names.push((pos2(x, self.rect.top() + 0.5 * HEADER.y - 1.0), name));
        }
        for (output, name) in scene.outputs.iter().enumerate() {
            let y = self.cell(Pair::new(output, 0)).center().y;
            names.push((pos2(self.rect.left() + 0.5 * HEADER.x - 2.0, y), name));
        }
        for (place, name) in names {
            let font = caption_font();
            ui.painter()
                .text(place, Align2::CENTER_CENTER, name, font, palette.dim_text);
        }
    }
}

/// Draws the phase switch in the corner of the table.
fn phase_switch_ui(ui: &mut Ui, table: &Table, view: &mut OverviewView) {
    let place = Rect::from_min_size(table.rect.min, HEADER - vec2(4.0, 4.0));
    let switch = Button::selectable(view.show_phase, RichText::new("phase").size(SMALL_SIZE))
        .wrap_mode(egui::TextWrapMode::Extend);
    let response = ui.put(place, switch);
    if response
        .on_hover_text("Show phases below magnitudes")
        .clicked()
    {
        view.show_phase = !view.show_phase;
    }
}

/// Response at its position in the table.
struct PlacedCell<'a> {
    cell: &'a OverviewCell<'a>,
    place: Rect,
    /// Accessible name.
    name: String,
    /// Lower and upper end of the comparison band \[rad/s\].
    band: (f64, f64),
    /// Visible range of `log10 omega`.
    log_omega: Range,
    palette: &'a Palette,
}

impl PlacedCell<'_> {
    fn ui(&self, ui: &Ui, view: &mut OverviewView) -> Response {
        let id = ui.scope_id().with(self.cell.pair);
        let response = ui.interact(self.place, id, Sense::click());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &self.name));
        if ui.is_rect_visible(self.place) {
            self.paint_frame(ui, response.hovered() || response.has_focus());
            self.paint_content(ui, view);
        }
        response.on_hover_cursor(CursorIcon::PointingHand)
    }

    fn paint_frame(&self, ui: &Ui, is_pointed_at: bool) {
        let palette = self.palette;
        let mut fill = palette.background;
        if self.cell.constrained {
            fill = fill.lerp_to_gamma(palette.selected, 0.55);
        }
        let outline = if self.cell.selected {
            Stroke::new(2.0, palette.accent)
        } else if is_pointed_at {
            Stroke::new(1.0, palette.accent)
        } else {
            Stroke::new(1.0, palette.line)
        };
        ui.painter()
            .rect(self.place, 2.0, fill, outline, StrokeKind::Inside);
    }

    /// Draws the curves, and the texts above them if there is room.
    fn paint_content(&self, ui: &Ui, view: &mut OverviewView) {
        let clip = self.place.shrink(1.5).intersect(ui.clip_rect());
        let painter = ui.painter().with_clip_rect(clip);
        let has_texts =
            self.place.width() >= LEAST_WITH_TEXT.x && self.place.height() >= LEAST_WITH_TEXT.y;
        let inner = self.place.shrink(2.0);
        let head_height = if has_texts { CELL_HEAD } else { 0.0 };
        let head = inner.with_max_y(inner.top() + head_height);
        let mut ranges = Vec::new();
        for (pane, rect) in pane_rects(inner.with_min_y(head.bottom()), view.show_phase) {
            self.paint_band(&painter, rect);
            let drawn = view.sketches.entry((self.cell.pair, pane)).or_default();
            let sketch = Sketch {
                curves: self.cell.curves,
                pane,
                rect,
                log_omega: self.log_omega,
                palette: self.palette,
            };
            sketch.paint(&painter, drawn);
            ranges.push(range_text(drawn, pane));
        }
        if has_texts {
            self.paint_head(ui, head, &ranges.join(" · "));
        }
    }

    /// Paints the vertical ranges and the note of the cell, which has no axes, above the curves.
    fn paint_head(&self, ui: &Ui, head: Rect, ranges: &str) {
        let palette = self.palette;
        let head = head.shrink2(vec2(3.0, 0.0));
        let note = row_text(ui, head, -0.01, &self.cell.note, SMALL_SIZE, palette.text);
        let room = note.left() - head.left() - 6.0;
        let ranges = elided(ui, ranges, room, SMALL_SIZE);
        row_text(ui, head, 0.0, &ranges, SMALL_SIZE, palette.dim_text);
    }

    /// Shades the comparison band, and draws the lower edge of a pane.
    fn paint_band(&self, painter: &Painter, rect: Rect) {
        let (min, max) = self.band;
        let ends = self.place_across(rect, min)..=self.place_across(rect, max);
        let band = Rect::from_x_y_ranges(ends, rect.y_range());
        painter.rect_filled(band, 0.0, self.palette.accent.gamma_multiply(0.06));
        let line = Stroke::new(1.0, self.palette.grid);
        painter.hline(rect.x_range(), rect.bottom(), line);
    }

    /// Returns the horizontal screen position of a frequency \[rad/s\], limited to the pane.
    fn place_across(&self, rect: Rect, omega: f64) -> f32 {
        let fraction = (omega.log10() - self.log_omega.min) / self.log_omega.width();
        rect.left() + fraction.clamp(0.0, 1.0) as f32 * rect.width()
    }

    /// Handles the events in the cell: a click brings its response into focus; all others concern
    /// the curve under the pointer.
    fn events(&self, response: &Response, view: &mut OverviewView) -> Vec<OverviewEvent> {
        let pointer = response.hover_pos().or(response.interact_pointer_pos());
        let curve = pointer.and_then(|pointer| view.curve_at(self.cell, pointer));
        let pointed = curve.map(|curve| curve.id.clone());
        let mut events = Vec::new();
        events.extend(pointed.clone().map(OverviewEvent::Hovered));
        if response.hovered() {
            events.push(OverviewEvent::Told(match curve {
                Some(curve) => format!("{} · {}", self.name, curve.label),
                None => self.name.clone(),
            }));
        }
        if response.clicked() {
            let is_alone = response.ctx.input(|input| input.modifiers.alt);
            events.push(match &pointed {
                Some(curve) if is_alone => OverviewEvent::Isolated(curve.clone()),
                _ => OverviewEvent::PairClicked(self.cell.pair),
            });
        }
        if response.secondary_clicked() {
            let pair = self.cell.pair;
            view.menu_curve = pointed.map(|curve| MenuCurve { pair, curve });
        }
        if let Some(curve) = self.menu_curve(view) {
            response.context_menu(|ui| {
                ui.label(RichText::new(&curve.label).strong());
                if let Some(wish) = model_wishes_ui(ui, curve) {
                    events.push(OverviewEvent::Wished(curve.id.clone(), wish));
                }
            });
        }
        events
    }

    /// Returns the curve whose menu is open, if it is in this cell.
    fn menu_curve(&self, view: &OverviewView) -> Option<&BodeCurve> {
        let menu = view.menu_curve.as_ref()?;
        if menu.pair != self.cell.pair {
            return None;
        }
        self.cell.curves.iter().find(|curve| curve.id == menu.curve)
    }
}

/// Returns the panes of a cell and their places.
fn pane_rects(rect: Rect, show_phase: bool) -> Vec<(Pane, Rect)> {
    if !show_phase {
        return vec![(Pane::Magnitude, rect)];
    }
    let split = rect.top() + MAGNITUDE_PART * rect.height();
    let (upper, lower) = rect.split_top_bottom_at_y(split);
    vec![(Pane::Magnitude, upper), (Pane::Phase, lower)]
}
