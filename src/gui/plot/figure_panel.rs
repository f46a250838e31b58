//! A figure's panel: title, axes, marks, and the mark under the pointer.
//!
//! A figure has plots side by side; a plot has a title and one or more panels below one another; a
//! panel has two axes and marks (lines, bars, dots …). Its *whole ranges* fit its marks. The dots
//! have ids, which name the objects that they represent.
//!
//! `figure_view` places the panels. Three fields of [`FigureScene`] change what is drawn here:
//!
//! ```text
//! is_compact  little text: tick labels of the values only in the first column (has_values,
//!             frame_with_axes), closer together (vertical_axis); no axis label below
//!             (horizontal_axis), only its unit beside the last plot (title_ui)
//! is_stacked  the panels of a plot share the horizontal axis: drawn below the last panel only
//!             (horizontal_axis); wider value axes, so that the frames align (vertical_axis)
//! columns     not empty: the pointer selects named columns (x = 0, 1, …) instead of dots
//!             (pointed_mark)
//! ```

use egui::{Align2, Id, Rect, Response, Sense, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_plot::figure::axis::{FrequencyUnit, Scale};
use gdcm_plot::figure::figure::Along;
use gdcm_plot::figure::marks::MarkId;
use gdcm_plot::figure::{Panel, Range};

use super::figure_marks::{DrawnMarks, MarkScene, RING, has_bars};
use super::figure_scene::FigureScene;
use super::figure_zoom::{navigated_ranges, whole_ranges};
use super::nearest_dot::{PointedMark, nearest_dot};
use super::panel_axis::{LABELLED_HEIGHT, PanelAxis, TICKS_HEIGHT, TickSpacing, tick_font};
use super::panel_painter::{Gestures, PanelPainter};
use super::panel_text::caption_font;
use super::ticks::Ticks;
use super::viewed_range::{bounds_of, ranges_of};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE, medium};

/// Title height above the first panel \[pt\].
const TITLE_HEIGHT: f32 = 18.0;
/// Vertical axis width \[pt\].
pub(super) const VALUE_AXIS_WIDTH: f32 = 38.0;
/// Vertical axis width for stacked panels, wide enough for any label, so that the panels have the
/// same edges \[pt\].
const STACKED_AXIS_WIDTH: f32 = 52.0;
const RIGHT_MARGIN: f32 = 8.0;
/// Gap between panels \[pt\].
const PANEL_GAP: f32 = 4.0;
/// Minimum distance between ticks \[pt\].
const TICK_GAP: f64 = 26.0;
/// Minimum distance between ticks in a compact figure, which has as many tick labels as fit \[pt\].
const COMPACT_TICK_GAP: f64 = 17.0;

/// Returns the height above a plot's first panel: without a title, only the gap between panels.
pub(super) fn title_height(title: &str) -> f32 {
    if title.is_empty() {
        PANEL_GAP
    } else {
        TITLE_HEIGHT
    }
}

/// A panel's state between frames.
#[derive(Clone, Debug, Default)]
pub(super) struct PanelView {
    /// Visible ranges in axis coordinates, kept from frame to frame if the figure can be zoomed;
    /// `None`: the whole ranges, which fit the marks.
    pub(super) ranges: Option<[Range; 2]>,
    /// Transform as last drawn; on the screen, a logarithmic horizontal axis has logarithms as
    /// coordinates.
    pub(super) transform: Option<PlotTransform>,
    pub(super) marks: DrawnMarks,
}

impl PanelView {
    /// Adopts the horizontal range of another panel in the same plot; `panel` is the content of
    /// this one. If the other panel shows its whole ranges, so does this one, vertically too: a
    /// double click fits all panels of a plot.
    pub(super) fn adopt_horizontal_range(&mut self, panel: &Panel, other: &Self) {
        self.ranges = match (other.ranges, self.ranges) {
            (None, _) => None,
            (Some([x, _]), Some([_, y])) => Some([x, y]),
            (Some([x, _]), None) => Some([x, panel.shown(Along::Y)]),
        };
    }
}

/// A figure's panel at its position on the screen, identified by the index of its plot and by its
/// index in the plot. (A plot has a title and one or more panels below one another.)
pub(super) struct PlacedPanel<'a> {
    pub(super) scene: &'a FigureScene<'a>,
    /// Index of the plot in the figure.
    pub(super) plot: usize,
    /// Index of the panel in the plot, from top to bottom.
    pub(super) number: usize,
    pub(super) id: Id,
    pub(super) rect: Rect,
    /// Mark highlighted in this figure or by another view.
    pub(super) emphasized: Option<&'a MarkId>,
    pub(super) palette: &'a Palette,
}

/// Panel as drawn, with the mark under the pointer.
pub(super) struct PlacedResponse {
    pub(super) response: Response,
    pub(super) pointed: Option<PointedMark>,
}

impl PlacedPanel<'_> {
    /// Draws the panel, and zooms and pans it:
    ///
    /// 1. place: the frame with its axes in `rect`, and the visible ranges: those kept, or else the
    ///    whole ranges;
    /// 2. axes: horizontal, then vertical in the remaining height;
    /// 3. paint the frame with its grid, and above the first panel the title;
    /// 4. point: find the dot or column under the pointer, as the frame is now;
    /// 5. paint the marks, emphasized where the pointer is;
    /// 6. zoom and pan: the ranges for the next frame; a double click beside all marks shows the
    ///    whole ranges again.
    pub(super) fn ui(&self, ui: &mut Ui, view: &mut PanelView) -> PlacedResponse {
        // Step 1.
        let panel = self.panel();
        let has_values = self.has_values(ui);
        let rect = self.frame_with_axes(has_values);
        let bounds = bounds_of(view.ranges.unwrap_or_else(|| whole_ranges(panel)));
        // Step 2: `across` is the horizontal, `values` the vertical axis.
        let across = self.horizontal_axis(ui);
        let frame_height = rect.height() - across.thickness;
        let values = self.vertical_axis(ui, frame_height, has_values);
        // Step 3.
        let painter = PanelPainter {
            id: self.id,
            rect,
            name: &self.description(),
            across,
            values,
            gestures: if self.scene.zooms {
                Gestures::PanAndZoom
            } else {
                Gestures::Clicks
            },
            is_transparent: false,
            palette: self.palette,
        };
        let shown = painter.show(ui, move |plot| plot.set_plot_bounds(bounds));
        let response = shown.response;
        let transform = shown.transform;
        view.transform = Some(transform);
        if self.number == 0 {
            self.title_ui(ui, *transform.frame());
        }
        // Step 4.
        let pointed = self.pointed_mark(&response, &transform);
        // Step 5.
        let marks = MarkScene {
            panel,
            transform,
            columns: self.scene.columns,
            selected: self.scene.selected.as_ref(),
            emphasized: self.emphasized,
            pointed_at: pointed.as_ref().map(|pointed| pointed.at),
            bars_opacity: self.bars_opacity(ui),
            palette: self.palette,
        };
        marks.paint(ui, &mut view.marks);
        self.describe_dots(ui, &transform);
        // Step 6.
        if self.scene.zooms {
            // `view.ranges` stays `None` until a gesture changes the ranges, so that the whole
            // ranges follow changed marks.
            if let Some(ranges) = navigated_ranges(panel, &response, &transform)
                && ranges != ranges_of(&bounds)
            {
                view.ranges = Some(ranges);
            }
            if response.double_clicked() && pointed.is_none() {
                view.ranges = None;
                response.ctx.request_repaint();
            }
        }
        PlacedResponse { response, pointed }
    }

    /// Returns the error bars' opacity: they fade in when they have been computed, from 0 to 1.
    fn bars_opacity(&self, ui: &Ui) -> f32 {
        /// Time in which the bars fade in \[s\].
        const FADE_S: f32 = 0.25;
        let animation = self.id.with("bars");
        if has_bars(self.panel()) {
            ui.ctx().animate_bool_with_time(animation, true, FADE_S)
        } else {
            // Resets the animation, so that the next bars start from 0.
            ui.ctx().animate_bool_with_time(animation, false, 0.0);
            // Unused, because there are no bars.
            1.0
        }
    }

    fn panel(&self) -> &Panel {
        &self.scene.figure.plots[self.plot].panels[self.number]
    }

    /// Returns the accessible name.
    fn description(&self) -> String {
        let plot = self
            .scene
            .words
            .plot_name(self.scene.first_plot + self.plot);
        if self.number == 0 {
            plot
        } else {
            format!("{plot}: {}", self.panel().y.label)
        }
    }

    /// Returns whether the vertical axis has tick labels: in a compact figure, only in the first
    /// column, whose plots begin at the left end of `ui`.
    fn has_values(&self, ui: &Ui) -> bool {
        // The panel knows its place, but not the number of columns of plots.
        let is_first_column = self.rect.left() - ui.max_rect().left() < 0.5 * self.rect.width();
        !self.scene.is_compact || is_first_column
    }

    /// Returns the area that the frame and its axes fill.
    ///
    /// In the first column of a compact figure it extends to the left beyond `rect`, into the room
    /// that `figure_view` keeps there, so that the frames of all columns have the same width.
    fn frame_with_axes(&self, has_values: bool) -> Rect {
        let above = if self.number == 0 {
            title_height(&self.scene.figure.plots[self.plot].title)
        } else {
            PANEL_GAP
        };
        let mut rect = Rect::from_min_max(
            self.rect.min + vec2(0.0, above),
            self.rect.max - vec2(RIGHT_MARGIN, 0.0),
        );
        if self.scene.is_compact && has_values {
            rect.min.x -= VALUE_AXIS_WIDTH;
        }
        rect
    }

    /// Returns the horizontal axis: below the last panel, unless the figure is compact, with tick
    /// labels and label; below the other panels of a stacked plot not drawn; in every other case
    /// with tick labels only.
    fn horizontal_axis(&self, ui: &Ui) -> PanelAxis {
        let panel = self.panel();
        let ticks = match panel.x.scale {
            Scale::Logarithmic => Ticks::Frequency(FrequencyUnit::RadPerSecond),
            Scale::Linear | Scale::Degrees => Ticks::Decimal(TICK_GAP),
        };
        let mut axis = PanelAxis::new(ticks, TICKS_HEIGHT);
        axis.spacing = spacing_across(ui, panel, self.palette);
        let is_last = self.number + 1 == self.scene.figure.plots[self.plot].panels.len();
        if is_last && !self.scene.is_compact {
            axis.thickness = LABELLED_HEIGHT;
            axis.label.clone_from(&panel.x.label);
        } else if !is_last && self.scene.is_stacked {
            axis.is_drawn = false;
            axis.thickness = 0.0;
        }
        axis
    }

    /// Returns the vertical axis. Its label is reduced to the unit if it is longer than
    /// `frame_height` \[pt\], and omitted if `figure_view` draws a common label for all plots.
    fn vertical_axis(&self, ui: &Ui, frame_height: f32, has_values: bool) -> PanelAxis {
        let gap = if self.scene.is_compact {
            COMPACT_TICK_GAP
        } else {
            TICK_GAP
        };
        let width = if self.scene.is_stacked {
            STACKED_AXIS_WIDTH
        } else {
            VALUE_AXIS_WIDTH
        };
        let mut axis = PanelAxis::new(Ticks::Decimal(gap), width);
        axis.is_drawn = has_values;
        if !self.scene.figure.shared.y {
            axis.label = label_within(ui, &self.panel().y.label, frame_height, self.palette);
        }
        axis
    }

    /// Returns the mark under the pointer: without columns the nearest dot, otherwise the column
    /// around the nearest whole number; `None` beyond the first and the last column.
    fn pointed_mark(&self, response: &Response, transform: &PlotTransform) -> Option<PointedMark> {
        // A click by touch comes without a hover position.
        let clicked_at = if response.clicked() {
            response.interact_pointer_pos()
        } else {
            None
        };
        let pointer = response.hover_pos().or(clicked_at)?;
        if self.scene.columns.is_empty() {
            return nearest_dot(self.panel(), transform, pointer);
        }
        let column = transform.value_from_position(pointer).x.round();
        if column < 0.0 {
            return None;
        }
        let id = self.scene.columns.get(column as usize)?.clone();
        Some(PointedMark {
            id,
            at: [column, 0.0],
        })
    }

    /// Describes the dots for screen readers. Pointing and clicking are handled by the plot itself,
    /// which picks the nearest dot.
    fn describe_dots(&self, ui: &Ui, transform: &PlotTransform) {
        let plot = self.scene.first_plot + self.plot;
        for dot in self.panel().dots() {
            let Some(id) = &dot.id else { continue };
            let Some(words) = self.scene.words.dot_name(plot, id, [dot.x, dot.y]) else {
                continue;
            };
            let at = transform.position_from_point(&PlotPoint::new(dot.x, dot.y));
            let place = Rect::from_center_size(at, Vec2::splat(RING));
            let response = ui.interact(place, self.id.with(("dot", &dot.id)), Sense::hover());
            response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &words));
        }
    }

    /// Draws the name above a plot, with a bar in the accent colour if the plot is in focus; in a
    /// compact figure, also the unit of the horizontal axis beside the last plot.
    fn title_ui(&self, ui: &Ui, frame: Rect) {
        let palette = self.palette;
        let is_accented = self.scene.accented == Some(self.plot);
        let font = if is_accented {
            medium(SMALL_SIZE)
        } else {
            caption_font()
        };
        let color = if self.scene.is_compact && !is_accented {
            palette.dim_text
        } else {
            palette.text
        };
        let title = &self.scene.figure.plots[self.plot].title;
        let place = pos2(frame.center().x, frame.top() - 0.5 * TITLE_HEIGHT);
        ui.painter()
            .text(place, Align2::CENTER_CENTER, title, font, color);
        if is_accented {
            let bar = Stroke::new(2.0, palette.accent);
            ui.painter().hline(frame.x_range(), frame.top() - 1.0, bar);
        }
        if self.scene.is_compact && self.plot + 1 == self.scene.figure.plots.len() {
            let unit = unit_in_brackets(&self.panel().x.label).unwrap_or_default();
            let unit = unit.trim_start_matches('[').trim_end_matches(']');
            let at = pos2(frame.right() + 6.0, frame.bottom() + 0.5 * TICKS_HEIGHT);
            let font = caption_font();
            ui.painter()
                .text(at, Align2::LEFT_CENTER, unit, font, palette.dim_text);
        }
    }
}

/// Returns how the ticks are spaced along a horizontal axis: names by the widest name, numbers by
/// the width of a digit.
fn spacing_across(ui: &Ui, panel: &Panel, palette: &Palette) -> TickSpacing {
    let named = panel.x.names.as_deref().unwrap_or_default();
    if named.is_empty() {
        return TickSpacing::WidestNumber {
            digit_pt: f64::from(tick_width(ui, "0", palette)),
        };
    }
    let mut names = Vec::with_capacity(named.len());
    let mut widest = 0.0f32;
    for (_, name) in named {
        widest = widest.max(tick_width(ui, name, palette));
        names.push(name.clone());
    }
    TickSpacing::Names {
        names,
        widest_pt: f64::from(widest),
    }
}

/// Returns the unit at the end of a label, with its brackets: "[kt]" in "Airspeed [kt]".
fn unit_in_brackets(label: &str) -> Option<&str> {
    let start = label.rfind('[')?;
    Some(&label[start..])
}

/// Returns a label, or only its unit if the label is longer than the axis.
fn label_within(ui: &Ui, label: &str, axis_length: f32, palette: &Palette) -> String {
    if tick_width(ui, label, palette) > axis_length
        && let Some(unit) = unit_in_brackets(label)
    {
        return unit.to_owned();
    }
    label.to_owned()
}

/// Returns the width of a text beside an axis \[pt\].
fn tick_width(ui: &Ui, text: &str, palette: &Palette) -> f32 {
    let galley = ui
        .painter()
        .layout_no_wrap(text.to_owned(), tick_font(), palette.text);
    galley.size().x
}
