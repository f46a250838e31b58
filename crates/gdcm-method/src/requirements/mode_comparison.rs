//! Modes of models against those identified from flight, with user-defined tolerances (M17.3).
//!
//! ```text
//! 1  pair the modes of every model with those of the identified one by distance and shape (mode_pairing)
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
use serde::{Deserialize, Serialize};

use gdcm_model::dataset::Band;
use gdcm_model::message_text::quoted;
use gdcm_model::response::Mode;
use gdcm_model::response::pole_estimate::PoleEstimate;
use gdcm_model::units::number;

use super::mode_name::{ModeName, NamedBy};
use super::mode_pairing::{ModePair, mode_pairs, single_modes};
use super::not_positive;

/// Relative distance within which an estimate matches a pole: the same model in another notation.
const SAME_POLE: f64 = 1e-3;

/// The modes of a model, with the names of its states if available.
#[derive(Clone, Copy, Debug)]
pub struct ModelModes<'a> {
    pub modes: &'a [Mode],
    /// Name of each state; empty without names.
    pub states: &'a [String],
}

/// The compared values of a mode, or their standard deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModeValues {
    /// Period \[s\]; `None` for a mode that does not oscillate.
    pub period_s: Option<f64>,
    /// Time to half amplitude \[s\], negative for a growing mode: time to double. `None` for a
    /// constant amplitude.
    pub time_to_half_s: Option<f64>,
    /// Damping ratio; `None` for a pole at zero.
    pub damping_ratio: Option<f64>,
}

impl ModeValues {
    /// Computes the values of a mode.
    pub fn of(mode: &Mode) -> Self {
        Self {
            period_s: mode.oscillates().then(|| TAU / mode.pole.im.abs()),
            time_to_half_s: mode.time_constant_s.map(|time_s| LN_2 * time_s),
            damping_ratio: mode.damping_ratio,
        }
    }

    /// Computes the standard deviations of a mode's values, to first order in those of its pole
    /// (M14.5).
    pub fn deviation(mode: &Mode, pole: &PoleEstimate) -> Self {
        let values = Self::of(mode);
        let re = mode.pole.re.abs();
        let im = mode.pole.im.abs();
        let size = mode.pole.norm();
        let damping = (im * im * pole.sd_re).hypot(re * im * pole.sd_im) / size.powi(3);
        Self {
            period_s: values.period_s.map(|period_s| period_s * pole.sd_im / im),
            time_to_half_s: values
                .time_to_half_s
                .map(|time_s| time_s.abs() * pole.sd_re / re),
            damping_ratio: values.damping_ratio.map(|_| damping),
        }
    }
}

/// Verdict on a mode of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModeVerdict {
    /// Within the tolerance.
    Within,
    /// Beyond it.
    Outside,
    /// Flight does not determine the mode to within the tolerance.
    NotDetermined,
    /// The table has no tolerance for the mode.
    NoTolerance,
    /// Unpaired: the model has no mode within the distance and likeness limits of a pair.
    NotPaired,
}

/// A model's counterpart of a flown mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparedMode {
    /// Its index among the model's modes.
    pub mode: usize,
    /// Its pole \[rad/s\].
    pub pole: Complex<f64>,
    pub values: ModeValues,
}

/// A flown mode and its counterparts in the models.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeRow {
    /// Its name; `None` if neither states nor frequency determine it.
    pub name: Option<ModeName>,
    pub named_by: NamedBy,
    /// The mode of the identified model.
    pub flown: ComparedMode,
    /// Standard deviations of the flown values; `None` if the identification result is unavailable.
    pub deviation: Option<ModeValues>,
    /// Whether flight determines the mode: not below the band, and its standard deviations within
    /// the tolerance if both are known.
    pub is_determined: bool,
    /// The tolerance, if the table has one.
    pub tolerance: Option<ModeTolerance>,
    /// The counterpart in each model; `None` for an unpaired mode.
    pub models: Vec<Option<ComparedMode>>,
    /// The verdict on each model.
    pub verdicts: Vec<ModeVerdict>,
}

/// Compares the modes of `models` with those of the identified model `flown`, in ascending
/// frequency; a conjugate pair makes one row. `estimates` are the flown poles with the uncertainty
/// of the identification; empty if unavailable. Returns no rows if the flown model has no modes (a
/// measured response).
///
/// A row takes its name from the first model with named states and a counterpart. No two rows have
/// the same name: the row with the surest match keeps it.
pub fn compare_modes(
    flown: ModelModes<'_>,
    models: &[ModelModes<'_>],
    estimates: &[PoleEstimate],
    band: Band,
    tolerances: &ModeToleranceTable,
) -> Vec<ModeRow> {
    let pairs: Vec<Vec<Option<ModePair>>> = models
        .iter()
        .map(|model| mode_pairs(flown.modes, model.modes, band.min()))
        .collect();
    let flown_modes = single_modes(flown.modes);
    let mut namings: Vec<Naming> = Vec::new();
    for (row, &mode) in flown_modes.iter().enumerate() {
        let of_models = models
            .iter()
            .zip(&pairs)
            .filter_map(|(model, pairs)| Some((*model, pairs[row]?)));
        let itself = (flown, ModePair { mode, cost: 0.0 });
        namings.push(Naming::of(
            &flown.modes[mode],
            std::iter::once(itself).chain(of_models),
        ));
    }
    keep_surest_names(&mut namings);
    let row = |(row, naming): (usize, Naming)| {
        let mode = &flown.modes[flown_modes[row]];
        let tolerance = naming.name.and_then(|name| tolerances.of(name)).cloned();
        let estimate = estimate_of(mode, estimates);
        let deviation = estimate.map(|estimate| ModeValues::deviation(mode, estimate));
        let flown = compared(mode, flown_modes[row]);
        let is_determined = mode.frequency_rad_s >= band.min()
            && estimate.is_none_or(|estimate| estimate.determined)
            && tolerance
                .as_ref()
                .zip(deviation.as_ref())
                .is_none_or(|(of, sd)| of.is_known(&flown.values, sd));
        let in_place = |(model, pairs): (&ModelModes<'_>, &Vec<Option<ModePair>>)| {
            pairs[row].map(|pair| compared(&model.modes[pair.mode], pair.mode))
        };
        let models: Vec<Option<ComparedMode>> = models.iter().zip(&pairs).map(in_place).collect();
        let verdicts = models
            .iter()
            .map(|model| verdict(&flown, model.as_ref(), is_determined, tolerance.as_ref()))
            .collect();
        let Naming { name, named_by, .. } = naming;
        ModeRow {
            name,
            named_by,
            flown,
            deviation,
            is_determined,
            tolerance,
            models,
            verdicts,
        }
    };
    namings.into_iter().enumerate().map(row).collect()
}

/// The name of a row, and its doubt.
#[derive(Clone, Copy, Debug)]
struct Naming {
    name: Option<ModeName>,
    named_by: NamedBy,
    /// Cost of the pair whose states give the name; infinite for a name by frequency.
    doubt: f64,
}

impl Naming {
    /// Returns the name by the first of `places` with named states, otherwise the name of the flown
    /// mode itself.
    fn of<'a>(flown: &Mode, places: impl Iterator<Item = (ModelModes<'a>, ModePair)>) -> Self {
        for (model, pair) in places {
            if let (name, NamedBy::States) = ModeName::of(&model.modes[pair.mode], model.states) {
                return Self {
                    name,
                    named_by: NamedBy::States,
                    doubt: pair.cost,
                };
            }
        }
        let (name, named_by) = ModeName::of(flown, &[]);
        Self {
            name,
            named_by,
            doubt: f64::INFINITY,
        }
    }
}

/// Removes a duplicate name from all rows except the surest; of equally sure rows the slowest keeps
/// it.
fn keep_surest_names(namings: &mut [Naming]) {
    let mut by_doubt: Vec<usize> = (0..namings.len()).collect();
    by_doubt.sort_by(|&a, &b| namings[a].doubt.total_cmp(&namings[b].doubt));
    let mut taken: Vec<ModeName> = Vec::new();
    for row in by_doubt {
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
        (Some(model), Some(tolerance)) if tolerance.holds(&flown.values, &model.values) => {
            ModeVerdict::Within
        }
        _ => ModeVerdict::Outside,
    }
}

fn compared(mode: &Mode, at: usize) -> ComparedMode {
    ComparedMode {
        mode: at,
        pole: mode.pole,
        values: ModeValues::of(mode),
    }
}

/// Returns the estimate of a mode's pole.
fn estimate_of<'a>(mode: &Mode, estimates: &'a [PoleEstimate]) -> Option<&'a PoleEstimate> {
    let distance = |estimate: &PoleEstimate| (estimate.pole - mode.pole).norm();
    let nearest = estimates
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    (distance(nearest) <= SAME_POLE * mode.frequency_rad_s).then_some(nearest)
}

/// One row of the table: a tolerance of the period, and alternative tolerances of amplitude and
/// damping.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModeTolerance {
    /// Name in the source ("long term").
    pub response: String,
    /// The modes that the row applies to.
    pub modes: Vec<ModeName>,
    /// Relative to the flown period.
    pub period: f64,
    /// Tolerance of the period \[s\], used if it is the wider of the two; `None` if only the
    /// relative one applies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
    /// Relative to the flown time to half or double amplitude.
    pub amplitude_time: f64,
    /// Absolute difference of the damping ratio.
    pub damping_ratio: f64,
    /// Entry of the source ("2.c.3.a").
    #[serde(default)]
    pub entry: String,
}

/// The table of mode tolerances; each row is checked on reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<ModeTolerance>")]
pub struct ModeToleranceTable(Vec<ModeTolerance>);

/// A tolerance that is not above zero.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("tolerance of modes {row}, {}: expected {name} above zero, found {}", quoted(response), number(*found))]
pub struct ModeToleranceError {
    /// Row number, counted from 1.
    pub row: usize,
    /// Response of the row.
    pub response: String,
    /// `period`, `period_s`, `amplitude_time` or `damping_ratio`.
    pub name: &'static str,
    /// The value found.
    pub found: f64,
}

impl ModeTolerance {
    /// Returns the tolerance of the period \[s\] around a flown period.
    pub fn of_period_s(&self, period_s: f64) -> f64 {
        (self.period * period_s).max(self.period_s.unwrap_or(0.0))
    }

    /// Whether `model` is within the tolerance around `flown`: the period, and either the time to
    /// half or double amplitude or the damping ratio.
    pub fn holds(&self, flown: &ModeValues, model: &ModeValues) -> bool {
        let differs = |of: fn(&ModeValues) -> Option<f64>| {
            Some(((of(model)? - of(flown)?).abs(), of(flown)?.abs()))
        };
        let period =
            differs(|values| values.period_s).is_some_and(|(by, of)| by <= self.of_period_s(of));
        let amplitude = differs(|values| values.time_to_half_s)
            .is_some_and(|(by, of)| by <= self.amplitude_time * of);
        let damping =
            differs(|values| values.damping_ratio).is_some_and(|(by, _)| by <= self.damping_ratio);
        period && (amplitude || damping)
    }

    /// Whether the flown mode itself is known to within the tolerance.
    pub fn is_known(&self, flown: &ModeValues, deviation: &ModeValues) -> bool {
        let within = |of: fn(&ModeValues) -> Option<f64>, most: f64| {
            of(deviation).is_some_and(|sd| sd <= most)
        };
        let period_s = flown
            .period_s
            .map_or(0.0, |period_s| self.of_period_s(period_s));
        let amplitude_s = flown
            .time_to_half_s
            .map_or(0.0, |time_s| self.amplitude_time * time_s.abs());
        let amplitude = within(|values| values.time_to_half_s, amplitude_s);
        within(|values| values.period_s, period_s)
            && (amplitude || within(|values| values.damping_ratio, self.damping_ratio))
    }

    fn check(&self, row: usize) -> Result<(), ModeToleranceError> {
        let values = [
            ("period", Some(self.period)),
            ("period_s", self.period_s),
            ("amplitude_time", Some(self.amplitude_time)),
            ("damping_ratio", Some(self.damping_ratio)),
        ];
        match not_positive(values) {
            Some((name, found)) => Err(ModeToleranceError {
                row,
                response: self.response.clone(),
                name,
                found,
            }),
            None => Ok(()),
        }
    }
}

impl ModeToleranceTable {
    /// Returns the rows.
    pub fn rows(&self) -> &[ModeTolerance] {
        &self.0
    }

    /// Returns the row of a mode, if any.
    pub fn of(&self, mode: ModeName) -> Option<&ModeTolerance> {
        self.0.iter().find(|row| row.modes.contains(&mode))
    }
}

impl TryFrom<Vec<ModeTolerance>> for ModeToleranceTable {
    type Error = ModeToleranceError;

    fn try_from(rows: Vec<ModeTolerance>) -> Result<Self, ModeToleranceError> {
        rows.iter()
            .enumerate()
            .try_for_each(|(index, row)| row.check(index + 1))?;
        Ok(Self(rows))
    }
}

impl Default for ModeToleranceTable {
    /// Returns the tolerances of 14 CFR part 60, appendix C, table C2A, 2.c.3.a (long-term
    /// response) and 2.d.3.a (lateral-directional oscillations).
    fn default() -> Self {
        let row = |response: &str, mode, period_s, entry: &str| ModeTolerance {
            response: response.to_owned(),
            modes: vec![mode],
            period: 0.1,
            period_s,
            amplitude_time: 0.1,
            damping_ratio: 0.02,
            entry: entry.to_owned(),
        };
        Self(vec![
            row("long term", ModeName::Phugoid, None, "2.c.3.a"),
            row(
                "lateral-directional oscillation",
                ModeName::DutchRoll,
                Some(0.5),
                "2.d.3.a",
            ),
        ])
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, dmatrix};

    use gdcm_model::dataset::StateSpace;
    use gdcm_model::response::modes;

    use super::*;

    fn pair(re: f64, im: f64) -> Vec<Mode> {
        of(dmatrix![re, im; -im, re])
    }

    fn of(a: DMatrix<f64>) -> Vec<Mode> {
        let n = a.nrows();
        modes(
            &StateSpace::new(
                a,
                DMatrix::zeros(n, 1),
                DMatrix::zeros(1, n),
                DMatrix::zeros(1, 1),
            )
            .unwrap(),
        )
        .unwrap()
    }

    fn band() -> Band {
        Band::new(0.5, 12.0).unwrap()
    }

    fn unnamed(modes: &[Mode]) -> ModelModes<'_> {
        ModelModes { modes, states: &[] }
    }

    /// The verdict on a Dutch roll against a flown one at -0.4 + 2j.
    fn verdict(re: f64, im: f64, estimates: &[PoleEstimate]) -> ModeVerdict {
        let flown = pair(-0.4, 2.0);
        let model = pair(re, im);
        let rows = compare_modes(
            unnamed(&flown),
            &[unnamed(&model)],
            estimates,
            band(),
            &ModeToleranceTable::default(),
        );
        assert_eq!(
            (rows.len(), rows[0].name),
            (1, Some(ModeName::DutchRoll)),
            "a conjugate pair is one row"
        );
        rows[0].verdicts[0]
    }

    fn estimate(sd_re: f64, sd_im: f64) -> PoleEstimate {
        PoleEstimate {
            pole: Complex::new(-0.4, 2.0),
            sd_re,
            sd_im,
            determined: true,
        }
    }

    #[test]
    fn period_time_to_half_and_damping_are_those_of_the_pole() {
        let values = ModeValues::of(&pair(-0.4, 2.0)[0]);
        assert!((values.period_s.unwrap() - TAU / 2.0).abs() < 1e-14);
        assert!((values.time_to_half_s.unwrap() - LN_2 / 0.4).abs() < 1e-14);
        assert!((values.damping_ratio.unwrap() - 0.4 / 4.16_f64.sqrt()).abs() < 1e-14);
        let growing = ModeValues::of(&of(dmatrix![0.1])[0]);
        assert!(
            growing.period_s.is_none()
                && (growing.time_to_half_s.unwrap() + LN_2 / 0.1).abs() < 1e-14
        );
    }

    #[test]
    fn a_mode_is_within_where_its_period_and_amplitude_or_damping_are() {
        assert_eq!(verdict(-0.4, 2.0, &[]), ModeVerdict::Within);
        // 3.14 s and 0.5 s more: 1.7255 rad/s. The damping ratio differs by 0.03, the time to half
        // not at all.
        assert_eq!(verdict(-0.4, 1.73, &[]), ModeVerdict::Within);
        assert_eq!(verdict(-0.4, 1.72, &[]), ModeVerdict::Outside);
        // Time to half 15 % off; the damping ratio by 0.0195 or by 0.029.
        assert_eq!(verdict(-0.36, 1.99, &[]), ModeVerdict::Within);
        assert_eq!(verdict(-0.34, 2.0, &[]), ModeVerdict::Outside);
        assert_eq!(
            verdict(0.4, 2.0, &[]),
            ModeVerdict::Outside,
            "as fast, but growing"
        );
    }

    #[test]
    fn a_mode_that_is_known_less_well_than_the_tolerance_is_not_determined() {
        assert_eq!(
            verdict(-0.4, 2.0, &[estimate(0.01, 0.01)]),
            ModeVerdict::Within
        );
        // A standard deviation of the period of 0.31 s is within 0.5 s; time to half to 25 %,
        // damping to 0.045.
        assert_eq!(
            verdict(-0.4, 2.0, &[estimate(0.1, 0.2)]),
            ModeVerdict::NotDetermined
        );
        assert_eq!(
            verdict(-0.4, 2.0, &[estimate(0.01, 0.4)]),
            ModeVerdict::NotDetermined
        );
        let by_records = PoleEstimate {
            determined: false,
            ..estimate(0.0, 0.0)
        };
        assert_eq!(
            verdict(-0.4, 2.0, &[by_records]),
            ModeVerdict::NotDetermined
        );
        let of_another = PoleEstimate {
            pole: Complex::new(-0.4, 3.0),
            ..by_records
        };
        assert_eq!(verdict(-0.4, 2.0, &[of_another]), ModeVerdict::Within);
    }

    #[test]
    fn deviations_are_those_of_moving_the_pole() {
        let sd_re = 1e-4;
        let sd_im = 2e-4;
        let deviation = ModeValues::deviation(&pair(-0.4, 2.0)[0], &estimate(sd_re, sd_im));
        let half = |values: fn(&ModeValues) -> Option<f64>, re: f64, im: f64| {
            let at = |sign: f64| {
                values(&ModeValues::of(&pair(-0.4 + sign * re, 2.0 + sign * im)[0])).unwrap()
            };
            0.5 * (at(1.0) - at(-1.0))
        };
        for values in [
            |of: &ModeValues| of.period_s,
            |of| of.time_to_half_s,
            |of| of.damping_ratio,
        ] as [fn(&_) -> _; 3]
        {
            let expected = half(values, sd_re, 0.0).hypot(half(values, 0.0, sd_im));
            // Third order of 1e-4.
            assert!((values(&deviation).unwrap() / expected - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_mode_below_the_band_is_not_determined_and_one_without_a_tolerance_is_only_shown() {
        let flown = of(dmatrix![-0.02, 0.2, 0.0; -0.2, -0.02, 0.0; 0.0, 0.0, -3.0]);
        let rows = compare_modes(
            unnamed(&flown),
            &[unnamed(&flown)],
            &[],
            band(),
            &ModeToleranceTable::default(),
        );
        let said: Vec<_> = rows
            .iter()
            .map(|row| (row.name, row.is_determined, row.verdicts[0]))
            .collect();
        let expected = [
            (Some(ModeName::Phugoid), false, ModeVerdict::NotDetermined),
            (
                Some(ModeName::RollSubsidence),
                true,
                ModeVerdict::NoTolerance,
            ),
        ];
        assert_eq!(said, expected);
    }

    #[test]
    fn rows_are_named_by_the_physics_model_and_gaps_are_said() {
        let flown = of(dmatrix![-0.4, 2.0, 0.0; -2.0, -0.4, 0.0; 0.0, 0.0, -3.0]);
        let physics = pair(-0.5, 2.1);
        let states = ["w".to_owned(), "q".to_owned()];
        let physics = ModelModes {
            modes: &physics,
            states: &states,
        };
        let rows = compare_modes(
            unnamed(&flown),
            &[physics, unnamed(&[])],
            &[],
            band(),
            &ModeToleranceTable::default(),
        );
        assert_eq!(
            (rows[0].name, rows[0].named_by),
            (Some(ModeName::ShortPeriod), NamedBy::States)
        );
        assert_eq!(
            rows[0].verdicts,
            [ModeVerdict::NoTolerance, ModeVerdict::NotPaired]
        );
        assert_eq!(
            (rows[1].name, rows[1].named_by),
            (Some(ModeName::RollSubsidence), NamedBy::Frequency)
        );
        assert_eq!(rows[1].models, [None, None]);
        assert_eq!(
            compare_modes(
                unnamed(&[]),
                &[physics],
                &[],
                band(),
                &ModeToleranceTable::default()
            ),
            []
        );
    }

    #[test]
    fn a_mode_is_named_once_and_a_fast_flown_pole_is_no_phugoid() {
        // An overdamped flown pole, and a physics phugoid with two real poles: these were once two
        // rows named phugoid.
        let flown = of(dmatrix![-0.26, 0.0; 0.0, -2.8]);
        let physics = pair(-0.26, 0.1);
        let states = ["u".to_owned(), "theta".to_owned()];
        let physics = ModelModes {
            modes: &physics,
            states: &states,
        };
        let table = ModeToleranceTable::default();
        let rows = compare_modes(unnamed(&flown), &[physics], &[], band(), &table);
        let found: Vec<_> = rows
            .iter()
            .map(|row| (row.name, row.named_by, row.verdicts[0]))
            .collect();
        let expected = [
            (
                Some(ModeName::Phugoid),
                NamedBy::States,
                ModeVerdict::NotDetermined,
            ),
            (
                Some(ModeName::RollSubsidence),
                NamedBy::Frequency,
                ModeVerdict::NotPaired,
            ),
        ];
        assert_eq!(found, expected);
        // Of two flown poles whose partners have the same name the nearer one keeps it.
        let split = of(dmatrix![-0.26, 0.0; 0.0, -0.6]);
        let physics = ModelModes {
            modes: &split,
            states: &states,
        };
        let flown = of(dmatrix![-0.27, 0.0; 0.0, -0.8]);
        let rows = compare_modes(unnamed(&flown), &[physics], &[], band(), &table);
        assert_eq!(
            rows.iter().map(|row| row.name).collect::<Vec<_>>(),
            [Some(ModeName::Phugoid), None]
        );
        assert!(rows.iter().all(|row| row.models[0].is_some()));
    }

    #[test]
    fn a_table_of_modes_comes_back_as_it_was_and_a_wrong_row_is_refused() {
        let text = serde_json::to_string(&ModeToleranceTable::default()).unwrap();
        assert_eq!(
            serde_json::from_str::<ModeToleranceTable>(&text).unwrap(),
            ModeToleranceTable::default()
        );
        assert!(
            text.contains(r#""modes":["dutch-roll"],"period":0.1,"period_s":0.5"#),
            "{text}"
        );
        let wrong = text.replace("\"damping_ratio\":0.02", "\"damping_ratio\":0.0");
        let words = serde_json::from_str::<ModeToleranceTable>(&wrong)
            .unwrap_err()
            .to_string();
        assert!(
            words.starts_with(
                "tolerance of modes 1, \"long term\": expected damping_ratio above zero, found 0"
            ),
            "{words}"
        );
    }
}
