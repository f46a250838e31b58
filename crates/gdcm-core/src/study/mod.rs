//! What the engineer does: settings, rejections, pins; and the analysis of it all, in cached stages.

mod adopted_models;
mod analysis;
mod assessment_table;
mod caution;
mod channel_time_skew;
mod comparison;
mod condition_responses;
mod condition_stages;
mod convention_doubt;
mod coupled_condition;
mod couplings_assessment;
mod couplings_cost;
mod couplings_tables;
mod couplings_words;
mod decision_difference;
mod derivation;
mod edit;
mod engine;
mod execution;
mod fitted_couplings;
mod identify_job;
mod job;
mod lead_compensation;
mod reconcile;
mod record_history;
mod remark;
mod required_bandwidth;
mod required_modes;
mod requirement_settings;
mod requirements;
mod requirements_overview;
mod requirements_tables;
mod role_model;
pub mod setting;
mod setting_row;
mod settings;
mod sign;
#[allow(clippy::module_inception)]
mod study;
mod substitutions;
mod table;
mod test_answers;
mod time_histories;
#[cfg(test)]
mod time_histories_tests;
mod time_history_tables;
mod uncertainty;

pub use crate::progress::{Cancelled, Progress, Unobserved};
pub use adopted_models::*;
pub use analysis::*;
pub use assessment_table::*;
pub use caution::*;
pub use channel_time_skew::*;
pub use comparison::*;
pub use condition_responses::*;
use condition_stages::*;
pub use convention_doubt::*;
pub use coupled_condition::*;
pub use couplings_assessment::*;
pub use couplings_cost::*;
pub use decision_difference::*;
pub use derivation::{Derivation, ExplainTarget, derivation};
pub use edit::*;
pub use engine::*;
pub use execution::*;
pub use fitted_couplings::*;
pub use identify_job::*;
pub use job::*;
pub use lead_compensation::*;
pub use reconcile::*;
pub use record_history::*;
pub use remark::*;
pub use required_bandwidth::*;
pub use required_modes::*;
pub use requirement_settings::*;
pub use requirements::*;
pub use requirements_overview::*;
pub use requirements_tables::*;
pub use role_model::*;
pub use setting::SETTINGS;
pub use setting_row::*;
pub use settings::*;
pub use sign::*;
pub use study::*;
pub use substitutions::*;
pub use table::*;
pub use test_answers::*;
pub use time_histories::*;
pub use uncertainty::*;

#[cfg(test)]
mod coupled_analysis_tests;
#[cfg(test)]
mod couplings_assessment_tests;
#[cfg(test)]
mod couplings_example_tests;
