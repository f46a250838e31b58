//! Effect of the coherence of measured responses on J, G, D and the bounds (M4a).

use std::sync::Arc;

use gdcm_method::fidelity::CostAverage;
use gdcm_method::fidelity::coherence_weights::coherence_weight;
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::dataset::DatasetHeader;
use gdcm_model::dataset::measured_response::MeasuredResponse;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{Band, Channel, Condition, Dataset, Model};
use gdcm_study::ConditionAnalysis;
use gdcm_study::decisions::edit_refusal::EditRefusal;
use gdcm_study::decisions::settings::{DEFAULT_COHERENCE, Settings};
use gdcm_study::results::caution::{Caution, Undefined};
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::remark::Remark;

use super::responses::model_of;
use super::*;

const ONLY: ConditionId = ConditionId(1);
const GAIN: f64 = 1.2;
const DELAY_S: f64 = 0.03;

/// Frequencies \[rad/s\] at which the measurement of the first response contains only noise.
const NOISE: std::ops::Range<f64> = 0.0..8.0;

/// Returns a dataset with a published helicopter as the physics model and a measured response as
/// the identified one: every response has an additional gain and delay, and the first is noise
/// within [`NOISE`]. `coherence` gives the coherence of a response (by index; 0 is the first) at a
/// frequency.
fn dataset(coherence: Option<&dyn Fn(usize, f64) -> f64>, bands: Option<[f64; 2]>) -> Arc<Dataset> {
    let dynamics = model_of("compleib_HE2_AH64_130kt.json");
    let (outputs, inputs) = dynamics.shape();
    let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 200);
    let flight = FrequencyResponse::from_dynamics(&dynamics, &grid)
        .curves()
        .map(|pair, values| {
            let turned = |(k, (value, omega)): (usize, (&Complex<f64>, &f64))| {
                let is_noise =
                    coherence.is_some() && pair == Pair::new(0, 0) && NOISE.contains(omega);
                let noise = if is_noise {
                    Complex::from_polar(3.0, 2.3 * (k * k) as f64)
                } else {
                    Complex::from(1.0)
                };
                value * Complex::from_polar(GAIN, -omega * DELAY_S) * noise
            };
            values
                .iter()
                .zip(grid.omega())
                .enumerate()
                .map(turned)
                .collect::<Vec<_>>()
        });
    let part = |of: fn(&Complex<f64>) -> f64| {
        flight.map(|_, values| values.iter().map(of).collect::<Vec<f64>>())
    };
    let coherence = coherence.map(|of| {
        flight.map(|pair, _| {
            let number = pair.output * inputs + pair.input;
            grid.omega()
                .iter()
                .map(|omega| of(number, *omega))
                .collect::<Vec<f64>>()
        })
    });
    let re = part(|value| value.re);
    let im = part(|value| value.im);
    let mut measured = MeasuredResponse::new(grid.omega().to_vec(), &re, &im, coherence).unwrap();
    if let Some(band) = bands {
        measured = measured
            .with_valid_bands(PairTable::filled(outputs, inputs, band))
            .unwrap();
    }
    let physics = Model::new("nominal", Origin::Nominal { perturbation: None }, dynamics);
    let origin = Origin::Identified {
        method: None,
        order: None,
    };
    let identified = Model::new("flight", origin, Dynamics::Measured(measured));
    let flight_state = FlightState {
        id: ONLY,
        name: "130 kt".to_owned(),
        airspeed_kt: 130.0,
        altitude: None,
        altitude_ft: None,
        weight: None,
        mass_kg: None,
    };
    let channels = |letter: &str, count| {
        (0..count)
            .map(|index| Channel::new(format!("{letter}{index}"), ""))
            .collect()
    };
    let header = DatasetHeader {
        name: "coherence".to_owned(),
        description: String::new(),
        inputs: channels("u", inputs),
        outputs: channels("y", outputs),
        on_axis: PairTable::filled(outputs, inputs, false),
        band: Band::new(0.5, 12.0).unwrap(),
        parameters: Vec::new(),
    };
    let condition = Condition::new(flight_state, vec![physics], vec![identified]).unwrap();
    Arc::new(Dataset::new(header, vec![condition]).unwrap())
}

fn noisy() -> Arc<Dataset> {
    dataset(
        Some(&|response, omega| {
            if response == 0 && NOISE.contains(&omega) {
                0.1
            } else {
                0.9
            }
        }),
        None,
    )
}

fn with(dataset: &Arc<Dataset>, edits: &[Edit]) -> Analysis {
    let mut study = Study::new(Arc::clone(dataset));
    edits.iter().for_each(|edit| study.apply(edit).unwrap());
    analyze(&mut Engine::default(), &study)
}

fn only(analysis: &Analysis) -> &ConditionAnalysis {
    analysis.condition(ONLY).unwrap()
}

#[test]
fn the_weights_are_those_of_the_reference() {
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
fn frequencies_that_were_not_measured_leave_g_d_j_and_the_bounds() {
    let analysis = with(
        &noisy(),
        &[setting_table::COST_AVERAGE.to(CostAverage::Mean)],
    );
    let result = only(&analysis);
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
            "{pair:?}: the mean over those that count"
        );
    }
    let off = with(
        &noisy(),
        &[
            setting_table::COST_AVERAGE.to(CostAverage::Mean),
            setting_table::COHERENCE.to(None::<f64>),
        ],
    );
    let gain = only(&off).comparison.delta.gain[Pair::new(0, 0)].unwrap();
    assert!(
        (gain / (3.0 * GAIN) - 1.0).abs() < 1e-12,
        "most of the band is noise of three times the gain"
    );
    assert!(only(&off).gain_bounds().upper > 3.0);
}

#[test]
fn equal_coherence_gives_the_medians_of_no_coherence_to_the_last_digit() {
    let equal = dataset(Some(&|_, _| 0.8), None);
    for points in [200, 131] {
        let points = setting_table::POINTS.to(points);
        let on = with(&equal, std::slice::from_ref(&points));
        let off = with(&equal, &[points, setting_table::COHERENCE.to(None::<f64>)]);
        assert_eq!(
            on.study.settings.coherence_threshold,
            Some(DEFAULT_COHERENCE),
            "it is on by default"
        );
        let on = only(&on);
        let off = only(&off);
        let [of_on, of_off] = [&on, &off].map(|of| &of.comparison.delta);
        assert_eq!(
            (&of_on.gain, &of_on.delay_s),
            (&of_off.gain, &of_off.delay_s)
        );
        for (pair, delay_s) in of_on.band_delay_s.iter() {
            // Rounding of a weighted mean of 200 terms.
            assert!((delay_s.unwrap() - of_off.band_delay_s[pair].unwrap()).abs() < 1e-14);
        }
        assert_eq!(
            (&on.gain_problem, &on.delay_problem),
            (&off.gain_problem, &off.delay_problem)
        );
        assert_eq!((&on.correction, &on.cost), (&off.correction, &off.cost));
    }
}

#[test]
fn a_dataset_without_coherence_gives_the_same_whether_it_is_on_or_off() {
    let plain = dataset(None, None);
    assert_eq!(Settings::for_dataset(&plain).coherence_threshold, None);
    let off = with(&plain, &[]);
    let on = with(&plain, &[setting_table::COHERENCE.to(Some(0.9))]);
    assert_eq!(
        (&off.conditions, &off.schedule),
        (&on.conditions, &on.schedule)
    );
}

#[test]
fn what_is_outside_the_valid_band_counts_for_nothing() {
    let good = |response: usize, omega: f64| {
        if response == 0 && NOISE.contains(&omega) {
            0.7
        } else {
            0.9
        }
    };
    let banded = dataset(Some(&good), Some([8.0, 11.0]));
    let result = with(&banded, &[]);
    for (_, mismatch) in only(&result).comparison.representative.mismatch.iter() {
        let omega = mismatch
            .as_ref()
            .unwrap()
            .coherence_weights
            .as_ref()
            .unwrap()
            .omega
            .as_slice();
        assert!(omega.iter().all(|omega| (8.0..=11.0).contains(omega)) && omega.len() > 10);
    }
    let gain = only(&result).comparison.delta.gain[Pair::new(0, 0)].unwrap();
    assert!((gain / GAIN - 1.0).abs() < 1e-12);
}

#[test]
fn a_response_that_was_nowhere_measured_has_no_g_and_says_why() {
    let never = dataset(
        Some(&|response, _| if response == 0 { 0.2 } else { 0.9 }),
        None,
    );
    let first = Pair::new(0, 0);
    let analysis = with(&never, &[Edit::Hold(first, true)]);
    let result = only(&analysis);
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
fn a_result_says_what_coherence_did() {
    let analysis = with(&noisy(), &[]);
    let result = only(&analysis);
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
    assert!(matches!(left_out[..], [(Pair { output: 0, input: 0 }, count)] if count > 100));

    let equal = with(&dataset(Some(&|_, _| 0.8), None), &[]);
    let said = condition_remarks(&equal.study, only(&equal), None);
    assert!(
        said.contains(&Remark::CoherenceUsed { responses: 4 }),
        "{said:?}"
    );

    let off = with(&noisy(), &[setting_table::COHERENCE.to(None::<f64>)]);
    let cautions = &only(&off).cautions;
    assert!(
        cautions.contains(&Caution::CoherenceNotUsed),
        "{cautions:?}"
    );
}

#[test]
fn a_threshold_outside_0_to_1_is_refused() {
    let mut study = Study::new(noisy());
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
