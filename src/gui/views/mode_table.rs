//! Table of modes in the displayed condition, and a cache for this table, the zeros and the shifts
//! of the poles due to couplings.
//!
//! Each mode of the reference model is followed in the other models. A model is an *outlier* for a
//! mode if its pole has jumped: it is far from the centre of all models' poles.

use std::sync::Arc;

use gdcm_model::dataset::{BundleKind, ModelId};
use gdcm_model::number_format::decimals;
use gdcm_model::response::zeros::finite_zeros;
use gdcm_study::ConditionAnalysis;
use gdcm_study::jobs::curve_jobs::ConditionModes;
use gdcm_words::Table;

use super::mode_text::{mode_name, participation_words, shown_damping_ratio};
use crate::gui::state::modes_cache::{CachedModes, ModesInputs};
use crate::gui::state::window_state::State;

/// Number of states listed for each mode: those that participate most.
const LISTED_STATES: usize = 2;

impl ModesInputs {
    /// Collects the values on which the cached table, zeros and shifts depend.
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

    /// Returns whether the cache remains valid; shared data are compared by address.
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
/// all models' zeros would hide the poles.
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

/// Returns the index of the physics model whose modes are followed in the other models: the
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

/// Builds the mode table for the physics bundle: a row for each mode in the reference model,
/// followed from model to model, with the spread of its poles and the models whose pole is far from
/// the others (outliers). Also returns, for each row, the first of these models.
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
        "Re λ [rad/s]",
        "Im λ [rad/s]",
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
        let outlier_names: Vec<&str> = track
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
            participation_words(mode, reference_model, LISTED_STATES).unwrap_or_default(),
            outlier_names.join(", "),
        ]);
        let first = track.jumps.first();
        outliers.push(first.map(|&model| state.model_id(kind, &models[model].name)));
    }
    (table, outliers)
}

fn three_decimals(value: f64) -> String {
    decimals(value, 3)
}
