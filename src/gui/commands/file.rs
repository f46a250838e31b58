//! Commands about studies, datasets and requirement tables as files.

use std::path::PathBuf;

use gdcm_io::Example;

use crate::gui::state::forms::RequirementTable;

/// Opens, saves, reloads or closes a file.
#[derive(Clone, Debug, PartialEq)]
pub enum FileCommand {
    /// Opens the desktop's dialog for levels or tolerances.
    AskRequirementTable(RequirementTable),
    /// Asks where to write the tolerances.
    AskWriteTolerances,
    /// Reads levels or tolerances from a file.
    ReadRequirementTable(RequirementTable, PathBuf),
    /// Writes the study's tolerances to a file.
    WriteTolerances(PathBuf),
    /// Opens the desktop's dialog for a dataset or a study to open.
    AskOpen,
    /// Opens a dataset or a study.
    Open(PathBuf),
    /// Opens a study whose dataset has moved: study path, dataset path.
    OpenStudyOf(PathBuf, PathBuf),
    /// Opens an example that is part of the program.
    OpenExample(Example),
    /// Closes the study and shows the start page.
    CloseStudy,
    /// Saves the study to its file.
    SaveStudy,
    /// Opens the desktop's dialog for the study's file.
    AskSaveStudy,
    /// Saves the study to another file.
    SaveStudyAs(PathBuf),
    /// Reads the dataset's changed file again.
    Reload,
    /// Keeps the open dataset although its file has changed.
    KeepOpen,
    /// Restores the decisions in a recovery file; the argument is the index in `Recovery::offers`.
    RestoreRecovery(usize),
    /// Removes a recovery file; the argument is the index in `Recovery::offers`.
    DiscardRecovery(usize),
    /// Checks which recent files exist.
    LookForRecent,
    Quit,
}
