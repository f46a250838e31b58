//! Correction in the displayed condition: gains and delays, with inputs and outputs side by side.
//!
//! k and τ are the gain and the delay of a channel. While the settings are open, a value that has
//! changed since shows its earlier value ("was") instead of the error bar. The proof shows that the
//! gains are the global optimum.

use egui::{Color32, CursorIcon, FontId, Rect, Role, Sense, Ui, pos2, vec2};

use gdcm_method::correction::{Channel, Outcome};
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::number_format::decimals;
use gdcm_model::units::s_to_ms;
use gdcm_study::ConditionAnalysis;
use gdcm_words::ExplainTarget;
use gdcm_words::leads::servo_words;
use gdcm_words::solution_details::proof_text;

use super::table_menu::table_menu_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::derivation_menu::QUESTION;
use crate::gui::state::panel_tables::TableKind;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::window_state::State;
use crate::gui::views::error_bars::error_bar_words;
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::elision::text_width;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium, small};

/// Row height \[pt\].
const ROW: f32 = 18.0;
/// Right edge of the gains, as a share of the side's width.
const GAIN_END: f32 = 0.5;
/// Right edge of the delays, as a share of the side's width.
const DELAY_END: f32 = 0.85;
/// Minimum gap between a channel name and its gain, and between the error bar of a gain and the
/// delay beside it \[pt\].
const LEAST_GAP: f32 = 5.0;
/// Length by which an earlier delay may extend beyond its side, into the gap between inputs and
/// outputs or the panel's padding \[pt\].
const BEYOND_ROW: f32 = 5.0;
/// Gap between a value and its error bar, or its earlier value \[pt\].
const BESIDE_GAP: f32 = 3.0;

/// Opacity of error bars that belong to earlier settings.
pub(super) const OLDER: f32 = 0.5;

/// Draws every channel's gain and delay; in a low window (`is_folded`) only the smallest and the
/// largest gain; without a result, at the same height, "none" or why there is none yet.
pub fn result_ui(
    ui: &mut Ui,
    state: &State,
    is_folded: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let (rect, heading) = ui.allocate_exact_size(vec2(ui.available_width(), 20.0), Sense::hover());
    painted_text(ui, rect, 0.0, "Result", medium(BODY_SIZE), palette.text);
    table_menu_ui(ui, &heading, TableKind::Channels, commands);
    let Some(Ok(shown)) = state.outcome() else {
        let words = if state.outcome().is_some() {
            "none"
        } else {
            state.results.absence()
        };
        painted_text(ui, rect, AT_RIGHT_END, words, small(), palette.dim_text);
        if !is_folded {
            ui.add_space(rows_height(state));
        }
        return;
    };
    proof_ui(ui, rect, state, shown, palette, commands);
    if is_folded {
        let mut least = f64::INFINITY;
        let mut most = 0.0_f64;
        for gain in shown.gains.inputs.iter().chain(&shown.gains.outputs) {
            least = least.min(*gain);
            most = most.max(*gain);
        }
        let words = format!("k {} to {}", decimals(least, 3), decimals(most, 3));
        painted_text(ui, rect, 56.0, &words, body(), palette.dim_text);
        return;
    }
    let (area, _) = ui.allocate_exact_size(
        vec2(ui.available_width(), rows_height(state)),
        Sense::hover(),
    );
    let width = 0.5 * (area.width() - 12.0);
    let inputs = SideValues {
        side: ChannelSide::Input,
        place: Rect::from_min_size(area.min, vec2(width, area.height())),
        state,
        shown,
        palette,
    };
    let outputs = SideValues {
        side: ChannelSide::Output,
        place: Rect::from_min_size(
            pos2(area.right() - width, area.top()),
            vec2(width, area.height()),
        ),
        ..inputs
    };
    inputs.ui(ui, commands);
    outputs.ui(ui, commands);
}

/// Returns the height for the heading and all channel rows, reserved without a result too \[pt\].
fn rows_height(state: &State) -> f32 {
    let dataset = state.dataset();
    let rows = dataset.inputs().len().max(dataset.outputs().len());
    ROW * (rows + 1) as f32
}

/// Draws, in small text, whether the gains are proven optimal, which they usually are; a click
/// opens the proof.
fn proof_ui(
    ui: &mut Ui,
    row: Rect,
    state: &State,
    shown: &ConditionAnalysis,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let outcome = shown.gains.proof.outcome;
    let is_proving = state.is_proving(shown);
    let is_dragged = state.is_setting_dragged();
    let (words, color) = match outcome {
        Outcome::Proven { .. } => ("global optimum ✓", palette.dim_text),
        Outcome::NotProven { .. } if is_dragged => {
            ("proof pending", palette.dim_text.gamma_multiply(OLDER))
        }
        Outcome::NotProven { .. } if is_proving => ("proof running", palette.dim_text),
        Outcome::NotProven { .. } => ("not proven", palette.warning),
    };
    let place = painted_text(ui, row, AT_RIGHT_END, words, small(), color);
    let response = ui.interact(
        place.expand(3.0),
        ui.scope_id().with("proof"),
        Sense::click(),
    );
    let response = named(response, Role::Button, words);
    response
        .on_hover_cursor(CursorIcon::PointingHand)
        .on_hover_text(proof_text(outcome))
        .asks(LayoutCommand::ShowSheet(Some(Sheet::Reasons)), commands);
}

/// Channels on one side: inputs on the left, or outputs on the right.
#[derive(Clone, Copy)]
struct SideValues<'a> {
    side: ChannelSide,
    place: Rect,
    state: &'a State,
    shown: &'a ConditionAnalysis,
    palette: &'a Palette,
}

/// Right edges of the values on one side, from the left end of its rows \[pt\].
struct Columns {
    gain_end: f32,
    delay_end: f32,
    /// Whether any gain has changed since the settings were opened.
    gain_changed: bool,
    /// Whether any delay has changed since the settings were opened.
    delay_changed: bool,
    /// Whether the row has room for the earlier delays; otherwise only the tooltips have them.
    shows_earlier_delays: bool,
}

/// A channel's gain or delay.
struct ChannelValue {
    text: String,
    font: FontId,
    color: Color32,
    /// Error bar's half-width, such as "±12": for a gain relative \[%\], for a delay \[ms\].
    half_width: Option<String>,
    /// Value when the settings were opened, if its text has changed since.
    earlier: Option<String>,
    /// Accessible name, without the value.
    name: String,
    /// Units of the value and of the half-width in the accessible name.
    unit: &'static str,
    half_width_unit: &'static str,
    /// Unrounded value, for the tooltip.
    exact: String,
    scalar: Scalar,
    asked: ExplainTarget,
}

impl ChannelValue {
    /// Returns "Gain of LON: 1.059, previously 1.023", or "Gain of LON: 1.059 ±3 %" with the error
    /// bar's half-width instead.
    fn accessible_name(&self) -> String {
        let value = format!("{}: {}{}", self.name, self.text, self.unit);
        match (&self.earlier, &self.half_width) {
            (Some(earlier), _) => format!("{value}, previously {earlier}{}", self.unit),
            (None, Some(half_width)) => format!("{value} {half_width}{}", self.half_width_unit),
            (None, None) => value,
        }
    }
}

/// Greatest widths of the texts in a column \[pt\].
#[derive(Default)]
struct ColumnWidths {
    value: f32,
    /// Width of the earlier values; 0 if none has changed.
    earlier: f32,
}

impl ColumnWidths {
    fn add(&mut self, ui: &Ui, value: &ChannelValue) {
        self.value = self
            .value
            .max(text_width(ui, &value.text, value.font.clone()));
        if let Some(earlier) = &value.earlier {
            self.earlier = self.earlier.max(text_width(ui, earlier, small()));
        }
    }
}

impl SideValues<'_> {
    fn row(&self, number: usize) -> Rect {
        Rect::from_min_size(
            self.place.min + vec2(0.0, ROW * number as f32),
            vec2(self.place.width(), ROW),
        )
    }

    fn ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let dataset = self.state.dataset();
        let palette = self.palette;
        let channels = self.side.pick(dataset.inputs(), dataset.outputs());
        let head = self.row(0);
        let title = self.side.to_string();
        painted_text(ui, head, 0.0, &title, small(), palette.dim_text);
        let columns = self.columns(ui);
        let gain_unit = if columns.gain_changed { "was" } else { "±%" };
        let delay_unit = match (columns.delay_changed, columns.shows_earlier_delays) {
            (false, _) => "±",
            (true, true) => "was",
            (true, false) => "",
        };
        for (end, words, unit) in [
            (columns.gain_end, "k", gain_unit),
            (columns.delay_end, "τ ms", delay_unit),
        ] {
            painted_upto(ui, head, end, words, small(), palette.dim_text);
            painted_text(ui, head, end + BESIDE_GAP, unit, small(), palette.dim_text);
        }
        for (index, channel) in channels.iter().enumerate() {
            let row = self.row(index + 1);
            painted_text(ui, row, 0.0, &channel.name, body(), palette.text);
            let gain = self.gain(index, &channel.name);
            let gain_end = self.value_ui(ui, row, gain, columns.gain_end, commands);
            let delay = self.delay(index, &channel.name);
            let least_end = gain_end + LEAST_GAP + text_width(ui, &delay.text, body());
            let delay_end = columns.delay_end.max(least_end);
            self.value_ui(ui, row, delay, delay_end, commands);
        }
    }

    fn channel(&self, index: usize) -> Channel {
        match self.side {
            ChannelSide::Input => Channel::Input(index),
            ChannelSide::Output => Channel::Output(index),
        }
    }

    /// Divides the row width among the columns. Values that have not changed have their usual places;
    /// beside changed values, whose earlier values are wider than error bars, the columns move
    /// towards the channel names.
    fn columns(&self, ui: &Ui) -> Columns {
        let dataset = self.state.dataset();
        let channels = self.side.pick(dataset.inputs(), dataset.outputs());
        let mut names = 0.0_f32;
        let mut gains = ColumnWidths::default();
        let mut delays = ColumnWidths::default();
        for (index, channel) in channels.iter().enumerate() {
            names = names.max(text_width(ui, &channel.name, body()));
            gains.add(ui, &self.gain(index, &channel.name));
            delays.add(ui, &self.delay(index, &channel.name));
        }
        let width = self.place.width();
        let mut gain_end = GAIN_END * width;
        let mut delay_end = DELAY_END * width;
        if gains.earlier > 0.0 {
            gain_end = gain_end.min(names + LEAST_GAP + gains.value);
            let least_end = gain_end + BESIDE_GAP + gains.earlier + LEAST_GAP + delays.value;
            delay_end = delay_end
                .min(width - BESIDE_GAP - delays.earlier)
                .max(least_end);
        }
        Columns {
            gain_end,
            delay_end,
            gain_changed: gains.earlier > 0.0,
            delay_changed: delays.earlier > 0.0,
            shows_earlier_delays: delay_end + BESIDE_GAP + delays.earlier <= width + BEYOND_ROW,
        }
    }

    /// Returns a value's text when the settings were opened, unless it equals `text`.
    fn earlier_text(
        &self,
        text: &str,
        index: usize,
        text_in: fn(&ConditionAnalysis, Channel) -> String,
    ) -> Option<String> {
        let previous = text_in(self.state.previous_result()?, self.channel(index));
        if previous == text {
            None
        } else {
            Some(previous)
        }
    }

    fn gain(&self, index: usize, name: &str) -> ChannelValue {
        let channel = self.channel(index);
        let gain = gain_of(self.shown, channel);
        let scalar = Scalar::ChannelGain(channel);
        let text = gain_text_of(self.shown, channel);
        ChannelValue {
            earlier: self.earlier_text(&text, index, gain_text_of),
            text,
            font: medium(BODY_SIZE),
            color: self.palette.text,
            half_width: self
                .state
                .painted_uncertainty()
                .half_width(scalar)
                .map(|half| format!("±{:.0}", 100.0 * half)),
            name: format!("Gain of {name}"),
            unit: "",
            half_width_unit: " %",
            exact: gain.to_string(),
            scalar,
            asked: ExplainTarget::Gain(self.shown.condition.id(), channel),
        }
    }

    fn delay(&self, index: usize, name: &str) -> ChannelValue {
        let channel = self.channel(index);
        let delay_ms = delay_ms_of(self.shown, channel);
        let is_delayed = delay_ms != 0.0;
        let scalar = Scalar::ChannelDelay(channel);
        let half_s = if is_delayed {
            self.state.painted_uncertainty().half_width(scalar)
        } else {
            None
        };
        let text = delay_text_of(self.shown, channel);
        let mut exact = format!("{delay_ms} ms");
        if let Some(compensated) = &self.shown.compensated
            && let Some(filter) = compensated.leads.filters()[channel]
        {
            exact.push_str(&format!("\nlead: {}", servo_words(filter)));
        }
        ChannelValue {
            earlier: self.earlier_text(&text, index, delay_text_of),
            text,
            font: body(),
            color: if is_delayed {
                self.palette.text
            } else {
                self.palette.quiet_text
            },
            half_width: half_s.map(|half_s| format!("±{:.0}", s_to_ms(half_s))),
            name: format!("Delay of {name}"),
            unit: " ms",
            half_width_unit: " ms",
            exact,
            scalar,
            asked: ExplainTarget::Delay(self.shown.condition.id(), channel),
        }
    }

    /// Draws a value, which ends `end` points from the left of the row, with its earlier value, or
    /// with the half-width of its error bar; a click opens its derivation. Returns the right end of
    /// all this, also from the left of the row \[pt\].
    fn value_ui(
        &self,
        ui: &mut Ui,
        row: Rect,
        value: ChannelValue,
        end: f32,
        commands: &mut Vec<Command>,
    ) -> f32 {
        let accessible_name = value.accessible_name();
        let ChannelValue {
            text,
            half_width,
            name,
            unit,
            exact,
            earlier,
            scalar,
            ..
        } = value;
        let place = painted_upto(ui, row, end, &text, value.font, value.color);
        let beside = end + BESIDE_GAP;
        let mut right_end = place.right();
        if let Some(earlier) = &earlier {
            let width = text_width(ui, earlier, small());
            if beside + width <= row.width() + BEYOND_ROW {
                let shown = painted_text(ui, row, beside, earlier, small(), self.palette.dim_text);
                right_end = shown.right();
            }
        } else if let Some(half_width) = &half_width {
            let color = if self.state.older_uncertainty().is_some() {
                self.palette.dim_text.gamma_multiply(OLDER)
            } else {
                self.palette.dim_text
            };
            right_end = painted_text(ui, row, beside, half_width, small(), color).right();
        }
        let area = row
            .with_min_x(place.left() - 4.0)
            .with_max_x(place.right() + 3.0)
            .shrink2(vec2(0.0, 0.5));
        let response = ui.interact(area, ui.scope_id().with(&name), Sense::click());
        let response = named(response, Role::Button, accessible_name);
        let mut hint = exact;
        if let Some(earlier) = &earlier {
            hint.push_str(&format!(
                "\nwas {earlier}{unit} when the settings were opened"
            ));
        }
        if let Some((bar, level)) = self.state.value_uncertainty().error_bar(scalar) {
            hint.push_str(&format!("\n{}", error_bar_words(bar, scalar, level)));
        }
        hint.push_str(&format!("\nclick: {QUESTION}"));
        let response = response
            .on_hover_cursor(CursorIcon::Help)
            .on_hover_text(hint);
        response.asks(SelectionCommand::Explain(Some(value.asked)), commands);
        right_end - row.left()
    }
}

fn gain_of(result: &ConditionAnalysis, channel: Channel) -> f64 {
    match channel {
        Channel::Input(index) => result.gains.inputs[index],
        Channel::Output(index) => result.gains.outputs[index],
    }
}

fn gain_text_of(result: &ConditionAnalysis, channel: Channel) -> String {
    decimals(gain_of(result, channel), 3)
}

fn delay_ms_of(result: &ConditionAnalysis, channel: Channel) -> f64 {
    match channel {
        Channel::Input(index) => s_to_ms(result.delays.inputs[index]),
        Channel::Output(index) => s_to_ms(result.delays.outputs[index]),
    }
}

fn delay_text_of(result: &ConditionAnalysis, channel: Channel) -> String {
    let delay_ms = delay_ms_of(result, channel);
    if delay_ms == 0.0 {
        return "0".to_owned();
    }
    let digits = if delay_ms.abs() < 10.0 { 1 } else { 0 };
    decimals(delay_ms, digits)
}

/// Paints right-aligned text that ends `end` points from the left of the row; returns its rectangle.
fn painted_upto(ui: &Ui, row: Rect, end: f32, words: &str, font: FontId, color: Color32) -> Rect {
    painted_text(
        ui,
        row.with_max_x(row.left() + end),
        AT_RIGHT_END,
        words,
        font,
        color,
    )
}
