//! The forms in front of the window: paths to open and to save, what to export, questions, help.

use egui::text::{CCursor, CCursorRange};
use std::path::PathBuf;

use egui::{Button, Context, Id, Modal, RichText, Role, ScrollArea, TextEdit, Ui};

use gdcm_core::dataset::ConditionId;
use gdcm_core::study::{Difference, Edit};
use gdcm_files::ExportFormat;
use gdcm_files::figure::ColumnWidth;

use super::{
    Command, ExportAsForm, ExportForm, FigureForm, FormKind, Palette, State, command_palette_ui, is_entered,
    keys_page_ui, name_text_field, named_switch,
};

/// Shows the form that is asked for, if any. Its field has the focus when it opens; Enter submits it; Escape and a click outside
/// close it.
pub fn forms_ui(ctx: &Context, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(kind) = state.forms.shown else {
        state.forms.drawn = None;
        return;
    };
    let asks_to_overwrite = !state.forms.existing.is_empty();
    let opens = state.forms.drawn.replace((kind, asks_to_overwrite)) != Some((kind, asks_to_overwrite));
    let modal = Modal::new(Id::unique("form")).show(ctx, |ui| {
        ui.set_width(460.0);
        let form = &mut Form { ui, opens, palette, commands };
        match kind {
            _ if asks_to_overwrite => overwrite_ui(form, kind, &state.forms.existing),
            FormKind::Open => form.path_ui(&OPEN, &mut state.forms.open_path, Command::Open),
            FormKind::FindDataset => find_dataset_ui(form, state),
            FormKind::Save => form.path_ui(&SAVE, &mut state.forms.save_path, Command::SaveStudyAs),
            FormKind::Export => export_ui(form, state),
            FormKind::ExportAs => export_as_ui(form, state),
            FormKind::Unsaved => unsaved_ui(form),
            FormKind::Differences => differences_ui(form, state),
            FormKind::Shortcuts => shortcuts_ui(form, state),
            FormKind::Palette => command_palette_ui(form.ui, state, opens, palette, form.commands),
            FormKind::SaveTable => save_table_ui(form, state),
            // It only asks whether to overwrite.
            FormKind::Models => {}
            FormKind::SaveFigure => save_figure_ui(form, state),
            FormKind::Report => form.path_ui(&REPORT, &mut state.forms.report_path, Command::WriteReport),
            FormKind::Reason => reason_ui(form, state),
            FormKind::About => about_ui(form),
        }
    });
    if modal.should_close() {
        commands.push(Command::ShowForm(None));
    }
}

/// The words of a form that asks for a path.
struct PathWords<'a> {
    title: &'a str,
    /// Accessible name of the field.
    field: &'a str,
    /// What stands in the field while it is empty.
    hint: &'a str,
    /// What is said below the field; nothing where it is empty.
    explanation: &'a str,
    /// What the button says.
    submit: &'a str,
    /// Whether what is written waits for the newest results.
    waits: bool,
}

impl<'a> PathWords<'a> {
    const fn new(title: &'a str, field: &'a str, hint: &'a str, explanation: &'a str, submit: &'a str) -> Self {
        Self { title, field, hint, explanation, submit, waits: false }
    }
}

const OPEN: PathWords<'_> = PathWords::new(
    "Open a dataset or a study",
    "Path to open",
    "path of a .json, .json.gz or .gdcm-study.json file",
    "",
    "Open file",
);
const FIND_DATASET: PathWords<'_> = PathWords::new(
    "Where is the dataset of this study?",
    "Path of the dataset",
    "path of a .json or .json.gz file",
    "",
    "Open with this dataset",
);
const SAVE: PathWords<'_> =
    PathWords::new("Save the study", "Path to save", "path of a .gdcm-study.json file", "", "Save file");
const SAVE_TABLE: PathWords<'_> =
    PathWords::new("Save the table", "Path of the table", "path of a .csv file", "", "Save table");
const SAVE_FIGURE: PathWords<'_> = PathWords::new(
    "Save the figure",
    "Path of the figure",
    "path of a .svg, .png, .pdf or .csv file",
    "On white paper, whatever the theme. The end of the name says the format; CSV holds the numbers.",
    "Save figure",
);
const REPORT: PathWords<'_> = PathWords::new(
    "Write the report",
    "Path of the report",
    "path of a .html file",
    "All that was done and found as one page with every plot, to read in a browser and to print.",
    "Write report",
);
const EXPORT_AS: PathWords<'_> = PathWords::new(
    "Export as…",
    "Path of the export",
    "path of the file",
    "State-space may be .mat, .json or .npz. gdcm export has more choices.",
    "Export file",
);

fn find_dataset_ui(form: &mut Form<'_, '_>, state: &mut State) {
    let Some((study, reason)) = &state.forms.lost_dataset else { return };
    let words = PathWords { explanation: reason, ..FIND_DATASET };
    form.path_ui(&words, &mut state.forms.dataset_path, |dataset| Command::OpenStudyOf(study.clone(), dataset));
}

fn save_table_ui(form: &mut Form<'_, '_>, state: &mut State) {
    let Some(table) = state.forms.table.clone() else { return };
    let title = format!("Save the table \u{201c}{}\u{201d}", table.title);
    let words = PathWords { title: &title, ..SAVE_TABLE };
    form.path_ui(&words, &mut state.forms.table_path, |path| Command::SaveTable(table, path));
}

fn save_figure_ui(form: &mut Form<'_, '_>, state: &mut State) {
    let FigureForm { view: Some(view), path, width } = &mut state.forms.figure else { return };
    let view = *view;
    let title = format!("Save the figure of {}", view.name());
    let widths = ColumnWidth::BOTH.map(|width| (width, width.words()));
    let words = PathWords { title: &title, ..SAVE_FIGURE };
    form.path_and_choice_ui(&words, path, (width, &widths), |path, width| Command::SaveFigure(view, width, path));
}

fn export_as_ui(form: &mut Form<'_, '_>, state: &mut State) {
    let words = PathWords { waits: state.results.is_behind(), ..EXPORT_AS };
    let ExportAsForm { format, path } = &mut state.forms.export_as;
    let before = *format;
    let formats: Vec<_> = ExportFormat::all().map(|format| (format, format.about().words)).collect();
    form.path_and_choice_ui(&words, path, (format, &formats), |path, format| Command::ExportAs(format, path));
    // The end of the name goes with the format, as long as nobody has typed another.
    if let Some(stem) = path.strip_suffix(&format!(".{}", before.about().extension)) {
        *path = format!("{stem}.{}", format.about().extension);
    }
}

fn export_ui(form: &mut Form<'_, '_>, state: &mut State) {
    form.title("Export corrections");
    form.explain("Writes corrections.json, corrections.csv and assessment.csv into a folder.");
    let conditions = state.dataset().conditions().iter();
    let names: Vec<(ConditionId, String)> =
        conditions.map(|condition| (condition.id(), condition.flight_state().name.clone())).collect();
    let waits = state.results.is_behind();
    let export = &mut state.forms.export;
    conditions_ui(form.ui, export, &names);
    form.ui.add_space(4.0);
    let entered = form.text_ui("Export folder", &mut export.folder, "folder; it is made where it does not exist");
    let ready = !export.chosen.is_empty() && !export.folder.trim().is_empty();
    form.line(|form| {
        form.submit_ui("Export", ready, entered, || Command::Export);
        form.button_ui("Choose folder…", false, Command::AskExportFolder);
        form.cancel_ui(waits);
    });
}

fn conditions_ui(ui: &mut Ui, form: &mut ExportForm, names: &[(ConditionId, String)]) {
    ui.horizontal(|ui| {
        if ui.small_button("All conditions").clicked() {
            form.chosen.extend(names.iter().map(|(id, _)| *id));
        }
        if ui.small_button("No conditions").clicked() {
            form.chosen.clear();
        }
    });
    ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
        for (id, name) in names {
            let mut chosen = form.chosen.contains(id);
            let response = ui.checkbox(&mut chosen, format!("{id}   {name}"));
            let response = named_switch(response, Role::CheckBox, chosen, format!("Export condition {id}"));
            if response.changed() && chosen {
                form.chosen.insert(*id);
            } else if response.changed() {
                form.chosen.remove(id);
            }
        }
    });
}

fn shortcuts_ui(form: &mut Form<'_, '_>, state: &State) {
    form.title("Keys and gestures");
    keys_page_ui(form.ui, state, form.palette);
    form.button_ui("Close", true, Command::ShowForm(None));
}

fn about_ui(form: &mut Form<'_, '_>) {
    form.title(concat!("gdcm ", env!("CARGO_PKG_VERSION")));
    form.ui.label(
        "The Gain-Delay Correction Method: one gain and one delay for each input and output channel, so that a physics-based \
         helicopter model matches flight and holds the important responses exactly.",
    );
    form.explain("The embedded example is simulated; nothing in it comes from a real aircraft.");
    form.explain("MIT OR Apache-2.0");
    form.button_ui("Close", true, Command::ShowForm(None));
}

/// Asks whether to overwrite files; a cancel goes back to the form that would.
fn overwrite_ui(form: &mut Form<'_, '_>, kind: FormKind, existing: &[String]) {
    form.title(if existing.len() == 1 { "This file exists already" } else { "These files exist already" });
    for path in existing {
        form.ui.label(path);
    }
    form.ui.add_space(4.0);
    form.line(|form| {
        form.button_ui("Overwrite", false, Command::Overwrite);
        // Enter loses nothing.
        form.button_ui("Cancel", true, Command::ShowForm(Some(kind)));
    });
}

fn unsaved_ui(form: &mut Form<'_, '_>) {
    form.title("There are decisions that are not saved");
    form.ui.label("Going on loses the rejected models, the chosen representatives and the settings of this study.");
    form.ui.add_space(4.0);
    form.line(|form| {
        form.button_ui("Save study first", true, Command::SaveAndGoOn);
        form.button_ui("Don't save", false, Command::DiscardAndGoOn);
        form.cancel_ui(false);
    });
}

fn differences_ui(form: &mut Form<'_, '_>, state: &State) {
    form.title("The dataset is not the one the study was made with");
    form.explain("Every decision that still applies was kept. What is different:");
    let palette = form.palette;
    ScrollArea::vertical().max_height(300.0).show(form.ui, |ui| {
        for difference in &state.differences {
            let not_applied = matches!(difference, Difference::NotApplied { .. });
            let color = if not_applied { palette.warning } else { palette.text };
            ui.label(RichText::new(format!("• {difference}")).color(color));
        }
    });
    form.ui.add_space(4.0);
    let lines: Vec<String> = state.differences.iter().map(|difference| difference.to_string()).collect();
    form.line(|form| {
        form.button_ui("Go on", true, Command::ShowForm(None));
        form.button_ui("Copy the list", false, Command::CopyText(lines.join("\n")));
    });
}

/// Why a model is rejected; one that is kept is rejected with it.
fn reason_ui(form: &mut Form<'_, '_>, state: &mut State) {
    let Some(model) = state.forms.rejected_model.clone() else { return };
    let is_rejected = state.study.is_rejected(&model);
    let (title, button) =
        if is_rejected { ("Why is it rejected?", "Keep the reason") } else { ("Reject with a reason", "Reject") };
    form.title(title);
    let words = format!("{} model {} of condition {}", model.bundle, model.name, model.condition);
    form.explain(&words);
    let reason = &mut state.forms.reason;
    let entered =
        form.text_ui("Reason of the rejection", reason, "in words; it is kept in the study and in the results");
    let reason = reason.trim().to_owned();
    form.line(|form| {
        let edit = || match is_rejected {
            true => Edit::SetReason(model, reason),
            false if reason.is_empty() => Edit::Reject(model),
            false => Edit::RejectBecause { model, reason },
        };
        form.submit_ui(button, true, entered, || Command::DecideInForm(edit()));
        form.cancel_ui(false);
    });
}

/// A form being drawn.
struct Form<'a, 'c> {
    ui: &'a mut Ui,
    /// Whether this is the first frame that shows it.
    opens: bool,
    palette: &'a Palette,
    commands: &'c mut Vec<Command>,
}

impl Form<'_, '_> {
    fn title(&mut self, text: &str) {
        self.ui.label(RichText::new(text).strong().size(15.0));
        self.ui.add_space(4.0);
    }

    /// What has to be known before the form is filled in.
    fn explain(&mut self, text: &str) {
        self.ui.label(self.palette.dim(text));
    }

    /// A form that asks for a path, and gives a command with it.
    fn path_ui(&mut self, words: &PathWords<'_>, path: &mut String, command: impl FnOnce(PathBuf) -> Command) {
        self.path_and_choice_ui(words, path, (&mut (), &[]), |path, ()| command(path));
    }

    /// A form that asks for a path and for one of some choices.
    fn path_and_choice_ui<T: Copy + PartialEq>(
        &mut self,
        words: &PathWords<'_>,
        path: &mut String,
        (choice, choices): (&mut T, &[(T, &str)]),
        command: impl FnOnce(PathBuf, T) -> Command,
    ) {
        self.title(words.title);
        let entered = self.text_ui(words.field, path, words.hint);
        for (value, text) in choices {
            self.ui.radio_value(choice, *value, *text);
        }
        if !words.explanation.is_empty() {
            self.explain(words.explanation);
            self.ui.add_space(4.0);
        }
        let (path, choice) = (path.trim(), *choice);
        self.line(|form| {
            form.submit_ui(words.submit, !path.is_empty(), entered, || command(path.into(), choice));
            form.cancel_ui(words.waits);
        });
    }

    /// The button that closes the form; what it asks for may wait for the newest results.
    fn cancel_ui(&mut self, waits: bool) {
        self.button_ui("Cancel", false, Command::ShowForm(None));
        if waits {
            self.explain("waits for the newest results");
        }
    }

    /// The text field of the form; whether the Enter key was pressed in it.
    fn text_ui(&mut self, name: &str, text: &mut String, hint: &str) -> bool {
        let shown = TextEdit::singleline(text).hint_text(hint).desired_width(f32::INFINITY).show(self.ui);
        let response = shown.response.response;
        name_text_field(&response, name, text);
        if self.opens {
            // What stands there is replaced by what is typed.
            let mut edited = shown.state;
            let all = CCursorRange::two(CCursor::new(0), CCursor::new(text.chars().count()));
            edited.cursor.set_char_range(Some(all));
            edited.store(self.ui.ctx(), response.id);
            response.request_focus();
        }
        is_entered(self.ui, &response)
    }

    /// The button that submits the form, which Enter does too; others follow on the same line.
    fn submit_ui(&mut self, text: &str, is_ready: bool, entered: bool, command: impl FnOnce() -> Command) {
        let clicked = self.ui.add_enabled(is_ready, Button::new(text)).clicked();
        if clicked || (entered && is_ready) {
            self.commands.push(command());
        }
    }

    /// A button; the first of a form without a text field has the focus when it opens.
    fn button_ui(&mut self, text: &str, is_first: bool, command: Command) {
        let response = self.ui.button(text);
        if is_first && self.opens {
            response.request_focus();
        }
        if response.clicked() {
            self.commands.push(command);
        }
    }

    /// What follows stands on one line.
    fn line(&mut self, add: impl FnOnce(&mut Form<'_, '_>)) {
        let (opens, palette, commands) = (self.opens, self.palette, &mut *self.commands);
        self.ui.horizontal(|ui| add(&mut Form { ui, opens, palette, commands }));
    }
}
