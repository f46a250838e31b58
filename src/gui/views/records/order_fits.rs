//! Fit over the model order: χ²/dof for the fitted and for the held-out records.

use std::sync::Arc;

use gdcm_sysid::identification::{Identification, OrderFit};

use crate::gui::plot::chart::{Chart, ChartAxis, ChartLine, ChartMarks, DENSE_DASH};
use crate::gui::widgets::palette::Palette;

/// Returns the chart with χ²/dof over the order, with the chosen order marked.
pub(super) fn order_chart<'a>(identification: &Identification, palette: &Palette) -> Chart<'a> {
    let mut chart = Chart::new("χ²/dof over the order", ChartAxis::Linear, "order", "");
    if !held_out_points(identification).is_empty() {
        let note = "dashed: held out".to_owned();
        chart.notes.push((note, palette.dim_text));
    }
    add_order_fits(&mut chart, identification, palette);
    chart
}

/// Adds the lines and the mark at the chosen order to a chart.
pub(super) fn add_order_fits(
    chart: &mut Chart<'_>,
    identification: &Identification,
    palette: &Palette,
) {
    chart.lines.push(ChartLine {
        points: held_out_points(identification).into(),
        color: palette.text,
        width: 1.2,
        dash: Some(DENSE_DASH),
    });
    chart.lines.push(ChartLine {
        points: fitted_points(identification),
        color: palette.text,
        width: 1.4,
        dash: None,
    });
    let mut chosen = Vec::new();
    for fit in &identification.order_fits {
        if Some(fit.order) == identification.refined.order() {
            chosen.push([fit.order as f64, fit.cost, 0.0]);
        }
    }
    chart.marks.push(ChartMarks {
        points: chosen,
        sideways: Vec::new(),
        color: palette.identified,
        filled: true,
        crosses: false,
    });
}

fn fitted_points(identification: &Identification) -> Arc<[[f64; 2]]> {
    identification
        .order_fits
        .iter()
        .map(|fit| [fit.order as f64, fit.cost])
        .collect()
}

fn held_out_points(identification: &Identification) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for OrderFit {
        order, held_out, ..
    } in &identification.order_fits
    {
        if let Some(held_out) = held_out {
            points.push([*order as f64, *held_out]);
        }
    }
    points
}
