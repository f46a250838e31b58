//! Every command of the window, once: the menus, the shortcuts, the palette and the page of keys are made of this table.

use egui::{Key, KeyboardShortcut, Modifiers, ThemePreference};

use gdcm_core::dataset::{BundleKind, ModelId, Pair};
use gdcm_core::study::{Edit, Kind, OfferedModels, Place, SETTINGS, Value};
use gdcm_files::figure::FigureFormat;

use super::arrangement::{Preset, View};
use super::assembling::AssemblingCommand;
use super::command::{Command, FormKind};
use super::curve_display::curve_entries;
use super::figures::views_with_figure;
use super::plot::FrequencyUnit;
use super::records::RecordsCommand;
use super::state::State;
use super::tables::TableKind;
use super::views::PairSet;

/// A menu of the bar on top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    /// Opening, saving, exporting.
    File,
    /// Decisions about the study.
    Edit,
    /// What is shown, and how.
    View,
    /// How curves are drawn: a part of the menu before.
    Curves,
    /// Explanations.
    Help,
}

/// Where a shortcut works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// Everywhere, also while text is typed.
    Everywhere,
    /// Only while nothing has the focus and no form is open: keys that lists, fields and texts use too.
    WithoutFocus,
}

/// One command.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its name, by which menus show it and the palette finds it.
    pub name: String,
    /// What it does, where the name does not say all.
    pub meaning: &'static str,
    /// The keys that give it, the first of which is shown.
    pub shortcuts: Vec<KeyboardShortcut>,
    /// Where they work.
    pub reach: Reach,
    /// The menu it stands in, and its group there; groups are parted by lines.
    pub menu: Option<(Menu, u8)>,
    /// Whether it can be given now.
    pub enabled: bool,
    /// What it asks for.
    pub command: Command,
}

impl Entry {
    /// An entry without shortcut and menu.
    pub(super) fn new(name: impl Into<String>, meaning: &'static str, command: Command) -> Self {
        let (shortcuts, reach) = (Vec::new(), Reach::Everywhere);
        Self { name: name.into(), meaning, shortcuts, reach, menu: None, enabled: true, command }
    }

    pub(super) fn keys(mut self, modifiers: Modifiers, key: Key) -> Self {
        self.shortcuts.push(KeyboardShortcut::new(modifiers, key));
        self
    }

    /// A key without modifiers that works only while nothing has the focus.
    pub(super) fn free_key(mut self, key: Key) -> Self {
        self.reach = Reach::WithoutFocus;
        self.keys(Modifiers::NONE, key)
    }

    pub(super) fn within(mut self, menu: Menu, group: u8) -> Self {
        self.menu = Some((menu, group));
        self
    }

    pub(super) fn enabled(mut self, enabled: bool) -> Self {
        self.enabled = enabled;
        self
    }
}

const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

/// What can be done with the flight records of the condition shown.
fn record_entries(state: &State) -> Vec<Entry> {
    let condition = state.condition().id();
    let of = |id| state.records.conditions.get(&id);
    let has_records = of(condition).is_some_and(|records| records.used_rows().next().is_some());
    let is_found = of(condition).is_some_and(|records| records.identification().is_some());
    let is_taken = state.study.taken_models().any(|(id, _)| id == condition);
    let all = state.records.conditions.values().any(|records| records.used_rows().next().is_some());
    let entry =
        |name, meaning, command: RecordsCommand, enabled| Entry::new(name, meaning, command.into()).enabled(enabled);
    vec![
        Entry::new(
            "Add flight records…",
            "Of the condition that their names say, or of the one shown",
            RecordsCommand::AskFiles.into(),
        )
        .within(Menu::File, 1),
        entry(
            "Identify models",
            "Of the condition shown, from its flight records",
            RecordsCommand::Identify,
            has_records,
        ),
        entry("Identify models of all conditions", "From their flight records", RecordsCommand::IdentifyAll, all),
        entry(
            "Take the identified models",
            "Into the condition shown",
            RecordsCommand::Take(OfferedModels::REFINED),
            is_found,
        ),
        entry("Put the file's identified models back", "Into the condition shown", RecordsCommand::Return, is_taken),
    ]
}

/// The commands of the menus and of the keys, in the order in which menus and the page of keys show them.
pub fn command_table(state: &State) -> Vec<Entry> {
    let mut entries = file_entries(state);
    entries.extend(edit_entries(state));
    entries.extend(view_entries(state));
    entries.extend(curve_entries(state));
    entries.extend(setting_entries(state));
    entries.extend(record_entries(state));
    entries.extend(TableKind::ALL.map(|kind| {
        Entry::new(format!("Copy table: {}", kind.name()), "As text, one line a row", Command::CopyTable(kind))
    }));
    entries.extend(
        TableKind::ALL.map(|kind| {
            Entry::new(format!("Save table: {}…", kind.name()), "As a CSV file", Command::AskSaveTable(kind))
        }),
    );
    entries.extend(views_with_figure().map(|view| {
        let name = format!("Copy numbers of {}", view.name());
        Entry::new(name, "As CSV, to the clipboard", Command::CopyFigure(view))
    }));
    entries.extend(views_with_figure().map(|view| {
        let command = Command::AskSaveFigure(view, FigureFormat::Svg);
        Entry::new(format!("Save figure: {}…", view.name()), "As SVG, PNG or PDF, or its numbers as CSV", command)
    }));
    entries.extend(help_entries());
    entries
}

fn file_entries(state: &State) -> Vec<Entry> {
    let form = |form| Command::ShowForm(Some(form));
    vec![
        Entry::new("Open…", "A dataset or a study, with the desktop's dialog", Command::AskOpen)
            .keys(CTRL, Key::O)
            .within(Menu::File, 0),
        Entry::new("Open by path…", "A dataset or a study, by its path; ~ is the home directory", form(FormKind::Open))
            .keys(CTRL_SHIFT, Key::O)
            .within(Menu::File, 0),
        Entry::new("Open the example", "The simulated dataset that comes with the program", Command::OpenExample)
            .within(Menu::File, 0),
        Entry::new(
            "Put models together…",
            "A dataset of a folder of model files: MATLAB, NumPy, JSON, text",
            Command::Assembling(AssemblingCommand::Open),
        )
        .within(Menu::File, 0),
        Entry::new("Save study", "Where it was saved last", Command::SaveStudy)
            .keys(CTRL, Key::S)
            .within(Menu::File, 1),
        Entry::new("Save study as…", "With the desktop's dialog", Command::AskSaveStudy)
            .keys(CTRL_SHIFT, Key::S)
            .within(Menu::File, 1),
        Entry::new(
            "Export corrections…",
            "Write corrections.json, corrections.csv and assessment.csv",
            form(FormKind::Export),
        )
        .keys(CTRL, Key::E)
        .within(Menu::File, 2)
        .enabled(state.analysis().is_some()),
        Entry::new(
            "Write report…",
            "All that was done and found as one page to print, with every plot",
            Command::AskReport,
        )
        .within(Menu::File, 2)
        .enabled(state.analysis().is_some()),
        Entry::new(
            "Export as…",
            "For MATLAB, Python, C or a lookup table; corrected models as state-space",
            form(FormKind::ExportAs),
        )
        .within(Menu::File, 2)
        .enabled(state.analysis().is_some()),
        Entry::new("Quit", "Close the window", Command::Quit).keys(CTRL, Key::Q).within(Menu::File, 3),
    ]
}

fn edit_entries(state: &State) -> Vec<Entry> {
    let step = |verb: &str, label: Option<&str>| label.map_or(verb.to_owned(), |label| format!("{verb} {label}"));
    let (undo, redo) = (state.history.undo_label(), state.history.redo_label());
    let condition = state.condition().id();
    let choice = state.study.choice(condition);
    let suggested = open_suggestions(state);
    let reject = match suggested.len() {
        0 => "Reject suggested".to_owned(),
        count => format!("Reject {count} suggested"),
    };
    let any_rejected = !choice.physics.rejected.is_empty() || !choice.identified.rejected.is_empty();
    let (scheduled, pair) = (choice.scheduled, state.display.pair);
    let schedule =
        if scheduled { "Leave this condition out of the schedule" } else { "Take this condition into the schedule" };
    vec![
        Entry::new(step("Undo", undo), "Take the last decision back", Command::Undo)
            .keys(CTRL, Key::Z)
            .within(Menu::Edit, 0)
            .enabled(undo.is_some()),
        Entry::new(step("Redo", redo), "Bring a decision taken back again", Command::Redo)
            .keys(CTRL_SHIFT, Key::Z)
            .keys(CTRL, Key::Y)
            .within(Menu::Edit, 0)
            .enabled(redo.is_some()),
        Entry::new(
            reject,
            "Reject the suggested outliers of this condition",
            Edit::RejectAll { condition, models: suggested.clone() }.into(),
        )
        .keys(CTRL, Key::R)
        .within(Menu::Edit, 1)
        .enabled(!suggested.is_empty()),
        Entry::new(
            "Restore all models of this condition",
            "Put every rejected model of this condition back",
            Edit::RestoreAll { condition }.into(),
        )
        .within(Menu::Edit, 1)
        .enabled(any_rejected),
        hold_entry(state, pair).free_key(Key::Space).within(Menu::Edit, 2),
        Entry::new(
            "Hold exactly the on-axis responses",
            "As the dataset names them, and no others",
            Edit::ConstrainOnAxis.into(),
        )
        .within(Menu::Edit, 2),
        Entry::new(
            schedule,
            "Whether its gains enter the regression over airspeed",
            Edit::SetScheduled { condition, scheduled: !scheduled }.into(),
        )
        .within(Menu::Edit, 3),
    ]
}

/// "Hold LON → Q" or "Free LON → Q"; a response that has no G cannot be held.
pub(super) fn hold_entry(state: &State, pair: Pair) -> Entry {
    let held = state.study.settings.constrained[pair];
    let verb = if held { "Free" } else { "Hold" };
    let is_undefined = state.shown().is_some_and(|shown| shown.comparison.undefined[pair].is_some());
    Entry::new(
        format!("{verb} {} exactly", state.dataset().pair_name(pair)),
        "Hold a response exactly, or leave it to the fit",
        Edit::Hold(pair, !held).into(),
    )
    .enabled(held || !is_undefined)
}

/// The models of the condition shown that are suggested as outliers and not rejected.
pub fn open_suggestions(state: &State) -> Vec<String> {
    let rejected = &state.study.choice(state.condition().id()).physics.rejected;
    let suggested = state.shown().map(|shown| shown.suggested()).unwrap_or_default();
    suggested.into_iter().filter(|model| !rejected.contains(model)).collect()
}

fn view_entries(state: &State) -> Vec<Entry> {
    let (unit_name, unit) = match state.display.unit {
        FrequencyUnit::RadPerSecond => ("Frequencies in Hz", FrequencyUnit::Hertz),
        FrequencyUnit::Hertz => ("Frequencies in rad/s", FrequencyUnit::RadPerSecond),
    };
    let mut entries = vec![
        Entry::new("Fit the plots", "Bring every curve back into view", Command::FitPlots)
            .free_key(Key::F)
            .within(Menu::View, 0),
        Entry::new(unit_name, "In every plot over frequency", Command::SetFrequencyUnit(unit)).within(Menu::View, 0),
    ];
    entries.extend(steps(state));
    let show = |view: View| {
        Entry::new(format!("Show {}", view.name()), view.kind().purpose, Command::ShowView(view)).within(Menu::View, 2)
    };
    entries.extend(View::ALL.map(show));
    let arrange = |preset: Preset| Entry::new(preset.name(), ARRANGED, Command::Arrange(preset)).within(Menu::View, 3);
    entries.extend(Preset::ALL.map(arrange));
    entries.extend([
        Entry::new("Next part of the window", PARTS, Command::LeaveRegion { forward: true })
            .keys(Modifiers::NONE, Key::F6)
            .within(Menu::View, 4),
        Entry::new("Previous part of the window", PARTS, Command::LeaveRegion { forward: false })
            .keys(Modifiers::SHIFT, Key::F6)
            .within(Menu::View, 4),
    ]);
    let themes = [
        ("Theme of the desktop", "Light or dark as the desktop is", ThemePreference::System),
        ("Dark theme", "Light text on a dark ground", ThemePreference::Dark),
        ("Light theme", "Dark text on a light ground", ThemePreference::Light),
    ];
    let theme = |(name, meaning, theme)| Entry::new(name, meaning, Command::SetTheme(theme)).within(Menu::View, 5);
    entries.extend(themes.map(theme));
    entries
}

const ARRANGED: &str = "Every plot goes back to its place in this arrangement";
const PARTS: &str = "Conditions, models, plots, matrix, settings, result; each remembers what had the focus in it";

/// To the neighbours of the condition and of the response shown.
fn steps(state: &State) -> [Entry; 4] {
    let conditions = state.dataset().conditions();
    let here = conditions.iter().position(|condition| condition.id() == state.condition().id()).unwrap_or(0);
    let to_condition = |name, key, place: Option<usize>| {
        let found = place.and_then(|place| conditions.get(place));
        let command = Command::SelectCondition(found.unwrap_or(&conditions[here]).id());
        Entry::new(name, "In the order of the list", command)
            .free_key(key)
            .within(Menu::View, 1)
            .enabled(found.is_some())
    };
    let (inputs, outputs) = (state.dataset().inputs().len(), state.dataset().outputs().len());
    let at = state.display.pair.output * inputs + state.display.pair.input;
    let to_response = |name, key, place: Option<usize>| {
        let found = place.filter(|place| *place < inputs * outputs);
        let place = found.unwrap_or(at);
        let command = Command::FocusPair(Pair::new(place / inputs, place % inputs));
        Entry::new(name, "Row by row of the matrix", command)
            .free_key(key)
            .within(Menu::View, 1)
            .enabled(found.is_some())
    };
    [
        to_condition("Next condition", Key::ArrowDown, Some(here + 1)),
        to_condition("Previous condition", Key::ArrowUp, here.checked_sub(1)),
        to_response("Next response", Key::ArrowRight, Some(at + 1)),
        to_response("Previous response", Key::ArrowLeft, at.checked_sub(1)),
    ]
}

/// Every choice of every setting, and the way to every field of one.
fn setting_entries(state: &State) -> Vec<Entry> {
    let mut entries = Vec::new();
    for setting in SETTINGS.into_iter().filter(|setting| setting.control.place != Place::Hidden) {
        let mut field = |what: String, label| {
            let name = format!("Set the {what} ({})…", setting.option.trim_start_matches('-'));
            entries.push(Entry::new(name, "Goes to its field", Command::FocusField(label)));
        };
        match setting.kind {
            Kind::Number { .. } | Kind::Optional { .. } => field(setting.name.to_owned(), setting.control.label),
            Kind::Range { ends, .. } => {
                field(format!("lower end of the {}", setting.name), ends[0]);
                field(format!("upper end of the {}", setting.name), ends[1]);
            }
            Kind::Choice { words, get, .. } => {
                let now = get(&state.study.settings);
                entries.extend(words.iter().enumerate().map(|(index, [_, text, _])| {
                    let name = format!("{}: {text}", setting.control.label);
                    Entry::new(name, setting.help, setting.to(Value::Choice(index)).into()).enabled(index != now)
                }));
            }
            Kind::Flag { .. } => {}
        }
    }
    entries
}

fn help_entries() -> [Entry; 4] {
    let form = |form| Command::ShowForm(Some(form));
    [
        Entry::new("Command palette", "Find any command by its name", form(FormKind::Palette))
            .keys(CTRL, Key::K)
            .within(Menu::Help, 0),
        Entry::new("Keys and gestures", "Every key, and what the pointer does", form(FormKind::Shortcuts))
            .keys(Modifiers::NONE, Key::F1)
            .within(Menu::Help, 0),
        Entry::new("Guided tour", "Five steps through the window", Command::StartTour).within(Menu::Help, 0),
        Entry::new("About gdcm", "Version and licence", form(FormKind::About)).within(Menu::Help, 1),
    ]
}

/// Those of the table, and one for each condition, response, model and recent file.
pub fn every_command(state: &State) -> Vec<Entry> {
    let mut entries = command_table(state);
    entries.retain(|entry| entry.command != Command::ShowForm(Some(FormKind::Palette)));
    entries.extend(PairSet::ALL.map(|set| {
        Entry::new(format!("Net gains of the responses {}", set.name()), set.purpose(), Command::ShowNetGains(set))
    }));
    entries.extend(state.dataset().conditions().iter().map(|condition| {
        let (id, flight_state) = (condition.id(), condition.flight_state());
        let name = format!("Condition {id} · {}", flight_state.name);
        Entry::new(name, "Show this condition", Command::SelectCondition(id))
    }));
    for pair in state.dataset().on_axis().pairs() {
        let name = state.dataset().pair_name(pair);
        entries.push(Entry::new(format!("Show {name}"), "In the plots of one response", Command::FocusPair(pair)));
        if pair != state.display.pair {
            entries.push(hold_entry(state, pair));
        }
    }
    entries.extend(model_entries(state));
    entries.extend(state.recent.iter().map(|file| {
        let name = format!("Open recent {} in {}", file.name, file.folder);
        Entry::new(name, "Opened or saved of late", Command::Open(file.path.clone())).enabled(!file.missing)
    }));
    entries
}

/// What can be done with each model of the condition shown.
fn model_entries(state: &State) -> Vec<Entry> {
    let condition = state.condition();
    let choice = state.study.choice(condition.id());
    let mut entries = Vec::new();
    for bundle in [BundleKind::Physics, BundleKind::Identified] {
        for model in condition.bundle(bundle) {
            let id = ModelId::new(condition.id(), bundle, &model.name);
            let name = &model.name;
            if choice.bundle(bundle).rejected.contains(name) {
                let restore = Edit::Restore(id).into();
                entries.push(Entry::new(format!("Restore {bundle} model {name}"), "Put it back", restore));
                let ask = Command::AskReason(ModelId::new(condition.id(), bundle, name));
                let text = format!("Say why {bundle} model {name} is rejected…");
                entries.push(Entry::new(text, "In words, kept in the study", ask));
                continue;
            }
            let reject = Edit::Reject(id.clone()).into();
            entries.push(Entry::new(format!("Reject {bundle} model {name}"), "Take it out of its bundle", reject));
            let ask = Command::AskReason(id.clone());
            let text = format!("Reject {bundle} model {name} with a reason…");
            entries.push(Entry::new(text, "In words, kept in the study", ask));
            let (text, edit) = if choice.bundle(bundle).pinned.as_ref() == Some(name) {
                ("Unpin", Edit::Unpin { condition: condition.id(), bundle })
            } else {
                ("Pin", Edit::Pin(id))
            };
            let meaning = "Whether it represents its bundle whatever the medoid is";
            entries.push(Entry::new(format!("{text} {bundle} model {name}"), meaning, edit.into()));
        }
    }
    entries
}
