//! What the fit sees of the focused response.

use std::sync::Arc;

use egui::Ui;
use gdcm_core::dataset::{BundleKind, Pair};
use gdcm_core::fidelity::{CoherenceWeights, Mismatch, Muad, leaves};
use gdcm_core::response::{FrequencyResponse, GainDelay, PolarCurve, quantile, wrap};
use gdcm_core::study::{ConditionAnalysis, ConditionCurves, Undefined};
use gdcm_core::units::{ratio_to_db, s_to_ms};

use super::frequency::{
    CorrectedFace, Drawn, carry_over, chips, corrected_faces, cursor_readout, model_faces, reference_of,
};
use crate::view::command::Command;
use crate::view::curve_display::CurveCommand;
use crate::view::palette::Palette;
use crate::view::plot::{
    BodeCurve, BodeQuantity, BodeScene, CurveId, Level, Pane, PhaseErrorUnit, Rule, RuleKind, bode_ui,
};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;

/// The errors of the response in focus, of every physics model kept, beside those that the correction leaves.
pub fn error_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let pair = state.display.pair;
    let mut view = std::mem::take(&mut state.display.error);
    let curves = error_curves(state, pair);
    let (rules, strips) = (error_rules(state, pair, &curves), noticed(state, &curves));
    let (title, message) = (state.dataset().pair_name(pair), error_message(state, pair));
    let display = &state.display.curves;
    let quantity = BodeQuantity::Error { phase: display.phase_error };
    let at = (display.cursor, display.pinned.as_slice());
    let readout = if display.lists_values { cursor_readout(&curves, quantity, state.display.unit, at) } else { None };
    let chips: Vec<_> = chips(state).into_iter().map(|(chip, _)| chip).collect();
    let band = state.study.settings.band;
    let grid = state.curves().map(|curves| curves.grid.omega());
    let scene = BodeScene {
        quantity,
        rules: &rules,
        strips: &strips,
        omega_range: grid.and_then(|omega| Some((*omega.first()?, *omega.last()?))),
        cursor: display.cursor,
        pinned: &display.pinned,
        readout: readout.as_ref(),
        hidden_roles: &display.hidden_roles,
        chips: &chips,
        unit: state.display.unit,
        stale: state.results.is_stale(ui.input(|input| input.time)),
        message: Some(&message),
        ..BodeScene::of(&title, &curves, (band.min(), band.max()))
    };
    let events = bode_ui(ui, &scene, &mut view, palette);
    carry_over(state, Drawn { quantity, curves: &curves, view: &view, events }, commands);
    state.display.bode.share_frequencies(&view);
    state.display.error = view;
    state.display.drawn_errors = curves;
}

/// How differences of phases are read.
pub fn error_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut unit = state.display.curves.phase_error;
    let units = [
        (PhaseErrorUnit::Degree, "Δφ", "Phase differences in degrees"),
        (PhaseErrorUnit::Millisecond, "Δφ/ω", "The delay [ms] that would make up for each phase difference"),
    ];
    choice_ui(ui, "Phase error", &mut unit, &units);
    if unit != state.display.curves.phase_error {
        commands.push(CurveCommand::DrawPhaseErrors(unit).into());
    }
}

/// How far one response is from the reference, and on which branch.
#[derive(Clone, Debug)]
struct ErrorShape {
    /// `20 log10 |H_sim| / |H_ref|`.
    mismatch_db: Vec<f64>,
    /// `Delta phi(H_sim, H_ref)` \[rad\] (M3, M6b): never a difference of two phases that were unwrapped apart.
    phase: Vec<f64>,
}

/// What is drawn of it: `20 log10 |H_ref| / |H_sim|`, and `Delta phi` in degrees or `Delta phi / omega` in milliseconds.
#[derive(Clone, Debug)]
struct DrawnError {
    magnitude_db: Arc<[f64]>,
    phase: Arc<[f64]>,
}

impl ErrorShape {
    /// The error at the frequencies that count; none where none does. Not a number at the others (M4a).
    fn of(
        simulated: &PolarCurve,
        reference: &PolarCurve,
        omega: &[f64],
        coherence_weights: Option<&CoherenceWeights>,
    ) -> Option<Self> {
        let mismatch = Mismatch::new(simulated, reference).coherence_weighted(coherence_weights)?;
        let phase = mismatch.on_grid(mismatch.phase_difference(omega), omega.len());
        Some(Self { phase, mismatch_db: mismatch.on_grid(mismatch.magnitude_db.clone(), omega.len()) })
    }

    /// After a gain and a delay of the simulated response (M10), which leave it on its branch.
    fn drawn(&self, correction: GainDelay, omega: &[f64], unit: PhaseErrorUnit) -> DrawnError {
        let phase = correction.phases(&self.phase, omega).zip(omega);
        DrawnError {
            magnitude_db: correction.magnitudes_db(&self.mismatch_db, omega).map(|db| -db).collect(),
            phase: match unit {
                PhaseErrorUnit::Degree => phase.map(|(phase, _)| phase.to_degrees()).collect(),
                PhaseErrorUnit::Millisecond => phase.map(|(phase, omega)| s_to_ms(phase / omega)).collect(),
            },
        }
    }
}

/// What the errors are made of.
#[derive(Clone, Debug)]
struct Made {
    curves: Arc<ConditionCurves>,
    pair: Pair,
    reference: usize,
    band: (f64, f64),
    /// Least coherence that counts.
    coherence: Option<f64>,
    unit: PhaseErrorUnit,
}

impl Made {
    fn is_same(&self, other: &Self) -> bool {
        let key = |made: &Self| (made.pair, made.reference, made.band, made.coherence, made.unit);
        Arc::ptr_eq(&self.curves, &other.curves) && key(self) == key(other)
    }

    /// The response of a model in the band; nothing where it is zero or not finite somewhere in it.
    fn polar(&self, response: &FrequencyResponse) -> Option<PolarCurve> {
        let omega = self.curves.grid.omega();
        let from = omega.partition_point(|omega| *omega < self.band.0);
        let to = omega.partition_point(|omega| *omega <= self.band.1);
        PolarCurve::of(response.curve(self.pair).get(from..to)?)
    }

    /// The frequencies among `omega` that count, where the reference's coherence says that.
    fn coherence_weights(&self, omega: &[f64]) -> Option<CoherenceWeights> {
        let flight = &self.curves.condition.bundle(BundleKind::Identified)[self.reference].dynamics;
        Some(CoherenceWeights::of_model(flight, omega, self.coherence)?[self.pair].clone())
    }

    fn omega(&self) -> Arc<[f64]> {
        let within = |omega: &&f64| (self.band.0..=self.band.1).contains(*omega);
        self.curves.grid.omega().iter().filter(within).copied().collect()
    }
}

/// Errors of every physics model of the condition shown for one response, kept while nothing of it changes.
#[derive(Debug, Default)]
pub struct CachedErrors {
    made: Option<Made>,
    omega: Arc<[f64]>,
    /// Zero at each frequency: the reference itself.
    zero: Arc<[f64]>,
    /// In the order of the physics models.
    errors: Vec<Option<(ErrorShape, DrawnError)>>,
    /// Of each corrected curve: what it was made with, and what is drawn of it.
    corrected: Vec<(CurveId, usize, GainDelay, DrawnError)>,
}

impl CachedErrors {
    fn refresh(&mut self, made: Made) {
        if self.made.as_ref().is_some_and(|before| before.is_same(&made)) {
            return;
        }
        self.omega = made.omega();
        self.zero = vec![0.0; self.omega.len()].into();
        self.corrected.clear();
        let reference = made.polar(&made.curves.identified[made.reference]);
        let coherence_weights = made.coherence_weights(&self.omega);
        let error = |response: &Arc<FrequencyResponse>| {
            let shape =
                ErrorShape::of(&made.polar(response)?, reference.as_ref()?, &self.omega, coherence_weights.as_ref())?;
            let drawn = shape.drawn(GainDelay::NONE, &self.omega, made.unit);
            Some((shape, drawn))
        };
        self.errors = made.curves.physics.iter().map(error).collect();
        self.made = Some(made);
    }

    fn corrected(&mut self, id: &CurveId, model: usize, correction: GainDelay) -> Option<DrawnError> {
        let same =
            |made: &&(CurveId, usize, GainDelay, DrawnError)| (&made.0, made.1, made.2) == (id, model, correction);
        if let Some((.., drawn)) = self.corrected.iter().find(same) {
            return Some(drawn.clone());
        }
        let drawn = self.errors[model].as_ref()?.0.drawn(correction, &self.omega, self.made.as_ref()?.unit);
        self.corrected.retain(|(of, ..)| of != id);
        self.corrected.push((id.clone(), model, correction, drawn.clone()));
        Some(drawn)
    }
}

/// The error over the band of every kept physics model, of the representative after its correction and after the schedule's, and the
/// reference as the line at zero; none until the responses are there.
pub fn error_curves(state: &mut State, pair: Pair) -> Vec<BodeCurve> {
    let Some(curves) = state.curves().cloned() else {
        return Vec::new();
    };
    let band = state.study.settings.band;
    let condition = Arc::clone(&curves.condition);
    let reference = reference_of(state, &condition);
    let unit = state.display.curves.phase_error;
    let mut errors = std::mem::take(&mut state.display.errors);
    let coherence = state.study.settings.coherence_threshold;
    errors.refresh(Made { curves, pair, reference, band: (band.min(), band.max()), coherence, unit });
    let mut drawn = Vec::new();
    for (index, face) in model_faces(state, &condition, BundleKind::Physics).filter(|(_, face)| !face.rejected) {
        if let Some((_, error)) = &errors.errors[index] {
            drawn.push(face.with(&errors.omega, &error.magnitude_db, &error.phase));
        }
    }
    if !drawn.is_empty() {
        let faces = model_faces(state, &condition, BundleKind::Identified);
        drawn.extend(
            faces
                .filter(|(index, _)| *index == reference)
                .map(|(_, face)| face.with(&errors.omega, &errors.zero, &errors.zero)),
        );
    }
    for CorrectedFace { face, model, correction } in corrected_faces(state, &condition, pair) {
        if let Some(error) = errors.corrected(&face.id, model, correction) {
            drawn.push(face.with(&errors.omega, &error.magnitude_db, &error.phase));
        }
    }
    state.display.errors = errors;
    drawn
}

/// G and D, the bounds of the channels, and quantiles of the representative's error among `drawn`: what the fit makes of it (M6, M7).
pub fn error_rules(state: &State, pair: Pair, drawn: &[BodeCurve]) -> Vec<Rule> {
    let Some(shown) = state.shown() else { return Vec::new() };
    let unit = state.display.curves.phase_error;
    let mut rules = delta_rules(shown, pair, unit);
    rules.extend(bound_rules(shown, unit));
    let name = shown.representative_name(BundleKind::Physics);
    let is_representative = |curve: &&BodeCurve| matches!(&curve.id, CurveId::Model(id) if id.bundle == BundleKind::Physics && id.name == name);
    if let Some(curve) = drawn.iter().find(is_representative) {
        rules.extend(quantile_rules(curve, state.study.settings.quantile, unit));
    }
    if let Some(curve) = drawn.first().filter(|_| state.display.curves.shows_muad) {
        rules.extend(muad_rules(&curve.omega, unit));
    }
    rules
}

/// The envelopes of unnoticeable added dynamics over the frequencies of an error (MIL-STD-1797A). They are those of model over
/// reference: what is drawn above is its inverse, what is drawn below is not.
fn muad_rules(omega: &[f64], unit: PhaseErrorUnit) -> Vec<Rule> {
    let phase = |omega: f64, degrees: f64| match unit {
        PhaseErrorUnit::Degree => degrees,
        PhaseErrorUnit::Millisecond => s_to_ms(degrees.to_radians() / omega),
    };
    let rule = |pane, label: &str, value: &dyn Fn(f64) -> f64| {
        let level = Level::Sampled(omega.iter().map(|&omega| [omega, value(omega)]).collect());
        Rule { pane, kind: RuleKind::Envelope, label: label.to_owned(), level }
    };
    [(0, "unnoticed below, MUAD"), (1, "unnoticed above, MUAD")]
        .into_iter()
        .flat_map(|(end, label)| {
            [
                rule(Pane::Magnitude, label, &|omega| -Muad::at(omega).magnitude_db[end]),
                rule(Pane::Phase, label, &|omega| phase(omega, Muad::at(omega).phase_deg[end])),
            ]
        })
        .collect()
}

/// Where what is left of the mismatch would be noticed \[rad/s\]: that of the corrected curve among `drawn`.
pub fn noticed(state: &State, drawn: &[BodeCurve]) -> Vec<(f64, f64)> {
    let curves = &state.display.curves;
    let corrected = drawn.iter().find(|curve| curve.id == CurveId::Corrected).filter(|_| curves.shows_muad);
    let Some(curve) = corrected else { return Vec::new() };
    let errors = curve.omega.iter().zip(curve.magnitude_db.iter().zip(curve.phase_deg.iter()));
    let (mut omega, mut error_db, mut principal_deg) = (Vec::new(), Vec::new(), Vec::new());
    // There is no error at frequencies that do not count.
    for (&at, (&db, &phase)) in errors.filter(|(_, (db, _))| db.is_finite()) {
        let radians = match curves.phase_error {
            PhaseErrorUnit::Degree => phase.to_radians(),
            PhaseErrorUnit::Millisecond => 1e-3 * phase * at,
        };
        omega.push(at);
        error_db.push(-db);
        principal_deg.push(wrap(radians).to_degrees());
    }
    leaves(&omega, &error_db, &principal_deg)
}

/// A delay as a line in the pane of phase errors.
fn delay_rule(kind: RuleKind, label: String, delay_s: f64, unit: PhaseErrorUnit) -> Rule {
    let level = match unit {
        PhaseErrorUnit::Degree => Level::PerOmega(delay_s.to_degrees()),
        PhaseErrorUnit::Millisecond => Level::Constant(s_to_ms(delay_s)),
    };
    Rule { pane: Pane::Phase, kind, label, level }
}

fn gain_rule(kind: RuleKind, label: String, gain: f64) -> Rule {
    Rule { pane: Pane::Magnitude, kind, label, level: Level::Constant(ratio_to_db(gain)) }
}

fn signed(value: f64) -> String {
    format!("{value:.1}").replace('-', "\u{2212}")
}

fn delta_rules(shown: &ConditionAnalysis, pair: Pair, unit: PhaseErrorUnit) -> Vec<Rule> {
    let gain = shown.wanted_gain(pair).map(|gain| {
        let label = format!("G {gain:.3} ({} dB), median over the band", signed(ratio_to_db(gain)));
        gain_rule(RuleKind::Delta, label, gain)
    });
    let delay = shown.wanted_delay_s(pair).map(|delay_s| {
        let meaning = if delay_s < 0.0 { ": lead is missing" } else { "" };
        let label = format!("D {} ms{meaning}", signed(s_to_ms(delay_s)));
        delay_rule(RuleKind::Delta, label, delay_s, unit)
    });
    gain.into_iter().chain(delay).collect()
}

fn bound_rules(shown: &ConditionAnalysis, unit: PhaseErrorUnit) -> Vec<Rule> {
    let (bounds, delay_s) = (shown.gain_bounds(), shown.delay_upper_s());
    vec![
        gain_rule(RuleKind::Bound, format!("LB {:.3}", bounds.lower), bounds.lower),
        gain_rule(RuleKind::Bound, format!("UB {:.3}", bounds.upper), bounds.upper),
        delay_rule(RuleKind::Bound, format!("UB {} ms", signed(s_to_ms(delay_s))), delay_s, unit),
    ]
}

/// The quantiles of one response's error: what M7 would take were there no others.
fn quantile_rules(curve: &BodeCurve, q: f64, unit: PhaseErrorUnit) -> Vec<Rule> {
    let delays = curve.omega.iter().zip(curve.phase_deg.iter()).map(|(omega, phase)| match unit {
        PhaseErrorUnit::Degree => phase.to_radians() / omega,
        PhaseErrorUnit::Millisecond => 1e-3 * phase,
    });
    // There is no error at frequencies that do not count.
    let finite = |values: &mut dyn Iterator<Item = f64>| values.filter(|value| value.is_finite()).collect::<Vec<f64>>();
    let (mut ratios_db, mut delays_s) = (finite(&mut curve.magnitude_db.iter().copied()), finite(&mut { delays }));
    let label = |q: f64| format!("{:.0} % quantile", 100.0 * q);
    [q, 1.0 - q]
        .into_iter()
        .flat_map(|q| {
            let level = Level::Constant(quantile(&mut ratios_db, q));
            let of_magnitude = Rule { pane: Pane::Magnitude, kind: RuleKind::Quantile, label: label(q), level };
            [of_magnitude, delay_rule(RuleKind::Quantile, label(q), quantile(&mut delays_s, q), unit)]
        })
        .collect()
}

/// What stands where there is no error to draw.
pub fn error_message(state: &State, pair: Pair) -> String {
    match state.shown() {
        Some(shown) if shown.comparison.undefined[pair] == Some(Undefined::NotCoherent) => {
            format!("{} is not compared: {}", state.dataset().pair_name(pair), Undefined::NotCoherent.words())
        }
        Some(shown) if shown.comparison.undefined[pair].is_some() => {
            let name = state.dataset().pair_name(pair);
            format!("{name} is not compared: one of the representatives has no such response in the band")
        }
        _ => state.curves_message().unwrap_or("Nothing to compare in the band").to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// A gain \[dB\] and a lead \[s\] over the reference, a response of one.
    fn error(omega: &[f64], gain_db: f64, lead_s: f64) -> ErrorShape {
        let polar = |gain_db: f64, lead_s: f64| PolarCurve {
            magnitude_db: vec![gain_db; omega.len()],
            phase: omega.iter().map(|omega| wrap(omega * lead_s)).collect(),
        };
        ErrorShape::of(&polar(gain_db, lead_s), &polar(0.0, 0.0), omega, None).unwrap()
    }

    #[test]
    fn the_right_gain_and_delay_bring_an_error_to_zero_on_its_branch() {
        // At 12 rad/s the lead is 1.15 turns: the phases themselves wrap.
        let omega: Vec<f64> = (1..=120).map(|k| 0.1 * f64::from(k)).collect();
        let error = error(&omega, 2.0, 0.6);
        let before = error.drawn(GainDelay::NONE, &omega, PhaseErrorUnit::Millisecond);
        // Roundings of angles of a turn, divided by 0.1 rad/s.
        assert!(before.phase.iter().all(|delay| (delay - 600.0).abs() < 1e-9) && omega[119] * 0.6 > TAU);
        assert_eq!(before.magnitude_db[0], -2.0, "the model is to be made smaller");
        let after = error.drawn(GainDelay::new(10f64.powf(-0.1), 0.6), &omega, PhaseErrorUnit::Degree);
        let values = after.magnitude_db.iter().chain(after.phase.iter());
        assert!(values.into_iter().all(|value| value.abs() < 1e-10));
    }

    #[test]
    fn frequencies_that_do_not_count_are_gaps() {
        let (omega, polar) = ([1.0, 2.0, 3.0], PolarCurve { magnitude_db: vec![1.0; 3], phase: vec![0.1; 3] });
        let coherence_weights = CoherenceWeights::of(&omega, &[0.9, 0.2, 0.9], 0.6, None);
        let shape = ErrorShape::of(&polar, &polar, &omega, Some(&coherence_weights)).unwrap();
        assert!(shape.mismatch_db[1].is_nan() && shape.phase[1].is_nan());
        assert_eq!((shape.mismatch_db[0], shape.phase[2]), (0.0, 0.0));
        let nothing = CoherenceWeights::of(&omega, &[0.0; 3], 0.6, None);
        assert!(ErrorShape::of(&polar, &polar, &omega, Some(&nothing)).is_none());
    }

    #[test]
    fn a_delay_is_a_ray_in_degrees_and_level_in_milliseconds() {
        let level = |unit| delay_rule(RuleKind::Delta, String::new(), 0.1, unit).level;
        assert_eq!(level(PhaseErrorUnit::Degree), Level::PerOmega(0.1f64.to_degrees()));
        assert_eq!(level(PhaseErrorUnit::Millisecond), Level::Constant(100.0));
    }

    #[test]
    fn the_envelopes_of_model_over_reference_are_mirrored_where_the_inverse_is_drawn() {
        let muad = Muad::at(2.0);
        let rules = muad_rules(&[2.0], PhaseErrorUnit::Degree);
        let of = |pane| rules.iter().filter(move |rule| rule.pane == pane).map(|rule| rule.level.clone());
        let sampled = |value: f64| Level::Sampled(vec![[2.0, value]]);
        let expected = muad.magnitude_db.map(|db| sampled(-db));
        assert_eq!(of(Pane::Magnitude).collect::<Vec<_>>(), expected);
        assert_eq!(of(Pane::Phase).collect::<Vec<_>>(), muad.phase_deg.map(sampled));
    }
}
