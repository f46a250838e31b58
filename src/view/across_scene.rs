//! One response in several conditions, coloured by airspeed.

use std::sync::Arc;

use crate::dataset::{BundleKind, Condition, ModelId, Pair};
use crate::response::{GainDelay, ResponseShape};
use crate::study::{AcrossCurves, AcrossJob, display_band};

use super::plot::{BodeCurve, CurveId, Role};
use super::state::State;

/// Frequencies of each curve.
const POINTS: usize = 300;

/// Which model of each condition is laid over the others'.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AcrossRole {
    /// The physics model at the condition's own trim.
    #[default]
    Nominal,
    /// The physics model that represents its bundle.
    Representative,
    /// The same under the condition's own correction.
    Corrected,
    /// The identified model that represents its bundle.
    Identified,
}

impl AcrossRole {
    /// Every role, in the order of its list.
    pub const ALL: [Self; 4] = [Self::Nominal, Self::Representative, Self::Corrected, Self::Identified];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Representative => "representative",
            Self::Corrected => "corrected",
            Self::Identified => "identified",
        }
    }

    /// The model that has this role in a condition; none where the condition has no result.
    fn model(self, state: &State, condition: &Condition) -> Option<ModelId> {
        let of = |kind: BundleKind, name: &str| ModelId::new(condition.id(), kind, name);
        if self == Self::Nominal {
            return Some(of(BundleKind::Physics, &condition.bundle(BundleKind::Physics)[condition.nominal()].name));
        }
        let result = state.analysis()?.condition(condition.id())?;
        let kind = if self == Self::Identified { BundleKind::Identified } else { BundleKind::Physics };
        Some(of(kind, result.representative_name(kind)))
    }

    /// What is done to its response before it is drawn; nothing where the response has no correction.
    fn correction(self, state: &State, id: &ModelId, pair: Pair) -> Option<GainDelay> {
        match self {
            Self::Corrected => state.analysis()?.condition(id.condition)?.correction.on(pair),
            _ => Some(GainDelay::NONE),
        }
    }
}

/// The responses that the view needs: one model of each condition.
pub fn across_job(state: &State) -> AcrossJob {
    let role = state.display.across_role;
    let models = state.dataset().conditions().iter().filter_map(|condition| role.model(state, condition)).collect();
    AcrossJob {
        dataset: Arc::clone(&state.study.dataset),
        models,
        grid: (display_band(state.study.settings.band), POINTS),
    }
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
        let shape = |(id, response): &(ModelId, Arc<crate::response::FrequencyResponse>)| {
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
    let correction = role.correction(state, id, state.display.pair)?;
    let shape = if correction == GainDelay::NONE { shape.clone() } else { shape.corrected(omega, correction) };
    let airspeed_kt = condition.flight_state().airspeed_kt;
    Some(BodeCurve {
        id: CurveId::Model(id.clone()),
        label: format!("condition {} · {airspeed_kt:.0} kt", condition.id()),
        detail: format!("{} · {} · click to show the condition", condition.flight_state().name, id.name),
        role: Role::OfAirspeed(airspeed_step(state, airspeed_kt)),
        rejected: false,
        hidden: false,
        highlighted: condition.id() == state.condition().id(),
        omega: Arc::clone(omega),
        magnitude_db: shape.magnitude_db,
        phase_deg: shape.phase_deg,
    })
}

/// The step of an airspeed between the slowest condition, 0, and the fastest, 255.
fn airspeed_step(state: &State, airspeed_kt: f64) -> u8 {
    let (least, most) = airspeed_range_kt(state);
    let part = if most > least { (airspeed_kt - least) / (most - least) } else { 0.0 };
    (255.0 * part.clamp(0.0, 1.0)).round() as u8
}

/// Airspeeds of the slowest and of the fastest condition \[kt\].
pub fn airspeed_range_kt(state: &State) -> (f64, f64) {
    let airspeeds = state.dataset().conditions().iter().map(|condition| condition.flight_state().airspeed_kt);
    airspeeds.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), kt| (least.min(kt), most.max(kt)))
}
