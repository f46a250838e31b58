//! Charts of the displayed record over time: the excited input, the output in focus and additional
//! outputs, with the models' responses, on a common time axis and with a common cursor.
//!
//! The *bright* spans are the displayed part, the parts in use or the whole record; the samples
//! outside them are drawn pale.

use std::sync::Arc;

use egui::{Align2, Color32, Rect, Shape, Stroke, Ui, pos2};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_model::dataset::Channel;
use gdcm_plot::figure::Range;

use super::caution_marks::channel_caution_marks;
use super::excited_channel::displayed_input;
use super::fit_layout::TICKS;
use super::frame_cache::cached;
use super::history_readout::{ChannelReadout, RoleValue};
use super::history_spans::{gap_spans, mode_spans};
use super::page::Page;
use super::record_span::RecordSpan;
use super::recorded_lines::{RecordedLines, recorded_lines};
use super::simulation::Simulated;
use super::spectrogram::spectrogram_ui;
use super::time_charts::{READOUT_WIDTH, VALUE_AXIS, time_axis};
use super::time_lines::value_at;
use super::value_range::rounded_range;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartLayout, ChartLine, ChartSpan};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::state::records::TimeRole;
use crate::gui::widgets::palette::{Palette, small};

/// Opacity of samples outside the bright spans ([`RecordSpan::bright_s`]).
const PALE: f32 = 0.4;
/// Share of the samples' range by which a model's response may extend the axis at either end; a
/// diverging model is cut.
const MOST_EXTENSION: f64 = 0.5;
/// Radius of dots at the cursor \[pt\].
const DOT: f32 = 2.8;

/// Horizontal axis and cursor, common to the charts.
pub(super) struct TimeView {
    /// Transform in one chart; only its horizontal axis is common to all charts.
    pub(super) transform: PlotTransform,
    /// Time at the cursor \[s\].
    pub(super) cursor_s: f64,
}

/// Draws the charts into the areas `places`, from top to bottom: the excited input, the output in
/// focus, and the additional outputs. Returns `None` without a chart.
///
/// 1. The channels, one for each place, and the place of the spectrogram, if it is switched on.
/// 2. A chart in each place that the spectrogram leaves: the samples in front of the models.
/// 3. The spectrogram on the same time axis.
/// 4. The common cursor with its values in every chart, and the unit at the lower left corner.
pub(super) fn histories_ui(
    ui: &mut Ui,
    page: Page<'_>,
    record: &RecordSpan,
    models: &[Simulated<'_>],
    places: &[Rect],
) -> Option<TimeView> {
    let charts = TimeCharts {
        page,
        record,
        models,
        spans: marked_spans(page),
    };
    charts.show(ui, places)
}

/// Returns the marked time spans: logging-system modes, and gaps.
fn marked_spans(page: Page<'_>) -> Vec<ChartSpan> {
    let Some(row) = page.records.rows.get(page.records.chosen) else {
        return Vec::new();
    };
    let mut spans = mode_spans(&row.table.modes, page.palette);
    spans.extend(gap_spans(page));
    spans
}

/// Returns the indices of outputs drawn over time: the output in focus, then the additional
/// outputs.
pub(super) fn shown_outputs(page: Page<'_>) -> Vec<usize> {
    let count = page.state.dataset().outputs().len();
    let focus = page.state.display.selection.pair.output;
    let mut outputs = vec![focus];
    match &page.state.records.more_outputs {
        Some(more) => {
            outputs.extend(
                more.iter()
                    .copied()
                    .filter(|output| *output < count && *output != focus),
            );
        }
        None => outputs.extend((0..count).filter(|output| *output != focus)),
    }
    outputs
}

/// Channel drawn over time.
#[derive(Clone, Copy)]
struct DrawnChannel<'a> {
    channel: &'a Channel,
    /// Index among inputs, then outputs.
    index: usize,
    /// Index among the outputs; `None` for an input.
    output: Option<usize>,
}

struct DrawnChart<'a> {
    channel: DrawnChannel<'a>,
    transform: PlotTransform,
    range: Range,
    recorded: Arc<RecordedLines>,
    place: Rect,
}

struct TimeCharts<'a> {
    page: Page<'a>,
    record: &'a RecordSpan,
    models: &'a [Simulated<'a>],
    /// Marked time spans \[s\], the same in every chart.
    spans: Vec<ChartSpan>,
}

impl<'a> TimeCharts<'a> {
    fn show(&self, ui: &mut Ui, places: &[Rect]) -> Option<TimeView> {
        // Step 1.
        let channels = self.channels(ui);
        let spectrogram_place = self.spectrogram_place(places);
        // Step 2.
        let mut drawn = Vec::new();
        for (number, place) in places.iter().enumerate() {
            let is_of_spectrogram = match spectrogram_place {
                Some(spectrogram) => spectrogram.contains(place.center()),
                None => false,
            };
            if is_of_spectrogram {
                continue;
            }
            let Some(channel) = channels.get(number) else {
                continue;
            };
            let is_lowest = number + 1 == places.len();
            drawn.push(self.chart_ui(ui, *place, *channel, is_lowest));
        }
        let lowest_chart = drawn.last()?;
        // Step 3.
        if let Some(place) = spectrogram_place {
            let has_ticks = places
                .last()
                .is_some_and(|last| place.contains(last.center()));
            spectrogram_ui(ui, self.page, self.record, place, has_ticks);
        }
        // Step 4.
        let transform = lowest_chart.transform;
        let cursor_s = self.cursor_s(ui, places, &drawn);
        for chart in &drawn {
            self.cursor_ui(ui, chart, cursor_s);
        }
        if let Some(last) = places.last() {
            let at = pos2(transform.frame().left() - 6.0, last.bottom() - 0.5 * TICKS);
            let color = self.page.palette.dim_text;
            ui.painter()
                .text(at, Align2::RIGHT_CENTER, "s", small(), color);
        }
        Some(TimeView {
            transform,
            cursor_s,
        })
    }

    /// Returns the place of the spectrogram; `None` if it is switched off. It replaces the two
    /// additional outputs or, if there are fewer, the input.
    fn spectrogram_place(&self, places: &[Rect]) -> Option<Rect> {
        self.page.state.records.spectrogram?;
        match places {
            [_, _, .., first, last] => Some(first.union(*last)),
            [first, ..] => Some(*first),
            [] => None,
        }
    }

    /// Returns the channels in the same order as `places`.
    fn channels(&self, ui: &Ui) -> Vec<DrawnChannel<'a>> {
        let dataset = self.page.state.dataset();
        let inputs = dataset.inputs();
        let input = displayed_input(ui, self.page);
        let mut channels = Vec::new();
        if let Some(channel) = inputs.get(input) {
            channels.push(DrawnChannel {
                channel,
                index: input,
                output: None,
            });
        }
        for output in shown_outputs(self.page) {
            channels.push(DrawnChannel {
                channel: &dataset.outputs()[output],
                index: inputs.len() + output,
                output: Some(output),
            });
        }
        channels
    }

    fn is_shown(&self, role: TimeRole) -> bool {
        !self.page.state.records.hidden_roles.contains(&role)
    }

    fn chart_ui(
        &self,
        ui: &mut Ui,
        place: Rect,
        channel: DrawnChannel<'a>,
        is_lowest: bool,
    ) -> DrawnChart<'a> {
        let palette = self.page.palette;
        let recorded = recorded_lines(ui, self.record, channel.index);
        let range = self.value_range(ui, channel, &recorded);
        let title = format!("{} [{}]", channel.channel.name, channel.channel.unit);
        let mut chart = Chart::new(&title, ChartAxis::Linear, "", "");
        chart.group = Some(time_axis(self.record));
        chart.fits_values = true;
        chart.values = Some(range);
        let [from, to] = self.record.span_s;
        chart.whole_across = Some(Range::new(from, to));
        chart.layout = ChartLayout {
            title_height: 0.0,
            value_axis_width: VALUE_AXIS,
            right_margin: READOUT_WIDTH,
            has_ticks_across: is_lowest,
        };
        chart.spans = self.spans.clone();
        for model in self.models {
            if let Some(output) = channel.output
                && self.is_shown(model.role)
            {
                let lines = model.lines(ui, output);
                add_lines(&mut chart, &lines, model.role, palette);
            }
        }
        if self.is_shown(TimeRole::Measured) {
            let color = TimeRole::Measured.color(palette).gamma_multiply(PALE);
            for points in &recorded.outside {
                chart.lines.push(ChartLine {
                    points: Arc::clone(points),
                    color,
                    width: 1.0,
                    dash: None,
                });
            }
            add_lines(&mut chart, &recorded.inside, TimeRole::Measured, palette);
        }
        chart.notes = self.caution_marks(&channel.channel.name);
        let transform = chart_ui(ui, place, &chart, palette).transform;
        DrawnChart {
            channel,
            transform,
            range,
            recorded,
            place,
        }
    }

    /// Returns a channel's value range: the samples' range, extended by all models' responses, even
    /// hidden ones, so that showing or hiding a model never moves the axis.
    fn value_range(
        &self,
        ui: &Ui,
        channel: DrawnChannel<'_>,
        recorded: &Arc<RecordedLines>,
    ) -> Range {
        let source = Arc::clone(recorded) as _;
        let name = format!("range {}", channel.index);
        let samples = cached(ui, &name, &[source], (), || {
            Range::spanning(recorded.points().map(|point| point[1]))
        });
        let Some(samples) = *samples else {
            return Range::new(-1.0, 1.0);
        };
        let widest = Range::new(
            samples.min - MOST_EXTENSION * samples.width(),
            samples.max + MOST_EXTENSION * samples.width(),
        );
        let mut range = samples;
        if let Some(output) = channel.output {
            for model in self.models {
                let lines = model.lines(ui, output);
                let source = Arc::clone(&lines) as _;
                let name = format!("range {} of {}", channel.index, model.role.name());
                let response = cached(ui, &name, &[source], (), || {
                    let points = lines.iter().flat_map(|line| line.iter());
                    Range::spanning(points.map(|point| point[1]))
                });
                if let Some(response) = *response {
                    range.min = range.min.min(response.min.max(widest.min));
                    range.max = range.max.max(response.max.min(widest.max));
                }
            }
        }
        rounded_range(range)
    }

    /// Returns the cursor's time \[s\]: first, under the pointer if it is over a chart that nothing
    /// covers; else where the output in focus (without outputs, the input) deviates most from its
    /// mean; else the record's start.
    fn cursor_s(&self, ui: &Ui, places: &[Rect], drawn: &[DrawnChart<'_>]) -> f64 {
        let pointer = ui.input(|input| input.pointer.hover_pos());
        if let Some(pointer) = pointer
            && let Some(chart) = drawn.last()
        {
            let frame = chart.transform.frame();
            let is_over = places.iter().any(|place| place.contains(pointer))
                && frame.x_range().contains(pointer.x)
                && ui.ctx().layer_id_at(pointer) == Some(ui.layer_id());
            if is_over {
                return chart.transform.value_from_position(pointer).x;
            }
        }
        let focus = drawn
            .iter()
            .find(|chart| chart.channel.output.is_some())
            .or(drawn.first());
        match focus {
            Some(chart) => *cached(
                ui,
                "largest sample",
                &[Arc::clone(&chart.recorded) as _],
                (),
                || time_of_largest_deviation(&chart.recorded).unwrap_or(self.record.span_s[0]),
            ),
            None => self.record.span_s[0],
        }
    }

    /// Draws a chart's cursor, and the values at the cursor in the margin.
    fn cursor_ui(&self, ui: &mut Ui, chart: &DrawnChart<'_>, cursor_s: f64) {
        let palette = self.page.palette;
        let frame = *chart.transform.frame();
        let values = self.values_at(ui, chart, cursor_s);
        let x = chart
            .transform
            .position_from_point(&PlotPoint::new(cursor_s, 0.0))
            .x;
        if frame.x_range().contains(x) {
            let painter = ui.painter().with_clip_rect(frame);
            let line = [pos2(x, frame.top()), pos2(x, frame.bottom())];
            let stroke = Stroke::new(1.0, palette.dim_text);
            painter.extend(Shape::dashed_line(&line, stroke, 4.0, 3.0));
            for role_value in &values {
                if let Some(value) = role_value.value
                    && self.is_shown(role_value.role)
                {
                    let at = chart
                        .transform
                        .position_from_point(&PlotPoint::new(cursor_s, value));
                    let color = role_value.role.color(palette);
                    painter.circle(at, DOT, color, Stroke::new(1.0, palette.background));
                }
            }
        }
        let readout = ChannelReadout {
            channel: chart.channel.channel,
            output: chart.channel.output,
            range: chart.range,
            values,
            models: self.models,
            page: self.page,
        };
        let mut place = chart.place.with_min_x(frame.right() + 10.0);
        place.max.y = frame.bottom();
        readout.show(ui, place);
    }

    fn values_at(&self, ui: &Ui, chart: &DrawnChart<'_>, cursor_s: f64) -> Vec<RoleValue> {
        let mut values = Vec::new();
        if let Some(output) = chart.channel.output {
            for model in self.models {
                values.push(RoleValue {
                    role: model.role,
                    value: value_at(&model.lines(ui, output), cursor_s),
                });
            }
        }
        let inside = value_at(&chart.recorded.inside, cursor_s);
        values.push(RoleValue {
            role: TimeRole::Measured,
            value: inside.or_else(|| value_at(&chart.recorded.outside, cursor_s)),
        });
        values
    }

    /// Returns the notes in a chart's accessible name: marks for the cautions about its channel.
    fn caution_marks(&self, channel: &str) -> Vec<(String, Color32)> {
        let mut marks = Vec::new();
        for mark in channel_caution_marks(self.page, channel) {
            marks.push((mark, self.page.palette.warning));
        }
        marks
    }
}

fn add_lines(chart: &mut Chart<'_>, lines: &[Arc<[[f64; 2]]>], role: TimeRole, palette: &Palette) {
    for points in lines {
        let line = ChartLine::styled(Arc::clone(points), role.style(palette));
        chart.lines.push(line);
    }
}

/// Returns the time \[s\] at which the samples inside the bright spans deviate most from their
/// mean; `None` without such samples.
fn time_of_largest_deviation(recorded: &RecordedLines) -> Option<f64> {
    let points: Vec<[f64; 2]> = recorded
        .inside
        .iter()
        .flat_map(|line| line.iter().copied())
        .collect();
    let mean = points.iter().map(|point| point[1]).sum::<f64>() / points.len().max(1) as f64;
    let largest = points
        .iter()
        .max_by(|a, b| (a[1] - mean).abs().total_cmp(&(b[1] - mean).abs()))?;
    Some(largest[0])
}
