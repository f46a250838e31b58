//! Reasons for a missing schedule.

use super::second_variable::SecondVariable;

/// Reason why there is no schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScheduleError {
    /// No condition was chosen, or no chosen condition has a correction.
    #[error("no schedule: none of the conditions chosen for it has a correction")]
    NoCondition,
    #[error("no schedule with {0}: a condition chosen for it has no {0}")]
    NoSecondValue(SecondVariable),
    /// In these conditions the second variable is constant, or a linear combination of the
    /// schedule's airspeed columns.
    #[error(
        "no schedule with {0}: its effect cannot be separated from the effect of airspeed in \
        these conditions"
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
