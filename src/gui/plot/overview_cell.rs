//! Overview cell: a response's small Bode plot, and its events.
//!
//! A constrained response, whose gain is matched exactly, has a tinted background.

use egui::{
    CursorIcon, Painter, Rect, Response, RichText, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2,
};

use super::curve_menu::model_actions_ui;
use super::drawn_curves::{BodeCurve, Pane};
use super::overview_axes::AxisRange;
use super::overview_response::OverviewCell;
use super::overview_scene::{MenuCurve, OverviewEvent, OverviewView};
use super::panel_painter::paint_frame;
use super::panel_text::AT_RIGHT;
use super::sketch::Sketch;
use crate::gui::widgets::painted_text::row_text;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Share of a cell's height for the magnitude, if the phase is shown too.
const MAGNITUDE_PART: f32 = 0.58;
/// Minimum size for a cell with texts \[pt\].
const LEAST_WITH_TEXT: Vec2 = vec2(96.0, 54.0);
/// Height of the text line above a cell's curves \[pt\].
const CELL_HEAD: f32 = 16.0;
/// Opacity of the line at the frequency under the pointer.
const POINTED: f32 = 0.55;
/// Opacity of the comparison band's shade.
const BAND_SHADE: f32 = 0.06;
/// Share of the selection colour in the background of a constrained response.
const CONSTRAINED_TINT: f32 = 0.55;

/// Response at its position in the table.
pub(super) struct PlacedCell<'a> {
    pub(super) cell: &'a OverviewCell<'a>,
    pub(super) place: Rect,
    /// Accessible name.
    pub(super) name: String,
    /// Lower and upper end of the comparison band \[rad/s\].
    pub(super) band: (f64, f64),
    /// Frequency axis, of `log10 omega`.
    pub(super) frequencies: AxisRange,
    /// Frequency under the pointer in any plot \[rad/s\].
    pub(super) cursor: Option<f64>,
    pub(super) palette: &'a Palette,
}

pub(super) struct CellLayout {
    /// Line above the curves; empty in a small cell.
    head: Rect,
    pub(super) panes: Vec<(Pane, Rect)>,
}

impl CellLayout {
    pub(super) fn new(place: Rect, show_phase: bool) -> Self {
        let has_head = place.width() >= LEAST_WITH_TEXT.x && place.height() >= LEAST_WITH_TEXT.y;
        let inner = place.shrink(2.0);
        let head_height = if has_head { CELL_HEAD } else { 0.0 };
        let head = inner.with_max_y(inner.top() + head_height);
        Self {
            head,
            panes: pane_rects(inner.with_min_y(head.bottom()), show_phase),
        }
    }
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
            fill = fill.lerp_to_gamma(palette.selected, CONSTRAINED_TINT);
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

    /// Draws the panes, and the note above them if there is room.
    fn paint_content(&self, ui: &Ui, view: &mut OverviewView) {
        let layout = CellLayout::new(self.place, view.show_phase);
        for (pane, rect) in layout.panes {
            let Some(values) = view.ranges.values(self.cell.pair.output, pane) else {
                continue;
            };
            let painter = ui.painter_at(rect.intersect(ui.clip_rect()));
            self.paint_ground(&painter, rect, AxisRange::of_values(pane, values));
            let drawn = view.drawn_panes.entry((self.cell.pair, pane)).or_default();
            let sketch = Sketch {
                curves: self.cell.curves,
                pane,
                rect,
                log_omega: self.frequencies.range,
                values,
                palette: self.palette,
            };
            sketch.paint(&painter, drawn);
            self.paint_cursor(&painter, rect);
        }
        if layout.head.height() > 0.0 {
            let head = layout.head.shrink2(vec2(3.0, 0.0));
            let note = &self.cell.note;
            row_text(ui, head, AT_RIGHT, note, SMALL_SIZE, self.palette.text);
        }
    }

    /// Shades the comparison band, and draws the grid and the lower edge of a pane.
    fn paint_ground(&self, painter: &Painter, rect: Rect, values: AxisRange) {
        let (min, max) = self.band;
        let ends = self.place_across(rect, min)..=self.place_across(rect, max);
        let band = Rect::from_x_y_ranges(ends, rect.y_range());
        painter.rect_filled(band, 0.0, self.palette.accent.gamma_multiply(BAND_SHADE));
        values.paint_levels(painter, rect, self.palette);
        self.frequencies
            .paint_verticals(painter, rect, self.palette);
        let line = Stroke::new(1.0, self.palette.line);
        painter.hline(rect.x_range(), rect.bottom(), line);
    }

    /// Draws the line at the frequency under the pointer.
    fn paint_cursor(&self, painter: &Painter, rect: Rect) {
        if let Some(omega) = self.cursor {
            let line = Stroke::new(0.8, self.palette.text.gamma_multiply(POINTED));
            painter.vline(self.place_across(rect, omega), rect.y_range(), line);
        }
    }

    /// Returns the horizontal screen position of a frequency \[rad/s\], limited to the pane.
    fn place_across(&self, rect: Rect, omega: f64) -> f32 {
        self.frequencies.across_in(rect, omega.log10())
    }

    /// Returns the frequency at a horizontal screen position \[rad/s\].
    fn omega_at(&self, x: f32) -> f64 {
        let inner = self.place.shrink(2.0);
        let share = f64::from((x - inner.left()) / inner.width());
        let range = self.frequencies.range;
        10f64.powf(range.min + share.clamp(0.0, 1.0) * range.width())
    }

    /// Handles the events in the cell:
    ///
    /// 1. pointing: the curve under the pointer, if any, is hovered and named in the status text;
    ///    the frequency there is reported;
    /// 2. click: with Alt on a curve, its model alone is shown; otherwise the cell's response comes
    ///    into focus;
    /// 3. secondary click: opens the menu on the curve, or closes it on empty ground.
    fn events(&self, response: &Response, view: &mut OverviewView) -> Vec<OverviewEvent> {
        // Step 1.
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
            if let Some(pointer) = pointer {
                events.push(OverviewEvent::PointedAt(self.omega_at(pointer.x)));
            }
        }
        // Step 2.
        if response.clicked() {
            let has_alt = response.ctx.input(|input| input.modifiers.alt);
            events.push(match &pointed {
                Some(curve) if has_alt => OverviewEvent::Isolated(curve.clone()),
                _ => OverviewEvent::PairClicked(self.cell.pair),
            });
        }
        // Step 3.
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
