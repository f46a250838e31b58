//! Window setup: directories, waiting times and preferences. Tests use other values than the
//! program.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use gdcm_study::Engine;
use gdcm_study::stages::engine::LIVE_PROOF;

use super::EngineMaker;
use crate::executor::Pool;
use crate::gui::state::preferences::Preferences;
use crate::message::Message;

/// Application id on the desktop, and name of the data directory.
pub(super) const APP_ID: &str = "gdcm";

/// Window setup; by default nothing is kept on disk.
#[derive(Clone)]
pub struct Setup {
    pub engine: EngineMaker,
    /// Directory for recovery files and the recent-files list; with `None`, neither is kept.
    pub directory: Option<PathBuf>,
    /// Directory that replaces `~` in typed paths; `None` leaves `~` as it is.
    pub home: Option<PathBuf>,
    /// Whether the first start offers the guided tour.
    pub offers_tour: bool,
    /// Maximum time between a decision and its storage in the recovery file: a longer time loses
    /// more decisions in a crash, a shorter one writes the file more often.
    pub keep_after: Duration,
    /// Interval between checks for changes in the dataset file: a longer one delays the offer to
    /// reload, a shorter one accesses the disk more often.
    pub look_every: Duration,
    pub preferences: Preferences,
    /// Problem found before the window was opened; shown first.
    pub trouble: Option<Message>,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            // Longer proofs of optimality run as jobs of their own.
            engine: Arc::new(|| {
                Engine::with_executor(Box::new(Pool)).with_proofs_within(LIVE_PROOF)
            }),
            directory: None,
            home: None,
            offers_tour: false,
            keep_after: Duration::from_secs(2),
            look_every: Duration::from_millis(1500),
            preferences: Preferences::default(),
            trouble: None,
        }
    }
}

impl Setup {
    /// Returns the program's setup, with the directories given by the platform.
    pub(super) fn of_program() -> Self {
        Self {
            directory: eframe::storage_dir(APP_ID),
            home: std::env::home_dir(),
            offers_tour: true,
            ..Self::default()
        }
    }
}
