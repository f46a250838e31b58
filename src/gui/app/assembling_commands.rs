//! Commands from the import view, which assembles a dataset from models: rules, and the dataset to
//! be made. The models are read by `model_reading.rs`.
//!
//! The *rules* hold what the engineer declares about the files: channels, units and signs, column
//! headings, and each model's condition and role.

use std::path::PathBuf;

use gdcm_io::files::dataset_file::add_dataset;
use gdcm_io::files::rules_file::{add_rules, load_rules, rules_path};
use gdcm_io::formats::sources_folder;
use gdcm_io::relative_folder::relative_folder;
use gdcm_model::assembly::Rules;
use gdcm_model::message_text::sanitized_path;

use super::GdcmApp;
use super::file_dialogs::DialogPurpose;
use super::model_reading::Sources;
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::state::forms::FormKind;
use crate::message::Message;

impl GdcmApp {
    /// Carries out a command from the import view; begins an import if there is none.
    pub(super) fn carry_out_assembling(&mut self, command: AssemblingCommand) {
        let import = self
            .state
            .assembling
            .get_or_insert_with(AssemblyState::default);
        let headings = import.assembly().rules().headings.clone();
        match command {
            AssemblingCommand::Open => {}
            AssemblingCommand::Close => {
                self.readers.models.give_up();
                self.state.assembling = None;
            }
            AssemblingCommand::AskFolder => {
                self.ask_path(DialogPurpose::ModelFolder, String::new())
            }
            AssemblingCommand::Add(paths) => {
                let paths = paths
                    .into_iter()
                    .map(|path| self.files.at_home(path))
                    .collect();
                self.read_models(Sources::More(paths));
            }
            AssemblingCommand::StopReading => self.readers.models.stop(),
            AssemblingCommand::Change(rules) => import.change(*rules),
            AssemblingCommand::Undo => import.undo(),
            AssemblingCommand::Redo => import.redo(),
            AssemblingCommand::Select(part) => import.selected = part,
            AssemblingCommand::Sort(column) => import.sorting = import.sorting.clicked(column),
            AssemblingCommand::ShowResponse(place) => import.preview.response = place,
            AssemblingCommand::LoadRules(path) => self.take_rules(path),
            AssemblingCommand::SaveRules(path) => self.save_rules(path),
            AssemblingCommand::MakeDataset(path) => self.make_dataset(path),
        }
        // Tables are read with the headings in the rules, so other headings require another
        // reading.
        if let Some(import) = &self.state.assembling
            && import.assembly().rules().headings != headings
        {
            self.read_models(Sources::Again(import.sources.clone()));
        }
    }

    /// Returns the import rules, if the import view is open.
    pub(super) fn import_rules(&self) -> Option<Rules> {
        let import = self.state.assembling.as_ref()?;
        Some(import.assembly().rules().clone())
    }

    /// Reads rules from a file, and applies them as an undoable step.
    fn take_rules(&mut self, path: PathBuf) {
        let path = self.files.at_home(path);
        let Some((rules, cautions)) = self.value_or_notify(load_rules(&path)) else {
            return;
        };
        if let Some(import) = &mut self.state.assembling {
            import.change(rules);
        }
        let mut text = format!("applied the rules in {}", sanitized_path(&path));
        for caution in cautions {
            text.push_str(&format!("; {caution}"));
        }
        self.notify_done(Message::new("rules-applied", text));
    }

    /// Writes the rules to a file; asks before overwriting.
    fn save_rules(&mut self, path: PathBuf) {
        let Some(rules) = self.import_rules() else {
            return;
        };
        let path = self.files.at_home(path);
        let saved = self.write_all(&[], |outputs| add_rules(&rules, &path, outputs));
        self.notify_saved(
            saved,
            &path,
            FormKind::Models,
            AssemblingCommand::SaveRules(path.clone()).into(),
        );
    }

    /// Writes the dataset and its rules, ends the import, and opens the dataset; asks before
    /// overwriting.
    fn make_dataset(&mut self, path: PathBuf) {
        let Some(import) = &self.state.assembling else {
            return;
        };
        let path = self.files.at_home(path);
        let folder = relative_folder(sources_folder(&import.sources), &path);
        let Some(dataset) = import.assembly().dataset(&folder) else {
            return self.notify_error(Message::new(
                "incomplete-rules",
                "the dataset cannot be made yet: complete the marked items first",
            ));
        };
        let rules = import.assembly().rules().clone();
        let beside = rules_path(&path);
        let written = self.write_all(&[&path, &beside], |outputs| {
            add_dataset(&dataset, &path, outputs)?;
            add_rules(&rules, &beside, outputs)
        });
        match written {
            Ok(()) => {
                self.state.forms.shown = None;
                self.state.assembling = None;
                self.open(path, None);
            }
            Err(error) => self.notify_not_written(
                error,
                FormKind::Models,
                AssemblingCommand::MakeDataset(path).into(),
            ),
        }
    }
}
