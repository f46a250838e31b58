//! Results and their typed facts: analyses, remarks, cautions, assessments, requirements, and their tables.

pub mod analysis;
pub mod assessment_table;
pub mod caution;
pub mod channel_time_skew;
pub mod condition_answers;
pub mod convention_doubt;
pub mod couplings_assessment;
#[cfg(test)]
mod couplings_tests;
pub mod couplings_words;
pub mod derivation;
pub mod remark;
pub mod required_bandwidth;
pub mod required_modes;
pub mod requirements;
pub mod requirements_tables;
pub mod schedule_losses;
pub mod table;
pub mod time_histories;
pub mod time_history_tables;
