//! Lines, bands and points of an identified response in a Bode chart.

use std::sync::Arc;

use egui::Color32;

use super::drawn_response::{BodePart, CurvePoint, DrawnResponse};
use super::page::Page;
use crate::gui::plot::chart::{Chart, ChartArea, ChartLine, ChartMarks, DENSE_DASH};
use crate::gui::state::records::TimeRole;
use crate::gui::widgets::palette::Palette;

/// Half-height of strips along the identified magnitude curve \[dB\].
const STRIP_DB: f64 = 2.0;
/// Half-height of strips along the identified phase curve \[deg\].
const STRIP_DEG: f64 = 15.0;

/// Adds the identified model's curve and confidence band to a chart, unless its role is hidden: the
/// refined model, or dashed the first one while it is refined. The strips along the curve always
/// remain.
pub(super) fn add_identified(
    chart: &mut Chart<'_>,
    drawn: &DrawnResponse,
    part: BodePart,
    page: Page<'_>,
) {
    let palette = page.palette;
    if !page
        .state
        .records
        .hidden_roles
        .contains(&TimeRole::Identified)
    {
        chart.areas.push(confidence_band(drawn, part, palette));
        let is_refined = !drawn.refined.is_empty();
        let curve = if is_refined {
            &drawn.refined
        } else {
            &drawn.first
        };
        let style = TimeRole::Identified.style(palette);
        chart.lines.push(ChartLine {
            dash: if is_refined { None } else { Some(DENSE_DASH) },
            ..ChartLine::styled(line_points(curve, part), style)
        });
    }
    for range in &drawn.deviating {
        chart
            .areas
            .push(strip_within(drawn, *range, part, palette.warning));
    }
    for range in &drawn.unexcited {
        chart
            .areas
            .push(strip_within(drawn, *range, part, palette.dim_text));
    }
}

/// Returns the 95 % confidence band about the refined curve.
fn confidence_band(drawn: &DrawnResponse, part: BodePart, palette: &Palette) -> ChartArea {
    let mut points = Vec::new();
    for (point, sd) in drawn.refined_with_sd.iter().zip(&drawn.refined_sds) {
        let [omega, value] = point.place(part);
        let half = part.drawn_half_interval(*sd);
        points.push([omega, value - half, value + half]);
    }
    ChartArea {
        points,
        color: palette.identified.gamma_multiply(0.28),
    }
}

pub(super) fn line_points(curve: &[CurvePoint], part: BodePart) -> Arc<[[f64; 2]]> {
    curve.iter().map(|point| point.place(part)).collect()
}

/// Returns a strip along the refined curve within a frequency range \[rad/s\].
fn strip_within(
    drawn: &DrawnResponse,
    range: [f64; 2],
    part: BodePart,
    color: Color32,
) -> ChartArea {
    let half = match part {
        BodePart::Magnitude => STRIP_DB,
        BodePart::Phase => STRIP_DEG,
    };
    let mut points = Vec::new();
    for point in &drawn.refined_with_sd {
        if (range[0]..=range[1]).contains(&point.omega) {
            let [omega, value] = point.place(part);
            points.push([omega, value - half, value + half]);
        }
    }
    ChartArea {
        points,
        color: color.gamma_multiply(0.25),
    }
}

/// Returns the trusted points (filled) or the other measured points, with their 95 % intervals.
pub(super) fn measured_marks(
    drawn: &DrawnResponse,
    part: BodePart,
    is_trusted: bool,
    palette: &Palette,
) -> ChartMarks {
    let mut points = Vec::new();
    for measured in &drawn.measured {
        if measured.is_trusted == is_trusted {
            let [omega, value] = measured.point.place(part);
            points.push([omega, value, part.drawn_half_interval(measured.sd)]);
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
