//! Table of the commands, the source for menus, shortcuts, the command palette and the page about
//! keys.

use egui::{Key, Modifiers};

use gdcm_plot::figure::FigureFormat;
use gdcm_study::PhaseCorrection;
use gdcm_study::decisions::adopted_models::AdoptionChoice;
use gdcm_study::decisions::setting::Kind;
use gdcm_study::decisions::setting_table::{self, SETTINGS};
use gdcm_study::decisions::setting_value::Value;
use gdcm_words::setting_words::setting_words;

use super::command::Command;
use super::curve_entries::curve_entries;
use super::display::DisplayCommand;
use super::edit_entries::{edit_entries, hold_entry, model_entries};
use super::entry::{CTRL, Entry, Menu, group};
use super::file::FileCommand;
use super::file_entries::file_entries;
use super::layout::LayoutCommand;
use super::output::OutputCommand;
use super::records::RecordsCommand;
use super::selection::SelectionCommand;
use super::view_entries::view_entries;
use crate::gui::state::forms::FormKind;
use crate::gui::state::pair_set::PairSet;
use crate::gui::state::panel_tables::TableKind;
use crate::gui::state::view::{View, views_with_figure};
use crate::gui::state::window_state::State;

/// Returns the commands for menus, keys and the palette; the entries of each menu are in menu
/// order.
pub fn command_table(state: &State) -> Vec<Entry> {
    let mut entries = file_entries(state);
    entries.extend(edit_entries(state));
    entries.extend(view_entries(state));
    entries.extend(curve_entries(state));
    entries.extend(setting_entries(state));
    entries.extend(record_entries(state));
    for kind in TableKind::ALL {
        entries.extend(table_entries(kind));
    }
    let has_leads = state.study.settings.phase == PhaseCorrection::Lead;
    for view in views_with_figure() {
        let is_drawn = view != View::Leads || has_leads;
        entries.extend(figure_entries(view).map(|entry| entry.enabled(is_drawn)));
    }
    let use_leads = Entry::new(
        "Use leads",
        "Corrects phases up to the top of the band, at the price of more gain above it",
        setting_table::PHASE.to(PhaseCorrection::Lead),
    );
    entries.push(use_leads.enabled(!has_leads));
    entries.push(Entry::new(
        "Keep the decisions as a variant…",
        "Moves the focus to the field for the name of the variant",
        LayoutCommand::NameVariant,
    ));
    entries.extend(help_entries());
    entries
}

fn table_entries(kind: TableKind) -> [Entry; 2] {
    [
        Entry::new(
            format!("Copy table: {}", kind.name()),
            "As text, one line for each row",
            OutputCommand::CopyTable(kind),
        ),
        Entry::new(
            format!("Save table: {}…", kind.name()),
            "As a CSV file",
            OutputCommand::AskSaveTable(kind),
        ),
    ]
}

fn figure_entries(view: View) -> [Entry; 2] {
    [
        Entry::new(
            format!("Copy the values of {}", view.name()),
            "As CSV, to the clipboard",
            OutputCommand::CopyFigure(view),
        ),
        Entry::new(
            format!("Save figure: {}…", view.name()),
            "As SVG, PNG or PDF, or its values as CSV",
            OutputCommand::AskSaveFigure(view, FigureFormat::Svg),
        ),
    ]
}

/// Returns the entries that identify models from flight records, and that use or remove these
/// models in the displayed condition.
fn record_entries(state: &State) -> [Entry; 4] {
    let condition = state.condition().id();
    let in_use = state.records.conditions_in_use();
    let is_found = match state.records.conditions.get(&condition) {
        Some(records) => records.identification().is_some(),
        None => false,
    };
    let is_taken = state.study.adopted_models().any(|(id, _)| id == condition);
    let here = "In the displayed condition";
    [
        Entry::new(
            "Identify models",
            "From the flight records of the displayed condition",
            RecordsCommand::Identify,
        )
        .enabled(in_use.contains(&condition)),
        Entry::new(
            "Identify models of all conditions",
            "From the flight records of each condition",
            RecordsCommand::IdentifyAll,
        )
        .enabled(!in_use.is_empty()),
        Entry::new(
            "Use the identified models",
            here,
            RecordsCommand::Adopt(AdoptionChoice::REFINED),
        )
        .enabled(is_found),
        Entry::new(
            "Restore the file's identified models",
            here,
            RecordsCommand::RestoreFileModels,
        )
        .enabled(is_taken),
    ]
}

/// Returns an entry for every choice and every numeric field in the settings; flags have none.
fn setting_entries(state: &State) -> Vec<Entry> {
    let mut entries = Vec::new();
    for setting in SETTINGS {
        let option = setting.option.trim_start_matches('-');
        let texts = setting_words(setting);
        match setting.kind {
            Kind::Number { .. } | Kind::Optional { .. } => {
                entries.push(field_entry(setting.name, option, texts.label));
            }
            Kind::Range { .. } | Kind::Band { .. } => {
                let ends = texts.ends;
                let lower = format!("lower end of the {}", setting.name);
                let upper = format!("upper end of the {}", setting.name);
                entries.push(field_entry(&lower, option, ends[0]));
                entries.push(field_entry(&upper, option, ends[1]));
            }
            Kind::Choice { words, get, .. } => {
                let now = get(&state.study.settings);
                for (index, choice) in words.iter().enumerate() {
                    let name = format!("{}: {}", texts.label, choice.sentence);
                    let edit = setting.to(Value::Choice(index));
                    entries.push(Entry::new(name, texts.help, edit).enabled(index != now));
                }
            }
            Kind::Flag { .. } => {}
        }
    }
    entries
}

/// Returns the entry that focuses a numeric field in the settings.
fn field_entry(name: &str, option: &str, label: &'static str) -> Entry {
    Entry::new(
        format!("Set the {name} ({option})…"),
        "Moves the focus to its field",
        LayoutCommand::FocusField(label),
    )
}

fn help_entries() -> impl Iterator<Item = Entry> {
    let help = [
        Entry::new(
            "Command palette",
            "Find any command by its name",
            Command::show_form(FormKind::Palette),
        )
        .keys(CTRL, Key::K),
        Entry::new(
            "Keys and gestures",
            "Every key, and the gestures of the pointer",
            Command::show_form(FormKind::Shortcuts),
        )
        .keys(Modifiers::NONE, Key::F1),
        Entry::new(
            "Messages",
            "Messages of this session",
            Command::show_form(FormKind::Messages),
        ),
        Entry::new(
            "Guided tour",
            "Five steps through the window",
            LayoutCommand::StartTour,
        ),
    ];
    let about = [
        Entry::new(
            "Licences",
            "Of the libraries in the program",
            Command::show_form(FormKind::Licences),
        ),
        Entry::new(
            "About gdcm",
            "Version and licence",
            Command::show_form(FormKind::About),
        ),
    ];
    group(Menu::Help, 0, help).chain(group(Menu::Help, 1, about))
}

/// Returns the entries in the palette: the command table without the palette itself, and entries
/// for each set of net gains, condition, response, model in the displayed condition, and recent
/// file.
pub fn every_command(state: &State) -> Vec<Entry> {
    let palette = Command::show_form(FormKind::Palette);
    let mut entries = command_table(state);
    entries.retain(|entry| entry.command != palette);
    entries.extend(PairSet::ALL.map(|set| {
        Entry::new(
            format!("Net gains of responses: {}", set.name()),
            set.purpose(),
            DisplayCommand::ShowNetGains(set),
        )
    }));
    for condition in state.dataset().conditions() {
        let id = condition.id();
        entries.push(Entry::new(
            format!("Condition {id} · {}", condition.flight_state().name),
            "Show this condition",
            SelectionCommand::SelectCondition(id),
        ));
    }
    for pair in state.dataset().on_axis().pairs() {
        entries.push(Entry::new(
            format!("Show {}", state.dataset().pair_name(pair)),
            "In the plots of one response",
            SelectionCommand::FocusPair(pair),
        ));
        if pair != state.display.selection.pair {
            entries.push(hold_entry(state, pair));
        }
    }
    entries.extend(model_entries(state));
    for file in &state.recent {
        let entry = Entry::new(
            format!("Open recent {} in {}", file.name, file.folder),
            "Recently opened or saved",
            FileCommand::Open(file.path.clone()),
        );
        entries.push(entry.enabled(!file.missing));
    }
    entries
}
