//! File reading in threads: a newer reading may replace an older one, whose result is then ignored,
//! and the engineer may stop a reading.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use gdcm_io::FolderProgress;

/// The newest reading for a purpose; several threads may take part in it.
#[derive(Default)]
pub(super) struct Reader {
    /// Number of the newest reading.
    newest: u64,
    /// Stop flag shared with the threads of the newest reading.
    stop: Arc<AtomicBool>,
}

/// A reading in progress.
pub(super) struct Reading {
    /// Reading number; the result is used only while no newer reading has begun.
    pub(super) number: u64,
    /// Set when the reading should stop.
    pub(super) stop: Arc<AtomicBool>,
}

impl Reader {
    /// Starts a reading that replaces the reading in progress.
    pub(super) fn begin(&mut self) -> Reading {
        self.give_up();
        self.stop = Arc::default();
        self.current()
    }

    /// Starts a reading in parallel to the reading in progress; both have the same number and are
    /// stopped together. After a stop, starts a new reading.
    pub(super) fn join(&mut self) -> Reading {
        if self.is_stopped() {
            return self.begin();
        }
        self.current()
    }

    fn current(&self) -> Reading {
        Reading {
            number: self.newest,
            stop: Arc::clone(&self.stop),
        }
    }

    /// Returns whether the result from reading `number` is still used.
    pub(super) fn is_newest(&self, number: u64) -> bool {
        self.newest == number
    }

    /// Stops the reading in progress; the content read so far may still be used.
    pub(super) fn stop(&self) {
        self.stop.store(true, Ordering::Release);
    }

    /// Returns whether the reading was stopped.
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Acquire)
    }

    /// Stops the reading in progress and discards its result, even if a drive blocks the thread.
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

/// Progress handle for a reading that can be stopped but shows no progress.
pub(super) struct SilentProgress(pub(super) Arc<AtomicBool>);

impl FolderProgress for SilentProgress {
    fn reading(&self, _: usize, _: usize, _: &str) {}

    fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }
}

/// The window's readers, by kind of file.
#[derive(Default)]
pub(super) struct Readers {
    pub(super) models: Reader,
    pub(super) opener: Reader,
    pub(super) record_reader: Reader,
}
