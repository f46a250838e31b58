//! The Records view: the records at the left, one page about them at the right.

use egui::scroll_area::ScrollBarVisibility;
use egui::{Button, Frame, Label, Margin, Panel, RichText, Role, ScrollArea, TextEdit, Ui, WidgetInfo};

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::state::State;

use super::histories::histories_ui;
use super::histories::inputs_ui;
use super::outcome::{offered_menu_ui, outcome_ui};
use super::record_list::columns_ui;
use super::record_list::record_list_ui;
use super::records_state::{ConditionRecords, RecordsCommand, RecordsPage};
use super::response::identified_poles_ui;
use super::response::response_ui;
use super::response::stabilisation_ui;
use super::simulation::fit_ui;

/// Width of the list \[pt\].
const LIST_WIDTH: f32 = 340.0;

/// What is done with all records. Laid out from right to left.
pub fn records_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let condition = state.condition().id();
    let bench = &state.records;
    let records = bench.conditions.get(&condition);
    if bench.running(condition).is_some() {
        if ui.button("Stop identifying").clicked() {
            commands.push(RecordsCommand::Stop.into());
        }
        ui.spinner();
        return;
    }
    let can = records.is_some_and(|records| records.used_rows().next().is_some());
    let hint = "Models of this condition from its records: CT-PBSID, refined, with bands (M14)";
    if ui.add_enabled(can, Button::new("Identify")).on_hover_text(hint).clicked() {
        commands.push(RecordsCommand::Identify.into());
    }
    if records.is_some_and(|records| records.identification().is_some()) {
        let hint = "In place of the identified models of this condition; one step to undo";
        offered_menu_ui(ui, ("Take these models", hint), |offered| commands.push(RecordsCommand::Take(offered).into()));
    }
    if state.study.taken_models().any(|(id, _)| id == condition) && ui.button("Put the file's models back").clicked() {
        commands.push(RecordsCommand::Return.into());
    }
}

/// Records of the condition shown, and what comes of them.
pub fn records_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let condition = state.condition().id();
    let mut path = std::mem::take(&mut state.records.path);
    let nothing = ConditionRecords::default();
    let records = state.records.conditions.get(&condition).unwrap_or(&nothing);
    let width = LIST_WIDTH.min(0.4 * ui.available_width());
    let panel = Panel::left("records").resizable(true).default_size(width).size_range(180.0..=480.0);
    panel.show(ui, |ui| {
        ScrollArea::vertical().id_salt("records").auto_shrink(false).show(ui, |ui| {
            source_ui(ui, state, &mut path, palette, commands);
            record_list_ui(ui, (records, state.records.is_example), palette, commands);
            outcome_ui(ui, state, records, palette, commands);
        });
    });
    // Clear of the line between list and page.
    Frame::new().inner_margin(Margin { left: 6, ..Margin::ZERO }).show(ui, |ui| {
        pages_ui(ui, state.records.page, commands);
        match state.records.page {
            RecordsPage::Histories => histories_ui(ui, state, records, palette, commands),
            RecordsPage::Inputs => inputs_ui(ui, state, records, palette),
            RecordsPage::Response => response_ui(ui, state, records, palette),
            RecordsPage::Stabilisation => stabilisation_ui(ui, state, records, palette),
            RecordsPage::Poles => identified_poles_ui(ui, records, palette),
            RecordsPage::Fit => fit_ui(ui, state, records, palette, commands),
            RecordsPage::Columns => columns_ui(ui, state, records, palette, commands),
        }
    });
    state.records.path = path;
}

/// One tab for each page, in one line that scrolls where it is too long.
fn pages_ui(ui: &mut Ui, shown: RecordsPage, commands: &mut Vec<Command>) {
    let tabs = ScrollArea::horizontal().id_salt("pages").scroll_bar_visibility(ScrollBarVisibility::AlwaysHidden);
    tabs.show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for page in RecordsPage::ALL {
                let label = format!("Page {}", page.name());
                let tab = ui.selectable_label(page == shown, page.short_name());
                tab.widget_info(|| WidgetInfo::selected(Role::Button, true, page == shown, &label));
                if tab.gained_focus() {
                    tab.scroll_to_me(None);
                }
                if tab.on_hover_text(format!("{}: {}", page.name(), page.purpose())).clicked() {
                    commands.push(RecordsCommand::Show(page).into());
                }
            }
        });
    });
}

/// Where records come from.
fn source_ui(ui: &mut Ui, state: &State, path: &mut String, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        if ui.button("Add records…").on_hover_text("CSV, text, .mat, .npz, .zip: files of flight records").clicked() {
            commands.push(RecordsCommand::AskFiles.into());
        }
        let width = (ui.available_width() - 8.0).max(40.0);
        let field = ui.add(TextEdit::singleline(path).hint_text("or a path").desired_width(width));
        field.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::TextInput, true, "Path of records");
            info.current_text_value = Some(path.clone());
            info
        });
        if field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) && !path.trim().is_empty() {
            commands.push(RecordsCommand::Add(vec![path.trim().into()]).into());
        }
    });
    let small = |text: String, color| RichText::new(text).size(SMALL_SIZE).color(color);
    if let Some(reading) = &state.records.reading {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(small(format!("reading {}", reading.name), palette.dim_text));
        });
    }
    for fault in &state.records.faults {
        ui.add(Label::new(small(fault.clone(), palette.warning)).wrap());
    }
}
