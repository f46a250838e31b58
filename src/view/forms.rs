//! The forms in front of the window: paths, export, questions, help.

use egui::{Button, Context, Grid, Id, Key, Modal, RichText, Role, ScrollArea, TextEdit, Ui, WidgetInfo};

use crate::dataset::ConditionId;
use crate::study::Difference;

use super::command::{Command, FormKind};
use super::palette::Palette;
use super::state::{ExportForm, State};

/// Shows the form that is asked for, if any. Escape and a click outside close it.
pub fn forms_ui(ctx: &Context, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(kind) = state.forms.shown else { return };
    let modal = Modal::new(Id::unique("form")).show(ctx, |ui| {
        ui.set_width(460.0);
        match kind {
            FormKind::Save | FormKind::Export if !state.forms.existing.is_empty() => {
                overwrite_ui(ui, kind, &state.forms.existing, commands);
            }
            FormKind::Open => open_ui(ui, &mut state.forms.open_path, commands),
            FormKind::FindDataset => find_dataset_ui(ui, state, palette, commands),
            FormKind::Save => save_ui(ui, &mut state.forms.save_path, commands),
            FormKind::Export => export_ui(ui, state, palette, commands),
            FormKind::Unsaved => unsaved_ui(ui, commands),
            FormKind::Differences => differences_ui(ui, state, palette, commands),
            FormKind::Shortcuts => shortcuts_ui(ui, palette),
            FormKind::About => about_ui(ui, palette),
        }
    });
    if modal.should_close() {
        commands.push(Command::ShowForm(None));
    }
}

fn title(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).strong().size(15.0));
    ui.add_space(4.0);
}

/// A text field with an accessible name; whether the Enter key ended it.
fn path_ui(ui: &mut Ui, name: &str, path: &mut String, hint: &str) -> bool {
    let field = TextEdit::singleline(path).hint_text(hint).desired_width(f32::INFINITY);
    let response = ui.add(field);
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::TextInput, true, name);
        info.current_text_value = Some(path.clone());
        info
    });
    response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
}

fn open_ui(ui: &mut Ui, path: &mut String, commands: &mut Vec<Command>) {
    title(ui, "Open a dataset or a study");
    let entered = path_ui(ui, "Path to open", path, "path of a .json, .json.gz or .gdcm-study.json file");
    ui.horizontal(|ui| {
        let open = ui.add_enabled(!path.trim().is_empty(), Button::new("Open file"));
        if open.clicked() || (entered && !path.trim().is_empty()) {
            commands.push(Command::Open(path.trim().into()));
        }
        if ui.button("Cancel").clicked() {
            commands.push(Command::ShowForm(None));
        }
    });
}

fn find_dataset_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some((study, reason)) = &state.forms.lost_dataset else { return };
    title(ui, "Where is the dataset of this study?");
    ui.label(RichText::new(reason).color(palette.dim_text));
    let path = &mut state.forms.dataset_path;
    let entered = path_ui(ui, "Path of the dataset", path, "path of a .json or .json.gz file");
    let path = path.trim();
    ui.horizontal(|ui| {
        let open = ui.add_enabled(!path.is_empty(), Button::new("Open with this dataset"));
        if open.clicked() || (entered && !path.is_empty()) {
            commands.push(Command::OpenStudyOf(study.clone(), path.into()));
        }
        if ui.button("Cancel").clicked() {
            commands.push(Command::ShowForm(None));
        }
    });
}

fn save_ui(ui: &mut Ui, path: &mut String, commands: &mut Vec<Command>) {
    title(ui, "Save the study");
    let entered = path_ui(ui, "Path to save", path, "path of a .gdcm-study.json file");
    ui.horizontal(|ui| {
        let save = ui.add_enabled(!path.trim().is_empty(), Button::new("Save file"));
        if save.clicked() || (entered && !path.trim().is_empty()) {
            commands.push(Command::SaveStudyAs(path.trim().into()));
        }
        if ui.button("Cancel").clicked() {
            commands.push(Command::ShowForm(None));
        }
    });
}

fn export_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    title(ui, "Export corrections");
    let dim = |text: &str| RichText::new(text.to_owned()).color(palette.dim_text);
    ui.label(dim("Writes corrections.json, corrections.csv and assessment.csv into a folder."));
    let names: Vec<(ConditionId, String)> = state
        .dataset()
        .conditions()
        .iter()
        .map(|condition| (condition.id(), condition.flight_state().name.clone()))
        .collect();
    let form = &mut state.forms.export;
    conditions_ui(ui, form, &names);
    ui.add_space(4.0);
    path_ui(ui, "Export folder", &mut form.folder, "folder; it is made where it does not exist");
    let ready = !form.chosen.is_empty() && !form.folder.trim().is_empty();
    ui.horizontal(|ui| {
        if ui.add_enabled(ready, Button::new("Export")).clicked() {
            commands.push(Command::Export);
        }
        if ui.button("Choose folder…").clicked() {
            commands.push(Command::AskExportFolder);
        }
        if ui.button("Cancel").clicked() {
            commands.push(Command::ShowForm(None));
        }
        if state.results.is_behind() {
            ui.label(dim("waits for the newest results"));
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

/// Asks whether to overwrite files; a cancel goes back to the form that would.
fn overwrite_ui(ui: &mut Ui, form: FormKind, existing: &[String], commands: &mut Vec<Command>) {
    title(ui, if existing.len() == 1 { "This file exists already" } else { "These files exist already" });
    for path in existing {
        ui.label(path);
    }
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        if ui.button("Overwrite").clicked() {
            commands.push(Command::Overwrite);
        }
        if ui.button("Cancel").clicked() {
            commands.push(Command::ShowForm(Some(form)));
        }
    });
}

fn unsaved_ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    title(ui, "There are decisions that are not saved");
    ui.label("Going on loses the rejected and pinned models and the settings of this study.");
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        if ui.button("Save study first").clicked() {
            commands.push(Command::SaveAndGoOn);
        }
        if ui.button("Lose them").clicked() {
            commands.push(Command::DiscardAndGoOn);
        }
        if ui.button("Cancel").clicked() {
            commands.push(Command::ShowForm(None));
        }
    });
}

fn differences_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    title(ui, "The dataset is not the one the study was made with");
    ui.label(RichText::new("Every decision that still applies was kept. What is different:").color(palette.dim_text));
    ScrollArea::vertical().max_height(300.0).show(ui, |ui| {
        for difference in &state.differences {
            let not_applied = matches!(difference, Difference::NotApplied { .. });
            let color = if not_applied { palette.warning } else { palette.text };
            ui.label(RichText::new(format!("• {difference}")).color(color));
        }
    });
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        if ui.button("Go on").clicked() {
            commands.push(Command::ShowForm(None));
        }
        if ui.button("Copy the list").clicked() {
            let lines: Vec<String> = state.differences.iter().map(|difference| difference.to_string()).collect();
            ui.ctx().copy_text(lines.join("\n"));
        }
    });
}

const KEYS: &[(&str, &str)] = &[
    ("Up, Down", "previous, next condition"),
    ("Left, Right", "previous, next response"),
    ("Space", "hold or free the response in focus"),
    ("Ctrl+R", "reject the suggested outliers of this condition"),
    ("Ctrl+Z, Ctrl+Shift+Z", "undo, redo"),
    ("Ctrl+O, Ctrl+S, Ctrl+E", "open, save the study, export"),
    ("F", "fit the plots"),
    ("click on a curve", "reject or restore its model"),
    ("Alt+click on a curve", "show it alone; again: show all"),
    ("drag, wheel", "move, zoom a plot"),
    ("drag with the secondary button", "zoom to a box"),
    ("double click in a plot", "fit it"),
    ("drag an end of the band", "move the band of comparison"),
];

fn shortcuts_ui(ui: &mut Ui, palette: &Palette) {
    title(ui, "Keys and gestures");
    Grid::new("keys").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
        for (keys, meaning) in KEYS {
            ui.label(RichText::new(*keys).strong());
            ui.label(RichText::new(*meaning).color(palette.dim_text));
            ui.end_row();
        }
    });
}

fn about_ui(ui: &mut Ui, palette: &Palette) {
    title(ui, concat!("gdcm ", env!("CARGO_PKG_VERSION")));
    ui.label(
        "The Gain-Delay Correction Method: one gain and one delay for each input and output channel, so that a physics-based \
         helicopter model matches flight and holds the important responses exactly.",
    );
    ui.label(
        RichText::new("The embedded example is simulated; nothing in it comes from a real aircraft.")
            .color(palette.dim_text),
    );
    ui.label(RichText::new("MIT OR Apache-2.0").color(palette.dim_text));
}
