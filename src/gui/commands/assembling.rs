//! Commands for importing models.

use std::path::PathBuf;

use gdcm_model::assembly::Rules;

/// Command in the import view.
#[derive(Clone, Debug, PartialEq)]
pub enum AssemblingCommand {
    /// Starts the import, or returns to it.
    Open,
    /// Chooses a folder with the desktop's dialog.
    AskFolder,
    /// Reads files, and folders with all their files.
    Add(Vec<PathBuf>),
    StopReading,
    /// Changes the import rules.
    Change(Box<Rules>),
    Undo,
    Redo,
    Select(usize),
    /// Sorts the table by the column with this index; the same column again reverses the order.
    Sort(usize),
    /// Shows a response in the preview, given as `output * inputs + input`.
    ShowResponse(usize),
    LoadRules(PathBuf),
    SaveRules(PathBuf),
    /// Writes the dataset and its rules, and opens the dataset.
    MakeDataset(PathBuf),
    /// Leaves the import and discards it.
    Close,
}
