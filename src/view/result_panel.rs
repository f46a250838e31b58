//! The correction of the condition shown: gains and delays of inputs and outputs, side by side.

use egui::{Color32, CursorIcon, FontId, Rect, Role, Sense, Ui, pos2, vec2};

use gdcm_core::correction::{Channel, Outcome};
use gdcm_core::study::{ConditionAnalysis, ExplainTarget, servo_words};
use gdcm_core::uncertainty::Scalar;
use gdcm_core::units::s_to_ms;
use gdcm_files::figure::decimals;

use super::palette::medium;
use super::views::bar_words;
use super::{
    Asks, BODY_SIZE, Command, Palette, QUESTION, SMALL_SIZE, Sheet, State, TableKind, named, painted_text,
    table_menu_ui,
};

/// Height of a row \[pt\].
const ROW: f32 = 18.0;
/// Where gains and delays end, as parts of the width of a side.
const ENDS: [f32; 2] = [0.5, 0.85];

/// Gains and delays of every channel; in a low window the range of the gains alone.
pub fn result_ui(ui: &mut Ui, state: &State, is_folded: bool, palette: &Palette, commands: &mut Vec<Command>) {
    let (rect, heading) = ui.allocate_exact_size(vec2(ui.available_width(), 20.0), Sense::hover());
    painted_text(ui, rect, 0.0, "Result", medium(BODY_SIZE), palette.text);
    table_menu_ui(ui, &heading, TableKind::Channels, commands);
    let Some(Ok(shown)) = state.outcome() else {
        let words = if state.outcome().is_some() { "none" } else { state.results.absence() };
        painted_text(ui, rect, -0.01, words, FontId::proportional(SMALL_SIZE), palette.dim_text);
        return;
    };
    proof_ui(ui, rect, state.is_proving(shown), shown, palette, commands);
    if is_folded {
        let gains = || shown.gains.inputs.iter().chain(&shown.gains.outputs);
        let (least, most) = gains().fold((f64::INFINITY, 0.0_f64), |(a, b), gain| (a.min(*gain), b.max(*gain)));
        let words = format!("k {} to {}", decimals(least, 3), decimals(most, 3));
        painted_text(ui, rect, 56.0, &words, FontId::proportional(BODY_SIZE), palette.dim_text);
        return;
    }
    let dataset = state.dataset();
    let rows = dataset.inputs().len().max(dataset.outputs().len());
    let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW * (rows + 1) as f32), Sense::hover());
    let width = 0.5 * (area.width() - 12.0);
    for (of_inputs, left) in [(true, area.left()), (false, area.right() - width)] {
        let side = Rect::from_min_size(pos2(left, area.top()), vec2(width, area.height()));
        Side { of_inputs, side, state, shown }.ui(ui, palette, commands);
    }
}

/// Whether better gains exist: small, for it is the rule; a click opens the proof.
fn proof_ui(
    ui: &mut Ui,
    row: Rect,
    is_proving: bool,
    shown: &ConditionAnalysis,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let outcome = shown.gains.proof.outcome;
    let (words, color) = match outcome {
        Outcome::Proven { .. } => ("global optimum ✓", palette.dim_text),
        Outcome::NotProven { .. } if is_proving => ("proof runs", palette.dim_text),
        Outcome::NotProven { .. } => ("not proven", palette.warning),
    };
    let place = painted_text(ui, row, -0.01, words, FontId::proportional(SMALL_SIZE), color);
    let response = ui.interact(place.expand(3.0), ui.scope_id().with("proof"), Sense::click());
    let response = named(response, Role::Button, words);
    response
        .on_hover_cursor(CursorIcon::PointingHand)
        .on_hover_text(outcome.words())
        .asks(Command::ShowSheet(Some(Sheet::Reasons)), commands);
}

/// The channels of one side.
struct Side<'a> {
    of_inputs: bool,
    side: Rect,
    state: &'a State,
    shown: &'a ConditionAnalysis,
}

impl Side<'_> {
    fn row(&self, number: usize) -> Rect {
        Rect::from_min_size(self.side.min + vec2(0.0, ROW * number as f32), vec2(self.side.width(), ROW))
    }

    fn ui(&self, ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
        let small = FontId::proportional(SMALL_SIZE);
        let dataset = self.state.dataset();
        let (title, channels) =
            if self.of_inputs { ("input", dataset.inputs()) } else { ("output", dataset.outputs()) };
        let head = self.row(0);
        painted_text(ui, head, 0.0, title, small.clone(), palette.dim_text);
        for (end, words) in ENDS.into_iter().zip(["k", "τ ms"]) {
            let place = self.painted_at(ui, head, end, words, small.clone(), palette.dim_text);
            let unit = if words == "k" { "±%" } else { "±" };
            painted_text(ui, head, place.right() - head.left() + 3.0, unit, small.clone(), palette.dim_text);
        }
        for (index, channel) in channels.iter().enumerate() {
            let row = self.row(index + 1);
            painted_text(ui, row, 0.0, &channel.name, FontId::proportional(BODY_SIZE), palette.text);
            let channel_of = if self.of_inputs { Channel::Input(index) } else { Channel::Output(index) };
            self.gain_ui(ui, row, (channel_of, index, &channel.name), palette, commands);
            self.delay_ui(ui, row, (channel_of, index, &channel.name), palette, commands);
        }
    }

    /// Text that ends at a part of the width of its row.
    fn painted_at(&self, ui: &Ui, row: Rect, end: f32, words: &str, font: FontId, color: Color32) -> Rect {
        let upto = row.with_max_x(row.left() + end * row.width());
        painted_text(ui, upto, -0.01, words, font, color)
    }

    fn gain_ui(
        &self,
        ui: &mut Ui,
        row: Rect,
        (channel, index, name): (Channel, usize, &str),
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
        let gains = if self.of_inputs { &self.shown.gains.inputs } else { &self.shown.gains.outputs };
        let gain = gains[index];
        let scalar = Scalar::ChannelGain(channel);
        let half = self.state.sureness().half(scalar).map(|half| format!("±{:.0}", 100.0 * half));
        let value = (decimals(gain, 3), medium(BODY_SIZE), palette.text);
        let asked = ExplainTarget::Gain(self.shown.condition.id(), channel);
        self.value_ui(
            ui,
            (row, ENDS[0]),
            value,
            half,
            (format!("Gain of {name}"), gain.to_string(), scalar, asked),
            palette,
            commands,
        );
    }

    fn delay_ui(
        &self,
        ui: &mut Ui,
        row: Rect,
        (channel, index, name): (Channel, usize, &str),
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
        let delays = if self.of_inputs { &self.shown.delays.inputs } else { &self.shown.delays.outputs };
        let delay_ms = s_to_ms(delays[index]);
        let is_delayed = delay_ms != 0.0;
        let scalar = Scalar::ChannelDelay(channel);
        let half = self.state.sureness().half(scalar).filter(|_| is_delayed);
        let half = half.map(|half| format!("±{:.0}", s_to_ms(half)));
        let text =
            if is_delayed { decimals(delay_ms, if delay_ms.abs() < 10.0 { 1 } else { 0 }) } else { "0".to_owned() };
        let color = if is_delayed { palette.text } else { palette.quiet_text };
        let filter = self.shown.compensated.as_ref().and_then(|led| led.leads.filters()[channel]);
        let filter = filter.map(|filter| format!("\nlead: {}", servo_words(filter))).unwrap_or_default();
        let asked = ExplainTarget::Delay(self.shown.condition.id(), channel);
        let told = (format!("Delay of {name}"), format!("{delay_ms} ms{filter}"), scalar, asked);
        self.value_ui(
            ui,
            (row, ENDS[1]),
            (text, FontId::proportional(BODY_SIZE), color),
            half,
            told,
            palette,
            commands,
        );
    }

    /// A value with half the width of its bar; a click asks how it was computed.
    #[expect(clippy::too_many_arguments, reason = "what is painted, what is told, and where")]
    fn value_ui(
        &self,
        ui: &mut Ui,
        (row, end): (Rect, f32),
        (text, font, color): (String, FontId, Color32),
        half: Option<String>,
        (name, exact, scalar, asked): (String, String, Scalar, ExplainTarget),
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
        let place = self.painted_at(ui, row, end, &text, font, color);
        if let Some(half) = &half {
            let from = place.right() - row.left() + 3.0;
            painted_text(ui, row, from, half, FontId::proportional(SMALL_SIZE), palette.dim_text);
        }
        let area = row.with_min_x(place.left() - 4.0).with_max_x(place.right() + 3.0).shrink2(vec2(0.0, 0.5));
        let response = ui.interact(area, ui.scope_id().with(&name), Sense::click());
        let response = named(response, Role::Button, format!("{name}: {text} {}", half.unwrap_or_default()).trim_end());
        let words =
            self.state.sureness().bar(scalar).map(|(bar, level)| format!("\n{}", bar_words(bar, scalar, level)));
        let hint = format!("{exact}{}\nclick: {QUESTION}", words.unwrap_or_default());
        response.on_hover_cursor(CursorIcon::Help).on_hover_text(hint).asks(Command::Explain(Some(asked)), commands);
    }
}
