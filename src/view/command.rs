//! What the engineer asks the window to do.

use std::path::PathBuf;
use std::sync::Arc;

use egui::ThemePreference;

use gdcm_io::exports::ExportFormat;
use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::gains::{Across, Measure};
use gdcm_plot::figure::{ColumnWidth, FigureFormat};
use gdcm_study::study::{AcrossRole, Edit, ExplainTarget, Table};

use super::assembling::AssemblingCommand;
use super::bars::Bar;
use super::cost_map::MappedCost;
use super::curve_display::CurveCommand;
use super::display::ViewGroup;
use super::explanation::Sheet;
use super::palette::PlotStyle;
use super::records::RecordsCommand;
use super::start_page::OpensWith;
use super::tables::TableKind;
use super::views::{AssessedFigures, PairSet, RequirementsPage, View};

/// One action of the engineer: what a click, a key or a menu entry stands for. Views push them; the window carries them out.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Take a decision about the study.
    Edit(Edit),
    /// The decision being taken is complete: the slider was let go.
    EndEdit,
    /// Take the last decision back.
    Undo,
    /// Take a decision back as if it had never been taken, if it was the last.
    Forget(Edit),
    /// Bring a decision taken back again.
    Redo,
    /// Show a condition.
    SelectCondition(ConditionId),
    /// Show a response in the large plot.
    FocusPair(Pair),
    /// Point at a model in every view, as long as this is asked for in each frame.
    Hover(ModelId),
    /// Point at a condition; for this frame.
    HoverCondition(ConditionId),
    /// Say in the status bar what the pointer means in a plot; for this frame.
    Tell(String),
    /// Show only this model beside the representatives; the same model again shows all.
    Isolate(ModelId),
    /// Bring a plot to the front.
    ShowView(View),
    /// Bring a group of views to the front, with the one that it showed last.
    ShowGroup(ViewGroup),
    /// Show a view beside the one in front, or that one alone.
    ShowBeside(Option<View>),
    /// Show a view in the dock.
    ShowInDock(View),
    /// Fold or unfold the dock.
    OpenDock(bool),
    /// Every panel and plot goes back to its place.
    ResetLayout,
    /// Show the left panel in full, or as a rail.
    ShowLeft(bool),
    /// Show a sheet over the middle of the window, or none.
    ShowSheet(Option<Sheet>),
    /// Unfold the settings, or fold them.
    ShowSettings(bool),
    /// Unfold the settings that are seldom changed, or fold them.
    ShowAdvanced(bool),
    /// Unfold the identified models, or fold them.
    ShowIdentified(bool),
    /// Map the costs of another correction.
    MapCost(MappedCost),
    /// Show the net gains of other responses.
    ShowNetGains(PairSet),
    /// Pick a response for the net-gain plots, or let it go.
    PickPair(Pair),
    /// Show gains or delays of the channels, over airspeed or over conditions.
    ShowChannels(Measure, Across),
    /// Show zeros among the poles, or not.
    ShowZeros(bool),
    /// Show error bars and bands in the plots of gains, or not.
    ShowBars(bool),
    /// Lay a variant over the present decisions in Bode and Net gain, or none.
    Overlay(Option<String>),
    /// Show the evidence for the schedule beside the net gains, or not.
    ShowEvidence(bool),
    /// Lay other models of the conditions over one another.
    ShowAcross(AcrossRole),
    /// Assess something else, or show it in another form.
    Assess(AssessedFigures),
    /// Show another page of requirements.
    ShowRequirements(RequirementsPage),
    /// Over time, show answers to a test input, or to the records.
    ShowTest(bool),
    /// Choose a file of levels, or of tolerances, with the desktop's dialog.
    AskRequirementTable(RequirementTable),
    /// Ask where to write the tolerances.
    AskWriteTolerances,
    /// Take the levels, or the tolerances, of a file.
    ReadRequirementTable(RequirementTable, PathBuf),
    /// Write the tolerances of the study to a file.
    WriteTolerances(PathBuf),
    /// Show how a value was computed, or put that away.
    Explain(Option<ExplainTarget>),
    /// Read frequencies in another unit.
    SetFrequencyUnit(FrequencyUnit),
    /// Show the curves of the plots over frequency in another way.
    Curves(CurveCommand),
    /// Show all models again, and select none.
    EndIsolation,
    /// Draw curves in another way.
    SetLooks(PlotStyle),
    /// Bring every curve back into view.
    FitPlots,
    /// Follow the desktop's theme, or not.
    SetTheme(ThemePreference),
    /// Choose a file with the desktop's dialog.
    AskOpen,
    /// Open a dataset or a study.
    Open(PathBuf),
    /// Open a study whose dataset has moved: the study, the dataset.
    OpenStudyOf(PathBuf, PathBuf),
    /// Open the embedded example.
    OpenExample,
    /// Put away what is open, and show the start page.
    CloseStudy,
    /// Show the start page, or what is open behind it.
    ShowStart(bool),
    /// Begin with something else the next time.
    BeginWith(OpensWith),
    /// Save the study where it was saved last.
    SaveStudy,
    /// Choose a file for the study with the desktop's dialog.
    AskSaveStudy,
    /// Save the study to a file.
    SaveStudyAs(PathBuf),
    /// Show a form, or close the one shown.
    ShowForm(Option<FormKind>),
    /// Choose the export folder with the desktop's dialog.
    AskExportFolder,
    /// Write the corrections chosen in the export form.
    Export,
    /// Write all corrections in a format for other tools.
    ExportAs(ExportFormat, PathBuf),
    /// Write over the files that the form has named.
    Overwrite,
    /// Save the study, then go on with what would lose decisions that are not saved.
    SaveAndGoOn,
    /// Go on with what loses decisions that are not saved.
    DiscardAndGoOn,
    /// Give up the reading under way, or else the computation.
    StopComputing,
    /// Compute what was given up.
    Compute,
    /// Read the dataset's file again, which has changed.
    Reload,
    /// Stay with the dataset that is open, though its file has changed.
    KeepOpen,
    /// Open the decisions of a recovery file, by the number of its offer.
    RestoreRecovery(usize),
    /// Remove a recovery file, by the number of its offer.
    DiscardRecovery(usize),
    /// See which of the recent files are there.
    LookForRecent,
    /// Put a bar away.
    CloseBar(Bar),
    /// Put a text on the clipboard.
    CopyText(String),
    /// Put a table on the clipboard as text.
    CopyTable(TableKind),
    /// Ask where to save a table.
    AskSaveTable(TableKind),
    /// Ask where to save a table that a view shows.
    AskSaveShownTable(Arc<Table>),
    /// Import models of files.
    Assembling(AssemblingCommand),
    /// Flight records, and models identified from them.
    Records(RecordsCommand),
    /// Save a table as CSV.
    SaveTable(Arc<Table>, PathBuf),
    /// Put the numbers of what a view shows on the clipboard, as CSV.
    CopyFigure(View),
    /// Ask where to save what a view shows.
    AskSaveFigure(View, FigureFormat),
    /// Save what a view shows, in the format that the name says, as wide as it is to be printed.
    SaveFigure(View, ColumnWidth, PathBuf),
    /// Ask where to write the report.
    AskReport,
    /// Write the report to a file.
    WriteReport(PathBuf),
    /// Give the focus to the field of this accessible name.
    FocusField(&'static str),
    /// Give the focus to the next part of the window, or to the one before.
    LeaveRegion {
        /// Whether to the next.
        forward: bool,
    },
    /// Show the first step of the guided tour.
    StartTour,
    /// Show another step of the guided tour, or end it.
    ShowTourStep(Option<usize>),
    /// Take a decision that a form asked for, and close the form.
    DecideInForm(Edit),
    /// Ask for the reason of a rejection, in words: of a model that is rejected, or that is to be.
    AskReason(ModelId),
    /// Say why what was typed is not taken.
    Refuse(String),
    /// Put the message away.
    DismissNotice,
    /// Close the window.
    Quit,
}

/// A table that requirements are asked with, which is a file of the engineer's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RequirementTable {
    /// Levels of bandwidth and phase delay.
    Levels,
    /// Tolerances of time histories.
    Tolerances,
}

/// A form in front of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FormKind {
    /// Which file to open, by path.
    Open,
    /// Where the dataset of a study is now, by path.
    FindDataset,
    /// Where to save the study, by path.
    Save,
    /// What to export, and where.
    Export,
    /// As what to export for other tools, and where.
    ExportAs,
    /// Why a model is rejected, in words.
    Reason,
    /// Where to save a table, by path.
    SaveTable,
    /// What is made of models that are imported.
    Models,
    /// Which channels of records a dataset is made of, and where.
    RecordDataset,
    /// Where to save a figure, by path, and how wide.
    SaveFigure,
    /// Where to write the report, by path.
    Report,
    /// Which file of a table to take, by path.
    ReadRequirementTable(RequirementTable),
    /// Where to write the tolerances, by path.
    WriteTolerances,
    /// Every command, found by its name.
    Palette,
    /// Whether to lose unsaved decisions.
    Unsaved,
    /// What is different in the dataset from the one the study was made with.
    Differences,
    /// Keys and gestures.
    Shortcuts,
    /// What the program is.
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
