//! Results as typed facts: an analysis with its comparisons, cautions, couplings and uncertainty;
//! and results derived from a finished analysis: assessments, requirements, time histories.

pub mod analysis;
pub mod asked_condition;
pub mod assessment_table;
pub mod caution;
pub mod channel_time_skew;
pub mod comparison;
pub mod condition_answers;
pub mod convention_doubt;
pub mod coupled_model;
pub mod couplings_assessment;
pub mod fitted_couplings;
pub mod lead_compensation;
pub mod model_swap;
pub mod record_comparison;
pub mod reported_error;
pub mod required_bandwidth;
pub mod required_modes;
pub mod requirement_role;
pub mod requirements;
pub mod schedule_losses;
pub mod scheduled_conditions;
pub mod time_histories;
pub mod uncertainty;
