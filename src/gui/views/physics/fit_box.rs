//! Check box that takes a physics parameter into the fit.

use egui::{Color32, Rect, Role, Sense, Stroke, StrokeKind, Ui, pos2, vec2};

use gdcm_study::Edit;
use gdcm_study::decisions::physics_settings::ParameterDecision;

use crate::gui::commands::command::Command;
use crate::gui::widgets::controls::{Asks, named_switch};
use crate::gui::widgets::palette::Palette;

/// Box side \[pt\].
const SIDE: f32 = 12.0;

/// Draws the box for the parameter `name` in a row, with its left edge at `left`.
pub(super) fn fit_box_ui(
    ui: &mut Ui,
    row: Rect,
    left: f32,
    name: &str,
    is_on: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let corner = pos2(left, row.center().y - 0.5 * SIDE);
    let place = Rect::from_min_size(corner, vec2(SIDE, SIDE));
    let id = ui.scope_id().with(("fitted", name));
    let response = ui.interact(place, id, Sense::click());
    let line = if response.hovered() || response.has_focus() {
        palette.accent
    } else {
        palette.dim_text
    };
    let fill = if is_on { line } else { Color32::TRANSPARENT };
    ui.painter()
        .rect(place, 2.0, fill, Stroke::new(1.0, line), StrokeKind::Inside);
    if is_on {
        let points = [vec2(-3.0, 0.0), vec2(-1.0, 2.5), vec2(3.5, -2.5)]
            .map(|corner| place.center() + corner)
            .to_vec();
        ui.painter()
            .line(points, Stroke::new(1.5, palette.background));
    }
    let response = named_switch(response, Role::CheckBox, is_on, format!("Fit {name}"));
    let decision = Edit::DecideParameter {
        name: name.to_owned(),
        decision: ParameterDecision::On(!is_on),
    };
    response.asks(decision, commands);
}
