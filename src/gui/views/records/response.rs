//! Charts of the response in focus: measured points, identified model with its confidence band,
//! physics and corrected models; below, partial coherence and phase residual.
//!
//! The *band* alone is the identification's frequency band, the *confidence band* the 95 % interval
//! about the identified curve. A measured point is *trusted* if its partial coherence and its
//! frequency resolution suffice (`drawn_response.rs`). The *phase residual* is the measured phase
//! minus the identified model's, in standard deviations of the measured point.
//!
//! `response_marks` has the lines, bands and points of magnitude and phase, `response_cautions` the
//! cautions about the response.

use std::sync::Arc;

use egui::{Align2, Color32, Id, Rect, Role as WidgetRole, Sense, Ui, pos2};

use gdcm_plot::figure::Range;
use gdcm_sysid::identification::TRUSTED_COHERENCE;

use super::drawn_response::{BodePart, DrawnResponse, Measurement};
use super::fit_layout::{CaptionedChart, ResponseLayout, TICKS};
use super::frame_cache::cached;
use super::page::Page;
use super::response_cautions::{doubtful_ranges, short_cautions};
use super::response_marks::{add_identified, line_points, measured_marks};
use super::value_range::rounded_range;
use crate::gui::plot::BodeCurve;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartLayout, ChartLine, ChartMarks, ChartSpan};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::state::records::TimeRole;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::elision::{elided, text_width};
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{BODY_SIZE, SMALL_SIZE, medium, small};

/// Substitute band \[rad/s\] if no identification has run.
const UNKNOWN_BAND: [f64; 2] = [0.1, 10.0];
/// Value axis width \[pt\].
const VALUE_AXIS: f32 = 40.0;
/// Factors by which the visible frequencies extend beyond the band at its lower and upper end.
const BEYOND: [f64; 2] = [1.4, 1.7];
/// Upper end of the coherence axis: slightly above 1, so that a line at 1 is not at the frame.
const HIGHEST_COHERENCE: f64 = 1.08;
/// Half-width of the shaded tolerance in the phase-residual chart, in standard deviations: 19
/// of 20 residuals are inside if they are only noise.
const RESIDUAL_TOLERANCE: f64 = 2.0;
/// Smallest and largest end of the phase-residual axis, in standard deviations; the axis ends at
/// the largest trusted residual between them.
const RESIDUAL_LIMITS: [f64; 2] = [4.0, 10.0];
/// Share of the curves' range within the band by which error bars may extend the axis.
const MOST_EXTENSION: f64 = 0.3;

/// Draws the response in focus; `curves` are those from `plain_curves`.
///
/// 1. Heading: the name at the left, short cautions at the right, an explanation of confidence band
///    and error bars between them.
/// 2. Without a response, the reason instead of the charts.
/// 3. Magnitude and phase: models (physics, corrected), identified curve with its 95 % band, strips
///    along it where it deviates from the measured points or was not excited, measured points with
///    error bars (hollow if not trusted).
/// 4. Partial coherence; in a high window, also the phase residual.
pub(super) fn response_ui(
    ui: &mut Ui,
    page: Page<'_>,
    curves: &[BodeCurve],
    heading: Rect,
    layout: &ResponseLayout,
) {
    let Page { state, palette, .. } = page;
    let name = state.dataset().pair_name(state.display.selection.pair);
    // Step 1, left; the cautions and the explanation follow once there is a response.
    let title = format!("Response {name}");
    let shown = painted_text(ui, heading, 0.0, &title, medium(BODY_SIZE), palette.text);
    // Step 2.
    let Some(drawn) = drawn_response(ui, page) else {
        empty_ui(ui, page, layout);
        return;
    };
    // Step 1, right and middle.
    let mut right = heading.right();
    for caution in short_cautions(page).iter().rev() {
        let text = format!("⚠ {caution}");
        right -= text_width(ui, &text, small());
        let x = right - heading.left();
        painted_text(ui, heading, x, &text, small(), palette.warning);
        right -= 10.0;
    }
    let words = heading_words(&drawn);
    let from = shown.right() - heading.left() + 10.0;
    let words = elided(ui, &words, right - heading.left() - from, SMALL_SIZE);
    painted_text(ui, heading, from, &words, small(), palette.dim_text);
    let charts = ResponseCharts {
        page,
        drawn: &drawn,
        curves,
        name: &name,
        band: job_band(page),
    };
    // Step 3.
    charts.bode_ui(ui, layout.magnitude, BodePart::Magnitude);
    charts.bode_ui(ui, layout.phase, BodePart::Phase);
    // Step 4.
    charts.coherence_ui(ui, layout.coherence);
    if let Some(place) = layout.residual {
        charts.residual_ui(ui, place);
    }
}

/// Returns a text that explains confidence band and error bars.
fn heading_words(drawn: &DrawnResponse) -> String {
    if drawn.refined.is_empty() {
        return "first model, being refined".to_owned();
    }
    let mut words = "identified with 95 % band, measured ± 1.96 σ".to_owned();
    if drawn.has_cut_bars() {
        words.push_str(", cut at ± 20 dB and ± 180°");
    }
    if !drawn.unexcited.is_empty() {
        words.push_str("; grey: not excited by the reference");
    }
    words
}

/// Draws the reason why there is no response.
fn empty_ui(ui: &Ui, page: Page<'_>, layout: &ResponseLayout) {
    let Page { state, palette, .. } = page;
    let text = if state.records.job_of(state.condition().id()).is_some() {
        "Identification in progress: the first model appears here"
    } else {
        match &page.records.latest {
            Some(latest) if latest.outcome.is_err() => {
                "The identification failed: the reason is at the right"
            }
            _ => "No identification yet: choose Identify for the measured response and the models",
        }
    };
    let area = layout
        .magnitude
        .caption
        .union(layout.phase.chart)
        .union(layout.coherence.chart);
    ui.painter().text(
        area.center(),
        Align2::CENTER_CENTER,
        text,
        small(),
        palette.dim_text,
    );
    let response = ui.interact(area, ui.scope_id().with("no response"), Sense::hover());
    named(response, WidgetRole::Label, text);
}

/// Returns the curves for the response in focus: from the first model while it is refined,
/// otherwise from the finished identification, if any.
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
    let identification = records.identification()?;
    let measurement = match &records.latest {
        Some(latest) => Measurement {
            band: latest.job.request.options.band,
            uses_references: latest.job.request.options.references > 0,
        },
        None => Measurement {
            band: UNKNOWN_BAND,
            uses_references: false,
        },
    };
    let source = Arc::clone(identification) as _;
    Some(cached(ui, "response", &[source], pair, || {
        DrawnResponse::new(identification, measurement, pair)
    }))
}

/// Returns the band \[rad/s\] of the running or waiting identification, otherwise of the finished
/// one; `UNKNOWN_BAND` without either.
fn job_band(page: Page<'_>) -> [f64; 2] {
    let Page { state, records, .. } = page;
    if let Some(job) = state.records.job_of(state.condition().id()) {
        return job.request.options.band;
    }
    match &records.latest {
        Some(latest) => latest.job.request.options.band,
        None => UNKNOWN_BAND,
    }
}

struct ResponseCharts<'a> {
    page: Page<'a>,
    drawn: &'a DrawnResponse,
    /// Curves from which those of the physics representative and its corrections are taken.
    curves: &'a [BodeCurve],
    name: &'a str,
    /// Identification band \[rad/s\].
    band: [f64; 2],
}

impl ResponseCharts<'_> {
    /// Returns an empty chart over the frequencies that all charts share.
    fn chart<'c>(&self, title: &'c str, place: CaptionedChart, values: Range) -> Chart<'c> {
        let unit = self.page.state.display.curves.unit;
        let mut chart = Chart::new(title, ChartAxis::Frequency(unit), "", "");
        let band_bits = self.band.map(f64::to_bits);
        chart.group = Some(Id::unique(("identified response", band_bits)));
        chart.fits_values = true;
        chart.values = Some(values);
        let [low, high] = self.band;
        chart.whole_across = Some(Range::new(low / BEYOND[0], high * BEYOND[1]));
        chart.layout = ChartLayout {
            title_height: 0.0,
            value_axis_width: VALUE_AXIS,
            right_margin: 2.0,
            has_ticks_across: place.has_ticks,
        };
        chart.band_ends = Some(self.band);
        chart.spans = self.caution_spans();
        chart
    }

    /// Draws a chart below its caption; if it has tick labels, with the frequency unit at its lower
    /// left corner.
    fn show(&self, ui: &mut Ui, place: CaptionedChart, caption: [&str; 2], chart: &Chart<'_>) {
        let palette = self.page.palette;
        let frame = *chart_ui(ui, place.chart, chart, palette).transform.frame();
        let line = place.caption.with_min_x(frame.left());
        let [quantity, unit] = caption;
        let shown = painted_text(ui, line, 0.0, quantity, small(), palette.text);
        let x = shown.right() - line.left() + 5.0;
        painted_text(ui, line, x, unit, small(), palette.dim_text);
        if place.has_ticks {
            let at = pos2(frame.left() - 6.0, place.chart.bottom() - 0.5 * TICKS);
            let unit = self.page.state.display.curves.unit.symbol();
            let color = palette.dim_text;
            ui.painter()
                .text(at, Align2::RIGHT_CENTER, unit, small(), color);
        }
    }

    fn bode_ui(&self, ui: &mut Ui, place: CaptionedChart, part: BodePart) {
        let palette = self.page.palette;
        let caption = match part {
            BodePart::Magnitude => ["Magnitude", "dB"],
            BodePart::Phase => ["Phase", "deg"],
        };
        let title = format!("{}: {}", self.name, caption[0].to_lowercase());
        let models = self.model_lines(part);
        let values = self.value_range(part, &models);
        let mut chart = self.chart(&title, place, values);
        if part == BodePart::Magnitude {
            chart.notes = self.notes();
        }
        chart.lines.extend(models);
        add_identified(&mut chart, self.drawn, part, self.page);
        if self.is_shown(TimeRole::Measured) {
            for is_trusted in [false, true] {
                chart
                    .marks
                    .push(measured_marks(self.drawn, part, is_trusted, palette));
            }
        }
        self.show(ui, place, caption, &chart);
    }

    /// Returns the notes in the accessible name: short cautions about the response.
    fn notes(&self) -> Vec<(String, Color32)> {
        let mut notes = Vec::new();
        for caution in short_cautions(self.page) {
            notes.push((format!("⚠ {caution}"), self.page.palette.warning));
        }
        notes
    }

    fn is_shown(&self, role: TimeRole) -> bool {
        !self.page.state.records.hidden_roles.contains(&role)
    }

    /// Returns the curves of the physics representative and its corrections.
    fn model_lines(&self, part: BodePart) -> Vec<ChartLine> {
        let mut lines = Vec::new();
        for role in [TimeRole::Physics, TimeRole::Corrected, TimeRole::Scheduled] {
            let bode_role = role.bode_role();
            let curve = self
                .curves
                .iter()
                .find(|curve| Some(curve.role) == bode_role);
            if let Some(curve) = curve
                && self.is_shown(role)
            {
                let points = line_points(&self.drawn.aligned(curve), part);
                lines.push(ChartLine::styled(points, role.style(self.page.palette)));
            }
        }
        lines
    }

    /// Returns the value range within the band: of models, identified curve and trusted points;
    /// bars of trusted points extend it by at most [`MOST_EXTENSION`]. Then rounded; ± 1 without
    /// values.
    fn value_range(&self, part: BodePart, models: &[ChartLine]) -> Range {
        let [low, high] = self.band;
        let is_inside = |omega: f64| (low..=high).contains(&omega);
        let mut values = Vec::new();
        for line in models {
            values.extend(
                line.points
                    .iter()
                    .filter(|point| is_inside(point[0]))
                    .map(|point| point[1]),
            );
        }
        for curve in [&self.drawn.refined, &self.drawn.first] {
            for point in curve {
                if is_inside(point.omega) {
                    values.push(point.place(part)[1]);
                }
            }
        }
        let mut bars = Vec::new();
        for measured in &self.drawn.measured {
            if measured.is_trusted && is_inside(measured.point.omega) {
                let value = measured.point.place(part)[1];
                let half = part.drawn_half_interval(measured.sd);
                values.push(value);
                bars.extend([value - half, value + half]);
            }
        }
        let Some(curves) = Range::spanning(values) else {
            return Range::new(-1.0, 1.0);
        };
        let most = MOST_EXTENSION * curves.width();
        let mut range = curves;
        for bar in bars {
            range = range.including(bar.clamp(curves.min - most, curves.max + most));
        }
        rounded_range(range)
    }

    fn coherence_ui(&self, ui: &mut Ui, place: CaptionedChart) {
        let palette = self.page.palette;
        let title = format!("{}: partial coherence", self.name);
        let mut chart = self.chart(&title, place, Range::new(0.0, HIGHEST_COHERENCE));
        chart.levels = vec![TRUSTED_COHERENCE];
        let points: Vec<[f64; 2]> = self
            .drawn
            .measured
            .iter()
            .map(|measured| [measured.point.omega, measured.coherence])
            .collect();
        chart.lines.push(ChartLine {
            points: points.into(),
            color: palette.text,
            width: 1.3,
            dash: None,
        });
        let caption = ["Partial coherence", "below 0.6, the points are hollow"];
        self.show(ui, place, caption, &chart);
    }

    fn residual_ui(&self, ui: &mut Ui, place: CaptionedChart) {
        let palette = self.page.palette;
        let title = format!("{}: phase residual", self.name);
        let mut points = Vec::new();
        let mut largest = 0.0f64;
        for measured in &self.drawn.measured {
            if let Some(residual) = measured.phase_residual {
                points.push([measured.point.omega, residual, 0.0]);
                if measured.is_trusted {
                    largest = largest.max(residual.abs());
                }
            }
        }
        let [least, most] = RESIDUAL_LIMITS;
        let half = largest.clamp(least, most);
        let mut chart = self.chart(&title, place, Range::new(-half, half));
        chart.tolerance = Some(ChartSpan {
            ends: [-RESIDUAL_TOLERANCE, RESIDUAL_TOLERANCE],
            color: palette.text.gamma_multiply(0.08),
        });
        chart.marks.push(ChartMarks {
            points,
            sideways: Vec::new(),
            color: palette.text,
            filled: true,
            crosses: false,
        });
        self.show(ui, place, ["Phase residual", "in σ, band ± 2"], &chart);
    }

    /// Returns the frequency ranges that cautions call doubtful: short records, a narrowed band.
    fn caution_spans(&self) -> Vec<ChartSpan> {
        let Page {
            records, palette, ..
        } = self.page;
        let mut spans = Vec::new();
        for (_, note) in records.cautions() {
            for ends in doubtful_ranges(&note, self.band) {
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
}
