//! Flight records of the displayed condition and the models identified from them: records and
//! search settings on the left, a page about them on the right.

pub mod frame_cache;
mod histories;
mod outcome;
pub mod page;
mod record_list;
mod response;
mod simulation;

use std::sync::Arc;

use egui::scroll_area::ScrollBarVisibility;
use egui::{
    Button, CollapsingHeader, ComboBox, Frame, Grid, Id, Label, Margin, Panel, PopupCloseBehavior,
    RichText, Role, ScrollArea, Ui,
};

use gdcm_model::dataset::ConditionId;
use gdcm_model::number_format::decimals;
use gdcm_model::units::{number, six_digits};
use gdcm_sysid::identification::SearchSpace;
use gdcm_sysid::identification_error::{HIGHEST_ORDER, LONGEST_PAST};
use gdcm_sysid::records::LayoutProblem;
use gdcm_words::Table;

use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::records::{ConditionRecords, RecordsPage};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::page_tab_ui;
use crate::gui::widgets::controls::{
    Asks, button_ui, entry_ui, is_entered, named, restore_panel_size, text_field_ui, typed_number,
};
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::tables::{Sorting, TableLook, table_ui};
use frame_cache::kept;
use histories::{histories_ui, inputs_ui};
use outcome::{offered_menu_ui, outcome_ui};
use page::Page;
use record_list::{columns_ui, record_list_ui};
use response::{identified_poles_ui, response_ui, stabilisation_ui};
use simulation::fit_ui;

pub use simulation::simulation_jobs;

/// Width of the list \[pt\].
const LIST_WIDTH: f32 = 340.0;

/// Draws the commands for all records, from right to left.
pub fn records_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let condition = state.condition().id();
    let records = state.records.conditions.get(&condition);
    if state.records.running(condition).is_some() {
        button_ui(
            ui,
            Button::new("Stop identifying"),
            "",
            RecordsCommand::Stop,
            commands,
        );
        ui.spinner();
        return;
    }
    let can = records.is_some_and(|records| records.used_rows().next().is_some());
    let hint = "Models of this condition from its records: CT-PBSID, refined, with bands (M14)";
    ui.add_enabled(can, Button::new("Identify"))
        .on_hover_text(hint)
        .asks(RecordsCommand::Identify, commands);
    if records.is_some_and(|records| records.identification().is_some()) {
        let hint = "In place of the identified models of this condition; one step to undo";
        offered_menu_ui(ui, ("Use these models", hint), |offered| {
            commands.push(RecordsCommand::Take(offered).into())
        });
    }
    if state.study.taken_models().any(|(id, _)| id == condition)
        && ui.button("Restore the file's models").clicked()
    {
        commands.push(RecordsCommand::Return.into());
    }
}

/// Draws the records of the displayed condition and their results.
pub fn records_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let condition = state.condition().id();
    let mut path = std::mem::take(&mut state.records.path);
    let mut sorting = state.records.sorting;
    let mut field = state.records.advanced_field;
    let nothing = ConditionRecords::default();
    let records = state.records.conditions.get(&condition).unwrap_or(&nothing);
    let page = Page {
        state,
        records,
        palette,
    };
    let width = LIST_WIDTH.min(0.4 * ui.available_width());
    restore_panel_size(ui, "records");
    let panel = Panel::left("records")
        .resizable(true)
        .default_size(width)
        .size_range(180.0..=480.0);
    panel.show(ui, |ui| {
        ScrollArea::vertical()
            .id_salt("records")
            .auto_shrink(false)
            .show(ui, |ui| {
                source_ui(ui, state, &mut path, palette, commands);
                record_list_ui(ui, page, commands);
                advanced_ui(ui, page, &mut field, commands);
                outcome_ui(ui, page, commands);
            });
    });
    // Keeps a distance from the line between list and page.
    Frame::new()
        .inner_margin(Margin {
            left: 6,
            ..Margin::ZERO
        })
        .show(ui, |ui| {
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

/// Shows one tab for each page, in a line that scrolls if it is too long.
fn pages_ui(ui: &mut Ui, shown: RecordsPage, commands: &mut Vec<Command>) {
    let tabs = ScrollArea::horizontal()
        .id_salt("pages")
        .scroll_bar_visibility(ScrollBarVisibility::AlwaysHidden);
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

/// Shows the sources of the records.
fn source_ui(
    ui: &mut Ui,
    state: &State,
    path: &mut String,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        let add = Button::new("Add records…");
        button_ui(
            ui,
            add,
            "CSV, text, .mat, .npz, .zip: files of flight records",
            RecordsCommand::AskFiles,
            commands,
        );
        let width = (ui.available_width() - 8.0).max(40.0);
        let field = text_field_ui(ui, "Path of records", path, "or a path", width);
        if is_entered(ui, &field) && !path.trim().is_empty() {
            commands.push(RecordsCommand::Add(vec![path.trim().into()]).into());
        }
    });
    if let Some(reading) = &state.records.reading {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(palette.small(format!("reading {reading}")));
        });
    }
    open_units_ui(ui, state, palette, commands);
    all_conditions_ui(ui, state, commands);
    let records = state.records.conditions.get(&state.condition().id());
    if records.is_some_and(|of| {
        of.rows
            .iter()
            .any(|row| row.problems.iter().any(LayoutProblem::is_missing))
    }) {
        ui.horizontal_wrapped(|ui| {
            ui.label(palette.small("Other channels than the dataset has?"));
            let hint = "Models are identified from them before there is a physics model";
            button_ui(
                ui,
                Button::new("Make a dataset of them…"),
                hint,
                RecordsCommand::AskDataset,
                commands,
            );
        });
    }
    for fault in &state.records.faults {
        ui.add(Label::new(palette.small_warning(fault)).wrap());
    }
}

/// Asks once for all missing units in the records of all conditions.
fn open_units_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(open) = state.records.open_units() else {
        return;
    };
    let channels: Vec<String> = open
        .channels
        .iter()
        .map(|(name, unit)| format!("{name} [{unit}]"))
        .collect();
    let records = if open.records == 1 {
        "1 record".to_owned()
    } else {
        format!("{} records", open.records)
    };
    let of = if open.conditions == 1 {
        String::new()
    } else {
        format!(" of {} conditions", open.conditions)
    };
    let question = format!(
        "{records}{of} without units: are they those of the dataset, {}?",
        channels.join(", ")
    );
    ui.add(Label::new(palette.small_warning(question)).wrap());
    ui.horizontal_wrapped(|ui| {
        let hint = "Holds for the records of all conditions whose files do not say a unit; one step to undo";
        button_ui(ui, Button::new("Take the dataset's units"), hint, RecordsCommand::TakeDatasetUnits, commands);
        let hint = "The columns of the first of these records; what is said there holds for all that have such columns";
        button_ui(ui, Button::new("Say others…"), hint, RecordsCommand::ShowUnclear, commands);
    });
}

/// Shows the commands for the records of all conditions, if several have some.
fn all_conditions_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let count = with_records(state).count();
    if count < 2 || !state.records.running.is_empty() {
        return;
    }
    ui.button(format!("Identify all {count} conditions"))
        .on_hover_text("One after the other, beside the live answer")
        .asks(RecordsCommand::IdentifyAll, commands);
    let found = state
        .records
        .conditions
        .values()
        .filter(|of| of.identification().is_some())
        .count();
    if found > 1 {
        let hint = "In place of the identified models of these conditions; one step to undo";
        let take = format!("Use the models of {found} conditions");
        offered_menu_ui(ui, (&take, hint), |offered| {
            commands.push(RecordsCommand::TakeAll(offered).into())
        });
    }
}

/// Shows the table of conditions with records; a heading sorts it, a click on a row displays the
/// condition.
fn condition_table_ui(
    ui: &mut Ui,
    page: Page<'_>,
    sorting: &mut Sorting,
    commands: &mut Vec<Command>,
) {
    let table = condition_table(page.state);
    let ids: Vec<_> = with_records(page.state).map(|(id, _)| *id).collect();
    if ids.is_empty() {
        ui.label(page.palette.dim("No condition has records yet."));
        return;
    }
    let shown = page.state.condition().id();
    let color = |row: usize, column: usize| {
        (column == 6 && table.rows[row][6] != "0").then_some(page.palette.warning)
    };
    let look = TableLook {
        color: &color,
        selected: &|row| ids.get(row) == Some(&shown),
    };
    if let Some(click) = table_ui(ui, &table, sorting, &look, page.palette, commands)
        && let Some(id) = ids.get(click.row)
    {
        commands.push(SelectionCommand::SelectCondition(*id).into());
    }
}

fn with_records(state: &State) -> impl Iterator<Item = (&ConditionId, &ConditionRecords)> {
    state
        .records
        .conditions
        .iter()
        .filter(|(_, of)| of.used_rows().next().is_some())
}

/// Returns a row for each condition with records: model order, χ²/dof of the fit and of the
/// held-out records, numbers of models and cautions, and computing time. Before an identification
/// the cells are empty or give the reason.
pub fn condition_table(state: &State) -> Table {
    let columns = [
        "condition",
        "airspeed [kt]",
        "order",
        "χ²/dof",
        "held out",
        "models",
        "cautions",
        "time [s]",
    ];
    let mut table = Table::new("Identified conditions", columns);
    for (id, records) in with_records(state) {
        let airspeed_kt = state
            .dataset()
            .condition(*id)
            .map(|of| decimals(of.flight_state().airspeed_kt, 0));
        let named = [id.to_string(), airspeed_kt.unwrap_or_default()];
        let told = match (&records.found, state.records.running(*id)) {
            (_, Some(job)) if job.news().step.is_empty() => vec!["waits".to_owned()],
            (_, Some(_)) => vec!["under way".to_owned()],
            (None, None) => Vec::new(),
            (Some((_, Err(_))), None) => vec!["not identified".to_owned()],
            (Some((job, Ok(found))), None) => vec![
                found
                    .refined
                    .order()
                    .map_or(String::new(), |order| order.to_string()),
                decimals(found.cost, 2),
                found
                    .held_out_cost
                    .map_or(String::new(), |cost| decimals(cost, 2)),
                (found.bundle.len() + 1).to_string(),
                found.cautions.len().to_string(),
                job.news()
                    .duration_s
                    .map_or(String::new(), |time_s| decimals(time_s, 1)),
            ],
        };
        table.row(named.into_iter().chain(told));
    }
    table
}

const FIELD_WIDTH: f32 = 150.0;
/// Names of the fields that cautions refer to.
const ORDERS: &str = "orders";
const REFERENCES: &str = "references";

/// Shows the search settings under a heading, one field each; an empty field is determined from the
/// records. Focuses `field` once it is visible.
fn advanced_ui(
    ui: &mut Ui,
    page: Page<'_>,
    field: &mut Option<&'static str>,
    commands: &mut Vec<Command>,
) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let band = state.study.settings.band;
    let of_study = format!(
        "{} {} (the study's)",
        six_digits(band.min()),
        six_digits(band.max())
    );
    let said = records.band.map_or_else(String::new, |[low, high]| {
        format!("{} {}", number(low), number(high))
    });
    let search = &records.search;
    let lists: [(&str, String, &str, Sets); 3] = [
        (
            ORDERS,
            listed(&search.orders),
            "by the records: 1 to 24",
            |search, list| {
                search.orders = whole(list, HIGHEST_ORDER)?;
                Ok(())
            },
        ),
        (
            "past windows",
            listed(&search.pasts),
            "by the records: 8 to 24",
            |search, list| {
                search.pasts = whole(list, LONGEST_PAST)?;
                Ok(())
            },
        ),
        (
            "Laguerre poles",
            listed(&search.poles),
            "0.375, 0.54, 0.75 of the band's end",
            |search, list| {
                let wrong = list.iter().find(|pole| **pole <= 0.0);
                search.poles = list.to_vec();
                wrong.map_or(Ok(()), |pole| {
                    Err(format!("a pole is positive, found {}", number(*pole)))
                })
            },
        ),
    ];
    let header =
        CollapsingHeader::new(palette.small("Advanced")).id_salt("advanced identification");
    header.open(field.is_some().then_some(true)).show(ui, |ui| {
        Grid::new("advanced identification")
            .num_columns(2)
            .spacing([6.0, 3.0])
            .show(ui, |ui| {
                if let Some(text) = field_ui(ui, "band [rad/s]", &said, &of_study, palette) {
                    commands.push(match numbers(&text).and_then(|list| band_of(&list)) {
                        Ok(band) => RecordsCommand::SetBand(band).into(),
                        Err(why) => Command::Form(FormCommand::Refuse(why)),
                    });
                }
                let is_wanted = *field == Some(REFERENCES);
                references_ui(ui, page, is_wanted, commands);
                for (name, said, hint, sets) in lists {
                    if let Some(text) = field_ui(ui, name, &said, hint, palette) {
                        let mut wanted = search.clone();
                        commands.push(
                            match numbers(&text).and_then(|list| sets(&mut wanted, &list)) {
                                Ok(()) => RecordsCommand::SetSearch(wanted).into(),
                                Err(why) => {
                                    Command::Form(FormCommand::Refuse(format!("{name}: {why}")))
                                }
                            },
                        );
                    }
                }
            });
        if let Some(name) = field.take() {
            ui.scroll_to_cursor(None);
            if name != REFERENCES {
                let field = Id::unique(("entry", format!("Identification: {name}"))).with("field");
                ui.memory_mut(|memory| memory.request_focus(field));
            }
        }
    });
}

/// Selects the columns of recorded references; those whose names suggest references come first.
fn references_ui(ui: &mut Ui, page: Page<'_>, is_wanted: bool, commands: &mut Vec<Command>) {
    let Page {
        records, palette, ..
    } = page;
    ui.label(palette.small(REFERENCES));
    let said = &records.references;
    let text = if said.is_empty() {
        "none".to_owned()
    } else {
        said.join(", ")
    };
    let list = ComboBox::from_id_salt(REFERENCES)
        .width(FIELD_WIDTH)
        .selected_text(text)
        .truncate();
    let list = list
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show_ui(ui, |ui| {
            let possible = possible_references(ui, records);
            let unknown = said
                .iter()
                .filter(|name| possible.iter().all(|(known, _)| known != *name));
            for (name, is_named) in unknown
                .map(|name| (name, true))
                .chain(possible.iter().map(|(name, of)| (name, *of)))
            {
                let mut is_chosen = said.contains(name);
                let text = if is_named {
                    RichText::new(name).strong()
                } else {
                    RichText::new(name)
                };
                if ui.checkbox(&mut is_chosen, text).changed() {
                    let others = said
                        .iter()
                        .filter(|other| *other != name)
                        .chain(is_chosen.then_some(name));
                    commands.push(RecordsCommand::SetReferences(others.cloned().collect()).into());
                }
            }
        });
    if is_wanted {
        list.response.request_focus();
    }
    let hint = "Columns of recorded signals that drove the loop from outside (M14.15)";
    named(
        list.response.on_hover_text(hint),
        Role::ComboBox,
        "Identification: references",
    );
    ui.end_row();
}

/// Returns the columns of the first used record that may be references, and whether their names
/// suggest it; those come first.
fn possible_references(ui: &Ui, records: &ConditionRecords) -> Arc<Vec<(String, bool)>> {
    let Some((_, row)) = records.used_rows().next() else {
        return Arc::default();
    };
    let of_row = || {
        row.possible_references()
            .into_iter()
            .map(|(name, is_named)| (name.to_owned(), is_named))
            .collect()
    };
    kept(
        ui,
        "possible references",
        &[Arc::clone(&row.table) as _],
        format!("{:?}", row.layout),
        of_row,
    )
}

/// Applies a list to the search settings, or returns an error message.
type Sets = fn(&mut SearchSpace, &[f64]) -> Result<(), String>;

fn field_ui(ui: &mut Ui, name: &str, said: &str, hint: &str, palette: &Palette) -> Option<String> {
    ui.label(palette.small(name));
    let text = entry_ui(
        ui,
        &format!("Identification: {name}"),
        said,
        hint,
        FIELD_WIDTH,
    );
    ui.end_row();
    text
}

fn listed<T: ToString>(list: &[T]) -> String {
    list.iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>()
        .join(" ")
}

/// Parses numbers separated by blanks.
fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split_whitespace()
        .filter_map(|part| typed_number(part.trim_end_matches([',', ';'])).transpose())
        .collect()
}

fn band_of(list: &[f64]) -> Result<Option<[f64; 2]>, String> {
    match *list {
        [] => Ok(None),
        [low, high] if 0.0 < low && low < high => Ok(Some([low, high])),
        _ => Err(
            "the band: expected two frequencies in rad/s, the lower first, as in \"0.5 12\""
                .to_owned(),
        ),
    }
}

fn whole(list: &[f64], most: usize) -> Result<Vec<usize>, String> {
    let wrong = list
        .iter()
        .find(|value| value.fract() != 0.0 || !(1.0..=most as f64).contains(*value));
    match wrong {
        Some(value) => Err(format!(
            "expected whole numbers from 1 to {most}, found {}",
            number(*value)
        )),
        None => Ok(list.iter().map(|value| *value as usize).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_typed_between_blanks_and_what_cannot_be_is_refused_in_words() {
        assert_eq!(numbers("2, 4 6.5;").unwrap(), [2.0, 4.0, 6.5]);
        assert!(numbers("2 x").unwrap_err().contains("expected a number"));
        assert_eq!(band_of(&[]), Ok(None));
        assert_eq!(band_of(&[0.5, 12.0]), Ok(Some([0.5, 12.0])));
        assert!(
            band_of(&[12.0, 0.5])
                .unwrap_err()
                .contains("the lower first")
        );
        assert_eq!(whole(&[2.0, 4.0], HIGHEST_ORDER), Ok(vec![2, 4]));
        assert!(whole(&[0.0], HIGHEST_ORDER).is_err() && whole(&[2.5], HIGHEST_ORDER).is_err());
    }
}
