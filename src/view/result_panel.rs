//! The result of the condition shown, in words and numbers.

use egui::{Align, Button, CollapsingHeader, Frame, Grid, Layout, Margin, Response, RichText, Role, Ui, vec2};

use gdcm_core::correction::{self, GainObjective, Outcome, Quantity, kkt_residual};
use gdcm_core::dataset::Pair;
use gdcm_core::study::{
    ConditionAnalysis, Edit, ExplainTarget, PhaseCorrection, Remark, RemarkKind, details, lead_words, servo_words,
    setting,
};
use gdcm_core::uncertainty::Scalar;
use gdcm_core::units::s_to_ms;

use super::views::bar_words;
use super::{
    BODY_SIZE, Command, FormKind, Palette, QUESTION, Region, SMALL_SIZE, State, TableKind, heading_ui, named,
    region_ui, remarks_shown, table_menu_ui, turn_entry, value_label_ui,
};

/// Size of the half-widths of bars \[pt\].
const HALF_SIZE: f32 = 9.5;
/// Room of that text: "±100%" \[pt\].
const HALF_WIDTH: f32 = 28.0;

/// Outcome, channel gains and delays, objective, and what could not be matched and why.
pub fn result_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    region_ui(ui, Region::Result, |ui| outcome_ui(ui, state, palette, commands));
}

fn outcome_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    match state.outcome() {
        None => {
            heading_ui(ui, palette, "Result", "");
            ui.label(palette.dim(state.results.absence()));
        }
        Some(Err(failure)) => {
            heading_ui(ui, palette, "Result", "none");
            remark_ui(ui, palette, &Remark::new(RemarkKind::Trouble, failure.to_string()));
        }
        Some(Ok(shown)) => {
            header_ui(ui, state, shown, palette, commands);
            // What is said of signs and units goes before every number.
            let remarks = remarks_shown(state, shown);
            let (doubts, others) = remarks.split_at(shown.doubts.len());
            remarks_ui(ui, state, doubts, palette, commands);
            ui.scope(|ui| channels_ui(ui, state, shown, palette, commands));
            objective_ui(ui, shown, palette, commands);
            remarks_ui(ui, state, others, palette, commands);
            lead_ui(ui, state, shown, palette);
            let header = palette.small("In detail");
            CollapsingHeader::new(header).id_salt("details").show(ui, |ui| {
                for sentence in details(&state.study, shown) {
                    ui.label(RichText::new(sentence).size(SMALL_SIZE));
                }
            });
        }
    }
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

/// The way to the export form; always in sight.
pub fn export_button_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let ready = state.analysis().is_some();
    let label = RichText::new("Export corrections…").strong().color(palette.on_accent());
    let button = Button::new(label).fill(palette.accent);
    let export = region_ui(ui, Region::Result, |ui| ui.add_enabled(ready, button));
    if export.on_hover_text("Write corrections.json, corrections.csv and assessment.csv (Ctrl+E)").clicked() {
        commands.push(Command::ShowForm(Some(FormKind::Export)));
    }
}

fn header_ui(ui: &mut Ui, state: &State, shown: &ConditionAnalysis, palette: &Palette, commands: &mut Vec<Command>) {
    ui.add_space(4.0);
    let heading = ui.horizontal(|ui| {
        ui.label(palette.small("Result").strong());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(palette.small(format!("gap {:.0e}", shown.gains.proof.outcome.gap())));
            proof_ui(ui, shown, state.is_proving(shown), palette);
            badge_ui(ui, shown, palette);
        });
    });
    table_menu_ui(ui, &heading.response, TableKind::Channels, commands);
}

/// Whether gains and phase are met: green where both are.
fn badge_ui(ui: &mut Ui, shown: &ConditionAnalysis, palette: &Palette) {
    let (word, color, hint) = match (shown.gains.matched, shown.delays.matched) {
        (true, true) => ("matched", palette.good, "Every held response has its gain and its delay"),
        (true, false) => (
            "phase not matched",
            palette.warning,
            "Every held gain is met, not every held delay; the reasons stand below",
        ),
        (false, _) => ("not matched", palette.warning, "Not every held gain can be reached; the reasons stand below"),
    };
    let text = RichText::new(word).size(SMALL_SIZE).strong().color(palette.on_accent());
    let badge = Frame::new().fill(color).corner_radius(3.0).inner_margin(Margin::symmetric(6, 1));
    badge.show(ui, |ui| ui.label(text)).response.on_hover_text(hint);
}

/// Whether better gains exist.
fn proof_ui(ui: &mut Ui, shown: &ConditionAnalysis, is_proving: bool, palette: &Palette) {
    let outcome = shown.gains.proof.outcome;
    let (text, hint) = match outcome {
        Outcome::Proven { .. } => (
            palette.small("global optimum"),
            "No gains within the bounds that hold the held responses are better: a lower bound proves it".to_owned(),
        ),
        Outcome::NotProven { .. } if is_proving => (
            palette.small("searching …"),
            "Whether better gains exist is being searched beside the live answer".to_owned(),
        ),
        Outcome::NotProven { .. } => (palette.small_warning("not proven"), outcome.words()),
    };
    ui.label(text).on_hover_text(hint);
}

/// Inputs beside outputs.
fn channels_ui(ui: &mut Ui, state: &State, shown: &ConditionAnalysis, palette: &Palette, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = 12.0;
    ui.columns(2, |columns| {
        for (ui, of_inputs) in columns.iter_mut().zip([true, false]) {
            side_ui(ui, of_inputs, (state, shown), palette, commands);
        }
    });
}

/// Gains and delays of the channels of one side; a click on a value asks how it was computed.
fn side_ui(
    ui: &mut Ui,
    of_inputs: bool,
    (state, shown): (&State, &ConditionAnalysis),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let (gains, delays, dataset) = (&shown.gains, &shown.delays, state.dataset());
    let (title, channels, gains, delays, channel): (_, _, _, _, fn(usize) -> correction::Channel) = match of_inputs {
        true => ("input", dataset.inputs(), &gains.inputs, &delays.inputs, correction::Channel::Input),
        false => ("output", dataset.outputs(), &gains.outputs, &delays.outputs, correction::Channel::Output),
    };
    let (width, id, sureness) = (ui.available_width(), shown.condition.id(), state.sureness());
    let told = |scalar| {
        let words = sureness.bar(scalar).map(|(bar, level)| format!("\n{}", bar_words(bar, scalar, level)));
        format!("{}\nclick: {QUESTION}", words.unwrap_or_default())
    };
    Grid::new(title).num_columns(3).spacing([4.0, 3.0]).min_col_width(0.2 * width).show(ui, |ui| {
        ui.label(palette.small(title));
        right(ui, |ui| ui.label(palette.small("k")));
        right(ui, |ui| ui.label(palette.small("τ ms")));
        ui.end_row();
        for (index, name) in channels.iter().map(|channel| &channel.name).enumerate() {
            let (channel, gain, delay_ms) = (channel(index), gains[index], s_to_ms(delays[index]));
            ui.label(RichText::new(name).size(BODY_SIZE));
            let scalar = Scalar::ChannelGain(channel);
            let half = sureness.half(scalar).map(|half| format!("±{:.0}%", 100.0 * half));
            let gain_text = RichText::new(format!("{gain:.3}"));
            let label = value_ui(ui, (gain_text, half), ExplainTarget::Gain(id, channel), palette, commands);
            label.on_hover_text(format!("{gain}{}", told(scalar)));
            let scalar = Scalar::ChannelDelay(channel);
            let is_delayed = delay_ms != 0.0;
            let half = sureness.half(scalar).filter(|_| is_delayed).map(|half| format!("±{:.0}", s_to_ms(half)));
            let text = if is_delayed { format!("{delay_ms:.1}") } else { "0".to_owned() };
            let text = RichText::new(text).color(if is_delayed { palette.text } else { palette.dim_text });
            let filter = shown.compensated.as_ref().and_then(|led| led.leads.filters()[channel]);
            let filter = filter.map(|filter| format!("\nlead: {}", servo_words(filter))).unwrap_or_default();
            let label = value_ui(ui, (text, half), ExplainTarget::Delay(id, channel), palette, commands);
            label.on_hover_text(format!("{delay_ms} ms{filter}{}", told(scalar)));
            ui.end_row();
        }
    });
}

/// A value that asks how it was computed, with the half-width of its bar beside it.
fn value_ui(
    ui: &mut Ui,
    (text, half): (RichText, Option<String>),
    asked: ExplainTarget,
    palette: &Palette,
    commands: &mut Vec<Command>,
) -> Response {
    right(ui, |ui| {
        half_ui(ui, half, palette);
        value_label_ui(ui, text, asked, commands)
    })
}

/// The half-width of a value's bar beside it, small; its room is kept free until it is there.
fn half_ui(ui: &mut Ui, half: Option<String>, palette: &Palette) {
    let size = vec2(HALF_WIDTH, ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_width(HALF_WIDTH);
        if let Some(half) = half {
            ui.label(RichText::new(half).size(HALF_SIZE).color(palette.dim_text));
        }
    });
}

fn right<R>(ui: &mut Ui, add: impl FnOnce(&mut Ui) -> R) -> R {
    ui.with_layout(Layout::right_to_left(Align::Center), add).inner
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
