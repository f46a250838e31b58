//! Chart layers, from bottom to top: image, shades over values and over horizontal ranges, areas,
//! dotted verticals, band ends, levels, lines, error bars and marks.

use egui::{Stroke, vec2};
use egui_plot::{Line, LineStyle, MarkerShape, PlotImage, PlotPoint, PlotPoints, PlotUi, Points};

use gdcm_plot::figure::thinning::Pixel;

use super::chart::{Chart, ChartAxis, ChartImage, ChartLine, ChartMarks};
use super::layers::{
    add_area, add_dashed_level, add_dotted_vertical, add_shade, add_shade_of_values, add_vertical,
};
use super::thinning::{pixel_of, thinned_between};
use crate::gui::widgets::palette::Palette;

/// Maximum deviation between a drawn line and its data \[pt\].
const TOLERANCE: f64 = 0.1;
/// Screen width assumed before the first drawing, larger than any screen's \[pixels\].
const MOST_PIXELS: f64 = 10_000.0;
const MARK_RADIUS: f32 = 3.0;

/// Adds a chart's content to its panel. Lines and marks are egui_plot items, because the panel fits
/// its ranges to them.
pub(super) fn add_layers(plot: &mut PlotUi<'_>, chart: &Chart<'_>, palette: &Palette) {
    if let Some(image) = &chart.image {
        add_image(plot, image);
    }
    if let Some(tolerance) = &chart.tolerance {
        let [from, to] = tolerance.ends;
        add_shade_of_values(plot, from..=to, tolerance.color);
    }
    for span in &chart.spans {
        let [from, to] = span.ends.map(|end| chart.across.place(end));
        add_shade(plot, from..=to, span.color);
    }
    for area in &chart.areas {
        let mut points = area.points.clone();
        for point in &mut points {
            point[0] = chart.across.place(point[0]);
        }
        add_area(plot, &points, area.color);
    }
    for vertical in &chart.verticals {
        let stroke = Stroke::new(0.8, palette.dim_text);
        add_dotted_vertical(plot, chart.across.place(*vertical), stroke);
    }
    for end in chart.band_ends.into_iter().flatten() {
        let stroke = Stroke::new(1.0, palette.accent);
        add_vertical(plot, chart.across.place(end), stroke);
    }
    for level in &chart.levels {
        add_dashed_level(plot, *level, Stroke::new(1.0, palette.dim_text));
    }
    let ends_across = visible_ends(plot);
    for line in &chart.lines {
        let points = visible_points(plot, chart.across, line, ends_across);
        let style = match line.dash {
            Some(length) => LineStyle::Dashed { length },
            None => LineStyle::Solid,
        };
        plot.line(
            Line::new("", PlotPoints::from(points))
                .color(line.color)
                .width(line.width * palette.line_width)
                .style(style)
                .allow_hover(false),
        );
    }
    for marks in &chart.marks {
        add_error_bars(plot, chart.across, marks);
        add_marks(plot, chart.across, marks);
    }
}

fn add_image(plot: &mut PlotUi<'_>, image: &ChartImage) {
    let [left, right] = image.across;
    let [lower, upper] = image.omega.map(f64::log10);
    let middle = PlotPoint::new(0.5 * (left + right), 0.5 * (lower + upper));
    let size = vec2((right - left) as f32, (upper - lower) as f32);
    plot.image(PlotImage::new("", image.texture, middle, size).allow_hover(false));
}

/// Returns the ends of the visible horizontal range, as last drawn: unbounded if the plot is about
/// to be fitted, because the fit needs all points.
pub(super) fn visible_ends(plot: &PlotUi<'_>) -> [f64; 2] {
    if plot.auto_bounds().x {
        return [f64::NEG_INFINITY, f64::INFINITY];
    }
    let bounds = plot.plot_bounds();
    [bounds.min()[0], bounds.max()[0]]
}

/// Returns the points to draw. A line over frequencies has few points and is not thinned.
fn visible_points(
    plot: &PlotUi<'_>,
    across: ChartAxis,
    line: &ChartLine,
    ends: [f64; 2],
) -> Vec<[f64; 2]> {
    match across {
        ChartAxis::Linear => thinned_between(&line.points, ends, pixel_in(plot, &line.points)),
        ChartAxis::Frequency(_) => line
            .points
            .iter()
            .map(|[x, y]| [across.place(*x), *y])
            .collect(),
    }
}

/// Returns the pixel size as last drawn; before the first drawing, a size finer than on any screen.
fn pixel_in(plot: &PlotUi<'_>, points: &[[f64; 2]]) -> Pixel {
    let pixel = pixel_of(plot.transform(), plot.ctx().pixels_per_point(), TOLERANCE);
    if pixel.width.is_finite() && pixel.width > 0.0 {
        return pixel;
    }
    let length = match points {
        [first, .., last] => last[0] - first[0],
        _ => 0.0,
    };
    Pixel {
        width: length / MOST_PIXELS,
        tolerance: 0.0,
    }
}

fn add_error_bars(plot: &mut PlotUi<'_>, across: ChartAxis, marks: &ChartMarks) {
    for [x, y, error] in &marks.points {
        if *error > 0.0 {
            let place = across.place(*x);
            add_bar(plot, marks, [[place, y - error], [place, y + error]]);
        }
    }
    for ([x, y, _], error) in marks.points.iter().zip(&marks.sideways) {
        if *error > 0.0 {
            let from = across.place(x - error);
            let to = across.place(x + error);
            add_bar(plot, marks, [[from, *y], [to, *y]]);
        }
    }
}

fn add_bar(plot: &mut PlotUi<'_>, marks: &ChartMarks, ends: [[f64; 2]; 2]) {
    let stroke = Stroke::new(1.0, marks.color);
    let bar = Line::new("", ends.to_vec());
    plot.line(bar.stroke(stroke).allow_hover(false));
}

fn add_marks(plot: &mut PlotUi<'_>, across: ChartAxis, marks: &ChartMarks) {
    let places: PlotPoints<'_> = marks
        .points
        .iter()
        .map(|[x, y, _]| [across.place(*x), *y])
        .collect();
    let shape = if marks.crosses {
        MarkerShape::Cross
    } else {
        MarkerShape::Circle
    };
    let points = Points::new("", places)
        .shape(shape)
        .filled(marks.filled)
        .radius(MARK_RADIUS)
        .color(marks.color);
    plot.points(points.allow_hover(false));
}
