//! The modes of models against those identified from flight (M17.3).
//!
//! ```text
//! 1  pair the poles of every model with those of the identified one so that the sum of the distances is least (Poles view)
//! 2  period 2 pi / |Im|, time to half amplitude ln 2 / -Re (negative: to double), damping ratio -Re / |lambda|
//! 3  within: period, and time to half or double amplitude or damping ratio, each within its tolerance
//! 4  sd of period: T sd_Im / |Im|;   of time to half: t sd_Re / |Re|;
//!    of damping ratio: sqrt((Im^2 sd_Re)^2 + (Re Im sd_Im)^2) / |lambda|^3
//! 5  not determined: below the band, by M14.5, or an sd beyond the tolerance
//! ```
//!
//! 14 CFR part 60, appendix C, table C2A, 2.c.3.a and 2.d.3.a.

use std::f64::consts::{LN_2, TAU};

use nalgebra::Complex;
use serde::Serialize;

use super::{ModeName, ModeTolerance, ModeToleranceTable, NamedBy};
use crate::dataset::Band;
use crate::fidelity::{ModeTrack, mode_tracks};
use crate::identification::PoleEstimate;
use crate::response::Mode;

/// Distance, as a part of the pole's modulus, within which an estimate is that of a pole: the same model written otherwise.
const SAME_POLE: f64 = 1e-3;

/// The modes of a model, and the names of its states where it has some.
#[derive(Clone, Copy, Debug)]
pub struct ModelModes<'a> {
    /// Its modes.
    pub modes: &'a [Mode],
    /// Name of each state; empty where they are not named.
    pub states: &'a [String],
}

/// What is asked of a mode, or the standard deviations of that.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModeValues {
    /// Period \[s\]; none where it does not oscillate.
    pub period_s: Option<f64>,
    /// Time to half amplitude \[s\], negative where it grows: time to double. None where it does neither.
    pub time_to_half_s: Option<f64>,
    /// Damping ratio; none of a pole at zero.
    pub damping_ratio: Option<f64>,
}

impl ModeValues {
    /// Of a mode.
    pub fn of(mode: &Mode) -> Self {
        Self {
            period_s: mode.oscillates().then(|| TAU / mode.pole.im.abs()),
            time_to_half_s: mode.time_constant_s.map(|time_s| LN_2 * time_s),
            damping_ratio: mode.damping_ratio,
        }
    }

    /// The standard deviations of a mode's values, to first order of those of its pole (M14.5).
    pub fn deviation(mode: &Mode, pole: &PoleEstimate) -> Self {
        let values = Self::of(mode);
        let (re, im, size) = (mode.pole.re.abs(), mode.pole.im.abs(), mode.pole.norm());
        let damping = (im * im * pole.sd_re).hypot(re * im * pole.sd_im) / size.powi(3);
        Self {
            period_s: values.period_s.map(|period_s| period_s * pole.sd_im / im),
            time_to_half_s: values.time_to_half_s.map(|time_s| time_s.abs() * pole.sd_re / re),
            damping_ratio: values.damping_ratio.map(|_| damping),
        }
    }
}

/// What is said of a mode of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModeVerdict {
    /// Within the tolerance.
    Within,
    /// Beyond it.
    Outside,
    /// Flight does not determine the mode to within the tolerance.
    NotDetermined,
    /// The table has no tolerance for it.
    NoTolerance,
    /// The model has no mode in its place.
    NotPaired,
}

/// A mode of one model in the place of a flown one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparedMode {
    /// Its index among the model's modes.
    pub mode: usize,
    /// Its pole \[rad/s\].
    pub pole: Complex<f64>,
    /// Its period, time to half amplitude and damping ratio.
    pub values: ModeValues,
}

/// One flown mode and those of the models in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeRow {
    /// What it is called; none where neither states nor frequency say it.
    pub name: Option<ModeName>,
    /// What it is named by.
    pub named_by: NamedBy,
    /// The mode of the identified model.
    pub flown: ComparedMode,
    /// How sure that is; none where the identification is not known.
    pub deviation: Option<ModeValues>,
    /// Whether flight determines it: not below the band, and its standard deviations within the tolerance where both are known.
    pub is_determined: bool,
    /// The tolerance, where the table has one.
    pub tolerance: Option<ModeTolerance>,
    /// The mode of each model in its place; none where it has none.
    pub models: Vec<Option<ComparedMode>>,
    /// What is said of each model.
    pub verdicts: Vec<ModeVerdict>,
}

/// The modes of `models` against those of the identified model `flown`, by rising frequency; of a conjugate pair one row. `estimates`
/// are its poles as the identification knows them; empty where it does not. Nothing where it has no modes (a measured response).
///
/// A row is named by the first model with named states that has a mode in its place.
pub fn compare_modes(
    flown: ModelModes<'_>,
    models: &[ModelModes<'_>],
    estimates: &[PoleEstimate],
    band: Band,
    tolerances: &ModeToleranceTable,
) -> Vec<ModeRow> {
    let all: Vec<ModelModes<'_>> = std::iter::once(flown).chain(models.iter().copied()).collect();
    let tracks = mode_tracks(&all.iter().map(|model| model.modes).collect::<Vec<&[Mode]>>(), 0);
    let row = |track: &ModeTrack| {
        let mode = &flown.modes[track.reference];
        let places: Vec<Place<'_>> =
            all.iter().zip(&track.modes).map(|(model, at)| at.map(|at| (*model, at))).collect();
        let (name, named_by) = name_of(&places, mode);
        let tolerance = name.and_then(|name| tolerances.of(name)).cloned();
        let estimate = estimate_of(mode, estimates);
        let deviation = estimate.map(|estimate| ModeValues::deviation(mode, estimate));
        let flown = compared(mode, track.reference);
        let is_determined = mode.frequency_rad_s >= band.min()
            && estimate.is_none_or(|estimate| estimate.determined)
            && tolerance.as_ref().zip(deviation.as_ref()).is_none_or(|(of, sd)| of.is_known(&flown.values, sd));
        let models: Vec<Option<ComparedMode>> =
            places[1..].iter().map(|place| place.map(|(model, at)| compared(&model.modes[at], at))).collect();
        let verdicts =
            models.iter().map(|model| verdict(&flown, model.as_ref(), is_determined, tolerance.as_ref())).collect();
        ModeRow { name, named_by, flown, deviation, is_determined, tolerance, models, verdicts }
    };
    tracks.iter().map(row).collect()
}

/// A model and which of its modes, where it has one in the place of the flown one.
type Place<'a> = Option<(ModelModes<'a>, usize)>;

fn verdict(
    flown: &ComparedMode,
    model: Option<&ComparedMode>,
    is_determined: bool,
    tolerance: Option<&ModeTolerance>,
) -> ModeVerdict {
    match (model, tolerance) {
        (None, _) => ModeVerdict::NotPaired,
        _ if !is_determined => ModeVerdict::NotDetermined,
        (_, None) => ModeVerdict::NoTolerance,
        (Some(model), Some(tolerance)) if tolerance.holds(&flown.values, &model.values) => ModeVerdict::Within,
        _ => ModeVerdict::Outside,
    }
}

fn compared(mode: &Mode, at: usize) -> ComparedMode {
    ComparedMode { mode: at, pole: mode.pole, values: ModeValues::of(mode) }
}

/// The name that the first model with named states gives to the mode in its place, else that of the flown mode by itself.
fn name_of(places: &[Place<'_>], flown: &Mode) -> (Option<ModeName>, NamedBy) {
    let by_states = |(model, at): &(ModelModes<'_>, usize)| match ModeName::of(&model.modes[*at], model.states) {
        (name, NamedBy::States) => Some(name),
        (_, NamedBy::Frequency) => None,
    };
    match places.iter().flatten().find_map(by_states) {
        Some(name) => (name, NamedBy::States),
        None => ModeName::of(flown, &[]),
    }
}

/// The estimate of a mode's pole.
fn estimate_of<'a>(mode: &Mode, estimates: &'a [PoleEstimate]) -> Option<&'a PoleEstimate> {
    let distance = |estimate: &PoleEstimate| (estimate.pole - mode.pole).norm();
    let nearest = estimates.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    (distance(nearest) <= SAME_POLE * mode.frequency_rad_s).then_some(nearest)
}
