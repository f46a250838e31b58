//! Figure on the screen: its plots side by side, the mark under the pointer, and clicks.
//!
//! A figure has plots; a plot has a title and one or more panels below one another; a panel, drawn
//! by `figure_panel`, has two axes and marks. The whole ranges of a panel fit its marks.

use std::collections::BTreeMap;

use egui::{CursorIcon, FontId, Pos2, Rect, Response, Ui, UiBuilder, Vec2, pos2, vec2};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_plot::figure::axis::Scale;
use gdcm_plot::figure::figure::Along;
use gdcm_plot::figure::marks::MarkId;
use gdcm_plot::figure::{Figure, Range};

use super::derivation_menu::QuestionMenu;
use super::figure_panel::{PanelView, PlacedPanel, PlacedResponse, VALUE_AXIS_WIDTH, title_height};
use super::figure_scene::{FigureEvent, FigureScene};
use super::nearest_dot::PointedMark;
use super::panel_axis::LABELLED_HEIGHT;
use super::panel_painter::use_frame_colors;
use super::panel_text::message_ui;
use super::steady_range::{AxisUpdate, steady_range};
use super::tiles::{TiledArea, Tiles, tiles_ui};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Width of the strip at the left for the common vertical label \[pt\].
const LABEL_STRIP: f32 = 16.0;
/// Margin for the unit beside the last plot in a compact figure \[pt\].
const UNIT_MARGIN: f32 = 14.0;

/// A figure's state between frames.
#[derive(Clone, Debug, Default)]
pub struct FigureView {
    hovered: Option<MarkId>,
    /// Subject of the figure; if this changes, all plots are fitted.
    subject: String,
    plots: Vec<PlotView>,
    /// Ranges shown last on the linear axes that are fitted to the marks; see [`Self::keep_axis_ranges`].
    shown_ranges: BTreeMap<AxisKey, Range>,
    question_menu: QuestionMenu,
}

/// Identity of an axis whose range is kept between frames.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct AxisKey {
    /// Plot title; empty for an axis that all plots share.
    plot: String,
    /// Index of the panel in the plot, 0 for a shared axis.
    panel: usize,
    is_vertical: bool,
}

#[derive(Clone, Debug, Default)]
struct PlotView {
    first: PanelView,
    /// Panels below the first, from top to bottom.
    lower: Vec<PanelView>,
}

impl FigureView {
    /// Requests that all plots be fitted in the next frame.
    pub fn request_fit(&mut self) {
        self.shown_ranges.clear();
        for plot in &mut self.plots {
            plot.first.ranges = None;
        }
    }

    /// Replaces a figure's fitted ranges by those shown before, as long as the marks fit into them
    /// (`steady_range`), so that the axes do not move with every update.
    ///
    /// Each panel has its own pair of ranges; axes that all plots share have the same. Logarithmic
    /// axes and axes with names keep the figure's ranges.
    pub fn keep_axis_ranges(&mut self, figure: &mut Figure, update: AxisUpdate) {
        let shared = figure.shared;
        let mut shown_ranges = BTreeMap::new();
        for plot in &mut figure.plots {
            for (number, panel) in plot.panels.iter_mut().enumerate() {
                for along in [Along::X, Along::Y] {
                    let is_vertical = along == Along::Y;
                    let is_shared = if is_vertical { shared.y } else { shared.x };
                    let fitted = panel.shown(along);
                    let axis = if is_vertical {
                        &mut panel.y
                    } else {
                        &mut panel.x
                    };
                    if axis.scale == Scale::Logarithmic || axis.names.is_some() {
                        continue;
                    }
                    let mut key = AxisKey {
                        plot: String::new(),
                        panel: 0,
                        is_vertical,
                    };
                    if !is_shared {
                        key.plot.clone_from(&plot.title);
                        key.panel = number;
                    }
                    let range = match self.shown_ranges.get(&key) {
                        Some(shown) => steady_range(*shown, fitted, update),
                        None => fitted,
                    };
                    axis.range = Some(range);
                    shown_ranges.insert(key, range);
                }
            }
        }
        // Without plots, results are being computed for the first time or anew: the ranges stay.
        if !figure.plots.is_empty() {
            self.shown_ranges = shown_ranges;
        }
    }

    /// Fits all plots if they show another subject than in the last call.
    pub fn fit_if_subject_changed(&mut self, subject: &str) {
        if self.subject != subject {
            subject.clone_into(&mut self.subject);
            self.request_fit();
        }
    }

    /// Returns the ranges kept for a plot's first panel; `None` if it shows the whole ranges, as
    /// before it is drawn and after a fit.
    pub fn ranges(&self, plot: usize) -> Option<[Range; 2]> {
        self.plots.get(plot)?.first.ranges
    }

    /// Returns a plot's transform as last drawn.
    pub fn transform(&self, plot: usize) -> Option<&PlotTransform> {
        self.plots.get(plot)?.first.transform.as_ref()
    }

    /// Converts axis coordinates in a plot to a screen position.
    pub fn position(&self, plot: usize, [x, y]: [f64; 2]) -> Option<Pos2> {
        let transform = self.transform(plot)?;
        Some(transform.position_from_point(&PlotPoint::new(x, y)))
    }

    /// Returns where a dot was last drawn on the screen.
    pub fn screen_position(&self, plot: usize, id: &MarkId) -> Option<Pos2> {
        let panel = self.plots.get(plot)?.first.marks.panel()?;
        let dot = panel.dots().find(|dot| dot.id.as_ref() == Some(id))?;
        self.position(plot, [dot.x, dot.y])
    }

    /// Adds the events for the mark under the pointer in a plot to `events`: first a derivation
    /// chosen in the open menu, which may be about an earlier mark, then pointing, status text and
    /// click.
    fn report(
        &mut self,
        scene: &FigureScene<'_>,
        plot: usize,
        shown: PlacedResponse,
        events: &mut Vec<FigureEvent>,
    ) {
        let PlacedResponse { response, pointed } = shown;
        let plot = scene.first_plot + plot;
        let questions = match &pointed {
            Some(mark) => scene.words.questions(plot, &mark.id),
            None => Vec::new(),
        };
        let chosen = self.question_menu.ui(&response, &questions);
        events.extend(chosen.map(FigureEvent::ExplanationRequested));
        let Some(mark) = pointed else { return };
        self.hovered = Some(mark.id.clone());
        events.push(FigureEvent::Pointed(mark.id.clone()));
        let text = scene.words.status_text(plot, &mark.id, mark.at);
        events.extend(text.map(FigureEvent::StatusText));
        events.extend(click_event(&response, plot, mark));
        response.on_hover_cursor(CursorIcon::PointingHand);
    }
}

fn click_event(response: &Response, plot: usize, mark: PointedMark) -> Option<FigureEvent> {
    if !response.clicked() {
        return None;
    }
    let modifiers = response.ctx.input(|input| input.modifiers);
    Some(FigureEvent::Clicked(plot, mark.id, modifiers))
}

/// Draws a figure into the remaining space in `ui`.
pub fn figure_ui(
    ui: &mut Ui,
    scene: &FigureScene<'_>,
    view: &mut FigureView,
    palette: &Palette,
) -> Vec<FigureEvent> {
    let rect = ui.available_rect_before_wrap();
    let events = figure_within_ui(ui, rect, scene, view, palette);
    ui.advance_cursor_after_rect(rect);
    events
}

/// Returns how many rows a figure's plots form, with no plot smaller than `least`.
pub fn rows(figure: &Figure, size: Vec2, least: Vec2) -> usize {
    match figure.plots.len() {
        0 => 0,
        count => Tiles::arrange(count, size - vec2(LABEL_STRIP, 0.0), least).rows,
    }
}

/// Draws a figure into `rect`:
///
/// 1. without plots, only the scene's message;
/// 2. keep room at the left: in a compact figure for the value axes of the first column and at the
///    right for the unit, otherwise for the vertical label that all plots share, if any;
/// 3. emphasize the mark that was under the pointer in the last frame, or else the mark that
///    another view highlights;
/// 4. draw the plots as tiles, each with its panels, and collect their events;
/// 5. repaint if another mark is under the pointer now.
pub fn figure_within_ui(
    ui: &mut Ui,
    rect: Rect,
    scene: &FigureScene<'_>,
    view: &mut FigureView,
    palette: &Palette,
) -> Vec<FigureEvent> {
    let count = scene.figure.plots.len();
    let mut events = Vec::new();
    // Step 1.
    if count == 0 {
        message_ui(ui, rect, scene.message, palette);
        return events;
    }
    view.plots.resize_with(count, PlotView::default);
    ui.scope_builder(UiBuilder::new().id_salt(scene.name).max_rect(rect), |ui| {
        use_frame_colors(ui, palette);
        // Step 2.
        let mut inner = rect;
        if scene.is_compact {
            inner.min.x += VALUE_AXIS_WIDTH;
            inner.max.x -= UNIT_MARGIN;
        } else if let Some(label) = common_label(scene.figure) {
            inner.min.x += LABEL_STRIP;
            upright_label_ui(ui, rect, label, palette);
        }
        // Step 3.
        let hovered = view.hovered.take();
        let painter = FigurePainter {
            scene,
            emphasized: hovered.as_ref().or(scene.highlighted.as_ref()),
            palette,
        };
        // Step 4.
        let area = TiledArea {
            name: "panels",
            rect: inner,
            count,
            least: scene.least_plot_size,
        };
        tiles_ui(ui, &area, |ui, plot, rect| {
            let shown = painter.plot_ui(ui, rect, plot, &mut view.plots[plot]);
            view.report(scene, plot, shown, &mut events);
        });
        // Step 5.
        if view.hovered != hovered {
            ui.ctx().request_repaint();
        }
    });
    events
}

/// Returns the vertical label if all plots share the vertical axis.
fn common_label(figure: &Figure) -> Option<&str> {
    if !figure.shared.y {
        return None;
    }
    let panel = figure.plots.first()?.panels.first()?;
    Some(&panel.y.label)
}

/// Paints the common vertical label, running upwards at the left edge.
fn upright_label_ui(ui: &Ui, rect: Rect, label: &str, palette: &Palette) {
    let font = FontId::proportional(SMALL_SIZE);
    let galley = ui
        .painter()
        .layout_no_wrap(label.to_owned(), font, palette.dim_text);
    let place = pos2(rect.left() + 1.0, rect.center().y + 0.5 * galley.size().x);
    let text = egui::epaint::TextShape::new(place, galley, palette.dim_text);
    ui.painter()
        .add(text.with_angle(-std::f32::consts::FRAC_PI_2));
}

struct FigurePainter<'a> {
    scene: &'a FigureScene<'a>,
    /// Mark highlighted in this figure or by another view.
    emphasized: Option<&'a MarkId>,
    palette: &'a Palette,
}

impl FigurePainter<'_> {
    /// Divides a plot's height among its panels, in proportion to their weights. In a stacked plot
    /// the common axis below the last panel is taken out first and added to that panel, so that
    /// the frames have the proportions; in a low plot it counts at most half the height.
    fn heights(&self, plot: usize, plot_height: f32) -> Vec<f32> {
        let panels = &self.scene.figure.plots[plot].panels;
        let total: f64 = panels.iter().map(|panel| panel.weight).sum();
        let axis_height = if self.scene.is_stacked && panels.len() > 1 {
            LABELLED_HEIGHT.min(0.5 * plot_height)
        } else {
            0.0
        };
        let mut heights: Vec<f32> = panels
            .iter()
            .map(|panel| (plot_height - axis_height) * (panel.weight / total) as f32)
            .collect();
        if let Some(last) = heights.last_mut() {
            *last += axis_height;
        }
        heights
    }

    /// Draws a plot's panels below one another into `rect`; returns the first panel's response,
    /// since only its marks are interactive.
    ///
    /// All panels have the same horizontal range: each lower panel adopts the first panel's range
    /// before it is drawn, and the first then adopts the lower panel's, which may have been zoomed.
    fn plot_ui(&self, ui: &mut Ui, rect: Rect, plot: usize, view: &mut PlotView) -> PlacedResponse {
        let panels = &self.scene.figure.plots[plot].panels;
        let title = title_height(&self.scene.figure.plots[plot].title);
        let heights = self.heights(plot, rect.height() - title);
        let id = ui.make_persistent_id((self.scene.name, plot));
        let mut placed = PlacedPanel {
            scene: self.scene,
            plot,
            number: 0,
            id,
            rect: rect.with_max_y(rect.top() + title + heights[0]),
            emphasized: self.emphasized,
            palette: self.palette,
        };
        let shown = placed.ui(ui, &mut view.first);
        let lower = &mut view.lower;
        lower.resize_with(panels.len() - 1, PanelView::default);
        for (below, number) in lower.iter_mut().zip(1..) {
            let top = placed.rect.bottom();
            placed.number = number;
            placed.id = id.with(number);
            placed.rect = Rect::from_x_y_ranges(rect.x_range(), top..=top + heights[number]);
            below.adopt_horizontal_range(&panels[number], &view.first);
            placed.ui(ui, below);
            view.first.adopt_horizontal_range(&panels[0], below);
        }
        shown
    }
}
