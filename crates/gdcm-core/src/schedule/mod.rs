//! One correction for all airspeeds, what speaks for it, and what it is worth (M11, M12).

mod assessment;
mod basis;
mod coefficients;
mod evidence;
mod lead_evidence;
mod lead_schedule;
mod regression;
#[expect(clippy::module_inception, reason = "the folder is named for its noun, and so is the file that holds it")]
mod schedule;
mod second_variable;

pub use assessment::{CostChange, assess, corrected_cost};
pub use basis::airspeed_indicators;
pub use coefficients::{CoefficientRow, CoefficientTable};
pub use evidence::{Evidence, FitEvidence, KindEvidence, Residual, SCHEDULE_KINDS, evidence};
pub use lead_evidence::{LeadEvidence, LeadFit, lead_evidence};
pub use lead_schedule::LeadSchedule;
pub use regression::{Airspeeds, Regression};
pub use schedule::{
    DEFAULT_TOLERANCE_KT, DelaySchedule, HIGHEST_DEGREE, Schedule, ScheduleCaution, ScheduleError, ScheduleKind,
    ScheduleSettings, ScheduledPoint, ScheduledQuantity,
};
pub use second_variable::{SecondTerm, SecondVariable};
