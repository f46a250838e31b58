//! Chart on the screen: its frame, its gestures, and the texts above.

use egui::{Align2, Rect, Response, Ui, Vec2, Vec2b, pos2, vec2};
use egui_plot::{PlotTransform, PlotUi};

use gdcm_model::number_format::counted;
use gdcm_plot::figure::Range;

use super::chart::{Chart, ChartAxis};
use super::chart_layers::{add_layers, visible_ends};
use super::panel_axis::{LABELLED_HEIGHT, PanelAxis, TICKS_HEIGHT};
use super::panel_painter::{Follow, Gestures, PanelPainter};
use super::panel_text::caption_font;
use super::ticks::{Ticks, VERTICAL_TICK_GAP};
use super::viewed_range::ranges_of;
use super::zoom_gesture::ZoomGesture;
use super::zoom_limit::{ZoomLimit, zoomed_within};
use crate::gui::widgets::palette::Palette;

/// Gap between two notes \[pt\].
const NOTE_GAP: f32 = 8.0;
/// Margin at the left and at the right of the data, relative to the width.
const ACROSS_MARGIN: f64 = 0.01;
/// Margin above and below the data, relative to the height.
const VALUE_MARGIN: f32 = 0.08;
/// Minimum distance between tick labels on a linear horizontal axis \[pt\].
const TICK_GAP: f64 = 50.0;

/// A chart as drawn.
pub struct ChartResponse {
    pub response: Response,
    /// Transform from axis coordinates, which are logarithms on a frequency axis, to the screen.
    pub transform: PlotTransform,
}

/// Draws a chart into `rect`: dragging pans, the wheel zooms, a double click shows everything.
///
/// 1. place the frame with its axes below the title line, left of the right margin;
/// 2. draw the layers, with lines thinned for the range visible in the last frame, and zoom;
/// 3. repaint if the visible range has changed since, so that the lines are thinned for it;
/// 4. paint the title and the notes, unless the chart has no title line.
pub fn chart_ui(ui: &mut Ui, rect: Rect, chart: &Chart<'_>, palette: &Palette) -> ChartResponse {
    let layout = chart.layout;
    // Step 1.
    let panel = PanelPainter {
        id: ui.make_persistent_id((chart.title, chart.group)),
        rect: Rect::from_min_max(
            rect.min + vec2(0.0, layout.title_height),
            rect.max - vec2(layout.right_margin, 0.0),
        ),
        name: &description(chart),
        across: horizontal_axis(chart),
        values: vertical_axis(chart),
        gestures: Gestures::Following(Follow {
            pans: Vec2b::new(true, !chart.fits_values),
            margins: vec2(ACROSS_MARGIN as f32, VALUE_MARGIN),
            group: chart.group,
            whole_across: chart.whole_across.map(|range| place_of(chart, range)),
            values: chart.values,
        }),
        is_transparent: false,
        palette,
    };
    // Step 2.
    let shown = panel.show(ui, |plot| {
        add_layers(plot, chart, palette);
        zoom_by_scrolling(plot, chart);
        visible_ends(plot)
    });
    // Step 3.
    let [across, _] = ranges_of(shown.transform.bounds());
    let thinned_for = shown.inner;
    let is_whole = thinned_for[0] == f64::NEG_INFINITY;
    if !is_whole && thinned_for != [across.min, across.max] {
        ui.request_repaint();
    }
    // Step 4.
    if layout.title_height > 0.0 {
        let line = rect.with_max_y(rect.top() + layout.title_height);
        let frame = *shown.transform.frame();
        let title = line.with_min_x(frame.left()).with_max_x(frame.right());
        paint_title(ui, title, chart, palette);
    }
    ChartResponse {
        response: shown.response,
        transform: shown.transform,
    }
}

/// Converts a range along the horizontal axis to axis coordinates.
fn place_of(chart: &Chart<'_>, range: Range) -> Range {
    Range::new(chart.across.place(range.min), chart.across.place(range.max))
}

/// Returns the accessible name.
fn description(chart: &Chart<'_>) -> String {
    let marks: usize = chart.marks.iter().map(|marks| marks.points.len()).sum();
    let mut description = format!(
        "{}: {}, {}",
        chart.title,
        counted(chart.lines.len(), "line"),
        counted(marks, "mark")
    );
    for (words, _) in &chart.notes {
        description.push_str("; ");
        description.push_str(words);
    }
    description
}

fn horizontal_axis(chart: &Chart<'_>) -> PanelAxis {
    let ticks = match chart.across {
        ChartAxis::Linear => Ticks::Decimal(TICK_GAP),
        ChartAxis::Frequency(unit) => Ticks::Frequency(unit),
    };
    let height = if chart.across_label.is_empty() {
        TICKS_HEIGHT
    } else {
        LABELLED_HEIGHT
    };
    let mut axis = PanelAxis::new(ticks, height).labelled(chart.across_label);
    axis.is_drawn = chart.layout.has_ticks_across;
    axis
}

fn vertical_axis(chart: &Chart<'_>) -> PanelAxis {
    let ticks = match &chart.image {
        Some(image) => Ticks::Frequency(image.unit),
        None => Ticks::Decimal(VERTICAL_TICK_GAP),
    };
    PanelAxis::new(ticks, chart.layout.value_axis_width).labelled(chart.value_label)
}

/// Paints the title at the left of a line, and the notes at the right.
fn paint_title(ui: &Ui, line: Rect, chart: &Chart<'_>, palette: &Palette) {
    let painter = ui.painter();
    let mut at = pos2(line.left(), line.center().y);
    let font = caption_font();
    painter.text(at, Align2::LEFT_CENTER, chart.title, font, palette.text);
    at.x = line.right();
    for (words, color) in chart.notes.iter().rev() {
        let place = painter.text(at, Align2::RIGHT_CENTER, words, caption_font(), *color);
        at.x = place.left() - NOTE_GAP;
    }
}

/// Zooms about the pointer by wheel and pinching: only the horizontal axis if the values always
/// fill the height (`fits_values`), with all gestures combined; otherwise each axis.
fn zoom_by_scrolling(plot: &mut PlotUi<'_>, chart: &Chart<'_>) {
    let fits_values = chart.fits_values;
    let Some(gesture) = ZoomGesture::find(plot.ctx(), plot.response()) else {
        if fits_values && !plot.auto_bounds().y {
            // Turn the automatic fit on again: dragging has turned it off.
            plot.set_auto_bounds(Vec2b::new(plot.auto_bounds().x, true));
        }
        return;
    };
    let factors = if fits_values {
        [gesture.along_one_axis(), 1.0]
    } else {
        [gesture.across(), gesture.upward()]
    };
    let fixed = plot.plot_from_screen(gesture.pointer);
    let [x, y] = ranges_of(&plot.plot_bounds());
    let limits = zoom_limits(chart);
    if let Some(x) = zoomed_within(x, factors[0], fixed.x, limits[0]) {
        plot.set_plot_bounds_x(x.min..=x.max);
    }
    if let Some(y) = zoomed_within(y, factors[1], fixed.y, limits[1]) {
        plot.set_plot_bounds_y(y.min..=y.max);
    }
    plot.set_auto_bounds(Vec2b::new(false, fits_values));
    // Prevents the surrounding area from scrolling as well.
    plot.ctx()
        .input_mut(|input| input.smooth_scroll_delta = Vec2::ZERO);
}

/// Returns the limits for zooming out, relative to the range of lines, marks and image. For the
/// horizontal axis: over frequencies a decade beyond it; in charts over time and small charts (the
/// values fill the height, or there is an image) that range with a small margin; otherwise ten
/// times as wide. For the values: ten times as wide. No limit without data.
fn zoom_limits(chart: &Chart<'_>) -> [Range; 2] {
    let mut across = Vec::new();
    let mut values = Vec::new();
    for line in &chart.lines {
        across.extend(line.points.iter().map(|point| point[0]));
        values.extend(line.points.iter().map(|point| point[1]));
    }
    for marks in &chart.marks {
        across.extend(marks.points.iter().map(|point| point[0]));
        values.extend(marks.points.iter().map(|point| point[1]));
    }
    if let Some(image) = &chart.image {
        across.extend(image.across);
        values.extend(image.omega.map(f64::log10));
    }
    let places = across.into_iter().map(|value| chart.across.place(value));
    let ends_with_data = chart.fits_values || chart.image.is_some();
    let widths = ZoomLimit::TenWidths { least: 0.0 };
    let limit_across = match chart.across {
        ChartAxis::Frequency(_) => ZoomLimit::Decade,
        ChartAxis::Linear if ends_with_data => ZoomLimit::DataWithMargin(ACROSS_MARGIN),
        ChartAxis::Linear => widths,
    };
    [
        Range::spanning(places).map_or(Range::ALL, |data| limit_across.range(data)),
        Range::spanning(values).map_or(Range::ALL, |data| widths.range(data)),
    ]
}
