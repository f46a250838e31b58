//! The files opened and saved of late.

use gdcm_core::message_text::{sanitized, sanitized_path};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};

use egui::Context;

use crate::view::state::RecentFile;
use gdcm_files::{FileError, add_recent_file, file_exists, recent_files};

use super::window::GdcmApp;

/// The list as it was read last.
type Answer = Result<Vec<RecentFile>, FileError>;

/// Where the list is kept, and where its readers answer: a network drive may keep them waiting.
pub(super) struct Recent {
    directory: Option<PathBuf>,
    sender: Sender<Answer>,
    receiver: Receiver<Answer>,
}

impl Recent {
    /// The list in `directory`; none is kept without it.
    pub(super) fn new(directory: Option<PathBuf>) -> Self {
        let (sender, receiver) = channel();
        Self { directory, sender, receiver }
    }

    /// Where the program keeps its data, if anywhere.
    pub(super) fn directory(&self) -> Option<&Path> {
        self.directory.as_deref()
    }

    /// Reads the list and looks which of its files are there, in a thread of its own; puts `newest` in front first.
    pub(super) fn look(&self, newest: Option<PathBuf>, ctx: &Context) {
        let Some(directory) = self.directory.clone() else { return };
        let (sender, wake) = (self.sender.clone(), ctx.clone());
        let look = move || {
            let added = newest.map_or(Ok(()), |newest| add_recent_file(&directory, &newest));
            // The window may be gone by now.
            let _ = sender.send(added.map(|()| recent_files(&directory).into_iter().map(seen).collect()));
            wake.request_repaint();
        };
        // Without a thread the list stays as it was.
        let _ = std::thread::Builder::new().name("recent files".to_owned()).spawn(look);
    }
}

fn seen(path: PathBuf) -> RecentFile {
    let name = path.file_name().map(|name| sanitized(&name.to_string_lossy())).unwrap_or_default();
    let folder = path.parent().map(sanitized_path).unwrap_or_default();
    RecentFile { missing: !file_exists(&path), path, name, folder }
}

impl GdcmApp {
    /// Takes the list, if it was read anew.
    pub(super) fn receive_recent(&mut self) {
        match self.recent.receiver.try_iter().last() {
            Some(Ok(files)) => self.state.recent = files,
            Some(Err(error)) => self.trouble(error.to_string()),
            None => {}
        }
    }
}
