//! One response in several conditions, coloured by airspeed.

use std::sync::Arc;

use gdcm_core::dataset::{ModelId, Pair};
use gdcm_core::response::{GainDelay, ResponseShape};
use gdcm_core::study::{AcrossCurves, AcrossJob, display_band};

use super::plot::{BodeCurve, CurveId, Role};
use super::state::State;

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
