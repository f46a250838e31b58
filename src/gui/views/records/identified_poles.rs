//! Identified poles: over the model order (stabilisation diagram), and in the s-plane. A pole that
//! stays where it is while the order grows is probably one of the aircraft, not of the noise.
//!
//! λ is a pole in rad/s. The records *determine* a pole if it is within the band and three of its
//! standard deviations are at most half its modulus.

use gdcm_model::response::pole_estimate::{POLE_INTERVAL, PoleEstimate};
use gdcm_sysid::identification::Identification;

use super::page::Page;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartMarks};
use crate::gui::widgets::palette::Palette;

/// Returns the stabilisation diagram: pole moduli over frequency, a row for each order. Crosses
/// mark poles that agree with a pole in the model whose order is lower by two.
pub(super) fn stabilisation_chart<'a>(
    page: Page<'_>,
    identification: &Identification,
    across: &'a str,
) -> Chart<'a> {
    let Page {
        state,
        records,
        palette,
    } = page;
    let unit = state.display.curves.unit;
    let axis = ChartAxis::Frequency(unit);
    let mut chart = Chart::new("Stabilisation diagram: |λ|", axis, across, "order");
    if let Some(latest) = &records.latest {
        chart.band_ends = Some(latest.job.request.options.band);
    }
    for mark in records.marks("order-limit") {
        chart.notes.push((mark, palette.warning));
    }
    let note = "×: within 5 % of a pole two orders lower".to_owned();
    chart.notes.push((note, palette.dim_text));
    for is_stable in [false, true] {
        chart
            .marks
            .push(stabilisation_marks(identification, is_stable, palette));
    }
    chart
}

/// Returns the nonzero poles that agree with a pole in the lower-order model, or those that do not.
fn stabilisation_marks(
    identification: &Identification,
    is_stable: bool,
    palette: &Palette,
) -> ChartMarks {
    let mut points = Vec::new();
    for point in &identification.stabilisation {
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

/// Returns the chart with the poles in the s-plane; those that the records determine have error
/// bars.
pub(super) fn poles_chart<'a>(page: Page<'_>, identification: &Identification) -> Chart<'a> {
    let Page {
        records, palette, ..
    } = page;
    let mut chart = Chart::new(
        "Identified poles ± 3 σ",
        ChartAxis::Linear,
        "Re λ [rad/s]",
        "Im λ [rad/s]",
    );
    for mark in records.marks("unstable") {
        chart.notes.push((mark, palette.warning));
    }
    let note = "grey: not determined".to_owned();
    chart.notes.push((note, palette.dim_text));
    add_poles(&mut chart, &identification.poles, palette);
    chart
}

/// Adds the poles and the imaginary axis to a chart.
pub(super) fn add_poles(chart: &mut Chart<'_>, poles: &[PoleEstimate], palette: &Palette) {
    chart.verticals = vec![0.0];
    for is_determined in [false, true] {
        chart.marks.push(pole_marks(poles, is_determined, palette));
    }
}

/// Returns the poles that the records determine, with their intervals, or those that they do not
/// determine, without intervals, which would hide other poles.
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
