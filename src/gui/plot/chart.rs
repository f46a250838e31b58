//! Simple plot: lines, bands and marks with error bars over a linear or logarithmic axis.

use std::sync::Arc;

use egui::{
    Align2, Color32, Id, Pos2, Rect, Response, Sense, Stroke, TextureId, Ui, UiBuilder, Vec2,
    Vec2b, WidgetInfo, pos2, vec2,
};
use egui_plot::{
    Axis, FilledArea, Line, LineStyle, MarkerShape, Plot, PlotImage, PlotPoint, PlotPoints, PlotUi,
    Points, Span, VLine,
};

use gdcm_plot::figure::Range;
use gdcm_plot::figure::thinning::{Pixel, thinned};

use super::axes::{
    FrequencyUnit, LABELLED_HEIGHT, TICKS_HEIGHT, Ticks, VERTICAL_TICK_GAP, axis_hints,
    caption_font, quiet_plot,
};
use super::drawn_curves::pixel_of;
use super::navigation::{Turn, turned};
use crate::gui::widgets::palette::Palette;

const TITLE_HEIGHT: f32 = 18.0;
/// Width of the longest number, so that the frames of stacked charts align \[pt\].
const VALUE_AXIS_WIDTH: f32 = 54.0;
const RIGHT_MARGIN: f32 = 8.0;
const NOTE_GAP: f32 = 8.0;
/// Space at either end of the horizontal axis, as a share of its length.
const EDGE: f64 = 0.01;
const TICK_GAP: f64 = 50.0;
/// Greatest distance of a drawn line from its data \[pt\].
const TOLERANCE: f64 = 0.1;
/// Upper bound on the width of a screen \[pixels\].
const MOST_PIXELS: f64 = 10_000.0;

/// Quantity of the horizontal axis of a chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChartAxis {
    /// Plain values.
    #[default]
    Linear,
    /// Angular frequencies \[rad/s\], drawn logarithmically and labelled in this unit.
    Frequency(FrequencyUnit),
}

impl ChartAxis {
    fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Frequency(_) => value.log10(),
        }
    }
}

/// Line of a chart.
#[derive(Clone, Debug)]
pub struct ChartLine {
    /// Points, ascending along the horizontal axis; invisible points and details finer than a pixel
    /// are not drawn.
    pub points: Arc<[[f64; 2]]>,
    pub color: Color32,
    /// Width \[pt\].
    pub width: f32,
    pub dashed: bool,
}

/// Area between two lines over the same places.
#[derive(Clone, Debug)]
pub struct ChartBand {
    /// Places, lower and upper values.
    pub points: Vec<[f64; 3]>,
    pub color: Color32,
}

/// Marks with the same style.
#[derive(Clone, Debug)]
pub struct ChartMarks {
    /// Places, values, and half-lengths of the vertical error bars; 0 for none.
    pub points: Vec<[f64; 3]>,
    /// Half-lengths of the horizontal error bars; empty for none.
    pub sideways: Vec<f64>,
    pub color: Color32,
    pub filled: bool,
    /// Whether the marks are crosses instead of circles.
    pub crosses: bool,
}

/// Marked stretch of the horizontal axis.
#[derive(Clone, Debug)]
pub struct ChartSpan {
    pub ends: [f64; 2],
    pub color: Color32,
}

/// Content of a chart.
#[derive(Clone, Debug, Default)]
pub struct Chart<'a> {
    /// Title, which is also its accessible name.
    pub title: &'a str,
    /// Words at the right end of the title line, with their colours.
    pub notes: Vec<(String, Color32)>,
    pub across: ChartAxis,
    /// Label of the horizontal axis; an empty label keeps the axis low.
    pub across_label: &'a str,
    /// Label of the vertical axis.
    pub value_label: &'a str,
    /// Whether the visible values fill the height: then only the horizontal axis can be zoomed and
    /// panned.
    pub fits_values: bool,
    /// Charts of a group share the visible stretch of the horizontal axis.
    pub group: Option<Id>,
    /// Marked stretches.
    pub spans: Vec<ChartSpan>,
    /// Areas, below all lines.
    pub bands: Vec<ChartBand>,
    /// Lines, the last on top.
    pub lines: Vec<ChartLine>,
    /// Marks, on top of the lines.
    pub marks: Vec<ChartMarks>,
    pub verticals: Vec<f64>,
    /// Image below everything else.
    pub image: Option<ChartImage>,
    /// Whether dragging chooses a stretch of the horizontal axis, returned by [`chosen_stretch`]
    /// for the group, instead of panning.
    pub chooses: bool,
}

/// Image over a stretch of both axes; the vertical axis shows frequencies \[rad/s\].
#[derive(Clone, Copy, Debug)]
pub struct ChartImage {
    /// Texture with the highest frequency at the top.
    pub texture: TextureId,
    /// Places of the left and right edges.
    pub across: [f64; 2],
    /// Frequencies of the lower and upper edges \[rad/s\].
    pub omega: [f64; 2],
    /// Display unit of the frequencies.
    pub unit: FrequencyUnit,
}

impl<'a> Chart<'a> {
    /// Creates an empty chart.
    pub fn new(
        title: &'a str,
        across: ChartAxis,
        across_label: &'a str,
        value_label: &'a str,
    ) -> Self {
        Self {
            title,
            across,
            across_label,
            value_label,
            ..Self::default()
        }
    }
}

/// Draws a chart into `rect`: dragging pans, the wheel zooms, a double click shows everything.
pub fn chart_ui(ui: &mut Ui, rect: Rect, chart: &Chart<'_>, palette: &Palette) -> Response {
    let id = ui.make_persistent_id(chart.title);
    let plot_rect = Rect::from_min_max(
        rect.min + vec2(0.0, TITLE_HEIGHT),
        rect.max - vec2(RIGHT_MARGIN, 0.0),
    );
    let shown = ui.scope_builder(UiBuilder::new().id_salt(id).max_rect(plot_rect), |ui| {
        empty_chart(id, plot_rect, chart, palette).show(ui, |plot| {
            draw(plot, chart, palette);
            zoom_by_scrolling(plot, chart);
            if let Some(group) = chart.group.filter(|_| chart.chooses) {
                choose_by_dragging(plot, group);
            }
            view_of(plot)
        })
    });
    let bounds = shown.inner.transform.bounds();
    let is_whole = shown.inner.inner[0] == f64::NEG_INFINITY;
    if !is_whole && shown.inner.inner != [bounds.min()[0], bounds.max()[0]] {
        // The lines were drawn for the view of the previous frame.
        ui.request_repaint();
    }
    let response = shown.inner.response;
    let frame = shown.inner.transform.frame();
    let mut at = pos2(frame.left(), rect.top() + 0.5 * TITLE_HEIGHT);
    ui.painter().text(
        at,
        Align2::LEFT_CENTER,
        chart.title,
        caption_font(),
        palette.text,
    );
    at.x = frame.right();
    for (words, color) in chart.notes.iter().rev() {
        at.x = ui
            .painter()
            .text(at, Align2::RIGHT_CENTER, words, caption_font(), *color)
            .left()
            - NOTE_GAP;
    }
    let mut description = format!(
        "{}: {} lines, {} marks",
        chart.title,
        chart.lines.len(),
        count(chart)
    );
    chart
        .notes
        .iter()
        .for_each(|(words, _)| description.extend(["; ", words.as_str()]));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, description.clone()));
    response
}

/// Start and current place of a drag, and whether it has ended.
type Stretch = ([f64; 2], bool);

fn choose_by_dragging(plot: &PlotUi<'_>, group: Id) {
    let response = plot.response();
    if !response.dragged() && !response.drag_stopped() {
        return;
    }
    let place = |at: Pos2| plot.plot_from_screen(at).x;
    // A drag is only recognised some points after the button was pressed.
    let (from, to) = plot
        .ctx()
        .input(|input| (input.pointer.press_origin(), input.pointer.latest_pos()));
    plot.ctx().data_mut(|data| {
        let began = data
            .get_temp::<Stretch>(group.with("stretch"))
            .map(|([from, _], _)| from);
        let Some(from) = from.map(place).or(began) else {
            return;
        };
        let to = to.map_or(from, place);
        data.insert_temp::<Stretch>(group.with("stretch"), ([from, to], response.drag_stopped()));
    });
}

/// Returns the stretch chosen by dragging in a group of charts, lower end first, and whether the
/// drag has ended; a finished stretch is returned once.
pub fn chosen_stretch(ui: &Ui, group: Id) -> Option<([f64; 2], bool)> {
    let id = group.with("stretch");
    let ([from, to], has_ended) = ui.data(|data| data.get_temp::<Stretch>(id))?;
    if has_ended {
        ui.data_mut(|data| data.remove::<Stretch>(id));
    }
    Some(([from.min(to), from.max(to)], has_ended))
}

/// The wheel and pinching zoom about the pointer.
fn zoom_by_scrolling(plot: &mut PlotUi<'_>, chart: &Chart<'_>) {
    let fits_values = chart.fits_values;
    if let Some((turn, pointer)) = turned(plot.ctx(), plot.response()) {
        let Turn { both, sideways } = turn;
        let factor = if fits_values {
            vec2(turn.along_one_axis(), 1.0)
        } else {
            vec2(both.x * sideways, both.y)
        };
        let fixed = plot.plot_from_screen(pointer);
        let bounds = plot.plot_bounds();
        let ends = ends(chart);
        let zoomed = |axis: usize, factor: f32, fixed: f64| {
            let Range { min, max } =
                Range::new(bounds.min()[axis], bounds.max()[axis]).zoomed(f64::from(factor), fixed);
            let [least, most] =
                ends[axis].map_or([min, max], |ends| [min.max(ends.min), max.min(ends.max)]);
            (least < most).then_some(least..=most)
        };
        zoomed(0, factor.x, fixed.x)
            .into_iter()
            .for_each(|range| plot.set_plot_bounds_x(range));
        zoomed(1, factor.y, fixed.y)
            .into_iter()
            .for_each(|range| plot.set_plot_bounds_y(range));
        plot.set_auto_bounds(Vec2b::new(false, fits_values));
        // Keeps the surrounding area from scrolling as well.
        plot.ctx()
            .input_mut(|input| input.smooth_scroll_delta = Vec2::ZERO);
    } else if fits_values && !plot.auto_bounds().y {
        // The drag has ended the automatic fit.
        plot.set_auto_bounds(Vec2b::new(plot.auto_bounds().x, true));
    }
}

/// Returns the zoom limits: the ends of a time axis, a decade beyond other data.
fn ends(chart: &Chart<'_>) -> [Option<Range>; 2] {
    /// Widths of the data that can be shown beyond each of their ends.
    const BEYOND: f64 = 4.5;
    let lines = || {
        chart
            .lines
            .iter()
            .flat_map(|line| line.points.iter().copied())
    };
    let points = || {
        lines().chain(
            chart
                .marks
                .iter()
                .flat_map(|marks| marks.points.iter().map(|[x, y, _]| [*x, *y])),
        )
    };
    let image = |of: fn(&ChartImage) -> [f64; 2]| chart.image.iter().flat_map(of);
    let across = points()
        .map(|point| point[0])
        .chain(image(|image| image.across));
    let across = Range::of(across.map(|value| chart.across.place(value)));
    let values = Range::of(
        points()
            .map(|point| point[1])
            .chain(image(|image| image.omega.map(f64::log10))),
    );
    let is_of_times = chart.fits_values || chart.image.is_some();
    let across = across.map(|range| match chart.across {
        ChartAxis::Frequency(_) => Range::new(range.min - 1.0, range.max + 1.0),
        ChartAxis::Linear if is_of_times => range.with_margin(EDGE, 0.0),
        ChartAxis::Linear => range.with_margin(BEYOND, 0.0),
    });
    [across, values.map(|range| range.with_margin(BEYOND, 0.0))]
}

fn count(chart: &Chart<'_>) -> usize {
    chart.marks.iter().map(|marks| marks.points.len()).sum()
}

fn empty_chart<'a>(id: Id, rect: Rect, chart: &Chart<'_>, palette: &Palette) -> Plot<'a> {
    let height = if chart.across_label.is_empty() {
        TICKS_HEIGHT
    } else {
        LABELLED_HEIGHT
    };
    let values = match &chart.image {
        Some(image) => Ticks::Frequency(image.unit),
        None => Ticks::Decimal(VERTICAL_TICK_GAP),
    };
    let plot = quiet_plot(id, palette)
        .sense(Sense::click_and_drag())
        .auto_bounds(true)
        .allow_drag(if chart.chooses {
            Vec2b::FALSE
        } else {
            Vec2b::new(true, !chart.fits_values)
        })
        .allow_axis_zoom_drag(true)
        .allow_double_click_reset(true)
        .set_margin_fraction(vec2(EDGE as f32, 0.08))
        .width(rect.width())
        .height(rect.height())
        .y_grid_spacer(values.spacer())
        .custom_y_axes(vec![axis_hints(
            Axis::Y,
            chart.value_label,
            VALUE_AXIS_WIDTH,
            palette,
            values,
        )]);
    let ticks = match chart.across {
        ChartAxis::Linear => Ticks::Decimal(TICK_GAP),
        ChartAxis::Frequency(unit) => Ticks::Frequency(unit),
    };
    let across = axis_hints(Axis::X, chart.across_label, height, palette, ticks);
    let plot = plot
        .x_grid_spacer(ticks.spacer())
        .custom_x_axes(vec![across]);
    match chart.group {
        Some(group) => plot
            .link_axis(group, Vec2b::new(true, false))
            .link_cursor(group, Vec2b::new(true, false)),
        None => plot,
    }
}

fn draw<'a>(plot: &mut PlotUi<'a>, chart: &Chart<'_>, palette: &Palette) {
    let place = |value: f64| chart.across.place(value);
    if let Some(ChartImage {
        texture,
        across,
        omega,
        ..
    }) = &chart.image
    {
        let [lower, upper] = omega.map(f64::log10);
        let middle = PlotPoint::new(0.5 * (across[0] + across[1]), 0.5 * (lower + upper));
        let size = vec2((across[1] - across[0]) as f32, (upper - lower) as f32);
        plot.image(PlotImage::new("", *texture, middle, size).allow_hover(false));
    }
    for span in &chart.spans {
        plot.span(
            Span::new("", place(span.ends[0])..=place(span.ends[1]))
                .fill(span.color)
                .border_width(0.0),
        );
    }
    for band in &chart.bands {
        let column = |index: usize| {
            band.points
                .iter()
                .map(|point| point[index])
                .collect::<Vec<f64>>()
        };
        let places: Vec<f64> = band.points.iter().map(|point| place(point[0])).collect();
        plot.add(
            FilledArea::new("", &places, &column(1), &column(2))
                .fill_color(band.color)
                .allow_hover(false),
        );
    }
    for vertical in &chart.verticals {
        let style = LineStyle::Dotted { spacing: 4.0 };
        plot.vline(
            VLine::new("", place(*vertical))
                .color(palette.dim_text)
                .width(0.8)
                .style(style),
        );
    }
    let ends = view_of(plot);
    for line in &chart.lines {
        let points = match chart.across {
            ChartAxis::Linear => in_view(&line.points, ends, pixel_in(plot, &line.points)),
            ChartAxis::Frequency(_) => line.points.iter().map(|[x, y]| [place(*x), *y]).collect(),
        };
        let style = if line.dashed {
            LineStyle::dashed_dense()
        } else {
            LineStyle::Solid
        };
        let width = line.width * palette.line_width;
        plot.line(
            Line::new("", PlotPoints::from(points))
                .color(line.color)
                .width(width)
                .style(style)
                .allow_hover(false),
        );
    }
    for marks in &chart.marks {
        draw_marks(plot, chart, marks);
    }
}

/// Returns the visible ends of the horizontal axis: unbounded if the plot is about to be fitted.
fn view_of(plot: &PlotUi<'_>) -> [f64; 2] {
    if plot.auto_bounds().x {
        return [f64::NEG_INFINITY, f64::INFINITY];
    }
    let bounds = plot.plot_bounds();
    [bounds.min()[0], bounds.max()[0]]
}

/// Returns the pixel of the plot as last drawn; before the first drawing, a pixel finer than that
/// of any screen.
fn pixel_in(plot: &PlotUi<'_>, points: &[[f64; 2]]) -> Pixel {
    let pixel = pixel_of(plot.transform(), plot.ctx().pixels_per_point(), TOLERANCE);
    if pixel.width.is_finite() && pixel.width > 0.0 {
        return pixel;
    }
    let length = points
        .first()
        .zip(points.last())
        .map_or(0.0, |(first, last)| last[0] - first[0]);
    Pixel {
        width: length / MOST_PIXELS,
        tolerance: 0.0,
    }
}

fn draw_marks(plot: &mut PlotUi<'_>, chart: &Chart<'_>, marks: &ChartMarks) {
    let place = |value: f64| chart.across.place(value);
    let bar = |from: [f64; 2], to: [f64; 2]| {
        Line::new("", vec![from, to])
            .stroke(Stroke::new(1.0, marks.color))
            .allow_hover(false)
    };
    for [x, y, error] in marks.points.iter().filter(|point| point[2] > 0.0) {
        plot.line(bar([place(*x), y - error], [place(*x), y + error]));
    }
    for ([x, y, _], error) in marks
        .points
        .iter()
        .zip(&marks.sideways)
        .filter(|(_, error)| **error > 0.0)
    {
        plot.line(bar([place(x - error), *y], [place(x + error), *y]));
    }
    let points: PlotPoints<'_> = marks
        .points
        .iter()
        .map(|[x, y, _]| [place(*x), *y])
        .collect();
    let shape = if marks.crosses {
        MarkerShape::Cross
    } else {
        MarkerShape::Circle
    };
    let points = Points::new("", points)
        .shape(shape)
        .filled(marks.filled)
        .radius(3.0)
        .color(marks.color);
    plot.points(points.allow_hover(false));
}

/// Returns the visible part of a line: the stretch between `ends` with a point on either side, no
/// finer than its pixels.
fn in_view(points: &[[f64; 2]], ends: [f64; 2], pixel: Pixel) -> Vec<[f64; 2]> {
    let from = points
        .partition_point(|point| point[0] < ends[0])
        .saturating_sub(1);
    let to = (points.partition_point(|point| point[0] <= ends[1]) + 1).min(points.len());
    thinned(points.get(from..to).unwrap_or_default(), pixel)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_keeps_every_peak_in_view_and_every_sample_that_the_screen_can_tell_apart() {
        let mut points: Vec<[f64; 2]> = (0..10_000)
            .map(|k| [f64::from(k), f64::from(k % 2)])
            .collect();
        points[4321][1] = 7.0;
        points[8765][1] = -3.0;
        let shown = |ends, width| {
            in_view(
                &points,
                ends,
                Pixel {
                    width,
                    tolerance: 1e-3,
                },
            )
        };
        let all = shown([f64::NEG_INFINITY, f64::INFINITY], 20.0);
        assert!(all.len() <= 4 * 10_000 / 20, "{}", all.len());
        assert!(all.contains(&[4321.0, 7.0]) && all.contains(&[8765.0, -3.0]));
        assert_eq!((all.first(), all.last()), (points.first(), points.last()));
        assert!(all.is_sorted_by(|a, b| a[0] < b[0]));
        assert_eq!(
            shown([4310.5, 4330.5], 0.1),
            &points[4310..=4331],
            "with the lines that leave the view"
        );
        assert!(
            shown([20_000.0, 20_001.0], 0.1).len() < 2,
            "nothing to draw"
        );
    }
}
