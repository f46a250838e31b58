//! Why the result is as it is: what explains it in words, where a lag may come from, and the proof.

use egui::{CollapsingHeader, RichText, Role, Ui, vec2};

use gdcm_core::correction::{GainObjective, Outcome, Quantity, kkt_residual};
use gdcm_core::dataset::Pair;
use gdcm_core::study::{
    ConditionAnalysis, Edit, ExplainTarget, PhaseCorrection, Remark, RemarkKind, details, lead_words, setting,
};

use super::palette::medium;
use super::views::offered_couplings;
use super::{
    BODY_SIZE, Command, Palette, SMALL_SIZE, State, View, entries_ui, named, remarks_shown, turn_entry, value_label_ui,
};

/// Where a common lag may come from, and where to look for it; a model is better mended there than corrected.
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

/// The sheet of reasons for the result of the condition shown.
pub fn reasons_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(Ok(shown)) = state.outcome() else {
        let words = match state.outcome() {
            Some(Err(failure)) => failure.to_string(),
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
        entries_ui(ui, [(look, Command::ShowView(view))], commands);
        ui.add_space(4.0);
    }
}

/// Whether better gains exist, and how far the answer may be from the best.
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

/// Sentences, each with what can be done about it.
fn remarks_ui(ui: &mut Ui, state: &State, remarks: &[Remark], palette: &Palette, commands: &mut Vec<Command>) {
    for remark in remarks {
        remark_ui(ui, palette, remark);
        if let Some(pair) = remark.ignore {
            ignore_ui(ui, state, pair, commands);
        }
        if let Some((channel, of)) = remark.turn {
            turn_ui(ui, turn_entry(state, channel, of), commands);
        }
        if let Some(phase) = remark.phase {
            offer_ui(ui, phase, commands);
        }
    }
}

fn objective_ui(ui: &mut Ui, shown: &ConditionAnalysis, palette: &Palette, commands: &mut Vec<Command>) {
    let unit = if shown.gains.quantity == Quantity::Gain(GainObjective::Decibel) { " dB²" } else { "" };
    let gains = format!("objective {:.4}{unit}", shown.gains.objective);
    let delays = format!("delays {:.4} s²", shown.delays.objective);
    let id = shown.condition.id();
    ui.horizontal_wrapped(|ui| {
        let label = value_label_ui(ui, palette.small(gains), ExplainTarget::GainObjective(id), commands);
        label.on_hover_text(format!(
            "eq. (7): {}{unit}, lower bound {}{unit}",
            shown.gains.objective, shown.gains.proof.lower_bound
        ));
        let label = value_label_ui(ui, palette.small(delays), ExplainTarget::DelayObjective(id), commands);
        let equation = if shown.compensated.is_some() { "M15.4" } else { "eq. (11)" };
        label.on_hover_text(format!(
            "{equation}: {} s², global optimum (convex); KKT residual {:.0e} s",
            shown.delays.objective,
            kkt_residual(&shown.delay_problem, &shown.delays)
        ));
    });
}

/// What each held response gets and each filter costs, in words.
fn lead_ui(ui: &mut Ui, state: &State, shown: &ConditionAnalysis, palette: &Palette) {
    if shown.compensated.is_none() {
        return;
    }
    let header = palette.small("Leads in words");
    CollapsingHeader::new(header).id_salt("leads").default_open(true).show(ui, |ui| {
        for sentence in lead_words(&state.study, shown, state.uncertainty().map(AsRef::as_ref)) {
            ui.label(RichText::new(sentence).size(SMALL_SIZE));
        }
    });
}

/// The click that corrects the phase as a remark offers.
fn offer_ui(ui: &mut Ui, phase: PhaseCorrection, commands: &mut Vec<Command>) {
    let button = ui.small_button(format!("Correct the phase by {}", setting::PHASE.text(phase.into())));
    if button.on_hover_text("In every condition; undo takes it back").clicked() {
        commands.push(setting::PHASE.to(phase).into());
    }
}

/// What couplings would bring off the axis, where that is worth it, and the click that uses them.
fn couplings_offer_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some((assessment, _)) = offered_couplings(state) else { return };
    let couplings = assessment.couplings;
    assessment.offer().into_iter().for_each(|text| remark_ui(ui, palette, &Remark::new(RemarkKind::Good, text)));
    let words = format!("Use {}", couplings.name());
    if ui.small_button(words).on_hover_text("In every condition; undo takes it back").clicked() {
        commands.push(setting::COUPLINGS.to(couplings).into());
    }
    entries_ui(ui, [("Look at the couplings", Command::ShowView(View::Couplings))], commands);
}

/// The click that turns the models of a channel, or puts them back.
fn turn_ui(ui: &mut Ui, (label, turn): (String, Command), commands: &mut Vec<Command>) {
    let button = named(ui.small_button(&label), Role::Button, label);
    if button.on_hover_text("In every condition; can be undone").clicked() {
        commands.push(turn);
    }
}

/// The click that takes a response out of the objective.
fn ignore_ui(ui: &mut Ui, state: &State, pair: Pair, commands: &mut Vec<Command>) {
    let name = state.dataset().pair_name(pair);
    let button = named(ui.small_button("Ignore it"), Role::Button, format!("Ignore {name}"));
    if button.on_hover_text(format!("Give {name} no weight in the objective, in every condition")).clicked() {
        commands.push(Edit::Fit(pair, false).into());
    }
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
    let bar = egui::Rect::from_min_size(rect.min, vec2(3.0, rect.height()));
    ui.painter().rect_filled(bar, 1.0, color);
}
