//! Settings for the qualification requirements (M17), on which no correction depends. The
//! requirement grid compares every condition with every requirement (M17.5); MUAD is maximum
//! unnoticeable added dynamics, a pair of envelopes about flight (M17.4).

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use gdcm_method::requirements::bandwidth::CommandType;
use gdcm_method::requirements::{LevelBoundaries, ModeToleranceTable, TestInput, ToleranceTable};
use gdcm_model::dataset::Dataset;
use gdcm_model::units::number;

use super::settings::is_default;

/// Requirement settings; a part that is missing in a file has its default value.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RequirementSettings {
    /// Outputs with attitude command, by name; all other outputs have rate command.
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    pub attitude_command: BTreeSet<String>,
    #[serde(skip_serializing_if = "is_default")]
    pub levels: LevelBoundaries,
    /// Tolerances on simulated time histories, relative to the measured ones.
    #[serde(skip_serializing_if = "is_default")]
    pub tolerances: ToleranceTable,
    /// Tolerances on the physics models' modes, relative to the identified modes.
    #[serde(skip_serializing_if = "is_default")]
    pub mode_tolerances: ModeToleranceTable,
    /// Limits in the requirement grid that no tolerance table contains.
    #[serde(skip_serializing_if = "is_default")]
    pub overview: OverviewLimits,
    /// Test input for displayed responses where no flight record is displayed.
    #[serde(skip_serializing_if = "is_default")]
    pub test: TestInput,
}

/// Limits on the difference between a corrected and the identified model in the requirement grid,
/// the overview of all requirements. They do not come from a standard; the engineer can change
/// them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OverviewLimits {
    /// Maximum relative difference in bandwidth between the corrected and the identified model.
    pub bandwidth: f64,
    /// Maximum difference in phase delay between the corrected and the identified model \[s\].
    pub phase_delay_s: f64,
    /// Maximum mean J over the on-axis responses; J is the cost of a mismatch (M4).
    pub mean_j: f64,
    /// Minimum share of the band inside the MUAD envelopes over the on-axis responses, 0 to 1.
    pub muad_share: f64,
}

impl Default for OverviewLimits {
    fn default() -> Self {
        Self {
            bandwidth: 0.1,
            phase_delay_s: 0.02,
            mean_j: 10.0,
            muad_share: 0.9,
        }
    }
}

/// Error for a limit in the grid that is not positive.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("limits of the requirements: expected {name} above zero, found {}", number(*found))]
pub struct OverviewLimitsError {
    pub name: &'static str,
    pub found: f64,
}

impl OverviewLimits {
    /// Checks the limits and returns them.
    ///
    /// # Errors
    /// [`OverviewLimitsError`] where a limit is not a positive number.
    pub fn checked(self) -> Result<Self, OverviewLimitsError> {
        let Self {
            bandwidth,
            phase_delay_s,
            mean_j,
            muad_share,
        } = self;
        let limits = [
            ("bandwidth", bandwidth),
            ("phase_delay_s", phase_delay_s),
            ("mean_j", mean_j),
            ("muad_share", muad_share),
        ];
        match limits
            .into_iter()
            .find(|(_, value)| !value.is_finite() || *value <= 0.0)
        {
            Some((name, found)) => Err(OverviewLimitsError { name, found }),
            None => Ok(self),
        }
    }
}

impl RequirementSettings {
    /// Returns the command type of an axis; `output` names its output.
    pub fn command_of(&self, output: &str) -> CommandType {
        if self.attitude_command.contains(output) {
            CommandType::Attitude
        } else {
            CommandType::Rate
        }
    }

    /// Returns the settings for outputs that the dataset does not have.
    pub fn without_channel(&self, dataset: &Dataset) -> Vec<OutputRequirement> {
        let (_, outputs) = dataset.input_and_output_names();
        let mut unknown = Vec::new();
        for name in &self.attitude_command {
            if !outputs.contains(name) {
                unknown.push(OutputRequirement::AttitudeCommand(name.clone()));
            }
        }
        for name in self.levels.unknown_axes(&outputs) {
            unknown.push(OutputRequirement::Levels(name.to_owned()));
        }
        unknown
    }
}

/// A requirement setting for one output, with the output's name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OutputRequirement {
    AttitudeCommand(String),
    Levels(String),
}

/// The part of the requirement settings that a decision changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequirementPart {
    AttitudeCommand,
    Levels,
    Tolerances,
    ModeTolerances,
    OverviewLimits,
    TestShape,
    TestSize,
    TestDuration,
    /// Everything that command-line options set.
    Options,
}

#[cfg(test)]
mod tests {
    use gdcm_method::requirements::{TestInputShape, Tolerance};

    use super::*;

    #[test]
    fn what_was_not_decided_is_not_written_and_what_was_comes_back() {
        assert_eq!(
            serde_json::to_string(&RequirementSettings::default()).unwrap(),
            "{}"
        );
        let row = Tolerance {
            absolute: 4.0,
            ..ToleranceTable::default().rows()[0].clone()
        };
        let settings = RequirementSettings {
            attitude_command: BTreeSet::from(["Q".to_owned()]),
            tolerances: ToleranceTable::new("our own", vec![row]).unwrap(),
            overview: OverviewLimits {
                bandwidth: 0.15,
                ..OverviewLimits::default()
            },
            test: TestInput {
                shape: TestInputShape::Doublet,
                ..TestInput::default()
            },
            ..RequirementSettings::default()
        };
        let text = serde_json::to_string(&settings).unwrap();
        assert_eq!(
            serde_json::from_str::<RequirementSettings>(&text).unwrap(),
            settings,
            "{text}"
        );
        assert_eq!(
            (settings.command_of("Q"), settings.command_of("P")),
            (CommandType::Attitude, CommandType::Rate)
        );
    }
}
