//! The Gain-Delay Correction Method: results as sentences and tables.
//!
//! **Question answered:** how does the program describe its results?
//!
//! The crates below return typed facts with numbers. This crate formulates them in English for the
//! terminal, the window, the report and the exported files. It computes nothing except the numbers
//! in its sentences. Section numbers (M4, M13.2, ...) are those of the pages listed under
//! [Sections M1 to M18](gdcm_method#sections-m1-to-m18).
//!
//! Sentences: [`remark`], [`conflict_text`], [`leads`], [`lead_price`], [`solution_details`] and
//! [`sensitivity`] for a condition; [`caution`], [`convention_doubt`] and [`channel_time_skew`] for
//! suspected faults; [`verdict`] for the constrained responses; [`missing_results`] for results
//! that do not exist; [`coupling_error`], [`coupled_model_error`], [`coupling_remark`],
//! [`couplings`], [`physics`], [`assessment`], [`schedule`], [`uncertainty`] for a study; [`edit`],
//! [`decision_differences`] and [`dataset_differences`]; [`export`] for exported files;
//! [`identification_caution`] for identified models, [`input_limit_text`] for their records;
//! [`flight_plan`] for further flights, [`suggested_runs`] for further runs of the physics model.
//! Settings: [`setting_words`], [`gain_source`]. Tables: [`table`], [`requirements`],
//! [`requirement_grid`], [`time_histories`]. Explained results: [`derivation`].
//!
//! # Example
//!
//! ```
//! use gdcm_words::Table;
//!
//! let mut table = Table::new("Condition 3", ["response", "G [-]"]);
//! table.row(["LON → Q", "1.346"]);
//! assert_eq!(table.text(), "Condition 3\nresponse  G [-]\nLON → Q   1.346\n");
//! ```

pub mod assessment;
pub mod caution;
pub mod channel_time_skew;
pub mod conflict_text;
pub mod convention_doubt;
pub mod coupled_model_error;
pub mod coupling_error;
pub mod coupling_remark;
pub mod couplings;
pub mod dataset_differences;
pub mod decision_differences;
pub mod derivation;
pub mod edit;
pub mod export;
pub mod flight_plan;
pub mod gain_source;
pub mod identification_caution;
pub mod input_limit_text;
pub mod lead_price;
pub mod leads;
pub mod missing_results;
pub mod physics;
pub mod remark;
pub mod requirement_grid;
pub mod requirements;
pub mod schedule;
pub mod sensitivity;
pub mod setting_words;
pub mod solution_details;
pub mod suggested_runs;
pub mod table;
pub mod time_histories;
pub mod uncertainty;
pub mod verdict;

pub use derivation::ExplainTarget;
pub use table::Table;

#[cfg(test)]
mod couplings_tests;
#[cfg(test)]
mod example_tests;
#[cfg(test)]
#[path = "../../gdcm-study/src/reference_tests.rs"]
mod reference_tests;
#[cfg(test)]
mod time_histories_tests;
