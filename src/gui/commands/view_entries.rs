//! Command-table entries for the window layout: views, panels, steps, themes.
//!
//! The dock is the area below the views, with pages of its own. Leads are filters that advance the
//! phase (M15: docs/lead.md).

use std::sync::Arc;

use egui::{Key, Modifiers, ThemePreference};

use gdcm_model::dataset::{Condition, ConditionId, Pair};
use gdcm_plot::figure::axis::FrequencyUnit;

use super::display::DisplayCommand;
use super::entry::{CTRL, Entry, Menu, group};
use super::layout::LayoutCommand;
use super::selection::SelectionCommand;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::view::{View, ViewGroup};
use crate::gui::state::window_state::State;

/// Returns the entries in the View menu, and those that show a certain view, which are in the
/// palette only.
pub(super) fn view_entries(state: &State) -> Vec<Entry> {
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
    let show = View::ALL.map(|view| show_entry(view, state));
    group(Menu::View, 0, plots)
        .chain(group(Menu::View, 1, steps(state)))
        .chain(show)
        .chain(layout_entries(state))
        .chain(group(Menu::View, 4, region_entries()))
        .chain(group(Menu::View, 5, theme_entries()))
        .collect()
}

/// Returns the entry that shows a view, or a page in the dock. Without leads, their page is
/// disabled and the entry says how to get them.
fn show_entry(view: View, state: &State) -> Entry {
    let name = format!("Show {}", view.name());
    let purpose = view.facts().purpose;
    if !view.is_dock_page() {
        return Entry::new(name, purpose, LayoutCommand::ShowView(view));
    }
    let is_page = View::docked(state.study.settings.phase).any(|page| page == view);
    let meaning = if is_page { purpose } else { NO_LEADS };
    Entry::new(name, meaning, LayoutCommand::ShowInDock(view)).enabled(is_page)
}

/// Tooltip on the entry that shows the leads, while it is disabled.
const NO_LEADS: &str = "The study has no leads: choose \"Use leads\" in the verdict, or Settings, phase, \
    \"delay or lead\"";

/// Tooltip on the entries that move the focus between window regions.
const PARTS: &str = "Moves between plots, dock, verdict, result, matrix, settings, conditions and models; each \
    remembers the focused control";

fn region_entries() -> [Entry; 2] {
    [
        Entry::new(
            "Next part of the window",
            PARTS,
            LayoutCommand::LeaveRegion { forward: true },
        )
        .keys(Modifiers::NONE, Key::F6),
        Entry::new(
            "Previous part of the window",
            PARTS,
            LayoutCommand::LeaveRegion { forward: false },
        )
        .keys(Modifiers::SHIFT, Key::F6),
    ]
}

fn theme_entries() -> [Entry; 3] {
    [
        Entry::new(
            "Theme of the desktop",
            "Light or dark, like the desktop",
            LayoutCommand::SetTheme(ThemePreference::System),
        ),
        Entry::new(
            "Dark theme",
            "Light text on a dark background",
            LayoutCommand::SetTheme(ThemePreference::Dark),
        ),
        Entry::new(
            "Light theme",
            "Dark text on a light background",
            LayoutCommand::SetTheme(ThemePreference::Light),
        ),
    ]
}

/// Returns the entries for view groups, the neighbouring views and pages, and the parts of the
/// window.
fn layout_entries(state: &State) -> impl Iterator<Item = Entry> {
    view_group_entries()
        .into_iter()
        .chain(neighbour_entries(state))
        .chain(page_entries())
        .chain(fold_entries(state))
        .map(|entry| entry.within(Menu::View, 3))
}

fn view_group_entries() -> Vec<Entry> {
    let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4];
    let mut entries = Vec::new();
    for (group, key) in ViewGroup::ALL.into_iter().zip(keys) {
        let entry = Entry::new(
            format!("Views: {}", group.name()),
            "Shows this group, with the view that was last open in it",
            LayoutCommand::ShowGroup(group),
        );
        entries.push(entry.keys(Modifiers::ALT, key));
    }
    entries
}

fn page_entries() -> [Entry; 2] {
    let meaning = "In the displayed view, if it has pages";
    [
        Entry::new(
            "Next page",
            meaning,
            LayoutCommand::TurnPage { forward: true },
        )
        .keys(Modifiers::ALT, Key::PageDown),
        Entry::new(
            "Previous page",
            meaning,
            LayoutCommand::TurnPage { forward: false },
        )
        .keys(Modifiers::ALT, Key::PageUp),
    ]
}

fn neighbour_entries(state: &State) -> [Entry; 2] {
    let arrangement = &state.display.layout.arrangement;
    let meaning = "In the view group that is displayed";
    [
        Entry::new(
            "Next view",
            meaning,
            LayoutCommand::ShowView(arrangement.neighbour(1)),
        )
        .keys(Modifiers::ALT, Key::ArrowRight),
        Entry::new(
            "Previous view",
            meaning,
            LayoutCommand::ShowView(arrangement.neighbour(-1)),
        )
        .keys(Modifiers::ALT, Key::ArrowLeft),
    ]
}

/// Returns the entries for the left side, the settings, the dock, the reasons and the layout.
fn fold_entries(state: &State) -> [Entry; 6] {
    let display = &state.display;
    let is_left_open = display.layout.has_left_panel();
    let is_dock_open = display.layout.arrangement.is_dock_open(true);
    let is_dock_enlarged = display.layout.arrangement.is_dock_enlarged();
    [
        Entry::new(
            if is_left_open {
                "Reduce the left panel to a rail"
            } else {
                "Show the left panel in full"
            },
            "Conditions and models; the rail shows numbers, airspeeds and costs",
            LayoutCommand::ShowLeft(!is_left_open),
        )
        .keys(CTRL, Key::B),
        Entry::new(
            if display.layout.settings_open {
                "Fold the settings"
            } else {
                "Unfold the settings"
            },
            "Settings of the study, at the left of the window",
            LayoutCommand::ShowSettings(!display.layout.settings_open),
        )
        .keys(CTRL, Key::Comma),
        Entry::new(
            if is_dock_open {
                "Fold the dock"
            } else {
                "Unfold the dock"
            },
            "The plots below the displayed view",
            LayoutCommand::OpenDock(!is_dock_open),
        ),
        Entry::new(
            if is_dock_enlarged {
                "Restore the height of the dock"
            } else {
                "Enlarge the dock"
            },
            if is_dock_enlarged {
                "To the usual height; also: double-click the bar of the dock"
            } else {
                "To twice the usual height; also: double-click the bar of the dock"
            },
            LayoutCommand::EnlargeDock(!is_dock_enlarged),
        ),
        Entry::new(
            "Show the reasons for the result",
            "Cautions, possible causes of a lag, and the proof of optimality",
            LayoutCommand::ShowSheet(Some(Sheet::Reasons)),
        ),
        Entry::new(
            "Reset the layout",
            "Return every panel and plot to its default place",
            LayoutCommand::ResetLayout,
        ),
    ]
}

/// Returns the entries that step to the previous or next condition or response.
fn steps(state: &State) -> [Entry; 4] {
    let conditions = state.dataset().conditions();
    let shown = state.condition().id();
    let here = conditions
        .iter()
        .position(|condition| condition.id() == shown)
        .unwrap_or(0);
    let next = conditions.get(here + 1);
    let previous = here.checked_sub(1).map(|place| &conditions[place]);
    let inputs = state.dataset().inputs().len();
    let responses = inputs * state.dataset().outputs().len();
    let pair = state.display.selection.pair;
    let at = pair.output * inputs + pair.input;
    let next_response = if at + 1 < responses {
        Some(at + 1)
    } else {
        None
    };
    [
        condition_step("Next condition", next, shown).free_key(Key::ArrowDown),
        condition_step("Previous condition", previous, shown).free_key(Key::ArrowUp),
        response_step("Next response", next_response, at, inputs).free_key(Key::ArrowRight),
        response_step("Previous response", at.checked_sub(1), at, inputs).free_key(Key::ArrowLeft),
    ]
}

/// Returns the entry that steps to another condition; disabled at the end of the list.
fn condition_step(name: &str, other: Option<&Arc<Condition>>, shown: ConditionId) -> Entry {
    let target = match other {
        Some(condition) => condition.id(),
        None => shown,
    };
    let command = SelectionCommand::SelectCondition(target);
    Entry::new(name, "In the order of the list", command).enabled(other.is_some())
}

/// Returns the entry that steps to another response, numbered row by row; disabled at the end of
/// the matrix.
fn response_step(name: &str, other: Option<usize>, shown: usize, inputs: usize) -> Entry {
    let place = other.unwrap_or(shown);
    let pair = Pair::new(place / inputs, place % inputs);
    let command = SelectionCommand::FocusPair(pair);
    Entry::new(name, "Row by row through the matrix", command).enabled(other.is_some())
}
