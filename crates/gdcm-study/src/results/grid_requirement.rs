//! Rows of the requirement grid, whose columns are conditions: what is required, the unit of the
//! values, and the limit (M17.5 in `docs/requirements.md`).
//!
//! A value compares the corrected or the physics model with the identified model or, in time, with
//! the held-out records. Values are stored as fractions, seconds, J or level numbers, and displayed
//! in the row's unit:
//!
//! ```text
//! row              stored value                                          unit   limit
//! bandwidth        omega_BW / omega_BW of the identified model - 1       %      Within
//! phase delay      tau_p - tau_p of the identified model [s]             ms     Within
//! level            handling-qualities level of omega_BW and tau_p        -      IdentifiedLevel
//! peak error       max |simulated - flown| / tolerance, over the         %      Tolerance
//!                  condition's held-out records
//! mode frequency   |lambda| / |lambda| of the identified model - 1       %      Mode, or None
//! mean J, on-axis  mean of J over the on-axis responses                  -      AtMost
//! mean J, all      mean of J over all comparable responses               -      None
//! MUAD share       share of the band inside both MUAD envelopes, mean    %      AtLeast
//!                  over the on-axis responses
//! ```
//!
//! `omega_BW` is the bandwidth and `tau_p` the phase delay (M17.1), `lambda` a mode's pole, J the
//! cost (M4); MUAD is the maximum unnoticeable added dynamics (M17.4). `grid_source` computes the
//! values and selects the rows.

use serde::Serialize;

use gdcm_method::requirements::mode_comparison::ModeTolerance;
use gdcm_method::requirements::{ModeName, Tolerance, ToleranceTable};
use gdcm_model::dataset::{Dataset, Pair};

/// Requirement group, in grid order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RequirementGroup {
    /// Bandwidth, phase delay and level.
    Bandwidth,
    /// Peak errors.
    InTime,
    Modes,
    /// Mean J and MUAD share.
    Summary,
}

impl RequirementGroup {
    pub const ALL: [Self; 4] = [Self::Bandwidth, Self::InTime, Self::Modes, Self::Summary];
}

/// A requirement: a grid row. A `Pair` is an on-axis response.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Requirement {
    /// `omega_BW / omega_BW of the identified model - 1`.
    Bandwidth(Pair),
    /// `tau_p - tau_p of the identified model` \[s\].
    PhaseDelay(Pair),
    /// Handling-qualities level of bandwidth and phase delay, from the level boundaries in the
    /// settings.
    Level(Pair),
    /// `max |simulated - flown| / tolerance` over the condition's held-out records; the index is
    /// the row in the tolerance table.
    PeakError(usize),
    /// `|lambda| / |lambda| of the identified model - 1`.
    ModeFrequency(ModeName),
    /// Mean J over the on-axis responses.
    MeanJOnAxis,
    /// Mean J over all responses that can be compared; it has no limit.
    MeanJAll,
    /// Share of the band, 0 to 1, inside the envelopes of maximum unnoticeable added dynamics
    /// (MUAD): the mean over the on-axis responses.
    MuadShareOnAxis,
}

/// Unit in which a requirement's values are displayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequirementUnit {
    /// The stored value is a fraction.
    Percent,
    /// The stored value is in seconds.
    Milliseconds,
    /// Mean J, which has no unit.
    Cost,
    /// Number of a handling-qualities level.
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

    /// Returns the response that a requirement concerns: for a peak error, the first on-axis
    /// response of its output; `None` for modes and summary values, and if the dataset has no such
    /// output. If no response is on-axis, all are searched ([`Dataset::measuring_pairs`]).
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
    /// Maximum magnitude, in the unit in which the values are stored: bandwidth, phase delay.
    Within(f64),
    /// Greatest value that is met: for the mean J over the on-axis responses.
    AtMost(f64),
    /// Least value that is met: for the MUAD share.
    AtLeast(f64),
    /// The identified model's level, which the model must have.
    IdentifiedLevel,
    /// Tolerance for a time history; the values are multiples of it, and met up to 1.
    Tolerance(Tolerance),
    /// Tolerances for a mode: the period, and the time to half amplitude or the damping ratio.
    Mode(ModeTolerance),
    /// No limit: mean J over all responses, and modes without a tolerance.
    None,
}
