//! What a window is given besides what it shows.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use super::pool::Pool;
use super::worker::EngineMaker;
use crate::view::display::Preferences;
use gdcm_core::study::{Engine, LIVE_PROOF};

/// What a window is given besides what it shows; a test gives other things than the program does.
#[derive(Clone)]
pub struct Setup {
    /// Makes the engines.
    pub engine: EngineMaker,
    /// Where recovery files and the list of recent files are kept; nowhere without it.
    pub directory: Option<PathBuf>,
    /// What `~` stands for in a path that is typed; itself without it.
    pub home: Option<PathBuf>,
    /// Whether the first start shows the guided tour.
    pub offers_tour: bool,
    /// How long after a change the decisions are kept in the recovery file at the latest.
    pub keep_after: Duration,
    /// How often the dataset's file is looked at.
    pub look_every: Duration,
    /// How the engineer likes the window.
    pub preferences: Preferences,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            engine: Arc::new(|| Engine::with_executor(Box::new(Pool)).with_proofs_within(LIVE_PROOF)),
            directory: None,
            home: None,
            offers_tour: false,
            keep_after: Duration::from_secs(2),
            look_every: Duration::from_millis(1500),
            preferences: Preferences::default(),
        }
    }
}

impl Setup {
    /// That of the program: with the directories that the platform gives it.
    pub(super) fn of_program() -> Self {
        Self {
            directory: eframe::storage_dir(super::launch::APP_ID),
            home: std::env::home_dir(),
            offers_tour: true,
            ..Self::default()
        }
    }
}
