//! The poles of the recommended model, with their standard deviations.

use egui::{RichText, Ui};

use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::plot::{Chart, ChartAxis, ChartMarks, chart_ui};
use gdcm_core::identification::{PoleEstimate, TWO_SIDED_95};

use super::bench::ConditionRecords;

/// The s-plane with an error bar on every pole.
pub(super) fn identified_poles_ui(ui: &mut Ui, records: &ConditionRecords, palette: &Palette) {
    let Some(found) = records.identification() else {
        ui.label(RichText::new("Nothing was identified yet: choose Identify above.").color(palette.dim_text));
        return;
    };
    let text = "± 1.96 standard deviations. Grey: below the band, or not determined by these records.";
    ui.label(RichText::new(text).size(SMALL_SIZE).color(palette.dim_text));
    let mut chart = Chart::new("Poles of CT-PBSID, refined", ChartAxis::Linear, "Re λ [rad/s]", "Im λ [rad/s]");
    chart.verticals = vec![0.0];
    for determined in [false, true] {
        let poles = || found.poles.iter().filter(move |pole| pole.determined == determined);
        // A bar of a pole that is not determined would hide the others.
        let bar = |sd: f64| if determined { TWO_SIDED_95 * sd } else { 0.0 };
        let place = |of: &PoleEstimate| [of.pole.re, of.pole.im, bar(of.sd_im)];
        chart.marks.push(ChartMarks {
            points: poles().map(place).collect(),
            sideways: poles().map(|of| bar(of.sd_re)).collect(),
            color: if determined { palette.identified } else { palette.dim_text },
            filled: false,
            crosses: true,
        });
    }
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, egui::Sense::hover());
    chart_ui(ui, area, &chart, palette);
}
