//! File formats of this program.

pub mod beginning_check;
pub mod corrections_file;
pub mod dataset_file;
pub mod example;
pub mod export_contents;
pub mod first_start;
pub mod flight_plan_file;
pub mod identified_models;
pub mod levels_and_tolerances;
pub mod model_collection;
pub mod opened_file;
pub mod recent_files;
pub mod recovery_file;
pub mod requirements_file;
pub mod rules_file;
pub mod standard_levels;
pub mod study_file;
