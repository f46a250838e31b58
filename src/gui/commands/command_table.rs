//! Table of all commands: the source of the menus, the shortcuts, the palette and the page of keys.

use egui::{Key, Modifiers, ThemePreference};

use gdcm_model::dataset::{BundleKind, ModelId, Pair};
use gdcm_plot::figure::FigureFormat;
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_study::Edit;
use gdcm_study::decisions::adopted_models::OfferedModels;
use gdcm_study::decisions::setting::SETTINGS;
use gdcm_study::decisions::setting_row::{Kind, Value};

use super::assembling::AssemblingCommand;
use super::command::Command;
use super::curve_entries::curve_entries;
use super::entry::{Entry, Menu};
use super::records::RecordsCommand;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::commands::study::StudyCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::opens_with::OpensWith;
use crate::gui::state::pair_set::PairSet;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::tables::TableKind;
use crate::gui::state::view::{View, ViewGroup, views_with_figure};
use crate::gui::state::window_state::State;

/// Builds the entries of a group of a menu.
pub fn group<const N: usize>(
    menu: Menu,
    group: u8,
    entries: [Entry; N],
) -> impl Iterator<Item = Entry> {
    entries
        .into_iter()
        .map(move |entry| entry.within(menu, group))
}

const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers {
    shift: true,
    ..Modifiers::COMMAND
};

/// Returns the commands of the menus and keys, in the order of the menus and of the page of keys.
pub fn command_table(state: &State) -> Vec<Entry> {
    let mut entries = file_entries(state);
    entries.extend(edit_entries(state));
    entries.extend(view_entries(state));
    entries.extend(curve_entries(state));
    entries.extend(setting_entries(state));
    entries.extend(record_entries(state));
    for kind in TableKind::ALL {
        let copy = format!("Copy table: {}", kind.name());
        let save = format!("Save table: {}…", kind.name());
        entries.push(Entry::new(
            copy,
            "As text, one line a row",
            OutputCommand::CopyTable(kind),
        ));
        entries.push(Entry::new(
            save,
            "As a CSV file",
            OutputCommand::AskSaveTable(kind),
        ));
    }
    for view in views_with_figure() {
        let copy = format!("Copy numbers of {}", view.name());
        let save = format!("Save figure: {}…", view.name());
        entries.push(Entry::new(
            copy,
            "As CSV, to the clipboard",
            OutputCommand::CopyFigure(view),
        ));
        let command = Command::Output(OutputCommand::AskSaveFigure(view, FigureFormat::Svg));
        entries.push(Entry::new(
            save,
            "As SVG, PNG or PDF, or its numbers as CSV",
            command,
        ));
    }
    entries.extend(help_entries());
    entries
}

/// Returns the command that shows a form.
fn form(form: FormKind) -> Command {
    Command::Form(FormCommand::ShowForm(Some(form)))
}

fn file_entries(state: &State) -> Vec<Entry> {
    let open = [
        Entry::new(
            "Open…",
            "A dataset or a study, with the desktop's dialog",
            FileCommand::AskOpen,
        )
        .keys(CTRL, Key::O),
        Entry::new(
            "Open by path…",
            "A dataset or a study, by its path; ~ is the home directory",
            form(FormKind::Open),
        )
        .keys(CTRL_SHIFT, Key::O),
        Entry::new(
            "Open the example",
            "The simulated dataset that comes with the program",
            FileCommand::OpenExample,
        ),
        Entry::new(
            "Import models…",
            "A dataset of a folder of model files: MATLAB, NumPy, JSON, text",
            AssemblingCommand::Open,
        ),
        Entry::new(
            "Add flight records…",
            "Of the condition that their names say, or of the one shown",
            RecordsCommand::AskFiles,
        ),
    ];
    let save = [
        Entry::new(
            "Save study",
            "Where it was saved last",
            FileCommand::SaveStudy,
        )
        .keys(CTRL, Key::S),
        Entry::new(
            "Save study as…",
            "With the desktop's dialog",
            FileCommand::AskSaveStudy,
        )
        .keys(CTRL_SHIFT, Key::S),
    ];
    let words = "Write corrections.json, corrections.csv and assessment.csv";
    let export = [
        Entry::new("Export corrections…", words, form(FormKind::Export)).keys(CTRL, Key::E),
        Entry::new(
            "Write report…",
            "All that was done and found as one page to print, with every plot",
            OutputCommand::AskReport,
        ),
        Entry::new(
            "Export as…",
            "For MATLAB, Python, C or a lookup table; corrected models as state-space",
            form(FormKind::ExportAs),
        ),
    ];
    let export = export.map(|entry| entry.enabled(state.analysis().is_some()));
    let pages = [
        Entry::new(
            "Close",
            "Put away what is open, and show the start page",
            FileCommand::CloseStudy,
        )
        .keys(CTRL, Key::W),
        Entry::new(
            "Start page",
            "Three ways in, and what was open of late",
            LayoutCommand::ShowStart(true),
        ),
    ];
    let begin = |what: OpensWith| {
        let entry = Entry::new(
            what.name(),
            "When the program is started without a file",
            LayoutCommand::BeginWith(what),
        );
        entry.enabled(state.display.layout.opens_with != what)
    };
    let quit = [Entry::new("Quit", "Close the window", FileCommand::Quit).keys(CTRL, Key::Q)];
    let menu = Menu::File;
    let entries = group(menu, 0, open)
        .chain(group(menu, 1, save))
        .chain(group(menu, 2, export));
    let entries =
        entries
            .chain(group(menu, 3, pages))
            .chain(group(menu, 4, OpensWith::ALL.map(begin)));
    entries.chain(group(menu, 5, quit)).collect()
}

/// Returns the actions on the flight records of the displayed condition.
fn record_entries(state: &State) -> [Entry; 4] {
    let condition = state.condition().id();
    let of = |id| state.records.conditions.get(&id);
    let has_records = of(condition).is_some_and(|records| records.used_rows().next().is_some());
    let is_found = of(condition).is_some_and(|records| records.identification().is_some());
    let is_taken = state.study.taken_models().any(|(id, _)| id == condition);
    let all = state
        .records
        .conditions
        .values()
        .any(|records| records.used_rows().next().is_some());
    let entry = |name, meaning, command: RecordsCommand| Entry::new(name, meaning, command);
    let here = "Into the condition shown";
    [
        entry(
            "Identify models",
            "Of the condition shown, from its flight records",
            RecordsCommand::Identify,
        )
        .enabled(has_records),
        entry(
            "Identify models of all conditions",
            "From their flight records",
            RecordsCommand::IdentifyAll,
        )
        .enabled(all),
        entry(
            "Use the identified models",
            here,
            RecordsCommand::Take(OfferedModels::REFINED),
        )
        .enabled(is_found),
        entry(
            "Restore the file's identified models",
            here,
            RecordsCommand::Return,
        )
        .enabled(is_taken),
    ]
}

fn edit_entries(state: &State) -> Vec<Entry> {
    let step = |verb: &str, label: Option<&str>| {
        label.map_or(verb.to_owned(), |label| format!("{verb} {label}"))
    };
    let undo = state.history.undo_label();
    let redo = state.history.redo_label();
    let condition = state.condition().id();
    let choice = state.study.choice(condition);
    let models = state
        .shown()
        .map(|shown| state.open_suggestions(shown))
        .unwrap_or_default();
    let reject = match models.len() {
        0 => "Reject suggested".to_owned(),
        count => format!("Reject {count} suggested"),
    };
    let is_any_suggested = !models.is_empty();
    let scheduled = choice.scheduled;
    let is_any_rejected =
        !choice.physics.rejected.is_empty() || !choice.identified.rejected.is_empty();
    let schedule = if scheduled {
        "Leave this condition out of the schedule"
    } else {
        "Include this condition in the schedule"
    };
    let edit = |name: String, meaning, edit: Edit| Entry::new(name, meaning, edit);
    let history = [
        Entry::new(
            step("Undo", undo),
            "Take the last decision back",
            StudyCommand::Undo,
        )
        .keys(CTRL, Key::Z)
        .enabled(undo.is_some()),
        Entry::new(
            step("Redo", redo),
            "Bring a decision taken back again",
            StudyCommand::Redo,
        )
        .keys(CTRL_SHIFT, Key::Z)
        .keys(CTRL, Key::Y)
        .enabled(redo.is_some()),
    ];
    let restore = "Put every rejected model of this condition back";
    let models = [
        edit(
            reject,
            "Reject the suggested outliers of this condition",
            Edit::reject_physics(condition, &models),
        )
        .keys(CTRL, Key::R)
        .enabled(is_any_suggested),
        edit(
            "Restore all models of this condition".to_owned(),
            restore,
            Edit::RestoreAll { condition },
        )
        .enabled(is_any_rejected),
    ];
    let on_axis = "Hold exactly the on-axis responses".to_owned();
    let held = [
        hold_entry(state, state.display.selection.pair).free_key(Key::Space),
        edit(
            on_axis,
            "As the dataset names them, and no others",
            Edit::ConstrainOnAxis,
        ),
    ];
    let scheduled = Edit::SetScheduled {
        condition,
        scheduled: !scheduled,
    };
    let scheduled = [edit(
        schedule.to_owned(),
        "Whether its gains enter the regression over airspeed",
        scheduled,
    )];
    let menu = Menu::Edit;
    let entries = group(menu, 0, history)
        .chain(group(menu, 1, models))
        .chain(group(menu, 2, held));
    entries.chain(group(menu, 3, scheduled)).collect()
}

/// Returns "Hold LON → Q exactly" or "Release LON → Q"; a response without G cannot be constrained.
pub(crate) fn hold_entry(state: &State, pair: Pair) -> Entry {
    let held = state.study.settings.constrained[pair];
    let name = state.dataset().pair_name(pair);
    let is_undefined = state
        .shown()
        .is_some_and(|shown| shown.comparison.undefined[pair].is_some());
    Entry::new(
        if held {
            format!("Release {name}")
        } else {
            format!("Hold {name} exactly")
        },
        "Hold its net gain exactly, and its delay where one can, or leave both to the fit",
        Edit::Hold(pair, !held),
    )
    .enabled(held || !is_undefined)
}

fn view_entries(state: &State) -> Vec<Entry> {
    let (unit_name, unit) = match state.display.curves.unit {
        FrequencyUnit::RadPerSecond => ("Frequencies in Hz", FrequencyUnit::Hertz),
        FrequencyUnit::Hertz => ("Frequencies in rad/s", FrequencyUnit::RadPerSecond),
    };
    let plots = [
        Entry::new(
            "Fit the plots",
            "Bring every curve back into view",
            DisplayCommand::FitPlots,
        )
        .free_key(Key::F),
        Entry::new(
            unit_name,
            "In every plot over frequency",
            DisplayCommand::SetFrequencyUnit(unit),
        ),
    ];
    let show = |view: View| {
        Entry::new(
            format!("Show {}", view.name()),
            view.facts().purpose,
            LayoutCommand::ShowView(view),
        )
    };
    let parts = [
        (Modifiers::NONE, "Next part of the window", true),
        (Modifiers::SHIFT, "Previous part of the window", false),
    ];
    let part = |(modifiers, name, forward)| {
        Entry::new(name, PARTS, LayoutCommand::LeaveRegion { forward }).keys(modifiers, Key::F6)
    };
    let themes = [
        (
            "Theme of the desktop",
            "Light or dark as the desktop is",
            ThemePreference::System,
        ),
        (
            "Dark theme",
            "Light text on a dark background",
            ThemePreference::Dark,
        ),
        (
            "Light theme",
            "Dark text on a light background",
            ThemePreference::Light,
        ),
    ];
    let theme = |(name, meaning, theme)| Entry::new(name, meaning, LayoutCommand::SetTheme(theme));
    let menu = Menu::View;
    let entries = group(menu, 0, plots)
        .chain(group(menu, 1, steps(state)))
        .chain(View::ALL.map(show));
    let entries = entries
        .chain(layout_entries(state))
        .chain(group(menu, 4, parts.map(part)));
    entries.chain(group(menu, 5, themes.map(theme))).collect()
}

const PARTS: &str = "Plots, dock, verdict, result, matrix, settings, conditions, models; each remembers what had the focus in it";

/// Returns the entries for groups of views, their neighbours, panels and folds.
fn layout_entries(state: &State) -> Vec<Entry> {
    let arrangement = &state.display.layout.arrangement;
    let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4];
    let groups = ViewGroup::ALL.into_iter().zip(keys).map(|(group, key)| {
        let command = Command::Layout(LayoutCommand::ShowGroup(group));
        Entry::new(
            format!("Views: {}", group.name()),
            "The group, with the view that it showed last",
            command,
        )
        .keys(Modifiers::ALT, key)
    });
    let neighbours = [
        ("Next view", Key::ArrowRight, 1),
        ("Previous view", Key::ArrowLeft, -1),
    ];
    let neighbours = neighbours.map(|(name, key, by)| {
        Entry::new(
            name,
            "Of the group in front",
            LayoutCommand::ShowView(arrangement.neighbour(by)),
        )
        .keys(Modifiers::ALT, key)
    });
    let display = &state.display;
    let is_left_open = display.layout.left_open.unwrap_or(display.layout.is_wide);
    let is_dock_open = arrangement.is_dock_open(true);
    let switches = [
        Entry::new(
            if is_left_open {
                "Conditions as a rail"
            } else {
                "Conditions and models in full"
            },
            "The left side of the window",
            LayoutCommand::ShowLeft(!is_left_open),
        )
        .keys(CTRL, Key::B),
        Entry::new(
            if display.layout.settings_open {
                "Fold the settings"
            } else {
                "Unfold the settings"
            },
            "In place of matrix and card",
            LayoutCommand::ShowSettings(!display.layout.settings_open),
        )
        .keys(CTRL, Key::Comma),
        Entry::new(
            if is_dock_open {
                "Fold the dock"
            } else {
                "Unfold the dock"
            },
            "The plots below the view in front",
            LayoutCommand::OpenDock(!is_dock_open),
        ),
        Entry::new(
            "Why the result is so",
            "Its cautions, where a lag may come from, the proof",
            LayoutCommand::ShowSheet(Some(Sheet::Reasons)),
        ),
        Entry::new(
            "Reset the layout",
            "Every panel and plot goes back to its place",
            LayoutCommand::ResetLayout,
        ),
    ];
    groups
        .chain(neighbours)
        .chain(switches)
        .map(|entry| entry.within(Menu::View, 3))
        .collect()
}

/// Returns the steps to the neighbours of the displayed condition and response.
fn steps(state: &State) -> [Entry; 4] {
    let conditions = state.dataset().conditions();
    let here = conditions
        .iter()
        .position(|condition| condition.id() == state.condition().id())
        .unwrap_or(0);
    let to_condition = |name, key, place: Option<usize>| {
        let found = place.and_then(|place| conditions.get(place));
        let command = Command::Selection(SelectionCommand::SelectCondition(
            found.unwrap_or(&conditions[here]).id(),
        ));
        Entry::new(name, "In the order of the list", command)
            .free_key(key)
            .enabled(found.is_some())
    };
    let inputs = state.dataset().inputs().len();
    let outputs = state.dataset().outputs().len();
    let at = state.display.selection.pair.output * inputs + state.display.selection.pair.input;
    let to_response = |name, key, place: Option<usize>| {
        let found = place.filter(|place| *place < inputs * outputs);
        let place = found.unwrap_or(at);
        let command = Command::Selection(SelectionCommand::FocusPair(Pair::new(
            place / inputs,
            place % inputs,
        )));
        Entry::new(name, "Row by row of the matrix", command)
            .free_key(key)
            .enabled(found.is_some())
    };
    [
        to_condition("Next condition", Key::ArrowDown, Some(here + 1)),
        to_condition("Previous condition", Key::ArrowUp, here.checked_sub(1)),
        to_response("Next response", Key::ArrowRight, Some(at + 1)),
        to_response("Previous response", Key::ArrowLeft, at.checked_sub(1)),
    ]
}

/// Returns an entry for every choice of every setting, and for every field of a setting.
fn setting_entries(state: &State) -> Vec<Entry> {
    let mut entries = Vec::new();
    for setting in SETTINGS {
        let mut field = |what: String, label| {
            let name = format!(
                "Set the {what} ({})…",
                setting.option.trim_start_matches('-')
            );
            entries.push(Entry::new(
                name,
                "Goes to its field",
                LayoutCommand::FocusField(label),
            ));
        };
        match setting.kind {
            Kind::Number { .. } | Kind::Optional { .. } => {
                field(setting.name.to_owned(), setting.control.label)
            }
            Kind::Range { ends, .. } => {
                field(format!("lower end of the {}", setting.name), ends[0]);
                field(format!("upper end of the {}", setting.name), ends[1]);
            }
            Kind::Choice { words, get, .. } => {
                let now = get(&state.study.settings);
                entries.extend(words.iter().enumerate().map(|(index, [_, text, _])| {
                    let name = format!("{}: {text}", setting.control.label);
                    Entry::new(name, setting.help, setting.to(Value::Choice(index)))
                        .enabled(index != now)
                }));
            }
            Kind::Flag { .. } => {}
        }
    }
    entries
}

fn help_entries() -> impl Iterator<Item = Entry> {
    let help = [
        Entry::new(
            "Command palette",
            "Find any command by its name",
            form(FormKind::Palette),
        )
        .keys(CTRL, Key::K),
        Entry::new(
            "Keys and gestures",
            "Every key, and what the pointer does",
            form(FormKind::Shortcuts),
        )
        .keys(Modifiers::NONE, Key::F1),
        Entry::new(
            "Guided tour",
            "Five steps through the window",
            LayoutCommand::StartTour,
        ),
    ];
    let about = [Entry::new(
        "About gdcm",
        "Version and licence",
        form(FormKind::About),
    )];
    group(Menu::Help, 0, help).chain(group(Menu::Help, 1, about))
}

/// Returns the commands of the table, and an entry for each condition, response, model and recent
/// file.
pub fn every_command(state: &State) -> Vec<Entry> {
    let mut entries = command_table(state);
    entries.retain(|entry| {
        entry.command != Command::Form(FormCommand::ShowForm(Some(FormKind::Palette)))
    });
    entries.extend(PairSet::ALL.map(|set| {
        Entry::new(
            format!("Net gains of the responses {}", set.name()),
            set.purpose(),
            DisplayCommand::ShowNetGains(set),
        )
    }));
    entries.extend(state.dataset().conditions().iter().map(|condition| {
        let id = condition.id();
        let flight_state = condition.flight_state();
        let name = format!("Condition {id} · {}", flight_state.name);
        Entry::new(
            name,
            "Show this condition",
            SelectionCommand::SelectCondition(id),
        )
    }));
    for pair in state.dataset().on_axis().pairs() {
        let name = state.dataset().pair_name(pair);
        entries.push(Entry::new(
            format!("Show {name}"),
            "In the plots of one response",
            SelectionCommand::FocusPair(pair),
        ));
        if pair != state.display.selection.pair {
            entries.push(hold_entry(state, pair));
        }
    }
    entries.extend(model_entries(state));
    entries.extend(state.recent.iter().map(|file| {
        let name = format!("Open recent {} in {}", file.name, file.folder);
        Entry::new(
            name,
            "Opened or saved of late",
            FileCommand::Open(file.path.clone()),
        )
        .enabled(!file.missing)
    }));
    entries
}

/// Returns the actions on each model of the displayed condition.
fn model_entries(state: &State) -> Vec<Entry> {
    let condition = state.condition();
    let choice = state.study.choice(condition.id());
    let mut entries = Vec::new();
    for bundle in [BundleKind::Physics, BundleKind::Identified] {
        for name in condition.bundle(bundle).iter().map(|model| &model.name) {
            let id = ModelId::new(condition.id(), bundle, name);
            let choice = choice.bundle(bundle);
            let mut entry = |text: String, meaning, command: Command| {
                entries.push(Entry::new(text, meaning, command))
            };
            let ask = Command::Form(FormCommand::AskReason(id.clone()));
            let kept_in_words = "In words, kept in the study";
            if choice.rejected.contains(name) {
                entry(
                    format!("Restore {bundle} model {name}"),
                    "Put it back",
                    Edit::Restore(id).into(),
                );
                entry(
                    format!("Say why {bundle} model {name} is rejected…"),
                    kept_in_words,
                    ask,
                );
                continue;
            }
            let out = "Take it out of its bundle";
            entry(
                format!("Reject {bundle} model {name}"),
                out,
                Edit::Reject(id.clone()).into(),
            );
            entry(
                format!("Reject {bundle} model {name} with a reason…"),
                kept_in_words,
                ask,
            );
            let (text, edit) = if choice.pinned.as_ref() == Some(name) {
                let edit = Edit::Unpin {
                    condition: condition.id(),
                    bundle,
                };
                (
                    format!("Use the medoid as representative, not {bundle} model {name}"),
                    edit,
                )
            } else {
                (
                    format!("Use {bundle} model {name} as representative"),
                    Edit::Pin(id),
                )
            };
            entry(
                text,
                "Whether it is used as representative, whatever the medoid is",
                edit.into(),
            );
        }
    }
    entries
}
