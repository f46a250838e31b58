//! Sheets over the middle of the window that explain results: derivations of values and costs of
//! decisions, with the menus that open them; and the reasons for the result, possible sources of
//! lag, and the proof.

use std::collections::BTreeSet;

use egui::{
    Align, Area, Button, CollapsingHeader, CursorIcon, Frame, Grid, Id, Label, Layout, Margin,
    Order, Rect, Response, RichText, Role, ScrollArea, Sense, Stroke, Ui, WidgetText, vec2,
};

use gdcm_method::correction::sensitivity::kkt_residual;
use gdcm_method::correction::{Channel, GainObjective, Outcome, Quantity};
use gdcm_model::dataset::Pair;
use gdcm_study::decisions::setting;
use gdcm_study::decisions::signs::SignRole;
use gdcm_study::{ConditionAnalysis, Edit};
use gdcm_words::ExplainTarget;
use gdcm_words::caution::failure_text;
use gdcm_words::condition_remarks::{details, remarks};
use gdcm_words::couplings::{coupling_consequences, coupling_offer, no_couplings};
use gdcm_words::derivation::{Derivation, derivation};
use gdcm_words::leads::lead_words;
use gdcm_words::remark::{Remark, RemarkKind};

use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::{offered_couplings, used_couplings};
use crate::gui::widgets::controls::{Asks, QUESTION, button_ui, entries_ui, named};
use crate::gui::widgets::focus::take_escape;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, TITLE_SIZE, medium};

/// Draws a sheet over `centre`; returns whether it is to be closed.
pub fn sheet_ui(
    ui: &Ui,
    centre: Rect,
    sheet: Sheet,
    palette: &Palette,
    add: impl FnOnce(&mut Ui),
) -> bool {
    let (is_right, width) = sheet.place();
    let width = width.min(centre.width());
    let place = if is_right {
        centre.with_min_x(centre.right() - width)
    } else {
        centre.with_max_x(centre.left() + width)
    };
    let id = Id::unique(("sheet", sheet.title()));
    let mut is_closed = false;
    let shown = Area::new(id)
        .order(Order::Middle)
        .fixed_pos(place.min)
        .show(ui.ctx(), |ui| {
            let stroke = Stroke::new(1.0, palette.line);
            Frame::new()
                .fill(palette.panel)
                .stroke(stroke)
                .inner_margin(Margin::same(12))
                .show(ui, |ui| {
                    ui.set_min_size(place.size() - vec2(26.0, 26.0));
                    ui.set_max_size(place.size() - vec2(26.0, 26.0));
                    ui.horizontal(|ui| {
                        ui.label(RichText::new(sheet.title()).font(medium(BODY_SIZE)));
                        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                            is_closed =
                                named(ui.small_button("×"), Role::Button, "Close the sheet")
                                    .clicked();
                        });
                    });
                    ScrollArea::vertical()
                        .auto_shrink([false, false])
                        .show(ui, |ui| add(ui));
                });
        });
    // In its first frame the sheet still sees the click that opened it.
    let is_new = ui
        .ctx()
        .data_mut(|data| !std::mem::replace(data.get_temp_mut_or_default::<bool>(id), true));
    let beside = ui.input(|input| {
        let at = input
            .pointer
            .interact_pos()
            .filter(|_| input.pointer.any_pressed());
        at.is_some_and(|at| !shown.response.rect.contains(at))
    });
    let is_over = egui::Popup::is_any_open(ui.ctx());
    is_closed |= take_escape(ui.ctx()) || (beside && !is_new && !is_over);
    if is_closed {
        ui.ctx().data_mut(|data| data.remove::<bool>(id));
    }
    is_closed
}

/// Draws the derivation of a value in a sheet; it follows the results while it is open.
pub fn derivation_sheet_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(asked) = &state.display.selection.asked else {
        return;
    };
    let found = state
        .analysis_with_bars()
        .and_then(|analysis| derivation(&analysis, asked));
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
    Grid::new("terms of the equation")
        .num_columns(2)
        .min_row_height(14.0)
        .spacing([10.0, 2.0])
        .show(ui, |ui| {
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
            commands.push(OutputCommand::CopyText(text_of(found)).into());
        }
        ui.label(palette.small(found.section));
    });
}

/// Draws the costs of constraining or releasing the response in question.
fn toggle_costs_ui(ui: &mut Ui, state: &State, asked: &ExplainTarget, palette: &Palette) {
    let (ExplainTarget::DeltaGain(condition, pair) | ExplainTarget::DeltaDelay(condition, pair)) =
        asked
    else {
        return;
    };
    let costs = if *condition == state.condition().id() {
        toggle_costs(state, *pair)
    } else {
        Vec::new()
    };
    if !costs.is_empty() {
        ui.add_space(4.0);
        ui.label(palette.small("What holding or freeing it would cost"));
    }
    for cost in costs {
        ui.label(RichText::new(cost).size(SMALL_SIZE));
    }
}

/// Returns the derivation as lines of text, with tabs between the symbols and their meanings.
pub fn text_of(found: &Derivation) -> String {
    let heads = [&found.title, &found.equation]
        .into_iter()
        .chain(&found.with_numbers)
        .cloned();
    let terms = found
        .terms()
        .into_iter()
        .map(|(symbol, meaning)| format!("{symbol}\t{meaning}"));
    let lines = heads
        .chain(terms)
        .chain(found.rests_on.iter().cloned())
        .chain([found.section.to_owned()]);
    lines.collect::<Vec<_>>().join("\n")
}

/// Draws a value whose click opens its derivation.
pub fn value_label_ui(
    ui: &mut Ui,
    text: impl Into<WidgetText>,
    asked: ExplainTarget,
    commands: &mut Vec<Command>,
) -> Response {
    let response = ui.add(Label::new(text).sense(Sense::click()).selectable(false));
    response.asks(SelectionCommand::Explain(Some(asked)), commands);
    response.on_hover_cursor(CursorIcon::Help)
}

/// Draws the part of a menu that opens derivations.
pub fn question_menu_ui(
    ui: &mut Ui,
    values: Vec<(String, ExplainTarget)>,
    commands: &mut Vec<Command>,
) {
    ui.menu_button(QUESTION, |ui| {
        entries_ui(
            ui,
            values.into_iter().map(|(name, asked)| {
                (
                    name,
                    Command::Selection(SelectionCommand::Explain(Some(asked))),
                )
            }),
            commands,
        );
    });
}

/// Returns the label and the command that change the sign of a channel's models, or restore it.
pub fn turn_entry(state: &State, channel: Channel, of: Option<SignRole>) -> (String, Command) {
    let (inputs, outputs) = state.dataset().names_of_channels();
    let name = channel.name(&inputs, &outputs);
    let label = if of.is_some() {
        format!("Turn {name}")
    } else {
        format!("Turn {name} back")
    };
    (label, Edit::SetSign { channel, of }.into())
}

/// Returns the remarks on the displayed result, on the schedule, and on the couplings in use.
pub fn remarks_shown(state: &State, shown: &ConditionAnalysis) -> Vec<Remark> {
    let schedule = state
        .analysis()
        .and_then(|analysis| analysis.schedule.as_ref().ok());
    let mut remarks = remarks(&state.study, shown, schedule);
    remarks.extend(coupling_remarks(state));
    remarks
}

/// Returns the benefit and cost of the couplings in use, or the reason for their absence; empty if
/// none are requested.
pub fn coupling_remarks(state: &State) -> Vec<Remark> {
    match (
        state.analysis().map(|analysis| analysis.asked_couplings()),
        used_couplings(state),
    ) {
        (Some(Err(why)), _) => vec![no_couplings(&why)],
        (Some(Ok(Some(_))), Some(assessment)) => coupling_consequences(assessment, state.dataset()),
        _ => Vec::new(),
    }
}

/// Returns the responses and channels whose gain constraints conflict, including channels of
/// another sign or unit.
pub fn gain_conflict_marks(shown: &ConditionAnalysis) -> (BTreeSet<Pair>, BTreeSet<Channel>) {
    let conflicts = &shown.gains.conflicts;
    let pairs = conflicts
        .iter()
        .flat_map(|conflict| conflict.entries.iter().copied())
        .collect();
    let doubted = shown.doubts.iter().map(|doubt| doubt.channel);
    (
        pairs,
        conflicts
            .iter()
            .flat_map(|conflict| conflict.channels())
            .chain(doubted)
            .collect(),
    )
}

/// Describes the cost of constraining or releasing a response; empty until the table of all toggles
/// of this very result is computed.
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

/// Possible sources of a common lag, and the view that shows each; repairing the model there is
/// better than correcting it.
const CAUSES: [(&str, &str, &str, View); 4] = [
    (
        "Clock of the records",
        "A record whose outputs are stamped late lags by the same time in every response.",
        "Look at the records",
        View::Records,
    ),
    (
        "Integration and sampling",
        "A simulation that hands its outputs on one step late lags by that step in every response.",
        "Look at the differences",
        View::Error,
    ),
    (
        "Servos",
        "A slow servo lags in every response to its input, and in no other: compare the columns of the matrix.",
        "Look at the inputs",
        View::Channels,
    ),
    (
        "Sensors and their filters",
        "A slow sensor lags in every response of its output: compare the rows of the matrix.",
        "Look at the outputs",
        View::Channels,
    ),
];

/// Draws the sheet of reasons for the result of the displayed condition.
pub fn reasons_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(Ok(shown)) = state.outcome() else {
        let words = match state.outcome() {
            Some(Err(failure)) => failure_text(failure, state.dataset()),
            _ => state.results.absence().to_owned(),
        };
        ui.label(words);
        return;
    };
    remarks_ui(ui, state, &remarks_shown(state, shown), palette, commands);
    couplings_offer_ui(ui, state, palette, commands);
    if !shown.delays.matched || shown.compensated.is_some() {
        causes_ui(ui, palette, commands);
    }
    lead_ui(ui, state, shown, palette);
    section_ui(ui, "Proof");
    proof_ui(ui, shown, state.is_proving(shown), palette);
    objective_ui(ui, shown, palette, commands);
    for sentence in details(&state.study, shown) {
        ui.label(RichText::new(sentence).size(SMALL_SIZE));
    }
}

fn section_ui(ui: &mut Ui, title: &str) {
    ui.add_space(12.0);
    ui.label(RichText::new(title).font(medium(BODY_SIZE)));
}

fn causes_ui(ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
    section_ui(ui, "Where a lag may come from");
    for (name, words, look, view) in CAUSES {
        ui.label(name);
        ui.label(palette.small(words));
        entries_ui(
            ui,
            [(look, Command::Layout(LayoutCommand::ShowView(view)))],
            commands,
        );
        ui.add_space(4.0);
    }
}

/// Draws whether better gains exist, and how far the answer may be from the optimum.
fn proof_ui(ui: &mut Ui, shown: &ConditionAnalysis, is_proving: bool, palette: &Palette) {
    let outcome = shown.gains.proof.outcome;
    let words = match outcome {
        Outcome::NotProven { .. } if is_proving => {
            "Whether better gains exist is being searched beside the live answer."
        }
        Outcome::NotProven { .. } => "Not proven.",
        Outcome::Proven { .. } => "Global optimum: a lower bound proves it.",
    };
    ui.label(palette.dim(format!("{words} Gap {:.0e}.", outcome.gap())));
}

/// Draws sentences, each with its possible actions.
fn remarks_ui(
    ui: &mut Ui,
    state: &State,
    remarks: &[Remark],
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    for remark in remarks {
        remark_ui(ui, palette, remark);
        if let Some(pair) = remark.ignore {
            let name = state.dataset().pair_name(pair);
            let button = named(
                ui.small_button("Ignore it"),
                Role::Button,
                format!("Ignore {name}"),
            );
            let hint = format!("Give {name} no weight in the objective, in every condition");
            button
                .on_hover_text(hint)
                .asks(Edit::Fit(pair, false), commands);
        }
        if let Some((channel, of)) = remark.turn {
            let (label, turn) = turn_entry(state, channel, of);
            button_ui(
                ui,
                Button::new(label).small(),
                "In every condition; can be undone",
                turn,
                commands,
            );
        }
        if let Some(phase) = remark.phase {
            let label = format!("Correct the phase by {}", setting::PHASE.text(phase.into()));
            button_ui(
                ui,
                Button::new(label).small(),
                UNDONE,
                setting::PHASE.to(phase),
                commands,
            );
        }
    }
}

/// Hint of a button that decides for every condition.
const UNDONE: &str = "In every condition; undo takes it back";

fn objective_ui(
    ui: &mut Ui,
    shown: &ConditionAnalysis,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let unit = if shown.gains.quantity == Quantity::Gain(GainObjective::Decibel) {
        " dB²"
    } else {
        ""
    };
    let gains = format!("objective {:.4}{unit}", shown.gains.objective);
    let delays = format!("delays {:.4} s²", shown.delays.objective);
    let id = shown.condition.id();
    ui.horizontal_wrapped(|ui| {
        let label = value_label_ui(
            ui,
            palette.small(gains),
            ExplainTarget::GainObjective(id),
            commands,
        );
        label.on_hover_text(format!(
            "eq. (7): {}{unit}, lower bound {}{unit}",
            shown.gains.objective, shown.gains.proof.lower_bound
        ));
        let label = value_label_ui(
            ui,
            palette.small(delays),
            ExplainTarget::DelayObjective(id),
            commands,
        );
        let equation = if shown.compensated.is_some() {
            "M15.4"
        } else {
            "eq. (11)"
        };
        label.on_hover_text(format!(
            "{equation}: {} s², global optimum (convex); KKT residual {:.0e} s",
            shown.delays.objective,
            kkt_residual(&shown.delay_problem, &shown.delays)
        ));
    });
}

/// Draws the lead of each constrained response and the price of each filter.
fn lead_ui(ui: &mut Ui, state: &State, shown: &ConditionAnalysis, palette: &Palette) {
    if shown.compensated.is_none() {
        return;
    }
    let header = palette.small("Leads in words");
    CollapsingHeader::new(header)
        .id_salt("leads")
        .default_open(true)
        .show(ui, |ui| {
            for sentence in lead_words(&state.study, shown, state.uncertainty().map(AsRef::as_ref))
            {
                ui.label(RichText::new(sentence).size(SMALL_SIZE));
            }
        });
}

/// Draws the off-axis benefit of couplings, if worthwhile, and the link that uses them.
fn couplings_offer_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some((assessment, _)) = offered_couplings(state) else {
        return;
    };
    let couplings = assessment.couplings;
    if let Some(text) = coupling_offer(assessment) {
        remark_ui(ui, palette, &Remark::good("couplings-offered", text));
    }
    let button = Button::new(format!("Use {}", couplings.name())).small();
    button_ui(
        ui,
        button,
        UNDONE,
        setting::COUPLINGS.to(couplings),
        commands,
    );
    entries_ui(
        ui,
        [(
            "Look at the couplings",
            Command::Layout(LayoutCommand::ShowView(View::Couplings)),
        )],
        commands,
    );
}

fn remark_ui(ui: &mut Ui, palette: &Palette, remark: &Remark) {
    let color = match remark.kind {
        RemarkKind::Good => palette.good,
        RemarkKind::Caution | RemarkKind::Trouble => palette.warning,
    };
    let text = RichText::new(&remark.text).size(SMALL_SIZE);
    let shown = ui.horizontal(|ui| {
        ui.add_space(8.0);
        ui.vertical(|ui| ui.label(text));
    });
    let rect = shown.response.rect;
    let bar = Rect::from_min_size(rect.min, vec2(3.0, rect.height()));
    ui.painter().rect_filled(bar, 1.0, color);
}
