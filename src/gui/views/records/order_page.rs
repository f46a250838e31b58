//! Page Order: fit over the model order, stabilisation diagram, poles, and the 95 % confidence
//! intervals predicted after further sweeps.

use egui::{Rect, ScrollArea, Sense, Ui, UiBuilder, pos2, vec2};

use super::identified_poles::{poles_chart, stabilisation_chart};
use super::next_flight::next_flight_ui;
use super::order_fits::order_chart;
use super::page::Page;
use crate::gui::plot::chart_view::chart_ui;

/// Share of the height for the stabilisation diagram and the poles.
const UPPER: f32 = 0.58;
/// Gap between charts \[pt\].
const GAP: f32 = 12.0;

/// Draws the page; without an identification, a message instead.
pub(super) fn order_ui(ui: &mut Ui, page: Page<'_>) {
    let Some(found) = page.identification_ui(ui) else {
        return;
    };
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, Sense::hover());
    let middle = pos2(area.center().x, area.top() + UPPER * area.height());
    let stabilisation = Rect::from_min_max(area.min, middle - vec2(0.5 * GAP, 0.5 * GAP));
    let poles = Rect::from_min_max(
        pos2(middle.x + 0.5 * GAP, area.top()),
        pos2(area.right(), middle.y - 0.5 * GAP),
    );
    let orders = Rect::from_min_max(
        pos2(area.left(), middle.y + 0.5 * GAP),
        pos2(middle.x - 0.5 * GAP, area.bottom()),
    );
    let next_flight = Rect::from_min_max(middle + vec2(0.5 * GAP, 0.5 * GAP), area.max);
    let unit = page.state.display.curves.unit;
    let across = unit.axis_label();
    let chart = stabilisation_chart(page, found, &across);
    chart_ui(ui, stabilisation, &chart, page.palette);
    chart_ui(ui, poles, &poles_chart(page, found), page.palette);
    chart_ui(ui, orders, &order_chart(found, page.palette), page.palette);
    ui.scope_builder(UiBuilder::new().max_rect(next_flight), |ui| {
        ScrollArea::both()
            .id_salt("next flight")
            .auto_shrink(false)
            .show(ui, |ui| next_flight_ui(ui, page));
    });
}
