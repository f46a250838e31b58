//! The result of the condition shown, in words and numbers.

use egui::{Align, Button, CollapsingHeader, Color32, Grid, Layout, RichText, Role, Ui, WidgetInfo, vec2};

use gdcm_core::correction::{self, GainObjective, Outcome, Quantity, kkt_residual};
use gdcm_core::dataset::{Channel, Pair};
use gdcm_core::study::{
    ConditionAnalysis, Edit, ExplainTarget, PhaseCorrection, Remark, RemarkKind, Setting, lead_words, servo_words,
};
use gdcm_core::uncertainty::Scalar;
use gdcm_core::units::s_to_ms;

use super::command::{Command, FormKind};
use super::controls::{heading_ui, table_menu_ui};
use super::explanation::figure_ui;
use super::explanation::{details_shown, remarks_shown};
use super::focus::{Region, region_ui};
use super::palette::{BODY_SIZE, Palette, SMALL_SIZE};
use super::state::State;
use super::tables::TableKind;
use super::views::bar_words;

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
            ui.label(RichText::new(state.results.absence()).color(palette.dim_text));
        }
        Some(Err(failure)) => {
            heading_ui(ui, palette, "Result", "none");
            remark_ui(ui, palette, &Remark::new(RemarkKind::Trouble, failure.to_string()));
        }
        Some(Ok(shown)) => {
            header_ui(ui, state, shown, palette, commands);
            ui.scope(|ui| channels_ui(ui, state, shown, palette, commands));
            objective_ui(ui, shown, palette, commands);
            for remark in remarks_shown(state, shown) {
                remark_ui(ui, palette, &remark);
                if let Some(pair) = remark.ignore {
                    ignore_ui(ui, state, pair, commands);
                }
                if let Some(phase) = remark.phase {
                    offer_ui(ui, phase, commands);
                }
            }
            lead_ui(ui, state, shown, palette);
            let header = RichText::new("In detail").size(SMALL_SIZE).color(palette.dim_text);
            CollapsingHeader::new(header).id_salt("details").show(ui, |ui| {
                for sentence in details_shown(state, shown) {
                    ui.label(RichText::new(sentence).size(SMALL_SIZE));
                }
            });
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
        ui.label(RichText::new("Result").size(SMALL_SIZE).strong().color(palette.dim_text));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let (word, color, gap, hint) = outcome(shown, state.is_proving(shown), palette);
            ui.label(RichText::new(format!("gap {gap:.0e}")).size(SMALL_SIZE).color(palette.dim_text));
            badge_ui(ui, word, color, palette).on_hover_text(hint);
        });
    });
    table_menu_ui(ui, &heading.response, TableKind::Channels, commands);
}

fn outcome(shown: &ConditionAnalysis, proving: bool, palette: &Palette) -> (&'static str, Color32, f64, String) {
    let outcome = shown.gains.proof.outcome;
    let (word, color, hint) = match (shown.gains.matched, outcome) {
        (false, _) => {
            let hint = "Not every held gain can be reached; the reasons stand below".to_owned();
            ("not matched", palette.warning, hint)
        }
        (true, Outcome::NotProven { .. }) if proving => {
            let hint = "Whether better gains exist is being searched beside the live answer";
            ("proving …", palette.warning, hint.to_owned())
        }
        (true, Outcome::Proven { .. }) => {
            let hint = "No gains within the bounds that hold the held responses are better: a lower bound proves it";
            ("proven", palette.good, hint.to_owned())
        }
        (true, Outcome::NotProven { .. }) => ("not proven", palette.warning, outcome.words()),
    };
    (word, color, outcome.gap(), hint)
}

fn badge_ui(ui: &mut Ui, word: &str, color: Color32, palette: &Palette) -> egui::Response {
    let text = RichText::new(word).size(SMALL_SIZE).strong().color(palette.on_accent());
    egui::Frame::new()
        .fill(color)
        .corner_radius(3.0)
        .inner_margin(egui::Margin::symmetric(6, 1))
        .show(ui, |ui| ui.label(text))
        .response
}

/// Inputs beside outputs.
fn channels_ui(ui: &mut Ui, state: &State, shown: &ConditionAnalysis, palette: &Palette, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = 12.0;
    ui.columns(2, |columns| {
        channel_table_ui(
            &mut columns[0],
            "input",
            state.dataset().inputs(),
            Side::Input,
            (state, shown),
            palette,
            commands,
        );
        channel_table_ui(
            &mut columns[1],
            "output",
            state.dataset().outputs(),
            Side::Output,
            (state, shown),
            palette,
            commands,
        );
    });
}

/// Which of the two tables of channels.
#[derive(Clone, Copy, Debug)]
enum Side {
    Input,
    Output,
}

impl Side {
    fn channel(self, index: usize) -> correction::Channel {
        match self {
            Self::Input => correction::Channel::Input(index),
            Self::Output => correction::Channel::Output(index),
        }
    }

    /// Gain, and delay \[ms\], of a channel.
    fn figures(self, shown: &ConditionAnalysis, index: usize) -> (f64, f64) {
        let (gains, delays) = (&shown.gains, &shown.delays);
        match self {
            Self::Input => (gains.inputs[index], s_to_ms(delays.inputs[index])),
            Self::Output => (gains.outputs[index], s_to_ms(delays.outputs[index])),
        }
    }
}

/// Gains and delays of the channels of one side; a click on a figure asks how it was computed.
fn channel_table_ui(
    ui: &mut Ui,
    title: &str,
    channels: &[Channel],
    side: Side,
    (state, shown): (&State, &ConditionAnalysis),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let uncertainty = state.uncertainty().filter(|_| !state.others_are_older());
    let words = |scalar: Scalar| {
        let bar = uncertainty.and_then(|of| Some(bar_words(of.bar(shown.condition.id(), scalar)?, scalar, of.level)));
        bar.map_or_else(String::new, |words| format!("\n{words}"))
    };
    let half =
        |scalar: Scalar| {
            let half = uncertainty.and_then(|of| of.bar(shown.condition.id(), scalar)?.half_width(of.level));
            half.map(|half| {
                if scalar.is_delay() { format!("±{:.0}", s_to_ms(half)) } else { format!("±{:.0}%", 100.0 * half) }
            })
        };
    let (width, id) = (ui.available_width(), shown.condition.id());
    Grid::new(title).num_columns(3).spacing([4.0, 3.0]).min_col_width(0.2 * width).show(ui, |ui| {
        let head = |ui: &mut Ui, text: &str| ui.label(RichText::new(text).size(SMALL_SIZE).color(palette.dim_text));
        head(ui, title);
        right(ui, |ui| head(ui, "k"));
        right(ui, |ui| head(ui, "τ ms"));
        ui.end_row();
        for (index, channel) in channels.iter().enumerate() {
            let (gain, delay_ms) = side.figures(shown, index);
            ui.label(RichText::new(&channel.name).size(BODY_SIZE));
            let asked = ExplainTarget::Gain(id, side.channel(index));
            let of_gain = Scalar::ChannelGain(side.channel(index));
            let hint = format!("{gain}{}\nclick: how was this computed?", words(of_gain));
            right(ui, |ui| {
                half_ui(ui, half(of_gain), palette);
                figure_ui(ui, format!("{gain:.3}"), asked, commands)
            })
            .on_hover_text(hint);
            let text = if delay_ms == 0.0 { "0".to_owned() } else { format!("{delay_ms:.1}") };
            let color = if delay_ms == 0.0 { palette.dim_text } else { palette.text };
            let asked = ExplainTarget::Delay(id, side.channel(index));
            let filter = shown.led.as_ref().and_then(|led| led.leads.filter(side.channel(index)));
            let filter = filter.map(|filter| format!("\nlead: {}", servo_words(filter))).unwrap_or_default();
            let of_delay = Scalar::ChannelDelay(side.channel(index));
            let hint = format!("{delay_ms} ms{filter}{}\nclick: how was this computed?", words(of_delay));
            right(ui, |ui| {
                half_ui(ui, half(of_delay).filter(|_| delay_ms != 0.0), palette);
                figure_ui(ui, RichText::new(text).color(color), asked, commands)
            })
            .on_hover_text(hint);
            ui.end_row();
        }
    });
}

/// The half-width of a figure's bar beside it, small; its room is kept free until it is there.
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
    let dim = |text: String| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    let id = shown.condition.id();
    ui.horizontal_wrapped(|ui| {
        let label = figure_ui(ui, dim(gains), ExplainTarget::GainObjective(id), commands);
        label.on_hover_text(format!(
            "eq. (7): {}{unit}, lower bound {}{unit}",
            shown.gains.objective, shown.gains.proof.lower_bound
        ));
        let label = figure_ui(ui, dim(delays), ExplainTarget::DelayObjective(id), commands);
        let equation = if shown.led.is_some() { "M15.4" } else { "eq. (11)" };
        label.on_hover_text(format!(
            "{equation}: {} s², a convex program; KKT residual {:.0e} s",
            shown.delays.objective,
            kkt_residual(&shown.delay_problem, &shown.delays)
        ));
    });
}

/// What each held response gets and each filter costs, in words.
fn lead_ui(ui: &mut Ui, state: &State, shown: &ConditionAnalysis, palette: &Palette) {
    if shown.led.is_none() {
        return;
    }
    let header = RichText::new("Leads in words").size(SMALL_SIZE).color(palette.dim_text);
    CollapsingHeader::new(header).id_salt("leads").default_open(true).show(ui, |ui| {
        for sentence in lead_words(&state.study, shown, state.uncertainty().map(AsRef::as_ref)) {
            ui.label(RichText::new(sentence).size(SMALL_SIZE));
        }
    });
}

/// The click that corrects the phase as a remark offers.
fn offer_ui(ui: &mut Ui, phase: PhaseCorrection, commands: &mut Vec<Command>) {
    let button = ui.small_button(format!("Correct the phase by {}", phase.words()));
    if button.on_hover_text("In every condition; undo takes it back").clicked() {
        commands.push(Edit::Set(Setting::Phase(phase)).into());
    }
}

/// The click that takes a response out of the objective.
fn ignore_ui(ui: &mut Ui, state: &State, pair: Pair, commands: &mut Vec<Command>) {
    let name = state.dataset().pair_name(pair);
    let button = ui.small_button("Ignore it");
    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Ignore {name}")));
    if button.on_hover_text(format!("Give {name} no weight in the objective, in every condition")).clicked() {
        commands.push(Edit::Set(Setting::Fitted(pair, false)).into());
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
