//! Synthetic models for assembly tests.

use nalgebra::DMatrix;

use super::found_model::{ChannelLabel, Facts, FoundModel};
use crate::dataset::dataset_draft::{ModelDraft, ResponseArray, ResponseDraft};
use crate::dataset::model::{Origin, Provenance};
use crate::dataset::state_space::Timing;

/// Creates a measured response from one input at 1 and 5 rad/s; `values` contains two real values
/// per output.
pub fn measured_model(values: &[f64]) -> ModelDraft {
    let shape = [values.len() / 2, 1, 2];
    let response = ResponseDraft {
        omega: vec![1.0, 5.0],
        re: ResponseArray {
            shape,
            values: values.to_vec(),
        },
        im: ResponseArray {
            shape,
            values: vec![0.0; values.len()],
        },
        coherence: None,
        valid_bands: None,
        estimate: Default::default(),
    };
    ModelDraft {
        name: "measured".into(),
        origin: Origin::Identified {
            method: None,
            order: None,
        },
        matrices: [None, None, None, None],
        timing: Timing::default(),
        response: Some(response),
        source: None,
        states: Vec::new(),
        bands: None,
        moved: None,
    }
}

/// Creates a model found in a file: 1 / (s + 1), one input and one output without names.
pub fn found_model(file: &str, variable: Option<&str>, facts: Facts) -> FoundModel {
    let source = Provenance {
        file: Some(file.to_owned()),
        variable: variable.map(str::to_owned),
        ..Provenance::default()
    };
    FoundModel {
        draft: ModelDraft {
            name: String::new(),
            origin: Origin::Perturbed { perturbation: None },
            matrices: [-1.0, 1.0, 1.0, 0.0].map(|entry| Some(DMatrix::from_element(1, 1, entry))),
            timing: Timing::default(),
            response: None,
            source: Some(source),
            states: Vec::new(),
            bands: None,
            moved: None,
        },
        inputs: vec![ChannelLabel::default()],
        outputs: vec![ChannelLabel::default()],
        facts,
        notes: Vec::new(),
    }
}

/// Creates facts that contain only an airspeed.
pub fn at_airspeed(airspeed_kt: f64) -> Facts {
    Facts {
        airspeed_kt: Some(airspeed_kt),
        ..Facts::default()
    }
}
