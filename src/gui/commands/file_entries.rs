//! Command-table entries for files: opening, saving, exporting.

use egui::Key;

use gdcm_io::Example;

use super::assembling::AssemblingCommand;
use super::command::Command;
use super::entry::{CTRL, CTRL_SHIFT, Entry, Menu, group};
use super::file::FileCommand;
use super::layout::LayoutCommand;
use super::output::OutputCommand;
use super::records::RecordsCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::notices::MessageBar;
use crate::gui::state::opens_with::OpensWith;
use crate::gui::state::window_state::State;

/// Returns the entries in the File menu.
pub(super) fn file_entries(state: &State) -> Vec<Entry> {
    let export = export_entries().map(|entry| entry.enabled(state.analysis().is_some()));
    let quit = [Entry::new("Quit", "Close the window", FileCommand::Quit).keys(CTRL, Key::Q)];
    group(Menu::File, 0, open_entries())
        .chain(group(Menu::File, 1, save_entries()))
        .chain(group(Menu::File, 2, export))
        .chain(group(Menu::File, 3, page_entries()))
        .chain(group(Menu::File, 4, begin_entries(state)))
        .chain(group(Menu::File, 5, quit))
        .chain(message_entries(state))
        .collect()
}

/// Returns the answers to the message bars, for the palette.
fn message_entries(state: &State) -> Vec<Entry> {
    let mut entries = Vec::new();
    for bar in state.notices.bars() {
        match bar {
            MessageBar::Changed { name } => {
                entries.push(Entry::new(
                    format!("Reload {name}"),
                    "The file has changed; the decisions that still apply are kept",
                    FileCommand::Reload,
                ));
                entries.push(Entry::new(
                    format!("Keep the open version of {name}"),
                    "The file has changed; the results remain those of the open version",
                    FileCommand::KeepOpen,
                ));
            }
            MessageBar::Recovery(offer) => {
                entries.push(Entry::new(
                    format!("Restore unsaved decisions of {}", offer.kept_at),
                    "Opens the dataset with the decisions that were not saved",
                    FileCommand::RestoreRecovery(offer.number),
                ));
                entries.push(Entry::new(
                    format!("Discard unsaved decisions of {}", offer.kept_at),
                    "Removes the recovery file of these decisions",
                    FileCommand::DiscardRecovery(offer.number),
                ));
            }
            // These bars have buttons that copy, close or compute again, which the palette does not
            // list.
            MessageBar::Fault(_) | MessageBar::Differences { .. } => {}
        }
    }
    entries
}

fn open_entries() -> [Entry; 6] {
    [
        Entry::new(
            "Open…",
            "Choose a dataset or a study in the system file dialog",
            FileCommand::AskOpen,
        )
        .keys(CTRL, Key::O),
        Entry::new(
            "Open by path…",
            "Type the path of a dataset or a study; ~ is the home directory",
            Command::show_form(FormKind::Open),
        )
        .keys(CTRL_SHIFT, Key::O),
        Entry::new(
            "Open the example",
            "The simulated dataset that comes with the program",
            FileCommand::OpenExample(Example::Simulated),
        ),
        Entry::new(
            "Open the real-aircraft example",
            "Published physics model and two flights of a quadrotor; they come with the program",
            FileCommand::OpenExample(Example::RealAircraft),
        ),
        Entry::new(
            "Import models…",
            "Makes a dataset from model files: MATLAB, NumPy, JSON, text",
            AssemblingCommand::Open,
        ),
        Entry::new(
            "Add flight records…",
            "To the condition in their names, otherwise to the displayed condition",
            RecordsCommand::AskFiles,
        ),
    ]
}

fn save_entries() -> [Entry; 2] {
    [
        Entry::new(
            "Save study",
            "Write the study to its file",
            FileCommand::SaveStudy,
        )
        .keys(CTRL, Key::S),
        Entry::new(
            "Save study as…",
            "Choose the file in the system file dialog",
            FileCommand::AskSaveStudy,
        )
        .keys(CTRL_SHIFT, Key::S),
    ]
}

fn export_entries() -> [Entry; 2] {
    [
        Entry::new(
            "Export corrections…",
            "All values, functions, tables and corrected models for other tools; the report",
            Command::show_form(FormKind::Export),
        )
        .keys(CTRL, Key::E),
        Entry::new(
            "Write report…",
            "Full report with every plot, ready to print",
            OutputCommand::AskReport,
        ),
    ]
}

fn page_entries() -> [Entry; 2] {
    [
        Entry::new(
            "Close",
            "Close the study and show the start page",
            FileCommand::CloseStudy,
        )
        .keys(CTRL, Key::W),
        Entry::new(
            "Start page",
            "Three ways to begin, and recent files",
            LayoutCommand::ShowStart(true),
        ),
    ]
}

/// Returns a menu entry for each choice of what is shown if the program is started without a file.
fn begin_entries(state: &State) -> [Entry; 3] {
    OpensWith::ALL.map(|choice| {
        Entry::new(
            choice.name(),
            "When the program is started without a file",
            LayoutCommand::BeginWith(choice),
        )
        .enabled(state.display.layout.opens_with != choice)
    })
}
