//! Forms that ask for a path: to open or save.

use std::path::PathBuf;

use gdcm_plot::figure::ColumnWidth;

use super::form_parts::Form;
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::forms::{FormKind, Forms, RequirementTable};
use crate::gui::state::window_state::State;

/// Texts in a form that asks for a path.
struct PathWords {
    kind: FormKind,
    title: &'static str,
    /// Accessible name for the field.
    field: &'static str,
    /// Placeholder in the empty field.
    hint: &'static str,
    /// Text below the field; may be empty.
    explanation: &'static str,
    submit: &'static str,
}

/// Texts for every form that asks for a path, and for at most one choice.
const PATHS: [PathWords; 10] = [
    PathWords {
        kind: FormKind::Open,
        title: "Open a dataset or a study",
        field: "Path to open",
        hint: "path of a .json, .json.gz or .gdcm-study.json file",
        explanation: "",
        submit: "Open file",
    },
    PathWords {
        kind: FormKind::FindDataset,
        title: "Where is the dataset of this study?",
        field: "Path of the dataset",
        hint: "path of a .json or .json.gz file",
        explanation: "",
        submit: "Open with this dataset",
    },
    PathWords {
        kind: FormKind::Save,
        title: "Save the study",
        field: "Path to save",
        hint: "path of a .gdcm-study.json file",
        explanation: "",
        submit: "Save file",
    },
    PathWords {
        kind: FormKind::AddRecords,
        title: "Add flight records",
        field: "Path of records",
        hint: "path of a file, a folder or an archive",
        explanation: "CSV, text, .mat, .npz, .zip and logs. Each record goes to the condition in the \
            name of its file or folder.",
        submit: "Add these records",
    },
    PathWords {
        kind: FormKind::SaveTable,
        title: "Save the table",
        field: "Path of the table",
        hint: "path of a .csv file",
        explanation: "",
        submit: "Save table",
    },
    PathWords {
        kind: FormKind::SaveFigure,
        title: "Save the figure",
        field: "Path of the figure",
        hint: "path of a .svg, .png, .pdf or .csv file",
        explanation: "On white paper in both themes. The file extension sets the format; CSV \
            contains the values.",
        submit: "Save figure",
    },
    PathWords {
        kind: FormKind::Report,
        title: "Write the report",
        field: "Path of the report",
        hint: "path of a .html file",
        explanation: "Decisions, results and plots on a single page, for browser and printer",
        submit: "Write report",
    },
    PathWords {
        kind: FormKind::ReadRequirementTable(RequirementTable::Levels),
        title: "Levels of bandwidth and phase delay",
        field: "Path of the levels",
        hint: "path of a .json file",
        explanation: "[{\"name\": \"Level 1\", \"axis\": \"P\", \"points\": [[rad/s, s], …]}]. Boundaries \
                      depend on task and category; those of ADS-33E-PRF for yaw are in the limits menu \
                      (docs/requirements.md).",
        submit: "Read levels",
    },
    PathWords {
        kind: FormKind::ReadRequirementTable(RequirementTable::Tolerances),
        title: "Tolerances of time histories",
        field: "Path of the tolerances",
        hint: "path of a .json file",
        explanation: "As written by Save tolerances… (docs/requirements.md)",
        submit: "Read tolerances",
    },
    PathWords {
        kind: FormKind::WriteTolerances,
        title: "Save the tolerances",
        field: "Path to save the tolerances",
        hint: "path of a .json file",
        explanation: "For other studies and for gdcm requirements --tolerances",
        submit: "Save tolerances",
    },
];

/// Draws a form that asks for a path, and in some forms for a choice; draws nothing for a form that
/// is not in [`PATHS`], which only asks whether to overwrite.
pub(super) fn path_ui(form: &mut Form<'_, '_>, kind: FormKind, state: &mut State) {
    let Some(words) = PATHS.iter().find(|words| words.kind == kind) else {
        return;
    };
    form.title(&title(words, &state.forms));
    let mut path = std::mem::take(state.forms.typed_in(kind));
    let entered = form.text_ui(words.field, &mut path, words.hint);
    if kind == FormKind::SaveFigure {
        let widths = ColumnWidth::BOTH.map(|width| (width, width.words()));
        form.choices_ui(&mut state.forms.figure_width, widths);
    }
    let forms = &mut state.forms;
    let explanation = match &forms.lost_dataset {
        Some((_, reason)) if kind == FormKind::FindDataset => reason,
        _ => words.explanation,
    };
    if !explanation.is_empty() {
        form.explain(explanation);
        form.ui.add_space(4.0);
    }
    form.line(|form| {
        let command = path_command(kind, forms, path.trim().into());
        form.submit_ui(words.submit, !path.trim().is_empty(), entered, command);
        form.cancel_ui(false);
    });
    *forms.typed_in(kind) = path;
}

/// Returns the title, with the name of the table or view if one is to be saved.
fn title(words: &PathWords, forms: &Forms) -> String {
    match (words.kind, &forms.table, forms.figure) {
        (FormKind::SaveTable, Some(table), _) => {
            format!("{} \u{201c}{}\u{201d}", words.title, table.title)
        }
        (FormKind::SaveFigure, _, Some(view)) => format!("{} of {}", words.title, view.name()),
        _ => words.title.to_owned(),
    }
}

/// Returns the command that a form submits; `None` if the table, the view or the study to act on is
/// missing.
fn path_command(kind: FormKind, forms: &Forms, path: PathBuf) -> Option<Command> {
    Some(match kind {
        FormKind::Open => Command::File(FileCommand::Open(path)),
        FormKind::FindDataset => Command::File(FileCommand::OpenStudyOf(
            forms.lost_dataset.as_ref()?.0.clone(),
            path,
        )),
        FormKind::Save => Command::File(FileCommand::SaveStudyAs(path)),
        FormKind::AddRecords => Command::Records(RecordsCommand::Add(vec![path])),
        FormKind::SaveTable => {
            Command::Output(OutputCommand::SaveTable(forms.table.clone()?, path))
        }
        FormKind::SaveFigure => Command::Output(OutputCommand::SaveFigure(
            forms.figure?,
            forms.figure_width,
            path,
        )),
        FormKind::Report => Command::Output(OutputCommand::WriteReport(path)),
        FormKind::ReadRequirementTable(table) => {
            Command::File(FileCommand::ReadRequirementTable(table, path))
        }
        FormKind::WriteTolerances => Command::File(FileCommand::WriteTolerances(path)),
        _ => return None,
    })
}
