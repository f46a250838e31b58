//! Who the curves of a condition are: their names, roles and marks, whatever is drawn of them.

use std::sync::Arc;

use gdcm_core::correction::ChannelCorrection;
use gdcm_core::dataset::{BundleKind, Condition, Model, ModelId, Pair};
use gdcm_core::fidelity::SUGGESTION_RATIO;
use gdcm_core::response::GainDelay;
use gdcm_core::study::ConditionAnalysis;
use gdcm_core::units::s_to_ms;

use super::plot::{BodeCurve, CurveId, Role};
use super::state::State;

/// A curve without its numbers.
#[derive(Clone, Debug)]
pub(super) struct CurveFace {
    pub(super) id: CurveId,
    label: String,
    detail: String,
    role: Role,
    pub(super) rejected: bool,
    highlighted: bool,
    hidden: bool,
}

impl CurveFace {
    /// The face of a curve whose phase was moved up by so many turns.
    pub(super) fn moved_by_hand(mut self, turns: i32) -> Self {
        if turns != 0 {
            let (way, count) = (if turns > 0 { "up" } else { "down" }, turns.unsigned_abs());
            let noun = if count == 1 { "turn" } else { "turns" };
            self.detail = format!("phase moved {way} by {count} {noun} · {}", self.detail);
        }
        self
    }

    /// The curve of these numbers.
    pub(super) fn with(self, omega: &Arc<[f64]>, magnitude_db: &Arc<[f64]>, phase_deg: &Arc<[f64]>) -> BodeCurve {
        let Self { id, label, detail, role, rejected, highlighted, hidden } = self;
        let (omega, magnitude_db, phase_deg) = (Arc::clone(omega), Arc::clone(magnitude_db), Arc::clone(phase_deg));
        BodeCurve { id, label, detail, role, rejected, highlighted, hidden, omega, magnitude_db, phase_deg }
    }
}

/// A corrected curve without its numbers: what it is made of.
#[derive(Clone, Debug)]
pub(super) struct CorrectedFace {
    pub(super) face: CurveFace,
    /// Index of the physics model.
    pub(super) model: usize,
    pub(super) correction: GainDelay,
}

/// Index of the identified model that the others are compared with; the first one where nothing was compared.
pub(super) fn reference_of(state: &State, condition: &Condition) -> usize {
    let name = state.shown().map(|shown| shown.representative_name(BundleKind::Identified));
    name.and_then(|name| condition.position(BundleKind::Identified, name)).unwrap_or(0)
}

/// The models of a bundle that are shown, with their indices.
pub(super) fn model_faces(
    state: &State,
    condition: &Condition,
    kind: BundleKind,
) -> impl Iterator<Item = (usize, CurveFace)> {
    let shown = state.shown();
    let representative = shown.map(|shown| shown.representative_name(kind));
    let isolated = state.display.isolated.as_ref().filter(move |id| id.condition == condition.id());
    let is_visible = move |name: &str| {
        isolated.is_none_or(|id| (id.bundle == kind && id.name == name) || representative == Some(name))
    };
    let face = move |(index, model): (usize, &Model)| {
        let id = ModelId::new(condition.id(), kind, &model.name);
        let rejected = state.study.is_rejected(&id);
        let role = Role::of_model(kind, model.is_nominal(), representative == Some(&model.name));
        let curves = &state.display.curves;
        let face = CurveFace {
            label: model.name.clone(),
            detail: detail(shown, model, &id, rejected),
            role,
            rejected,
            highlighted: state.display.hovered.as_ref() == Some(&id) || curves.selected.contains(&id),
            hidden: curves.hidden_roles.contains(&role.shown(rejected)) || curves.hidden_models.contains(&id),
            id: CurveId::Model(id),
        };
        (index, face)
    };
    condition.bundle(kind).iter().enumerate().filter(move |(_, model)| is_visible(&model.name)).map(face)
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

/// The physics representative under the condition's own correction, under the schedule's, and where there are leads under its own
/// without them.
pub(super) fn corrected_faces(state: &State, condition: &Condition, pair: Pair) -> Vec<CorrectedFace> {
    let Some(shown) = state.shown() else { return Vec::new() };
    let name = shown.representative_name(BundleKind::Physics);
    let Some(model) = condition.position(BundleKind::Physics, name) else {
        return Vec::new();
    };
    let face = |id: CurveId, label: String, role: Role, correction: &ChannelCorrection| {
        let (net_gain, delay_ms) = (correction.net_gain(pair).value(), s_to_ms(correction.net_delay(pair).value_s()));
        let detail = format!("net gain {net_gain:.3}, net delay {delay_ms:.1} ms");
        let hidden = state.display.curves.hidden_roles.contains(&role);
        let face = CurveFace { id, label, detail, role, rejected: false, highlighted: false, hidden };
        Some(CorrectedFace { face, model, correction: correction.on(pair)? })
    };
    let own = face(CurveId::Corrected, format!("{name}, corrected"), Role::Corrected, &shown.correction);
    let scheduled = state.analysis().and_then(|analysis| analysis.schedule.as_ref().ok()).and_then(|schedule| {
        let older = if state.others_are_older() { " of older settings" } else { "" };
        let label = format!("{name}, scheduled{older}");
        let correction = schedule.at_state(state.condition().flight_state());
        face(CurveId::Scheduled, label, Role::Scheduled, &correction)
    });
    let without = shown.led.as_ref().and_then(|_| {
        let correction = shown.correction.clone().without_leads();
        face(CurveId::WithoutLeads, format!("{name}, corrected without leads"), Role::WithoutLeads, &correction)
    });
    own.into_iter().chain(scheduled).chain(without).collect()
}
