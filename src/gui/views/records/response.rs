//! The measured response with the identified models, as a Bode plot.

use std::sync::Arc;

use egui::{Color32, Id, Rect, RichText, Role, Sense, Shape, Stroke, Ui, vec2};

use gdcm_sysid::identification::CautionNote;

use super::drawn_response::{BodePart, CurvePoint, DrawnResponse, MeasuredBand};
use super::frame_cache::cached;
use super::page::Page;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartBand, ChartLine, ChartMarks, ChartSpan};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::elision::text_width;
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{Palette, small};

/// Substitute band \[rad/s\] for an identification without a job.
const UNKNOWN_BAND: [f64; 2] = [0.1, 10.0];
/// Half-height of the marks along the curve of the recommended model.
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

/// Length of a line sample in the legend \[pt\].
const SAMPLE: f32 = 18.0;

struct LegendEntry {
    sample: Sample,
    text: &'static str,
    color: Color32,
}

fn legend_ui(ui: &mut Ui, drawn: &DrawnResponse, palette: &Palette) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 14.0;
        for entry in legend_entries(drawn, palette) {
            entry.show(ui, palette);
        }
        if drawn.has_cut_intervals() {
            ui.label(palette.small("bars and bands are cut at ± 20 dB and ± 180°"));
        }
    });
}

fn legend_entries(drawn: &DrawnResponse, palette: &Palette) -> Vec<LegendEntry> {
    let mut entries = vec![
        LegendEntry {
            sample: Sample::Line,
            text: "CT-PBSID, refined, with its 95 % band",
            color: palette.identified,
        },
        LegendEntry {
            sample: Sample::DashedLine,
            text: "CT-PBSID",
            color: palette.accent,
        },
        LegendEntry {
            sample: Sample::Dot,
            text: "measured (local polynomial), ± 1.96 sd",
            color: palette.text,
        },
        LegendEntry {
            sample: Sample::Circle,
            text: "partial coherence below 0.6, or few spectral lines",
            color: palette.dim_text,
        },
    ];
    if !drawn.unexcited.is_empty() {
        entries.push(LegendEntry {
            sample: Sample::Bar,
            text: "not excited by the reference",
            color: palette.dim_text,
        });
    }
    entries
}

impl LegendEntry {
    /// Draws the sample and the label on the same line.
    fn show(&self, ui: &mut Ui, palette: &Palette) {
        let words = text_width(ui, self.text, small());
        let (rect, response) =
            ui.allocate_exact_size(vec2(SAMPLE + 4.0 + words, 14.0), Sense::hover());
        let sample = rect.with_max_x(rect.left() + SAMPLE);
        self.sample.paint(ui, sample, self.color);
        painted_text(ui, rect, SAMPLE + 4.0, self.text, small(), palette.dim_text);
        named(response, Role::Label, self.text);
    }
}

/// Line or point drawn before a legend label.
#[derive(Clone, Copy)]
enum Sample {
    Line,
    DashedLine,
    Dot,
    Circle,
    Bar,
}

impl Sample {
    fn paint(self, ui: &Ui, rect: Rect, color: Color32) {
        let painter = ui.painter();
        let ends = [rect.left_center(), rect.right_center()];
        match self {
            Self::Line => {
                painter.line_segment(ends, Stroke::new(2.0, color));
            }
            Self::DashedLine => {
                painter.extend(Shape::dashed_line(&ends, Stroke::new(1.2, color), 4.0, 3.0));
            }
            Self::Dot => {
                painter.circle_filled(rect.center(), 3.0, color);
            }
            Self::Circle => {
                painter.circle_stroke(rect.center(), 3.0, Stroke::new(1.0, color));
            }
            Self::Bar => {
                let bar = rect.shrink2(vec2(0.0, 4.0));
                painter.rect_filled(bar, 0.0, color.gamma_multiply(0.25));
            }
        }
    }
}
