//! Models and records recognised in files of any format.

pub mod model_files;
pub mod recognise;
pub mod record_files;
