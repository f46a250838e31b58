//! A dataset for records of channels that no dataset has yet: models are identified from them before there is a physics model.

use nalgebra::DMatrix;

use super::RecordChannels;
use crate::assembly::{ChannelRule, standard_on_axis};
use crate::dataset::{
    Band, BundleKind, Channel, Condition, ConditionError, ConditionId, ConditionRecord, Dataset, DatasetError,
    DatasetHeader, Dynamics, FlightState, Model, Origin, PairTable, StateSpace, StateSpaceError,
};

/// What stands for a unit that nobody says.
pub const UNSAID_UNIT: &str = "?";

/// Why records do not make a dataset.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordDatasetError {
    /// The channels, or the conditions.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
    /// The records, or the models that stand for those to come.
    #[error(transparent)]
    Condition(#[from] ConditionError),
    /// A model that stands for one to come.
    #[error(transparent)]
    Model(#[from] StateSpaceError),
}

/// A dataset of one condition with these records and without models: one that answers nothing, `y = 0 u`, stands in each bundle until
/// there is another, and no analysis has a result before.
///
/// The responses that matter are those of a helicopter as far as there are such channels, and else every output to the input of its
/// place.
///
/// # Errors
/// [`RecordDatasetError`]: no input or no output, a name that stands twice.
pub fn dataset_of_records(
    name: &str,
    channels: &RecordChannels,
    band: Band,
    records: Vec<ConditionRecord>,
) -> Result<Dataset, RecordDatasetError> {
    let channel = |rule: &ChannelRule| {
        let unit = if rule.unit.is_empty() { UNSAID_UNIT } else { &rule.unit };
        Channel::new(rule.name.clone(), unit)
    };
    let (inputs, outputs): (Vec<Channel>, Vec<Channel>) =
        (channels.inputs.iter().map(channel).collect(), channels.outputs.iter().map(channel).collect());
    let on_axis = on_axis(&inputs, &outputs);
    let none_yet = |kind: BundleKind, origin| -> Result<Model, StateSpaceError> {
        let (rows, columns) = (outputs.len(), inputs.len());
        let zeros = DMatrix::zeros;
        let silent =
            StateSpace::new(-DMatrix::identity(1, 1), zeros(1, columns), zeros(rows, 1), zeros(rows, columns))?;
        Ok(Model::new(format!("no {kind} model yet"), origin, Dynamics::StateSpace(silent)))
    };
    let physics = none_yet(BundleKind::Physics, Origin::Nominal { perturbation: None })?;
    let identified = none_yet(BundleKind::Identified, Origin::Identified { method: None, order: None })?;
    let condition = Condition::new(FlightState::at(ConditionId(1), 0.0), vec![physics], vec![identified])?;
    let header = DatasetHeader {
        name: name.to_owned(),
        description: "Made of flight records; models that answer nothing stand for those to come.".to_owned(),
        inputs,
        outputs,
        on_axis,
        band,
    };
    Ok(Dataset::new(header, vec![condition.with_records(records)?])?)
}

fn on_axis(inputs: &[Channel], outputs: &[Channel]) -> PairTable<bool> {
    let known = |output: &Channel, input: &Channel| standard_on_axis(&output.name, &input.name);
    let any = outputs.iter().any(|output| inputs.iter().any(|input| known(output, input)));
    PairTable::from_fn(outputs.len(), inputs.len(), |pair| match any {
        true => known(&outputs[pair.output], &inputs[pair.input]),
        false => pair.output % inputs.len().max(1) == pair.input,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Pair;

    fn channels(inputs: &[&str], outputs: &[&str]) -> RecordChannels {
        let rules = |names: &[&str]| names.iter().map(|name| ChannelRule::named(*name)).collect();
        RecordChannels { inputs: rules(inputs), outputs: rules(outputs), ..RecordChannels::default() }
    }

    #[test]
    fn records_make_a_dataset_that_says_that_it_has_no_model_yet() {
        let mut of = channels(&["M"], &["q"]);
        of.outputs[0].unit = "rad/s".into();
        let records = vec![ConditionRecord::new("prbs", "prbs.mat")];
        let band = Band::new(3.0, 25.0).unwrap();
        let dataset = dataset_of_records("quadrotor", &of, band, records).unwrap();
        let condition = &dataset.conditions()[0];
        assert_eq!(condition.records()[0].file, "prbs.mat");
        assert_eq!((dataset.inputs()[0].unit.as_str(), dataset.outputs()[0].unit.as_str()), ("?", "rad/s"));
        assert!(dataset.on_axis()[Pair::new(0, 0)]);
        assert_eq!(condition.bundle(BundleKind::Physics)[0].name, "no physics model yet");
    }

    #[test]
    fn the_responses_that_matter_are_those_of_a_helicopter_where_there_are_such_channels() {
        let of = channels(&["LON", "LAT"], &["P", "Q"]);
        let dataset = dataset_of_records("x", &of, Band::new(0.5, 12.0).unwrap(), Vec::new()).unwrap();
        let marked: Vec<Pair> = dataset.on_axis().iter().filter(|(_, on)| **on).map(|(pair, _)| pair).collect();
        assert_eq!(marked, [Pair::new(0, 1), Pair::new(1, 0)]);
        assert!(dataset_of_records("x", &channels(&[], &["P"]), dataset.band(), Vec::new()).is_err());
    }
}
