//! The curves of the focused response, made of what was computed.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Complex;

use crate::correction::ChannelCorrection;
use crate::dataset::{BundleKind, ModelId, Pair};
use crate::fidelity::SUGGESTION_RATIO;
use crate::response::{FrequencyResponse, GainDelay, nearest_turn_offset, unwrap};
use crate::study::{ConditionAnalysis, ConditionCurves};
use crate::units::{ratio_to_db, s_to_ms};

use super::plot::{BodeCurve, CurveId, Role};
use super::state::State;

/// What a curve of the large plot stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveSubject {
    /// One model as it is.
    Model(ModelId),
    /// The representative physics model with the condition's own correction.
    Corrected,
    /// The representative physics model with the scheduled correction.
    Scheduled,
}

const CORRECTED: u64 = u64::MAX;
const SCHEDULED: u64 = u64::MAX - 1;

/// The number by which the plot names a model of the condition shown.
fn curve_id(bundle: BundleKind, model: usize) -> CurveId {
    let of_bundle = match bundle {
        BundleKind::Physics => 0,
        BundleKind::Identified => 1,
    };
    CurveId(2 * model as u64 + of_bundle)
}

/// What the plot means by a number, in the condition of index `condition`.
pub fn subject_of(id: CurveId, condition: usize) -> CurveSubject {
    match id.0 {
        CORRECTED => CurveSubject::Corrected,
        SCHEDULED => CurveSubject::Scheduled,
        number => {
            let bundle = if number % 2 == 0 { BundleKind::Physics } else { BundleKind::Identified };
            CurveSubject::Model(ModelId { condition, bundle, model: (number / 2) as usize })
        }
    }
}

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
    /// Of each corrected curve, by its number: what it was made with, and its shape.
    corrected: BTreeMap<u64, (Treatment, Shape)>,
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
            let laid = |response: &FrequencyResponse| Shape::of(&response.curve(pair)).laid_on(&reference_shape);
            curves.bundle(kind).iter().map(laid).collect()
        };
        self.physics = shapes(BundleKind::Physics);
        self.identified = shapes(BundleKind::Identified);
        self.omega = curves.grid.omega().into();
        self.corrected.clear();
        self.made_of = Some((Arc::clone(curves), pair, reference));
    }

    /// The corrected shape of the curve `id`: the same one until it is made with something else.
    fn corrected(&mut self, id: u64, treatment: Treatment) -> Shape {
        match self.corrected.get(&id) {
            Some((with, shape)) if *with == treatment => shape.clone(),
            _ => {
                let shape = self.physics[treatment.model].corrected(&self.omega, treatment.correction);
                self.corrected.insert(id, (treatment, shape.clone()));
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
    let Some((condition, curves)) = state.results.curves.clone() else {
        return Vec::new();
    };
    let fits = condition == state.display.condition
        && curves.physics.len() == state.condition().bundle(BundleKind::Physics).len()
        && curves.identified.len() == state.condition().bundle(BundleKind::Identified).len();
    if !fits {
        return Vec::new();
    }
    let reference = state.shown().map_or(0, |shown| shown.comparison.identified.model);
    let mut shapes = state.display.shapes.remove(&pair).unwrap_or_default();
    shapes.refresh(&curves, pair, reference);
    let mut drawn = model_curves(state, &shapes, BundleKind::Physics);
    drawn.extend(model_curves(state, &shapes, BundleKind::Identified));
    if let Some(shown) = state.shown() {
        drawn.extend(corrected_curves(state, &mut shapes, shown, pair));
    }
    state.display.shapes.insert(pair, shapes);
    drawn
}

fn model_curves(state: &State, shapes: &CachedShapes, kind: BundleKind) -> Vec<BodeCurve> {
    let shown = state.shown();
    let representative = shown.map(|shown| match kind {
        BundleKind::Physics => shown.comparison.physics.model,
        BundleKind::Identified => shown.comparison.identified.model,
    });
    let models = state.condition().bundle(kind);
    let isolated = state.display.isolated.filter(|id| id.condition == state.display.condition);
    let visible =
        |index: &usize| isolated.is_none_or(|id| id == state.model_id(kind, *index) || representative == Some(*index));
    (0..models.len())
        .filter(visible)
        .map(|index| {
            let id = state.model_id(kind, index);
            let shape = &shapes.of_bundle(kind)[index];
            let rejected = state.study.is_rejected(id);
            BodeCurve {
                id: curve_id(kind, index),
                label: models[index].name.clone(),
                detail: detail(shown, kind, index, rejected),
                role: role_of(kind, models[index].is_nominal(), representative == Some(index)),
                rejected,
                highlighted: state.display.hovered == Some(id),
                omega: Arc::clone(&shapes.omega),
                magnitude_db: Arc::clone(&shape.magnitude_db),
                phase_deg: Arc::clone(&shape.phase_deg),
            }
        })
        .collect()
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
fn detail(shown: Option<&ConditionAnalysis>, kind: BundleKind, index: usize, rejected: bool) -> String {
    let discontinuity = shown.and_then(|shown| shown.figures.discontinuity.as_ref().ok());
    let ratio =
        discontinuity.and_then(|discontinuity| discontinuity.ratios[index]).filter(|_| kind == BundleKind::Physics);
    let action = if rejected { "click to restore" } else { "click to reject" };
    match ratio {
        Some(ratio) if ratio > SUGGESTION_RATIO => format!("ratio {ratio:.2}, suggested as an outlier · {action}"),
        Some(ratio) => format!("ratio {ratio:.2} · {action}"),
        None => action.to_owned(),
    }
}

fn corrected_curves(state: &State, shapes: &mut CachedShapes, shown: &ConditionAnalysis, pair: Pair) -> Vec<BodeCurve> {
    let model = shown.comparison.physics.model;
    let name = &state.condition().bundle(BundleKind::Physics)[model].name;
    let airspeed_kt = state.condition().flight_state().airspeed_kt;
    let mut curve = |id: u64, label: String, role: Role, correction: &ChannelCorrection| {
        let shape = shapes.corrected(id, Treatment { model, correction: correction.on(pair)? });
        let (net_gain, delay_ms) = (correction.net_gain(pair).value(), s_to_ms(correction.net_delay(pair).value_s()));
        Some(BodeCurve {
            id: CurveId(id),
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
    let own = curve(CORRECTED, format!("{name}, corrected"), Role::Corrected, &shown.correction);
    let mut curves: Vec<BodeCurve> = own.into_iter().collect();
    if let Some(Ok(schedule)) = state.analysis().map(|analysis| &analysis.schedule) {
        curves.extend(curve(SCHEDULED, format!("{name}, scheduled"), Role::Scheduled, &schedule.at(airspeed_kt)));
    }
    curves
}
