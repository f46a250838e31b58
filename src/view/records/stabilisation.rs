//! The stabilisation diagram: poles of the models of every order.

use egui::{RichText, Ui};

use crate::view::palette::Palette;
use crate::view::plot::{Chart, ChartAxis, ChartMarks, chart_ui};
use crate::view::state::State;
use gdcm_core::identification::StabilisationPoint;

use super::bench::ConditionRecords;

/// Moduli of the poles over frequency, one row an order; crosses stay where the order before has them.
pub(super) fn stabilisation_ui(ui: &mut Ui, state: &State, records: &ConditionRecords, palette: &Palette) {
    let Some(found) = records.identification() else {
        ui.label(RichText::new("Nothing was identified yet: choose Identify above.").color(palette.dim_text));
        return;
    };
    let text = "Crosses: within 5 % of a pole of the order two below. Circles: not. Dotted: the band.";
    ui.label(RichText::new(text).size(crate::view::palette::SMALL_SIZE).color(palette.dim_text));
    let unit = state.display.unit;
    let across = unit.axis_label();
    let title = "Stabilisation diagram: |λ| of the models of every order, at the best Laguerre pole and past window";
    let mut chart = Chart::new(title, ChartAxis::Frequency(unit), &across, "order");
    chart.verticals = records.found.iter().flat_map(|(job, _)| job.options.band).collect();
    for stable in [false, true] {
        let points = found.stabilisation.iter().filter(|point| point.stable == stable && point.pole.norm() > 0.0);
        let place = |point: &StabilisationPoint| [point.pole.norm(), point.order as f64, 0.0];
        chart.marks.push(ChartMarks {
            points: points.map(place).collect(),
            sideways: Vec::new(),
            color: if stable { palette.perturbed } else { palette.dim_text },
            filled: false,
            crosses: stable,
        });
    }
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, egui::Sense::hover());
    chart_ui(ui, area, &chart, palette);
}
