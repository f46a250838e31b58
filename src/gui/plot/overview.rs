//! Every response at once: a table of small Bode plots with outputs in rows and inputs in columns.

use std::collections::BTreeMap;

use egui::{
    Align2, Button, CursorIcon, Painter, Pos2, Rect, Response, RichText, Sense, Stroke, StrokeKind,
    Ui, UiBuilder, Vec2, WidgetInfo, pos2, vec2,
};
use egui_plot::{PlotBounds, PlotPoint, PlotTransform};

use gdcm_model::dataset::Pair;
use gdcm_model::number_format::decimals;
use gdcm_plot::figure::Range;

use super::axes::{caption_font, message_ui};
use super::bode::PANES;
use super::curve_menu::{CurveWish, model_wishes_ui};
use super::drawn_curves::{BodeCurve, CurveId, DrawnCurves, Pane, curve_lines, pixel_of};
use super::navigation::nearest;
use crate::gui::widgets::controls::{elided, row_text};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

const HEADER: Vec2 = vec2(52.0, 22.0);
const GAP: f32 = 4.0;
/// Share of a cell's height taken by the magnitude if the phase is shown too.
const MAGNITUDE_PART: f32 = 0.58;
/// Least cell size with texts \[pt\].
const LEAST_WITH_TEXT: Vec2 = vec2(96.0, 54.0);
/// Height of the line of text above the curves of a cell \[pt\].
const CELL_HEAD: f32 = 16.0;

/// Response in the overview.
#[derive(Clone, Debug)]
pub struct OverviewCell<'a> {
    pub pair: Pair,
    pub curves: &'a [BodeCurve],
    pub constrained: bool,
    /// Whether it is the pair in focus.
    pub selected: bool,
    /// Short text in the corner, such as J; may be empty.
    pub note: String,
}

/// Content of the overview.
#[derive(Clone, Copy, Debug)]
pub struct OverviewScene<'a> {
    /// Names of the inputs: the columns.
    pub inputs: &'a [String],
    /// Names of the outputs: the rows.
    pub outputs: &'a [String],
    /// Responses, in any order.
    pub cells: &'a [OverviewCell<'a>],
    /// Band of comparison: lower and upper end \[rad/s\].
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

/// State of the overview between frames.
#[derive(Clone, Debug, Default)]
pub struct OverviewView {
    /// Whether phases are shown below magnitudes.
    pub show_phase: bool,
    sketches: BTreeMap<(Pair, Pane), Sketch>,
    /// Curve whose menu is open, with its cell.
    menu_of: Option<(Pair, CurveId)>,
}

impl OverviewView {
    /// Returns the curve of a cell under the pointer, if any.
    fn curve_at<'c>(&self, cell: &OverviewCell<'c>, pointer: Pos2) -> Option<&'c BodeCurve> {
        let hit = |pane: Pane| {
            let transform = self.sketches.get(&(cell.pair, pane))?.transform?;
            let is_inside = transform.frame().contains(pointer);
            nearest(cell.curves, pane, pointer, &transform).filter(|_| is_inside)
        };
        let hits = PANES.into_iter().filter_map(hit);
        let hit = hits.min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        cell.curves.get(hit.curve)
    }

    /// Returns the screen position of a magnitude of a response: decades of frequency and decibels.
    pub fn position_in(&self, pair: Pair, log_omega: f64, magnitude_db: f64) -> Option<Pos2> {
        let transform = self.sketches.get(&(pair, Pane::Magnitude))?.transform?;
        Some(transform.position_from_point(&PlotPoint::new(log_omega, magnitude_db)))
    }

    /// Returns the screen position of the centre of a response's magnitude.
    pub fn screen_position(&self, pair: Pair) -> Option<Pos2> {
        Some(
            self.sketches
                .get(&(pair, Pane::Magnitude))?
                .transform?
                .frame()
                .center(),
        )
    }
}

/// Draws the overview into the remaining space of `ui`.
pub fn overview_ui(
    ui: &mut Ui,
    scene: &OverviewScene<'_>,
    view: &mut OverviewView,
    palette: &Palette,
) -> Vec<OverviewEvent> {
    let rect = ui.available_rect_before_wrap();
    let curves = scene.cells.iter().flat_map(|cell| cell.curves);
    // Frequencies ascend: the ends are sufficient.
    let ends = curves
        .flat_map(|curve| [curve.omega.first(), curve.omega.last()])
        .flatten();
    let log_omega = Range::of(ends.map(|omega| omega.log10()));
    let (Some(log_omega), false, false) =
        (log_omega, scene.inputs.is_empty(), scene.outputs.is_empty())
    else {
        message_ui(
            ui,
            rect,
            scene.message.unwrap_or("Nothing to draw"),
            palette,
        );
        return Vec::new();
    };
    let table = Table {
        rect,
        columns: scene.inputs.len(),
        rows: scene.outputs.len(),
    };
    let mut events = Vec::new();
    ui.scope_builder(UiBuilder::new().id_salt("overview").max_rect(rect), |ui| {
        headers_ui(ui, scene, view, &table, palette);
        for cell in scene.cells {
            let place = table.cell(cell.pair);
            let title = format!(
                "{} → {}",
                scene.inputs[cell.pair.input], scene.outputs[cell.pair.output]
            );
            let name = if cell.note.is_empty() {
                title
            } else {
                format!("{title}: {}", cell.note)
            };
            let response = cell_ui(ui, scene, (cell, place, &name), view, log_omega, palette);
            events.extend(cell_events((&response, &name), cell, view));
        }
    });
    ui.advance_cursor_after_rect(rect);
    events
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
        Rect::from_min_size(
            area.min + offset,
            (size - vec2(GAP, GAP)).max(vec2(1.0, 1.0)),
        )
    }
}

fn headers_ui(
    ui: &mut Ui,
    scene: &OverviewScene<'_>,
    view: &mut OverviewView,
    table: &Table,
    palette: &Palette,
) {
    let toggle_place = Rect::from_min_size(table.rect.min, HEADER - vec2(4.0, 4.0));
    let toggle = Button::selectable(view.show_phase, RichText::new("phase").size(SMALL_SIZE))
        .wrap_mode(egui::TextWrapMode::Extend);
    if ui
        .put(toggle_place, toggle)
        .on_hover_text("Show phases below magnitudes")
        .clicked()
    {
        view.show_phase = !view.show_phase;
    }
    let painter = ui.painter();
    for (input, name) in scene.inputs.iter().enumerate() {
        let place = pos2(
            table.cell(Pair::new(0, input)).center().x,
            table.rect.top() + 0.5 * HEADER.y - 1.0,
        );
        painter.text(
            place,
            Align2::CENTER_CENTER,
            name,
            caption_font(),
            palette.dim_text,
        );
    }
    for (output, name) in scene.outputs.iter().enumerate() {
        let place = pos2(
            table.rect.left() + 0.5 * HEADER.x - 2.0,
            table.cell(Pair::new(output, 0)).center().y,
        );
        painter.text(
            place,
            Align2::CENTER_CENTER,
            name,
            caption_font(),
            palette.dim_text,
        );
    }
}

/// Draws a response.
fn cell_ui(
    ui: &Ui,
    scene: &OverviewScene<'_>,
    (cell, place, name): (&OverviewCell<'_>, Rect, &str),
    view: &mut OverviewView,
    log_omega: Range,
    palette: &Palette,
) -> Response {
    let response = ui.interact(place, ui.scope_id().with(cell.pair), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, name));
    if ui.is_rect_visible(place) {
        paint_frame(
            ui,
            cell,
            place,
            response.hovered() || response.has_focus(),
            palette,
        );
        let painter = ui
            .painter()
            .with_clip_rect(place.shrink(1.5).intersect(ui.clip_rect()));
        let inner = place.shrink(2.0);
        let has_texts = place.width() >= LEAST_WITH_TEXT.x && place.height() >= LEAST_WITH_TEXT.y;
        let head = inner.with_max_y(inner.top() + if has_texts { CELL_HEAD } else { 0.0 });
        let mut ranges = Vec::new();
        for (pane, rect) in pane_rects(inner.with_min_y(head.bottom()), view.show_phase) {
            paint_band(&painter, rect, scene.band, log_omega, palette);
            let sketch = view.sketches.entry((cell.pair, pane)).or_default();
            sketch.paint(&painter, cell.curves, (pane, rect), log_omega, palette);
            ranges.push(sketch.range_text(pane));
        }
        if has_texts {
            // The vertical ranges of the cell, which has no axis, and its note: above its curves,
            // not on them.
            let head = head.shrink2(vec2(3.0, 0.0));
            let note = row_text(ui, head, -0.01, &cell.note, SMALL_SIZE, palette.text);
            let ranges = elided(
                ui,
                &ranges.join(" · "),
                note.left() - head.left() - 6.0,
                SMALL_SIZE,
            );
            row_text(ui, head, 0.0, &ranges, SMALL_SIZE, palette.dim_text);
        }
    }
    response.on_hover_cursor(CursorIcon::PointingHand)
}

/// Handles the events in a cell: a click brings its response into focus, the others concern the
/// curve under the pointer.
fn cell_events(
    (response, name): (&Response, &str),
    cell: &OverviewCell<'_>,
    view: &mut OverviewView,
) -> Vec<OverviewEvent> {
    let pointer = response.hover_pos().or(response.interact_pointer_pos());
    let curve = pointer.and_then(|pointer| view.curve_at(cell, pointer));
    let meant = curve.map(|curve| curve.id.clone());
    let mut events: Vec<OverviewEvent> = meant
        .clone()
        .map(OverviewEvent::Hovered)
        .into_iter()
        .collect();
    if response.hovered() {
        let curve = curve.map_or_else(String::new, |curve| format!(" · {}", curve.label));
        events.push(OverviewEvent::Told(format!("{name}{curve}")));
    }
    if response.clicked() {
        let is_alone = response.ctx.input(|input| input.modifiers.alt);
        events.push(match meant.clone().filter(|_| is_alone) {
            Some(curve) => OverviewEvent::Isolated(curve),
            None => OverviewEvent::PairClicked(cell.pair),
        });
    }
    if response.secondary_clicked() {
        view.menu_of = meant.map(|curve| (cell.pair, curve));
    }
    let subject = view.menu_of.as_ref().filter(|(pair, _)| *pair == cell.pair);
    if let Some(curve) =
        subject.and_then(|(_, id)| cell.curves.iter().find(|curve| curve.id == *id))
    {
        response.context_menu(|ui| {
            ui.label(RichText::new(&curve.label).strong());
            events.extend(
                model_wishes_ui(ui, curve)
                    .map(|wish| OverviewEvent::Wished(curve.id.clone(), wish)),
            );
        });
    }
    events
}

fn paint_frame(
    ui: &Ui,
    cell: &OverviewCell<'_>,
    place: Rect,
    is_pointed_at: bool,
    palette: &Palette,
) {
    let fill = match cell.constrained {
        true => palette.background.lerp_to_gamma(palette.selected, 0.55),
        false => palette.background,
    };
    let outline = match (cell.selected, is_pointed_at) {
        (true, _) => Stroke::new(2.0, palette.accent),
        (false, true) => Stroke::new(1.0, palette.accent),
        (false, false) => Stroke::new(1.0, palette.line),
    };
    ui.painter()
        .rect(place, 2.0, fill, outline, StrokeKind::Inside);
}

fn pane_rects(rect: Rect, show_phase: bool) -> Vec<(Pane, Rect)> {
    if !show_phase {
        return vec![(Pane::Magnitude, rect)];
    }
    let split = rect.top() + MAGNITUDE_PART * rect.height();
    let (upper, lower) = rect.split_top_bottom_at_y(split);
    vec![(Pane::Magnitude, upper), (Pane::Phase, lower)]
}

fn paint_band(
    painter: &Painter,
    rect: Rect,
    (min, max): (f64, f64),
    log_omega: Range,
    palette: &Palette,
) {
    let x = |omega: f64| {
        let fraction = (omega.log10() - log_omega.min) / log_omega.width();
        rect.left() + fraction.clamp(0.0, 1.0) as f32 * rect.width()
    };
    let band = Rect::from_x_y_ranges(x(min)..=x(max), rect.y_range());
    painter.rect_filled(band, 0.0, palette.accent.gamma_multiply(0.06));
    painter.hline(
        rect.x_range(),
        rect.bottom(),
        Stroke::new(1.0, palette.grid),
    );
}

/// Greatest distance of a drawn line from the curve \[pt\].
const TOLERANCE: f64 = 0.25;

/// Sparkline as last drawn.
#[derive(Clone, Debug, Default)]
pub(super) struct Sketch {
    drawn: DrawnCurves,
    /// Transform of the last drawing, where x counts decades of frequency; `None` if there was
    /// nothing to draw.
    transform: Option<PlotTransform>,
}

impl Sketch {
    /// Draws all values of `curves` into `rect`, with a little space above and below, the most
    /// important curves on top.
    pub(super) fn paint(
        &mut self,
        painter: &Painter,
        curves: &[BodeCurve],
        (pane, rect): (Pane, Rect),
        log_omega: Range,
        palette: &Palette,
    ) {
        let values = Range::of(
            curves
                .iter()
                .flat_map(|curve| curve.values(pane).iter().copied()),
        );
        self.transform = values
            .map(|values| values.with_margin(0.06, 1.0))
            .map(|values| {
                let bounds = PlotBounds::from_min_max(
                    [log_omega.min, values.min],
                    [log_omega.max, values.max],
                );
                PlotTransform::new(rect, bounds, false)
            });
        let Some(transform) = &self.transform else {
            return;
        };
        let pixel = pixel_of(transform, painter.pixels_per_point(), TOLERANCE);
        self.drawn
            .update(curves, pane, (*transform.bounds(), pixel), palette);
        let mut order: Vec<(usize, &BodeCurve)> = curves.iter().enumerate().collect();
        order.sort_by_key(|(_, curve)| (curve.highlighted, curve.role.layer(curve.rejected)));
        let mut shapes = Vec::new();
        for (index, curve) in order {
            let look = palette
                .role_style(curve.role, curve.rejected)
                .in_miniature();
            let look = if curve.highlighted {
                look.emphasized()
            } else {
                look
            };
            curve_lines(self.drawn.runs(index), look, transform, &mut shapes);
        }
        painter.extend(shapes);
    }

    /// Describes the last visible range of the vertical axis; empty if there was nothing to draw.
    pub(super) fn range_text(&self, pane: Pane) -> String {
        let unit = if pane == Pane::Magnitude { " dB" } else { "°" };
        self.transform.map_or_else(String::new, |transform| {
            let [min, max] =
                [transform.bounds().min(), transform.bounds().max()].map(|end| decimals(end[1], 0));
            format!("{min} … {max}{unit}")
        })
    }
}

#[cfg(test)]
mod tests {
    use egui::{Context, LayerId, pos2};

    use super::*;
    use crate::gui::plot::tests::sample_curve as curve;

    fn paint(sketch: &mut Sketch, curves: &[BodeCurve]) {
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 60.0));
        let painter = Painter::new(Context::default(), LayerId::background(), rect);
        let log_omega = Range::new(0.0, 0.7);
        sketch.paint(
            &painter,
            curves,
            (Pane::Magnitude, rect),
            log_omega,
            &Palette::dark(),
        );
    }

    #[test]
    fn a_curve_that_reaches_farther_widens_what_is_in_view() {
        let mut sketch = Sketch::default();
        let mut curves = vec![curve(0, &[0.0, 9.0, 5.0]), curve(1, &[1.0, 2.0, 3.0])];
        paint(&mut sketch, &curves);
        let before = sketch.transform;
        curves[1] = curve(1, &[1.0, 20.0, 3.0]);
        paint(&mut sketch, &curves);
        assert_ne!(
            sketch.transform.map(|of| *of.bounds()),
            before.map(|of| *of.bounds())
        );
        assert_eq!(sketch.range_text(Pane::Magnitude), "\u{2212}1 … 21 dB");
    }

    #[test]
    fn what_has_no_values_is_told_by_no_range() {
        let mut sketch = Sketch::default();
        paint(&mut sketch, &[curve(0, &[f64::NAN; 3])]);
        assert_eq!(sketch.range_text(Pane::Magnitude), "");
    }
}
