//! The window: the only module that uses eframe, file dialogs and threads.

mod background_jobs;
mod files;
mod job_queue;
mod keyboard;
mod launch;
pub mod model_import;
mod outputs;
pub mod record_import;
mod recovery;
mod reload;
pub mod threads;
mod update;
mod window;

pub use background_jobs::EngineMaker;
pub use launch::{Setup, open};
pub use window::GdcmApp;
