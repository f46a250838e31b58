//! Recognition of models and records in files of any format.

mod dataset_models;
mod loose_matrices;
pub mod model_files;
pub mod recognise;
pub mod record_files;
mod response_tables;
