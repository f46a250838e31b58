//! Forms in front of the window: paths to open and save, export options, questions, help.

use std::collections::BTreeSet;
use std::path::PathBuf;

use egui::text::{CCursor, CCursorRange};
use egui::{
    Align, Button, Context, Id, Label, Layout, Modal, RichText, Role, ScrollArea, TextEdit, Ui,
    vec2,
};

use gdcm_io::export::{EXPORTERS, ExportRequest, export_contents};
use gdcm_io::files::export_contents::ExportContents;
use gdcm_model::dataset::ConditionId;
use gdcm_plot::figure::ColumnWidth;
use gdcm_study::decisions::differences::Difference;
use gdcm_study::{Analysis, Edit};
use gdcm_words::decisions::dataset_difference_text;

use super::help::keys_page_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::command_palette::command_palette_ui;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::forms::{FormKind, Forms, RequirementTable};
use crate::gui::state::records::WantedDataset;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{is_entered, name_text_field, named_switch, text_field_ui};
use crate::gui::widgets::palette::Palette;

/// Draws the requested form, if any. Its field has the focus when it opens; Enter submits it;
/// Escape and a click outside close it.
pub fn forms_ui(ctx: &Context, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(kind) = state.forms.shown else {
        state.forms.drawn = None;
        return;
    };
    let asks_to_overwrite = !state.forms.existing.is_empty();
    let opens =
        state.forms.drawn.replace((kind, asks_to_overwrite)) != Some((kind, asks_to_overwrite));
    // Each form has its own id, because egui stores the size by id.
    let modal = Modal::new(Id::unique(("form", kind, asks_to_overwrite))).show(ctx, |ui| {
        ui.set_width(460.0);
        let form = &mut Form {
            ui,
            opens,
            palette,
            commands,
        };
        match kind {
            _ if asks_to_overwrite => overwrite_ui(form, kind, &state.forms.existing),
            FormKind::Export => export_ui(form, state),
            FormKind::Unsaved => unsaved_ui(form),
            FormKind::Differences => differences_ui(form, state),
            FormKind::Shortcuts => shortcuts_ui(form, state),
            FormKind::Palette => command_palette_ui(form.ui, state, opens, palette, form.commands),
            FormKind::Reason => reason_ui(form, state),
            FormKind::RecordDataset => record_dataset_ui(form, &mut state.records.wanted),
            FormKind::About => about_ui(form),
            _ => path_ui(form, kind, state),
        }
    });
    if modal.should_close() {
        commands.push(FormCommand::ShowForm(None).into());
    }
}

/// Texts of a form that asks for a path.
struct PathWords {
    kind: FormKind,
    title: &'static str,
    /// Accessible name of the field.
    field: &'static str,
    /// Placeholder of the empty field.
    hint: &'static str,
    /// Text below the field; may be empty.
    explanation: &'static str,
    /// Text of the button.
    submit: &'static str,
}

/// Every form that asks for a path and at most for a choice.
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
        explanation: "On white paper, whatever the theme. The end of the name says the format; CSV holds the numbers.",
        submit: "Save figure",
    },
    PathWords {
        kind: FormKind::Report,
        title: "Write the report",
        field: "Path of the report",
        hint: "path of a .html file",
        explanation: "All that was done and found as one page with every plot, to read in a browser and to print.",
        submit: "Write report",
    },
    PathWords {
        kind: FormKind::ReadRequirementTable(RequirementTable::Levels),
        title: "Levels of bandwidth and phase delay",
        field: "Path of the levels",
        hint: "path of a .json file",
        explanation: "[{\"name\": \"Level 1\", \"axis\": \"P\", \"points\": [[rad/s, s], …]}]. None is built in: boundaries depend on the \
                      task and the category (docs/requirements.md).",
        submit: "Take levels",
    },
    PathWords {
        kind: FormKind::ReadRequirementTable(RequirementTable::Tolerances),
        title: "Tolerances of time histories",
        field: "Path of the tolerances",
        hint: "path of a .json file",
        explanation: "A file as Save tolerances… writes it (docs/requirements.md).",
        submit: "Take tolerances",
    },
    PathWords {
        kind: FormKind::WriteTolerances,
        title: "Save the tolerances",
        field: "Path to save the tolerances",
        hint: "path of a .json file",
        explanation: "A file of their own, for other studies and for gdcm requirements --tolerances.",
        submit: "Save tolerances",
    },
    PathWords {
        kind: FormKind::ExportAs,
        title: "Export as…",
        field: "Path of the export",
        hint: "path of the file",
        explanation: "State-space may be .mat, .json or .npz. gdcm export has more choices.",
        submit: "Export file",
    },
];

/// Draws a form that asks for a path, and in some forms for a choice; draws nothing if the form
/// only asks whether to overwrite.
fn path_ui(form: &mut Form<'_, '_>, kind: FormKind, state: &mut State) {
    let Some(words) = PATHS.iter().find(|words| words.kind == kind) else {
        return;
    };
    let waits = kind == FormKind::ExportAs && state.results.is_behind();
    let forms = &mut state.forms;
    let title = match (kind, &forms.table, forms.figure) {
        (FormKind::SaveTable, Some(table), _) => {
            format!("{} \u{201c}{}\u{201d}", words.title, table.title)
        }
        (FormKind::SaveFigure, _, Some(view)) => format!("{} of {}", words.title, view.name()),
        _ => words.title.to_owned(),
    };
    form.title(&title);
    let mut path = std::mem::take(forms.typed_in(kind));
    let entered = form.text_ui(words.field, &mut path, words.hint);
    let before = forms.export_format;
    match kind {
        FormKind::SaveFigure => {
            form.choices_ui(
                &mut forms.figure_width,
                ColumnWidth::BOTH.map(|width| (width, width.words())),
            );
        }
        FormKind::ExportAs => {
            form.choices_ui(
                &mut forms.export_format,
                EXPORTERS.into_iter().map(|of| (of, of.words)),
            );
        }
        _ => {}
    }
    // The extension follows the format until the name is edited.
    if let Some(stem) = path
        .strip_suffix(&format!(".{}", before.extension))
        .filter(|_| kind == FormKind::ExportAs)
    {
        path = format!("{stem}.{}", forms.export_format.extension);
    }
    if kind == FormKind::ExportAs {
        let request = ExportRequest {
            format: state.forms.export_format,
            ..ExportRequest::default()
        };
        contents_ui(form, state, |analysis| export_contents(analysis, &request));
    }
    let forms = &mut state.forms;
    let lost = forms
        .lost_dataset
        .as_ref()
        .filter(|_| kind == FormKind::FindDataset);
    let explanation = lost.map_or(words.explanation, |(_, reason)| reason);
    if !explanation.is_empty() {
        form.explain(explanation);
        form.ui.add_space(4.0);
    }
    form.line(|form| {
        let command = path_command(kind, forms, path.trim().into());
        form.submit_ui(words.submit, !path.trim().is_empty(), entered, command);
        form.cancel_ui(waits);
    });
    *forms.typed_in(kind) = path;
}

/// Draws the planned contents of an exported file and its omissions; nothing before there are
/// results.
fn contents_ui(
    form: &mut Form<'_, '_>,
    state: &State,
    contents: impl Fn(&Analysis) -> ExportContents,
) {
    let Some(analysis) = state.analysis() else {
        return;
    };
    let contents = contents(analysis);
    form.ui.add_space(4.0);
    form.explain(&format!("Contains: {}.", contents.words()));
    for words in contents.left_out_words(&analysis.study.dataset) {
        form.ui
            .add(Label::new(form.palette.small_warning(format!("Left out: {words}"))).wrap());
    }
}

/// Returns the command of a form with its path.
fn path_command(kind: FormKind, forms: &Forms, path: PathBuf) -> Option<Command> {
    Some(match kind {
        FormKind::Open => Command::File(FileCommand::Open(path)),
        FormKind::FindDataset => Command::File(FileCommand::OpenStudyOf(
            forms.lost_dataset.as_ref()?.0.clone(),
            path,
        )),
        FormKind::Save => Command::File(FileCommand::SaveStudyAs(path)),
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
        FormKind::ExportAs => Command::Output(OutputCommand::ExportAs(forms.export_format, path)),
        _ => return None,
    })
}

fn export_ui(form: &mut Form<'_, '_>, state: &mut State) {
    form.title("Export corrections");
    form.explain("Writes corrections.json, corrections.csv and assessment.csv into a folder.");
    contents_ui(form, state, ExportContents::of_results);
    let conditions = state.dataset().conditions().iter();
    let names: Vec<(ConditionId, String)> = conditions
        .map(|condition| (condition.id(), condition.flight_state().name.clone()))
        .collect();
    let waits = state.results.is_behind();
    let exported = &mut state.forms.exported;
    conditions_ui(form.ui, exported, &names);
    form.ui.add_space(4.0);
    let is_any = !exported.is_empty();
    let folder = state.forms.typed_in(FormKind::Export);
    let entered = form.text_ui(
        "Export folder",
        folder,
        "folder; it is made where it does not exist",
    );
    let ready = is_any && !folder.trim().is_empty();
    form.line(|form| {
        form.submit_ui(
            "Export",
            ready,
            entered,
            Some(Command::Output(OutputCommand::Export)),
        );
        form.button_ui("Choose folder…", false, OutputCommand::AskExportFolder);
        form.cancel_ui(waits);
    });
}

fn conditions_ui(
    ui: &mut Ui,
    exported: &mut BTreeSet<ConditionId>,
    names: &[(ConditionId, String)],
) {
    ui.horizontal(|ui| {
        if ui.small_button("All conditions").clicked() {
            exported.extend(names.iter().map(|(id, _)| *id));
        }
        if ui.small_button("No conditions").clicked() {
            exported.clear();
        }
    });
    ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
        for (id, name) in names {
            let mut chosen = exported.contains(id);
            let response = ui.checkbox(&mut chosen, format!("{id}   {name}"));
            let response = named_switch(
                response,
                Role::CheckBox,
                chosen,
                format!("Export condition {id}"),
            );
            if response.changed() && !exported.remove(id) {
                exported.insert(*id);
            }
        }
    });
}

fn shortcuts_ui(form: &mut Form<'_, '_>, state: &State) {
    form.title("Keys and gestures");
    keys_page_ui(form.ui, state, form.palette);
    form.button_ui("Close", true, FormCommand::ShowForm(None));
}

fn about_ui(form: &mut Form<'_, '_>) {
    form.title(concat!("gdcm ", env!("CARGO_PKG_VERSION")));
    form.ui.label(
        "The Gain-Delay Correction Method: one gain and one delay for each input and output channel, so that a physics-based \
         helicopter model matches flight and holds the important responses exactly.",
    );
    form.explain("The embedded example is simulated; nothing in it comes from a real aircraft.");
    form.explain("MIT OR Apache-2.0");
    form.button_ui("Close", true, FormCommand::ShowForm(None));
}

/// Asks whether to overwrite files; Cancel returns to the form.
fn overwrite_ui(form: &mut Form<'_, '_>, kind: FormKind, existing: &[String]) {
    form.title(if existing.len() == 1 {
        "This file exists already"
    } else {
        "These files exist already"
    });
    for path in existing {
        form.ui.label(path);
    }
    form.ui.add_space(4.0);
    form.line(|form| {
        form.button_ui("Overwrite", false, FormCommand::Overwrite);
        // Enter must not lose anything.
        form.button_ui("Cancel", true, FormCommand::ShowForm(Some(kind)));
    });
}

fn unsaved_ui(form: &mut Form<'_, '_>) {
    form.title("There are decisions that are not saved");
    form.ui.label("Going on loses the rejected models, the chosen representatives and the settings of this study.");
    form.ui.add_space(4.0);
    form.line(|form| {
        form.button_ui("Save study first", true, FormCommand::SaveAndGoOn);
        form.button_ui("Don't save", false, FormCommand::DiscardAndGoOn);
        form.cancel_ui(false);
    });
}

fn differences_ui(form: &mut Form<'_, '_>, state: &State) {
    form.title("The dataset is not the one the study was made with");
    form.explain("Every decision that still applies was kept. What is different:");
    let palette = form.palette;
    ScrollArea::vertical()
        .max_height(300.0)
        .show(form.ui, |ui| {
            for difference in &state.differences {
                let not_applied = matches!(difference, Difference::NotApplied { .. });
                let color = if not_applied {
                    palette.warning
                } else {
                    palette.text
                };
                ui.label(
                    RichText::new(format!("• {}", dataset_difference_text(difference)))
                        .color(color),
                );
            }
        });
    form.ui.add_space(4.0);
    let lines: Vec<String> = state
        .differences
        .iter()
        .map(dataset_difference_text)
        .collect();
    form.line(|form| {
        form.button_ui("Go on", true, FormCommand::ShowForm(None));
        form.button_ui(
            "Copy the list",
            false,
            OutputCommand::CopyText(lines.join("\n")),
        );
    });
}

/// Draws the form for the reason of a rejection; a kept model is rejected on submission.
fn reason_ui(form: &mut Form<'_, '_>, state: &mut State) {
    let Some(model) = state.forms.rejected_model.clone() else {
        return;
    };
    let is_rejected = state.study.is_rejected(&model);
    let (title, button) = if is_rejected {
        ("Why is it rejected?", "Keep the reason")
    } else {
        ("Reject with a reason", "Reject")
    };
    form.title(title);
    let words = format!(
        "{} model {} of condition {}",
        model.bundle, model.name, model.condition
    );
    form.explain(&words);
    let reason = state.forms.typed_in(FormKind::Reason);
    let entered = form.text_ui(
        "Reason of the rejection",
        reason,
        "in words; it is kept in the study and in the results",
    );
    let reason = reason.trim().to_owned();
    form.line(|form| {
        let edit = match is_rejected {
            true => Edit::SetReason(model, reason),
            false if reason.is_empty() => Edit::Reject(model),
            false => Edit::RejectBecause { model, reason },
        };
        form.submit_ui(
            button,
            true,
            entered,
            Some(Command::Form(FormCommand::DecideInForm(edit))),
        );
        form.cancel_ui(false);
    });
}

/// Most columns of a record that are listed.
const MOST_COLUMNS: usize = 60;

/// Draws the form that selects the record channels of a dataset, and its path.
fn record_dataset_ui(form: &mut Form<'_, '_>, wanted: &mut WantedDataset) {
    form.title("A dataset of these records");
    form.explain(
        "With it, models are identified before there is a physics model. Channels are separated by commas; unit and column \
         where the file does not say them: q [rad/s]=gyro_y, or =#3 for the third column.",
    );
    form.ui.add_space(4.0);
    let mut entered = false;
    form.line(|form| {
        form.labelled("inputs");
        let hint = "LON, LAT, or M [N m]=moment";
        entered |= form.text_ui("Inputs of the dataset", &mut wanted.inputs, hint);
    });
    let texts = [
        (
            "outputs",
            "Outputs of the dataset",
            &mut wanted.outputs,
            "P, Q, or q [rad/s]=gyro_y",
        ),
        (
            "file",
            "Path of the dataset of records",
            &mut wanted.path,
            "path of a .json.gz file",
        ),
    ];
    for (label, name, text, hint) in texts {
        form.line(|form| {
            form.labelled(label);
            let width = form.ui.available_width() - 8.0;
            let field = text_field_ui(form.ui, name, text, hint, width);
            entered |= is_entered(form.ui, &field);
        });
    }
    form.line(|form| {
        form.labelled("band");
        let names = [
            "Lower end of the band to identify",
            "Upper end of the band to identify",
        ];
        for (name, end) in names.iter().zip(&mut wanted.band) {
            text_field_ui(form.ui, name, end, "rad/s", 60.0);
        }
        form.explain("rad/s");
    });
    let columns = wanted
        .columns
        .iter()
        .take(MOST_COLUMNS)
        .cloned()
        .collect::<Vec<_>>()
        .join(", ");
    let more = wanted.columns.len().saturating_sub(MOST_COLUMNS);
    let more = if more > 0 {
        format!(", and {more} more")
    } else {
        String::new()
    };
    ScrollArea::vertical()
        .id_salt("columns of the records")
        .max_height(96.0)
        .show(form.ui, |ui| {
            ui.add(Label::new(form.palette.small(format!("columns: {columns}{more}"))).wrap());
        });
    for problem in &wanted.problems {
        form.ui
            .add(Label::new(form.palette.small_warning(problem)).wrap());
    }
    let is_ready = [&wanted.inputs, &wanted.outputs, &wanted.path]
        .iter()
        .all(|text| !text.trim().is_empty());
    form.line(|form| {
        form.submit_ui(
            "Make the dataset",
            is_ready,
            entered,
            Some(RecordsCommand::MakeDataset.into()),
        );
        form.cancel_ui(false);
    });
}

/// Form being drawn.
struct Form<'a, 'c> {
    ui: &'a mut Ui,
    /// Whether this is its first frame.
    opens: bool,
    palette: &'a Palette,
    commands: &'c mut Vec<Command>,
}

impl Form<'_, '_> {
    fn title(&mut self, text: &str) {
        self.ui.label(RichText::new(text).strong().size(15.0));
        self.ui.add_space(4.0);
    }

    /// Draws an explanation above the fields.
    fn explain(&mut self, text: &str) {
        self.ui.label(self.palette.dim(text));
    }

    fn choices_ui<T: PartialEq>(
        &mut self,
        chosen: &mut T,
        choices: impl IntoIterator<Item = (T, &'static str)>,
    ) {
        for (value, text) in choices {
            self.ui.radio_value(chosen, value, text);
        }
    }

    /// Draws the label in front of a field.
    fn labelled(&mut self, text: &str) {
        let size = vec2(56.0, self.ui.spacing().interact_size.y);
        self.ui
            .allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
                ui.set_min_width(size.x);
                ui.label(self.palette.dim(text));
            });
    }

    /// Draws the button that closes the form; its action may have to wait for the newest results.
    fn cancel_ui(&mut self, waits: bool) {
        self.button_ui("Cancel", false, FormCommand::ShowForm(None));
        if waits {
            self.explain("waits for the newest results");
        }
    }

    /// Draws the text field of the form; returns whether Enter was pressed in it.
    fn text_ui(&mut self, name: &str, text: &mut String, hint: &str) -> bool {
        let shown = TextEdit::singleline(text)
            .hint_text(hint)
            .desired_width(f32::INFINITY)
            .show(self.ui);
        let response = shown.response.response;
        name_text_field(&response, name, text);
        if self.opens {
            // Typing replaces the initial text.
            let mut edited = shown.state;
            let all = CCursorRange::two(CCursor::new(0), CCursor::new(text.chars().count()));
            edited.cursor.set_char_range(Some(all));
            edited.store(self.ui.ctx(), response.id);
            response.request_focus();
        }
        is_entered(self.ui, &response)
    }

    /// Draws the submit button, which Enter also presses; further buttons follow on the same line.
    fn submit_ui(&mut self, text: &str, is_ready: bool, entered: bool, command: Option<Command>) {
        let clicked = self.ui.add_enabled(is_ready, Button::new(text)).clicked();
        self.commands
            .extend(command.filter(|_| clicked || (entered && is_ready)));
    }

    /// Draws a button; the first button of a form without a text field has the focus when it opens.
    fn button_ui(&mut self, text: &str, is_first: bool, command: impl Into<Command>) {
        let response = self.ui.button(text);
        if is_first && self.opens {
            response.request_focus();
        }
        if response.clicked() {
            self.commands.push(command.into());
        }
    }

    /// Lays out the content in a single line.
    fn line(&mut self, add: impl FnOnce(&mut Form<'_, '_>)) {
        let opens = self.opens;
        let palette = self.palette;
        let commands = &mut *self.commands;
        self.ui.horizontal(|ui| {
            add(&mut Form {
                ui,
                opens,
                palette,
                commands,
            })
        });
    }
}
