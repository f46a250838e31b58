//! Planning the next flight: confidence intervals predicted after further frequency sweeps
//! (M14.25).
//!
//! The Fisher information from the flown records, kept at the end of the identification, plus that
//! from planned sweeps, gives the standard deviations after a flight that has not been flown.
//!
//! | subject | files |
//! |---|---|
//! | information from the flown records | [`flight_information`] |
//! | the spectrum of a planned sweep | [`planned_sweep`] |
//! | intervals after further sweeps | [`flight_planner`], `coordinate_changes` |
//! | tables, advice, targets | [`flight_plan`], [`sweep_advice`], [`interval_target`] |

mod coordinate_changes;
pub mod flight_information;
pub mod flight_plan;
pub mod flight_planner;
pub mod interval_target;
mod least_number;
pub mod planned_sweep;
#[cfg(test)]
mod planning_tests;
pub mod sweep_advice;
