//! Analysis stages, each cached while its inputs stay the same; and assessments that need further
//! analyses.

pub mod bundle_metrics;
pub mod compared_model;
mod compared_stages;
pub mod comparison;
pub mod comparison_cautions;
pub mod comparison_input;
pub mod condition_curves;
pub mod condition_responses;
pub mod condition_stages;
pub mod convention_check;
pub mod correction_costs;
pub mod coupling_effects;
pub mod coupling_fit;
pub mod couplings_assessment;
pub mod engine;
pub mod error_bars;
pub mod known_models;
pub mod mean_gains;
mod memo;
pub mod model_cautions;
pub mod model_swaps;
pub mod optima;
pub mod physics_assessment;
pub mod physics_fit;
pub mod physics_models;
pub mod rerun_checks;
pub mod run;
pub mod signed_delay_cautions;
