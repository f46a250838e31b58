//! Commands for importing models.

use std::path::PathBuf;

use gdcm_model::assembly::Rules;

/// Command in the import view.
#[derive(Clone, Debug, PartialEq)]
pub enum AssemblingCommand {
    /// Start the import, or return to it.
    Open,
    /// Choose a folder with the desktop's dialog.
    AskFolder,
    /// Read files, and folders with all their files.
    Add(Vec<PathBuf>),
    StopReading,
    /// Change the import rules.
    Change(Box<Rules>),
    Undo,
    Redo,
    Select(usize),
    /// Sort the table by the column with this index; the same column again reverses the order.
    Sort(usize),
    /// Show the response with this index in the preview.
    ShowResponse(usize),
    LoadRules(PathBuf),
    SaveRules(PathBuf),
    /// Write the dataset and its rules, and open the dataset.
    MakeDataset(PathBuf),
    /// Leave the import and discard it.
    Close,
}
