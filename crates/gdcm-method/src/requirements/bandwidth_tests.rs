//! Tests of bandwidth and phase delay against reference results (M17.1).

use std::f64::consts::PI;

use nalgebra::{Complex, dmatrix};
use proptest::prelude::*;

use gdcm_model::dataset::measured_response::MeasuredResponse;
use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::{Band, Channel, Dynamics, Pair, PairTable, StateSpace};
use gdcm_model::response::GainDelay;
use gdcm_model::response::frequency_grid::log_spaced;

use super::attitude_response::{
    AttitudeResponse, AttitudeResponseError, ResponseAt, search_frequencies,
};
use super::bandwidth::{
    AboveBand, Bandwidth, BandwidthSettings, CommandType, Metric, NoMetric, PairUncertainty,
    substitution_bar,
};
use super::known_answers::{answers, attitudes, number};
use super::sampled_response::SampledResponse;
use super::{AttitudeOutput, BandwidthRule};

/// The only response of a model with one input and one output.
const ONLY: Pair = Pair {
    output: 0,
    input: 0,
};

fn band() -> Band {
    Band::new(0.5, 12.0).unwrap()
}

fn settings(command: CommandType) -> BandwidthSettings {
    BandwidthSettings {
        command,
        band: band(),
        above_band: AboveBand::Marked,
    }
}

/// A transfer function evaluated at `j omega`.
fn at_frequencies(
    transfer: impl Fn(Complex<f64>) -> Complex<f64>,
) -> impl Fn(&[f64]) -> Vec<Complex<f64>> {
    move |omega| {
        omega
            .iter()
            .map(|omega| transfer(Complex::new(0.0, *omega)))
            .collect()
    }
}

/// Evaluates a response with the frequencies and the band of a model.
fn evaluate(
    response: &ResponseAt<'_>,
    output: AttitudeOutput,
    settings: &BandwidthSettings,
    deviation: Option<PairUncertainty<'_>>,
) -> Bandwidth {
    let frequencies = search_frequencies(settings.band);
    let attitude = AttitudeResponse::new(response, output, &frequencies, settings.band).unwrap();
    Bandwidth::read(&attitude, settings, deviation)
}

/// Evaluates a rate response, `s` times the given attitude.
fn rate_bandwidth(
    attitude: impl Fn(Complex<f64>) -> Complex<f64>,
    settings: &BandwidthSettings,
) -> Bandwidth {
    let rate = at_frequencies(|s| s * attitude(s));
    evaluate(&rate, AttitudeOutput::Rate, settings, None)
}

fn value(metric: Result<Metric, NoMetric>) -> f64 {
    metric.unwrap().value
}

#[test]
fn bandwidths_and_phase_delays_equal_the_reference() {
    let answers = answers();
    let cases = answers["bandwidth"].as_array().unwrap();
    for (case, attitude) in cases.iter().zip(attitudes()) {
        let found = rate_bandwidth(attitude, &settings(CommandType::Rate));
        let line = found.phase_line.unwrap();
        for (found, name) in [
            (value(found.omega_180), "omega_180"),
            (value(found.omega_phase), "omega_phase"),
            (value(found.omega_gain), "omega_gain"),
            (value(found.omega_bw), "bandwidth_rate"),
            (line.two_points_s, "phase_delay_two_points_s"),
            (line.least_squares_s, "phase_delay_line_s"),
            (line.departure_deg, "departure_deg"),
        ] {
            let expected = number(case, name);
            assert!(
                (found - expected).abs() < 1e-9 * expected,
                "{} {name}: {found} instead of {expected}",
                case["name"]
            );
        }
        // A phase that departs by more than 10 deg from a straight line is fitted by least squares.
        let is_straight = number(case, "departure_deg") <= 10.0;
        assert_eq!(line.is_straight(), is_straight);
        let phase_delay_s = if is_straight {
            line.two_points_s
        } else {
            line.least_squares_s
        };
        assert_eq!(value(found.phase_delay_s), phase_delay_s);
        let is_gain_first = number(case, "omega_gain") < number(case, "omega_phase");
        let rule = if is_gain_first {
            BandwidthRule::Gain
        } else {
            BandwidthRule::Phase
        };
        assert_eq!(
            (found.is_gain_limited(), found.rule),
            (is_gain_first, Some(rule))
        );
    }
}

#[test]
fn the_gain_margin_limits_the_bandwidth_of_rate_command_only() {
    let [_, lightly_damped, ..] = attitudes();
    let rate = rate_bandwidth(lightly_damped, &settings(CommandType::Rate));
    let attitude = rate_bandwidth(lightly_damped, &settings(CommandType::Attitude));
    assert_eq!(value(rate.omega_bw), value(rate.omega_gain));
    assert_eq!(
        (attitude.omega_bw, attitude.rule),
        (attitude.omega_phase, Some(BandwidthRule::Phase))
    );
    assert!(
        attitude.is_gain_limited(),
        "the gain limit is reported for every response type"
    );
}

#[test]
fn an_output_is_a_rate_or_an_attitude_by_its_unit() {
    for (unit, expected) in [
        ("deg/s", AttitudeOutput::Rate),
        ("rad/s", AttitudeOutput::Rate),
        ("deg", AttitudeOutput::Attitude),
        ("rad", AttitudeOutput::Attitude),
    ] {
        assert_eq!(
            AttitudeOutput::classify(&Channel::new("P", unit)),
            Ok(expected)
        );
    }
    // A rotor speed is not an angular rate of the fuselage.
    for unit in ["rpm", "g", "m/s^2"] {
        assert_eq!(
            AttitudeOutput::classify(&Channel::new("NZ", unit)),
            Err(AttitudeResponseError::NotAnAttitude {
                output: "NZ".into(),
                unit: unit.into()
            })
        );
    }
}

#[test]
fn an_attitude_and_its_rate_have_the_same_bandwidth() {
    let [attitude, ..] = attitudes();
    let rate = settings(CommandType::Rate);
    let of_attitude = evaluate(
        &at_frequencies(attitude),
        AttitudeOutput::Attitude,
        &rate,
        None,
    );
    let of_rate = rate_bandwidth(attitude, &rate);
    assert!((value(of_attitude.omega_bw) - value(of_rate.omega_bw)).abs() < 1e-10);
}

#[test]
fn a_phase_that_never_falls_through_a_level_has_no_crossing() {
    let found = rate_bandwidth(|s| 1.0 / (s * (s + 1.0)), &settings(CommandType::Rate));
    let no_crossing = NoMetric::NoCrossing {
        level_deg: -180.0,
        up_to: 48.0,
    };
    assert_eq!(found.omega_180, Err(no_crossing));
    assert!(found.phase_delay_s.is_err() && found.omega_gain.is_err());
    assert_eq!(found.phase_line, None);
    assert!(
        (value(found.omega_bw) - 1.0).abs() < 1e-10,
        "the pole at 1 rad/s has a phase margin of 45 deg"
    );
    assert_eq!(found.rule, Some(BandwidthRule::PhaseGainUnknown));
    // A double integrator with a delay is below -135 deg at every frequency.
    let late = rate_bandwidth(
        |s| (-0.05 * s).exp() / (s * s),
        &settings(CommandType::Rate),
    );
    assert!(matches!(
        late.omega_phase,
        Err(NoMetric::BelowFromStart {
            level_deg: -135.0,
            from
        }) if (from - 0.5).abs() < 0.01
    ));
    assert_eq!((late.omega_bw.is_err(), late.rule), (true, None));
}

#[test]
fn slow_modes_below_the_band_move_neither_branch_nor_crossings() {
    // An unstable phugoid at 0.2 rad/s shifts the phase by a full turn below the band, and nearby
    // zeros shift it back.
    let [.., short] = attitudes();
    let rate = settings(CommandType::Rate);
    let plain = rate_bandwidth(short, &rate);
    let turned = rate_bandwidth(
        |s| short(s) * (s * s + 0.1 * s + 0.03) / (s * s - 0.04 * s + 0.04),
        &rate,
    );
    assert!((value(turned.omega_180) / value(plain.omega_180) - 1.0).abs() < 0.1);
    assert!((value(turned.omega_bw) / value(plain.omega_bw) - 1.0).abs() < 0.2);
    // The phase falls through -135 deg and rises above this level again, both below the band; the
    // crossing that counts is the later one within the band.
    let dipping = rate_bandwidth(
        |s| short(s) * (s * s + 0.001 * s + 0.04) / (s * s + 0.001 * s + 0.0225),
        &rate,
    );
    assert!(value(dipping.omega_phase) > 1.9);
}

#[test]
fn a_slow_aircraft_crosses_below_the_band() {
    let rate = settings(CommandType::Rate);
    let slow = rate_bandwidth(|s| 1.0 / (s * (s + 0.2)), &rate);
    let omega_phase = slow.omega_phase.unwrap();
    assert!((omega_phase.value - 0.2).abs() < 1e-10 && omega_phase.rests_below_band);
    // Lightly damped zeros and poles near 1.5 rad/s lift the phase for a while, so that it falls
    // through the level a second time within the band.
    let lifted = rate_bandwidth(
        |s| (s * s + 0.002 * s + 1.96) / (s * s + 0.002 * s + 2.56) / (s * (s + 0.2)),
        &rate,
    );
    let omega_phase = value(lifted.omega_phase);
    assert!(
        (omega_phase - 0.2).abs() < 1e-3,
        "{omega_phase}: the crossing below the band comes first"
    );
}

#[test]
fn a_reversed_sign_is_recognised_from_the_phase() {
    let [.., short] = attitudes();
    let [plain, reversed] = [1.0, -1.0].map(|sign| {
        let response = at_frequencies(|s| sign * short(s));
        let frequencies = search_frequencies(band());
        AttitudeResponse::new(&response, AttitudeOutput::Attitude, &frequencies, band())
            .unwrap()
            .reversed_phase_deg()
    });
    assert_eq!(plain, None);
    // The phase at 0.5 rad/s, of an integrator, a delay of 0.02 s and a mode of 4 rad/s, is -90 -
    // 0.6 - 10.1 = -100.7 deg; the opposite sign adds 180 deg.
    assert!((reversed.unwrap() - 79.0).abs() < 2.0);
}

#[test]
fn a_flat_magnitude_has_no_gain_margin_and_no_bandwidth() {
    // Only the delay changes the phase.
    let delay = |s: Complex<f64>| (-0.2 * s).exp();
    let found = rate_bandwidth(delay, &settings(CommandType::Rate));
    for metric in [found.omega_bw, found.omega_gain] {
        assert!(matches!(
            metric,
            Err(NoMetric::NoGainCrossing { down_to, .. }) if (down_to - 0.125).abs() < 1e-12
        ));
    }
    let commanded = rate_bandwidth(delay, &settings(CommandType::Attitude));
    // Frequency at which a delay of 0.2 s has a phase of -135 deg.
    assert!((value(commanded.omega_bw) - 0.75 * PI / 0.2).abs() < 1e-9);
}

#[test]
fn values_above_the_band_are_marked_and_refused_with_leads() {
    // omega_180 is 8 rad/s: twice that, 16 rad/s, is above the band.
    let attitude = |s: Complex<f64>| (-PI / 16.0 * s).exp() / s;
    let marked = rate_bandwidth(attitude, &settings(CommandType::Rate));
    let omega_180 = marked.omega_180.unwrap();
    assert!((omega_180.value - 8.0).abs() < 1e-9 && !omega_180.rests_above_band);
    assert!(marked.phase_delay_s.unwrap().rests_above_band);
    assert!(!marked.omega_bw.unwrap().rests_above_band);
    let refused = BandwidthSettings {
        above_band: AboveBand::Refused,
        ..settings(CommandType::Rate)
    };
    let with_leads = rate_bandwidth(attitude, &refused);
    assert_eq!(
        (with_leads.omega_bw, with_leads.phase_line),
        (marked.omega_bw, None)
    );
    assert!(matches!(
        with_leads.phase_delay_s,
        Err(NoMetric::AboveBand { needed, top: 12.0 }) if (needed - 16.0).abs() < 1e-8
    ));
    // omega_180 is 15.7 rad/s: gain margin and bandwidth depend on the model above the band.
    let fast = |s: Complex<f64>| (-0.1 * s).exp() / s;
    let marked = rate_bandwidth(fast, &settings(CommandType::Rate));
    assert!(marked.omega_bw.unwrap().rests_above_band);
    let with_leads = rate_bandwidth(fast, &refused);
    assert_eq!(
        (with_leads.rule, with_leads.omega_bw),
        (
            Some(BandwidthRule::PhaseGainUnknown),
            with_leads.omega_phase
        )
    );
}

/// Evaluates the last reference case, measured at 60 frequencies up to `top` \[rad/s\].
fn measured_bandwidth(top: f64) -> Bandwidth {
    let [.., short] = attitudes();
    let omega = log_spaced(0.5, top, 60);
    let values = at_frequencies(|s| s * short(s))(&omega);
    let re = values.iter().map(|value| value.re).collect();
    let im = values.iter().map(|value| value.im).collect();
    let measured = MeasuredResponse::new(
        omega,
        &PairTable::filled(1, 1, re),
        &PairTable::filled(1, 1, im),
        None,
    )
    .unwrap();
    let omega = measured.omega().to_vec();
    let model = SampledResponse::new(&Dynamics::Measured(measured), band());
    let response = model.exact(ONLY, GainDelay::NONE);
    let attitude = AttitudeResponse::new(&response, AttitudeOutput::Rate, &omega, band()).unwrap();
    Bandwidth::read(&attitude, &settings(CommandType::Rate), None)
}

#[test]
fn a_measurement_is_never_extrapolated() {
    // Reference values of this case: omega_180 is 3.79 rad/s, the phase delay 0.122 s.
    let complete = measured_bandwidth(12.0);
    assert!(
        (value(complete.omega_180) / 3.7928490126513252 - 1.0).abs() < 1e-3,
        "differs by more than the resolution of 60 points"
    );
    assert!((value(complete.phase_delay_s) / 0.12206651443391653 - 1.0).abs() < 1e-2);
    let short = measured_bandwidth(6.0);
    assert!(matches!(
        short.phase_delay_s,
        Err(NoMetric::ResponseEnds { needed }) if (needed - 7.58).abs() < 0.02
    ));
    let shorter = measured_bandwidth(3.0);
    assert!(matches!(
        shorter.omega_180,
        Err(NoMetric::NoCrossing { level_deg: -180.0, up_to }) if (up_to - 3.0).abs() < 1e-12
    ));
    assert_eq!(
        (shorter.rule, shorter.omega_bw),
        (Some(BandwidthRule::PhaseGainUnknown), shorter.omega_phase)
    );
}

#[test]
fn a_zero_response_is_refused() {
    let zero = at_frequencies(|_| Complex::new(0.0, 0.0));
    let frequencies = search_frequencies(band());
    let refused = AttitudeResponse::new(&zero, AttitudeOutput::Rate, &frequencies, band()).err();
    let Some(AttitudeResponseError::NoResponse { from, to }) = refused else {
        panic!("a zero response is not refused")
    };
    assert!((from - 0.125).abs() < 1e-12 && (to - 48.0).abs() < 1e-9);
    assert!(AttitudeResponse::new(&zero, AttitudeOutput::Rate, &[], band()).is_err());
}

#[test]
fn a_model_and_its_correction_are_evaluated_exactly() {
    // 5 / (s + 3) is the rate of the third reference case without its servo; the 60 ms delay comes
    // from the correction and the model.
    let lag = StateSpace::new(dmatrix![-3.0], dmatrix![5.0], dmatrix![1.0], dmatrix![0.0]).unwrap();
    let timing = Timing {
        input_delays_s: Some(vec![0.02]),
        ..Timing::default()
    };
    let model = SampledResponse::new(&Dynamics::StateSpace(lag.timed(timing).unwrap()), band());
    let correction = GainDelay::new(1.7, 0.04);
    let rate = settings(CommandType::Rate);
    let exact = evaluate(
        &model.exact(ONLY, correction),
        AttitudeOutput::Rate,
        &rate,
        None,
    );
    let interpolated = evaluate(
        &model.interpolated(ONLY, correction),
        AttitudeOutput::Rate,
        &rate,
        None,
    );
    let expected = rate_bandwidth(|s| 5.0 * (-0.06 * s).exp() / (s * (s + 3.0)), &rate);
    for (found, expected) in [
        (exact.omega_bw, expected.omega_bw),
        (exact.omega_180, expected.omega_180),
        (exact.omega_gain, expected.omega_gain),
        (exact.phase_delay_s, expected.phase_delay_s),
    ] {
        assert!((value(found) / value(expected) - 1.0).abs() < 1e-10);
    }
    for (interpolated, exact) in [
        (interpolated.omega_bw, exact.omega_bw),
        (interpolated.omega_gain, exact.omega_gain),
        (interpolated.phase_delay_s, exact.phase_delay_s),
    ] {
        // Cubic interpolation through four points 1.5 % apart: the error is of the order of the
        // fourth power of the spacing, times the phase of the delay.
        let difference = (value(interpolated) / value(exact) - 1.0).abs();
        assert!(difference > 0.0 && difference < 1e-7, "{difference}");
    }
}

/// An uncertainty band with equal standard deviations at all these frequencies.
fn uniform_bands(omega: Vec<f64>, sd_db: f64, sd_deg: f64) -> ModelBands {
    let sd_db = PairTable::filled(1, 1, vec![sd_db; omega.len()]);
    let sd_deg = PairTable::filled(1, 1, vec![sd_deg; omega.len()]);
    ModelBands::new(omega, sd_db, sd_deg).unwrap()
}

/// Evaluates the last reference case with its phase shifted by `turn_deg`, and an uncertainty band.
fn turned_bandwidth(turn_deg: f64, bands: &ModelBands) -> Bandwidth {
    let [.., short] = attitudes();
    let turn = Complex::from_polar(1.0, turn_deg.to_radians());
    let rate = at_frequencies(|s| s * short(s) * turn);
    let deviation = PairUncertainty { bands, pair: ONLY };
    evaluate(
        &rate,
        AttitudeOutput::Rate,
        &settings(CommandType::Rate),
        Some(deviation),
    )
}

fn crossings(found: &Bandwidth) -> [Metric; 3] {
    [found.omega_180, found.omega_phase, found.omega_gain].map(Result::unwrap)
}

#[test]
fn deviations_from_phase_equal_the_shifts_by_a_turned_response() {
    let sd_deg = 0.3;
    let bands = uniform_bands(log_spaced(0.1, 48.0, 400), 0.0, sd_deg);
    let low = crossings(&turned_bandwidth(-sd_deg, &bands));
    let middle = turned_bandwidth(0.0, &bands);
    let high = crossings(&turned_bandwidth(sd_deg, &bands));
    for (crossing, metric) in crossings(&middle).iter().enumerate() {
        let deviation = metric.deviation.unwrap();
        let half_change = 0.5 * (high[crossing].value - low[crossing].value).abs();
        // The deviation is of first order: the remainder is the phase curvature over 0.3 deg.
        assert!(
            (deviation / half_change - 1.0).abs() < 1e-2,
            "{deviation} {half_change}"
        );
    }
    // Phase delay = (phase difference) / (2 omega_180), of two independent phases.
    let twice = 2.0 * value(middle.omega_180);
    let expected = 2.0_f64.sqrt() * sd_deg.to_radians() / twice;
    let deviation = middle.phase_delay_s.unwrap().deviation.unwrap();
    assert!((deviation / expected - 1.0).abs() < 1e-12);
}

#[test]
fn magnitude_deviations_affect_only_the_gain_crossing() {
    let bands = uniform_bands(log_spaced(0.1, 48.0, 400), 0.05, 0.0);
    let found = turned_bandwidth(0.0, &bands);
    assert_eq!(found.omega_180.unwrap().deviation, Some(0.0));
    // At 2.4 rad/s |Theta| falls by at least about 20 dB per decade: 0.05 sqrt(2) dB move the
    // frequency by less than 1 %.
    let deviation = found.omega_gain.unwrap().deviation.unwrap();
    assert!(
        deviation > 0.0 && deviation < 0.01 * value(found.omega_gain),
        "{deviation}"
    );
}

#[test]
fn a_band_that_ends_before_a_crossing_gives_no_deviation_there() {
    let bands = uniform_bands(vec![0.5, 5.0], 0.1, 0.1);
    let found = turned_bandwidth(0.0, &bands);
    assert!(found.omega_180.unwrap().deviation.is_some());
    assert!(found.phase_delay_s.unwrap().deviation.is_none());
}

#[test]
fn a_substitution_bar_has_the_mean_square_deviation_and_counts_missing_values() {
    let bar = substitution_bar(2.0, &[Some(2.3), Some(1.6), None], &[]);
    assert_eq!((bar.left_out, bar.identification), (1, None));
    assert!((bar.variance() - (0.09 + 0.16) / 2.0).abs() < 1e-15);
    assert!(bar.interval(0.9).unwrap()[0] >= 0.0);
}

proptest! {
    #[test]
    fn scaling_the_gain_changes_no_bandwidth(gain in 1e-3_f64..1e3, case in 0_usize..4) {
        let attitude = attitudes()[case];
        let plain = rate_bandwidth(attitude, &settings(CommandType::Rate));
        let scaled = rate_bandwidth(|s| gain * attitude(s), &settings(CommandType::Rate));
        for (plain, scaled) in [
            (plain.omega_180, scaled.omega_180),
            (plain.omega_phase, scaled.omega_phase),
            (plain.omega_gain, scaled.omega_gain),
            (plain.phase_delay_s, scaled.phase_delay_s),
        ] {
            prop_assert!((value(plain) / value(scaled) - 1.0).abs() < 1e-10);
        }
    }

    #[test]
    fn a_straight_phase_has_half_its_pure_delay_as_phase_delay(delay_s in 0.04_f64..0.6) {
        // 1/s and a delay: the phase is straight. It falls by pi/2 up to omega_180, and by another
        // pi/2 up to 2 omega_180.
        let found = rate_bandwidth(
            |s| (-delay_s * s).exp() / s,
            &settings(CommandType::Rate),
        );
        let line = found.phase_line.unwrap();
        prop_assert!(line.is_straight() && line.departure_deg < 1e-9);
        prop_assert!((value(found.phase_delay_s) - 0.5 * delay_s).abs() < 1e-10);
        prop_assert!((line.two_points_s - line.least_squares_s).abs() < 1e-10);
    }
}
