//! Page with the channels of a record over time, and the models' responses to the same inputs.

use std::sync::Arc;

use egui::{Color32, Label, Rect, RichText, ScrollArea, Sense, Ui, vec2};

use gdcm_model::simulation::FlightRecord;
use gdcm_sysid::records::ModeSpan;

use super::frame_cache::cached;
use super::history_spans::{gap_spans, mode_spans, part_spans};
use super::page::Page;
use super::record_parts::{part_ui, span_ui};
use super::simulation::{Simulated, simulated, time_models_ui};
use super::spectrogram::{spectrogram_choice_ui, spectrogram_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartLine, ChartSpan};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::plot::dragged_range::take_dragged_range;
use crate::gui::widgets::palette::Palette;

/// Minimum chart height \[pt\]; further charts scroll.
const LEAST_HEIGHT: f32 = 84.0;

/// Shows the toolbar, the spectrogram, and a chart for each input and output.
pub(super) fn histories_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let Some(row) = records.rows.get(records.chosen) else {
        return;
    };
    let Some(flight) = &row.flight else {
        let text = "First assign the record's columns to channels on the Columns page";
        ui.label(RichText::new(text).color(palette.warning));
        return;
    };
    modes_ui(ui, &row.table.modes, palette);
    let mut spans = mode_spans(&row.table.modes, palette);
    spans.extend(part_spans(page));
    spans.extend(gap_spans(page));
    ui.horizontal_wrapped(|ui| {
        time_models_ui(ui, state, palette, commands);
        spectrogram_choice_ui(ui, page, commands);
        part_ui(ui, page, commands);
        span_ui(ui, page);
    });
    if let Some(part_s) = take_dragged_range(ui, Page::time_axis()) {
        spans.push(ChartSpan {
            ends: part_s.ends,
            color: palette.accent.gamma_multiply(0.35),
        });
        if part_s.has_ended {
            commands.push(RecordsCommand::AddPart(records.chosen, part_s.ends).into());
        }
    }
    preparation_ui(ui, page);
    let models = simulated(state, palette);
    for model in &models {
        model.absence_ui(ui, state, palette);
    }
    spectrogram_ui(ui, page, flight);
    let charts = ChannelCharts {
        page,
        flight,
        models: &models,
        spans: &spans,
    };
    ScrollArea::vertical()
        .id_salt("histories")
        .auto_shrink(false)
        .show(ui, |ui| charts.show(ui));
}

/// Lists facts about the preparation of the displayed record that raise no caution, such as an
/// input at its limit.
fn preparation_ui(ui: &mut Ui, page: Page<'_>) {
    let Page {
        records, palette, ..
    } = page;
    let Some(found) = page.current_identification() else {
        return;
    };
    for (record, record_use) in found.record_uses.iter().enumerate() {
        if records.row_of_record(record) == Some(records.chosen) {
            for fact in record_use.facts() {
                ui.label(palette.small(fact));
            }
        }
    }
}

/// Charts of a record, inputs before outputs, in two columns.
struct ChannelCharts<'a> {
    page: Page<'a>,
    flight: &'a Arc<FlightRecord>,
    models: &'a [Simulated<'a>],
    /// Marked time spans \[s\], the same in every chart.
    spans: &'a [ChartSpan],
}

impl ChannelCharts<'_> {
    fn show(&self, ui: &mut Ui) {
        let dataset = self.page.state.dataset();
        let count = dataset.inputs().len() + dataset.outputs().len();
        let rows = count.div_ceil(2).max(1);
        let height = ((ui.available_height() - 6.0) / rows as f32).max(LEAST_HEIGHT);
        let width = 0.5 * ui.available_width();
        let size = vec2(2.0 * width, height * rows as f32);
        let (area, _) = ui.allocate_exact_size(size, Sense::hover());
        for index in 0..count {
            // Fill the grid column by column, so that inputs come before outputs.
            let column = index / rows;
            let row = index % rows;
            let corner = area.min + vec2(column as f32 * width, row as f32 * height);
            let is_lowest = row + 1 == rows || index + 1 == count;
            let place = Rect::from_min_size(corner, vec2(width, height));
            self.channel_ui(ui, place, index, is_lowest);
        }
    }

    /// Draws the chart of a channel; `index` counts inputs, then outputs. The lowest chart of a
    /// column labels the time axis.
    fn channel_ui(&self, ui: &mut Ui, place: Rect, index: usize, is_lowest: bool) {
        let Page { state, palette, .. } = self.page;
        let dataset = state.dataset();
        let inputs = dataset.inputs();
        let output = index.checked_sub(inputs.len());
        let channel = match output {
            None => &inputs[index],
            Some(output) => &dataset.outputs()[output],
        };
        let title = format!("{} [{}]", channel.name, channel.unit);
        let across = if is_lowest { "time [s]" } else { "" };
        let mut chart = Chart::new(&title, ChartAxis::Linear, across, "");
        chart.group = Some(Page::time_axis());
        chart.fits_values = true;
        chart.chooses = state.records.chooses_parts;
        chart.spans = self.spans.to_vec();
        chart.lines = self.recorded_lines(ui, index, output);
        if let Some(output) = output {
            for model in self.models {
                chart.lines.extend(model.lines(ui, output));
                if let Some(fit) = model.fit_words(output) {
                    chart.notes.push((fit, model.color));
                }
            }
        }
        chart.notes.extend(self.caution_marks(&channel.name));
        chart_ui(ui, place, &chart, palette);
    }

    fn recorded_lines(&self, ui: &Ui, index: usize, output: Option<usize>) -> Vec<ChartLine> {
        let palette = self.page.palette;
        let color = if output.is_none() {
            palette.text
        } else {
            palette.identified
        };
        let flight = self.flight;
        let source = Arc::clone(flight) as _;
        let lines = cached(ui, &format!("channel {index}"), &[source], (), || {
            recorded_points(flight, index)
        });
        lines
            .iter()
            .map(|points| ChartLine {
                points: Arc::clone(points),
                color,
                width: 1.0,
                dashed: false,
            })
            .collect()
    }

    /// Returns short marks for the cautions about a channel, in the displayed record or in all
    /// records.
    fn caution_marks(&self, channel: &str) -> Vec<(String, Color32)> {
        let Page {
            records, palette, ..
        } = self.page;
        let mut marks = Vec::new();
        for (rows, note) in records.cautions() {
            let is_of_record = rows.is_empty() || rows.contains(&records.chosen);
            if is_of_record && note.channel.as_deref() == Some(channel) {
                marks.push((format!("⚠ {}", note.mark()), palette.warning));
            }
        }
        marks
    }
}

/// Returns the time \[s\] and value of a channel as lines, interrupted where samples are missing.
fn recorded_points(flight: &FlightRecord, index: usize) -> Vec<Arc<[[f64; 2]]>> {
    let inputs = flight.inputs.ncols();
    let mut points = Vec::with_capacity(flight.time_s.len());
    for (sample, &time_s) in flight.time_s.iter().enumerate() {
        let value = if index < inputs {
            flight.inputs[(sample, index)]
        } else {
            flight.outputs[(sample, index - inputs)]
        };
        points.push([time_s, value]);
    }
    points
        .split(|[time_s, value]| !time_s.is_finite() || !value.is_finite())
        .filter(|run| !run.is_empty())
        .map(Arc::from)
        .collect()
}

/// Lists the modes of the logging system in a line.
fn modes_ui(ui: &mut Ui, modes: &[ModeSpan], palette: &Palette) {
    if modes.is_empty() {
        return;
    }
    let mut words = Vec::new();
    for mode in modes {
        let [from, to] = mode.ends_s;
        words.push(format!("{} {from:.1} to {to:.1} s", mode.name));
    }
    let words = words.join(" · ");
    ui.add(Label::new(palette.small(&words)).truncate())
        .on_hover_text(words);
}
