//! The reference dataset of the tests, read from a compressed JSON file.

use std::io::Read;
use std::sync::Arc;

use nalgebra::DMatrix;
use serde_json::Value;

use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::dataset::DatasetHeader;
use gdcm_model::dataset::model::{ModelBands, Origin};
use gdcm_model::dataset::{
    Band, Channel, Condition, ConditionId, Dataset, Dynamics, Model, Pair, PairTable, StateSpace,
};

/// Returns the reference dataset, for which the expected values are stored.
pub(crate) fn reference_dataset() -> Dataset {
    unpacked_dataset(include_bytes!(
        "../../../tests/data/reference/example-dataset.json.gz"
    ))
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

pub(crate) fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    list(value).iter().map(number).collect()
}

fn text(value: &Value) -> String {
    value.as_str().unwrap().to_owned()
}

pub(crate) fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = list(value).iter().map(numbers).collect();
    DMatrix::from_fn(rows.len(), rows[0].len(), |row, column| rows[row][column])
}

fn model(value: &Value, origin: Origin) -> Model {
    let [a, b, c, d] = ["A", "B", "C", "D"].map(|name| matrix(&value[name]));
    let dynamics = Dynamics::StateSpace(StateSpace::new(a, b, c, d).unwrap());
    let bands = value.get("bands").map(|bands| {
        let table = |name: &str| {
            PairTable::from_fn(6, 4, |pair| numbers(&bands[name][pair.output][pair.input]))
        };
        Arc::new(
            ModelBands::new(
                numbers(&bands["omega_rad_s"]),
                table("sd_db"),
                table("sd_deg"),
            )
            .unwrap(),
        )
    });
    Model {
        bands,
        ..Model::new(text(&value["name"]), origin, dynamics)
    }
}

fn condition(value: &Value) -> Condition {
    let physics = list(&value["physics_models"]).iter().map(|entry| {
        let perturbation = None;
        let is_nominal = entry["role"].as_str() == Some("nominal");
        model(
            entry,
            if is_nominal {
                Origin::Nominal { perturbation }
            } else {
                Origin::Perturbed { perturbation }
            },
        )
    });
    let identified = list(&value["identified_models"]).iter().map(|entry| {
        model(
            entry,
            Origin::Identified {
                method: None,
                order: None,
            },
        )
    });
    let flight_state = FlightState::at(
        ConditionId(value["id"].as_i64().unwrap()),
        number(&value["airspeed_kt"]),
    );
    Condition::new(flight_state, physics.collect(), identified.collect()).unwrap()
}

/// Returns a dataset from its file, JSON compressed with gzip.
pub(crate) fn unpacked_dataset(packed: &[u8]) -> Dataset {
    let mut unpacked = String::new();
    flate2::read::GzDecoder::new(packed)
        .read_to_string(&mut unpacked)
        .unwrap();
    let file: Value = serde_json::from_str(&unpacked).unwrap();
    let channels = |side: &str| -> Vec<Channel> {
        list(&file[side])
            .iter()
            .map(|channel| Channel::new(text(&channel["name"]), text(&channel["unit"])))
            .collect()
    };
    let inputs = channels("inputs");
    let outputs = channels("outputs");
    let is_on_axis = |pair: Pair| {
        list(&file["on_axis"]).iter().any(|on_axis| {
            on_axis[0] == outputs[pair.output].name.as_str()
                && on_axis[1] == inputs[pair.input].name.as_str()
        })
    };
    let header = DatasetHeader {
        name: "reference".into(),
        description: String::new(),
        on_axis: PairTable::from_fn(outputs.len(), inputs.len(), is_on_axis),
        band: Band::new(
            number(&file["frequency_band"]["min"]),
            number(&file["frequency_band"]["max"]),
        )
        .unwrap(),
        inputs,
        outputs,
        parameters: Vec::new(),
    };
    Dataset::new(
        header,
        list(&file["conditions"]).iter().map(condition).collect(),
    )
    .unwrap()
}
