//! Files: datasets, studies and results. The only place that touches the file system.

pub mod beginning;
pub mod corrections_file;
pub mod dataset_file;
pub mod export;
pub mod export_contents;
pub mod figure_file;
pub mod file_error;
pub mod formats;
pub mod json_text;
mod location;
pub mod model_files;
pub mod models_file;
pub mod output_set;
mod recognise;
pub mod record_files;
pub mod report;
pub mod requirements_file;
pub mod rules_file;
pub mod source;
mod strides;
pub mod study_file;
pub mod user_state;
pub mod variables;

pub use dataset_file::{
    DatasetOrigin, LoadedDataset, embedded_example, load_dataset, load_dataset_bytes,
};

pub use file_error::FileError;

pub use formats::mat::write as write_mat;

pub use formats::FolderProgress;
pub use gdcm_model::dataset::limits::LARGEST_TEXT;

pub use model_files::read_models;

pub use output_set::Existing;

pub use study_file::{Opened, load_any, save_study};
