//! The curves of the focused response, made of what was computed.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Complex;

use crate::correction::ChannelCorrection;
use crate::dataset::{BundleKind, Condition, Model, ModelId, Pair};
use crate::fidelity::SUGGESTION_RATIO;
use crate::response::{FrequencyResponse, GainDelay, nearest_turn_offset, unwrap};
use crate::study::{ConditionAnalysis, ConditionCurves};
use crate::units::{ratio_to_db, s_to_ms};

use super::plot::{BodeCurve, CurveId, Role};
use super::state::State;

/// Magnitude \[dB\] and unwrapped phase \[deg\] of one response.
#[derive(Clone, Debug)]
struct Shape {
    magnitude_db: Arc<[f64]>,
    phase_deg: Arc<[f64]>,
}

impl Shape {
    /// The phase is principal at the first finite value, then unwrapped; a value that is not finite leaves a gap (M2).
    fn of(values: &[Complex<f64>]) -> Self {
        let finite: Vec<usize> =
            (0..values.len()).filter(|&k| values[k].is_finite() && values[k].norm() > 0.0).collect();
        let mut phase: Vec<f64> = finite.iter().map(|&k| values[k].arg()).collect();
        unwrap(&mut phase);
        let mut shape = (vec![f64::NAN; values.len()], vec![f64::NAN; values.len()]);
        for (&k, phase) in finite.iter().zip(phase) {
            shape.0[k] = ratio_to_db(values[k].norm());
            shape.1[k] = phase.to_degrees();
        }
        Self { magnitude_db: shape.0.into(), phase_deg: shape.1.into() }
    }

    /// The shape moved by whole turns as near to `reference` as they bring it (M2).
    fn laid_on(self, reference: &Shape) -> Self {
        let radians = |phase: &[f64]| phase.iter().map(|degrees| degrees.to_radians()).collect::<Vec<f64>>();
        let offset = nearest_turn_offset(&radians(&self.phase_deg), &radians(&reference.phase_deg)).to_degrees();
        if offset == 0.0 {
            return self;
        }
        Self { phase_deg: self.phase_deg.iter().map(|phase| phase + offset).collect(), ..self }
    }

    /// The shape after a gain and a delay (M10).
    fn corrected(&self, omega: &[f64], correction: GainDelay) -> Self {
        let phase: Vec<f64> = self.phase_deg.iter().map(|degrees| degrees.to_radians()).collect();
        Self {
            magnitude_db: correction.magnitudes_db(&self.magnitude_db).collect(),
            phase_deg: correction.phases(&phase, omega).map(f64::to_degrees).collect(),
        }
    }
}

/// Shapes of every model of the condition shown for one response, kept while neither changes.
#[derive(Debug, Default)]
pub struct CachedShapes {
    made_of: Option<(Arc<ConditionCurves>, Pair, usize)>,
    omega: Arc<[f64]>,
    physics: Vec<Shape>,
    identified: Vec<Shape>,
    /// Of each corrected curve: what it was made with, and its shape.
    corrected: BTreeMap<CurveId, (Treatment, Shape)>,
}

/// What a corrected curve is made with.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Treatment {
    /// Index of the physics model.
    model: usize,
    correction: GainDelay,
}

impl CachedShapes {
    /// Makes the shapes of `pair`; phases are laid on that of the identified model `reference`.
    fn refresh(&mut self, curves: &Arc<ConditionCurves>, pair: Pair, reference: usize) {
        let same = |(made_of, of_pair, of_reference): &(Arc<ConditionCurves>, Pair, usize)| {
            Arc::ptr_eq(made_of, curves) && *of_pair == pair && *of_reference == reference
        };
        if self.made_of.as_ref().is_some_and(same) {
            return;
        }
        let reference_shape = Shape::of(&curves.identified[reference].curve(pair));
        let shapes = |kind| {
            let laid = |response: &Arc<FrequencyResponse>| Shape::of(&response.curve(pair)).laid_on(&reference_shape);
            curves.bundle(kind).iter().map(laid).collect()
        };
        self.physics = shapes(BundleKind::Physics);
        self.identified = shapes(BundleKind::Identified);
        self.omega = curves.grid.omega().into();
        self.corrected.clear();
        self.made_of = Some((Arc::clone(curves), pair, reference));
    }

    /// The corrected shape of the curve `id`: the same one until it is made with something else.
    fn corrected(&mut self, id: &CurveId, treatment: Treatment) -> Shape {
        match self.corrected.get(id) {
            Some((with, shape)) if *with == treatment => shape.clone(),
            _ => {
                let shape = self.physics[treatment.model].corrected(&self.omega, treatment.correction);
                self.corrected.insert(id.clone(), (treatment, shape.clone()));
                shape
            }
        }
    }

    fn of_bundle(&self, kind: BundleKind) -> &[Shape] {
        match kind {
            BundleKind::Physics => &self.physics,
            BundleKind::Identified => &self.identified,
        }
    }
}

/// Every curve of one response in the condition shown; none until its responses are there.
pub fn bode_curves(state: &mut State, pair: Pair) -> Vec<BodeCurve> {
    let Some(curves) = state.curves().cloned() else {
        return Vec::new();
    };
    let position = |name| curves.condition.position(BundleKind::Identified, name);
    let reference =
        state.shown().and_then(|shown| position(shown.representative_name(BundleKind::Identified))).unwrap_or(0);
    let mut shapes = state.display.shapes.remove(&pair).unwrap_or_default();
    shapes.refresh(&curves, pair, reference);
    let mut drawn = model_curves(state, &curves.condition, &shapes, BundleKind::Physics);
    drawn.extend(model_curves(state, &curves.condition, &shapes, BundleKind::Identified));
    if let Some(shown) = state.shown() {
        drawn.extend(corrected_curves(state, &curves.condition, &mut shapes, shown, pair));
    }
    state.display.shapes.insert(pair, shapes);
    drawn
}

/// The models of the condition that the shapes were computed of.
fn model_curves(state: &State, condition: &Condition, shapes: &CachedShapes, kind: BundleKind) -> Vec<BodeCurve> {
    let shown = state.shown();
    let representative = shown.map(|shown| shown.representative_name(kind));
    let models = condition.bundle(kind);
    let isolated = state.display.isolated.as_ref().filter(|id| id.condition == condition.id());
    let is_visible =
        |name: &str| isolated.is_none_or(|id| (id.bundle == kind && id.name == name) || representative == Some(name));
    let curve = |(model, shape): (&Model, &Shape)| {
        let id = ModelId::new(condition.id(), kind, &model.name);
        let rejected = state.study.is_rejected(&id);
        BodeCurve {
            label: model.name.clone(),
            detail: detail(shown, model, &id, rejected),
            role: role_of(kind, model.is_nominal(), representative == Some(&model.name)),
            rejected,
            highlighted: state.display.hovered.as_ref() == Some(&id),
            id: CurveId::Model(id),
            omega: Arc::clone(&shapes.omega),
            magnitude_db: Arc::clone(&shape.magnitude_db),
            phase_deg: Arc::clone(&shape.phase_deg),
        }
    };
    let shapes_of = shapes.of_bundle(kind);
    models.iter().zip(shapes_of).filter(|(model, _)| is_visible(&model.name)).map(curve).collect()
}

fn role_of(kind: BundleKind, nominal: bool, represents: bool) -> Role {
    match (kind, nominal, represents) {
        (BundleKind::Physics, true, _) => Role::Nominal,
        (BundleKind::Physics, false, true) => Role::Representative,
        (BundleKind::Physics, false, false) => Role::Perturbed,
        (BundleKind::Identified, _, true) => Role::IdentifiedRepresentative,
        (BundleKind::Identified, _, false) => Role::Identified,
    }
}

/// "ratio 3.68, suggested as an outlier · click to reject".
fn detail(shown: Option<&ConditionAnalysis>, model: &Model, id: &ModelId, rejected: bool) -> String {
    let ratio =
        shown.filter(|_| id.bundle == BundleKind::Physics).and_then(|shown| shown.discontinuity_ratio(&id.name));
    let action = if rejected { "click to restore" } else { "click to reject" };
    let ratio = ratio.map(|ratio| {
        let verdict = if ratio > SUGGESTION_RATIO { ", suggested as an outlier" } else { "" };
        format!("ratio {ratio:.2}{verdict}")
    });
    let source = model.source.as_ref().map(|source| format!("from {}", source.words()));
    ratio.into_iter().chain(source).chain([action.to_owned()]).collect::<Vec<_>>().join(" · ")
}

fn corrected_curves(
    state: &State,
    condition: &Condition,
    shapes: &mut CachedShapes,
    shown: &ConditionAnalysis,
    pair: Pair,
) -> Vec<BodeCurve> {
    let name = shown.representative_name(BundleKind::Physics);
    let Some(model) = condition.position(BundleKind::Physics, name) else {
        return Vec::new();
    };
    let airspeed_kt = state.condition().flight_state().airspeed_kt;
    let mut curve = |id: CurveId, label: String, role: Role, correction: &ChannelCorrection| {
        let shape = shapes.corrected(&id, Treatment { model, correction: correction.on(pair)? });
        let (net_gain, delay_ms) = (correction.net_gain(pair).value(), s_to_ms(correction.net_delay(pair).value_s()));
        Some(BodeCurve {
            id,
            label,
            detail: format!("net gain {net_gain:.3}, net delay {delay_ms:.1} ms"),
            role,
            rejected: false,
            highlighted: false,
            omega: Arc::clone(&shapes.omega),
            magnitude_db: shape.magnitude_db,
            phase_deg: shape.phase_deg,
        })
    };
    let own = curve(CurveId::Corrected, format!("{name}, corrected"), Role::Corrected, &shown.correction);
    let mut curves: Vec<BodeCurve> = own.into_iter().collect();
    if let Some(Ok(schedule)) = state.analysis().map(|analysis| &analysis.schedule) {
        let older = if state.others_are_older() { " of older settings" } else { "" };
        let label = format!("{name}, scheduled{older}");
        curves.extend(curve(CurveId::Scheduled, label, Role::Scheduled, &schedule.at(airspeed_kt)));
    }
    curves
}
