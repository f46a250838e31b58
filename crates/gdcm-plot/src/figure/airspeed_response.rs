//! Curves of a response of one model in every condition, coloured by airspeed.

use std::sync::Arc;

use gdcm_model::dataset::{Dataset, ModelId, Pair};
use gdcm_model::response::GainDelay;
use gdcm_model::response::response_shape::ResponseShape;
use gdcm_study::jobs::curve_jobs::AcrossCurves;
use gdcm_study::{AcrossRole, Analysis};

use super::bode_curve::{BodeCurve, CurveId};
use super::role::Role;

/// A response of one model in each condition. Conditions without the model or its correction are
/// not drawn.
#[derive(Clone, Copy, Debug)]
pub struct AirspeedResponse<'a> {
    pub dataset: &'a Dataset,
    /// Source of corrections; `None` before the conditions are compared.
    pub analysis: Option<&'a Analysis>,
    /// Selects the model and its correction.
    pub role: AcrossRole,
    pub pair: Pair,
    /// Responses of the model in each condition.
    pub responses: &'a Arc<AcrossCurves>,
}

impl AirspeedResponse<'_> {
    /// Returns a curve for each condition, coloured by airspeed. `cache` keeps the computed shapes
    /// until the responses change.
    pub fn curves(&self, cache: &mut AirspeedCache) -> Vec<BodeCurve> {
        cache.refresh(self.responses, self.pair);
        let mut drawn = Vec::new();
        for ModelShape { id, shape } in &cache.shapes {
            drawn.extend(self.curve(id, shape, &cache.omega));
        }
        drawn
    }

    /// Returns the curve of a condition; `None` without the condition or the correction.
    fn curve(&self, id: &ModelId, shape: &ResponseShape, omega: &Arc<[f64]>) -> Option<BodeCurve> {
        let condition = self.dataset.condition(id.condition)?;
        let correction = self
            .role
            .correction(id.condition, self.pair, self.analysis)?;
        let shape = if correction == GainDelay::NONE {
            shape.clone()
        } else {
            shape.corrected(omega, correction)
        };
        let state = condition.flight_state();
        let (slowest_kt, fastest_kt) = self.dataset.airspeed_range_kt();
        let color_role = Role::of_airspeed(state.airspeed_kt, slowest_kt, fastest_kt);
        let curve = BodeCurve {
            label: format!("condition {} · {:.0} kt", id.condition, state.airspeed_kt),
            detail: format!("{} · {}", state.name, id.name),
            ..BodeCurve::new(CurveId::Model(id.clone()), color_role)
        };
        Some(curve.with(omega, &shape.magnitude_db, &shape.phase_deg))
    }
}

/// Shape of a response of a model, in one of the conditions.
#[derive(Debug)]
struct ModelShape {
    id: ModelId,
    shape: ResponseShape,
}

/// Data from which the shapes of a response in several conditions are computed.
#[derive(Debug)]
struct AirspeedSource {
    curves: Arc<AcrossCurves>,
    pair: Pair,
}

/// Shapes of a response of one model in each condition, kept until their source changes.
#[derive(Debug, Default)]
pub struct AirspeedCache {
    source: Option<AirspeedSource>,
    omega: Arc<[f64]>,
    shapes: Vec<ModelShape>,
}

impl AirspeedCache {
    /// Computes the shapes of a response; phases are aligned with the first model.
    fn refresh(&mut self, curves: &Arc<AcrossCurves>, pair: Pair) {
        if let Some(known) = &self.source
            && Arc::ptr_eq(&known.curves, curves)
            && known.pair == pair
        {
            return;
        }
        self.shapes.clear();
        for (id, response) in &curves.responses {
            let mut shape = ResponseShape::new(response.curve(pair));
            if let Some(first) = self.shapes.first() {
                shape = shape.phase_aligned(&first.shape, usize::MAX);
            }
            self.shapes.push(ModelShape {
                id: id.clone(),
                shape,
            });
        }
        self.omega = curves.grid.omega().into();
        self.source = Some(AirspeedSource {
            curves: Arc::clone(curves),
            pair,
        });
    }
}
