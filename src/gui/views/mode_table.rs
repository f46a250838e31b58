//! Modes in the displayed condition, as text and as a table, with their cache.

use std::sync::Arc;

use gdcm_method::requirements::{ModeName, NamedBy};
use gdcm_model::dataset::{BundleKind, Dynamics, Model, ModelId};
use gdcm_model::response::Mode;
use gdcm_model::response::zeros::finite_zeros;
use gdcm_model::units::number;
use gdcm_study::ConditionAnalysis;
use gdcm_study::jobs::curve_jobs::ConditionModes;
use gdcm_words::Table;

use crate::gui::state::modes_cache::{CachedModes, ModesInputs};
use crate::gui::state::window_state::State;

impl ModesInputs {
    fn new(state: &State, modes: &Arc<ConditionModes>) -> Self {
        let mut couplings = None;
        if let Some(shown) = state.shown()
            && let Some(coupled) = &shown.coupled
        {
            couplings = Some(Arc::clone(&coupled.fitted));
        }
        let mut zeros_of = None;
        if state.display.poles.show_zeros {
            zeros_of = Some((
                state.display.selection.pair,
                models_with_zeros(state, modes),
            ));
        }
        Self {
            modes: Arc::clone(modes),
            reference: reference_index(state, modes),
            couplings,
            zeros_of,
        }
    }

    fn is_same(&self, other: &Self) -> bool {
        let are_couplings_same = match (&self.couplings, &other.couplings) {
            (Some(own), Some(others)) => Arc::ptr_eq(own, others),
            (None, None) => true,
            _ => false,
        };
        Arc::ptr_eq(&self.modes, &other.modes)
            && are_couplings_same
            && self.reference == other.reference
            && self.zeros_of == other.zeros_of
    }
}

impl CachedModes {
    /// Recomputes the cache if it no longer matches the state.
    pub fn refresh(&mut self, state: &State) {
        let Some(modes) = state.modes() else {
            *self = Self::default();
            return;
        };
        let inputs = ModesInputs::new(state, modes);
        if let Some(known) = &self.inputs
            && known.is_same(&inputs)
        {
            return;
        }
        (self.table, self.outliers) = modes_table(state, modes, inputs.reference);
        self.shifts = match state.shown() {
            Some(shown) => ConditionAnalysis::pole_shifts(shown),
            None => Vec::new(),
        };
        self.zeros.clear();
        if let Some((pair, models)) = &inputs.zeros_of {
            for id in models {
                let zeros = match modes.condition.model(id.bundle, &id.name) {
                    Some(model) => finite_zeros(&model.dynamics, *pair),
                    None => Vec::new(),
                };
                self.zeros.push((id.clone(), zeros));
            }
        }
        self.inputs = Some(inputs);
    }
}

/// Returns the models whose zeros are shown: the nominal model and both representatives, because
/// the zeros of all models would hide the poles.
fn models_with_zeros(state: &State, modes: &ConditionModes) -> Vec<ModelId> {
    let condition = &modes.condition;
    let nominal = &condition.bundle(BundleKind::Physics)[condition.nominal()];
    let mut models = vec![state.model_id(BundleKind::Physics, &nominal.name)];
    if let Some(shown) = state.shown() {
        for kind in BundleKind::BOTH {
            let id = state.model_id(kind, shown.representative_name(kind));
            if !models.contains(&id) {
                models.push(id);
            }
        }
    }
    models
}

/// Returns the index of the physics model whose modes are followed through the other models: the
/// representative or, until it is available, the nominal model.
fn reference_index(state: &State, modes: &ConditionModes) -> usize {
    let kind = BundleKind::Physics;
    if let Some(shown) = state.shown()
        && let Some(index) = modes
            .condition
            .position(kind, shown.representative_name(kind))
    {
        return index;
    }
    modes.condition.nominal()
}

/// Describes a mode: its values, its name, its largest participations and, for a discrete-time
/// model, the conversion of its pole to `s`.
pub(super) fn mode_description(mode: &Mode, model: &Model) -> Vec<String> {
    let mut words = vec![mode_values(mode)];
    words.extend(mode_name(mode, model));
    words.extend(participation_words(mode, model, 3));
    words.extend(discrete_time_words(model));
    words
}

/// Formats "|λ| 1.520 rad/s, ζ 0.310, T 2.10 s".
fn mode_values(mode: &Mode) -> String {
    let mut words = vec![format!("|λ| {:.3} rad/s", mode.frequency_rad_s)];
    if let Some(ratio) = shown_damping_ratio(mode) {
        words.push(format!("ζ {ratio:.3}"));
    }
    if let Some(constant_s) = mode.time_constant_s {
        words.push(format!("T {constant_s:.2} s"));
    }
    words.join(", ")
}

/// Returns the damping ratio; `None` unless the mode oscillates.
fn shown_damping_ratio(mode: &Mode) -> Option<f64> {
    if mode.oscillates() {
        mode.damping_ratio
    } else {
        None
    }
}

/// Returns the name of a mode; `None` unless the model names its states (M17.3).
fn mode_name(mode: &Mode, model: &Model) -> Option<String> {
    match ModeName::determine(mode, &model.states) {
        (Some(name), NamedBy::States) => Some(name.to_string()),
        _ => None,
    }
}

/// Describes the conversion of discrete-time poles to `s`.
fn discrete_time_words(model: &Model) -> Option<String> {
    let Dynamics::StateSpace(system) = &model.dynamics else {
        return None;
    };
    let sample_time_s = system.timing().sample_time_s?;
    Some(format!(
        "s = ln z / T, T = {} s; poles at z = 0 have no s and are not drawn",
        number(sample_time_s)
    ))
}

/// Lists up to `most` states with the largest participation: "w 62 %, q 21 %".
fn participation_words(mode: &Mode, model: &Model, most: usize) -> Option<String> {
    let shares = match &mode.participation {
        Ok(shares) => shares,
        Err(why) => return Some(why.to_string()),
    };
    let mut words = Vec::new();
    for (state, share) in shares.iter().take(most) {
        let name = match model.states.get(*state) {
            Some(name) => name.clone(),
            None => format!("state {}", state + 1),
        };
        words.push(format!("{name} {:.0} %", 100.0 * share));
    }
    let words = words.join(", ");
    if words.is_empty() { None } else { Some(words) }
}

/// Builds the mode table of the physics bundle: a row for each mode of the reference model,
/// followed from model to model. Also returns, for each row, the first model whose pole is an
/// outlier of the mode.
fn modes_table(
    state: &State,
    modes: &ConditionModes,
    reference: usize,
) -> (Table, Vec<Option<ModelId>>) {
    let kind = BundleKind::Physics;
    let models = modes.condition.bundle(kind);
    let reference_model = &models[reference];
    let title = format!("Modes of condition {}", modes.condition.id());
    let columns = [
        "mode",
        "|λ| [rad/s]",
        "ζ [-]",
        "T [s]",
        "Re λ",
        "Im λ",
        "spread [rad/s]",
        "states",
        "outlier in",
    ];
    let mut table = Table::new(title, columns);
    let mut outliers = Vec::new();
    let reference_modes = modes.bundle(kind)[reference].as_deref().unwrap_or_default();
    for track in modes.tracks(kind, reference) {
        let Some(mode) = reference_modes.get(track.reference) else {
            continue;
        };
        let jumps: Vec<&str> = track
            .jumps
            .iter()
            .map(|&model| models[model].name.as_str())
            .collect();
        table.row([
            mode_name(mode, reference_model).unwrap_or_default(),
            three_decimals(mode.frequency_rad_s),
            shown_damping_ratio(mode)
                .map(three_decimals)
                .unwrap_or_default(),
            mode.time_constant_s.map(three_decimals).unwrap_or_default(),
            three_decimals(mode.pole.re),
            three_decimals(mode.pole.im),
            three_decimals(track.spread_rad_s),
            participation_words(mode, reference_model, 2).unwrap_or_default(),
            jumps.join(", "),
        ]);
        let first = track.jumps.first();
        outliers.push(first.map(|&model| state.model_id(kind, &models[model].name)));
    }
    (table, outliers)
}

fn three_decimals(value: f64) -> String {
    format!("{value:.3}").replace('-', "\u{2212}")
}
