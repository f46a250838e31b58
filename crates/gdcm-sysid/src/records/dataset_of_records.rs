//! A dataset for records with new channels, for identification before a physics model exists.

use nalgebra::DMatrix;

use gdcm_model::dataset::condition::{ConditionRecord, FlightState};
use gdcm_model::dataset::dataset::DatasetHeader;
use gdcm_model::dataset::draft_fault::DraftFault;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{
    Band, Channel, Condition, ConditionId, Dataset, Dynamics, Model, PairTable, StateSpace,
};
use gdcm_model::names::channel_rule::ChannelRule;
use gdcm_model::names::on_axis::is_standard_on_axis;

use super::record_channels::RecordChannels;

/// Placeholder for an unknown unit.
const UNKNOWN_UNIT: &str = "?";

/// Creates a dataset with these records in one condition. Its physics model is a placeholder with
/// zero response, `y = 0 u`; analyses have no result until a real model is added.
///
/// The responses that are usually on-axis in a helicopter are marked as such. If the channels have
/// none, each output is on-axis to the input with the same index, counted cyclically.
///
/// # Errors
/// No input or no output, or a duplicate name.
pub fn dataset_of_records(
    name: &str,
    channels: &RecordChannels,
    band: Band,
    records: Vec<ConditionRecord>,
) -> Result<Dataset, DraftFault> {
    let inputs: Vec<Channel> = channels.inputs.iter().map(channel).collect();
    let outputs: Vec<Channel> = channels.outputs.iter().map(channel).collect();
    let placeholder = zero_model(inputs.len(), outputs.len())?;
    let condition = Condition::new(
        FlightState::at(ConditionId(1), 0.0),
        vec![placeholder],
        Vec::new(),
    )?;
    let header = DatasetHeader {
        name: name.to_owned(),
        description: "Created from flight records; a placeholder with zero response replaces the \
            physics model."
            .to_owned(),
        on_axis: on_axis(&inputs, &outputs),
        inputs,
        outputs,
        band,
        parameters: Vec::new(),
    };
    let conditions = vec![condition.with_records(records)?];
    Ok(Dataset::new(header, conditions)?)
}

/// Creates a channel with its rule's unit, or the placeholder for an unknown unit.
fn channel(rule: &ChannelRule) -> Channel {
    let unit = if rule.unit.is_empty() {
        UNKNOWN_UNIT
    } else {
        &rule.unit
    };
    Channel::new(rule.name.clone(), unit)
}

/// Creates the placeholder `y = 0 u`.
fn zero_model(inputs: usize, outputs: usize) -> Result<Model, DraftFault> {
    let dynamics = StateSpace::new(
        -DMatrix::identity(1, 1),
        DMatrix::zeros(1, inputs),
        DMatrix::zeros(outputs, 1),
        DMatrix::zeros(outputs, inputs),
    )?;
    Ok(Model::new(
        "no physics model yet",
        Origin::Nominal { perturbation: None },
        Dynamics::StateSpace(dynamics),
    ))
}

/// Marks a helicopter's usual on-axis responses, or else the diagonal.
fn on_axis(inputs: &[Channel], outputs: &[Channel]) -> PairTable<bool> {
    let standard = PairTable::from_fn(outputs.len(), inputs.len(), |pair| {
        is_standard_on_axis(&outputs[pair.output].name, &inputs[pair.input].name)
    });
    if standard.iter().any(|(_, is_on_axis)| *is_on_axis) {
        return standard;
    }
    PairTable::from_fn(outputs.len(), inputs.len(), |pair| {
        pair.output % inputs.len().max(1) == pair.input
    })
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::{BundleKind, Pair};

    use super::*;

    fn channels(inputs: &[&str], outputs: &[&str]) -> RecordChannels {
        RecordChannels {
            inputs: inputs.iter().copied().map(ChannelRule::named).collect(),
            outputs: outputs.iter().copied().map(ChannelRule::named).collect(),
            ..RecordChannels::default()
        }
    }

    #[test]
    fn a_dataset_of_records_has_a_placeholder_as_physics_model() {
        let mut channels = channels(&["M"], &["q"]);
        channels.outputs[0].unit = "rad/s".into();
        let records = vec![ConditionRecord::new("prbs", "prbs.mat")];
        let band = Band::new(3.0, 25.0).unwrap();
        let dataset = dataset_of_records("quadrotor", &channels, band, records).unwrap();
        let condition = &dataset.conditions()[0];
        assert_eq!(condition.records()[0].file, "prbs.mat");
        assert_eq!(dataset.inputs()[0].unit, "?");
        assert_eq!(dataset.outputs()[0].unit, "rad/s");
        assert!(dataset.on_axis()[Pair::new(0, 0)]);
        assert_eq!(
            condition.bundle(BundleKind::Physics)[0].name,
            "no physics model yet"
        );
        assert!(!condition.has_reference());
    }

    #[test]
    fn responses_are_on_axis_as_in_a_helicopter_if_it_has_such_channels() {
        let channels_of_helicopter = channels(&["LON", "LAT"], &["P", "Q"]);
        let band = Band::new(0.5, 12.0).unwrap();
        let dataset = dataset_of_records("x", &channels_of_helicopter, band, Vec::new()).unwrap();
        let marked: Vec<Pair> = dataset
            .on_axis()
            .iter()
            .filter(|(_, is_on_axis)| **is_on_axis)
            .map(|(pair, _)| pair)
            .collect();
        assert_eq!(marked, [Pair::new(0, 1), Pair::new(1, 0)]);
        let without_inputs = channels(&[], &["P"]);
        assert!(dataset_of_records("x", &without_inputs, dataset.band(), Vec::new()).is_err());
    }
}
