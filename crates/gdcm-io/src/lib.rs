//! Files: datasets, studies and results. The only place that touches the file system.

pub mod csv_text;
pub mod export;
pub mod export_fault;
pub mod file_error;
pub mod files;
pub mod formats;
pub mod import;
mod json_errors;
mod json_lists;
pub mod json_text;
mod location;
pub mod output_set;
pub mod reading_budget;
pub mod report;
pub mod source;

pub use crate::files::dataset_file::{
    DatasetOrigin, LoadedDataset, embedded_example, load_dataset, load_dataset_bytes,
};

pub use file_error::FileError;

pub use formats::mat::write as write_mat;

pub use formats::FolderProgress;
pub use gdcm_model::dataset::limits::LARGEST_TEXT;

pub use crate::import::model_files::read_models;

pub use output_set::Existing;

pub use crate::files::study_file::{Opened, load_any, save_study};
