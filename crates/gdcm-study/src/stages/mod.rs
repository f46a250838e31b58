//! The analysis in stages, each kept while its key stays the same.

pub mod comparison;
pub mod condition_responses;
pub mod condition_stages;
pub mod engine;
pub mod execution;
pub mod fitted_couplings;
pub mod lead_compensation;
pub mod substitutions;
pub mod uncertainty;
