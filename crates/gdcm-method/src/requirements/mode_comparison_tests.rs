//! Tests of the mode comparison (M17.3).

use std::f64::consts::{LN_2, TAU};

use nalgebra::{Complex, DMatrix, dmatrix};

use gdcm_model::dataset::{Band, StateSpace};
use gdcm_model::response::pole_estimate::PoleEstimate;
use gdcm_model::response::{Mode, modes};

use super::mode_comparison::{ModeValues, ModelModes, compare_modes};
use super::mode_tolerance::{ModeTolerance, ModeToleranceError};
use super::{ModeName, ModeToleranceTable, ModeVerdict, NamedBy};

fn pair(re: f64, im: f64) -> Vec<Mode> {
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
    let values = ModeValues::new(&pair(-0.4, 2.0)[0]);
    assert!((values.period_s.unwrap() - TAU / 2.0).abs() < 1e-14);
    assert!((values.time_to_half_s.unwrap() - LN_2 / 0.4).abs() < 1e-14);
    assert!((values.damping_ratio.unwrap() - 0.4 / 4.16_f64.sqrt()).abs() < 1e-14);
    let growing = ModeValues::new(&uncontrolled_modes(dmatrix![0.1])[0]);
    assert!(
        growing.period_s.is_none() && (growing.time_to_half_s.unwrap() + LN_2 / 0.1).abs() < 1e-14
    );
}

#[test]
fn a_mode_is_within_if_its_period_and_its_amplitude_or_damping_are() {
    assert_eq!(verdict(-0.4, 2.0, &[]), ModeVerdict::Within);
    // A period of 3.14 s + 0.5 s corresponds to 1.7255 rad/s. The damping ratio differs by 0.03,
    // the time to half does not differ.
    assert_eq!(verdict(-0.4, 1.73, &[]), ModeVerdict::Within);
    assert_eq!(verdict(-0.4, 1.72, &[]), ModeVerdict::Outside);
    // The time to half differs by 15 %, the damping ratio by 0.0195 or 0.029.
    assert_eq!(verdict(-0.36, 1.99, &[]), ModeVerdict::Within);
    assert_eq!(verdict(-0.34, 2.0, &[]), ModeVerdict::Outside);
    assert_eq!(
        verdict(0.4, 2.0, &[]),
        ModeVerdict::Outside,
        "as fast, but growing"
    );
}

#[test]
fn a_mode_less_certain_than_the_tolerance_is_not_determined() {
    assert_eq!(
        verdict(-0.4, 2.0, &[estimate(0.01, 0.01)]),
        ModeVerdict::Within
    );
    // The standard deviations are 0.31 s for the period (tolerance 0.5 s), 25 % for the time to
    // half amplitude, and 0.045 for the damping ratio.
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

fn all_values(values: ModeValues) -> [f64; 3] {
    [values.period_s, values.time_to_half_s, values.damping_ratio].map(Option::unwrap)
}

/// Half the changes of the mode's values between poles moved by plus and by minus (`re`, `im`).
fn half_changes(re: f64, im: f64) -> [f64; 3] {
    let high = all_values(ModeValues::new(&pair(-0.4 + re, 2.0 + im)[0]));
    let low = all_values(ModeValues::new(&pair(-0.4 - re, 2.0 - im)[0]));
    std::array::from_fn(|value| 0.5 * (high[value] - low[value]))
}

#[test]
fn deviations_agree_with_moving_the_pole() {
    let sd_re = 1e-4;
    let sd_im = 2e-4;
    let deviation = ModeValues::deviation(&pair(-0.4, 2.0)[0], &estimate(sd_re, sd_im));
    let deviation = all_values(deviation);
    let by_re = half_changes(sd_re, 0.0);
    let by_im = half_changes(0.0, sd_im);
    for (deviation, (by_re, by_im)) in deviation.iter().zip(by_re.iter().zip(by_im)) {
        // The difference quotient has an error of third order in 1e-4.
        assert!((deviation / by_re.hypot(by_im) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_mode_below_the_band_is_not_determined_and_without_a_tolerance_has_no_verdict() {
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
    // An overdamped flown pole, and a physics phugoid with two real poles: an earlier version named
    // two rows phugoid.
    let flown = uncontrolled_modes(dmatrix![-0.26, 0.0; 0.0, -2.8]);
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
    // Two flown poles whose partners have the same name: the nearer pole keeps it.
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
