//! The window: the only place that knows eframe, file dialogs and threads.

mod analysis_job;
mod assembling;
mod background_jobs;
mod files;
mod job_queue;
mod keyboard;
mod launch;
mod outputs;
mod reader;
mod records;
mod recovery;
mod reload;
mod report;
mod requirement_tables;
pub mod threads;
mod update;
mod window;

use analysis_job::{AnalysisJob, Proof};
use background_jobs::BackgroundJobs;
use files::{DialogPurpose, PendingAction, ReadFor, SavedStudy, study_name};
use job_queue::JobQueue;
use reader::{Reader, Untold};
use recovery::Autosave;
use recovery::{LAST_WAIT, end_words};
use reload::DiskWatch;
use report::ReportJob;
use threads::Fault;
use threads::{Mailbox, Reply, ReplySender, caught};
use update::NextFocus;
use window::PREFERENCES;

pub use background_jobs::EngineMaker;
pub use launch::{Setup, open};
pub use window::GdcmApp;
