//! The Records view: the records at the left, one page about them at the right.

use egui::scroll_area::ScrollBarVisibility;
use egui::{Button, Frame, Label, Margin, Panel, ScrollArea, Ui};

use crate::view::controls::page_tab_ui;
use crate::view::{Command, Palette, State, button_ui, is_entered, restore_panel_size, text_field_ui};

use gdcm_core::records::LayoutProblem;

use super::{
    ConditionRecords, Page, RecordsCommand, RecordsPage, advanced_ui, columns_ui, condition_table_ui, fit_ui,
    histories_ui, identified_poles_ui, inputs_ui, offered_menu_ui, outcome_ui, record_list_ui, response_ui,
    stabilisation_ui,
};

/// Width of the list \[pt\].
const LIST_WIDTH: f32 = 340.0;

/// What is done with all records. Laid out from right to left.
pub fn records_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let condition = state.condition().id();
    let records = state.records.conditions.get(&condition);
    if state.records.running(condition).is_some() {
        button_ui(ui, Button::new("Stop identifying"), "", RecordsCommand::Stop, commands);
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
        offered_menu_ui(ui, ("Use these models", hint), |offered| commands.push(RecordsCommand::Take(offered).into()));
    }
    if state.study.taken_models().any(|(id, _)| id == condition) && ui.button("Restore the file's models").clicked() {
        commands.push(RecordsCommand::Return.into());
    }
}

/// Records of the condition shown, and what comes of them.
pub fn records_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let condition = state.condition().id();
    let mut path = std::mem::take(&mut state.records.path);
    let mut sorting = state.records.sorting;
    let mut field = state.records.advanced_field;
    let nothing = ConditionRecords::default();
    let records = state.records.conditions.get(&condition).unwrap_or(&nothing);
    let page = Page { state, records, palette };
    let width = LIST_WIDTH.min(0.4 * ui.available_width());
    restore_panel_size(ui, "records");
    let panel = Panel::left("records").resizable(true).default_size(width).size_range(180.0..=480.0);
    panel.show(ui, |ui| {
        ScrollArea::vertical().id_salt("records").auto_shrink(false).show(ui, |ui| {
            source_ui(ui, state, &mut path, palette, commands);
            record_list_ui(ui, page, commands);
            advanced_ui(ui, page, &mut field, commands);
            outcome_ui(ui, page, commands);
        });
    });
    // Clear of the line between list and page.
    Frame::new().inner_margin(Margin { left: 6, ..Margin::ZERO }).show(ui, |ui| {
        pages_ui(ui, state.records.page, commands);
        match state.records.page {
            RecordsPage::Histories => histories_ui(ui, page, commands),
            RecordsPage::Inputs => inputs_ui(ui, page),
            RecordsPage::Response => response_ui(ui, page),
            RecordsPage::Stabilisation => stabilisation_ui(ui, page),
            RecordsPage::Poles => identified_poles_ui(ui, page),
            RecordsPage::Fit => fit_ui(ui, page, commands),
            RecordsPage::Columns => columns_ui(ui, page, commands),
            RecordsPage::Conditions => condition_table_ui(ui, page, &mut sorting, commands),
        }
    });
    state.records.path = path;
    state.records.sorting = sorting;
    state.records.advanced_field = field;
}

/// One tab for each page, in one line that scrolls where it is too long.
fn pages_ui(ui: &mut Ui, shown: RecordsPage, commands: &mut Vec<Command>) {
    let tabs = ScrollArea::horizontal().id_salt("pages").scroll_bar_visibility(ScrollBarVisibility::AlwaysHidden);
    tabs.show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for page in RecordsPage::ALL {
                let (name, short_name, purpose) = page.words();
                let (tab, is_clicked) = page_tab_ui(ui, page == shown, short_name, (name, purpose));
                if tab.gained_focus() {
                    tab.scroll_to_me(None);
                }
                commands.extend(is_clicked.then_some(RecordsCommand::Show(page).into()));
            }
        });
    });
}

/// Where records come from.
fn source_ui(ui: &mut Ui, state: &State, path: &mut String, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let add = Button::new("Add records…");
        button_ui(ui, add, "CSV, text, .mat, .npz, .zip: files of flight records", RecordsCommand::AskFiles, commands);
        let width = (ui.available_width() - 8.0).max(40.0);
        let field = text_field_ui(ui, "Path of records", path, "or a path", width);
        if is_entered(ui, &field) && !path.trim().is_empty() {
            commands.push(RecordsCommand::Add(vec![path.trim().into()]).into());
        }
    });
    if let Some(reading) = &state.records.reading {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(palette.small(format!("reading {}", reading.name)));
        });
    }
    let records = state.records.conditions.get(&state.condition().id());
    if records.is_some_and(|of| of.rows.iter().any(|row| row.problems.iter().any(LayoutProblem::is_missing))) {
        ui.horizontal_wrapped(|ui| {
            ui.label(palette.small("Other channels than the dataset has?"));
            let hint = "Models are identified from them before there is a physics model";
            button_ui(ui, Button::new("Make a dataset of them…"), hint, RecordsCommand::AskDataset, commands);
        });
    }
    for fault in &state.records.faults {
        ui.add(Label::new(palette.small_warning(fault)).wrap());
    }
}
