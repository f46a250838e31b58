//! Commands: requests to the window.

use gdcm_study::Edit;

use super::assembling::AssemblingCommand;
use super::computing::ComputingCommand;
use super::display::DisplayCommand;
use super::file::FileCommand;
use super::form::FormCommand;
use super::layout::LayoutCommand;
use super::output::OutputCommand;
use super::records::RecordsCommand;
use super::selection::SelectionCommand;
use super::study::StudyCommand;
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::widgets::number_entry::RefusedEntry;
use crate::gui::widgets::tables::TableRequest;

/// Request caused by a click, a key or a menu entry. Views push commands; the window carries them
/// out.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    Study(StudyCommand),
    Selection(SelectionCommand),
    Layout(LayoutCommand),
    Display(DisplayCommand),
    File(FileCommand),
    Output(OutputCommand),
    Form(FormCommand),
    Computing(ComputingCommand),
    Curves(CurveCommand),
    Assembling(AssemblingCommand),
    Records(RecordsCommand),
}

impl Command {
    pub(super) fn show_form(form: FormKind) -> Self {
        Self::Form(FormCommand::ShowForm(Some(form)))
    }
}

impl From<StudyCommand> for Command {
    fn from(command: StudyCommand) -> Self {
        Self::Study(command)
    }
}

impl From<SelectionCommand> for Command {
    fn from(command: SelectionCommand) -> Self {
        Self::Selection(command)
    }
}

impl From<LayoutCommand> for Command {
    fn from(command: LayoutCommand) -> Self {
        Self::Layout(command)
    }
}

impl From<DisplayCommand> for Command {
    fn from(command: DisplayCommand) -> Self {
        Self::Display(command)
    }
}

impl From<FileCommand> for Command {
    fn from(command: FileCommand) -> Self {
        Self::File(command)
    }
}

impl From<OutputCommand> for Command {
    fn from(command: OutputCommand) -> Self {
        Self::Output(command)
    }
}

impl From<FormCommand> for Command {
    fn from(command: FormCommand) -> Self {
        Self::Form(command)
    }
}

impl From<ComputingCommand> for Command {
    fn from(command: ComputingCommand) -> Self {
        Self::Computing(command)
    }
}

impl From<CurveCommand> for Command {
    fn from(command: CurveCommand) -> Self {
        Self::Curves(command)
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
        StudyCommand::Edit(edit).into()
    }
}

impl From<RefusedEntry> for Command {
    fn from(entry: RefusedEntry) -> Self {
        let RefusedEntry(reason) = entry;
        FormCommand::Refuse(reason).into()
    }
}

impl From<TableRequest> for Command {
    fn from(request: TableRequest) -> Self {
        match request {
            TableRequest::Copy(text) => OutputCommand::CopyText(text).into(),
            TableRequest::Save(table) => OutputCommand::AskSaveShownTable(table).into(),
        }
    }
}
