//! Tests of bandwidth and phase delay against known answers (M17.1).

use std::f64::consts::PI;

use nalgebra::{Complex, dmatrix};
use proptest::prelude::*;

use gdcm_model::dataset::measured_response::MeasuredResponse;
use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::{Band, Channel, Dynamics, Pair, PairTable, StateSpace};
use gdcm_model::response::GainDelay;
use gdcm_model::response::frequency_response::log_spaced;

use super::attitude_response::{AttitudeResponse, ResponseAt, SampledModel, search_frequencies};
use super::bandwidth::{
    AboveBand, Bandwidth, BandwidthSettings, CommandType, Metric, NoMetric, PairBand,
    substitution_bar,
};
use super::known_answers::{answers, attitudes, number};
use super::{AttitudeOutput, BandwidthRule};

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

/// Evaluates a rate response, `s` times the given attitude.
fn of_attitude(
    attitude: impl Fn(Complex<f64>) -> Complex<f64>,
    settings: &BandwidthSettings,
) -> Bandwidth {
    let rate = |omega: &[f64]| -> Vec<Complex<f64>> {
        omega
            .iter()
            .map(|omega| Complex::new(0.0, *omega))
            .map(|s| s * attitude(s))
            .collect()
    };
    let frequencies = search_frequencies(settings.band);
    Bandwidth::of(
        &AttitudeResponse::new(&rate, AttitudeOutput::Rate, &frequencies, settings.band).unwrap(),
        settings,
        None,
    )
}

fn value(metric: Result<Metric, NoMetric>) -> f64 {
    metric.unwrap().value
}

#[test]
fn bandwidths_and_phase_delays_are_the_known_ones() {
    let answers = answers();
    for (case, attitude) in answers["bandwidth"]
        .as_array()
        .unwrap()
        .iter()
        .zip(attitudes())
    {
        let found = of_attitude(attitude, &settings(CommandType::Rate));
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
                "{} {name}: {found} {expected}",
                case["name"]
            );
        }
        let by_line = number(case, "departure_deg") > 10.0;
        assert_eq!(
            (line.is_straight(), value(found.phase_delay_s)),
            (
                !by_line,
                if by_line {
                    line.least_squares_s
                } else {
                    line.two_points_s
                }
            )
        );
        let gain_first = number(case, "omega_gain") < number(case, "omega_phase");
        assert_eq!(found.is_gain_limited(), gain_first);
        assert_eq!(
            found.rule,
            Some(if gain_first {
                BandwidthRule::Gain
            } else {
                BandwidthRule::Phase
            })
        );
    }
}

#[test]
fn the_gain_margin_rules_where_it_comes_first_and_never_of_attitude_command() {
    let [_, light, ..] = attitudes();
    let [rate, attitude] = [CommandType::Rate, CommandType::Attitude]
        .map(|command| of_attitude(light, &settings(command)));
    assert_eq!(rate.omega_bw.unwrap().value, rate.omega_gain.unwrap().value);
    assert_eq!(
        (attitude.omega_bw, attitude.rule),
        (attitude.omega_phase, Some(BandwidthRule::Phase))
    );
    assert!(
        attitude.is_gain_limited(),
        "the standard warns of it whatever the bandwidth is"
    );
}

#[test]
fn an_attitude_is_taken_as_it_is_and_a_rate_over_s() {
    let unit = |unit: &str| AttitudeOutput::of(&Channel::new("P", unit));
    assert_eq!(
        [unit("deg/s"), unit("rad/s"), unit("deg"), unit("rad")],
        [
            Ok(AttitudeOutput::Rate),
            Ok(AttitudeOutput::Rate),
            Ok(AttitudeOutput::Attitude),
            Ok(AttitudeOutput::Attitude),
        ]
    );
    assert!(
        unit("rpm").is_err(),
        "a rotor speed is no rate of the fuselage"
    );
    let acceleration = AttitudeOutput::of(&Channel::new("NZ", "m/s^2"))
        .unwrap_err()
        .to_string();
    assert_eq!(
        acceleration,
        "\"NZ\" in \"m/s^2\" has no bandwidth: it is neither a rate (deg/s, rad/s) nor an attitude (deg, rad)"
    );

    let [attitude, ..] = attitudes();
    let at = |omega: &[f64]| {
        omega
            .iter()
            .map(|omega| attitude(Complex::new(0.0, *omega)))
            .collect()
    };
    let response = AttitudeResponse::new(
        &at,
        AttitudeOutput::Attitude,
        &search_frequencies(band()),
        band(),
    )
    .unwrap();
    let found = Bandwidth::of(&response, &settings(CommandType::Rate), None);
    assert!(
        (value(found.omega_bw)
            - value(of_attitude(attitude, &settings(CommandType::Rate)).omega_bw))
        .abs()
            < 1e-10
    );
}

#[test]
fn a_phase_that_never_falls_through_has_no_crossing_and_says_up_to_where() {
    let found = of_attitude(|s| 1.0 / (s * (s + 1.0)), &settings(CommandType::Rate));
    assert_eq!(
        found.omega_180.unwrap_err().to_string(),
        "no crossing of -180 deg up to 48 rad/s"
    );
    assert_eq!(
        (
            found.phase_delay_s.is_err(),
            found.omega_gain.is_err(),
            found.phase_line
        ),
        (true, true, None)
    );
    assert!(
        (value(found.omega_bw) - 1.0).abs() < 1e-10,
        "45 deg of margin at the pole"
    );
    assert_eq!(found.rule, Some(BandwidthRule::PhaseGainUnknown));
    let late = of_attitude(
        |s| (-0.05 * s).exp() / (s * s),
        &settings(CommandType::Rate),
    );
    assert_eq!(
        late.omega_phase.unwrap_err().to_string(),
        "no crossing of -135 deg: the phase is below it from 0.500 rad/s on"
    );
    assert_eq!((late.omega_bw.is_err(), late.rule), (true, None));
}

#[test]
fn slow_modes_below_the_band_move_neither_branch_nor_crossings() {
    // An unstable phugoid at 0.2 rad/s turns the phase by a turn below the band, and nearby zeros
    // turn it back.
    let [.., short] = attitudes();
    let turned = |s: Complex<f64>| short(s) * (s * s + 0.1 * s + 0.03) / (s * s - 0.04 * s + 0.04);
    let rate = settings(CommandType::Rate);
    let plain = of_attitude(short, &rate);
    let found = of_attitude(turned, &rate);
    assert!((value(found.omega_180) / value(plain.omega_180) - 1.0).abs() < 0.1);
    assert!((value(found.omega_bw) / value(plain.omega_bw) - 1.0).abs() < 0.2);
    // A phase that dips through -135 deg only below the band has its crossing within the band.
    let dips =
        |s: Complex<f64>| short(s) * (s * s + 0.001 * s + 0.04) / (s * s + 0.001 * s + 0.0225);
    assert!(value(of_attitude(dips, &settings(CommandType::Rate)).omega_phase) > 1.9);
    // A slow aircraft crosses below the band and stays below the level.
    let slow = of_attitude(|s| 1.0 / (s * (s + 0.2)), &settings(CommandType::Rate));
    let omega_phase = slow.omega_phase.unwrap();
    assert!((omega_phase.value - 0.2).abs() < 1e-10 && omega_phase.rests_below_band);
    // The same if lightly damped zeros and poles near 1.5 rad/s lifts the phase for a while, so
    // that it falls through once more.
    let lifted =
        |s: Complex<f64>| (s * s + 0.002 * s + 1.96) / (s * s + 0.002 * s + 2.56) / (s * (s + 0.2));
    let again = value(of_attitude(lifted, &settings(CommandType::Rate)).omega_phase);
    assert!(
        (again - 0.2).abs() < 1e-3,
        "{again}: the fall below the band comes first"
    );
}

#[test]
fn a_stick_that_counts_the_other_way_round_is_suspected() {
    let [.., short] = attitudes();
    let phase_deg = |sign: f64| {
        let at = |omega: &[f64]| {
            omega
                .iter()
                .map(|omega| sign * short(Complex::new(0.0, *omega)))
                .collect()
        };
        let response = AttitudeResponse::new(
            &at,
            AttitudeOutput::Attitude,
            &search_frequencies(band()),
            band(),
        );
        response.unwrap().reversed_phase_deg()
    };
    assert_eq!(phase_deg(1.0), None);
    assert!((phase_deg(-1.0).unwrap() - 79.0).abs() < 2.0);
}

#[test]
fn a_magnitude_that_is_nowhere_6_db_higher_has_no_gain_margin_and_no_bandwidth() {
    // A flat magnitude: only the delay turns the phase.
    let delay = |s: Complex<f64>| (-0.2 * s).exp();
    let found = of_attitude(delay, &settings(CommandType::Rate));
    assert!(matches!(
        found.omega_bw,
        Err(NoMetric::NoGainCrossing { .. })
    ));
    assert!(
        found
            .omega_gain
            .unwrap_err()
            .to_string()
            .ends_with("down to 0.125 rad/s")
    );
    let commanded = of_attitude(delay, &settings(CommandType::Attitude));
    // -135 deg with a 0.2 s delay.
    assert!((value(commanded.omega_bw) - 0.75 * PI / 0.2).abs() < 1e-9);
}

#[test]
fn what_lies_above_the_band_is_said_to_rest_on_the_model_or_refused_with_leads() {
    // omega_180 is 8 rad/s: 16 is above the band.
    let attitude = |s: Complex<f64>| (-PI / 16.0 * s).exp() / s;
    let marked = of_attitude(attitude, &settings(CommandType::Rate));
    assert!(
        (value(marked.omega_180) - 8.0).abs() < 1e-9 && !marked.omega_180.unwrap().rests_above_band
    );
    assert!(
        marked.phase_delay_s.unwrap().rests_above_band
            && !marked.omega_bw.unwrap().rests_above_band
    );
    let refused = BandwidthSettings {
        above_band: AboveBand::Refused,
        ..settings(CommandType::Rate)
    };
    let led = of_attitude(attitude, &refused);
    assert_eq!((led.omega_bw, led.phase_line), (marked.omega_bw, None));
    let words = led.phase_delay_s.unwrap_err().to_string();
    assert_eq!(
        words,
        "rests on the leads above the band: 16.000 rad/s, beyond 12 rad/s"
    );
    // omega_180 is 15.7 rad/s: the gain margin rests on the model, and so does the bandwidth.
    let fast = |s: Complex<f64>| (-0.1 * s).exp() / s;
    assert!(
        of_attitude(fast, &settings(CommandType::Rate))
            .omega_bw
            .unwrap()
            .rests_above_band
    );
    let led = of_attitude(fast, &refused);
    assert_eq!(
        (led.rule, led.omega_bw),
        (Some(BandwidthRule::PhaseGainUnknown), led.omega_phase)
    );
}

#[test]
fn a_measurement_is_never_extrapolated() {
    let [.., short] = attitudes();
    let found = |to: f64| {
        let omega = log_spaced(0.5, to, 60);
        let values: Vec<Complex<f64>> = omega
            .iter()
            .map(|omega| Complex::new(0.0, *omega))
            .map(|s| s * short(s))
            .collect();
        let table = |part: fn(&Complex<f64>) -> f64| {
            PairTable::filled(1, 1, values.iter().map(part).collect::<Vec<f64>>())
        };
        let measured = MeasuredResponse::new(
            omega,
            &table(|value| value.re),
            &table(|value| value.im),
            None,
        )
        .unwrap();
        let omega = measured.omega().to_vec();
        let model = SampledModel::of(&Dynamics::Measured(measured), band());
        let response = model.exact(ONLY, GainDelay::NONE);
        let attitude =
            AttitudeResponse::new(&response, AttitudeOutput::Rate, &omega, band()).unwrap();
        Bandwidth::of(&attitude, &settings(CommandType::Rate), None)
    };
    // omega_180 is 3.79 rad/s.
    let whole = found(12.0);
    assert!(
        (value(whole.omega_180) / 3.7928490126513252 - 1.0).abs() < 1e-3,
        "as far as 60 points tell it"
    );
    assert!((value(whole.phase_delay_s) / 0.12206651443391653 - 1.0).abs() < 1e-2);
    let part = found(6.0);
    let words = part.phase_delay_s.unwrap_err().to_string();
    assert!(
        words.starts_with("the response has no value at 7.5"),
        "{words}"
    );
    let less = found(3.0);
    assert_eq!(
        less.omega_180.unwrap_err().to_string(),
        "no crossing of -180 deg up to 3 rad/s"
    );
    assert_eq!(
        (less.rule, less.omega_bw),
        (Some(BandwidthRule::PhaseGainUnknown), less.omega_phase)
    );
}

#[test]
fn a_response_that_is_nowhere_is_refused() {
    let nothing = |omega: &[f64]| vec![Complex::new(0.0, 0.0); omega.len()];
    let refused = AttitudeResponse::new(
        &nothing,
        AttitudeOutput::Rate,
        &search_frequencies(band()),
        band(),
    )
    .err()
    .unwrap();
    assert_eq!(
        refused.to_string(),
        "there is no response between 0.125 and 48 rad/s"
    );
    assert!(AttitudeResponse::new(&nothing, AttitudeOutput::Rate, &[], band()).is_err());
}

#[test]
fn a_model_and_its_correction_are_taken_exactly() {
    // 5 / (s + 3) is the rate of the third known answer without its servo; the 60 ms delay comes
    // from the correction and the model.
    let lag = StateSpace::new(dmatrix![-3.0], dmatrix![5.0], dmatrix![1.0], dmatrix![0.0]).unwrap();
    let timing = Timing {
        input_delays_s: Some(vec![0.02]),
        ..Timing::default()
    };
    let model = SampledModel::of(&Dynamics::StateSpace(lag.timed(timing).unwrap()), band());
    let correction = GainDelay::new(1.7, 0.04);
    let of = |response: &ResponseAt<'_>| {
        let attitude = AttitudeResponse::new(
            response,
            AttitudeOutput::Rate,
            &search_frequencies(band()),
            band(),
        );
        Bandwidth::of(&attitude.unwrap(), &settings(CommandType::Rate), None)
    };
    let found = of(&model.exact(ONLY, correction));
    let near = of(&model.interpolated(ONLY, correction));
    let error = AttitudeOutput::of(&Channel::new("NZ", "g")).unwrap_err();
    assert!(error.to_string().contains("has no bandwidth"));
    let expected = of_attitude(
        |s| 5.0 * (-0.06 * s).exp() / (s * (s + 3.0)),
        &settings(CommandType::Rate),
    );
    for (found, expected) in [
        (found.omega_bw, expected.omega_bw),
        (found.omega_180, expected.omega_180),
        (found.omega_gain, expected.omega_gain),
        (found.phase_delay_s, expected.phase_delay_s),
    ] {
        assert!((value(found) / value(expected) - 1.0).abs() < 1e-10);
    }
    for (near, exact) in [
        (near.omega_bw, found.omega_bw),
        (near.omega_gain, found.omega_gain),
        (near.phase_delay_s, found.phase_delay_s),
    ] {
        // Four points 1.5 % apart: the fourth power of the spacing times the delay's phase.
        let apart = (value(near) / value(exact) - 1.0).abs();
        assert!(apart > 0.0 && apart < 1e-7, "{apart}");
    }
}

#[test]
fn deviations_are_those_of_moving_the_response() {
    let [.., short] = attitudes();
    let sd_deg = 0.3;
    let sd_db = 0.05;
    // The phase is uncertain only around omega_180, the magnitude only around omega_gain.
    let frequencies = log_spaced(0.1, 48.0, 400);
    let bands = |sd_db: f64, sd_deg: f64| {
        let table = |value: f64| PairTable::filled(1, 1, vec![value; frequencies.len()]);
        ModelBands::new(frequencies.clone(), table(sd_db), table(sd_deg)).unwrap()
    };
    let rate = |turn_deg: f64| {
        move |omega: &[f64]| -> Vec<Complex<f64>> {
            let turn = Complex::from_polar(1.0, turn_deg.to_radians());
            omega
                .iter()
                .map(|omega| Complex::new(0.0, *omega))
                .map(|s| s * short(s) * turn)
                .collect()
        }
    };
    let of = |turn_deg: f64, bands: &ModelBands| {
        let at = rate(turn_deg);
        let response = AttitudeResponse::new(
            &at,
            AttitudeOutput::Rate,
            &search_frequencies(band()),
            band(),
        )
        .unwrap();
        Bandwidth::of(
            &response,
            &settings(CommandType::Rate),
            Some(PairBand { bands, pair: ONLY }),
        )
    };
    let phase_only = bands(0.0, sd_deg);
    let low = of(-sd_deg, &phase_only);
    let middle = of(0.0, &phase_only);
    let high = of(sd_deg, &phase_only);
    let half = |metric: fn(&Bandwidth) -> Result<Metric, NoMetric>| {
        0.5 * (value(metric(&high)) - value(metric(&low))).abs()
    };
    for metric in [
        |of: &Bandwidth| of.omega_180,
        |of| of.omega_phase,
        |of| of.omega_gain,
    ] as [fn(&Bandwidth) -> _; 3]
    {
        let deviation = metric(&middle).unwrap().deviation.unwrap();
        // First order: the remainder is the phase curvature over 0.3 deg.
        assert!(
            (deviation / half(metric) - 1.0).abs() < 1e-2,
            "{deviation} {}",
            half(metric)
        );
    }
    let twice = 2.0 * value(middle.omega_180);
    let expected = 2.0_f64.sqrt() * sd_deg.to_radians() / twice;
    assert!((middle.phase_delay_s.unwrap().deviation.unwrap() / expected - 1.0).abs() < 1e-12);
    let magnitude_only = of(0.0, &bands(sd_db, 0.0));
    assert_eq!(magnitude_only.omega_180.unwrap().deviation, Some(0.0));
    // At 2.4 rad/s |Theta| falls by about 20 dB a decade and more: 0.05 sqrt(2) dB move the
    // frequency by less than 1 %.
    let deviation = magnitude_only.omega_gain.unwrap().deviation.unwrap();
    assert!(
        deviation > 0.0 && deviation < 0.01 * value(magnitude_only.omega_gain),
        "{deviation}"
    );
}

#[test]
fn a_band_that_ends_before_a_crossing_gives_no_deviation_there() {
    let [.., short] = attitudes();
    let table = || PairTable::filled(1, 1, vec![0.1, 0.1]);
    let bands = ModelBands::new(vec![0.5, 5.0], table(), table()).unwrap();
    let rate = |omega: &[f64]| -> Vec<Complex<f64>> {
        omega
            .iter()
            .map(|omega| Complex::new(0.0, *omega))
            .map(|s| s * short(s))
            .collect()
    };
    let response = AttitudeResponse::new(
        &rate,
        AttitudeOutput::Rate,
        &search_frequencies(band()),
        band(),
    )
    .unwrap();
    let found = Bandwidth::of(
        &response,
        &settings(CommandType::Rate),
        Some(PairBand {
            bands: &bands,
            pair: ONLY,
        }),
    );
    assert!(
        found.omega_180.unwrap().deviation.is_some()
            && found.phase_delay_s.unwrap().deviation.is_none()
    );
}

#[test]
fn the_bar_of_substitutions_holds_their_spread_and_counts_what_is_missing() {
    let bar = substitution_bar(2.0, &[Some(2.3), Some(1.6), None], &[]);
    assert_eq!((bar.left_out, bar.identification), (1, None));
    assert!((bar.variance() - (0.09 + 0.16) / 2.0).abs() < 1e-15);
    assert!(bar.interval(0.9).unwrap()[0] >= 0.0);
}

proptest! {
    #[test]
    fn scaling_the_gain_changes_no_bandwidth(gain in 1e-3_f64..1e3, case in 0_usize..4) {
        let attitude = attitudes()[case];
        let plain = of_attitude(attitude, &settings(CommandType::Rate));
        let scaled = of_attitude(|s| gain * attitude(s), &settings(CommandType::Rate));
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
    fn a_pure_delay_adds_exactly_half_of_itself_to_the_phase_delay_of_a_straight_phase(
        delay_s in 0.04_f64..0.3, more_s in 0.0_f64..0.3,
    ) {
        // 1/s and a delay: the phase is straight. It loses pi/2 up to omega_180 and as much
        // again up to twice that.
        let of = |delay_s: f64| of_attitude(move |s| (-delay_s * s).exp() / s, &settings(CommandType::Rate));
        let less = of(delay_s);
        let more = of(delay_s + more_s);
        prop_assert!(less.phase_line.unwrap().is_straight() && less.phase_line.unwrap().departure_deg < 1e-9);
        for (found, delay_s) in [(less, delay_s), (more, delay_s + more_s)] {
            prop_assert!((value(found.phase_delay_s) - 0.5 * delay_s).abs() < 1e-10);
            let line = found.phase_line.unwrap();
            prop_assert!((line.two_points_s - line.least_squares_s).abs() < 1e-10);
        }
    }
}
