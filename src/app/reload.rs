//! A dataset whose file changes on the disk while it is open.

use std::sync::Arc;

use egui::Context;

use crate::view::bars::Bar;
use gdcm_files::{LoadedDataset, Opened, load_dataset};

use super::files::ReadFor;
use super::window::GdcmApp;

impl GdcmApp {
    /// PlotStyle at the file of the dataset that is open, and says whether it has changed.
    pub(super) fn receive_disk(&mut self) {
        self.disk.watch(self.loaded.path());
        let Some(seen) = self.disk.seen() else { return };
        if self.loaded.path() != Some(&seen.path) {
            return;
        }
        self.state.bars.retain(|bar| !matches!(bar, Bar::Changed { .. }));
        if seen.sha256 != self.loaded.sha256 {
            self.state.bars.push(Bar::Changed { name: self.loaded.file_name() });
        }
    }

    /// Stays with what is open until the file changes again.
    pub(super) fn keep_open(&mut self) {
        self.state.bars.retain(|bar| !matches!(bar, Bar::Changed { .. }));
    }

    /// Reads the dataset's file again; what is open stays until it is read.
    pub(super) fn reload(&mut self, ctx: &Context) {
        if let Some(path) = self.loaded.path().map(ToOwned::to_owned) {
            let name = path.display().to_string();
            self.read(ReadFor::Reloading, name, move || Ok(Opened::Dataset(load_dataset(&path)?)), ctx);
        }
    }

    /// Shows the dataset as it is now, with every decision that still applies: a step that can be undone.
    pub(super) fn show_reloaded(&mut self, loaded: LoadedDataset) {
        if loaded.path() != self.loaded.path() {
            // Something else was opened in between.
            return;
        }
        self.keep_open();
        self.state.bars.retain(|bar| !matches!(bar, Bar::Differences { .. }));
        let name = loaded.file_name();
        let (study, differences) = self.state.study.carried_over(Arc::clone(&loaded.dataset));
        let before = std::mem::replace(&mut self.state.study, study);
        self.state.history.record_reload(before, format!("reload {name}"));
        self.earlier.push(loaded);
        self.study_changed();
        let sentences: Vec<String> = differences.iter().map(ToString::to_string).collect();
        if sentences.is_empty() {
            self.done(format!("reloaded {name}: every decision still applies"));
        } else {
            self.state.bars.push(Bar::Differences { name, sentences });
        }
    }

    /// Takes up the file of the dataset that the study is about, after a reload or a step back or forth across one.
    pub(super) fn follow_dataset(&mut self) {
        let dataset = self.state.study.file_dataset();
        if let Some(index) = self.earlier.iter().position(|loaded| Arc::ptr_eq(&loaded.dataset, dataset)) {
            std::mem::swap(&mut self.loaded, &mut self.earlier[index]);
            self.state.file_cautions.clone_from(&self.loaded.cautions);
        }
        self.state.follow_dataset();
    }
}
