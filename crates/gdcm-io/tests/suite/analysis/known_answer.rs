//! Published helicopters with various channel counts, and flight models that differ from them by
//! known gains and delays.

use std::sync::Arc;

use gdcm_method::correction::GainBounds;
use gdcm_model::dataset::{Band, Dataset, ModelId};

use super::measured_flight::{dataset_with_flight, flight_state, measured_response};
use super::responses::model_of;
use super::*;
use crate::evidence;

/// Returns the known gain of a channel: different values between 0.7 and 1.3.
fn gain(channel: usize) -> f64 {
    1.0 + 0.3 * (0.7 * channel as f64).sin()
}

/// Returns a dataset with the helicopter of `file` as the physics model. The identified model is
/// its response as measured frequency data, with `gain` on every channel and a delay on every
/// response.
fn dataset_of(file: &str, delay_s: f64) -> Dataset {
    let dynamics = model_of(file);
    let (outputs, inputs) = dynamics.shape();
    let grid = FrequencyGrid::logarithmic(Band::new(0.2, 30.0).unwrap(), 3000);
    let response = FrequencyResponse::from_dynamics(&dynamics, &grid);
    let flight = response.curves().map(|pair, values| {
        let net_gain = gain(pair.output) * gain(outputs + pair.input);
        let lag = |omega: &f64| Complex::from_polar(net_gain, -omega * delay_s);
        values
            .iter()
            .zip(grid.omega())
            .map(|(value, omega)| value * lag(omega))
            .collect::<Vec<_>>()
    });
    let measured = measured_response(&grid, &flight, None);
    let on_axis = PairTable::filled(outputs, inputs, false);
    dataset_with_flight(flight_state(file, 0.0), dynamics, measured, on_axis)
}

#[test]
fn gains_and_delays_put_into_published_helicopters_are_found_again() {
    // Outputs and inputs of each published model.
    let shapes = [
        ("compleib_HE2_AH64_130kt.json", (2, 2)),
        ("yamaha_R50_hover_mettler.json", (13, 4)),
    ];
    let mut worst = 0.0_f64;
    let mut values = 0;
    for (file, shape) in shapes {
        let dataset = dataset_of(file, 0.02);
        assert_eq!(
            (dataset.outputs().len(), dataset.inputs().len()),
            shape,
            "{file}"
        );
        let mut study = Study::new(Arc::new(dataset));
        let bounds = GainBounds {
            lower: 0.3,
            upper: 3.0,
        };
        for edit in [
            setting_table::GAIN_BOUNDS.to(Some(bounds)),
            setting_table::DELAY_UPPER.to(Some(0.1)),
            setting_table::ALPHA_GAIN.to(0.0),
            setting_table::ALPHA_DELAY.to(0.0),
        ] {
            study.apply(&edit).unwrap();
        }
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let result = analysis.condition(ConditionId(1)).unwrap();
        let mut defined = 0;
        for (pair, delta_gain) in result.comparison.delta.gain.iter() {
            let Some(delta_gain) = delta_gain else {
                continue;
            };
            defined += 1;
            let known = gain(pair.output) * gain(shape.0 + pair.input);
            // Interpolation between 3000 measured frequencies: the error is a few 1e-6 at lightly
            // damped peaks, and far less for the median.
            let deviations = [
                delta_gain / known - 1.0,
                result.correction.net_gain(pair) / known - 1.0,
                result.correction.net_delay_s(pair) - 0.02,
            ];
            for deviation in deviations {
                assert!(deviation.abs() < 1e-6, "{file} {pair:?}: {deviations:?}");
                worst = worst.max(deviation.abs());
                values += 1;
            }
            assert!(
                result.cost[pair].unwrap().corrected.total() < 1e-4,
                "{file} {pair:?}: J after the correction is not zero"
            );
        }
        assert!(defined >= 4, "{file}: {defined} responses are defined");
    }
    evidence::record(evidence::Deviations {
        code: "recovered-gains-and-delays",
        instances: shapes.len(),
        values,
        worst,
        tolerance: 1e-6,
    });
}

#[test]
fn a_band_below_the_measured_frequencies_gives_no_result_and_states_the_reason() {
    let mut study = Study::new(Arc::new(dataset_of("compleib_HE2_AH64_130kt.json", 0.0)));
    study
        .apply(&setting_table::BAND.to(Band::new(0.1, 12.0).unwrap()))
        .unwrap();
    let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
    let failure = analysis.conditions[&ConditionId(1)].as_ref().unwrap_err();
    assert_eq!(failure.code(), "nothing-to-compare");
    assert!(analysis.schedule.is_err());
    let only_model = ModelId::new(ConditionId(1), BundleKind::Identified, "flight");
    assert!(
        study.apply(&Edit::Reject(only_model)).is_err(),
        "the only model of a bundle cannot be rejected"
    );
}
