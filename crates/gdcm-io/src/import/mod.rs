//! Recognises models and records in files, whatever their format.

mod dataset_models;
mod loose_matrices;
pub mod model_files;
pub mod recognise;
pub mod record_files;
mod response_tables;
