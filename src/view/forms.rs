//! The forms in front of the window: paths to open and to save, what to export, questions, help.

use egui::text::{CCursor, CCursorRange};
use egui::{Button, Context, Id, Key, Modal, RichText, Role, ScrollArea, TextEdit, Ui, WidgetInfo};

use gdcm_core::dataset::ConditionId;
use gdcm_core::study::{Difference, Edit};
use gdcm_files::ExportFormat;
use gdcm_files::figure::ColumnWidth;

use super::command::{Command, FormKind};
use super::command_palette::command_palette_ui;
use super::help::keys_page_ui;
use super::palette::Palette;
use super::state::{ExportAsForm, ExportForm, FigureForm, State};

/// Shows the form that is asked for, if any. Its field has the focus when it opens; Enter submits it; Escape and a click outside
/// close it.
pub fn forms_ui(ctx: &Context, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(kind) = state.forms.shown else {
        state.forms.drawn = None;
        return;
    };
    let writes = [
        FormKind::Save,
        FormKind::Export,
        FormKind::ExportAs,
        FormKind::SaveTable,
        FormKind::SaveFigure,
        FormKind::Report,
        FormKind::Models,
    ];
    let asks_to_overwrite = writes.contains(&kind) && !state.forms.existing.is_empty();
    let opens = state.forms.drawn.replace((kind, asks_to_overwrite)) != Some((kind, asks_to_overwrite));
    let modal = Modal::new(Id::unique("form")).show(ctx, |ui| {
        ui.set_width(460.0);
        let form = &mut Form { ui, opens, commands };
        match kind {
            _ if asks_to_overwrite => overwrite_ui(form, kind, &state.forms.existing),
            FormKind::Open => open_ui(form, &mut state.forms.open_path),
            FormKind::FindDataset => find_dataset_ui(form, state, palette),
            FormKind::Save => save_ui(form, &mut state.forms.save_path),
            FormKind::Export => export_ui(form, state, palette),
            FormKind::ExportAs => export_as_ui(form, state, palette),
            FormKind::Unsaved => unsaved_ui(form),
            FormKind::Differences => differences_ui(form, state, palette),
            FormKind::Shortcuts => shortcuts_ui(form, state, palette),
            FormKind::Palette => command_palette_ui(form.ui, state, opens, palette, form.commands),
            FormKind::SaveTable => save_table_ui(form, state),
            // It only asks whether to overwrite.
            FormKind::Models => {}
            FormKind::SaveFigure => save_figure_ui(form, state, palette),
            FormKind::Report => report_ui(form, &mut state.forms.report_path, palette),
            FormKind::Reason => reason_ui(form, state, palette),
            FormKind::About => about_ui(form, palette),
        }
    });
    if modal.should_close() {
        commands.push(Command::ShowForm(None));
    }
}

fn open_ui(form: &mut Form<'_, '_>, path: &mut String) {
    form.title("Open a dataset or a study");
    let entered = form.text_ui("Path to open", path, "path of a .json, .json.gz or .gdcm-study.json file");
    let path = path.trim();
    form.line(|form| {
        form.submit_ui("Open file", !path.is_empty(), entered, || Command::Open(path.into()));
        form.button_ui("Cancel", false, Command::ShowForm(None));
    });
}

fn find_dataset_ui(form: &mut Form<'_, '_>, state: &mut State, palette: &Palette) {
    let Some((study, reason)) = &state.forms.lost_dataset else { return };
    form.title("Where is the dataset of this study?");
    form.ui.label(RichText::new(reason).color(palette.dim_text));
    let path = &mut state.forms.dataset_path;
    let entered = form.text_ui("Path of the dataset", path, "path of a .json or .json.gz file");
    let path = path.trim();
    form.line(|form| {
        let open = || Command::OpenStudyOf(study.clone(), path.into());
        form.submit_ui("Open with this dataset", !path.is_empty(), entered, open);
        form.button_ui("Cancel", false, Command::ShowForm(None));
    });
}

fn save_ui(form: &mut Form<'_, '_>, path: &mut String) {
    form.title("Save the study");
    let entered = form.text_ui("Path to save", path, "path of a .gdcm-study.json file");
    let path = path.trim();
    form.line(|form| {
        form.submit_ui("Save file", !path.is_empty(), entered, || Command::SaveStudyAs(path.into()));
        form.button_ui("Cancel", false, Command::ShowForm(None));
    });
}

fn save_table_ui(form: &mut Form<'_, '_>, state: &mut State) {
    let Some(table) = state.forms.table.clone() else { return };
    form.title(&format!("Save the table \u{201c}{}\u{201d}", table.title));
    let path = &mut state.forms.table_path;
    let entered = form.text_ui("Path of the table", path, "path of a .csv file");
    let path = path.trim();
    form.line(|form| {
        form.submit_ui("Save table", !path.is_empty(), entered, || Command::SaveTable(table, path.into()));
        form.button_ui("Cancel", false, Command::ShowForm(None));
    });
}

fn save_figure_ui(form: &mut Form<'_, '_>, state: &mut State, palette: &Palette) {
    let FigureForm { view: Some(view), path, width } = &mut state.forms.figure else { return };
    let view = *view;
    form.title(&format!("Save the figure of {}", view.name()));
    let hint = "path of a .svg, .png, .pdf or .csv file";
    let entered = form.text_ui("Path of the figure", path, hint);
    for choice in ColumnWidth::BOTH {
        form.ui.radio_value(width, choice, choice.words());
    }
    let words = "On white paper, whatever the theme. The end of the name says the format; CSV holds the numbers.";
    form.ui.label(RichText::new(words).color(palette.dim_text));
    form.ui.add_space(4.0);
    let (path, width) = (path.trim(), *width);
    form.line(|form| {
        let save = || Command::SaveFigure(view, width, path.into());
        form.submit_ui("Save figure", !path.is_empty(), entered, save);
        form.button_ui("Cancel", false, Command::ShowForm(None));
    });
}

fn report_ui(form: &mut Form<'_, '_>, path: &mut String, palette: &Palette) {
    form.title("Write the report");
    let entered = form.text_ui("Path of the report", path, "path of a .html file");
    let words = "All that was done and found as one page with every plot, to read in a browser and to print.";
    form.ui.label(RichText::new(words).color(palette.dim_text));
    form.ui.add_space(4.0);
    let path = path.trim();
    form.line(|form| {
        form.submit_ui("Write report", !path.is_empty(), entered, || Command::WriteReport(path.into()));
        form.button_ui("Cancel", false, Command::ShowForm(None));
    });
}

fn export_ui(form: &mut Form<'_, '_>, state: &mut State, palette: &Palette) {
    form.title("Export corrections");
    let dim = |text: &str| RichText::new(text.to_owned()).color(palette.dim_text);
    form.ui.label(dim("Writes corrections.json, corrections.csv and assessment.csv into a folder."));
    let names: Vec<(ConditionId, String)> = state
        .dataset()
        .conditions()
        .iter()
        .map(|condition| (condition.id(), condition.flight_state().name.clone()))
        .collect();
    let is_behind = state.results.is_behind();
    let export = &mut state.forms.export;
    conditions_ui(form.ui, export, &names);
    form.ui.add_space(4.0);
    let entered = form.text_ui("Export folder", &mut export.folder, "folder; it is made where it does not exist");
    let ready = !export.chosen.is_empty() && !export.folder.trim().is_empty();
    form.line(|form| {
        form.submit_ui("Export", ready, entered, || Command::Export);
        form.button_ui("Choose folder…", false, Command::AskExportFolder);
        form.button_ui("Cancel", false, Command::ShowForm(None));
        if is_behind {
            form.ui.label(dim("waits for the newest results"));
        }
    });
}

fn export_as_ui(form: &mut Form<'_, '_>, state: &mut State, palette: &Palette) {
    form.title("Export as…");
    let is_behind = state.results.is_behind();
    let ExportAsForm { format, path } = &mut state.forms.export_as;
    let entered = form.text_ui("Path of the export", path, "path of the file");
    let before = *format;
    for choice in ExportFormat::all() {
        form.ui.radio_value(format, choice, choice.about().words);
    }
    // The end of the name goes with the format, as long as nobody has typed another.
    if let Some(stem) = path.strip_suffix(&format!(".{}", before.about().extension)) {
        *path = format!("{stem}.{}", format.about().extension);
    }
    let dim = |text: &str| RichText::new(text.to_owned()).color(palette.dim_text);
    form.ui.label(dim("State-space may be .mat, .json or .npz. gdcm export has more choices."));
    form.ui.add_space(4.0);
    let (format, path) = (*format, path.trim());
    form.line(|form| {
        form.submit_ui("Export file", !path.is_empty(), entered, || Command::ExportAs(format, path.into()));
        form.button_ui("Cancel", false, Command::ShowForm(None));
        if is_behind {
            form.ui.label(dim("waits for the newest results"));
        }
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
            response
                .widget_info(|| WidgetInfo::selected(Role::CheckBox, true, chosen, format!("Export condition {id}")));
            if response.changed() && chosen {
                form.chosen.insert(*id);
            } else if response.changed() {
                form.chosen.remove(id);
            }
        }
    });
}

fn shortcuts_ui(form: &mut Form<'_, '_>, state: &State, palette: &Palette) {
    form.title("Keys and gestures");
    keys_page_ui(form.ui, state, palette);
    form.button_ui("Close", true, Command::ShowForm(None));
}

fn about_ui(form: &mut Form<'_, '_>, palette: &Palette) {
    form.title(concat!("gdcm ", env!("CARGO_PKG_VERSION")));
    form.ui.label(
        "The Gain-Delay Correction Method: one gain and one delay for each input and output channel, so that a physics-based \
         helicopter model matches flight and holds the important responses exactly.",
    );
    form.ui.label(
        RichText::new("The embedded example is simulated; nothing in it comes from a real aircraft.")
            .color(palette.dim_text),
    );
    form.ui.label(RichText::new("MIT OR Apache-2.0").color(palette.dim_text));
    form.button_ui("Close", true, Command::ShowForm(None));
}

/// A form being drawn.
pub(super) struct Form<'a, 'c> {
    pub(super) ui: &'a mut Ui,
    /// Whether this is the first frame that shows it.
    pub(super) opens: bool,
    pub(super) commands: &'c mut Vec<Command>,
}

impl Form<'_, '_> {
    pub(super) fn title(&mut self, text: &str) {
        self.ui.label(RichText::new(text).strong().size(15.0));
        self.ui.add_space(4.0);
    }

    /// The text field of the form; whether the Enter key was pressed in it.
    pub(super) fn text_ui(&mut self, name: &str, text: &mut String, hint: &str) -> bool {
        let shown = TextEdit::singleline(text).hint_text(hint).desired_width(f32::INFINITY).show(self.ui);
        let response = shown.response.response;
        response.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::TextInput, true, name);
            info.current_text_value = Some(text.clone());
            info
        });
        if self.opens {
            // What stands there is replaced by what is typed.
            let mut edited = shown.state;
            let all = CCursorRange::two(CCursor::new(0), CCursor::new(text.chars().count()));
            edited.cursor.set_char_range(Some(all));
            edited.store(self.ui.ctx(), response.id);
            response.request_focus();
        }
        response.lost_focus() && self.ui.input(|input| input.key_pressed(Key::Enter))
    }

    /// The button that submits the form, which Enter does too; others follow on the same line.
    pub(super) fn submit_ui(&mut self, text: &str, is_ready: bool, entered: bool, command: impl FnOnce() -> Command) {
        let clicked = self.ui.add_enabled(is_ready, Button::new(text)).clicked();
        if clicked || (entered && is_ready) {
            self.commands.push(command());
        }
    }

    /// A button; the first of a form without a text field has the focus when it opens.
    pub(super) fn button_ui(&mut self, text: &str, is_first: bool, command: Command) {
        let response = self.ui.button(text);
        if is_first && self.opens {
            response.request_focus();
        }
        if response.clicked() {
            self.commands.push(command);
        }
    }

    /// What follows stands on one line.
    pub(super) fn line(&mut self, add: impl FnOnce(&mut Form<'_, '_>)) {
        let (opens, commands) = (self.opens, &mut *self.commands);
        self.ui.horizontal(|ui| add(&mut Form { ui, opens, commands }));
    }
}

/// Asks whether to overwrite files; a cancel goes back to the form that would.
pub(super) fn overwrite_ui(form: &mut Form<'_, '_>, kind: FormKind, existing: &[String]) {
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

pub(super) fn unsaved_ui(form: &mut Form<'_, '_>) {
    form.title("There are decisions that are not saved");
    form.ui.label("Going on loses the rejected and pinned models and the settings of this study.");
    form.ui.add_space(4.0);
    form.line(|form| {
        form.button_ui("Save study first", true, Command::SaveAndGoOn);
        form.button_ui("Lose them", false, Command::DiscardAndGoOn);
        form.button_ui("Cancel", false, Command::ShowForm(None));
    });
}

pub(super) fn differences_ui(form: &mut Form<'_, '_>, state: &State, palette: &Palette) {
    form.title("The dataset is not the one the study was made with");
    let words = "Every decision that still applies was kept. What is different:";
    form.ui.label(RichText::new(words).color(palette.dim_text));
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
pub(super) fn reason_ui(form: &mut Form<'_, '_>, state: &mut State, palette: &Palette) {
    let Some(model) = state.forms.rejected_model.clone() else { return };
    let is_rejected = state.study.is_rejected(&model);
    let (title, button) =
        if is_rejected { ("Why is it rejected?", "Keep the reason") } else { ("Reject with a reason", "Reject") };
    form.title(title);
    let words = format!("{} model {} of condition {}", model.bundle, model.name, model.condition);
    form.ui.label(RichText::new(words).color(palette.dim_text));
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
        form.button_ui("Cancel", false, Command::ShowForm(None));
    });
}
