//! Long computations that run in parallel to the interactive analysis.

pub mod across_job;
pub mod across_role;
pub mod analysis_jobs;
#[cfg(test)]
mod coupling_costs_tests;
#[cfg(test)]
pub(crate) mod couplings_tests;
pub mod curve_jobs;
pub mod identification_jobs;
pub mod job;
pub mod requirement_jobs;
#[cfg(test)]
mod test_input_responses_tests;
#[cfg(test)]
mod time_histories_tests;
pub mod trade_off_job;
#[cfg(test)]
mod trade_off_job_tests;
