//! Forms in front of the window, and what they contain.

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
    /// Path to the file to open.
    Open,
    /// New path to a study's dataset.
    FindDataset,
    /// Path for the study.
    Save,
    /// Files to export, their contents and folder.
    Export,
    /// Messages from this session.
    Messages,
    /// Reason for a rejection, in the engineer's words.
    Reason,
    /// Path for a table to save.
    SaveTable,
    /// Files of the import (rules or dataset) that exist; asks only whether to overwrite them.
    Models,
    /// Channels and path for a dataset made from records.
    RecordDataset,
    /// Path to flight records to add.
    AddRecords,
    /// Path and printed width for a figure.
    SaveFigure,
    /// Path for the report.
    Report,
    /// Path to a table to read.
    ReadRequirementTable(RequirementTable),
    /// Path for the tolerances.
    WriteTolerances,
    /// Command palette, searched by name.
    Palette,
    /// Confirmation before unsaved decisions are lost.
    Unsaved,
    /// Differences between the dataset and the saved study's dataset.
    Differences,
    Shortcuts,
    About,
    /// Licences under which the libraries are used.
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
    /// Width at which the figure is printed.
    pub figure_width: ColumnWidth,
    pub export: ExportForm,
    pub palette: PaletteForm,
    /// Files that the form's action would overwrite; if there are any, the form asks for consent.
    pub existing: Vec<String>,
}

impl Forms {
    /// Returns the editable text in a form's field.
    pub fn typed_in(&mut self, form: FormKind) -> &mut String {
        self.typed.entry(form).or_default()
    }
}
