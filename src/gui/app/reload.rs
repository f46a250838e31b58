//! Reloads the open dataset after its file has changed on disk. Undo can return to the dataset
//! before the reload, so datasets that a reload has replaced stay in memory
//! (`DocumentFiles::replaced_datasets`).

use std::sync::Arc;

use gdcm_io::files::dataset_file::load_dataset_within;
use gdcm_io::{LoadedDataset, Opened};

use super::GdcmApp;
use super::disk_watch::ChangedFile;
use super::document_files::ReadFor;
use crate::gui::state::notices::{Activity, MessageBar, NoticeAction};
use crate::message::Message;

impl GdcmApp {
    pub(super) fn watch_disk(&mut self) {
        self.files.disk.watch(self.files.loaded.path());
    }

    /// Offers to reload the dataset if its file's content has changed; withdraws the offer if the
    /// content is again that of the open dataset.
    pub(super) fn file_changed(&mut self, changed: &ChangedFile) {
        if self.files.loaded.path() != Some(&changed.path) {
            return;
        }
        self.withdraw_reload_offer();
        if changed.sha256 != self.files.loaded.sha256 {
            self.state.notices.add_bar(MessageBar::Changed {
                name: self.files.loaded.file_name(),
            });
        }
    }

    /// Closes the offer to reload; the next one appears when the file changes again.
    pub(super) fn withdraw_reload_offer(&mut self) {
        self.state
            .notices
            .close_bars(|bar| matches!(bar, MessageBar::Changed { .. }));
    }

    /// Reads the dataset's file again; the open dataset is replaced once the file has been read.
    pub(super) fn reload(&mut self) {
        if let Some(path) = self.files.loaded.path() {
            let path = path.to_owned();
            let name = path.display().to_string();
            self.read(ReadFor::Reloading, name, move |budget| {
                load_dataset_within(&path, budget).map(Opened::Dataset)
            });
        }
    }

    /// Shows the reloaded dataset with every decision that still applies, as an undoable step.
    pub(super) fn show_reloaded(&mut self, loaded: LoadedDataset) {
        if loaded.path() != self.files.loaded.path() {
            // Ignore the result: another file has been opened in the meantime.
            return;
        }
        self.withdraw_reload_offer();
        self.state
            .notices
            .close_bars(|bar| matches!(bar, MessageBar::Differences { .. }));
        let name = loaded.file_name();
        let (study, differences) = self.state.study.reconciled(Arc::clone(&loaded.dataset));
        let before = std::mem::replace(&mut self.state.study, study);
        self.state.history.record_reload(before, name.clone());
        self.files.replaced_datasets.push(loaded);
        self.study_changed();
        if differences.is_empty() {
            let text = format!("reloaded {name}: every decision still applies");
            let message = Message::new("reloaded", text);
            self.notify_done_with(Activity::Other, message, Some(NoticeAction::Undo));
        } else {
            self.state
                .notices
                .add_bar(MessageBar::Differences { name, differences });
        }
    }

    /// Makes the loaded dataset that of the study, after a reload, or after an undo or redo across
    /// a reload.
    pub(super) fn select_dataset_file(&mut self) {
        let dataset = self.state.study.file_dataset();
        let of_study = self
            .files
            .replaced_datasets
            .iter_mut()
            .find(|loaded| Arc::ptr_eq(&loaded.dataset, dataset));
        if let Some(of_study) = of_study {
            std::mem::swap(&mut self.files.loaded, of_study);
            self.state
                .file_cautions
                .clone_from(&self.files.loaded.cautions);
        }
        self.state.follow_dataset();
    }
}
