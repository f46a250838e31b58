//! The window: the only module that uses eframe, file dialogs and threads.

mod analysis_job;
mod background_jobs;
mod computation;
mod computing_commands;
mod curve_commands;
mod dialogs;
mod disk_watch;
mod display_commands;
mod document_files;
mod file_commands;
mod files;
mod form_commands;
mod job_kind;
mod job_pool;
mod job_queue;
mod keyboard;
mod launch;
mod layout_commands;
pub mod model_import;
mod output_commands;
mod outputs;
mod readers;
pub mod record_import;
mod recovery;
mod reload;
mod selection_commands;
mod study_commands;
pub mod threads;
mod update;
mod window;

pub use background_jobs::EngineMaker;
pub use launch::{Setup, open};
pub use window::GdcmApp;
