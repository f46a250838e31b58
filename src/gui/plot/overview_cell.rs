//! Overview cell: a response's small Bode plot, and its events.

use egui::{
    CursorIcon, Painter, Rect, Response, RichText, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2,
};

use gdcm_plot::figure::Range;

use super::curve_menu::model_actions_ui;
use super::drawn_curves::{BodeCurve, Pane};
use super::overview_scene::{MenuCurve, OverviewCell, OverviewEvent, OverviewView};
use super::panel_painter::paint_frame;
use super::panel_text::AT_RIGHT;
use super::sketch::{Sketch, range_text};
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::painted_text::row_text;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Share of a cell's height for the magnitude, if the phase is shown too.
const MAGNITUDE_PART: f32 = 0.58;
/// Minimum size for a cell with texts \[pt\].
const LEAST_WITH_TEXT: Vec2 = vec2(96.0, 54.0);
/// Line height above a cell's curves \[pt\].
const CELL_HEAD: f32 = 16.0;

/// Response at its position in the table.
pub(super) struct PlacedCell<'a> {
    pub(super) cell: &'a OverviewCell<'a>,
    pub(super) place: Rect,
    /// Accessible name.
    pub(super) name: String,
    /// Lower and upper end of the comparison band \[rad/s\].
    pub(super) band: (f64, f64),
    /// Visible range of `log10 omega`.
    pub(super) log_omega: Range,
    pub(super) palette: &'a Palette,
}

impl PlacedCell<'_> {
    /// Draws the cell; returns its events.
    pub(super) fn ui(&self, ui: &Ui, view: &mut OverviewView) -> Vec<OverviewEvent> {
        let id = ui.scope_id().with(self.cell.pair);
        let response = ui.interact(self.place, id, Sense::click());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &self.name));
        if ui.is_rect_visible(self.place) {
            self.paint_frame(ui, response.hovered() || response.has_focus());
            self.paint_content(ui, view);
        }
        let response = response.on_hover_cursor(CursorIcon::PointingHand);
        self.events(&response, view)
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
        paint_frame(ui, self.place, fill, outline);
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

    /// Paints the vertical ranges and the note above the curves, because the cell has no axes.
    fn paint_head(&self, ui: &Ui, head: Rect, ranges: &str) {
        let palette = self.palette;
        let head = head.shrink2(vec2(3.0, 0.0));
        let note = row_text(
            ui,
            head,
            AT_RIGHT,
            &self.cell.note,
            SMALL_SIZE,
            palette.text,
        );
        let room = note.left() - head.left() - 6.0;
        let ranges = elided(ui, ranges, room, SMALL_SIZE);
        row_text(ui, head, 0.0, &ranges, SMALL_SIZE, palette.dim_text);
    }

    /// Shades the comparison band, and draws a pane's lower edge.
    fn paint_band(&self, painter: &Painter, rect: Rect) {
        let (min, max) = self.band;
        let ends = self.place_across(rect, min)..=self.place_across(rect, max);
        let band = Rect::from_x_y_ranges(ends, rect.y_range());
        painter.rect_filled(band, 0.0, self.palette.accent.gamma_multiply(0.06));
        let line = Stroke::new(1.0, self.palette.grid);
        painter.hline(rect.x_range(), rect.bottom(), line);
    }

    /// Returns the horizontal screen position for a frequency \[rad/s\], limited to the pane.
    fn place_across(&self, rect: Rect, omega: f64) -> f32 {
        let fraction = (omega.log10() - self.log_omega.min) / self.log_omega.width();
        rect.left() + fraction.clamp(0.0, 1.0) as f32 * rect.width()
    }

    /// Handles the events in the cell:
    ///
    /// 1. pointing: the curve under the pointer, if any, is hovered and named in the status text;
    /// 2. click: with Alt on a curve, its model alone is shown; otherwise the cell's response comes
    ///    into focus;
    /// 3. secondary click: opens the menu on the curve, or closes it on empty ground.
    fn events(&self, response: &Response, view: &mut OverviewView) -> Vec<OverviewEvent> {
        let pointer = response.hover_pos().or(response.interact_pointer_pos());
        let curve = pointer.and_then(|pointer| view.curve_at(self.cell, pointer));
        let pointed = curve.map(|curve| curve.id.clone());
        let mut events = Vec::new();
        events.extend(pointed.clone().map(OverviewEvent::Hovered));
        if response.hovered() {
            events.push(OverviewEvent::StatusText(match curve {
                Some(curve) => format!("{} · {}", self.name, curve.label),
                None => self.name.clone(),
            }));
        }
        if response.clicked() {
            let has_alt = response.ctx.input(|input| input.modifiers.alt);
            events.push(match &pointed {
                Some(curve) if has_alt => OverviewEvent::Isolated(curve.clone()),
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
                if let Some(action) = model_actions_ui(ui, curve) {
                    events.push(OverviewEvent::ActionChosen(curve.id.clone(), action));
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

/// Returns a cell's panes and their places.
fn pane_rects(rect: Rect, show_phase: bool) -> Vec<(Pane, Rect)> {
    if !show_phase {
        return vec![(Pane::Magnitude, rect)];
    }
    let split = rect.top() + MAGNITUDE_PART * rect.height();
    let (upper, lower) = rect.split_top_bottom_at_y(split);
    vec![(Pane::Magnitude, upper), (Pane::Phase, lower)]
}
