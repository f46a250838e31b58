//! Commands that copy or write corrections, tables, figures and the report.

use std::path::PathBuf;
use std::sync::Arc;

use gdcm_plot::figure::{ColumnWidth, FigureFormat};
use gdcm_study::results::export_note::ExportRemedy;
use gdcm_words::Table;

use crate::gui::state::panel_tables::TableKind;
use crate::gui::state::view::View;

/// Copies a result to the clipboard, or writes it to a file.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputCommand {
    /// Opens the desktop's dialog for the export folder.
    AskExportFolder,
    /// Writes the files listed in the export dialog, once its dry run has ended.
    Export,
    /// Carries out a remedy that the export dialog offers.
    ApplyExportRemedy(ExportRemedy),
    /// Copies the command line that writes the same files as the export dialog.
    CopyExportCommand,
    /// Opens a folder in the desktop.
    ShowFolder(PathBuf),
    /// Copies text to the clipboard.
    CopyText(String),
    /// Copies a table to the clipboard as text.
    CopyTable(TableKind),
    /// Asks where to save a table.
    AskSaveTable(TableKind),
    /// Asks where to save a table shown by a view.
    AskSaveShownTable(Arc<Table>),
    /// Saves a table as CSV.
    SaveTable(Arc<Table>, PathBuf),
    /// Copies the values shown by a view to the clipboard as CSV.
    CopyFigure(View),
    /// Asks where to save a view's figure.
    AskSaveFigure(View, FigureFormat),
    /// Saves a view's figure in the format given by the file extension, with the given printed
    /// width.
    SaveFigure(View, ColumnWidth, PathBuf),
    /// Asks where to write the report.
    AskReport,
    WriteReport(PathBuf),
}
