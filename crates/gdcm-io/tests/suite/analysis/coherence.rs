//! Effect of the coherence of measured responses on J, G, D and the bounds (M4a).

use std::sync::Arc;

use gdcm_method::fidelity::CostAverage;
use gdcm_method::fidelity::coherence_weights::coherence_weight;
use gdcm_model::dataset::{Band, Dataset};
use gdcm_study::ConditionAnalysis;
use gdcm_study::decisions::edit_refusal::EditRefusal;
use gdcm_study::decisions::settings::{DEFAULT_COHERENCE, Settings};
use gdcm_study::results::caution::{Caution, Undefined};
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::remark::Remark;

use super::measured_flight::{dataset_with_flight, flight_state, measured_response};
use super::responses::model_of;
use super::*;

/// The only condition of the dataset.
const ONLY: ConditionId = ConditionId(1);
/// Gain of every measured response relative to the physics model.
const GAIN: f64 = 1.2;
/// Delay of every measured response relative to the physics model.
const DELAY_S: f64 = 0.03;

/// Frequencies \[rad/s\] at which the measurement of the first response contains only noise.
const NOISE_RAD_S: std::ops::Range<f64> = 0.0..8.0;

/// Returns a dataset with a published helicopter as the physics model and a measured response as
/// the identified one: every response has the additional [`GAIN`] and [`DELAY_S`], and the first is
/// noise within [`NOISE_RAD_S`] if `coherence` is given. `coherence` returns the coherence of a
/// response (by index; 0 is the first) at a frequency; `band` limits the valid frequencies of all
/// responses.
fn dataset(coherence: Option<&dyn Fn(usize, f64) -> f64>, band: Option<[f64; 2]>) -> Arc<Dataset> {
    let dynamics = model_of("compleib_HE2_AH64_130kt.json");
    let (outputs, inputs) = dynamics.shape();
    let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 200);
    let flight = FrequencyResponse::from_dynamics(&dynamics, &grid)
        .curves()
        .map(|pair, values| {
            let has_noise = coherence.is_some() && pair == Pair::new(0, 0);
            let mut measured = Vec::with_capacity(values.len());
            for (k, (value, omega)) in values.iter().zip(grid.omega()).enumerate() {
                let noise = if has_noise && NOISE_RAD_S.contains(omega) {
                    // Three times the true gain, at scattered phases.
                    Complex::from_polar(3.0, 2.3 * (k * k) as f64)
                } else {
                    Complex::from(1.0)
                };
                measured.push(value * Complex::from_polar(GAIN, -omega * DELAY_S) * noise);
            }
            measured
        });
    let coherence = coherence.map(|coherence_at| {
        flight.map(|pair, _| {
            let number = pair.output * inputs + pair.input;
            grid.omega()
                .iter()
                .map(|omega| coherence_at(number, *omega))
                .collect::<Vec<f64>>()
        })
    });
    let mut measured = measured_response(&grid, &flight, coherence);
    if let Some(band) = band {
        measured = measured
            .with_valid_bands(PairTable::filled(outputs, inputs, band))
            .unwrap();
    }
    let on_axis = PairTable::filled(outputs, inputs, false);
    let state = flight_state("130 kt", 130.0);
    Arc::new(dataset_with_flight(state, dynamics, measured, on_axis))
}

/// Returns a dataset in which the coherence tells the noise of the first response: 0.1 where it is
/// noise, 0.9 elsewhere.
fn noisy_dataset() -> Arc<Dataset> {
    dataset(
        Some(&|response, omega| {
            if response == 0 && NOISE_RAD_S.contains(&omega) {
                0.1
            } else {
                0.9
            }
        }),
        None,
    )
}

fn analysis_with(dataset: &Arc<Dataset>, edits: &[Edit]) -> Analysis {
    let mut study = Study::new(Arc::clone(dataset));
    for edit in edits {
        study.apply(edit).unwrap();
    }
    analyze(&mut Engine::default(), &study)
}

fn only_result(analysis: &Analysis) -> &ConditionAnalysis {
    analysis.condition(ONLY).unwrap()
}

#[test]
fn coherence_weights_match_the_reference() {
    let golden = json(include_str!(
        "../../../../../tests/data/reference/muad-golden.json"
    ));
    let rows = list(&golden["Wgamma"]);
    assert!(rows.len() >= 8);
    for row in rows {
        let [coherence, weight] = numbers(row)[..] else {
            panic!("two numbers")
        };
        assert!(
            (coherence_weight(coherence) - weight).abs() < 1e-15,
            "{coherence}"
        );
    }
}

#[test]
fn incoherent_frequencies_do_not_affect_g_d_j_and_the_bounds() {
    let analysis = analysis_with(
        &noisy_dataset(),
        &[setting_table::COST_AVERAGE.to(CostAverage::Mean)],
    );
    let result = only_result(&analysis);
    for (pair, gain) in result.comparison.delta.gain.iter() {
        // Rounding only: the response is measured at the frequencies of the analysis and converted
        // to dB and back.
        assert!((gain.unwrap() / GAIN - 1.0).abs() < 1e-12, "{pair:?}");
        assert!(
            (result.comparison.delta.delay_s[pair].unwrap() - DELAY_S).abs() < 1e-12,
            "{pair:?}"
        );
    }
    assert!(
        (result.gain_bounds().upper - GAIN).abs() < 1e-12
            && (result.delay_upper_s() - DELAY_S).abs() < 1e-12
    );
    let weight = coherence_weight(0.9);
    let expected = 20.0 * weight * (20.0 * GAIN.log10()).powi(2);
    let magnitude = |pair| result.cost[pair].unwrap().uncorrected.magnitude;
    for pair in result.cost.pairs() {
        assert!(
            (magnitude(pair) / expected - 1.0).abs() < 1e-11,
            "{pair:?}: the mean over the coherent frequencies"
        );
    }
    let off = analysis_with(
        &noisy_dataset(),
        &[
            setting_table::COST_AVERAGE.to(CostAverage::Mean),
            setting_table::COHERENCE.to(None::<f64>),
        ],
    );
    let gain = only_result(&off).comparison.delta.gain[Pair::new(0, 0)].unwrap();
    assert!(
        (gain / (3.0 * GAIN) - 1.0).abs() < 1e-12,
        "most of the band is noise of three times the gain"
    );
    assert!(only_result(&off).gain_bounds().upper > 3.0);
}

#[test]
fn equal_coherence_gives_exactly_the_medians_without_coherence() {
    let equal = dataset(Some(&|_, _| 0.8), None);
    for points in [200, 131] {
        let points = setting_table::POINTS.to(points);
        let on = analysis_with(&equal, std::slice::from_ref(&points));
        let off = analysis_with(&equal, &[points, setting_table::COHERENCE.to(None::<f64>)]);
        assert_eq!(
            on.study.settings.coherence_threshold,
            Some(DEFAULT_COHERENCE),
            "a dataset with coherence has a threshold by default"
        );
        let on = only_result(&on);
        let off = only_result(&off);
        let delta_on = &on.comparison.delta;
        let delta_off = &off.comparison.delta;
        assert_eq!(
            (&delta_on.gain, &delta_on.delay_s),
            (&delta_off.gain, &delta_off.delay_s)
        );
        for (pair, delay_s) in delta_on.band_delay_s.iter() {
            // Rounding of a weighted mean of 200 terms.
            assert!((delay_s.unwrap() - delta_off.band_delay_s[pair].unwrap()).abs() < 1e-14);
        }
        assert_eq!(
            (&on.gain_problem, &on.delay_problem),
            (&off.gain_problem, &off.delay_problem)
        );
        assert_eq!((&on.correction, &on.cost), (&off.correction, &off.cost));
    }
}

#[test]
fn a_threshold_has_no_effect_on_a_dataset_without_coherence() {
    let plain = dataset(None, None);
    assert_eq!(Settings::for_dataset(&plain).coherence_threshold, None);
    let off = analysis_with(&plain, &[]);
    let on = analysis_with(&plain, &[setting_table::COHERENCE.to(Some(0.9))]);
    assert_eq!(
        (&off.conditions, &off.schedule),
        (&on.conditions, &on.schedule)
    );
}

#[test]
fn frequencies_outside_the_valid_band_have_no_weight() {
    // Above the threshold even where the first response is noise: only the band excludes it.
    let coherence = |response: usize, omega: f64| {
        if response == 0 && NOISE_RAD_S.contains(&omega) {
            0.7
        } else {
            0.9
        }
    };
    let banded = dataset(Some(&coherence), Some([8.0, 11.0]));
    let result = analysis_with(&banded, &[]);
    let mismatches = &only_result(&result).comparison.representative.mismatch;
    for (pair, mismatch) in mismatches.iter() {
        let mismatch = mismatch.as_ref().unwrap();
        let omega = &mismatch.coherence_weights.as_ref().unwrap().omega;
        assert!(omega.len() > 10, "{pair:?}: {} frequencies", omega.len());
        assert!(
            omega.iter().all(|omega| (8.0..=11.0).contains(omega)),
            "{pair:?}: {omega:?}"
        );
    }
    let gain = only_result(&result).comparison.delta.gain[Pair::new(0, 0)].unwrap();
    assert!((gain / GAIN - 1.0).abs() < 1e-12);
}

#[test]
fn a_response_without_coherent_frequencies_has_no_g_and_states_the_reason() {
    let never = dataset(
        Some(&|response, _| if response == 0 { 0.2 } else { 0.9 }),
        None,
    );
    let first = Pair::new(0, 0);
    let analysis = analysis_with(&never, &[Edit::Hold(first, true)]);
    let result = only_result(&analysis);
    assert_eq!(result.comparison.delta.gain[first], None);
    assert_eq!(
        result.comparison.undefined[first],
        Some(Undefined::NotCoherent)
    );
    assert!(!result.held()[first] && result.cost[first].is_none());
    assert!(
        result.cautions.contains(&Caution::HeldButUndefined {
            pair: first,
            why: Undefined::NotCoherent
        }),
        "{:?}",
        result.cautions
    );
}

#[test]
fn a_result_reports_the_effect_of_coherence() {
    let analysis = analysis_with(&noisy_dataset(), &[]);
    let result = only_result(&analysis);
    let [
        Caution::NotCoherent {
            left_out,
            points: 200,
            weighed: 4,
            ..
        },
    ] = &result.cautions[1..]
    else {
        panic!("{:?}", result.cautions)
    };
    // More than half of the 200 frequencies are below 8 rad/s, where the first response is noise.
    assert!(
        matches!(left_out[..], [(Pair { output: 0, input: 0 }, count)] if count > 100),
        "{left_out:?}"
    );

    let equal = analysis_with(&dataset(Some(&|_, _| 0.8), None), &[]);
    let remarks = condition_remarks(&equal.study, only_result(&equal), None);
    assert!(
        remarks.contains(&Remark::CoherenceUsed { responses: 4 }),
        "{remarks:?}"
    );

    let off = analysis_with(
        &noisy_dataset(),
        &[setting_table::COHERENCE.to(None::<f64>)],
    );
    let cautions = &only_result(&off).cautions;
    assert!(
        cautions.contains(&Caution::CoherenceNotUsed),
        "{cautions:?}"
    );
}

#[test]
fn a_threshold_outside_0_to_1_is_refused() {
    let mut study = Study::new(noisy_dataset());
    for threshold in [-0.1, 1.1, f64::NAN] {
        let refusal = study
            .apply(&setting_table::COHERENCE.to(Some(threshold)))
            .unwrap_err();
        assert!(
            matches!(
                refusal,
                EditRefusal::OutOfRange { found, .. } if found.total_cmp(&threshold).is_eq()
            ),
            "{refusal:?}"
        );
    }
}
