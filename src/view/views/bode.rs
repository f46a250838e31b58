//! The focused response, large.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::Ui;
use gdcm_core::dataset::{BundleKind, ModelBands, Pair};
use gdcm_core::identification::TWO_SIDED_95;
use gdcm_core::response::{FrequencyResponse, GainDelay, ResponseShape, wrapped_deg};
use gdcm_core::study::ConditionCurves;

use super::frequency::{
    CorrectedFace, CurveFace, Drawn, carry_over, chips, corrected_faces, cursor_readout, model_faces, reference_of,
};
use crate::view::command::Command;
use crate::view::palette::Palette;
use crate::view::plot::{BodeBand, BodeCurve, BodeQuantity, BodeScene, CurveId, PhaseUnit, ResponsePlace, bode_ui};
use crate::view::state::State;

/// Magnitude and phase of the response in focus, of every model of the condition shown.
pub fn bode_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let pair = state.display.pair;
    let mut view = std::mem::take(&mut state.display.bode);
    let curves = bode_curves(state, pair);
    let title = state.dataset().pair_name(pair);
    let ratio_unit = ratio_unit(state);
    let display = &state.display.curves;
    let quantity = BodeQuantity::Response {
        magnitude: display.magnitude,
        phase: display.phase,
        ratio_unit: &ratio_unit,
        place: ResponsePlace::Condition,
    };
    let at = (display.cursor, display.pinned.as_slice());
    let readout = if display.lists_values { cursor_readout(&curves, quantity, state.display.unit, at) } else { None };
    let chips: Vec<_> = chips(state).into_iter().map(|(chip, _)| chip).collect();
    let band = state.study.settings.band;
    let bands = uncertainty_bands(state, pair, &curves);
    let scene = BodeScene {
        quantity,
        bands: &bands,
        cursor: display.cursor,
        pinned: &display.pinned,
        readout: readout.as_ref(),
        hidden_roles: &display.hidden_roles,
        chips: &chips,
        unit: state.display.unit,
        stale: state.results.is_stale(ui.input(|input| input.time)),
        message: state.curves_message(),
        ..BodeScene::of(&title, &curves, (band.min(), band.max()))
    };
    let events = bode_ui(ui, &scene, &mut view, palette);
    carry_over(state, Drawn { quantity, curves: &curves, view: &view, events }, commands);
    state.display.error.share_frequencies(&view);
    state.display.bode = view;
    state.display.drawn = curves;
}

/// "(deg/s)/in": the unit of the ratio of output to input.
fn ratio_unit(state: &State) -> String {
    let pair = state.display.pair;
    let (output, input) = (&state.dataset().outputs()[pair.output].unit, &state.dataset().inputs()[pair.input].unit);
    let bracketed = |unit: &str| if unit.contains('/') { format!("({unit})") } else { unit.to_owned() };
    format!("{}/{}", bracketed(output), bracketed(input))
}

/// Shapes of every model of the condition shown for one response, kept while neither changes.
#[derive(Debug, Default)]
pub struct CachedShapes {
    made_of: Option<(Arc<ConditionCurves>, Pair, usize)>,
    omega: Arc<[f64]>,
    physics: Vec<ResponseShape>,
    identified: Vec<ResponseShape>,
    /// Of each corrected curve: what it was made with, and its shape.
    corrected: BTreeMap<CurveId, (Treatment, ResponseShape)>,
    /// Phases that are not drawn as they are, by their curves.
    presented: BTreeMap<CurveId, PresentedPhase>,
}

/// A phase that is not drawn as it is.
#[derive(Clone, Debug)]
struct PresentedPhase {
    /// The phase as it is \[deg\].
    phase_deg: Arc<[f64]>,
    how: Presentation,
    /// What is drawn of it \[deg\].
    drawn_deg: Arc<[f64]>,
}

/// How a phase is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Presentation {
    unit: PhaseUnit,
    /// Whole turns up.
    turns: i32,
}

impl Presentation {
    /// The continuous phase \[deg\] as it is drawn. A wrapped one has a gap where it jumps, in place of a line from edge to edge.
    fn of(self, phase_deg: &[f64]) -> Arc<[f64]> {
        if self.unit == PhaseUnit::Unwrapped {
            return phase_deg.iter().map(|phase| phase + 360.0 * f64::from(self.turns)).collect();
        }
        wrapped_deg(phase_deg).into()
    }
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
        let reference_shape = ResponseShape::of(&curves.identified[reference].curve(pair));
        let shapes = |kind| {
            let laid = |response: &Arc<FrequencyResponse>| {
                ResponseShape::of(&response.curve(pair)).phase_aligned(&reference_shape)
            };
            curves.bundle(kind).iter().map(laid).collect()
        };
        self.physics = shapes(BundleKind::Physics);
        self.identified = shapes(BundleKind::Identified);
        self.omega = curves.grid.omega().into();
        self.corrected.clear();
        self.presented.clear();
        self.made_of = Some((Arc::clone(curves), pair, reference));
    }

    /// The corrected shape of the curve `id`: the same one until it is made with something else.
    fn corrected(&mut self, id: &CurveId, treatment: Treatment) -> ResponseShape {
        match self.corrected.get(id) {
            Some((with, shape)) if *with == treatment => shape.clone(),
            _ => {
                let shape = self.physics[treatment.model].corrected(&self.omega, treatment.correction);
                self.corrected.insert(id.clone(), (treatment, shape.clone()));
                shape
            }
        }
    }

    /// The phase of the curve `id` as it is drawn: the same one until something of it changes.
    fn presented(&mut self, id: &CurveId, phase_deg: &Arc<[f64]>, how: Presentation) -> Arc<[f64]> {
        if how == (Presentation { unit: PhaseUnit::Unwrapped, turns: 0 }) {
            return Arc::clone(phase_deg);
        }
        let is_same = |before: &&PresentedPhase| Arc::ptr_eq(&before.phase_deg, phase_deg) && before.how == how;
        if let Some(before) = self.presented.get(id).filter(is_same) {
            return Arc::clone(&before.drawn_deg);
        }
        let drawn_deg = how.of(phase_deg);
        let presented = PresentedPhase { phase_deg: Arc::clone(phase_deg), how, drawn_deg: Arc::clone(&drawn_deg) };
        self.presented.insert(id.clone(), presented);
        drawn_deg
    }

    fn of_bundle(&self, kind: BundleKind) -> &[ResponseShape] {
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
    let reference = reference_of(state, &curves.condition);
    let mut shapes = state.display.shapes.remove(&pair).unwrap_or_default();
    shapes.refresh(&curves, pair, reference);
    let mut drawn = Vec::new();
    let mut draw = |shapes: &mut CachedShapes, face: CurveFace, shape: ResponseShape| {
        let turns = state.display.curves.turns_of(curves.condition.id(), pair, &face.id);
        let how = Presentation { unit: state.display.curves.phase, turns };
        let phase_deg = shapes.presented(&face.id, &shape.phase_deg, how);
        drawn.push(face.moved_by_hand(turns).with(&shapes.omega, &shape.magnitude_db, &phase_deg));
    };
    for kind in BundleKind::BOTH {
        for (index, face) in model_faces(state, &curves.condition, kind) {
            let shape = shapes.of_bundle(kind)[index].clone();
            draw(&mut shapes, face, shape);
        }
    }
    for CorrectedFace { face, model, correction } in corrected_faces(state, &curves.condition, pair) {
        let shape = shapes.corrected(&face.id, Treatment { model, correction });
        draw(&mut shapes, face, shape);
    }
    state.display.shapes.insert(pair, shapes);
    drawn
}

/// The 95 % band of every identified model that is drawn, is kept, and says how uncertain it is.
pub fn uncertainty_bands(state: &State, pair: Pair, curves: &[BodeCurve]) -> Vec<BodeBand> {
    let band = |curve: &BodeCurve| {
        let CurveId::Model(id) = &curve.id else { return None };
        let is_shown = id.bundle == BundleKind::Identified && !curve.rejected && !curve.hidden;
        let bands = state.dataset().model(id).filter(|_| is_shown)?.bands.as_ref()?;
        Some(band_around(curve, bands, pair))
    };
    curves.iter().filter_map(band).collect()
}

fn band_around(curve: &BodeCurve, bands: &ModelBands, pair: Pair) -> BodeBand {
    let (db, deg) = (&bands.sd_db()[pair], &bands.sd_deg()[pair]);
    let mut band = BodeBand::default();
    for (index, omega) in curve.omega.iter().enumerate() {
        let Some((at, part)) = place(bands.omega(), *omega) else { continue };
        let sd = |values: &[f64]| TWO_SIDED_95 * (values[at] + part * (values[at + 1] - values[at]));
        let around = |value: f64, half: f64| [value - half, value + half];
        band.omega.push(*omega);
        band.magnitude_db.push(around(curve.magnitude_db[index], sd(db)));
        band.phase_deg.push(around(curve.phase_deg[index], sd(deg)));
    }
    band
}

/// Between which two of `omegas` a frequency lies, and how far by its logarithm; none outside of them.
fn place(omegas: &[f64], omega: f64) -> Option<(usize, f64)> {
    let above = omegas.partition_point(|of| *of <= omega);
    let at = above.checked_sub(1)?;
    match omegas.get(above) {
        Some(next) => Some((at, (omega / omegas[at]).ln() / (next / omegas[at]).ln())),
        None if omegas[at] == omega && at > 0 => Some((at - 1, 1.0)),
        None => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrapped_phase_stays_within_half_a_turn_and_has_a_gap_where_it_jumps() {
        let wrapped = Presentation { unit: PhaseUnit::Wrapped, turns: 0 }.of(&[-100.0, -170.0, -190.0, -200.0]);
        // Two roundings of angles below 360.
        assert!((wrapped[1] + 170.0).abs() < 1e-12 && (wrapped[3] - 160.0).abs() < 1e-12);
        assert!(wrapped[2].is_nan(), "{wrapped:?}");
    }

    #[test]
    fn a_turn_by_hand_moves_a_phase_by_360_degrees() {
        let up = Presentation { unit: PhaseUnit::Unwrapped, turns: 1 }.of(&[-100.0, f64::NAN]);
        assert!(up[0] == 260.0 && up[1].is_nan());
    }
}

#[cfg(test)]
mod tests2 {
    use super::*;

    #[test]
    fn a_frequency_lies_between_two_by_its_logarithm_and_nowhere_outside() {
        let omegas = [1.0, 10.0, 100.0];
        assert_eq!(place(&omegas, 10.0), Some((1, 0.0)));
        let (at, part) = place(&omegas, 10f64.powf(1.5)).unwrap();
        assert!(at == 1 && (part - 0.5).abs() < 1e-12);
        assert_eq!(place(&omegas, 100.0), Some((1, 1.0)), "the last one belongs to the band");
        assert_eq!((place(&omegas, 0.9), place(&omegas, 101.0)), (None, None));
    }
}
