//! Reasons for a missing schedule.

use super::second_variable::SecondVariable;

/// Reason why there is no schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScheduleError {
    /// No condition was chosen, or no chosen condition has a correction.
    #[error("no schedule: none of the conditions in the schedule has a correction")]
    NoCondition,
    #[error(
        "no schedule with {0}: the {0} of a condition in the schedule is not given; enter the {0}, or schedule without it"
    )]
    NoSecondValue(SecondVariable),
    /// In these conditions the second variable is constant, or a linear combination of the
    /// schedule's airspeed columns.
    #[error(
        "no schedule with {0}: the effect of {0} cannot be separated from the effect of airspeed in \
        these conditions; schedule without {0}, or add conditions"
    )]
    NotToldApart(SecondVariable),
}

impl ScheduleError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoCondition => "no-condition-to-schedule",
            Self::NoSecondValue(..) => "no-second-value",
            Self::NotToldApart(..) => "too-few-distinct-values",
        }
    }
}
