//! The complete dataset: channels, conditions and models, consistent with one another.

use std::sync::Arc;

use super::band::Band;
use super::channel::Channel;
use super::condition::Condition;
use super::dynamics::Dynamics;
use super::model::Model;
use super::model_id::{BundleKind, ConditionId, ModelId};
use super::pair_table::{Pair, PairTable};
use super::physics_parameter::{ParameterError, PhysicsParameter, check_parameters};

/// Channels, on-axis responses, default band, and the flight conditions with their models (M1).
///
/// Checked at construction: every model has the dataset's `p` outputs and `m` inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Dataset {
    header: DatasetHeader,
    conditions: Vec<Arc<Condition>>,
}

/// Error for channels and conditions that do not form a dataset.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DatasetError {
    /// A list without entries: inputs, outputs or conditions.
    #[error("{0}: expected at least one entry, found none")]
    Empty(&'static str),
    #[error("{list}: duplicate name \"{name}\"; names must differ")]
    DuplicateChannel {
        /// `inputs` or `outputs`.
        list: &'static str,
        name: String,
    },
    #[error(
        "conditions: duplicate id {id} (positions {first} and {second} in the list); ids must \
        differ"
    )]
    DuplicateId {
        id: ConditionId,
        /// First condition, counted from 1.
        first: usize,
        /// Second condition, counted from 1.
        second: usize,
    },
    #[error(
        "on_axis: expected {} outputs x {} inputs, found {} x {}",
        expected.0, expected.1, found.0, found.1
    )]
    OnAxisShape {
        /// The dataset's outputs and inputs.
        expected: (usize, usize),
        /// Rows and columns.
        found: (usize, usize),
    },
    #[error(
        "condition {condition}, model \"{model}\": expected {} outputs x {} inputs, found {} x {}",
        expected.0, expected.1, found.0, found.1
    )]
    ModelShape {
        condition: ConditionId,
        model: String,
        expected: (usize, usize),
        /// The model's outputs and inputs.
        found: (usize, usize),
    },
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

impl DatasetError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Empty(..) => "empty-dataset",
            Self::DuplicateChannel { .. } => "duplicate-channel",
            Self::DuplicateId { .. } => "duplicate-condition",
            Self::OnAxisShape { .. } => "on-axis-shape",
            Self::ModelShape { .. } => "model-shape",
            Self::Parameter(error) => error.code(),
        }
    }
}

/// A dataset's description, without its conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetHeader {
    pub name: String,
    /// Content and source of the data.
    pub description: String,
    pub inputs: Vec<Channel>,
    pub outputs: Vec<Channel>,
    /// On-axis responses (M1).
    pub on_axis: PairTable<bool>,
    /// Default band in which models are compared.
    pub band: Band,
    /// Named physics model parameters (M18.1).
    pub parameters: Vec<PhysicsParameter>,
}

impl Dataset {
    /// Creates a dataset from conditions in file order.
    ///
    /// # Errors
    /// [`DatasetError`] for an empty list, a duplicate channel name or condition identifier, a
    /// wrong channel count in a model or in `on_axis`, or an invalid parameter.
    pub fn new(header: DatasetHeader, conditions: Vec<Condition>) -> Result<Self, DatasetError> {
        check_channels("inputs", &header.inputs)?;
        check_channels("outputs", &header.outputs)?;
        let expected = (header.outputs.len(), header.inputs.len());
        let found = (header.on_axis.outputs(), header.on_axis.inputs());
        if found != expected {
            return Err(DatasetError::OnAxisShape { expected, found });
        }
        check_parameters(&header.parameters)?;
        check_conditions(&conditions, expected)?;
        Ok(Self {
            header,
            conditions: conditions.into_iter().map(Arc::new).collect(),
        })
    }

    /// Copies the description, without the conditions.
    pub fn header(&self) -> DatasetHeader {
        self.header.clone()
    }

    /// Returns the display name.
    pub fn name(&self) -> &str {
        &self.header.name
    }

    /// Returns the content and source of the data.
    pub fn description(&self) -> &str {
        &self.header.description
    }

    /// Returns the input channels, in the order of the model inputs.
    pub fn inputs(&self) -> &[Channel] {
        &self.header.inputs
    }

    /// Returns the output channels, in the order of the model outputs.
    pub fn outputs(&self) -> &[Channel] {
        &self.header.outputs
    }

    /// Returns the on-axis responses (M1).
    pub fn on_axis(&self) -> &PairTable<bool> {
        &self.header.on_axis
    }

    /// Returns the default band in which models are compared.
    pub fn band(&self) -> Band {
        self.header.band
    }

    /// Returns the named physics model parameters, as declared in the dataset (M18.1). Runs may
    /// move parameters that are not declared.
    pub fn parameters(&self) -> &[PhysicsParameter] {
        &self.header.parameters
    }

    /// Returns the minimum and the maximum airspeed over the conditions \[kt\].
    pub fn airspeed_range_kt(&self) -> (f64, f64) {
        let mut slowest = f64::INFINITY;
        let mut fastest = f64::NEG_INFINITY;
        for condition in &self.conditions {
            let airspeed_kt = condition.flight_state().airspeed_kt;
            slowest = slowest.min(airspeed_kt);
            fastest = fastest.max(airspeed_kt);
        }
        (slowest, fastest)
    }

    /// Returns the conditions, in file order.
    pub fn conditions(&self) -> &[Arc<Condition>] {
        &self.conditions
    }

    /// Returns the condition identifiers, in file order.
    pub fn ids(&self) -> impl Iterator<Item = ConditionId> {
        self.conditions.iter().map(|condition| condition.id())
    }

    /// Returns the conditions without identified models as a reference, in file order.
    pub fn without_reference(&self) -> Vec<ConditionId> {
        self.conditions
            .iter()
            .filter(|condition| !condition.has_reference())
            .map(|condition| condition.id())
            .collect()
    }

    /// Returns the condition with this identifier; `None` if there is none.
    pub fn condition(&self, id: ConditionId) -> Option<&Arc<Condition>> {
        self.conditions
            .iter()
            .find(|condition| condition.id() == id)
    }

    /// Returns a copy in which `condition` replaces the condition with the same identifier; an
    /// unchanged copy if there is none.
    ///
    /// # Errors
    /// [`DatasetError::ModelShape`].
    pub fn with_condition(&self, condition: Condition) -> Result<Self, DatasetError> {
        let shape = (self.header.outputs.len(), self.header.inputs.len());
        check_conditions(std::slice::from_ref(&condition), shape)?;
        let condition = Arc::new(condition);
        let mut dataset = self.clone();
        for place in &mut dataset.conditions {
            if place.id() == condition.id() {
                place.clone_from(&condition);
            }
        }
        Ok(dataset)
    }

    /// Returns whether any identified model is a measured response with coherence.
    pub fn has_coherence(&self) -> bool {
        self.conditions
            .iter()
            .flat_map(|condition| condition.bundle(BundleKind::Identified))
            .any(|model| match &model.dynamics {
                Dynamics::Measured(response) => response.coherence().is_some(),
                Dynamics::StateSpace(_) => false,
            })
    }

    /// Returns the model with this identifier; `None` if there is none.
    pub fn model(&self, id: &ModelId) -> Option<&Model> {
        self.condition(id.condition)?.model(id.bundle, &id.name)
    }

    /// Names a response, input first: "LON → Q".
    pub fn pair_name(&self, pair: Pair) -> String {
        format!(
            "{} → {}",
            self.header.inputs[pair.input].name, self.header.outputs[pair.output].name
        )
    }

    /// Returns all channel names: inputs, then outputs. A single response's names come in the other
    /// order ([`Self::output_and_input_name`]).
    pub fn input_and_output_names(&self) -> (Vec<String>, Vec<String>) {
        (
            channel_names(&self.header.inputs),
            channel_names(&self.header.outputs),
        )
    }

    /// Returns a response's channel names: output, then input.
    pub fn output_and_input_name(&self, pair: Pair) -> (String, String) {
        (
            self.header.outputs[pair.output].name.clone(),
            self.header.inputs[pair.input].name.clone(),
        )
    }

    /// Returns the response from the named input to the named output; `None` if either is missing.
    pub fn find_pair(&self, output: &str, input: &str) -> Option<Pair> {
        Some(Pair {
            output: channel_index(&self.header.outputs, output)?,
            input: channel_index(&self.header.inputs, input)?,
        })
    }

    /// Returns the responses from which distances and bounds are computed: the on-axis responses,
    /// or all responses if none is on-axis (M5, M7).
    pub fn measuring_pairs(&self) -> PairTable<bool> {
        if self.header.on_axis.marked().next().is_some() {
            self.header.on_axis.clone()
        } else {
            PairTable::filled(self.header.outputs.len(), self.header.inputs.len(), true)
        }
    }
}

fn channel_names(channels: &[Channel]) -> Vec<String> {
    channels
        .iter()
        .map(|channel| channel.name.clone())
        .collect()
}

fn channel_index(channels: &[Channel], name: &str) -> Option<usize> {
    channels.iter().position(|channel| channel.name == name)
}

fn check_channels(list: &'static str, channels: &[Channel]) -> Result<(), DatasetError> {
    if channels.is_empty() {
        return Err(DatasetError::Empty(list));
    }
    for (index, channel) in channels.iter().enumerate() {
        if channels[..index]
            .iter()
            .any(|earlier| earlier.name == channel.name)
        {
            return Err(DatasetError::DuplicateChannel {
                list,
                name: channel.name.clone(),
            });
        }
    }
    Ok(())
}

fn check_conditions(
    conditions: &[Condition],
    expected: (usize, usize),
) -> Result<(), DatasetError> {
    if conditions.is_empty() {
        return Err(DatasetError::Empty("conditions"));
    }
    for (second, condition) in conditions.iter().enumerate() {
        let id = condition.id();
        if let Some(first) = conditions[..second]
            .iter()
            .position(|earlier| earlier.id() == id)
        {
            return Err(DatasetError::DuplicateId {
                id,
                first: first + 1,
                second: second + 1,
            });
        }
        let moved = condition.moved_models().iter().map(|moved| &moved.model);
        for model in BundleKind::BOTH
            .into_iter()
            .flat_map(|kind| condition.bundle(kind))
            .chain(moved)
        {
            let found = model.dynamics.shape();
            if found != expected {
                return Err(DatasetError::ModelShape {
                    condition: id,
                    model: model.name.clone(),
                    expected,
                    found,
                });
            }
        }
    }
    Ok(())
}
