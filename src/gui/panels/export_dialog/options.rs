//! Columns at the left of the export dialog: formats; what is exported, and where to.
//!
//! The breakpoints are the airspeeds of the exported lookup tables; the Padé order is that of the
//! approximation of delays in exported models.

use egui::{Button, DragValue, RichText, Role, ScrollArea, Sense, TextEdit, Ui, WidgetInfo, vec2};

use gdcm_io::export::export_set::CHECKSUMS;
use gdcm_io::export::{EXPORTERS, ExportFormat, FormatGroup};
use gdcm_method::correction::pade::HIGHEST_PADE_ORDER;
use gdcm_model::dataset::ConditionId;
use gdcm_study::decisions::export_choices::ExportChoices;

use super::labelled_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::panels::form_parts::Form;
use crate::gui::state::export_form::{ExportForm, REPORT, airspeeds_words};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::DropDown;
use crate::gui::widgets::controls::{Asks, named_switch};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium, small};
use crate::gui::widgets::panel_layout::in_line_ui;
use crate::gui::widgets::text_fields::{is_entered, name_text_field};

/// Height of a check box line \[pt\].
const ROW: f32 = 24.0;
/// Height of a group heading \[pt\].
const GROUP: f32 = 25.0;
/// Field width \[pt\].
const FIELD: f32 = 148.0;
/// Maximum height of the area with condition buttons \[pt\].
const CONDITIONS: f32 = 104.0;
/// Size of a condition button \[pt\].
const CHIP: [f32; 2] = [20.0, 22.0];

/// Draws the formats by purpose, each with its file extension.
pub(super) fn formats_ui(ui: &mut Ui, state: &mut State, palette: &Palette) {
    let form = &mut state.forms.export;
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        heading_ui(ui, "Formats", palette);
        for group in FormatGroup::ALL {
            group_heading_ui(ui, group.name(), palette);
            for format in EXPORTERS.iter().filter(|format| format.group == group) {
                format_ui(ui, form, FormatRow::from_format(format), palette);
            }
        }
        group_heading_ui(ui, "Document", palette);
        format_ui(ui, form, FormatRow::REPORT, palette);
        format_ui(ui, form, FormatRow::CHECKSUMS, palette);
    });
}

/// Texts on a format's check box.
struct FormatRow {
    /// Name among the choices.
    name: &'static str,
    title: &'static str,
    extension: &'static str,
}

impl FormatRow {
    const REPORT: Self = Self {
        name: REPORT,
        title: "Report",
        extension: "html",
    };
    const CHECKSUMS: Self = Self {
        name: CHECKSUMS,
        title: "Checksums",
        extension: CHECKSUMS,
    };

    fn from_format(format: &ExportFormat) -> Self {
        Self {
            name: format.name,
            title: format.title,
            extension: format.extension,
        }
    }
}

fn heading_ui(ui: &mut Ui, text: &str, palette: &Palette) {
    ui.label(
        RichText::new(text)
            .font(medium(BODY_SIZE))
            .color(palette.text),
    );
}

fn group_heading_ui(ui: &mut Ui, text: &str, palette: &Palette) {
    let (line, _) = ui.allocate_exact_size(vec2(ui.available_width(), GROUP), Sense::hover());
    let text_line = line.with_min_y(line.top() + 4.0);
    painted_text(ui, text_line, 0.0, text, body(), palette.dim_text);
}

/// Draws a format's check box, with the file extension at the right.
fn format_ui(ui: &mut Ui, form: &mut ExportForm, row: FormatRow, palette: &Palette) {
    let (line, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let extension = format!(".{}", row.extension);
    in_line_ui(ui, line, false, |ui| {
        let mut is_chosen = form.choices.formats.contains(row.name);
        let response = ui.checkbox(&mut is_chosen, row.title);
        let name = format!("Export {} {extension}", row.title);
        let response = named_switch(response, Role::CheckBox, is_chosen, name);
        if response.changed() {
            form.switch_format(row.name);
        }
    });
    painted_text(
        ui,
        line,
        AT_RIGHT_END,
        &extension,
        small(),
        palette.dim_text,
    );
}

/// Draws what is exported, and where to; Enter in a field exports.
pub(super) fn options_ui(
    ui: &mut Ui,
    state: &mut State,
    opens: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mut is_submitted = false;
    heading_ui(ui, "What", palette);
    conditions_ui(ui, state, palette);
    ui.add_space(4.0);
    correction_ui(ui, &mut state.forms.export, palette);
    model_ui(ui, state, palette);
    is_submitted |= breakpoints_ui(ui, state, palette);
    labelled_ui(ui, "Padé order", ROW + 4.0, palette, |ui| {
        let order = &mut state.forms.export.choices.pade_order;
        let field = DragValue::new(order)
            .range(1..=HIGHEST_PADE_ORDER)
            .speed(0.05);
        let response = ui.add_sized(vec2(48.0, ROW), field);
        let value = *order as f64;
        response.widget_info(|| {
            let mut info = WidgetInfo::drag_value(true, value);
            info.label = Some("Padé order".to_owned());
            info
        });
        response.on_hover_text("For the delays in corrected models");
    });
    ui.add_space(6.0);
    ui.separator();
    heading_ui(ui, "Where", palette);
    is_submitted |= folder_ui(ui, state, opens, palette, commands);
    is_submitted |= prefix_ui(ui, state, palette);
    existing_ui(ui, state, palette);
    if is_submitted {
        commands.push(OutputCommand::Export.into());
    }
}

/// Draws a button for each condition, and a button that chooses all or none.
fn conditions_ui(ui: &mut Ui, state: &mut State, palette: &Palette) {
    let dataset = std::sync::Arc::clone(&state.study.dataset);
    let form = &mut state.forms.export;
    let chosen = form.chosen(&dataset);
    let count = dataset.conditions().len();
    labelled_ui(ui, "Conditions", ROW, palette, |ui| {
        let is_all = chosen.len() == count;
        let text = if is_all { "none" } else { "all" };
        let button = Button::new(RichText::new(text).color(palette.accent)).frame(false);
        let name = if is_all {
            "No conditions"
        } else {
            "All conditions"
        };
        let switch = named_switch(ui.add(button), Role::Button, false, name);
        if switch.clicked() {
            let ids = if is_all {
                Default::default()
            } else {
                dataset.ids().collect()
            };
            form.choose(ids, &dataset);
        }
        ui.label(format!("{} of {count}", chosen.len()));
    });
    let mut switched: Option<ConditionId> = None;
    ScrollArea::vertical()
        .id_salt("exported conditions")
        .max_height(CONDITIONS)
        .show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = vec2(2.0, 3.0);
                ui.spacing_mut().button_padding = vec2(2.0, 1.0);
                for condition in dataset.conditions() {
                    let id = condition.id();
                    let is_chosen = chosen.contains(&id);
                    let button = Button::new(id.to_string())
                        .selected(is_chosen)
                        .corner_radius(4.0)
                        .min_size(CHIP.into());
                    let name = format!("Export condition {id}");
                    let chip = named_switch(ui.add(button), Role::CheckBox, is_chosen, name);
                    if chip.clicked() {
                        switched = Some(id);
                    }
                    chip.on_hover_text(&condition.flight_state().name);
                }
            });
        });
    if let Some(id) = switched {
        form.switch_condition(id, &dataset);
    }
}

/// Draws the choice between the schedule and each condition's own correction.
fn correction_ui(ui: &mut Ui, form: &mut ExportForm, palette: &Palette) {
    labelled_ui(ui, "Correction", ROW + 4.0, palette, |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        // The line is laid out from right to left.
        for (is_own, text) in [(true, "per condition"), (false, "schedule")] {
            let is_chosen = form.choices.per_condition == is_own;
            let button = Button::new(text).selected(is_chosen).corner_radius(6.0);
            let name = format!("Correction {text}");
            let response = named_switch(ui.add(button), Role::RadioButton, is_chosen, name)
                .on_hover_text("For corrected models; functions and tables contain the schedule");
            if response.clicked() {
                form.choices.per_condition = is_own;
            }
        }
    });
}

/// Draws the choice of each condition's physics model.
fn model_ui(ui: &mut Ui, state: &mut State, palette: &Palette) {
    let mut names = vec![
        ExportChoices::NOMINAL.to_owned(),
        ExportChoices::REPRESENTATIVE.to_owned(),
    ];
    names.extend(state.exported_model_names());
    let form = &mut state.forms.export;
    labelled_ui(ui, "Physics model", ROW + 4.0, palette, |ui| {
        let list = DropDown {
            name: "Physics model",
            width: FIELD - 20.0,
            text: &form.choices.model,
        };
        let choices = names
            .iter()
            .enumerate()
            .map(|(index, name)| (index, *name == form.choices.model, name.clone()));
        if let Some(index) = list.ui(ui, choices) {
            form.choices.model.clone_from(&names[index]);
        }
    });
}

/// Draws the field for the airspeeds in the exported tables; returns whether Enter was pressed.
fn breakpoints_ui(ui: &mut Ui, state: &mut State, palette: &Palette) -> bool {
    let form = &mut state.forms.export;
    let hint = airspeeds_words(&form.default_breakpoints_kt);
    let is_wrong = form.breakpoints_kt().is_err();
    let mut is_submitted = false;
    labelled_ui(ui, "Breakpoints, kt", ROW + 4.0, palette, |ui| {
        let mut edit = TextEdit::singleline(&mut form.breakpoints)
            .hint_text(hint)
            .desired_width(FIELD);
        if is_wrong {
            edit = edit.text_color(palette.warning);
        }
        let response = ui.add(edit);
        name_text_field(&response, "Breakpoints", &form.breakpoints);
        is_submitted = is_entered(ui, &response);
        response.on_hover_text("Airspeeds of lookup tables, increasing");
    });
    is_submitted
}

/// Draws the folder field with the button that opens the desktop's dialog; returns whether Enter
/// was pressed.
fn folder_ui(
    ui: &mut Ui,
    state: &mut State,
    opens: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) -> bool {
    let mut is_submitted = false;
    labelled_ui(ui, "Folder", ROW + 6.0, palette, |ui| {
        ui.button("Choose…")
            .asks(OutputCommand::AskExportFolder, commands);
        let mut form = Form {
            ui,
            opens,
            palette,
            commands,
        };
        let folder = &mut state.forms.export.folder;
        is_submitted = form.text_ui("Export folder", folder, "created if missing");
    });
    is_submitted
}

/// Draws the field for the file-name prefix; returns whether Enter was pressed.
fn prefix_ui(ui: &mut Ui, state: &mut State, palette: &Palette) -> bool {
    let mut is_submitted = false;
    let prefix = &mut state.forms.export.prefix;
    labelled_ui(ui, "File prefix", ROW + 4.0, palette, |ui| {
        let response = ui.add(TextEdit::singleline(prefix).desired_width(FIELD));
        name_text_field(&response, "File prefix", prefix);
        is_submitted = is_entered(ui, &response);
    });
    is_submitted
}

/// Draws the choice of how existing files are treated, how many exist, and the choice of whether
/// the study remembers this form.
fn existing_ui(ui: &mut Ui, state: &mut State, palette: &Palette) {
    let announced = existing_words(state);
    let choices = &mut state.forms.export.choices;
    ui.checkbox(&mut choices.replaces, "Overwrite existing files");
    let (line, _) = ui.allocate_exact_size(vec2(ui.available_width(), 16.0), Sense::hover());
    painted_text(ui, line, 22.0, &announced, small(), palette.dim_text);
    let remembers = &mut state.forms.export.remembers;
    ui.checkbox(remembers, "Remember for this study");
}

/// States how many files exist already, and what happens to them; empty without a current dry run.
fn existing_words(state: &State) -> String {
    let Some(plan) = state.current_export_plan() else {
        return String::new();
    };
    let count = plan.file_count();
    let existing = plan.existing_files.len();
    if existing == 0 {
        "no file exists yet".to_owned()
    } else if state.forms.export.choices.replaces {
        format!("{existing} of {count} files will be replaced")
    } else {
        format!(
            "existing files are kept ({existing} of {count}); the new names get the suffix {}",
            plan.suffix
        )
    }
}
