//! The threads that read for the window: of one purpose only the newest count, and they can be stopped.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use gdcm_files::FolderProgress;

use super::GdcmApp;

/// The newest thread that reads for one purpose, or several beside one another.
#[derive(Default)]
pub(super) struct Reader {
    newest: u64,
    stop: Arc<AtomicBool>,
}

impl Reader {
    /// Begins to read in place of what was being read: the number of the thread, and what ends it.
    pub(super) fn begin(&mut self) -> (u64, Arc<AtomicBool>) {
        self.give_up();
        self.stop = Arc::default();
        (self.newest, Arc::clone(&self.stop))
    }

    /// Begins to read beside what is being read: the number of these threads, and what ends them all.
    pub(super) fn join(&mut self) -> (u64, Arc<AtomicBool>) {
        if self.is_stopped() {
            return self.begin();
        }
        (self.newest, Arc::clone(&self.stop))
    }

    /// Whether the answer of this thread still counts.
    pub(super) fn is_newest(&self, number: u64) -> bool {
        self.newest == number
    }

    /// Ends the reading; what was read until then counts.
    pub(super) fn stop(&self) {
        self.stop.store(true, Ordering::Release);
    }

    /// Whether the reading was ended by hand.
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Acquire)
    }

    /// Ends the reading, whose answer counts no more, however long a drive keeps the thread waiting.
    pub(super) fn give_up(&mut self) {
        self.stop();
        self.newest += 1;
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Reads without telling how far it is, until it is stopped.
pub(super) struct Untold(pub(super) Arc<AtomicBool>);

impl FolderProgress for Untold {
    fn reading(&self, _: usize, _: usize, _: &str) {}

    fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }
}

impl GdcmApp {
    /// Stops what is told of beside it: the reading of files, or else what is being computed.
    pub(super) fn stop_work(&mut self) {
        let opening = self.state.opening.take();
        let records = self.state.records.reading.take();
        let Some(name) = opening.or(records.as_ref().map(|reading| reading.name.clone())) else {
            return self.stop_jobs();
        };
        self.opener.give_up();
        self.record_reader.give_up();
        if records.is_some() {
            // What was looked for is not looked for again by itself.
            self.records_of(self.state.condition().id());
        }
        self.done(format!("stopped reading {name}; what was open stays"));
    }
}
