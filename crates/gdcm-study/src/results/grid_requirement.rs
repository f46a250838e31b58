//! Requirements as grid rows: groups, units and limits (M17.5).

use serde::Serialize;

use gdcm_method::requirements::mode_comparison::ModeTolerance;
use gdcm_method::requirements::{ModeName, Tolerance, ToleranceTable};
use gdcm_model::dataset::{Dataset, Pair};

/// Requirement group, in grid order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RequirementGroup {
    Bandwidth,
    InTime,
    Modes,
    Summary,
}

impl RequirementGroup {
    pub const ALL: [Self; 4] = [Self::Bandwidth, Self::InTime, Self::Modes, Self::Summary];
}

/// A requirement: a grid row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Requirement {
    Bandwidth(Pair),
    PhaseDelay(Pair),
    /// Level for bandwidth and phase delay, from the level boundaries in the settings.
    Level(Pair),
    /// Peak error in time; the index is its row in the tolerance table.
    PeakError(usize),
    ModeFrequency(ModeName),
    MeanJOnAxis,
    MeanJAll,
    MuadShareOnAxis,
}

/// Unit in which a requirement's values are displayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequirementUnit {
    /// The stored value is a fraction.
    Percent,
    /// The stored value is in seconds.
    Milliseconds,
    /// The value is a cost without unit.
    Cost,
    /// The value is a level number.
    Level,
}

impl Requirement {
    /// Returns the row group to which the requirement belongs.
    pub fn group(self) -> RequirementGroup {
        match self {
            Self::Bandwidth(_) | Self::PhaseDelay(_) | Self::Level(_) => {
                RequirementGroup::Bandwidth
            }
            Self::PeakError(_) => RequirementGroup::InTime,
            Self::ModeFrequency(_) => RequirementGroup::Modes,
            Self::MeanJOnAxis | Self::MeanJAll | Self::MuadShareOnAxis => RequirementGroup::Summary,
        }
    }

    /// Returns the unit for its cells and its limit.
    pub fn unit(self) -> RequirementUnit {
        match self {
            Self::PhaseDelay(_) => RequirementUnit::Milliseconds,
            Self::Level(_) => RequirementUnit::Level,
            Self::MeanJOnAxis | Self::MeanJAll => RequirementUnit::Cost,
            Self::Bandwidth(_)
            | Self::PeakError(_)
            | Self::ModeFrequency(_)
            | Self::MuadShareOnAxis => RequirementUnit::Percent,
        }
    }

    /// Returns the quantity's stable code, for files and tests.
    pub fn code(self) -> &'static str {
        match self {
            Self::Bandwidth(_) => "bandwidth",
            Self::PhaseDelay(_) => "phase-delay",
            Self::Level(_) => "level",
            Self::PeakError(_) => "peak-error",
            Self::ModeFrequency(_) => "mode-frequency",
            Self::MeanJOnAxis => "mean-j-on-axis",
            Self::MeanJAll => "mean-j-all",
            Self::MuadShareOnAxis => "muad-share-on-axis",
        }
    }

    /// Returns the response that a requirement concerns: for a peak error, its output's on-axis
    /// response; `None` for modes and summary values, and if the dataset has no such output.
    pub fn pair(self, dataset: &Dataset, tolerances: &ToleranceTable) -> Option<Pair> {
        match self {
            Self::Bandwidth(pair) | Self::PhaseDelay(pair) | Self::Level(pair) => Some(pair),
            Self::PeakError(row) => {
                let channel = &tolerances.rows().get(row)?.channel;
                let outputs = dataset.outputs();
                let output = outputs.iter().position(|output| output.name == *channel)?;
                let pairs = dataset.measuring_pairs();
                pairs.marked().find(|pair| pair.output == output)
            }
            Self::ModeFrequency(_) | Self::MeanJOnAxis | Self::MeanJAll | Self::MuadShareOnAxis => {
                None
            }
        }
    }
}

/// Limit for the values in a row.
#[derive(Clone, Debug, PartialEq)]
pub enum RequirementLimit {
    /// Maximum magnitude, in the unit in which the values are stored.
    Within(f64),
    AtMost(f64),
    AtLeast(f64),
    /// The identified model's level.
    IdentifiedLevel,
    /// Tolerance for a time history; the values are multiples of it, and met up to 1.
    Tolerance(Tolerance),
    /// Tolerances for a mode: the period, and the time to half amplitude or the damping ratio.
    Mode(ModeTolerance),
    None,
}
