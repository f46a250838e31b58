//! A dataset before its checks, as filled by any format's reader; `draft_checks.rs` turns it into a
//! dataset.

use nalgebra::{Complex, DMatrix};

use super::channel::Channel;
use super::condition::{ConditionRecord, FlightState};
use super::dynamics::Dynamics;
use super::measured_response::{Estimate, MeasuredResponse};
use super::model::{Model, Origin, Provenance};
use super::pair_table::PairTable;
use super::physics_parameter::{MovedModel, MovedParameters, PhysicsParameter};
use super::state_space::Timing;

/// A dataset before its checks.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetDraft {
    pub name: String,
    /// Content and source of the data.
    pub description: String,
    pub inputs: Vec<Channel>,
    pub outputs: Vec<Channel>,
    /// On-axis responses: output name and input name.
    pub on_axis: Vec<(String, String)>,
    /// Default band, lower and upper end \[rad/s\].
    pub band: (f64, f64),
    /// Named physics model parameters.
    pub parameters: Vec<PhysicsParameter>,
    pub conditions: Vec<ConditionDraft>,
}

/// A flight condition before its checks.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionDraft {
    pub flight_state: FlightState,
    /// The physics bundle, and the models with moved parameters.
    pub physics: Vec<ModelDraft>,
    pub identified: Vec<ModelDraft>,
    pub records: Vec<ConditionRecord>,
}

/// A model before its checks.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelDraft {
    pub name: String,
    pub origin: Origin,
    /// Matrices A, B, C and D; `None` if missing.
    pub matrices: [Option<DMatrix<f64>>; 4],
    pub timing: Timing,
    pub response: Option<ResponseDraft>,
    pub source: Option<Provenance>,
    /// State names; empty if unknown. They identify the states of runs (M18.1) and name modes
    /// (M17.3).
    pub states: Vec<String>,
    /// Standard deviation of the response over frequency, if the file gives it.
    pub bands: Option<BandsDraft>,
    /// Named parameters moved in a physics model; `None` for a model in a bundle.
    pub moved: Option<MovedParameters>,
}

/// A measured frequency response before its checks.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseDraft {
    /// Frequencies \[rad/s\].
    pub omega: Vec<f64>,
    pub re: ResponseArray,
    pub im: ResponseArray,
    /// Coherence (0 to 1); `None` if the file does not give it.
    pub coherence: Option<ResponseArray>,
    /// Each response's first and last trusted frequency \[rad/s\], both 0 if none is
    /// trusted; `None` if the file does not give them.
    pub valid_bands: Option<ResponseArray>,
    pub estimate: Estimate,
}

/// Standard deviation of a model's response, before its checks.
#[derive(Clone, Debug, PartialEq)]
pub struct BandsDraft {
    /// Frequencies \[rad/s\].
    pub omega: Vec<f64>,
    /// Standard deviation in magnitude \[dB\].
    pub sd_db: ResponseArray,
    /// Standard deviation in phase \[deg\].
    pub sd_deg: ResponseArray,
}

/// Values for each response, `[output][input][value]`: one for each frequency, or the two ends of a
/// valid band. The last index runs fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseArray {
    /// Output count, input count and value count.
    pub shape: [usize; 3],
    pub values: Vec<f64>,
}

impl ModelDraft {
    /// Converts a model to a draft, so that it can be written or merged.
    pub fn from_model(model: &Model) -> Self {
        let mut draft = Self {
            name: model.name.clone(),
            origin: model.origin.clone(),
            matrices: [None, None, None, None],
            timing: Timing::default(),
            response: None,
            source: model.source.clone(),
            states: model.states.to_vec(),
            bands: model.bands.as_deref().map(|bands| BandsDraft {
                omega: bands.omega().to_vec(),
                sd_db: ResponseArray::from_table(bands.sd_db()),
                sd_deg: ResponseArray::from_table(bands.sd_deg()),
            }),
            moved: None,
        };
        match &model.dynamics {
            Dynamics::StateSpace(system) => {
                draft.matrices = [system.a(), system.b(), system.c(), system.d()]
                    .map(|matrix| Some(matrix.clone()));
                draft.timing = system.timing().clone();
            }
            Dynamics::Measured(response) => {
                draft.response = Some(ResponseDraft::from_response(response));
            }
        }
        draft
    }

    /// Converts a model with moved parameters to a draft, so that it can be written.
    pub fn from_moved(moved: &MovedModel) -> Self {
        Self {
            moved: Some(moved.moved.clone()),
            ..Self::from_model(&moved.model)
        }
    }
}

impl ResponseDraft {
    fn from_response(response: &MeasuredResponse) -> Self {
        let values = response.values();
        Self {
            omega: response.omega().to_vec(),
            re: ResponseArray::from_table(&values.map(|_, values| real_parts(values))),
            im: ResponseArray::from_table(&values.map(|_, values| imaginary_parts(values))),
            coherence: response.coherence().map(ResponseArray::from_table),
            valid_bands: response.valid_bands().map(ResponseArray::from_table),
            estimate: response.estimate(),
        }
    }
}

impl ResponseArray {
    /// Converts a table with the same value count in every response.
    fn from_table<V: AsRef<[f64]>>(table: &PairTable<V>) -> Self {
        let mut length = 0;
        let mut values = Vec::new();
        for (_, entry) in table.iter() {
            length = entry.as_ref().len();
            values.extend_from_slice(entry.as_ref());
        }
        Self {
            shape: [table.outputs(), table.inputs(), length],
            values,
        }
    }
}

fn real_parts(values: &[Complex<f64>]) -> Vec<f64> {
    values.iter().map(|value| value.re).collect()
}

fn imaginary_parts(values: &[Complex<f64>]) -> Vec<f64> {
    values.iter().map(|value| value.im).collect()
}
