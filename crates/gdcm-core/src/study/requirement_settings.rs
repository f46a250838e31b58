//! What requirements are asked with: decisions that no correction depends on (M17).

use std::collections::BTreeSet;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Analysis;
use crate::dataset::Dataset;
use crate::requirements::{CommandType, LevelBoundaries, ModeToleranceTable, TestInput, ToleranceTable};
use crate::units::number;

/// What requirements are asked with; a part that is left out is the default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RequirementSettings {
    /// Names of the outputs whose attitude the stick commands; of all others it commands the rate.
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    pub attitude_command: BTreeSet<String>,
    /// Boundaries of levels over bandwidth and phase delay.
    #[serde(skip_serializing_if = "is_default")]
    pub levels: LevelBoundaries,
    /// How far a time history may be from the flown one.
    #[serde(skip_serializing_if = "is_default")]
    pub tolerances: ToleranceTable,
    /// How far a mode may be from the flown one.
    #[serde(skip_serializing_if = "is_default")]
    pub mode_tolerances: ModeToleranceTable,
    /// From where on the overview says that a corrected model is far from the identified one.
    #[serde(skip_serializing_if = "is_default")]
    pub overview: OverviewLimits,
    /// What the models answer to where no flight record is shown.
    #[serde(skip_serializing_if = "is_default")]
    pub test: TestInput,
}

/// From where on the overview of the corrected models says that one is far from the identified one: limits of the program, of no standard.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OverviewLimits {
    /// Difference of the bandwidth, as a part of the identified one.
    pub bandwidth: f64,
    /// Difference of the phase delay \[s\].
    pub phase_delay_s: f64,
    /// Least share of time inside a tolerance, 0 to 1.
    pub share_inside: f64,
}

impl Default for OverviewLimits {
    fn default() -> Self {
        Self { bandwidth: 0.1, phase_delay_s: 0.02, share_inside: 0.9 }
    }
}

/// A limit of the overview that is not above zero.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("limits of the overview: expected {name} above zero, found {}", number(*found))]
pub struct OverviewLimitsError {
    /// Which.
    pub name: &'static str,
    /// What stands there.
    pub found: f64,
}

impl OverviewLimits {
    /// The same, checked.
    ///
    /// # Errors
    /// [`OverviewLimitsError`] where one is not a number above zero.
    pub fn checked(self) -> Result<Self, OverviewLimitsError> {
        let Self { bandwidth, phase_delay_s, share_inside } = self;
        let limits = [("bandwidth", bandwidth), ("phase_delay_s", phase_delay_s), ("share_inside", share_inside)];
        match limits.into_iter().find(|(_, value)| !value.is_finite() || *value <= 0.0) {
            Some((name, found)) => Err(OverviewLimitsError { name, found }),
            None => Ok(self),
        }
    }
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Analysis {
    /// The same analysis, of which requirements are asked with other settings.
    pub fn asked_with(&self, settings: &Arc<RequirementSettings>) -> Self {
        let mut analysis = self.clone();
        analysis.study.requirements = Arc::clone(settings);
        analysis
    }
}

impl RequirementSettings {
    /// How an axis answers to its stick, by the name of its output.
    pub fn command_of(&self, output: &str) -> CommandType {
        if self.attitude_command.contains(output) { CommandType::Attitude } else { CommandType::Rate }
    }

    /// What names outputs that the dataset does not have, in words.
    pub fn without_channel(&self, dataset: &Dataset) -> Vec<String> {
        let (_, outputs) = dataset.names_of_channels();
        let unknown = |name: &&String| !outputs.contains(name);
        let commands = self.attitude_command.iter().filter(unknown);
        let commands = commands.map(|name| format!("attitude command of {name}: the dataset has no such output"));
        let levels = self.levels.unknown_axes(&outputs).into_iter();
        commands.chain(levels.map(|name| format!("levels of {name}: the dataset has no such output"))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::requirements::{TestInputShape, Tolerance};

    #[test]
    fn what_was_not_decided_is_not_written_and_what_was_comes_back() {
        assert_eq!(serde_json::to_string(&RequirementSettings::default()).unwrap(), "{}");
        let row = Tolerance { absolute: 4.0, ..ToleranceTable::default().rows()[0].clone() };
        let settings = RequirementSettings {
            attitude_command: BTreeSet::from(["Q".to_owned()]),
            tolerances: ToleranceTable::new("our own", vec![row]).unwrap(),
            overview: OverviewLimits { bandwidth: 0.15, ..OverviewLimits::default() },
            test: TestInput { shape: TestInputShape::Doublet, ..TestInput::default() },
            ..RequirementSettings::default()
        };
        let text = serde_json::to_string(&settings).unwrap();
        assert_eq!(serde_json::from_str::<RequirementSettings>(&text).unwrap(), settings, "{text}");
        assert_eq!((settings.command_of("Q"), settings.command_of("P")), (CommandType::Attitude, CommandType::Rate));
    }
}
