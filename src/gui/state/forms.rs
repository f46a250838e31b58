//! Forms in front of the window, and their contents.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use gdcm_model::dataset::ModelId;
use gdcm_plot::figure::ColumnWidth;
use gdcm_words::Table;

use super::export_form::ExportForm;
use super::view::View;

/// Requirement table that the engineer supplies as a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RequirementTable {
    Levels,
    Tolerances,
}

/// Form in front of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FormKind {
    /// Path of the file to open.
    Open,
    /// New path of a study's dataset.
    FindDataset,
    /// Path of the study.
    Save,
    /// Files to export, their contents and folder.
    Export,
    /// Messages of the session.
    Messages,
    /// Reason for a rejection, in the engineer's words.
    Reason,
    /// Path of a table to save.
    SaveTable,
    /// Dataset to make from imported models.
    Models,
    /// Channels and path for a dataset made from records.
    RecordDataset,
    /// Path of flight records to add.
    AddRecords,
    /// Path and printed width of a figure.
    SaveFigure,
    /// Path of the report.
    Report,
    /// Path of a table to read.
    ReadRequirementTable(RequirementTable),
    /// Path of the tolerances.
    WriteTolerances,
    /// Command palette, searched by name.
    Palette,
    /// Confirmation before unsaved decisions are lost.
    Unsaved,
    /// Differences between the dataset and the saved study's dataset.
    Differences,
    Shortcuts,
    About,
    /// Licences of the libraries.
    Licences,
}

/// Search in the open palette.
#[derive(Clone, Debug, Default)]
pub struct PaletteForm {
    /// Typed search text.
    pub query: String,
    /// Index of the row that Enter carries out.
    pub chosen: usize,
}

/// Contents of the forms.
#[derive(Debug, Default)]
pub struct Forms {
    /// The open form.
    pub shown: Option<FormKind>,
    /// Form drawn last, and whether it asked to overwrite files. If either differs in the next
    /// frame, the form counts as newly opened.
    pub drawn: Option<(FormKind, bool)>,
    /// Path or text typed into each form.
    pub typed: BTreeMap<FormKind, String>,
    /// Study whose dataset was not found, and the message from the attempt to open it.
    pub lost_dataset: Option<(PathBuf, String)>,
    /// Model whose rejection is given a reason.
    pub rejected_model: Option<ModelId>,
    /// Table to be saved.
    pub table: Option<Arc<Table>>,
    /// View whose figure is to be saved.
    pub figure: Option<View>,
    /// Printed width of the figure.
    pub figure_width: ColumnWidth,
    pub export: ExportForm,
    pub palette: PaletteForm,
    /// Files that the form's action would overwrite; if there are any, the form asks for consent.
    pub existing: Vec<String>,
}

impl Forms {
    /// Returns the editable text in the field of a form.
    pub fn typed_in(&mut self, form: FormKind) -> &mut String {
        self.typed.entry(form).or_default()
    }
}
