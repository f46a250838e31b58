//! Responses and poles in the displayed condition, with unchanged and with changed physics
//! parameters.
//!
//! G and D are the gain and the delay that would match a response (M6: docs/method.md).

use egui::{RichText, Ui, Vec2, vec2};

use gdcm_plot::figure::physics_change::physics_change_figure;
use gdcm_study::results::physics_assessment::PhysicsAssessment;

use crate::gui::plot::figure_legend::figure_legend_ui;
use crate::gui::plot::{FigureScene, figure_ui};
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};

/// Minimum plot size \[pt\].
const LEAST_PLOT: Vec2 = vec2(90.0, 60.0);
/// Width that a plot needs to be readable \[pt\].
const READABLE_WIDTH: f32 = 150.0;
/// Maximum count of responses shown.
const MOST_RESPONSES: f32 = 6.0;

/// Draws the most improved responses, as many as fit, and the poles.
pub(super) fn change_ui(
    ui: &mut Ui,
    state: &mut State,
    assessment: &PhysicsAssessment,
    palette: &Palette,
) {
    let condition = state.condition().id();
    // One plot shows the poles, the others a response each.
    let most_responses =
        (ui.available_width() / READABLE_WIDTH - 1.0).clamp(1.0, MOST_RESPONSES) as usize;
    let figure = physics_change_figure(
        assessment,
        state.dataset(),
        condition,
        most_responses,
        state.display.curves.unit,
    )
    .unwrap_or_default();
    ui.horizontal(|ui| {
        ui.label(RichText::new("Before and after").font(medium(BODY_SIZE)));
        let context = format!("condition {condition}, each response with its own G and D");
        ui.label(palette.small(&context)).on_hover_text(
            "The channels correct gain and delay, so each response is shown after its own G and D \
            (eq. (5) and (9) in docs/method.md); J is the remaining cost. The most improved \
            responses come first.",
        );
    });
    figure_legend_ui(ui, &figure, palette);
    let view = &mut state.display.physics.change;
    view.fit_if_subject_changed(&figure.title);
    let scene = FigureScene {
        zooms: true,
        is_stacked: true,
        ..FigureScene::new(
            "before and after",
            &figure,
            LEAST_PLOT,
            "No parameter is changed in this condition",
            &figure,
        )
    };
    figure_ui(ui, &scene, view, palette);
}
