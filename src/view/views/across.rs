//! One response in every condition, laid over one another.

use std::sync::Arc;

use egui::{Align2, Pos2, Rect, RichText, Ui, pos2, vec2};
use gdcm_core::dataset::{ModelId, Pair};
use gdcm_core::response::{GainDelay, ResponseShape};
use gdcm_core::study::{AcrossCurves, AcrossJob, AcrossRole, display_band};

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::plot::{BodeCurve, BodeEvent, BodeQuantity, BodeScene, CurveId, Role, bode_ui};
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
    let scene = BodeScene {
        quantity: BodeQuantity::RESPONSE_OF_EVERY_CONDITION,
        unit: state.display.unit,
        stale: state.results.is_stale(ui.input(|input| input.time)),
        message: Some(state.results.absence()),
        ..BodeScene::of(&title, &curves, (band.min(), band.max()))
    };
    for event in bode_ui(ui, &scene, &mut state.display.across, palette) {
        if let BodeEvent::Clicked(CurveId::Model(id)) = event {
            commands.push(Command::SelectCondition(id.condition));
        }
    }
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

/// Shapes of one response of several models, kept while both stay the same.
#[derive(Debug, Default)]
pub struct CachedAcross {
    made_of: Option<(Arc<AcrossCurves>, Pair)>,
    omega: Arc<[f64]>,
    shapes: Vec<(ModelId, ResponseShape)>,
}

impl CachedAcross {
    /// Makes the shapes of `pair`; phases are laid on that of the first model.
    fn refresh(&mut self, curves: &Arc<AcrossCurves>, pair: Pair) {
        if self.made_of.as_ref().is_some_and(|(of, at)| Arc::ptr_eq(of, curves) && *at == pair) {
            return;
        }
        let mut first: Option<ResponseShape> = None;
        let shape = |(id, response): &(ModelId, Arc<gdcm_core::response::FrequencyResponse>)| {
            let shape = ResponseShape::of(&response.curve(pair));
            let shape = match &first {
                Some(first) => shape.laid_on(first),
                None => shape,
            };
            first.get_or_insert_with(|| shape.clone());
            (id.clone(), shape)
        };
        self.shapes = curves.responses.iter().map(shape).collect();
        self.omega = curves.grid.omega().into();
        self.made_of = Some((Arc::clone(curves), pair));
    }
}

/// The response in focus of one model of each condition; none until their responses are there.
pub fn across_curves(state: &mut State) -> Vec<BodeCurve> {
    let Some(curves) = state.across().cloned() else {
        return Vec::new();
    };
    let pair = state.display.pair;
    let mut cached = std::mem::take(&mut state.display.across_shapes);
    cached.refresh(&curves, pair);
    let drawn = cached.shapes.iter().filter_map(|(id, shape)| curve(state, &cached.omega, id, shape)).collect();
    state.display.across_shapes = cached;
    drawn
}

fn curve(state: &State, omega: &Arc<[f64]>, id: &ModelId, shape: &ResponseShape) -> Option<BodeCurve> {
    let role = state.display.across_role;
    let condition = state.dataset().condition(id.condition)?;
    let correction = role.correction(id.condition, state.display.pair, state.analysis())?;
    let shape = if correction == GainDelay::NONE { shape.clone() } else { shape.corrected(omega, correction) };
    let airspeed_kt = condition.flight_state().airspeed_kt;
    Some(BodeCurve {
        id: CurveId::Model(id.clone()),
        label: format!("condition {} · {airspeed_kt:.0} kt", condition.id()),
        detail: format!("{} · {} · click to show the condition", condition.flight_state().name, id.name),
        role: Role::of_airspeed(airspeed_kt, state.dataset().airspeed_range_kt()),
        rejected: false,
        hidden: false,
        highlighted: condition.id() == state.condition().id(),
        omega: Arc::clone(omega),
        magnitude_db: shape.magnitude_db,
        phase_deg: shape.phase_deg,
    })
}
