//! A correction for all airspeeds, signed delays included, its assessment, and its benefit (M11, M12,
//! M15.5).
//!
//! | file | content |
//! |---|---|
//! | `settings`, `delay_scheduling` | form, degree, regressed quantity; whether delays are scheduled |
//! | `airspeeds`, `regression` | clusters of airspeeds; polynomial and lookup table |
//! | `second_variable`, `second_term` | altitude or mass besides airspeed, and its contribution |
//! | `scheduled_point`, `channel_schedule`, `delay_schedule`, `lead_schedule` | fit and evaluation |
//! | `interpolation_check`, `caution` | checks between the conditions |
//! | `form_comparison`, `predictions` | residuals and leave-one-condition-out errors by form |
//! | `lead_degree_comparison` | the same for the signed delays by degree |
//! | `assessment` | J before and after a correction |
//! | `coefficient_table` | coefficients with channel names |

pub mod airspeeds;
pub mod assessment;
pub mod caution;
mod channel_schedule;
mod coefficient_table;
mod delay_schedule;
pub mod delay_scheduling;
mod error;
pub mod form_comparison;
mod interpolation_check;
pub mod lead_degree_comparison;
mod lead_schedule;
mod predictions;
pub mod regression;
mod scheduled_point;
mod second_term;
pub mod second_variable;
pub mod settings;
#[cfg(test)]
mod test_points;

pub use airspeeds::Airspeeds;
pub use assessment::CostChange;
pub use caution::ScheduleCaution;
pub use channel_schedule::Schedule;
pub use delay_scheduling::DelayScheduling;
pub use error::ScheduleError;
pub use regression::Regression;
pub use scheduled_point::ScheduledPoint;
pub use second_variable::SecondVariable;
pub use settings::{ScheduleKind, ScheduleSettings, ScheduledQuantity};
