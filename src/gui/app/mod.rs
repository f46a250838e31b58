//! The window itself: the only module in `gui` that uses eframe, file dialogs and threads.
//!
//! Begin with `window.rs`: [`GdcmApp`] and the steps in a frame. `update.rs` hands each command to
//! its group (`…_commands.rs`), `live_analysis.rs` describes how results follow every change,
//! `background_jobs.rs` lists all kinds of jobs, and `launch.rs` leads from the command line to the
//! window.

mod analysis_job;
mod assembling_commands;
mod autosave;
mod background_jobs;
mod background_work;
mod computing_commands;
mod curve_commands;
mod disk_watch;
mod display_commands;
mod document_files;
mod export_command_line;
mod exports;
pub mod faults;
mod figure_saving;
mod file_commands;
mod file_dialogs;
mod file_writing;
mod first_file;
mod form_commands;
mod job_kind;
mod job_pool;
mod job_queue;
mod key_order;
mod keyboard;
mod launch;
mod layout_commands;
mod live_analysis;
mod mailbox;
mod model_reading;
mod notices;
mod opening;
mod output_commands;
mod postponed_actions;
mod readers;
mod recent_files;
mod record_channels;
mod record_commands;
mod record_dataset;
mod record_edits;
mod record_identification;
mod record_import;
mod record_layout_edits;
mod record_reading;
mod recovery;
mod reload;
mod report_job;
mod requirement_files;
mod results_to_write;
mod saving;
mod selection_commands;
mod setup;
mod study_commands;
mod threads;
mod update;
mod wanted_jobs;
mod window;
mod window_panels;
mod zoom_repair;

pub use background_jobs::EngineMaker;
pub use launch::open;
pub use setup::Setup;
pub use window::GdcmApp;
