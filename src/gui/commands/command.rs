//! Commands: requests of the engineer to the window.

use std::path::PathBuf;
use std::sync::Arc;

use egui::ThemePreference;

use gdcm_io::export::ExportFormat;
use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::gains::{Across, Measure};
use gdcm_plot::figure::{ColumnWidth, FigureFormat};
use gdcm_study::{AcrossRole, Edit};
use gdcm_words::{ExplainTarget, Table};

use crate::gui::panels::bars::Bar;
use crate::gui::panels::cost_map::MappedCost;
use crate::gui::panels::explanation::Sheet;
use crate::gui::panels::start_page::OpensWith;
use crate::gui::state::curve_display::CurveCommand;
use crate::gui::state::display::ViewGroup;
use crate::gui::views::assembling::AssemblingCommand;
use crate::gui::views::records::RecordsCommand;
use crate::gui::views::{AssessedFigures, PairSet, RequirementsPage, View};
use crate::gui::widgets::palette::PlotStyle;
use crate::gui::widgets::tables::TableKind;

/// Action of the engineer: a click, a key or a menu entry. Views push commands; the window carries
/// them out.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Takes a decision about the study.
    Edit(Edit),
    /// Completes the current decision, for example when a slider is released.
    EndEdit,
    /// Undoes the last decision.
    Undo,
    /// Removes a decision from the history if it was the last.
    Forget(Edit),
    /// Redoes the last undone decision.
    Redo,
    SelectCondition(ConditionId),
    /// Shows a response in the large plot.
    FocusPair(Pair),
    /// Highlights a model in every view; repeated in each frame.
    Hover(ModelId),
    /// Highlights a condition for this frame.
    HoverCondition(ConditionId),
    /// Describes the plot element under the pointer in the status bar, for this frame.
    Tell(String),
    /// Shows only this model beside the representatives; repeated for the same model, shows all
    /// again.
    Isolate(ModelId),
    /// Brings a plot to the front.
    ShowView(View),
    /// Brings a group to the front, with the view it showed last.
    ShowGroup(ViewGroup),
    /// Shows a view beside the view in front; with `None` the view in front alone.
    ShowBeside(Option<View>),
    ShowInDock(View),
    /// Unfolds (`true`) or folds the dock.
    OpenDock(bool),
    /// Restores the default layout of panels and plots.
    ResetLayout,
    /// Shows the left panel in full (`true`) or as a rail.
    ShowLeft(bool),
    /// Shows a sheet over the middle of the window, or closes it.
    ShowSheet(Option<Sheet>),
    /// Unfolds or folds the settings.
    ShowSettings(bool),
    /// Unfolds or folds the rarely changed settings.
    ShowAdvanced(bool),
    /// Unfolds or folds the identified models.
    ShowIdentified(bool),
    /// Selects the correction whose costs are mapped.
    MapCost(MappedCost),
    /// Selects the responses in the net-gain plots.
    ShowNetGains(PairSet),
    /// Adds a response to the net-gain plots, or removes it.
    PickPair(Pair),
    /// Selects gains or delays of the channels, over airspeed or over conditions.
    ShowChannels(Measure, Across),
    /// Shows or hides zeros among the poles.
    ShowZeros(bool),
    /// Shows or hides error bars and bands in the plots of gains.
    ShowBars(bool),
    /// Overlays a variant on the present decisions in Bode and Net gain, or removes the overlay.
    Overlay(Option<String>),
    /// Shows or hides the evidence for the schedule beside the net gains.
    ShowEvidence(bool),
    /// Selects the models that are overlaid across conditions.
    ShowAcross(AcrossRole),
    /// Changes the assessed quantity or its form.
    Assess(AssessedFigures),
    /// Shows another page of requirements.
    ShowRequirements(RequirementsPage),
    /// Selects responses over time to a test input (`true`) or to the records.
    ShowTest(bool),
    /// Opens the desktop's dialog for a file of levels or tolerances.
    AskRequirementTable(RequirementTable),
    /// Asks for the path of the tolerances.
    AskWriteTolerances,
    /// Reads levels or tolerances from a file.
    ReadRequirementTable(RequirementTable, PathBuf),
    /// Writes the tolerances of the study to a file.
    WriteTolerances(PathBuf),
    /// Shows the derivation of a value, or closes it.
    Explain(Option<ExplainTarget>),
    /// Changes the unit of frequencies.
    SetFrequencyUnit(FrequencyUnit),
    /// Changes how plots over frequency show their curves.
    Curves(CurveCommand),
    /// Shows all models again and clears the selection.
    EndIsolation,
    /// Changes the style of curves.
    SetLooks(PlotStyle),
    /// Fits the plots to their curves.
    FitPlots,
    /// Selects a theme, or follows the desktop's.
    SetTheme(ThemePreference),
    /// Opens the desktop's dialog for a file.
    AskOpen,
    /// Opens a dataset or a study.
    Open(PathBuf),
    /// Opens a study whose dataset has moved: path of the study, path of the dataset.
    OpenStudyOf(PathBuf, PathBuf),
    OpenExample,
    /// Closes the study and shows the start page.
    CloseStudy,
    /// Shows the start page, or the study behind it.
    ShowStart(bool),
    /// Selects what the program opens with at the next start.
    BeginWith(OpensWith),
    /// Saves the study to its file.
    SaveStudy,
    /// Opens the desktop's dialog for the study's file.
    AskSaveStudy,
    /// Saves the study to another file.
    SaveStudyAs(PathBuf),
    /// Shows a form, or closes the open form.
    ShowForm(Option<FormKind>),
    /// Opens the desktop's dialog for the export folder.
    AskExportFolder,
    /// Writes the corrections selected in the export form.
    Export,
    /// Writes all corrections in a format for other tools.
    ExportAs(ExportFormat, PathBuf),
    /// Overwrites the files listed in the form.
    Overwrite,
    /// Saves the study, then continues with the action that would lose unsaved decisions.
    SaveAndGoOn,
    /// Continues with the action that loses unsaved decisions.
    DiscardAndGoOn,
    /// Stops reading a file; if none is being read, stops the computation.
    StopComputing,
    /// Starts a stopped computation again.
    Compute,
    /// Reads the dataset's changed file again.
    Reload,
    /// Keeps the open dataset although its file has changed.
    KeepOpen,
    /// Opens the decisions of a recovery file; the argument is the offer's number.
    RestoreRecovery(usize),
    /// Removes a recovery file; the argument is the offer's number.
    DiscardRecovery(usize),
    /// Checks which recent files exist.
    LookForRecent,
    /// Closes a bar.
    CloseBar(Bar),
    /// Copies text to the clipboard.
    CopyText(String),
    /// Copies a table to the clipboard as text.
    CopyTable(TableKind),
    /// Asks for the path of a table.
    AskSaveTable(TableKind),
    /// Asks for the path of a table shown by a view.
    AskSaveShownTable(Arc<Table>),
    /// Imports models from files.
    Assembling(AssemblingCommand),
    /// Flight records, and models identified from them.
    Records(RecordsCommand),
    /// Saves a table as CSV.
    SaveTable(Arc<Table>, PathBuf),
    /// Copies the numbers shown by a view to the clipboard as CSV.
    CopyFigure(View),
    /// Asks for the path of a view's figure.
    AskSaveFigure(View, FigureFormat),
    /// Saves the figure of a view, in the format of the file extension and in the given printed
    /// width.
    SaveFigure(View, ColumnWidth, PathBuf),
    /// Asks for the path of the report.
    AskReport,
    /// Writes the report to a file.
    WriteReport(PathBuf),
    /// Focuses the field with this accessible name.
    FocusField(&'static str),
    /// Moves the focus to the next or to the previous region of the window.
    LeaveRegion {
        forward: bool,
    },
    /// Shows the first step of the guided tour.
    StartTour,
    /// Shows another step of the guided tour, or ends it.
    ShowTourStep(Option<usize>),
    /// Takes the decision requested by a form, and closes the form.
    DecideInForm(Edit),
    /// Asks for the reason, in words, why a model is or will be rejected.
    AskReason(ModelId),
    /// Reports why an entry is refused.
    Refuse(String),
    /// Closes the message.
    DismissNotice,
    Quit,
}

/// Table of requirements that the engineer supplies as a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RequirementTable {
    Levels,
    Tolerances,
}

/// Form in front of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FormKind {
    /// Path of a file to open.
    Open,
    /// New path of a study's dataset.
    FindDataset,
    /// Path for the study.
    Save,
    /// Corrections to export, and the folder.
    Export,
    /// Format of an export for other tools, and the path.
    ExportAs,
    /// Reason of a rejection, in words.
    Reason,
    /// Path for a table.
    SaveTable,
    /// What to make of imported models.
    Models,
    /// Channels of the records that a dataset consists of, and the path.
    RecordDataset,
    /// Path and width of a figure.
    SaveFigure,
    /// Path for the report.
    Report,
    /// Path of a table to read.
    ReadRequirementTable(RequirementTable),
    /// Path for the tolerances.
    WriteTolerances,
    /// Palette of all commands, searched by name.
    Palette,
    /// Confirmation before unsaved decisions are lost.
    Unsaved,
    /// Differences between the dataset and the dataset of the saved study.
    Differences,
    Shortcuts,
    About,
}

impl From<CurveCommand> for Command {
    fn from(command: CurveCommand) -> Self {
        Command::Curves(command)
    }
}

impl From<AssemblingCommand> for Command {
    fn from(command: AssemblingCommand) -> Self {
        Self::Assembling(command)
    }
}

impl From<RecordsCommand> for Command {
    fn from(command: RecordsCommand) -> Self {
        Self::Records(command)
    }
}

impl From<Edit> for Command {
    fn from(edit: Edit) -> Self {
        Command::Edit(edit)
    }
}
