//! How a value was computed and what decisions would cost: the sheet of a derivation, and the menus that open it.

use std::collections::BTreeSet;

use egui::{CursorIcon, Grid, Label, Response, RichText, Sense, Ui, WidgetText};

use gdcm_core::correction::Channel;
use gdcm_core::dataset::Pair;
use gdcm_core::study::{
    ConditionAnalysis, Derivation, Edit, ExplainTarget, Remark, SignRole, derivation, no_couplings, remarks,
};

use super::palette::{TITLE_SIZE, medium};
use super::views::used_couplings;
use super::{Command, Palette, SMALL_SIZE, State, entries_ui};

/// What asks for a derivation, everywhere.
pub const QUESTION: &str = "How was this computed?";

/// How the value asked about was computed, in a sheet; it follows the results while it is open.
pub fn derivation_sheet_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(asked) = &state.display.asked else { return };
    let found = state.analysis_with_bars().and_then(|analysis| derivation(&analysis, asked));
    match &found {
        Some(found) => {
            derivation_ui(ui, found, palette, commands);
            toggle_costs_ui(ui, state, asked, palette);
        }
        None => {
            ui.label("There is no such value now");
            ui.label(state.results.absence());
        }
    }
}

fn derivation_ui(ui: &mut Ui, found: &Derivation, palette: &Palette, commands: &mut Vec<Command>) {
    ui.label(RichText::new(&found.title).font(medium(TITLE_SIZE)));
    ui.add_space(4.0);
    ui.label(&found.equation);
    ui.add_space(4.0);
    for step in &found.with_numbers {
        ui.label(step);
    }
    ui.add_space(4.0);
    Grid::new("terms of the equation").num_columns(2).min_row_height(14.0).spacing([10.0, 2.0]).show(ui, |ui| {
        for (symbol, meaning) in found.terms() {
            ui.label(RichText::new(symbol).size(SMALL_SIZE));
            ui.add(Label::new(palette.small(meaning)).wrap());
            ui.end_row();
        }
    });
    ui.add_space(4.0);
    ui.label(palette.small("It rests on"));
    for part in &found.rests_on {
        ui.label(RichText::new(part).size(SMALL_SIZE));
    }
    ui.horizontal(|ui| {
        if ui.button("Copy the derivation").clicked() {
            commands.push(Command::CopyText(text_of(found)));
        }
        ui.label(palette.small(found.section));
    });
}

/// What holding or freeing the response that is asked about would cost.
fn toggle_costs_ui(ui: &mut Ui, state: &State, asked: &ExplainTarget, palette: &Palette) {
    let (ExplainTarget::DeltaGain(condition, pair) | ExplainTarget::DeltaDelay(condition, pair)) = asked else {
        return;
    };
    let costs = if *condition == state.condition().id() { toggle_costs(state, *pair) } else { Vec::new() };
    if !costs.is_empty() {
        ui.add_space(4.0);
        ui.label(palette.small("What holding or freeing it would cost"));
    }
    for cost in costs {
        ui.label(RichText::new(cost).size(SMALL_SIZE));
    }
}

/// The derivation as lines of text, the symbols with tabs before what they stand for.
pub fn text_of(found: &Derivation) -> String {
    let heads = [&found.title, &found.equation].into_iter().chain(&found.with_numbers).cloned();
    let terms = found.terms().into_iter().map(|(symbol, meaning)| format!("{symbol}\t{meaning}"));
    let lines = heads.chain(terms).chain(found.rests_on.iter().cloned()).chain([found.section.to_owned()]);
    lines.collect::<Vec<_>>().join("\n")
}

/// A value whose click asks how it was computed.
pub fn value_label_ui(
    ui: &mut Ui,
    text: impl Into<WidgetText>,
    asked: ExplainTarget,
    commands: &mut Vec<Command>,
) -> Response {
    let response = ui.add(Label::new(text).sense(Sense::click()).selectable(false));
    if response.clicked() {
        commands.push(Command::Explain(Some(asked)));
    }
    response.on_hover_cursor(CursorIcon::Help)
}

/// The part of a menu that asks how values were computed.
pub fn question_menu_ui(ui: &mut Ui, values: Vec<(String, ExplainTarget)>, commands: &mut Vec<Command>) {
    ui.menu_button(QUESTION, |ui| {
        entries_ui(ui, values.into_iter().map(|(name, asked)| (name, Command::Explain(Some(asked)))), commands);
    });
}

/// What turns the models of a channel, or puts them back, with its label.
pub fn turn_entry(state: &State, channel: Channel, of: Option<SignRole>) -> (String, Command) {
    let (inputs, outputs) = state.dataset().names_of_channels();
    let name = channel.name(&inputs, &outputs);
    let label = if of.is_some() { format!("Turn {name}") } else { format!("Turn {name} back") };
    (label, Edit::SetSign { channel, of }.into())
}

/// The remarks on the result shown, on the schedule, and on the couplings that are used.
pub fn remarks_shown(state: &State, shown: &ConditionAnalysis) -> Vec<Remark> {
    let schedule = state.analysis().and_then(|analysis| analysis.schedule.as_ref().ok());
    let mut remarks = remarks(&state.study, shown, schedule);
    remarks.extend(coupling_remarks(state));
    remarks
}

/// What couplings that are used are worth and cost, or why there are none; nothing where none are asked for.
pub fn coupling_remarks(state: &State) -> Vec<Remark> {
    match (state.analysis().map(|analysis| analysis.asked_couplings()), used_couplings(state)) {
        (Some(Err(why)), _) => vec![no_couplings(&why)],
        (Some(Ok(Some(_))), Some(assessment)) => assessment.consequences(state.dataset()),
        _ => Vec::new(),
    }
}

/// The responses and the channels that are in each other's way, of the gains; channels of another sign or unit too.
pub fn gain_conflict_marks(shown: &ConditionAnalysis) -> (BTreeSet<Pair>, BTreeSet<Channel>) {
    let conflicts = &shown.gains.conflicts;
    let pairs = conflicts.iter().flat_map(|conflict| conflict.entries.iter().copied()).collect();
    let doubted = shown.doubts.iter().map(|doubt| doubt.channel);
    (pairs, conflicts.iter().flat_map(|conflict| conflict.channels()).chain(doubted).collect())
}

/// What holding or freeing a response would cost, in words; nothing until the table of all toggles of this very result is computed.
pub fn toggle_costs(state: &State, pair: Pair) -> Vec<String> {
    let Some(toggles) = state.toggles() else {
        return Vec::new();
    };
    let (inputs, outputs) = state.dataset().names_of_channels();
    let (gain, delay) = toggles.of_pair(pair);
    let gain = gain.map(|toggle| format!("Gains: {}", toggle.words(&inputs, &outputs)));
    let delay = delay.map(|toggle| format!("Delays: {}", toggle.words(&inputs, &outputs)));
    gain.into_iter().chain(delay).collect()
}
