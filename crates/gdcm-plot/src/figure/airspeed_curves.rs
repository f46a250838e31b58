//! Curves of one response in every condition, coloured by airspeed, and the error that the schedule
//! leaves in each.
//!
//! A condition's *optimum* is its own correction; the *schedule* gives gains and delays over
//! airspeed, fitted to the optima. An error is that of a corrected physics model against the
//! condition's identified model.

use std::sync::Arc;

use gdcm_model::dataset::{Band, Condition, ConditionId, Dataset, Pair};
use gdcm_model::response::GainDelay;
use gdcm_model::response::response_shape::ResponseShape;
use gdcm_study::jobs::across_job::AcrossCurves;
use gdcm_study::{AcrossRole, Analysis};

use super::bode_curve::{BodeCurve, CurveId};
use super::role::{AirspeedLine, Role};
use super::uncertainty_band::BodeBand;

/// One response in several conditions. A role has no curve in a condition without the role's model
/// or its correction.
#[derive(Clone, Copy, Debug)]
pub struct AirspeedResponse<'a> {
    pub dataset: &'a Dataset,
    /// Source for corrections and schedule; `None` before the conditions are compared.
    pub analysis: Option<&'a Analysis>,
    /// Kinds of model drawn in each condition, such as identified or scheduled.
    pub roles: &'a [AcrossRole],
    /// Conditions in the figure.
    pub conditions: &'a [ConditionId],
    pub pair: Pair,
    /// Comparison band; phases are aligned over all frequencies up to its upper end.
    pub band: Band,
    /// Model responses in each condition.
    pub responses: &'a Arc<AcrossCurves>,
}

/// A response's curves over the conditions.
#[derive(Clone, Debug, Default)]
pub struct AirspeedCurves {
    /// Responses of the models in the requested roles, condition by condition.
    pub responses: Vec<BodeCurve>,
    /// Scheduled minus identified model in each condition.
    pub errors: Vec<BodeCurve>,
    /// Smallest and largest difference at each frequency between the model with its condition's own
    /// optimum and the identified model; `None` without optima.
    pub optima: Option<BodeBand>,
}

impl AirspeedResponse<'_> {
    /// Returns the curves, coloured by airspeed. `cache` keeps the uncorrected shapes until the
    /// responses or the pair change.
    pub fn curves(&self, cache: &mut AirspeedCache) -> AirspeedCurves {
        cache.refresh(self);
        let mut curves = AirspeedCurves::default();
        let mut optima = Vec::new();
        for shapes in &cache.shapes {
            let Some(condition) = self.dataset.condition(shapes.condition) else {
                continue;
            };
            if !self.conditions.contains(&shapes.condition) {
                continue;
            }
            for role in self.roles {
                if let Some(shape) = self.shape(shapes, condition, *role, &cache.omega) {
                    let curve = self.curve(condition, *role);
                    let curve = curve.with(&cache.omega, &shape.magnitude_db, &shape.phase_deg);
                    curves.responses.push(curve);
                }
            }
            if let Some(error) = self.error(shapes, condition, AcrossRole::Scheduled, &cache.omega)
            {
                let curve = self.curve(condition, AcrossRole::Scheduled);
                let curve = curve.with(&cache.omega, &error.magnitude_db, &error.phase_deg);
                curves.errors.push(curve);
            }
            optima.extend(self.error(shapes, condition, AcrossRole::Corrected, &cache.omega));
        }
        curves.optima = range_of_errors(&optima, &cache.omega);
        curves
    }

    /// Returns a role's response in a condition; `None` without the model or its correction.
    fn shape(
        &self,
        shapes: &ConditionShapes,
        condition: &Condition,
        role: AcrossRole,
        omega: &[f64],
    ) -> Option<ResponseShape> {
        let shape = match role {
            AcrossRole::Identified => shapes.identified.as_ref()?,
            AcrossRole::Representative => shapes.representative.as_ref()?,
            AcrossRole::Nominal => shapes.nominal.as_ref()?,
            AcrossRole::Scheduled | AcrossRole::Corrected => shapes.coupled.as_ref()?,
        };
        let correction = role.correction(condition, self.pair, self.analysis)?;
        if correction == GainDelay::NONE {
            return Some(shape.clone());
        }
        Some(shape.corrected(omega, correction))
    }

    /// Returns the difference between a role's model and the identified model; `None` if either is
    /// missing in the condition.
    fn error(
        &self,
        shapes: &ConditionShapes,
        condition: &Condition,
        role: AcrossRole,
        omega: &[f64],
    ) -> Option<ResponseShape> {
        let identified = shapes.identified.as_ref()?;
        let points = points_up_to(omega, self.band.max());
        let model = self
            .shape(shapes, condition, role, omega)?
            .phase_aligned(identified, points);
        Some(ResponseShape {
            magnitude_db: difference(&model.magnitude_db, &identified.magnitude_db),
            phase_deg: difference(&model.phase_deg, &identified.phase_deg),
        })
    }

    /// Returns a role's curve in a condition, without points.
    fn curve(&self, condition: &Condition, role: AcrossRole) -> BodeCurve {
        let state = condition.flight_state();
        let step = Role::airspeed_step(state.airspeed_kt, self.dataset.airspeed_range_kt());
        let mut detail = state.name.clone();
        if let Some(model) = role.model(condition, self.analysis) {
            detail = format!("{detail} · {}", model.name);
        }
        let id = condition.id();
        BodeCurve {
            label: format!(
                "condition {id} · {:.0} kt, {}",
                state.airspeed_kt,
                role.name()
            ),
            detail,
            ..BodeCurve::new(
                CurveId::OfCondition(id, role),
                Role::OfAirspeed(step, line_of(role)),
            )
        }
    }
}

/// Returns the line style that distinguishes a role from the others at the same airspeed.
pub fn line_of(role: AcrossRole) -> AirspeedLine {
    match role {
        AcrossRole::Identified => AirspeedLine::Identified,
        AcrossRole::Scheduled => AirspeedLine::Scheduled,
        AcrossRole::Corrected => AirspeedLine::Corrected,
        AcrossRole::Representative => AirspeedLine::Representative,
        AcrossRole::Nominal => AirspeedLine::Nominal,
    }
}

/// Counts the leading frequencies up to `limit` \[rad/s\].
fn points_up_to(omega: &[f64], limit: f64) -> usize {
    // The last frequency of a grid may exceed its limit by a rounding error.
    omega.partition_point(|omega| *omega <= limit * (1.0 + 1e-9))
}

fn difference(values: &[f64], others: &[f64]) -> Arc<[f64]> {
    values
        .iter()
        .zip(others)
        .map(|(value, other)| value - other)
        .collect()
}

/// Returns the smallest and the largest error at each frequency; `None` without errors.
fn range_of_errors(errors: &[ResponseShape], omega: &[f64]) -> Option<BodeBand> {
    if errors.is_empty() {
        return None;
    }
    let mut range = BodeBand {
        omega: omega.to_vec(),
        ..BodeBand::default()
    };
    for index in 0..omega.len() {
        range.magnitude_db.push(smallest_and_largest(
            errors.iter().map(|error| error.magnitude_db[index]),
        ));
        range.phase_deg.push(smallest_and_largest(
            errors.iter().map(|error| error.phase_deg[index]),
        ));
    }
    Some(range)
}

/// Returns the smallest and the largest finite value; NaN without one.
fn smallest_and_largest(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut ends = [f64::NAN; 2];
    for value in values {
        if value.is_finite() {
            ends = [ends[0].min(value), ends[1].max(value)];
        }
    }
    ends
}

/// Uncorrected shapes in one condition.
#[derive(Debug)]
struct ConditionShapes {
    condition: ConditionId,
    identified: Option<ResponseShape>,
    /// Physics representative.
    representative: Option<ResponseShape>,
    /// Physics representative with physics parameters and couplings applied, to which corrections
    /// apply; equal to `representative` if there are neither.
    coupled: Option<ResponseShape>,
    nominal: Option<ResponseShape>,
}

/// A response's shapes in each condition, kept until the responses or the pair change.
#[derive(Debug, Default)]
pub struct AirspeedCache {
    /// Model responses from which the shapes were computed.
    responses: Option<Arc<AcrossCurves>>,
    pair: Option<Pair>,
    omega: Arc<[f64]>,
    shapes: Vec<ConditionShapes>,
}

impl AirspeedCache {
    /// Computes a response's shapes, unless they are known. Phases from identified models are
    /// aligned with the first condition that has an identified or a nominal model, those from
    /// physics models with their condition's identified model or, without one, with that first
    /// condition.
    fn refresh(&mut self, response: &AirspeedResponse<'_>) {
        if let Some(known) = &self.responses
            && Arc::ptr_eq(known, response.responses)
            && self.pair == Some(response.pair)
        {
            return;
        }
        self.omega = response.responses.grid.omega().into();
        self.shapes.clear();
        // Phase reference of the first condition that has one.
        let mut first = None;
        for condition in response.dataset.conditions() {
            let source = ShapeSource {
                response,
                condition,
                points: points_up_to(&self.omega, response.band.max()),
            };
            let shapes = source.shapes(first.as_ref());
            if first.is_none() {
                first.clone_from(shapes.phase_reference());
            }
            self.shapes.push(shapes);
        }
        self.responses = Some(Arc::clone(response.responses));
        self.pair = Some(response.pair);
    }
}

/// Source of the shapes in one condition.
struct ShapeSource<'a> {
    response: &'a AirspeedResponse<'a>,
    condition: &'a Condition,
    /// Leading frequencies over which phases are aligned.
    points: usize,
}

impl ShapeSource<'_> {
    /// Returns the shapes; `first` is the shape of another condition with which phases are aligned.
    fn shapes(&self, first: Option<&ResponseShape>) -> ConditionShapes {
        let identified = self.shape(AcrossRole::Identified, first);
        let reference = identified.as_ref().or(first).cloned();
        let reference = reference.as_ref();
        ConditionShapes {
            condition: self.condition.id(),
            representative: self.shape(AcrossRole::Representative, reference),
            coupled: self.shape(AcrossRole::Corrected, reference),
            nominal: self.shape(AcrossRole::Nominal, reference),
            identified,
        }
    }

    /// Returns the shape of a role's model before correction; `None` without its response.
    fn shape(&self, role: AcrossRole, reference: Option<&ResponseShape>) -> Option<ResponseShape> {
        let model = role.model(self.condition, self.response.analysis)?;
        let model_responses = self.response.responses.model(&model)?;
        let response = match &model_responses.coupled {
            Some(coupled) if role.is_corrected() => coupled,
            _ => &model_responses.response,
        };
        let shape = ResponseShape::new(response.curve(self.response.pair));
        Some(match reference {
            Some(reference) => shape.phase_aligned(reference, self.points),
            None => shape,
        })
    }
}

impl ConditionShapes {
    /// Returns the shape to which other conditions align their phases: the identified model's, or
    /// else the nominal model's.
    fn phase_reference(&self) -> &Option<ResponseShape> {
        if self.identified.is_some() {
            &self.identified
        } else {
            &self.nominal
        }
    }
}
