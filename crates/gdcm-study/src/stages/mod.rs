//! Stages of the analysis, each cached while its inputs stay the same; and assessments that need
//! further analyses.

pub mod bundle_metrics;
pub mod compared_model;
pub mod comparison;
pub mod condition_curves;
pub mod condition_responses;
pub mod condition_stages;
pub mod convention_check;
pub mod coupling_costs;
pub mod coupling_fit;
pub mod engine;
pub mod error_bars;
pub mod model_cautions;
pub mod model_swaps;
pub mod optima;
pub mod run;
pub mod schedule_cautions;
