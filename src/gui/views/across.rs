//! Plot across conditions: the response in focus of a model of every condition, coloured by
//! airspeed.

use egui::{Align2, Pos2, Rect, Ui, vec2};

use gdcm_plot::figure::responses::AirspeedResponse;
use gdcm_study::AcrossRole;
use gdcm_study::jobs::curve_jobs::AcrossJob;
use gdcm_study::stages::condition_curves::display_band;

use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::bode_event::BodeEvent;
use crate::gui::plot::pointed_curve_text::pointed_curve_text;
use crate::gui::plot::quantity::BodeQuantity;
use crate::gui::plot::{BodeCurve, BodeScene, CurveId, Pane, Role, bode_ui};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Number of frequencies on each curve.
const POINTS: usize = 300;
/// Number of steps in the colour key of the airspeeds.
const KEY_STEPS: u8 = 24;
/// Size of the colour key \[pt\].
const KEY_SIZE: egui::Vec2 = vec2(96.0, 8.0);

/// Draws the selector of the models and the colour key of the airspeed, from right to left.
pub fn across_header_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mut role = state.display.frequency.across_role;
    let roles = AcrossRole::ALL.map(|role| (role, role.name(), "Model drawn for each condition"));
    choice_ui(ui, "Model of each condition", &mut role, &roles);
    if role != state.display.frequency.across_role {
        commands.push(DisplayCommand::ShowAcross(role).into());
    }
    let (least, most) = state.dataset().airspeed_range_kt();
    ui.label(palette.small(format!("{most:.0} kt")));
    let (rect, _) = ui.allocate_exact_size(KEY_SIZE, egui::Sense::hover());
    paint_key(ui, rect, palette);
    ui.label(palette.small(format!("{least:.0} kt")));
}

/// Paints the colours from the slowest condition to the fastest.
fn paint_key(ui: &Ui, rect: Rect, palette: &Palette) {
    let width = rect.width() / f32::from(KEY_STEPS);
    for step in 0..KEY_STEPS {
        let corner = Pos2::new(rect.left() + width * f32::from(step), rect.top());
        let role = Role::OfAirspeed(step.saturating_mul(u8::MAX / (KEY_STEPS - 1)));
        let color = palette.role_style(role, false).color;
        ui.painter().rect_filled(
            Rect::from_min_size(corner, vec2(width + 0.5, rect.height())),
            0.0,
            color,
        );
    }
}

/// Draws magnitude and phase of the response in focus for a model of every condition; a click
/// selects a condition.
pub fn across_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let curves = across_curves(state);
    fit_across(state);
    let band = state.study.settings.band;
    let title = state.dataset().pair_name(state.display.selection.pair);
    let quantity = BodeQuantity::RESPONSE_OF_EVERY_CONDITION;
    let unit = state.display.curves.unit;
    let scene = BodeScene {
        quantity,
        unit,
        stale: state.results.is_stale(ui.input(|input| input.time)),
        message: Some(state.results.absence()),
        ..BodeScene::new(&title, &curves, (band.min(), band.max()))
    };
    for event in bode_ui(ui, &scene, &mut state.display.frequency.across, palette) {
        if let BodeEvent::Clicked(CurveId::Model(id)) = event {
            commands.push(SelectionCommand::SelectCondition(id.condition).into());
        }
    }
    let view = &state.display.frequency.across;
    if let Some(words) = pointed_curve_text(view, &curves, quantity, unit) {
        commands.push(SelectionCommand::Tell(words).into());
    }
    if let Some(transform) = view.transform(Pane::Magnitude)
        && !curves.is_empty()
    {
        let place = transform.frame().right_top() + vec2(-8.0, 6.0);
        ui.painter().text(
            place,
            Align2::RIGHT_TOP,
            title,
            egui::FontId::proportional(SMALL_SIZE),
            palette.text,
        );
    }
}

/// Fits the value axes in each frame until the curves of a newly selected response or model are
/// available.
fn fit_across(state: &mut State) {
    let asked = (
        state.display.selection.pair,
        state.display.frequency.across_role,
    );
    if state.display.frequency.across_fitted == Some(asked) {
        return;
    }
    state.display.frequency.across.request_refit();
    // Until then, the previous curves are drawn, and the fit must be repeated.
    if let Some((job, _)) = &state.results.across
        && job.models == across_job(state).models
    {
        state.display.frequency.across_fitted = Some(asked);
    }
}

/// Returns the job that computes the responses in the view: a model of each condition.
pub fn across_job(state: &State) -> AcrossJob {
    let grid = (display_band(state.study.settings.band), POINTS);
    AcrossJob::for_role(
        &state.study.dataset,
        state.analysis(),
        state.display.frequency.across_role,
        grid,
    )
}

/// Returns the curves of the response in focus for a model of each condition; empty until the
/// responses are available.
pub fn across_curves(state: &mut State) -> Vec<BodeCurve> {
    let Some(curves) = state.across().cloned() else {
        return Vec::new();
    };
    let mut cached = std::mem::take(&mut state.display.frequency.across_shapes);
    let response = AirspeedResponse {
        dataset: state.dataset(),
        analysis: state.analysis(),
        role: state.display.frequency.across_role,
        pair: state.display.selection.pair,
        responses: &curves,
    };
    let mut drawn = response.curves(&mut cached);
    for curve in &mut drawn {
        curve.highlighted =
            matches!(&curve.id, CurveId::Model(id) if id.condition == state.condition().id());
        curve.detail.push_str(" · click to show the condition");
    }
    state.display.frequency.across_shapes = cached;
    drawn
}
