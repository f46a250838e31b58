//! Reads models and records from files and writes results to files; the crates that it uses access
//! no files.
//!
//! `formats` reads single file formats into variables and columns; `import` recognises models and
//! flight records in them. `files` holds the program's own formats (dataset, study, corrections),
//! `export` other tools' formats, `report` the printed report. Files are written whole or not at
//! all.
//!
//! Section numbers (M4, M13.2, ...) are those of the pages listed under
//! [Sections M1 to M18](gdcm_method#sections-m1-to-m18).
//!
//! ```
//! let example = gdcm_io::embedded_example()?;
//! assert_eq!(example.dataset.conditions().len(), 11);
//! # Ok::<(), gdcm_io::FileError>(())
//! ```

pub mod content_fault;
pub mod csv_text;
pub mod export;
pub mod export_fault;
pub mod file_caution;
pub mod file_error;
pub mod file_reading;
pub mod files;
pub mod formats;
mod gzip;
pub mod import;
mod json_arrays;
mod json_empty_members;
mod json_errors;
mod json_lists;
mod json_location;
mod json_outline;
mod json_path;
mod json_reading;
pub mod json_writing;
pub mod output_set;
pub mod reading_budget;
pub mod relative_folder;
pub mod report;
pub mod software;
mod unknown_keys;
pub mod user_paths;
pub mod variable_fault;

pub use gdcm_model::dataset::limits::LARGEST_TEXT;

pub use crate::file_error::FileError;
pub use crate::files::dataset_file::{
    DatasetOrigin, LoadedDataset, embedded_example, load_dataset, load_dataset_bytes, load_example,
};
pub use crate::files::example::Example;
pub use crate::files::opened_file::{Opened, load_any};
pub use crate::files::study_file::save_study;
pub use crate::formats::FolderProgress;
pub use crate::formats::mat::write as write_mat;
pub use crate::import::model_files::read_models;
pub use crate::output_set::Existing;
