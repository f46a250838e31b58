//! The channels to read from records: from a dataset or a user's list, and a new dataset for such
//! channels.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use nalgebra::DMatrix;

use gdcm_model::dataset::condition::{ConditionRecord, FlightState};
use gdcm_model::dataset::dataset::DatasetHeader;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::unchecked_dataset::DraftFault;
use gdcm_model::dataset::{
    Band, Channel, Condition, ConditionId, Dataset, Dynamics, Model, PairTable, StateSpace,
};
use gdcm_model::names::ChannelRule;
use gdcm_model::names::on_axis::is_standard_on_axis;

use super::record_layout::RecordLayout;
use super::record_table::RecordTable;
use super::resampling::ResamplingWish;

/// User-defined conversion of a channel's samples; overrides the file.
#[derive(Clone, Debug, PartialEq)]
pub enum SaidConversion {
    /// Unit of the samples.
    Unit(String),
    /// Channel units per column unit; negative for the opposite sign.
    Factor(f64),
}

/// Inputs and outputs to read from records. A channel without a unit takes the unit of the file; a
/// channel with aliases is searched only by its aliases.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordChannels {
    /// Inputs, in order.
    pub inputs: Vec<ChannelRule>,
    /// Outputs, in order.
    pub outputs: Vec<ChannelRule>,
    /// User-defined conversions by channel.
    pub said: BTreeMap<String, SaidConversion>,
    /// Combination of topics with separate clocks into one record.
    pub resampling: ResamplingWish,
}

impl RecordChannels {
    /// Returns the channels of a dataset, in its units.
    pub fn of_dataset(dataset: &Dataset) -> Self {
        let rule = |channel: &Channel| ChannelRule {
            unit: channel.unit.clone(),
            ..ChannelRule::named(channel.name.clone())
        };
        Self {
            inputs: dataset.inputs().iter().map(rule).collect(),
            outputs: dataset.outputs().iter().map(rule).collect(),
            said: BTreeMap::new(),
            resampling: ResamplingWish {
                band_end: Some(dataset.band().max()),
                ..ResamplingWish::default()
            },
        }
    }

    /// Returns the channels for records named by the dataset: in its units if their files give
    /// none, with their remedies applied.
    #[must_use]
    pub fn of_named_records(mut self) -> Self {
        for rule in self.inputs.iter_mut().chain(&mut self.outputs) {
            rule.unit_in_files = Some(rule.unit.clone());
        }
        self
    }

    /// Gives channels without a unit the unit of their column in this layout, so that further
    /// records are converted.
    pub fn take_units(&mut self, layout: &RecordLayout, table: &RecordTable) {
        let sides = [
            (&mut self.inputs, &layout.inputs),
            (&mut self.outputs, &layout.outputs),
        ];
        for (rules, uses) in sides {
            for (rule, used) in rules
                .iter_mut()
                .zip(uses)
                .filter(|(rule, _)| rule.unit.is_empty())
            {
                let of_file = || used.and_then(|used| table.columns.get(used.column)?.unit.clone());
                let unit = match self.said.get(&rule.name) {
                    Some(SaidConversion::Unit(unit)) => Some(unit.clone()),
                    // The unit of the product is unknown.
                    Some(SaidConversion::Factor(factor)) if factor.abs() != 1.0 => None,
                    _ => of_file(),
                };
                rule.unit = unit.unwrap_or_default();
            }
        }
    }
}

// Channels as written in one line: "LON, Q [deg/s]=pitch_rate".

/// Channels by name, each with an optional unit and column.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelList {
    /// The channels, in order.
    pub channels: Vec<SaidChannel>,
}

/// A channel as written in a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SaidChannel {
    pub name: String,
    /// The unit; empty if not given.
    pub unit: String,
    /// The column: its name, `TOPIC.FIELD`, or `#3` for the third.
    pub column: Option<String>,
}

/// Reasons why a text is not a list of channels.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChannelListError {
    /// A part of the text is not a channel.
    #[error("expected CHANNEL or CHANNEL=COLUMN, as P or P [deg/s]=roll_rate, found \"{0}\"")]
    NoChannel(String),
    /// Duplicate channel.
    #[error("{0} stands twice")]
    Twice(String),
}

impl SaidChannel {
    /// Returns the rule for the column and unit of the channel.
    pub fn rule(&self) -> ChannelRule {
        ChannelRule {
            unit: self.unit.clone(),
            unit_in_files: Some(self.unit.clone()).filter(|unit| !unit.is_empty()),
            aliases: self.column.iter().cloned().collect(),
            ..ChannelRule::named(self.name.clone())
        }
    }
}

impl FromStr for SaidChannel {
    type Err = ChannelListError;

    fn from_str(text: &str) -> Result<Self, ChannelListError> {
        let (name, column) = match text.split_once('=') {
            Some((name, column)) => (name.trim(), Some(column.trim().trim_matches('"'))),
            None => (text.trim(), None),
        };
        // `xyz[0]` is an index.
        let is_index = |unit: &str| unit.bytes().all(|byte| byte.is_ascii_digit());
        let bracket = name
            .strip_suffix(']')
            .and_then(|rest| rest.rsplit_once('['))
            .filter(|(_, unit)| !is_index(unit));
        let (name, unit) = bracket.map_or((name, ""), |(name, unit)| (name.trim(), unit.trim()));
        if name.is_empty() || column.is_some_and(str::is_empty) {
            return Err(ChannelListError::NoChannel(text.to_owned()));
        }
        Ok(Self {
            name: name.to_owned(),
            unit: unit.to_owned(),
            column: column.map(str::to_owned),
        })
    }
}

impl FromStr for ChannelList {
    type Err = ChannelListError;

    fn from_str(text: &str) -> Result<Self, ChannelListError> {
        let channels: Vec<SaidChannel> = split_outside_quotes(text)
            .into_iter()
            .map(str::parse)
            .collect::<Result<_, _>>()?;
        let is_again = |at: &usize| {
            channels[..*at]
                .iter()
                .any(|other| other.name == channels[*at].name)
        };
        match (0..channels.len()).find(is_again) {
            Some(at) => Err(ChannelListError::Twice(channels[at].name.clone())),
            None => Ok(Self { channels }),
        }
    }
}

impl fmt::Display for ChannelList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, SaidChannel { name, unit, column }) in self.channels.iter().enumerate() {
            f.write_str(if at == 0 { "" } else { ", " })?;
            f.write_str(name)?;
            if !unit.is_empty() {
                write!(f, " [{unit}]")?;
            }
            match column {
                Some(column) if column.contains(',') => write!(f, "=\"{column}\"")?,
                Some(column) => write!(f, "={column}")?,
                None => {}
            }
        }
        Ok(())
    }
}

/// Splits a list at the commas outside quotation marks.
fn split_outside_quotes(text: &str) -> Vec<&str> {
    let mut quoted = false;
    let is_comma = |c: char| {
        quoted ^= c == '"';
        c == ',' && !quoted
    };
    text.split(is_comma).collect()
}

// A dataset for records with new channels: models are identified from them before a physics model
// exists.

/// Placeholder for an unknown unit.
pub const UNSAID_UNIT: &str = "?";

/// Creates a dataset of one condition with these records and without models: a placeholder with
/// zero response, `y = 0 u`, is its physics model until a real one is added; no analysis has a
/// result before that.
///
/// The usual responses of a helicopter are marked as on-axis for the channels found, otherwise each
/// output to the input with the same index.
///
/// # Errors
/// No input or no output, or a duplicate name.
pub fn dataset_of_records(
    name: &str,
    channels: &RecordChannels,
    band: Band,
    records: Vec<ConditionRecord>,
) -> Result<Dataset, DraftFault> {
    let channel = |rule: &ChannelRule| {
        let unit = if rule.unit.is_empty() {
            UNSAID_UNIT
        } else {
            &rule.unit
        };
        Channel::new(rule.name.clone(), unit)
    };
    let (inputs, outputs): (Vec<Channel>, Vec<Channel>) = (
        channels.inputs.iter().map(channel).collect(),
        channels.outputs.iter().map(channel).collect(),
    );
    let on_axis = on_axis(&inputs, &outputs);
    let rows = outputs.len();
    let columns = inputs.len();
    let zeros = DMatrix::zeros;
    let silent = StateSpace::new(
        -DMatrix::identity(1, 1),
        zeros(1, columns),
        zeros(rows, 1),
        zeros(rows, columns),
    )?;
    let origin = Origin::Nominal { perturbation: None };
    let physics = Model::new("no physics model yet", origin, Dynamics::StateSpace(silent));
    let condition = Condition::new(
        FlightState::at(ConditionId(1), 0.0),
        vec![physics],
        Vec::new(),
    )?;
    let header = DatasetHeader {
        name: name.to_owned(),
        description: "Made of flight records; a model that answers nothing stands for the physics model to come."
            .to_owned(),
        inputs,
        outputs,
        on_axis,
        band,
    };
    Ok(Dataset::new(
        header,
        vec![condition.with_records(records)?],
    )?)
}

fn on_axis(inputs: &[Channel], outputs: &[Channel]) -> PairTable<bool> {
    let known = |output: &Channel, input: &Channel| is_standard_on_axis(&output.name, &input.name);
    let any = outputs
        .iter()
        .any(|output| inputs.iter().any(|input| known(output, input)));
    PairTable::from_fn(outputs.len(), inputs.len(), |pair| match any {
        true => known(&outputs[pair.output], &inputs[pair.input]),
        false => pair.output % inputs.len().max(1) == pair.input,
    })
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::{BundleKind, Pair};

    use super::*;

    fn list(text: &str) -> Result<ChannelList, ChannelListError> {
        text.parse()
    }

    #[test]
    fn channels_may_say_their_columns_and_their_units() {
        let said = list("LON, P=roll rate,LAT=\"elev, yoke\",Q [deg/s]=#30,xyz[0]").unwrap();
        let channel = |name: &str, unit: &str, column: Option<&str>| SaidChannel {
            name: name.into(),
            unit: unit.into(),
            column: column.map(Into::into),
        };
        let expected = [
            channel("LON", "", None),
            channel("P", "", Some("roll rate")),
            channel("LAT", "", Some("elev, yoke")),
            channel("Q", "deg/s", Some("#30")),
            channel("xyz[0]", "", None),
        ];
        assert_eq!(said.channels, expected);
        assert_eq!(
            list(&said.to_string()),
            Ok(said),
            "it is read as it is written"
        );
    }

    #[test]
    fn what_is_no_channel_is_refused() {
        assert!(
            list("").is_err()
                && list("P=").is_err()
                && list("P,,Q").is_err()
                && list("[deg/s]").is_err()
        );
        assert_eq!(list("P,Q,P").unwrap_err().to_string(), "P stands twice");
    }

    fn channels(inputs: &[&str], outputs: &[&str]) -> RecordChannels {
        let rules = |names: &[&str]| names.iter().map(|name| ChannelRule::named(*name)).collect();
        RecordChannels {
            inputs: rules(inputs),
            outputs: rules(outputs),
            ..RecordChannels::default()
        }
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
        assert_eq!(
            (
                dataset.inputs()[0].unit.as_str(),
                dataset.outputs()[0].unit.as_str()
            ),
            ("?", "rad/s")
        );
        assert!(dataset.on_axis()[Pair::new(0, 0)]);
        assert_eq!(
            condition.bundle(BundleKind::Physics)[0].name,
            "no physics model yet"
        );
        assert!(!condition.has_reference());
    }

    #[test]
    fn the_responses_that_matter_are_those_of_a_helicopter_where_there_are_such_channels() {
        let of = channels(&["LON", "LAT"], &["P", "Q"]);
        let dataset =
            dataset_of_records("x", &of, Band::new(0.5, 12.0).unwrap(), Vec::new()).unwrap();
        let marked: Vec<Pair> = dataset
            .on_axis()
            .iter()
            .filter(|(_, on)| **on)
            .map(|(pair, _)| pair)
            .collect();
        assert_eq!(marked, [Pair::new(0, 1), Pair::new(1, 0)]);
        assert!(
            dataset_of_records("x", &channels(&[], &["P"]), dataset.band(), Vec::new()).is_err()
        );
    }
}
