//! Compares models' modes with the modes identified from flight, within user-defined tolerances
//! (M17.3).
//!
//! ```text
//! 1  pair every model's modes with the identified ones by distance and shape (mode_pairing)
//! 2  name each flown mode by the states of the first model that has named states and a partner,
//!    else by its frequency (mode_name); of equal names only the one with the lowest pairing cost
//!    stays
//! 3  each mode's period, time to half or double amplitude, and damping ratio (mode_values)
//! 4  determined: the flown mode is not below the band, identification determines it (M14.5), and
//!    its standard deviations are within the tolerance
//! 5  verdict, the first that applies:
//!    not paired | not determined (4) | no tolerance for the name |
//!    within: period, and time to half or double amplitude or damping ratio, each within its
//!    tolerance (mode_tolerance) | outside
//! ```
//!
//! A *flown* mode is a mode of the model identified from flight; M14.5 estimates the standard
//! deviations of its pole.
//!
//! 14 CFR part 60, appendix C, table C2A, 2.c.3.a and 2.d.3.a.

use nalgebra::Complex;
use serde::Serialize;

use gdcm_model::dataset::Band;
use gdcm_model::response::Mode;
use gdcm_model::response::pole_estimate::PoleEstimate;

pub use super::mode_tolerance::{ModeTolerance, ModeToleranceError, ModeToleranceTable};
pub use super::mode_values::ModeValues;

use super::mode_name::{ModeName, NamedBy};
use super::mode_pairing::{ModePair, mode_pairs, single_modes};

/// Maximum relative distance between a pole and its estimate. Both come from the same model; only
/// rounding separates them.
const SAME_POLE: f64 = 1e-3;

/// A model's modes, with its state names if available.
#[derive(Clone, Copy, Debug)]
pub struct ModelModes<'a> {
    pub modes: &'a [Mode],
    /// State names; empty if unavailable.
    pub states: &'a [String],
}

/// Verdict on a model's mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModeVerdict {
    Within,
    Outside,
    /// The mode is below the band, or flight does not determine it to within the tolerance.
    NotDetermined,
    /// The table has no tolerance for the mode.
    NoTolerance,
    /// Unpaired: no remaining mode in the model is within the limits on distance and likeness.
    NotPaired,
}

/// A mode in a row: the flown mode, or a model's counterpart to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparedMode {
    /// Index among the model's modes.
    pub mode: usize,
    /// Pole \[rad/s\].
    pub pole: Complex<f64>,
    pub values: ModeValues,
}

impl ComparedMode {
    fn new(index: usize, mode: &Mode) -> Self {
        Self {
            mode: index,
            pole: mode.pole,
            values: ModeValues::new(mode),
        }
    }
}

/// A mode identified from flight (the flown mode), and its counterparts in the models.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeRow {
    /// Mode name; `None` if the states (the frequency and damping if no states are named) do not
    /// determine it, or if another row keeps the same name.
    pub name: Option<ModeName>,
    pub named_by: NamedBy,
    pub flown: ComparedMode,
    /// Standard deviations for `flown`; `None` if identification has no estimate for its pole.
    pub deviation: Option<ModeValues>,
    /// Whether flight determines the mode: its frequency is not below the band and, if
    /// identification has an estimate for its pole, that estimate is determined (M14.5) with
    /// standard deviations within the tolerance, if there is one.
    pub is_determined: bool,
    /// The tolerance, if the table has one.
    pub tolerance: Option<ModeTolerance>,
    /// The counterpart in each model; `None` for an unpaired mode.
    pub models: Vec<Option<ComparedMode>>,
    pub verdicts: Vec<ModeVerdict>,
}

/// Compares the modes of `models` with the identified modes `flown`, in ascending frequency; a
/// conjugate pair makes a single row. `estimates` are the flown poles with their uncertainty from
/// identification; empty if unavailable. Returns no rows if the flown model has no modes (a
/// measured response).
///
/// A row takes its name from the first model with named states and a counterpart, the flown model
/// first; without one, from the flown mode's frequency and damping. No two rows have the same name:
/// if two would, only the row with the lowest pairing cost keeps it, and a name by frequency never
/// prevails over a name by states.
pub fn compare_modes(
    flown: ModelModes<'_>,
    models: &[ModelModes<'_>],
    estimates: &[PoleEstimate],
    band: Band,
    tolerances: &ModeToleranceTable,
) -> Vec<ModeRow> {
    // Step 1
    let models: Vec<PairedModel<'_>> = models
        .iter()
        .map(|&model| PairedModel {
            model,
            pairs: mode_pairs(flown.modes, model.modes, band.min()),
        })
        .collect();
    // Step 2
    let flown_modes = single_modes(flown.modes);
    let mut namings: Vec<Naming> = Vec::new();
    for (row, &mode) in flown_modes.iter().enumerate() {
        namings.push(Naming::from_states_or_frequency(flown, mode, &models, row));
    }
    keep_best_paired_names(&mut namings);
    let flown_model = FlownModel {
        modes: flown.modes,
        estimates,
        band,
    };
    // Steps 3 to 5
    let mut rows = Vec::new();
    for (row, naming) in namings.into_iter().enumerate() {
        let tolerance = naming.name.and_then(|name| tolerances.row_for(name));
        let flown = flown_model.mode(flown_modes[row], tolerance);
        let counterparts: Vec<Option<ComparedMode>> =
            models.iter().map(|model| model.counterpart(row)).collect();
        let verdicts = counterparts
            .iter()
            .map(|counterpart| verdict(&flown, counterpart.as_ref(), tolerance))
            .collect();
        rows.push(ModeRow {
            name: naming.name,
            named_by: naming.named_by,
            flown: flown.mode,
            deviation: flown.deviation,
            is_determined: flown.is_determined,
            tolerance: tolerance.cloned(),
            models: counterparts,
            verdicts,
        });
    }
    rows
}

/// A model, and each flown mode's partner among its modes.
struct PairedModel<'a> {
    model: ModelModes<'a>,
    /// For each row, the flown mode's partner; `None` if unpaired.
    pairs: Vec<Option<ModePair>>,
}

impl PairedModel<'_> {
    /// Returns the model's counterpart to the flown mode in this row; `None` if unpaired.
    fn counterpart(&self, row: usize) -> Option<ComparedMode> {
        let pair = self.pairs[row]?;
        Some(ComparedMode::new(pair.mode, &self.model.modes[pair.mode]))
    }
}

/// The identified model's modes, pole uncertainty and band.
struct FlownModel<'a> {
    modes: &'a [Mode],
    /// The flown poles with their uncertainty; empty if unavailable.
    estimates: &'a [PoleEstimate],
    band: Band,
}

/// A flown mode and its uncertainty.
struct FlownMode {
    mode: ComparedMode,
    deviation: Option<ModeValues>,
    is_determined: bool,
}

impl FlownModel<'_> {
    /// Evaluates the mode with this index and its uncertainty (steps 3 and 4).
    fn mode(&self, index: usize, tolerance: Option<&ModeTolerance>) -> FlownMode {
        let mode = &self.modes[index];
        let compared = ComparedMode::new(index, mode);
        let estimate = matching_estimate(mode, self.estimates);
        let deviation = estimate.map(|estimate| ModeValues::deviation(mode, estimate));
        let is_within_tolerance = match (tolerance, &deviation) {
            (Some(tolerance), Some(deviation)) => {
                tolerance.covers_deviation(&compared.values, deviation)
            }
            _ => true,
        };
        let is_determined = mode.frequency_rad_s >= self.band.min()
            && estimate.is_none_or(|estimate| estimate.determined)
            && is_within_tolerance;
        FlownMode {
            mode: compared,
            deviation,
            is_determined,
        }
    }
}

/// A row's name, and how closely the mode that gives it is paired.
#[derive(Clone, Copy, Debug)]
struct Naming {
    name: Option<ModeName>,
    named_by: NamedBy,
    /// Pairing cost for the mode whose states give the name (`mode_pairing`): 0 for the flown mode
    /// itself; infinite for a name by frequency, which any name by states displaces.
    pairing_cost: f64,
}

impl Naming {
    /// Names a flown mode by its states: in the flown model, else in the first model whose paired
    /// mode has named states. Without named states, guesses from the flown mode's frequency and
    /// damping.
    fn from_states_or_frequency(
        flown: ModelModes<'_>,
        mode: usize,
        models: &[PairedModel<'_>],
        row: usize,
    ) -> Self {
        let itself = ModePair { mode, cost: 0.0 };
        if let Some(naming) = Self::from_states(flown, itself) {
            return naming;
        }
        for model in models {
            let naming = model.pairs[row].and_then(|pair| Self::from_states(model.model, pair));
            if let Some(naming) = naming {
                return naming;
            }
        }
        let (name, named_by) = ModeName::determine(&flown.modes[mode], &[]);
        Self {
            name,
            named_by,
            pairing_cost: f64::INFINITY,
        }
    }

    /// Returns the name from the states of `model`; `None` if they are unnamed.
    fn from_states(model: ModelModes<'_>, pair: ModePair) -> Option<Self> {
        match ModeName::determine(&model.modes[pair.mode], model.states) {
            (name, NamedBy::States) => Some(Self {
                name,
                named_by: NamedBy::States,
                pairing_cost: pair.cost,
            }),
            (_, NamedBy::Frequency) => None,
        }
    }
}

/// Removes a duplicate name from all rows except the one with the lowest pairing cost; among equal
/// costs the slowest mode, which comes first, keeps the name.
fn keep_best_paired_names(namings: &mut [Naming]) {
    let mut by_cost: Vec<usize> = (0..namings.len()).collect();
    by_cost.sort_by(|&a, &b| namings[a].pairing_cost.total_cmp(&namings[b].pairing_cost));
    let mut taken: Vec<ModeName> = Vec::new();
    for row in by_cost {
        let Some(name) = namings[row].name else {
            continue;
        };
        if taken.contains(&name) {
            namings[row].name = None;
        } else {
            taken.push(name);
        }
    }
}

/// Returns the verdict on a model's counterpart to a flown mode (step 5).
fn verdict(
    flown: &FlownMode,
    counterpart: Option<&ComparedMode>,
    tolerance: Option<&ModeTolerance>,
) -> ModeVerdict {
    let Some(counterpart) = counterpart else {
        return ModeVerdict::NotPaired;
    };
    if !flown.is_determined {
        return ModeVerdict::NotDetermined;
    }
    match tolerance {
        None => ModeVerdict::NoTolerance,
        Some(tolerance) if tolerance.contains(&flown.mode.values, &counterpart.values) => {
            ModeVerdict::Within
        }
        Some(_) => ModeVerdict::Outside,
    }
}

/// Returns the estimate nearest to the mode's pole; `None` if their relative distance exceeds
/// [`SAME_POLE`].
fn matching_estimate<'a>(mode: &Mode, estimates: &'a [PoleEstimate]) -> Option<&'a PoleEstimate> {
    let nearest = estimates
        .iter()
        .min_by(|a, b| pole_distance(a, mode).total_cmp(&pole_distance(b, mode)))?;
    if pole_distance(nearest, mode) <= SAME_POLE * mode.frequency_rad_s {
        Some(nearest)
    } else {
        None
    }
}

/// Returns the distance between an estimate and a mode's pole \[rad/s\].
fn pole_distance(estimate: &PoleEstimate, mode: &Mode) -> f64 {
    (estimate.pole - mode.pole).norm()
}
