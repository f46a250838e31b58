//! Identified poles: over the model order, and in the s-plane.

use egui::{Sense, Ui};

use gdcm_model::response::pole_estimate::{POLE_INTERVAL, PoleEstimate};
use gdcm_sysid::identification::Identification;

use super::page::Page;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartMarks};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::widgets::palette::Palette;

/// Shows pole moduli over frequency, a row for each order. Crosses mark poles that agree with a
/// pole of the model whose order is lower by two.
pub(super) fn stabilisation_ui(ui: &mut Ui, page: Page<'_>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let Some(found) = page.identification_ui(ui) else {
        return;
    };
    ui.label(palette.small(
        "Cross: within 5 % of a pole of the model whose order is lower by two. Circle: no such \
        pole. Dotted line: band.",
    ));
    let unit = state.display.curves.unit;
    let across = unit.axis_label();
    let title = "Stabilisation diagram: |λ| of the models of every order, at the best Laguerre \
                 pole and past window";
    let mut chart = Chart::new(title, ChartAxis::Frequency(unit), &across, "order");
    if let Some((job, _)) = &records.found {
        chart.verticals.extend(job.request.options.band);
    }
    for mark in records.marks("order-limit") {
        chart.notes.push((mark, palette.warning));
    }
    for is_stable in [false, true] {
        chart
            .marks
            .push(stabilisation_marks(found, is_stable, palette));
    }
    fill_with_chart(ui, &chart, palette);
}

/// Returns the nonzero poles that agree with a pole of the lower-order model, or the poles that do
/// not.
fn stabilisation_marks(found: &Identification, is_stable: bool, palette: &Palette) -> ChartMarks {
    let mut points = Vec::new();
    for point in &found.stabilisation {
        let modulus = point.pole.norm();
        if point.stable == is_stable && modulus > 0.0 {
            points.push([modulus, point.order as f64, 0.0]);
        }
    }
    ChartMarks {
        points,
        sideways: Vec::new(),
        color: if is_stable {
            palette.perturbed
        } else {
            palette.dim_text
        },
        filled: false,
        crosses: is_stable,
    }
}

/// Shows the poles in the s-plane, each with an error bar.
pub(super) fn identified_poles_ui(ui: &mut Ui, page: Page<'_>) {
    let Page {
        records, palette, ..
    } = page;
    let Some(found) = page.identification_ui(ui) else {
        return;
    };
    ui.label(palette.small(
        "± 3 standard deviations, approximate. Grey: below the band, or not determined by these \
        records.",
    ));
    let mut chart = Chart::new(
        "Poles of CT-PBSID, refined",
        ChartAxis::Linear,
        "Re λ [rad/s]",
        "Im λ [rad/s]",
    );
    chart.verticals = vec![0.0];
    for mark in records.marks("unstable") {
        chart.notes.push((mark, palette.warning));
    }
    for is_determined in [false, true] {
        chart
            .marks
            .push(pole_marks(&found.poles, is_determined, palette));
    }
    fill_with_chart(ui, &chart, palette);
}

/// Returns the poles with their intervals. Poles that the records do not determine have no
/// interval, because it would hide other poles.
fn pole_marks(poles: &[PoleEstimate], is_determined: bool, palette: &Palette) -> ChartMarks {
    let mut points = Vec::new();
    let mut sideways = Vec::new();
    for estimate in poles {
        if estimate.determined != is_determined {
            continue;
        }
        let mut half_re = 0.0;
        let mut half_im = 0.0;
        if is_determined {
            half_re = POLE_INTERVAL * estimate.sd_re;
            half_im = POLE_INTERVAL * estimate.sd_im;
        }
        points.push([estimate.pole.re, estimate.pole.im, half_im]);
        sideways.push(half_re);
    }
    ChartMarks {
        points,
        sideways,
        color: if is_determined {
            palette.identified
        } else {
            palette.dim_text
        },
        filled: false,
        crosses: true,
    }
}

/// Draws a chart in the available space.
fn fill_with_chart(ui: &mut Ui, chart: &Chart<'_>, palette: &Palette) {
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, Sense::hover());
    chart_ui(ui, area, chart, palette);
}
