//! Figure on the screen: its plots side by side, the meaning of the pointer in them, and the effect
//! of a click.

use std::ops::RangeInclusive;

use egui::{
    Align2, CursorIcon, FontId, Id, Modifiers, Pos2, Rect, Response, Sense, Stroke, Ui, UiBuilder,
    Vec2, WidgetInfo, pos2, vec2,
};
use egui_plot::{
    Axis as Side, GridInput, GridMark, Plot as Frame, PlotBounds, PlotPoint, PlotTransform,
};

use gdcm_plot::figure::axis::{FrequencyUnit, Scale};
use gdcm_plot::figure::drawing::{Area, Shape};
use gdcm_plot::figure::figure::{Along, Dots, Plot};
use gdcm_plot::figure::paint::dot_shapes;
use gdcm_plot::figure::{Figure, Mark, MarkId, Panel, Range};
use gdcm_words::ExplainTarget;

use super::axes::{
    LABELLED_HEIGHT, TICKS_HEIGHT, Ticks, axis_hints, caption_font, labelled_mark, message_ui,
    quiet_plot, tick_font, use_frame_colors,
};
use super::canvas::{Canvas, LETTERS_PT, area};
use super::curve_menu::{NamedFigure, Questions};
use super::navigation::{nearest_dot, turned};
use super::tiles::{Tiles, tiles_ui};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE, medium};

const TITLE_HEIGHT: f32 = 18.0;
const RIGHT_MARGIN: f32 = 8.0;
/// Gap between the panels of a plot \[pt\].
const PANEL_GAP: f32 = 4.0;
/// Width of the strip at the left with the common label of the vertical axes \[pt\].
const LABEL_STRIP: f32 = 16.0;
/// Width of a vertical axis \[pt\].
const VALUE_AXIS_WIDTH: f32 = 38.0;
/// Width of the unit beside the last plot of a compact figure \[pt\].
const UNIT_MARGIN: f32 = 14.0;
/// Least distance between the ticks of an axis \[pt\].
const TICK_GAP: f64 = 26.0;
/// The same in a low plot \[pt\].
const COMPACT_TICK_GAP: f64 = 17.0;
/// Radius of the ring around a focused or highlighted dot \[pt\].
const RING: f32 = 8.0;
/// Magnification of a highlighted dot.
const EMPHASIZED: f64 = 1.3;
/// Greatest visible width, relative to the width of the whole panel.
const FARTHEST: f64 = 10.0;
/// Least visible width of an axis.
const LEAST_WIDTH: f64 = 1e-4;

/// Descriptions of the plots of a figure.
pub trait FigureWords {
    /// Describes a plot for screen readers.
    fn plot(&self, plot: usize) -> String;

    /// Describes a dot at a place of the axes for screen readers; `None` if dots are not described
    /// individually.
    fn dot(&self, _plot: usize, _id: &MarkId, _at: [f64; 2]) -> Option<String> {
        None
    }

    /// Returns the status line for a mark under the pointer; `None` for no text.
    fn pointed(&self, _plot: usize, _id: &MarkId, _at: [f64; 2]) -> Option<String> {
        None
    }

    /// Returns the values with a derivation at a mark.
    fn questions(&self, _plot: usize, _id: &MarkId) -> Vec<NamedFigure> {
        Vec::new()
    }
}

impl FigureWords for Figure {
    fn plot(&self, plot: usize) -> String {
        self.plots[plot].title.clone()
    }
}

/// Figure with its interaction on the screen. The panels of a plot are stacked; interactive marks
/// are in the first panel.
pub struct FigureScene<'a> {
    /// Distinguishes the widgets from those of other figures.
    pub name: &'static str,
    pub figure: &'a Figure,
    /// Mark in focus.
    pub selected: Option<MarkId>,
    /// Mark highlighted by another view.
    pub highlighted: Option<MarkId>,
    /// Marks at the names of the horizontal axes, if the columns are interactive instead of the
    /// dots.
    pub columns: &'a [MarkId],
    /// Whether the plots can be zoomed and panned.
    pub zooms: bool,
    /// Least size of a plot \[pt\].
    pub least: Vec2,
    /// Message shown if there is nothing to draw.
    pub message: &'a str,
    /// Whether the label of the vertical axis appears once, at the left of each row, and the unit
    /// of the horizontal axis at its end.
    pub is_compact: bool,
    /// Plot in focus, which has a bar in the accent colour.
    pub accented: Option<usize>,
    /// Descriptions of the plots, and the number of this figure's first plot in them.
    pub words: (&'a dyn FigureWords, usize),
}

impl<'a> FigureScene<'a> {
    /// Creates a figure without zoom and without a mark in focus.
    pub fn new(
        name: &'static str,
        figure: &'a Figure,
        least: Vec2,
        message: &'a str,
        words: &'a dyn FigureWords,
    ) -> Self {
        let selected = None;
        let highlighted = None;
        let columns = &[][..];
        let accented = None;
        let zooms = false;
        let is_compact = false;
        let words = (words, 0);
        Self {
            name,
            figure,
            selected,
            highlighted,
            columns,
            zooms,
            least,
            message,
            is_compact,
            accented,
            words,
        }
    }
}

/// Event in a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum FigureEvent {
    /// The mark under the pointer.
    Pointed(MarkId),
    /// Its description.
    Told(String),
    /// A mark was clicked in this plot, with these modifier keys.
    Clicked(usize, MarkId, Modifiers),
    /// The derivation of a value was requested.
    Asked(ExplainTarget),
}

/// State of a figure between frames.
#[derive(Clone, Debug, Default)]
pub struct FigureView {
    hovered: Option<MarkId>,
    /// Place on the axes of the dot under the pointer.
    pointed_at: Option<[f64; 2]>,
    /// Subject of the plots, if known.
    subject: String,
    plots: Vec<PlotView>,
    questions: Questions,
}

/// State of a plot.
#[derive(Clone, Debug, Default)]
struct PlotView {
    /// Visible ranges, if zoomed or panned.
    ranges: Option<[Range; 2]>,
    transform: Option<PlotTransform>,
    /// Panel, area and ranges of the shapes: placing labels takes longer than drawing them.
    drawn_for: Option<(Panel, Area, [Range; 2])>,
    shapes: Vec<Shape>,
    /// States of the other panels, from top to bottom.
    lower: Vec<PlotView>,
}

impl FigureView {
    /// Fits all plots at the next frame.
    pub fn request_fit(&mut self) {
        self.plots.iter_mut().for_each(|plot| plot.ranges = None);
    }

    /// Sets the subject of the plots: a new subject fits all of them.
    pub fn is_of(&mut self, subject: &str) {
        if self.subject != subject {
            subject.clone_into(&mut self.subject);
            self.request_fit();
        }
    }

    /// Returns the place, on the axes of its plot, of the dot under the pointer.
    pub fn pointed_at(&self) -> Option<[f64; 2]> {
        self.pointed_at
    }

    /// Returns the visible ranges of a plot as last drawn.
    pub fn ranges(&self, plot: usize) -> Option<[Range; 2]> {
        self.plots.get(plot)?.ranges
    }

    /// Returns the last transform of a plot.
    pub fn transform(&self, plot: usize) -> Option<&PlotTransform> {
        self.plots.get(plot)?.transform.as_ref()
    }

    /// Returns the screen position of a place on the axes of a plot.
    pub fn position(&self, plot: usize, [x, y]: [f64; 2]) -> Option<Pos2> {
        Some(
            self.transform(plot)?
                .position_from_point(&PlotPoint::new(x, y)),
        )
    }

    /// Returns the last screen position of a mark's dot in a plot.
    pub fn screen_position(&self, plot: usize, id: &MarkId) -> Option<Pos2> {
        let (panel, ..) = self.plots.get(plot)?.drawn_for.as_ref()?;
        let dot = panel.dots().find(|dot| dot.id.as_ref() == Some(id))?;
        self.position(plot, [dot.x, dot.y])
    }
}

/// Draws a figure into the remaining space of `ui`.
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

/// Returns the number of rows of a figure's plots in an area of `size`, with no plot smaller than
/// `least`.
pub fn rows(figure: &Figure, size: Vec2, least: Vec2) -> usize {
    match figure.plots.len() {
        0 => 0,
        count => Tiles::arrange(count, size - vec2(LABEL_STRIP, 0.0), least).rows,
    }
}

/// Draws a figure into `rect`.
pub fn figure_within_ui(
    ui: &mut Ui,
    rect: Rect,
    scene: &FigureScene<'_>,
    view: &mut FigureView,
    palette: &Palette,
) -> Vec<FigureEvent> {
    let plots = &scene.figure.plots;
    let mut events = Vec::new();
    if plots.is_empty() {
        message_ui(ui, rect, scene.message, palette);
        return events;
    }
    view.plots.resize_with(plots.len(), PlotView::default);
    ui.scope_builder(UiBuilder::new().id_salt(scene.name).max_rect(rect), |ui| {
        use_frame_colors(ui, palette);
        let mut inner = rect;
        if scene.is_compact {
            inner.min.x += VALUE_AXIS_WIDTH;
            inner.max.x -= UNIT_MARGIN;
        } else if let Some(label) = common_label(scene.figure) {
            inner.min.x += LABEL_STRIP;
            upright_label_ui(ui, rect, label, palette);
        }
        let hovered = view.hovered.take();
        view.pointed_at = None;
        let emphasized = hovered.as_ref().or(scene.highlighted.as_ref());
        tiles_ui(
            ui,
            "panels",
            inner,
            plots.len(),
            scene.least,
            |ui, index, rect| {
                let id = ui.make_persistent_id((scene.name, index));
                let kept = (&mut view.plots[index], emphasized);
                let (response, pointed) = panels_ui(ui, (id, rect), scene, index, kept, palette);
                let words = scene.words.0;
                let index = scene.words.1 + index;
                let questions = pointed
                    .as_ref()
                    .map(|(id, _)| words.questions(index, id))
                    .unwrap_or_default();
                events.extend(
                    view.questions
                        .ui(&response, &questions)
                        .map(FigureEvent::Asked),
                );
                let Some((id, at)) = pointed else { return };
                view.hovered = Some(id.clone());
                view.pointed_at = Some(at);
                events.push(FigureEvent::Pointed(id.clone()));
                events.extend(words.pointed(index, &id, at).map(FigureEvent::Told));
                if response.clicked() {
                    events.push(FigureEvent::Clicked(
                        index,
                        id,
                        ui.input(|input| input.modifiers),
                    ));
                }
                response.on_hover_cursor(CursorIcon::PointingHand);
            },
        );
        if view.hovered != hovered {
            ui.ctx().request_repaint();
        }
    });
    events
}

/// Returns the label of the vertical axes, if they share it.
fn common_label(figure: &Figure) -> Option<&str> {
    let panel = figure.plots.first()?.panels.first()?;
    Some(panel.y.label.as_str()).filter(|_| figure.shared.y)
}

/// Paints the common label of the vertical axes, upright at the left edge.
fn upright_label_ui(ui: &Ui, rect: Rect, label: &str, palette: &Palette) {
    let galley = ui.painter().layout_no_wrap(
        label.to_owned(),
        FontId::proportional(SMALL_SIZE),
        palette.dim_text,
    );
    let place = pos2(rect.left() + 1.0, rect.center().y + 0.5 * galley.size().x);
    let text = egui::epaint::TextShape::new(place, galley, palette.dim_text);
    ui.painter()
        .add(text.with_angle(-std::f32::consts::FRAC_PI_2));
}

/// Draws the stacked panels of a plot into `rect`, over the same part of their horizontal axis;
/// returns the mark under the pointer in the first panel, and its place on the axes.
fn panels_ui(
    ui: &mut Ui,
    (id, rect): (Id, Rect),
    scene: &FigureScene<'_>,
    index: usize,
    (kept, emphasized): (&mut PlotView, Option<&MarkId>),
    palette: &Palette,
) -> (Response, Option<(MarkId, [f64; 2])>) {
    let panels = &scene.figure.plots[index].panels;
    let all: f64 = panels.iter().map(|panel| panel.weight).sum();
    let height = |panel: &Panel| (rect.height() - TITLE_HEIGHT) * (panel.weight / all) as f32;
    let mut place = rect.with_max_y(rect.top() + TITLE_HEIGHT + height(&panels[0]));
    let shown = plot_ui(
        ui,
        (id, place),
        scene,
        (index, 0),
        (kept, emphasized),
        palette,
    );
    let mut lower = std::mem::take(&mut kept.lower);
    lower.resize_with(panels.len() - 1, PlotView::default);
    let of_y = |view: &PlotView, panel: &Panel| {
        view.ranges
            .map_or_else(|| panel.shown(Along::Y), |[_, y]| y)
    };
    for (number, (panel, below)) in (1..).zip(panels[1..].iter().zip(&mut lower)) {
        below.ranges = kept.ranges.map(|[x, _]| [x, of_y(below, panel)]);
        place = Rect::from_x_y_ranges(
            place.x_range(),
            place.bottom()..=place.bottom() + height(panel),
        );
        plot_ui(
            ui,
            (id.with(number), place),
            scene,
            (index, number),
            (below, emphasized),
            palette,
        );
        kept.ranges = below.ranges.map(|[x, _]| [x, of_y(kept, &panels[0])]);
    }
    kept.lower = lower;
    shown
}

/// Draws a panel of a plot into `rect`; returns the mark under the pointer, and its place on the
/// axes.
fn plot_ui(
    ui: &mut Ui,
    (id, rect): (Id, Rect),
    scene: &FigureScene<'_>,
    (index, panel_number): (usize, usize),
    (kept, emphasized): (&mut PlotView, Option<&MarkId>),
    palette: &Palette,
) -> (Response, Option<(MarkId, [f64; 2])>) {
    let Plot { title, panels } = &scene.figure.plots[index];
    let panel = &panels[panel_number];
    let words = scene.words.0;
    let number = scene.words.1 + index;
    let is_first = panel_number == 0;
    let above = if is_first { TITLE_HEIGHT } else { PANEL_GAP };
    let mut plot_rect = Rect::from_min_max(
        rect.min + vec2(0.0, above),
        rect.max - vec2(RIGHT_MARGIN, 0.0),
    );
    let has_values = !scene.is_compact || rect.left() - ui.max_rect().left() < 0.5 * rect.width();
    if scene.is_compact && has_values {
        plot_rect.min.x -= VALUE_AXIS_WIDTH;
    }
    let [x, y] = kept.ranges.unwrap_or_else(|| whole(panel));
    let shown = ui.scope_builder(UiBuilder::new().id_salt(id).max_rect(plot_rect), |ui| {
        let is_last = panel_number + 1 == panels.len();
        frame(
            ui,
            (id, plot_rect.size()),
            (panel, is_last),
            (scene, has_values),
            palette,
        )
        .show(ui, |plot| {
            plot.set_plot_bounds(PlotBounds::from_min_max([x.min, y.min], [x.max, y.max]));
        })
    });
    let response = shown.inner.response;
    let transform = shown.inner.transform;
    let told = if is_first {
        words.plot(number)
    } else {
        format!("{}: {}", words.plot(number), panel.y.label)
    };
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &told));
    if is_first {
        title_ui(
            ui,
            (title, panel),
            *transform.frame(),
            scene,
            index,
            palette,
        );
    }
    kept.transform = Some(transform);
    let pointer = response.hover_pos().or(response
        .interact_pointer_pos()
        .filter(|_| response.clicked()));
    let pointed = pointer.and_then(|pointer| match scene.columns {
        [] => nearest_dot(panel, &transform, pointer),
        columns => {
            let x = transform.value_from_position(pointer).x.round();
            Some((
                columns.get(x as usize).filter(|_| x >= 0.0)?.clone(),
                [x, 0.0],
            ))
        }
    });
    kept.paint(
        ui,
        scene,
        panel,
        (emphasized, pointed.as_ref().map(|(_, at)| *at)),
        palette,
    );
    for dot in panel.dots() {
        let told = dot
            .id
            .as_ref()
            .and_then(|id| words.dot(number, id, [dot.x, dot.y]));
        if let Some(told) = told {
            // For screen readers; the plot itself handles pointing and clicking, and takes the
            // nearest dot.
            let at = transform.position_from_point(&PlotPoint::new(dot.x, dot.y));
            let place = Rect::from_center_size(at, Vec2::splat(RING));
            let response = ui.interact(place, id.with(("dot", &dot.id)), Sense::hover());
            response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &told));
        }
    }
    if scene.zooms {
        let whole = whole(panel);
        kept.navigate(&response, pointed.is_some(), (whole, ends(panel, whole)));
    }
    (response, pointed)
}

/// Draws the name above a plot, with a bar in the accent colour if it is in focus; beside the last
/// plot, the unit of the horizontal axis.
fn title_ui(
    ui: &Ui,
    (title, panel): (&str, &Panel),
    frame: Rect,
    scene: &FigureScene<'_>,
    index: usize,
    palette: &Palette,
) {
    let is_accented = scene.accented == Some(index);
    let quiet = if scene.is_compact {
        palette.dim_text
    } else {
        palette.text
    };
    let (font, color) = if is_accented {
        (medium(SMALL_SIZE), palette.text)
    } else {
        (caption_font(), quiet)
    };
    let place = pos2(frame.center().x, frame.top() - 0.5 * TITLE_HEIGHT);
    ui.painter()
        .text(place, Align2::CENTER_CENTER, title, font, color);
    if is_accented {
        ui.painter().hline(
            frame.x_range(),
            frame.top() - 1.0,
            Stroke::new(2.0, palette.accent),
        );
    }
    if scene.is_compact && index + 1 == scene.figure.plots.len() {
        let unit = panel.x.label.split(['[', ']']).nth(1).unwrap_or_default();
        let at = pos2(frame.right() + 6.0, frame.bottom() + 0.5 * TICKS_HEIGHT);
        ui.painter().text(
            at,
            Align2::LEFT_CENTER,
            unit,
            caption_font(),
            palette.dim_text,
        );
    }
}

impl PlotView {
    /// Draws the marks, recomputed only if changed; the mark under the pointer is emphasized.
    fn paint(
        &mut self,
        ui: &Ui,
        scene: &FigureScene<'_>,
        panel: &Panel,
        (emphasized, pointed): (Option<&MarkId>, Option<[f64; 2]>),
        palette: &Palette,
    ) {
        let Some(transform) = self.transform else {
            return;
        };
        let frame = *transform.frame();
        let min = transform.bounds().min();
        let max = transform.bounds().max();
        let area = area(frame);
        let ranges = [0, 1].map(|axis| Range::new(min[axis], max[axis]));
        let ranges = [values(panel, ranges[0]), ranges[1]];
        let is_same = |(of, at, shown): &(Panel, Area, [Range; 2])| {
            (of, at, shown) == (panel, &area, &ranges)
        };
        if !self.drawn_for.as_ref().is_some_and(is_same) {
            (self.shapes, _) = panel.shapes(area, ranges, LETTERS_PT);
            self.drawn_for = Some((panel.clone(), area, ranges));
        }
        let painter = ui
            .painter()
            .with_clip_rect(frame.expand(RING).intersect(ui.clip_rect()));
        for (column, id) in scene.columns.iter().enumerate() {
            let is_pointed = pointed.is_some_and(|at| at[0] == column as f64);
            let strength = match (scene.selected.as_ref() == Some(id), is_pointed) {
                (true, _) => 0.6,
                (false, true) => 0.35,
                (false, false) => continue,
            };
            let ends =
                [-0.5, 0.5].map(|beside| transform.position_from_point_x(column as f64 + beside));
            let ground = Rect::from_x_y_ranges(ends[0]..=ends[1], frame.y_range());
            painter.rect_filled(ground, 0.0, palette.selected.gamma_multiply(strength));
        }
        let canvas = Canvas {
            painter: &painter,
            origin: frame.min,
            palette,
        };
        canvas.paint(&self.shapes);
        let ring = |at: [f64; 2], color| {
            let at = transform.position_from_point(&PlotPoint::new(at[0], at[1]));
            painter.circle_stroke(at, RING, Stroke::new(1.4, color));
        };
        for mark in &panel.marks {
            let Mark::Dots(Dots {
                shape,
                color,
                filled,
                size,
                dots,
                ..
            }) = mark
            else {
                continue;
            };
            for dot in dots.iter().filter(|dot| dot.id.is_some()) {
                let at = transform.position_from_point(&PlotPoint::new(dot.x, dot.y));
                if dot.id.as_ref() == emphasized {
                    canvas.paint(&dot_shapes(
                        canvas.from(at),
                        (*shape, EMPHASIZED * size.max(0.8)),
                        *color,
                        *filled,
                    ));
                }
                if dot.id == scene.selected {
                    ring([dot.x, dot.y], palette.text);
                }
            }
        }
        if let Some(at) = pointed.filter(|_| scene.columns.is_empty()) {
            ring(at, palette.dim_text);
        }
    }

    /// Handles navigation: the wheel zooms about the pointer, dragging pans, a double click beside
    /// the dots fits.
    fn navigate(
        &mut self,
        response: &Response,
        is_pointed: bool,
        (whole, ends): ([Range; 2], [Range; 2]),
    ) {
        let Some(transform) = self.transform else {
            return;
        };
        let min = transform.bounds().min();
        let max = transform.bounds().max();
        let mut shown = [0, 1].map(|axis| Range::new(min[axis], max[axis]));
        if let Some((turn, pointer)) = turned(&response.ctx, response) {
            let factor = f64::from(turn.along_one_axis());
            let fixed = transform.value_from_position(pointer);
            let zoomed = [
                shown[0].zoomed(factor, fixed.x),
                shown[1].zoomed(factor, fixed.y),
            ];
            let within = [0, 1].map(|axis| Range {
                min: zoomed[axis].min.max(ends[axis].min),
                max: zoomed[axis].max.min(ends[axis].max),
            });
            // An axis whose whole range was dragged beyond the ends stays as it is.
            shown = [0, 1].map(|axis| {
                if within[axis].width() > 0.0 {
                    within[axis]
                } else {
                    shown[axis]
                }
            });
            response.ctx.request_repaint();
        }
        let limited = |axis: usize| {
            shown[axis].limited(Range::new(LEAST_WIDTH, FARTHEST * whole[axis].width()))
        };
        if let [Some(x), Some(y)] = [limited(0), limited(1)] {
            self.ranges = Some([x, y]);
        }
        if response.double_clicked() && !is_pointed {
            self.ranges = None;
            response.ctx.request_repaint();
        }
    }
}

/// Returns the zoom limits: the ends of a time axis, a decade beyond other data.
fn ends(panel: &Panel, [across, values]: [Range; 2]) -> [Range; 2] {
    let beyond = |range: Range| range.with_margin(0.5 * (FARTHEST - 1.0), LEAST_WIDTH);
    let across = match panel.x.scale {
        Scale::Logarithmic => Range::new(across.min - 1.0, across.max + 1.0),
        Scale::Linear | Scale::Degrees if panel.x.label.ends_with("[s]") => across,
        Scale::Linear | Scale::Degrees => beyond(across),
    };
    [across, beyond(values)]
}

/// Returns the full ranges of a panel; on the screen, a logarithmic horizontal axis has logarithms.
fn whole(panel: &Panel) -> [Range; 2] {
    let [x, y] = [Along::X, Along::Y].map(|along| panel.shown(along));
    match panel.x.scale {
        Scale::Logarithmic => [Range::new(x.min.log10(), x.max.log10()), y],
        Scale::Linear | Scale::Degrees => [x, y],
    }
}

/// Returns the range of the values at these places.
fn values(panel: &Panel, places: Range) -> Range {
    match panel.x.scale {
        Scale::Logarithmic => Range::new(10f64.powf(places.min), 10f64.powf(places.max)),
        Scale::Linear | Scale::Degrees => places,
    }
}

/// Builds the frame with its axes.
fn frame<'a>(
    ui: &Ui,
    (id, size): (Id, Vec2),
    (panel, is_last): (&Panel, bool),
    (scene, has_values): (&FigureScene<'_>, bool),
    palette: &Palette,
) -> Frame<'a> {
    let names: Vec<(f64, String)> = panel.x.names.clone().unwrap_or_default();
    // Low plots have as many numbers as fit.
    let gap = if scene.is_compact {
        COMPACT_TICK_GAP
    } else {
        TICK_GAP
    };
    let is_named = !names.is_empty();
    let values = Ticks::Decimal(gap);
    let width = |text: &str| {
        ui.painter()
            .layout_no_wrap(text.to_owned(), tick_font(), palette.text)
            .size()
            .x
    };
    let widest = names
        .iter()
        .map(|(_, name)| width(name))
        .fold(0.0, f32::max);
    let count = names.len();
    let digit = f64::from(width("0"));
    let along = match panel.x.scale {
        Scale::Logarithmic => Ticks::Frequency(FrequencyUnit::RadPerSecond),
        Scale::Linear | Scale::Degrees => Ticks::Decimal(TICK_GAP),
    };
    let spacer = move |input: GridInput| match is_named {
        true => named_marks(&input, count, widest),
        false => along.marks_beside(input.bounds, input.base_step_size, digit),
    };
    let is_labelled = is_last && !scene.is_compact;
    let (words, height) = if is_labelled {
        (panel.x.label.as_str(), LABELLED_HEIGHT)
    } else {
        ("", TICKS_HEIGHT)
    };
    let across = axis_hints(Side::X, words, height, palette, along);
    let across = match is_named {
        true => across.formatter(move |mark, _: &RangeInclusive<f64>| {
            names
                .get(mark.value.round() as usize)
                .map(|(_, name)| name.clone())
                .unwrap_or_default()
        }),
        false => across,
    };
    let label = if scene.figure.shared.y {
        ""
    } else {
        panel.y.label.as_str()
    };
    // No label is longer than its axis: beside a low panel only the unit is shown.
    let is_too_long = width(label) > size.y - height;
    let label = label
        .rfind('[')
        .filter(|_| is_too_long)
        .map_or(label, |unit| &label[unit..]);
    let plot = quiet_plot(id, palette)
        .sense(if scene.zooms {
            Sense::click_and_drag()
        } else {
            Sense::click()
        })
        .width(size.x)
        .height(size.y)
        .show_grid([!is_named, true])
        .x_grid_spacer(spacer)
        .y_grid_spacer(values.spacer())
        .custom_x_axes(vec![across])
        .custom_y_axes(match has_values {
            true => vec![axis_hints(
                Side::Y,
                label,
                VALUE_AXIS_WIDTH,
                palette,
                values,
            )],
            false => Vec::new(),
        });
    if scene.zooms {
        plot.allow_drag(true)
            .allow_zoom(true)
            .allow_axis_zoom_drag(true)
    } else {
        plot
    }
}

/// Returns a mark for each name, or for every second, third … name if they are too wide.
fn named_marks(input: &GridInput, count: usize, widest: f32) -> Vec<GridMark> {
    /// Least gap between two names \[pt\].
    const SPACE: f64 = 6.0;
    let every = ((f64::from(widest) + SPACE) * input.base_step_size)
        .ceil()
        .max(1.0);
    (0..count)
        .step_by(every as usize)
        .map(|index| labelled_mark(index as f64, input.base_step_size))
        .collect()
}
