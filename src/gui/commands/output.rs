//! Commands about corrections, tables, figures and the report as output.

use std::path::PathBuf;
use std::sync::Arc;

use gdcm_io::export::ExportFormat;
use gdcm_plot::figure::{ColumnWidth, FigureFormat};
use gdcm_words::Table;

use crate::gui::state::tables::TableKind;
use crate::gui::state::view::View;

/// Copies a result to the clipboard, or writes it to a file.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputCommand {
    /// Opens the desktop's dialog for the export folder.
    AskExportFolder,
    /// Writes the corrections selected in the export form.
    Export,
    /// Writes all corrections in a format for other tools.
    ExportAs(ExportFormat, PathBuf),
    /// Copies text to the clipboard.
    CopyText(String),
    /// Copies a table to the clipboard as text.
    CopyTable(TableKind),
    /// Asks for a table's path.
    AskSaveTable(TableKind),
    /// Asks for the path of a table that a view shows.
    AskSaveShownTable(Arc<Table>),
    /// Saves a table as CSV.
    SaveTable(Arc<Table>, PathBuf),
    /// Copies the values shown by a view to the clipboard as CSV.
    CopyFigure(View),
    /// Asks for the path of a view's figure.
    AskSaveFigure(View, FigureFormat),
    /// Saves a view's figure in the format given by the file extension, with the given printed
    /// width.
    SaveFigure(View, ColumnWidth, PathBuf),
    /// Asks for the report's path.
    AskReport,
    /// Writes the report to a file.
    WriteReport(PathBuf),
}
