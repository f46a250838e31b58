//! The window: the only module of the window that uses eframe, file dialogs and threads.
//!
//! Begin with `window.rs`: [`GdcmApp`] and the course of a frame. `update.rs` hands each command to
//! its group (`…_commands.rs`), `computation.rs` describes the live analysis, `background_jobs.rs`
//! lists all other jobs, and `launch.rs` leads from the command line to the window.

mod analysis_job;
mod autosave;
mod background_jobs;
mod computation;
mod computing_commands;
mod curve_commands;
mod dialogs;
mod disk_watch;
mod display_commands;
mod document_files;
pub mod faults;
mod file_commands;
mod file_dialogs;
mod form_commands;
mod job_kind;
mod job_pool;
mod job_queue;
mod key_order;
mod keyboard;
mod launch;
mod layout_commands;
mod mailbox;
mod model_import;
mod notices;
mod opening;
mod output_commands;
mod outputs;
mod readers;
mod recent_files;
mod record_commands;
mod record_dataset;
mod record_identification;
mod record_import;
mod record_reading;
mod recovery;
mod reload;
mod report_job;
mod requirement_files;
mod saving;
mod selection_commands;
mod study_commands;
mod threads;
mod update;
mod window;
mod window_panels;
mod zoom_repair;

pub use background_jobs::EngineMaker;
pub use launch::{Setup, open};
pub use window::GdcmApp;
