//! Datasets with one condition: a physics model, and a measured response as the identified model.

use nalgebra::Complex;

use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::dataset::DatasetHeader;
use gdcm_model::dataset::measured_response::MeasuredResponse;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{
    Band, Channel, Condition, ConditionId, Dataset, Dynamics, Model, PairTable,
};
use gdcm_model::response::FrequencyGrid;

/// Returns the response `values` at the frequencies of `grid`, as measured with a given coherence.
pub(super) fn measured_response(
    grid: &FrequencyGrid,
    values: &PairTable<Vec<Complex<f64>>>,
    coherence: Option<PairTable<Vec<f64>>>,
) -> MeasuredResponse {
    let re = values.map(|_, curve| curve.iter().map(|value| value.re).collect::<Vec<f64>>());
    let im = values.map(|_, curve| curve.iter().map(|value| value.im).collect::<Vec<f64>>());
    MeasuredResponse::new(grid.omega().to_vec(), &re, &im, coherence).unwrap()
}

/// Returns condition 1 at an airspeed.
pub(super) fn flight_state(name: &str, airspeed_kt: f64) -> FlightState {
    FlightState {
        id: ConditionId(1),
        name: name.to_owned(),
        airspeed_kt,
        altitude: None,
        altitude_ft: None,
        weight: None,
        mass_kg: None,
    }
}

/// Returns a dataset with a single condition, in which the physics model is called "nominal" and
/// the identified model "flight", for a band from 0.5 to 12 rad/s. Its inputs are u0, u1, ..., its
/// outputs y0, y1, ...
pub(super) fn dataset_with_flight(
    flight_state: FlightState,
    physics: Dynamics,
    flight: MeasuredResponse,
    on_axis: PairTable<bool>,
) -> Dataset {
    let (outputs, inputs) = physics.shape();
    let name = flight_state.name.clone();
    let nominal = Model::new("nominal", Origin::Nominal { perturbation: None }, physics);
    let origin = Origin::Identified {
        method: None,
        order: None,
    };
    let identified = Model::new("flight", origin, Dynamics::Measured(flight));
    let condition = Condition::new(flight_state, vec![nominal], vec![identified]).unwrap();
    let header = DatasetHeader {
        name,
        description: String::new(),
        inputs: channels("u", inputs),
        outputs: channels("y", outputs),
        on_axis,
        band: Band::new(0.5, 12.0).unwrap(),
        parameters: Vec::new(),
    };
    Dataset::new(header, vec![condition]).unwrap()
}

fn channels(letter: &str, count: usize) -> Vec<Channel> {
    (0..count)
        .map(|index| Channel::new(format!("{letter}{index}"), ""))
        .collect()
}
