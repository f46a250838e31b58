//! The desktop's file dialogs, each in a thread of its own so that the window never waits.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

use egui::Context;

/// What a dialog was opened for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DialogPurpose {
    /// A dataset or a study to open.
    Open,
    /// A file to save the study to.
    SaveStudy,
    /// A folder to export to.
    ExportFolder,
    /// A folder of model files.
    ModelFolder,
    /// A folder of flight records.
    RecordFolder,
}

/// How a dialog ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DialogAnswer {
    /// A path was chosen.
    Chosen(DialogPurpose, PathBuf),
    /// Nothing was chosen, or there is no dialog on this desktop: both look alike.
    Nothing(DialogPurpose),
}

/// The dialogs under way.
pub struct Dialogs {
    sender: Sender<DialogAnswer>,
    receiver: Receiver<DialogAnswer>,
    open: bool,
}

impl Dialogs {
    /// No dialog is open.
    pub fn new() -> Self {
        let (sender, receiver) = channel();
        Self { sender, receiver, open: false }
    }

    /// Opens a dialog, unless one is open; it starts with `file_name` where it saves.
    pub fn ask(&mut self, purpose: DialogPurpose, file_name: String, ctx: &Context) {
        if self.open {
            return;
        }
        let (sender, ctx) = (self.sender.clone(), ctx.clone());
        let ask = move || {
            let answer = match dialog(purpose, &file_name) {
                Some(path) => DialogAnswer::Chosen(purpose, path),
                None => DialogAnswer::Nothing(purpose),
            };
            // The window may be gone by now.
            let _ = sender.send(answer);
            ctx.request_repaint();
        };
        self.open = std::thread::Builder::new().name("dialog".to_owned()).spawn(ask).is_ok();
    }

    /// The answer, once the dialog is closed.
    pub fn answer(&mut self) -> Option<DialogAnswer> {
        let answer = self.receiver.try_recv().ok()?;
        self.open = false;
        Some(answer)
    }
}

fn dialog(purpose: DialogPurpose, file_name: &str) -> Option<PathBuf> {
    let dialog = rfd::FileDialog::new();
    match purpose {
        DialogPurpose::Open => dialog
            .set_title("Open a dataset or a study")
            .add_filter("datasets and studies", &["json", "gz"])
            .add_filter("all files", &["*"])
            .pick_file(),
        DialogPurpose::SaveStudy => {
            dialog.set_title("Save the study").add_filter("studies", &["json"]).set_file_name(file_name).save_file()
        }
        DialogPurpose::ModelFolder => dialog.set_title("A folder of model files").pick_folder(),
        DialogPurpose::RecordFolder => dialog.set_title("A folder of flight records").pick_folder(),
        DialogPurpose::ExportFolder => dialog.set_title("Export corrections to a folder").pick_folder(),
    }
}
