//! Scaling, low-pass filter, spectral lines and the measured response.

use nalgebra::{Complex, DMatrix, DVector};
use proptest::prelude::*;

use gdcm_model::dataset::StateSpace;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::Sequential;
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::simulation::{FirstOrderHold, LowPass, Segment};
use gdcm_sysid::identification::ResponseEstimate;
use gdcm_sysid::likelihood::noise_covariance::NoiseCovariance;
use gdcm_sysid::spectra::cut_off::CutOff;
use gdcm_sysid::spectra::local_polynomial::local_polynomial;
use gdcm_sysid::spectra::local_polynomial_error::LocalPolynomialError;
use gdcm_sysid::spectra::scales::{Scales, ScalingError};
use gdcm_sysid::spectra::spectrum::{Spectrum, spectra};

use super::common::{
    HIGHEST_LINE, Threads, complex, known_answers, list, matrix, noise, noisy_segments,
    noisy_spectra, response, slow_system,
};
use crate::synthetic::tries;

#[test]
fn channel_scales_equal_the_reference() {
    let known = known_answers();
    let scales = Scales::from_segments(&noisy_segments(&known, 4)).unwrap();
    let expected = &known["noisy"]["scales"];
    for (scale, expected) in scales
        .inputs
        .iter()
        .chain(&scales.outputs)
        .zip(list(&expected["u"]).iter().chain(&list(&expected["y"])))
    {
        assert!(
            (scale - expected).abs() < 1e-9,
            "{scale} instead of {expected}"
        );
    }
}

#[test]
fn the_low_pass_filter_equals_the_reference() {
    let known = known_answers();
    let case = &known["lowpass"];
    let filter = LowPass::new(case["wc"].as_f64().unwrap(), case["dt"].as_f64().unwrap()).unwrap();
    for (filtered, expected) in filter
        .filter(&list(&case["x"]))
        .iter()
        .zip(list(&case["expected"]))
    {
        assert!(
            (filtered - expected).abs() < 1e-12,
            "{filtered} instead of {expected}"
        );
    }
}

#[test]
fn spectral_lines_equal_the_reference() {
    let known = known_answers();
    let case = &known["noisy"]["spectra_r1"];
    let lines = spectra(&noisy_segments(&known, 1), 100.0, &Sequential)[0]
        .between(case["lo"].as_f64().unwrap(), case["hi"].as_f64().unwrap());
    assert_eq!(lines.omega.len(), 4);
    for (omega, expected) in lines.omega.iter().zip(list(&case["w"])) {
        assert!((omega - expected).abs() < 1e-12);
    }
    assert!((lines.inputs.transpose() - complex(&case["U"])).camax() < 1e-9);
    assert!((lines.outputs.transpose() - complex(&case["Y"])).camax() < 1e-9);
}

#[test]
fn the_measured_response_equals_the_reference() {
    // Tolerance of the reference: 1e-6, for responses and noise relative to the largest entry.
    let known = known_answers();
    let case = &known["noisy"]["lpm"];
    let measured = local_polynomial(&noisy_spectra(), &list(&case["w"]), &Sequential).unwrap();
    let coherence = matrix(&case["coherence"]);
    for (k, point) in measured.points.iter().enumerate() {
        let response = matrix(&case["G_scaled"]["re"][k])
            .zip_map(&matrix(&case["G_scaled"]["im"][k]), Complex::new);
        assert!((&point.response - &response).camax() < 1e-6 * response.camax());
        let noise = matrix(&case["Cv"][k]);
        assert!((&point.noise - &noise).amax() < 1e-6 * noise.amax());
        assert!((point.coherence.transpose() - coherence.row(k)).amax() < 1e-6);
        assert!((&point.partial_coherence - matrix(&case["partial"][k])).amax() < 1e-6);
        assert_eq!(point.freedom, 10);
    }
}

/// Returns a synthetic system with 2 inputs and 2 outputs, and its records at 25 Hz without noise
/// and feedback; the inputs are low-pass filtered random numbers.
fn noise_free_records(records: usize, samples: usize) -> (StateSpace, Vec<Segment>) {
    let model = slow_system();
    let held = FirstOrderHold::new(&model, 0.04).unwrap();
    let mut segments = Vec::new();
    for record in 0..records {
        let mut inputs = DMatrix::zeros(samples, 2);
        for (i, mut column) in inputs.column_iter_mut().enumerate() {
            let mut value = 0.0;
            for (x, step) in column
                .iter_mut()
                .zip(noise((17 * record + i) as u64, samples))
            {
                value = 0.9 * value + step;
                *x = value;
            }
        }
        let outputs = held.simulate(&DVector::from_element(4, record as f64 - 1.5), &inputs);
        segments.push(Segment {
            record,
            start_s: 0.0,
            sample_time_s: 0.04,
            inputs,
            outputs,
        });
    }
    (model, segments)
}

/// Adds uniform noise between -`amplitude` and `amplitude` to all outputs.
fn add_output_noise(segment: &mut Segment, amplitude: f64, seed: u64) {
    let noise = noise(seed, segment.outputs.len());
    for (output, noise) in segment.outputs.iter_mut().zip(noise) {
        *output += amplitude * noise;
    }
}

#[test]
fn noise_free_records_give_the_response_of_the_system() {
    let (model, segments) = noise_free_records(4, 1500);
    let measured = local_polynomial(
        &spectra(&segments, HIGHEST_LINE, &Sequential),
        &log_spaced(0.5, 8.0, 12),
        &Sequential,
    )
    .unwrap();
    for point in &measured.points {
        let error = (&point.response - response(&model, point.omega)).camax();
        // 5 %: error of a second-degree polynomial over a window of +-0.45 rad/s, near modes whose
        // real parts are -0.4 rad/s or less.
        assert!(
            error < 0.05 * point.response.camax(),
            "{} rad/s: error {error}",
            point.omega
        );
        // Deviations of the response from the polynomial count as noise.
        assert!(
            point.coherence.iter().all(|c| *c > 0.99),
            "{} rad/s: coherence {}",
            point.omega,
            point.coherence
        );
    }
}

#[test]
fn the_variance_of_the_response_equals_the_spread_over_many_trials() {
    let (model, segments) = noise_free_records(2, 1000);
    let omegas = [3.0];
    let truth = local_polynomial(
        &spectra(&segments, HIGHEST_LINE, &Sequential),
        &omegas,
        &Sequential,
    )
    .unwrap()
    .points[0]
        .response
        .clone();
    let trials = 200;
    let mut predicted = DMatrix::zeros(2, 2);
    let mut spread = DMatrix::zeros(2, 2);
    for trial in 0..trials {
        let mut noisy = segments.clone();
        for (k, segment) in noisy.iter_mut().enumerate() {
            add_output_noise(segment, 10.0, 1000 + (10 * trial + k) as u64);
        }
        let point = &local_polynomial(
            &spectra(&noisy, HIGHEST_LINE, &Sequential),
            &omegas,
            &Sequential,
        )
        .unwrap()
        .points[0];
        predicted += &point.variance / trials as f64;
        spread += (&point.response - &truth).map(|e| e.norm_sqr() / trials as f64);
    }
    assert_eq!(model.order(), 4);
    for (predicted, spread) in predicted.iter().zip(spread.iter()) {
        // The noise is far larger than the deviations from the polynomial, which count as noise
        // too. 0.21 is three times 1 / sqrt 200, the relative standard deviation of a variance from
        // 200 complex trials.
        assert!(
            (predicted / spread - 1.0).abs() < 0.21,
            "predicted variance {predicted}, spread {spread}"
        );
    }
}

#[test]
fn the_noise_covariance_is_that_of_the_added_noise() {
    let (_, mut segments) = noise_free_records(6, 2000);
    for (k, segment) in segments.iter_mut().enumerate() {
        let noise = noise(50 + k as u64, 4000);
        for n in 0..2000 {
            // The noise is far larger than the deviations from the polynomial, which count as noise
            // too.
            segment.outputs[(n, 0)] += 10.0 * noise[n];
            segment.outputs[(n, 1)] += 10.0 * noise[n] + 5.0 * noise[2000 + n];
        }
    }
    let measured = local_polynomial(
        &spectra(&segments, HIGHEST_LINE, &Sequential),
        &log_spaced(0.5, 8.0, 40),
        &Sequential,
    )
    .unwrap();
    let covariance = NoiseCovariance::from_measured(&measured).unwrap();
    // White noise of variance 100/3 has spectral lines of power 100 dt / 3 = 4/3 (dt = 0.04 s). The
    // second output has the noise of the first and an independent noise of a quarter its power.
    let line_power = 4.0 / 3.0;
    let expected = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.25]) * line_power;
    // Mean over the same 40 frequencies, 0.5 to 8 rad/s.
    let mean = (0..40).fold(DMatrix::zeros(2, 2), |sum, k| {
        sum + covariance
            .at(0.5 * 16.0_f64.powf(k as f64 / 39.0))
            .map(|entry| entry.re)
            / 40.0
    });
    assert!((&mean - &expected).amax() < 0.1 * expected.amax(), "{mean}");
    let weight = covariance.weight(2.0).unwrap();
    // W Cv W^H = 2 I: real and imaginary part of a whitened line have unit variance each.
    let whitened = &weight * covariance.at(2.0) * weight.adjoint();
    let error = whitened.map(|entry| entry.re) - DMatrix::identity(2, 2) * 2.0;
    assert!(error.amax() < 1e-9);
    assert!(whitened.iter().all(|entry| entry.im.abs() < 1e-9));
    assert_eq!(weight[(0, 1)].norm(), 0.0);
}

#[test]
fn the_noise_covariance_is_smoothed_and_interpolated_in_log_frequency() {
    let mut measured =
        local_polynomial(&noisy_spectra(), &log_spaced(0.5, 8.0, 9), &Sequential).unwrap();
    for (k, point) in measured.points.iter_mut().enumerate() {
        point.noise = DMatrix::identity(2, 2) * if k == 4 { 9.0 } else { 0.0 };
        point.power.fill(0.0);
    }
    let covariance = NoiseCovariance::from_measured(&measured).unwrap();
    // Smoothing weights 1, 2, 3, 2, 1, divided by their sum 9; 1e-4 of the covariance is added.
    for (k, expected) in [
        (1, 0.0),
        (2, 1.0),
        (3, 2.0),
        (4, 3.0),
        (5, 2.0),
        (6, 1.0),
        (7, 0.0),
    ] {
        let at = covariance.at(measured.points[k].omega * (1.0 + 1e-15));
        assert!((at[(0, 0)] - 1.0001 * expected).norm() < 1e-9, "{k}");
    }
    // Halfway between the values 2 and 3 of the points 3 and 4.
    let between = covariance.at((measured.points[3].omega * measured.points[4].omega).sqrt());
    assert!((between[(0, 0)] - 1.0001 * 2.5).norm() < 1e-9);
    assert_eq!(covariance.at(1e-3), covariance.at(0.5));
    assert!(covariance.at(1e3)[(0, 0)].norm() < 1e-9);
}

#[test]
fn noise_free_and_linearly_dependent_outputs_have_a_weight() {
    let (_, mut segments) = noise_free_records(4, 1500);
    for segment in &mut segments {
        let sum = segment.outputs.column(0) * 2.0 + segment.outputs.column(1);
        segment.outputs = DMatrix::from_columns(&[
            segment.outputs.column(0).into_owned(),
            segment.outputs.column(1).into_owned(),
            sum,
        ]);
    }
    let measured = local_polynomial(
        &spectra(&segments, HIGHEST_LINE, &Sequential),
        &log_spaced(0.5, 8.0, 40),
        &Sequential,
    )
    .unwrap();
    let covariance = NoiseCovariance::from_measured(&measured).unwrap();
    assert!(
        [0.5, 1.0, 3.3, 8.0]
            .iter()
            .all(|&w| covariance.weight(w).is_some())
    );
}

#[test]
fn an_input_that_copies_another_is_not_identified() {
    let (_, mut segments) = noise_free_records(4, 1500);
    assert_eq!(
        local_polynomial(
            &spectra(&segments, HIGHEST_LINE, &Sequential),
            &log_spaced(0.5, 8.0, 12),
            &Sequential
        )
        .unwrap()
        .excitation()
        .not_identified()
        .count(),
        0
    );
    for (k, segment) in segments.iter_mut().enumerate() {
        let copy = segment.inputs.column(0) * 2.0;
        segment.inputs.column_mut(1).copy_from(&copy);
        add_output_noise(segment, 0.05, k as u64);
    }
    let measured = local_polynomial(
        &spectra(&segments, HIGHEST_LINE, &Sequential),
        &log_spaced(0.5, 8.0, 12),
        &Sequential,
    )
    .unwrap();
    let excitation = measured.excitation();
    assert!(excitation.moved_together());
    assert_eq!(excitation.not_identified().collect::<Vec<_>>(), [0, 1]);
    assert!(
        measured
            .points
            .iter()
            .all(|point| point.response.iter().all(|g| g.is_finite()))
    );
}

#[test]
fn an_input_without_effect_is_not_identified() {
    let (_, mut segments) = noise_free_records(5, 1500);
    for (k, segment) in segments.iter_mut().enumerate() {
        let without_effect = DVector::from_vec(noise(900 + k as u64, 1500));
        segment.inputs = DMatrix::from_columns(&[
            segment.inputs.column(0).into_owned(),
            segment.inputs.column(1).into_owned(),
            without_effect,
        ]);
        add_output_noise(segment, 0.05, k as u64);
    }
    let measured = local_polynomial(
        &spectra(&segments, HIGHEST_LINE, &Sequential),
        &log_spaced(0.5, 8.0, 40),
        &Sequential,
    )
    .unwrap();
    assert_eq!(
        measured.excitation().not_identified().collect::<Vec<_>>(),
        [2]
    );
}

#[test]
fn vibration_lowers_the_cut_off_and_its_channel_is_named() {
    let (_, mut segments) = noise_free_records(2, 1500);
    assert_eq!(
        CutOff::choose(&segments, 8.0, &Sequential),
        CutOff {
            omega: 40.0,
            highest: 8.0,
            vibrating: vec![]
        }
    );
    // A vibration of 50 rad/s in the second output, as large as its motion.
    let amplitude = segments[0].outputs.column(1).amax();
    for segment in &mut segments {
        for n in 0..1500 {
            segment.outputs[(n, 1)] += amplitude * (50.0 * 0.04 * n as f64).sin();
        }
    }
    let cut_off = CutOff::choose(&segments, 8.0, &Sequential);
    assert_eq!(
        (
            cut_off.omega,
            cut_off.vibrating.len(),
            cut_off.vibrating[0].0
        ),
        (16.0, 1, 1)
    );
    let filtered = cut_off.apply(&segments, &Sequential);
    let remaining = CutOff::choose(&filtered, 8.0, &Sequential).vibrating;
    assert_eq!(remaining, [], "the filter removes the vibration");
}

#[test]
fn the_low_pass_filter_keeps_straight_lines_and_refuses_cut_offs_near_the_nyquist_frequency() {
    let filter = LowPass::new(20.0, 0.02).unwrap();
    let line: Vec<f64> = (0..40).map(|n| 3.0 - 0.2 * n as f64).collect();
    for (filtered, line) in filter.filter(&line).iter().zip(&line) {
        assert!((filtered - line).abs() < 1e-12);
    }
    // The Nyquist frequency is pi / 0.02 s = 157 rad/s.
    for (omega, dt) in [
        (130.0, 0.02),
        (f64::NAN, 0.02),
        (-1.0, 0.02),
        (1e-12, 1e-12),
        (f64::INFINITY, 1.0),
        (0.0, 0.0),
    ] {
        assert_eq!(LowPass::new(omega, dt), None, "{omega} rad/s, {dt} s");
    }
    for length in 0..4 {
        // A signal shorter than the reach of the filter, 63 samples, is reflected repeatedly.
        assert!(
            filter
                .filter(&vec![2.5; length])
                .iter()
                .all(|x| (x - 2.5).abs() < 1e-12)
        );
    }
}

#[test]
fn a_short_record_has_a_response_and_too_few_lines_are_refused() {
    let (_, segments) = noise_free_records(1, 250);
    // 10 s give 16 lines up to 10.4 rad/s, all of which the polynomial of first degree uses.
    let all = spectra(&segments, HIGHEST_LINE, &Sequential);
    let point = &local_polynomial(&all, &[0.3], &Sequential).unwrap().points[0];
    assert!(
        point.half_width > 7.0 && point.freedom > 0,
        "{} {}",
        point.half_width,
        point.freedom
    );
    let few: Vec<Spectrum> = all.iter().map(|lines| lines.between(0.0, 6.0)).collect();
    let refused = local_polynomial(&few, &[0.3], &Sequential).unwrap_err();
    assert_eq!(
        refused,
        LocalPolynomialError::TooFewLines {
            lines: 9,
            needed: 12
        }
    );
}

#[test]
fn records_cut_into_pieces_of_twenty_seconds_give_the_response_of_the_system() {
    let (model, segments) = noise_free_records(9, 1500);
    let cut: Vec<Segment> = segments
        .iter()
        .flat_map(|segment| {
            (0..3).map(|k| Segment {
                inputs: segment.inputs.rows(500 * k, 500).into(),
                outputs: segment.outputs.rows(500 * k, 500).into(),
                ..segment.clone()
            })
        })
        .collect();
    let measured = local_polynomial(
        &spectra(&cut, HIGHEST_LINE, &Sequential),
        &log_spaced(0.25, 8.0, 40),
        &Sequential,
    )
    .unwrap();
    // 5 %, as for complete records.
    let point = measured.points.last().unwrap();
    assert!((&point.response - response(&model, 8.0)).camax() < 0.05 * point.response.camax());
}

#[test]
fn unusable_lines_and_frequencies_are_refused() {
    assert_eq!(
        local_polynomial(&[], &[1.0], &Sequential),
        Err(LocalPolynomialError::Nothing {
            missing: "spectral lines"
        })
    );
    let good = noisy_spectra();
    assert_eq!(
        local_polynomial(&good, &[], &Sequential),
        Err(LocalPolynomialError::Nothing {
            missing: "frequencies in the band"
        })
    );
    for omega in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        assert_eq!(
            local_polynomial(&good, &[omega], &Sequential),
            Err(LocalPolynomialError::NotFinite)
        );
    }
    // A frequency outside its window (extrapolation) is accepted.
    let far = local_polynomial(&good, &[1e9], &Sequential).unwrap();
    assert!(
        far.points[0]
            .response
            .iter()
            .all(|value| value.re.is_finite() && value.im.is_finite())
    );
    for value in [f64::NAN, f64::INFINITY, 1e200] {
        let mut bad = good.clone();
        bad[1].outputs[(0, 3)].im = value;
        assert_eq!(
            local_polynomial(&bad, &[1.0], &Sequential),
            Err(LocalPolynomialError::NotFinite)
        );
    }
    let mut bad = good.clone();
    bad[2].inputs = DMatrix::zeros(3, bad[2].omega.len());
    assert_eq!(
        local_polynomial(&bad, &[1.0], &Sequential),
        Err(LocalPolynomialError::ChannelsDiffer(2))
    );
    // Lines without any power are accepted; the results are finite.
    let silent: Vec<Spectrum> = good
        .iter()
        .map(|s| Spectrum {
            inputs: s.inputs.scale(0.0),
            outputs: s.outputs.scale(0.0),
            ..s.clone()
        })
        .collect();
    let measured = local_polynomial(&silent, &[1.0, 3.0], &Sequential).unwrap();
    assert!(
        measured
            .points
            .iter()
            .all(|p| p.response.iter().all(|g| g.is_finite())
                && p.variance.iter().all(|v| v.is_finite()))
    );
}

#[test]
fn unusable_segments_have_no_scales_and_no_lines() {
    let segment = |rows: usize, value: f64| Segment {
        record: 0,
        start_s: 0.0,
        sample_time_s: 0.02,
        inputs: DMatrix::from_element(rows, 1, value),
        outputs: DMatrix::from_fn(rows, 1, |n, _| n as f64),
    };
    assert_eq!(Scales::from_segments(&[]), Err(ScalingError::NoSegments));
    assert_eq!(
        Scales::from_segments(&[segment(9, 0.1)]),
        Err(ScalingError::Constant {
            role: ChannelSide::Input,
            index: 0
        })
    );
    assert_eq!(
        Scales::from_segments(&[segment(9, f64::NAN)]),
        Err(ScalingError::NotFinite(0))
    );
    assert_eq!(
        Scales::from_segments(&[segment(0, 0.0)]),
        Err(ScalingError::Constant {
            role: ChannelSide::Input,
            index: 0
        })
    );
    for rows in 0..3 {
        assert_eq!(
            spectra(&[segment(rows, 1.0)], 1e9, &Sequential)[0]
                .omega
                .len(),
            0
        );
    }
    let two_outputs = Segment {
        outputs: DMatrix::zeros(9, 2),
        ..segment(9, 1.0)
    };
    assert_eq!(
        Scales::from_segments(&[segment(9, 1.0), two_outputs]),
        Err(ScalingError::ChannelsDiffer(1))
    );
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let segments = noisy_segments(&known_answers(), 4);
    let scales = Scales::from_segments(&segments).unwrap();
    let scaled: Vec<_> = segments
        .iter()
        .map(|segment| scales.scaled(segment))
        .collect();
    let results = |threads: usize| {
        let executor = Threads(threads);
        let lines = spectra(&scaled, HIGHEST_LINE, &executor);
        let measured = local_polynomial(&lines, &log_spaced(0.3, 8.0, 40), &executor).unwrap();
        (CutOff::choose(&scaled, 8.0, &executor), measured)
    };
    assert_eq!(results(1), results(5));
}

fn measured_response(segments: &[Segment], omegas: &[f64]) -> ResponseEstimate {
    let lines = spectra(segments, HIGHEST_LINE, &Sequential);
    local_polynomial(&lines, omegas, &Sequential).unwrap()
}

/// Returns the response in the units of the channels, estimated from scaled segments.
fn response_in_units(segments: &[Segment], omegas: &[f64]) -> ResponseEstimate {
    let scales = Scales::from_segments(segments).unwrap();
    let scaled: Vec<_> = segments
        .iter()
        .map(|segment| scales.scaled(segment))
        .collect();
    measured_response(&scaled, omegas).in_units(&scales)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(tries(6, 16)))]

    #[test]
    fn trims_and_drifts_do_not_change_the_response(
        trim in -100.0..100.0,
        drift in -1.0..1.0,
        record in 0_usize..4,
        channel in 0_usize..4,
    ) {
        let segments = noisy_segments(&known_answers(), 4);
        let omegas = log_spaced(0.3, 8.0, 12);
        let before = measured_response(&segments, &omegas);
        let mut moved = segments.clone();
        let segment = &mut moved[record];
        let samples = if channel < 2 {
            &mut segment.inputs
        } else {
            &mut segment.outputs
        };
        // A constant is added to any channel, a ramp only to outputs, where it acts as a transient:
        // the response to a ramp of an input is a ramp of the output.
        let drift = if channel < 2 { 0.0 } else { drift };
        for (n, sample) in samples.column_mut(channel % 2).iter_mut().enumerate() {
            *sample += trim + 0.04 * drift * n as f64;
        }
        let after = measured_response(&moved, &omegas);
        for (before, after) in before.points.iter().zip(&after.points) {
            // The spectrum of a ramp is proportional to 1/(j omega). A second-degree polynomial
            // follows it only partly in windows that reach the first line; well above, 2 % of a
            // drift of 40 per record remain, compared with noise of 0.1.
            if before.omega > 1.5 || drift == 0.0 {
                let allowed = if drift == 0.0 { 1e-9 } else { 0.02 };
                let change = (&before.response - &after.response).camax();
                prop_assert!(change < allowed * before.response.camax().max(1.0));
            }
        }
    }

    #[test]
    fn permuting_records_and_channels_permutes_the_response(
        order in Just(vec![0_usize, 1, 2, 3]).prop_shuffle(),
    ) {
        let segments = noisy_segments(&known_answers(), 4);
        let omegas = log_spaced(0.5, 8.0, 7);
        let before = measured_response(&segments, &omegas);
        let swapped: Vec<Segment> = order
            .iter()
            .map(|&k| Segment {
                inputs: segments[k].inputs.select_columns(&[1, 0]),
                outputs: segments[k].outputs.select_columns(&[1, 0]),
                ..segments[k].clone()
            })
            .collect();
        let after = measured_response(&swapped, &omegas);
        for (before, after) in before.points.iter().zip(&after.points) {
            for here in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let there = (1 - here.0, 1 - here.1);
                let change = (before.response[here] - after.response[there]).norm();
                prop_assert!(change < 1e-9);
                let change = before.partial_coherence[here] - after.partial_coherence[there];
                prop_assert!(change.abs() < 1e-9);
                prop_assert!((before.noise[here] - after.noise[there]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_unit_of_an_input_scales_the_response(gain in 1e-3..1e3) {
        let segments = noisy_segments(&known_answers(), 4);
        let omegas = log_spaced(0.5, 8.0, 5);
        let before = response_in_units(&segments, &omegas);
        let mut other_unit = segments.clone();
        for segment in &mut other_unit {
            segment.inputs.column_mut(0).scale_mut(gain);
        }
        let after = response_in_units(&other_unit, &omegas);
        for (before, after) in before.points.iter().zip(&after.points) {
            for entry in [(0, 0), (1, 0)] {
                let change = (after.response[entry] * gain - before.response[entry]).norm();
                prop_assert!(change < 1e-9 * before.response.camax());
                let ratio = after.variance[entry] * gain * gain / before.variance[entry];
                prop_assert!((ratio - 1.0).abs() < 1e-9);
            }
        }
    }
}
