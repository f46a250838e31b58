//! Every channel of a record over time.

use std::sync::Arc;

use egui::{Id, Rect, RichText, ScrollArea, Sense, Ui, vec2};

use crate::view::command::Command;
use crate::view::palette::Palette;
use crate::view::plot::{Chart, ChartAxis, ChartLine, ChartSpan, chart_ui};
use crate::view::state::State;
use gdcm_core::identification::{FlightRecord, Treatment};

use super::bench::ConditionRecords;
use super::kept::kept;
use super::simulation::{simulated, time_models_ui};

/// Least height of a chart \[pt\]; more of them scroll.
const LEAST_HEIGHT: f32 = 84.0;

/// A chart for each input and output, with the responses of models to the same inputs where those are asked for.
pub(super) fn histories_ui(
    ui: &mut Ui,
    state: &State,
    records: &ConditionRecords,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(row) = records.rows.get(records.chosen) else { return };
    let Some(flight) = &row.flight else {
        ui.label(RichText::new("Say first which columns are its channels: page Columns").color(palette.warning));
        return;
    };
    let dataset = state.dataset();
    let names =
        dataset.inputs().iter().chain(dataset.outputs()).map(|channel| format!("{} [{}]", channel.name, channel.unit));
    let names: Vec<String> = names.collect();
    let gaps = spans(records, palette);
    time_models_ui(ui, state, palette, commands);
    let models = simulated(state, palette);
    for model in &models {
        model.absence_ui(ui, state, palette);
    }
    ScrollArea::vertical().id_salt("histories").auto_shrink(false).show(ui, |ui| {
        let rows = names.len().div_ceil(2).max(1);
        let height = ((ui.available_height() - 6.0) / rows as f32).max(LEAST_HEIGHT);
        let width = 0.5 * ui.available_width();
        let area = ui.allocate_exact_size(vec2(2.0 * width, height * rows as f32), Sense::hover()).0;
        for (place, name) in names.iter().enumerate() {
            // Down the first column, then down the second: inputs stand before outputs.
            let (column, line) = (place / rows, place % rows);
            let corner = area.min + vec2(column as f32 * width, line as f32 * height);
            let is_last = line + 1 == rows || place + 1 == names.len();
            let mut chart = Chart::new(name, ChartAxis::Linear, if is_last { "time [s]" } else { "" }, "");
            chart.group = Some(Id::unique("flight record"));
            chart.fits_values = true;
            chart.spans.clone_from(&gaps);
            let color = if place < dataset.inputs().len() { palette.text } else { palette.identified };
            let points =
                kept(ui, &format!("channel {place}"), &[Arc::clone(flight) as _], (), || points_of(flight, place));
            let line =
                |points: &Arc<[[f64; 2]]>| ChartLine { points: Arc::clone(points), color, width: 1.0, dashed: false };
            chart.lines.extend(points.iter().map(line));
            if let Some(output) = place.checked_sub(dataset.inputs().len()) {
                chart.lines.extend(models.iter().flat_map(|model| model.lines(ui, output)));
                chart.notes.extend(models.iter().filter_map(|model| Some((model.fit_words(output)?, model.color))));
            }
            chart_ui(ui, Rect::from_min_size(corner, vec2(width, height)), &chart, palette);
        }
    });
}

/// The samples of a channel as unbroken lines: what is missing stays a gap.
fn points_of(flight: &FlightRecord, place: usize) -> Vec<Arc<[[f64; 2]]>> {
    let inputs = flight.inputs.ncols();
    let value = |sample: usize| match place.checked_sub(inputs) {
        None => flight.inputs[(sample, place)],
        Some(output) => flight.outputs[(sample, output)],
    };
    let points: Vec<[f64; 2]> = flight.time_s.iter().enumerate().map(|(at, time)| [*time, value(at)]).collect();
    let runs = points.split(|point| point.iter().any(|value| !value.is_finite()));
    runs.filter(|run| !run.is_empty()).map(Arc::from).collect()
}

/// What was bridged and what was cut out of the record shown.
fn spans(records: &ConditionRecords, palette: &Palette) -> Vec<ChartSpan> {
    let Some(found) = records.identification().filter(|_| !records.changed) else { return Vec::new() };
    let record = (0..found.record_uses.len()).find(|record| records.row_of_record(*record) == Some(records.chosen));
    let gaps = record.map_or(&[][..], |record| &found.record_uses[record].gaps);
    let span = |gap: &gdcm_core::identification::Gap| {
        let color = match gap.treatment {
            Treatment::Bridged => palette.accent.gamma_multiply(0.25),
            Treatment::CutOut => palette.warning.gamma_multiply(0.35),
        };
        ChartSpan { ends: [gap.start_s, gap.end_s], color }
    };
    gaps.iter().map(span).collect()
}
