//! Page with the measured response and the identified models, as a Bode plot. `drawn_response`
//! computes the curves.

use std::sync::Arc;

use egui::{Color32, Id, Rect, RichText, Sense, Ui, vec2};

use gdcm_sysid::identification::CautionNote;

use super::drawn_response::{BodePart, CurvePoint, DrawnResponse, MeasuredBand};
use super::frame_cache::cached;
use super::page::Page;
use super::response_legend::legend_ui;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartBand, ChartLine, ChartMarks, ChartSpan};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::widgets::palette::Palette;

/// Substitute band \[rad/s\] for an identification without a job.
const UNKNOWN_BAND: [f64; 2] = [0.1, 10.0];
/// Half-height of the marks along the curve of the recommended model \[dB\] and \[deg\].
const MARK_DB: f64 = 2.0;
const MARK_DEG: f64 = 15.0;

/// Draws the Bode plot of the identified response; during refinement, of the first model.
pub(super) fn response_ui(ui: &mut Ui, page: Page<'_>) {
    let Page { state, palette, .. } = page;
    let Some(drawn) = drawn_response(ui, page) else {
        let text = "No identification yet: choose Identify above. This page then shows the \
                    measured response, the models and their bands.";
        ui.label(RichText::new(text).color(palette.dim_text));
        return;
    };
    legend_ui(ui, &drawn, palette);
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, Sense::hover());
    let name = state.dataset().pair_name(state.display.selection.pair);
    let size = vec2(area.width(), 0.5 * area.height());

    let title = format!("{name}: magnitude");
    let mut magnitude = Chart::new(&title, frequency_axis(page), "", "Magnitude [dB]");
    add_response(&mut magnitude, &drawn, BodePart::Magnitude, palette);
    for mark in caution_marks(page) {
        magnitude.notes.push((format!("⚠ {mark}"), palette.warning));
    }
    magnitude.spans.extend(caution_spans(page));
    let place = Rect::from_min_size(area.min, size);
    chart_ui(ui, place, &magnitude, palette);

    let title = format!("{name}: phase");
    let across = state.display.curves.unit.axis_label();
    let mut phase = Chart::new(&title, frequency_axis(page), &across, "Phase [deg]");
    add_response(&mut phase, &drawn, BodePart::Phase, palette);
    phase.spans.extend(caution_spans(page));
    let place = Rect::from_min_size(area.min + vec2(0.0, size.y), size);
    chart_ui(ui, place, &phase, palette);
}

/// Returns the curves of the pair in focus: of the first model while it is refined, otherwise of
/// the finished identification, if any.
fn drawn_response(ui: &Ui, page: Page<'_>) -> Option<Arc<DrawnResponse>> {
    let Page { state, records, .. } = page;
    let pair = state.display.selection.pair;
    if let Some(job) = state.records.job_of(state.condition().id())
        && let Some(model) = job.news().first_model
    {
        let band = job.request.options.band;
        let source = Arc::clone(&model) as _;
        return Some(cached(ui, "first model", &[source], pair, || {
            DrawnResponse::first_model(&model, band, pair)
        }));
    }
    let found = records.identification()?;
    let measured_band = match &records.found {
        Some((job, _)) => MeasuredBand {
            band: job.request.options.band,
            by_reference: job.request.options.references > 0,
        },
        None => MeasuredBand {
            band: UNKNOWN_BAND,
            by_reference: false,
        },
    };
    let source = Arc::clone(found) as _;
    Some(cached(ui, "response", &[source], pair, || {
        DrawnResponse::new(found, measured_band, pair)
    }))
}

fn frequency_axis(page: Page<'_>) -> ChartAxis {
    ChartAxis::Frequency(page.state.display.curves.unit)
}

/// Returns short marks for the cautions about the displayed response: about its pair, its input or
/// output, or all responses.
fn caution_marks(page: Page<'_>) -> Vec<&'static str> {
    let dataset = page.state.dataset();
    let pair = page.state.display.selection.pair;
    let output = &dataset.outputs()[pair.output].name;
    let input = &dataset.inputs()[pair.input].name;
    let mut marks = Vec::new();
    for (_, note) in page.records.cautions() {
        let is_concerned = match (&note.pair, &note.channel) {
            (Some(names), _) => names[0] == *output && names[1] == *input,
            (None, Some(channel)) => {
                note.records.is_empty() && (channel == output || channel == input)
            }
            (None, None) => note.code.starts_with("feedback") || note.code == "band-narrowed",
        };
        if is_concerned {
            marks.push(note.mark());
        }
    }
    marks
}

/// Returns the frequency intervals to which cautions about all responses refer.
fn caution_spans(page: Page<'_>) -> Vec<ChartSpan> {
    let Page {
        records, palette, ..
    } = page;
    let band = match &records.found {
        Some((job, _)) => job.request.options.band,
        None => [0.0; 2],
    };
    let mut spans = Vec::new();
    for (_, note) in records.cautions() {
        for ends in doubtful_intervals(&note, band) {
            if ends[0] < ends[1] {
                spans.push(ChartSpan {
                    ends,
                    color: palette.warning.gamma_multiply(0.1),
                });
            }
        }
    }
    spans
}

/// Returns the intervals \[rad/s\] to which a caution refers: the lower end of the band for short
/// records, or the ends of `band` that no input excites.
fn doubtful_intervals(note: &CautionNote, band: [f64; 2]) -> Vec<[f64; 2]> {
    match (note.code, note.band_rad_s) {
        ("short", Some(ends)) => vec![ends],
        ("band-narrowed", Some([low, high])) => vec![[band[0], low], [high, band[1]]],
        _ => Vec::new(),
    }
}

/// Adds the curves, bands and points of a response to a chart.
fn add_response(chart: &mut Chart<'_>, drawn: &DrawnResponse, part: BodePart, palette: &Palette) {
    chart.group = Some(Id::unique("identified response"));
    chart.bands.push(confidence_band(drawn, part, palette));
    chart.lines.push(ChartLine {
        points: line_points(&drawn.unrefined, part),
        color: palette.accent,
        width: 1.2,
        dashed: true,
    });
    chart.lines.push(ChartLine {
        points: line_points(&drawn.recommended, part),
        color: palette.identified,
        width: 2.0,
        dashed: false,
    });
    for interval in &drawn.deviating {
        chart
            .bands
            .push(interval_mark(drawn, *interval, part, palette.warning));
    }
    for interval in &drawn.unexcited {
        chart
            .bands
            .push(interval_mark(drawn, *interval, part, palette.dim_text));
    }
    for is_trusted in [false, true] {
        chart
            .marks
            .push(measured_marks(drawn, part, is_trusted, palette));
    }
}

/// Returns the 95 % band about the recommended curve.
fn confidence_band(drawn: &DrawnResponse, part: BodePart, palette: &Palette) -> ChartBand {
    let mut points = Vec::new();
    for (point, sd) in drawn.recommended.iter().zip(&drawn.recommended_sds) {
        let [omega, value] = point.place(part);
        let half = part.drawn_half_interval(*sd);
        points.push([omega, value - half, value + half]);
    }
    ChartBand {
        points,
        color: palette.identified.gamma_multiply(0.28),
    }
}

fn line_points(curve: &[CurvePoint], part: BodePart) -> Arc<[[f64; 2]]> {
    curve.iter().map(|point| point.place(part)).collect()
}

/// Returns a strip along the recommended curve within an interval \[rad/s\].
fn interval_mark(
    drawn: &DrawnResponse,
    interval: [f64; 2],
    part: BodePart,
    color: Color32,
) -> ChartBand {
    let half = match part {
        BodePart::Magnitude => MARK_DB,
        BodePart::Phase => MARK_DEG,
    };
    let mut points = Vec::new();
    for point in &drawn.recommended {
        if (interval[0]..=interval[1]).contains(&point.omega) {
            let [omega, value] = point.place(part);
            points.push([omega, value - half, value + half]);
        }
    }
    ChartBand {
        points,
        color: color.gamma_multiply(0.25),
    }
}

/// Returns the measured points with their 95 % intervals; trusted points are filled.
fn measured_marks(
    drawn: &DrawnResponse,
    part: BodePart,
    is_trusted: bool,
    palette: &Palette,
) -> ChartMarks {
    let mut points = Vec::new();
    for measured in &drawn.measured {
        if measured.is_trusted == is_trusted {
            let [omega, value] = measured.point.place(part);
            points.push([omega, value, part.half_interval(measured.sd)]);
        }
    }
    ChartMarks {
        points,
        sideways: Vec::new(),
        color: if is_trusted {
            palette.text
        } else {
            palette.dim_text
        },
        filled: is_trusted,
        crosses: false,
    }
}
