//! One response in every condition, laid over one another.

use egui::{Align2, Pos2, Rect, RichText, Ui, pos2, vec2};
use gdcm_core::study::{AcrossJob, AcrossRole, display_band};
use gdcm_files::figure::airspeed_curves;

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::plot::{BodeCurve, BodeEvent, BodeQuantity, BodeScene, CurveId, Role, bode_ui, pointed_words};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;

/// Steps of the key of airspeeds.
const KEY_STEPS: u8 = 24;
const KEY_SIZE: egui::Vec2 = vec2(96.0, 8.0);

/// Which model of each condition, and what the colours mean. Laid out from right to left.
pub fn across_header_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let mut role = state.display.across_role;
    let roles = AcrossRole::ALL.map(|role| (role, role.name(), "The model of each condition that is drawn"));
    choice_ui(ui, "Model of each condition", &mut role, &roles);
    if role != state.display.across_role {
        commands.push(Command::ShowAcross(role));
    }
    let (least, most) = state.dataset().airspeed_range_kt();
    let small = |text: String| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    ui.label(small(format!("{most:.0} kt")));
    let (rect, _) = ui.allocate_exact_size(KEY_SIZE, egui::Sense::hover());
    paint_key(ui, rect, palette);
    ui.label(small(format!("{least:.0} kt")));
}

/// The colours from the slowest condition to the fastest.
fn paint_key(ui: &Ui, rect: Rect, palette: &Palette) {
    let width = rect.width() / f32::from(KEY_STEPS);
    for step in 0..KEY_STEPS {
        let corner = Pos2::new(rect.left() + width * f32::from(step), rect.top());
        let role = Role::OfAirspeed(step.saturating_mul(u8::MAX / (KEY_STEPS - 1)));
        let color = palette.role_style(role, false).color;
        ui.painter().rect_filled(Rect::from_min_size(corner, vec2(width + 0.5, rect.height())), 0.0, color);
    }
}

/// Magnitude and phase of the response in focus, of one model of every condition; a click shows a condition.
pub fn across_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let curves = across_curves(state);
    let band = state.study.settings.band;
    let title = state.dataset().pair_name(state.display.pair);
    let rect = ui.available_rect_before_wrap();
    let (quantity, unit) = (BodeQuantity::RESPONSE_OF_EVERY_CONDITION, state.display.unit);
    let scene = BodeScene {
        quantity,
        unit,
        stale: state.results.is_stale(ui.input(|input| input.time)),
        message: Some(state.results.absence()),
        ..BodeScene::of(&title, &curves, (band.min(), band.max()))
    };
    for event in bode_ui(ui, &scene, &mut state.display.across, palette) {
        if let BodeEvent::Clicked(CurveId::Model(id)) = event {
            commands.push(Command::SelectCondition(id.condition));
        }
    }
    commands.extend(pointed_words(&state.display.across, &curves, (quantity, unit)).map(Command::Tell));
    let place = pos2(rect.right() - 16.0, rect.top() + 14.0);
    ui.painter().text(place, Align2::RIGHT_TOP, title, egui::FontId::proportional(SMALL_SIZE), palette.text);
}

/// Frequencies of each curve.
const POINTS: usize = 300;

/// The responses that the view needs: one model of each condition.
pub fn across_job(state: &State) -> AcrossJob {
    let grid = (display_band(state.study.settings.band), POINTS);
    AcrossJob::of(&state.study.dataset, state.analysis(), state.display.across_role, grid)
}

/// The response in focus of one model of each condition; none until their responses are there.
pub fn across_curves(state: &mut State) -> Vec<BodeCurve> {
    let Some(curves) = state.across().cloned() else {
        return Vec::new();
    };
    let pair = state.display.pair;
    let mut cached = std::mem::take(&mut state.display.across_shapes);
    let (made_of, role) = ((state.dataset(), state.analysis()), state.display.across_role);
    let mut drawn = airspeed_curves(made_of, role, pair, &curves, &mut cached);
    for curve in &mut drawn {
        curve.highlighted = matches!(&curve.id, CurveId::Model(id) if id.condition == state.condition().id());
        curve.detail.push_str(" · click to show the condition");
    }
    state.display.across_shapes = cached;
    drawn
}
