//! Tests of the mode comparison (M17.3).

use std::f64::consts::{LN_2, TAU};

use nalgebra::{Complex, DMatrix, dmatrix};

use gdcm_model::dataset::{Band, StateSpace};
use gdcm_model::response::pole_estimate::PoleEstimate;
use gdcm_model::response::{Mode, modes};

use super::mode_comparison::{ModeValues, ModelModes, compare_modes};
use super::mode_tolerance::{ModeTolerance, ModeToleranceError};
use super::{ModeName, ModeToleranceTable, ModeVerdict, NamedBy};

/// Modes of a model with the poles `re ± j im`: a single oscillatory mode.
fn oscillatory_modes(re: f64, im: f64) -> Vec<Mode> {
    uncontrolled_modes(dmatrix![re, im; -im, re])
}

/// Modes of `dx/dt = a x`, without inputs and outputs.
fn uncontrolled_modes(a: DMatrix<f64>) -> Vec<Mode> {
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

/// Verdict on a Dutch roll with pole `re + j im`, compared with a flown Dutch roll at -0.4 + 2j.
fn verdict(re: f64, im: f64, estimates: &[PoleEstimate]) -> ModeVerdict {
    let flown = oscillatory_modes(-0.4, 2.0);
    let model = oscillatory_modes(re, im);
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

// The pole s = -0.4 + 2j oscillates at |Im s| = 2 rad/s: its period is 2 pi / 2, the time to half
// amplitude ln 2 / 0.4, the damping ratio 0.4 / |s|. A growing mode has a negative time to half.
#[test]
fn period_time_to_half_and_damping_are_those_of_the_pole() {
    let values = ModeValues::new(&oscillatory_modes(-0.4, 2.0)[0]);
    assert!((values.period_s.unwrap() - TAU / 2.0).abs() < 1e-14);
    assert!((values.time_to_half_s.unwrap() - LN_2 / 0.4).abs() < 1e-14);
    assert!((values.damping_ratio.unwrap() - 0.4 / 4.16_f64.sqrt()).abs() < 1e-14);
    let growing = ModeValues::new(&uncontrolled_modes(dmatrix![0.1])[0]);
    assert!(
        growing.period_s.is_none() && (growing.time_to_half_s.unwrap() + LN_2 / 0.1).abs() < 1e-14
    );
}

#[test]
fn a_mode_is_within_if_its_period_and_either_time_to_half_or_damping_are() {
    // Default tolerances for the Dutch roll: the wider of 10 % and 0.5 s on the period, 10 % on the
    // time to half amplitude, 0.02 on the damping ratio. The flown period is 3.14 s.
    assert_eq!(verdict(-0.4, 2.0, &[]), ModeVerdict::Within);
    // A period of 3.14 s + 0.5 s corresponds to 1.7254 rad/s. The damping ratio differs by 0.03,
    // but the time to half is the same, which is sufficient.
    assert_eq!(verdict(-0.4, 1.73, &[]), ModeVerdict::Within);
    assert_eq!(verdict(-0.4, 1.72, &[]), ModeVerdict::Outside);
    // The time to half is outside, by 11 % and by 18 %; the damping ratio differs by 0.018, which
    // is within, and by 0.029, which is not.
    assert_eq!(verdict(-0.36, 1.99, &[]), ModeVerdict::Within);
    assert_eq!(verdict(-0.34, 2.0, &[]), ModeVerdict::Outside);
    assert_eq!(
        verdict(0.4, 2.0, &[]),
        ModeVerdict::Outside,
        "a growing mode at the flown frequency"
    );
}

#[test]
fn a_mode_less_certain_than_the_tolerance_is_not_determined() {
    assert_eq!(
        verdict(-0.4, 2.0, &[estimate(0.01, 0.01)]),
        ModeVerdict::Within
    );
    // The standard deviations are 0.31 s for the period (tolerance 0.5 s), but 25 % for the time to
    // half amplitude (tolerance 10 %) and 0.051 for the damping ratio (tolerance 0.02).
    assert_eq!(
        verdict(-0.4, 2.0, &[estimate(0.1, 0.2)]),
        ModeVerdict::NotDetermined
    );
    // The standard deviation of the period is 0.63 s.
    assert_eq!(
        verdict(-0.4, 2.0, &[estimate(0.01, 0.4)]),
        ModeVerdict::NotDetermined
    );
    // The records do not determine the pole, whatever its standard deviations.
    let undetermined = PoleEstimate {
        determined: false,
        ..estimate(0.0, 0.0)
    };
    assert_eq!(
        verdict(-0.4, 2.0, &[undetermined]),
        ModeVerdict::NotDetermined
    );
    let undetermined_other_pole = PoleEstimate {
        pole: Complex::new(-0.4, 3.0),
        ..undetermined
    };
    assert_eq!(
        verdict(-0.4, 2.0, &[undetermined_other_pole]),
        ModeVerdict::Within,
        "an estimate of another pole does not matter"
    );
}

fn all_values(values: ModeValues) -> [f64; 3] {
    [values.period_s, values.time_to_half_s, values.damping_ratio].map(Option::unwrap)
}

/// Half the changes of the mode's values between poles moved by plus and by minus (`re`, `im`).
fn half_changes(re: f64, im: f64) -> [f64; 3] {
    let high = all_values(ModeValues::new(&oscillatory_modes(-0.4 + re, 2.0 + im)[0]));
    let low = all_values(ModeValues::new(&oscillatory_modes(-0.4 - re, 2.0 - im)[0]));
    std::array::from_fn(|value| 0.5 * (high[value] - low[value]))
}

#[test]
fn standard_deviations_agree_with_difference_quotients() {
    let sd_re = 1e-4;
    let sd_im = 2e-4;
    let deviation =
        ModeValues::deviation(&oscillatory_modes(-0.4, 2.0)[0], &estimate(sd_re, sd_im));
    let deviation = all_values(deviation);
    // The real and the imaginary part of the pole are uncorrelated: their effects add in squares.
    let by_re = half_changes(sd_re, 0.0);
    let by_im = half_changes(0.0, sd_im);
    for (deviation, (by_re, by_im)) in deviation.iter().zip(by_re.iter().zip(by_im)) {
        // The difference quotient has an error of third order in 1e-4.
        assert!((deviation / by_re.hypot(by_im) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_mode_below_the_band_is_not_determined_and_a_mode_without_tolerance_has_no_verdict() {
    // A phugoid at 0.2 rad/s, below the band from 0.5 rad/s, and a roll mode at 3 rad/s, which no
    // row of the default table covers.
    let flown = uncontrolled_modes(dmatrix![-0.02, 0.2, 0.0; -0.2, -0.02, 0.0; 0.0, 0.0, -3.0]);
    let rows = compare_modes(
        unnamed(&flown),
        &[unnamed(&flown)],
        &[],
        band(),
        &ModeToleranceTable::default(),
    );
    let found: Vec<_> = rows
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
    assert_eq!(found, expected);
}

#[test]
fn rows_are_named_by_the_physics_model_and_unpaired_modes_are_marked() {
    let flown = uncontrolled_modes(dmatrix![-0.4, 2.0, 0.0; -2.0, -0.4, 0.0; 0.0, 0.0, -3.0]);
    let physics = oscillatory_modes(-0.5, 2.1);
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
    // Two real flown poles beside an oscillatory phugoid of the physics model: an earlier version
    // named both rows phugoid.
    let flown = uncontrolled_modes(dmatrix![-0.26, 0.0; 0.0, -2.8]);
    let physics = oscillatory_modes(-0.26, 0.1);
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
    // Two flown poles whose partners in the physics model have the same name: the flown pole that
    // is nearer to its partner keeps it.
    let split = uncontrolled_modes(dmatrix![-0.26, 0.0; 0.0, -0.6]);
    let physics = ModelModes {
        modes: &split,
        states: &states,
    };
    let flown = uncontrolled_modes(dmatrix![-0.27, 0.0; 0.0, -0.8]);
    let rows = compare_modes(unnamed(&flown), &[physics], &[], band(), &table);
    assert_eq!(
        rows.iter().map(|row| row.name).collect::<Vec<_>>(),
        [Some(ModeName::Phugoid), None]
    );
    assert!(rows.iter().all(|row| row.models[0].is_some()));
}

#[test]
fn a_mode_tolerance_table_survives_json_and_a_tolerance_of_zero_is_refused() {
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
    assert!(serde_json::from_str::<ModeToleranceTable>(&wrong).is_err());
    let rows: Vec<ModeTolerance> = serde_json::from_str(&wrong).unwrap();
    assert_eq!(
        ModeToleranceTable::try_from(rows),
        Err(ModeToleranceError {
            row: 1,
            response: "long term".to_owned(),
            name: "damping_ratio",
            found: 0.0
        })
    );
}
