//! Constraint matrix: every response with G, D and J, constrained or free; and the card of the
//! response in focus with its request, remainder and error bar.

use egui::{
    Align2, Color32, Grid, Key, Rect, Response, RichText, Role, ScrollArea, Sense, Stroke,
    StrokeKind, Ui, WidgetInfo, pos2, vec2,
};

use gdcm_method::correction::Channel;
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::Pair;
use gdcm_model::number_format::decimals;
use gdcm_model::units::s_to_ms;
use gdcm_study::decisions::signs::SignRole;
use gdcm_study::results::caution::Undefined;
use gdcm_study::{ConditionAnalysis, Edit};
use gdcm_words::ExplainTarget;
use gdcm_words::caution::undefined_text;

use super::explanation::{gain_conflict_marks, question_menu_ui, turn_entry};
use super::table_menu::table_menu_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::results::Sureness;
use crate::gui::state::tables::TableKind;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::check_ui;
use crate::gui::widgets::controls::{entries_ui, named_switch, painted_text};
use crate::gui::widgets::focus::{Region, region_ui};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, body, medium, small};

/// Least and greatest height of a cell \[pt\].
const CELL_HEIGHTS: [f32; 2] = [34.0, 44.0];
/// Gap between two cells \[pt\].
const GAP: f32 = 3.0;
const LEAST_CELL_WIDTH: f32 = 58.0;
const ROW_LABEL_WIDTH: f32 = 28.0;
const HEADER_HEIGHT: f32 = 20.0;
const LOCK_SIZE: f32 = 13.0;
/// J at which an underline reaches the full length of its cell.
const FULL_COST: f64 = 60.0;
/// Draws every response as a cell, within `room` points of height. A click on the cell shows the
/// response in the large plot; a click on its box, a double click or the space bar constrains or
/// releases it; a right-click offers more.
pub fn matrix_ui(
    ui: &mut Ui,
    state: &State,
    room: f32,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let (rect, heading) = ui.allocate_exact_size(vec2(ui.available_width(), 20.0), Sense::hover());
    painted_text(
        ui,
        rect,
        0.0,
        "Constraint matrix",
        medium(BODY_SIZE),
        palette.text,
    );
    key_ui(ui, rect, palette);
    table_menu_ui(ui, &heading, TableKind::Matrix, commands);
    let outputs = state.dataset().outputs().len();
    let pitch = (room - 20.0 - HEADER_HEIGHT) / outputs as f32;
    let height = (pitch - GAP).clamp(CELL_HEIGHTS[0], CELL_HEIGHTS[1]);
    region_ui(ui, Region::Matrix, |ui| {
        cells_ui(ui, state, (room - 20.0, height), palette, commands)
    });
}

/// Draws the key of the underlines, from right to left.
fn key_ui(ui: &Ui, row: Rect, palette: &Palette) {
    let mut right = row.right();
    for (words, color) in [
        ("not reduced", palette.warning),
        ("after", palette.text),
        ("before", palette.quiet_mark),
    ] {
        let upto = row.with_max_x(right);
        let place = painted_text(ui, upto, -0.01, words, small(), palette.dim_text);
        let mark = Rect::from_center_size(pos2(place.left() - 9.0, row.center().y), vec2(9.0, 3.0));
        ui.painter().rect_filled(mark, 1.5, color);
        right = mark.left() - 10.0;
    }
    if row.width() > 310.0 {
        painted_text(
            ui,
            row.with_max_x(right),
            -0.01,
            "J",
            small(),
            palette.dim_text,
        );
    }
}

fn cells_ui(
    ui: &mut Ui,
    state: &State,
    (room, cell_height): (f32, f32),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let outputs = state.dataset().outputs();
    let inputs = state.dataset().inputs();
    let width = ((ui.available_width() - ROW_LABEL_WIDTH + GAP) / inputs.len() as f32)
        .max(LEAST_CELL_WIDTH);
    let pitch = cell_height + GAP;
    let size = vec2(
        ROW_LABEL_WIDTH + width * inputs.len() as f32 - GAP,
        HEADER_HEIGHT + pitch * outputs.len() as f32,
    );
    let (in_conflict, blamed) = state.shown().map(gain_conflict_marks).unwrap_or_default();
    let focus = state.display.selection.pair;
    let name_look = |channel, is_of_focus| match (blamed.contains(&channel), is_of_focus) {
        (true, _) => (palette.warning, small()),
        (_, true) => (palette.text, medium(SMALL_SIZE)),
        _ => (palette.dim_text, small()),
    };
    // A matrix larger than its room scrolls by itself: verdict and export stay in place.
    ScrollArea::both()
        .id_salt("constraint matrix")
        .max_height(room)
        .show(ui, |ui| {
            let (area, _) = ui.allocate_exact_size(size, Sense::hover());
            for (input, channel) in inputs.iter().enumerate() {
                let x = area.left() + ROW_LABEL_WIDTH + width * input as f32 + 0.5 * (width - GAP);
                let (color, font) = name_look(Channel::Input(input), input == focus.input);
                let place = pos2(x, area.top() + 0.5 * HEADER_HEIGHT);
                ui.painter()
                    .text(place, Align2::CENTER_CENTER, &channel.name, font, color);
            }
            for (output, channel) in outputs.iter().enumerate() {
                let top = area.top() + HEADER_HEIGHT + pitch * output as f32;
                let place = pos2(area.left() + ROW_LABEL_WIDTH - 8.0, top + 0.5 * cell_height);
                let (color, font) = name_look(Channel::Output(output), output == focus.output);
                ui.painter()
                    .text(place, Align2::RIGHT_CENTER, &channel.name, font, color);
                for input in 0..inputs.len() {
                    let left = area.left() + ROW_LABEL_WIDTH + width * input as f32;
                    let rect = Rect::from_min_size(pos2(left, top), vec2(width - GAP, cell_height));
                    let pair = Pair { output, input };
                    Cell::of(state, pair, in_conflict.contains(&pair))
                        .ui(ui, rect, palette, commands);
                }
            }
        });
}

struct Cell<'a> {
    pair: Pair,
    name: String,
    focused: bool,
    constrained: bool,
    fitted: bool,
    /// Whether the response is not matched, or prevents others from being matched.
    in_conflict: bool,
    shown: Option<&'a ConditionAnalysis>,
    state: &'a State,
    sureness: Sureness<'a>,
}

impl<'a> Cell<'a> {
    fn of(state: &'a State, pair: Pair, in_conflict: bool) -> Self {
        Self {
            pair,
            name: state.dataset().pair_name(pair),
            focused: state.display.selection.pair == pair,
            constrained: state.study.settings.constrained[pair],
            fitted: !state.study.settings.ignored[pair],
            in_conflict,
            shown: state.shown(),
            state,
            sureness: state.sureness(),
        }
    }

    /// Returns the reason why there is no G, once it is known.
    fn undefined(&self) -> Option<Undefined> {
        self.shown?.comparison.undefined[self.pair]
    }

    fn ui(&self, ui: &mut Ui, rect: Rect, palette: &Palette, commands: &mut Vec<Command>) {
        let response = ui.interact(
            rect,
            ui.scope_id().with(("cell", self.pair)),
            Sense::click(),
        );
        let response = named_switch(
            response,
            Role::Button,
            self.focused,
            format!("Response {}", self.name),
        );
        if response.gained_focus() {
            response.scroll_to_me(None);
        }
        let is_pointed = response.contains_pointer() || response.has_focus();
        self.paint(ui, rect, is_pointed, palette);
        let lock = self.lock_ui(ui, rect, is_pointed, palette);
        let space = response.has_focus() && ui.input(|input| input.key_pressed(Key::Space));
        if lock.clicked() || response.double_clicked() || space {
            if self.constrained || self.undefined().is_none() {
                commands.push(Edit::Hold(self.pair, !self.constrained).into());
            }
        } else if response.clicked() {
            commands.push(SelectionCommand::FocusPair(self.pair).into());
        }
        response.context_menu(|ui| self.menu_ui(ui, commands));
        response.on_hover_ui(|ui| self.tooltip_ui(ui, palette));
    }

    /// Draws the box that constrains or releases the response, at the end of the line of G; visible
    /// under the pointer.
    fn lock_ui(&self, ui: &mut Ui, rect: Rect, is_pointed: bool, palette: &Palette) -> Response {
        let corner = rect.right_top() + vec2(-LOCK_SIZE, 1.0);
        let place = Rect::from_min_size(corner, vec2(LOCK_SIZE, LOCK_SIZE));
        let response = ui.interact(
            place.expand(2.0),
            ui.scope_id().with(("hold", self.pair)),
            Sense::click(),
        );
        let name = format!("Hold {}", self.name);
        response.widget_info(|| {
            WidgetInfo::selected(
                Role::CheckBox,
                self.undefined().is_none(),
                self.constrained,
                &name,
            )
        });
        if !(is_pointed || response.contains_pointer() || response.has_focus()) {
            return response;
        }
        let square = place.shrink(2.0);
        if self.constrained {
            ui.painter().rect_filled(square, 2.0, palette.accent);
            let stroke = Stroke::new(1.6, palette.on_accent());
            let tick = [
                square.left_center() + vec2(2.0, 0.3),
                square.center() + vec2(-0.7, 2.4),
                square.right_top() + vec2(-1.8, 2.6),
            ];
            ui.painter().line(tick.to_vec(), stroke);
        } else if self.undefined().is_none() {
            ui.painter().rect_stroke(
                square,
                2.0,
                Stroke::new(1.0, palette.text),
                StrokeKind::Inside,
            );
        }
        let hint = match (self.undefined(), self.constrained) {
            (Some(why), _) => format!("{} cannot be held: {}", self.name, undefined_text(why)),
            (_, true) => {
                "Held: its net gain exactly, its delay where one can; click to free it".to_owned()
            }
            (_, false) => {
                "Free; click to hold its net gain exactly, and its delay where one can".to_owned()
            }
        };
        response.on_hover_text(hint)
    }

    fn paint(&self, ui: &Ui, rect: Rect, is_pointed: bool, palette: &Palette) {
        let painter = ui.painter();
        let fill = match (self.constrained, is_pointed) {
            (true, _) => palette.selected,
            (false, true) => palette.raised,
            (false, false) => Color32::TRANSPARENT,
        };
        let outline = match (self.in_conflict, self.focused) {
            (_, true) => Stroke::new(2.0, palette.accent),
            (true, false) => Stroke::new(2.0, palette.warning),
            (false, false) => Stroke::new(
                1.0,
                if self.constrained {
                    Color32::TRANSPARENT
                } else {
                    palette.line
                },
            ),
        };
        painter.rect(rect, 4.0, fill, outline, StrokeKind::Inside);
        self.paint_values(ui, rect, is_pointed, palette);
    }

    /// Paints G and D, each with the half-width of its error bar, over an underline of its part of
    /// J.
    fn paint_values(&self, ui: &Ui, rect: Rect, is_pointed: bool, palette: &Palette) {
        let Some(shown) = self.shown else { return };
        let (Some(gain), Some(delay_s)) = (
            shown.wanted_gain(self.pair),
            shown.wanted_delay_s(self.pair),
        ) else {
            let nothing = matches!(self.undefined(), Some(Undefined::NumericallyNothing(_)));
            let words = if nothing { "nothing" } else { "no G" };
            ui.painter().text(
                rect.center(),
                Align2::CENTER_CENTER,
                words,
                small(),
                palette.dim_text,
            );
            return;
        };
        let cost = shown.cost[self.pair];
        let parts = cost.map(|of| {
            let before = of.uncorrected;
            let after = of.corrected;
            [
                [before.magnitude, after.magnitude],
                [before.phase, after.phase],
            ]
        });
        let strong = if self.fitted {
            palette.text
        } else {
            palette.quiet_text
        };
        let gain_half = self
            .sureness
            .half(Scalar::Gain(self.pair))
            .map(|half| format!("±{:.0}", 100.0 * half));
        let delay_half = self
            .sureness
            .half(shown.wanted_delay(self.pair))
            .map(|half| format!("±{:.0}", s_to_ms(half)));
        let values = [
            (decimals(gain, 2), medium(BODY_SIZE), gain_half),
            (decimals(s_to_ms(delay_s), 0), small(), delay_half),
        ];
        let lower = rect.top() + 0.5 * rect.height();
        let halves = [rect.with_max_y(lower), rect.with_min_y(lower - 1.0)];
        for (place, (half, (text, font, bar))) in halves.into_iter().zip(values).enumerate() {
            let mut line = half.shrink2(vec2(6.0, 0.0)).translate(vec2(0.0, -1.5));
            if place == 0 && is_pointed {
                line.max.x = rect.right() - LOCK_SIZE;
            }
            let value = painted_text(ui, line, 0.0, &text, font, strong);
            if let Some(bar) = bar {
                let galley = ui.painter().layout_no_wrap(bar, small(), palette.dim_text);
                // The cell has no room for a three-digit half-width beside a three-digit value:
                // both are in the tooltip and in the card.
                let place = pos2(
                    line.right() - galley.size().x,
                    line.center().y - 0.5 * galley.size().y,
                );
                if place.x > value.right() {
                    ui.painter().galley(place, galley, palette.dim_text);
                }
            }
            if let Some([before, after]) = parts.map(|parts| parts[place]) {
                underline(ui, half, (before, after), palette);
            }
        }
    }

    fn menu_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let mut switch = |ui: &mut Ui, is_on: bool, text: String, edit: fn(Pair, bool) -> Edit| {
            if let Some(is_on) = check_ui(ui, is_on, text, "") {
                commands.push(edit(self.pair, is_on).into());
                ui.close();
            }
        };
        switch(
            ui,
            self.constrained,
            format!("Hold {} exactly", self.name),
            Edit::Hold,
        );
        switch(
            ui,
            self.fitted,
            format!("Fit {} in the objective", self.name),
            Edit::Fit,
        );
        entries_ui(
            ui,
            [(
                "Hold exactly the on-axis responses",
                Edit::ConstrainOnAxis.into(),
            )],
            commands,
        );
        let turn = |channel| {
            let is_turned = self.state.study.signs.contains_key(&channel);
            turn_entry(
                self.state,
                channel,
                (!is_turned).then_some(SignRole::Identified),
            )
        };
        entries_ui(ui, Channel::of(self.pair).map(turn), commands);
        if let Some(shown) = self.shown.filter(|_| self.undefined().is_none()) {
            let id = shown.condition.id();
            let pair = self.pair;
            let values = [
                ("G", ExplainTarget::DeltaGain(id, pair)),
                ("D", ExplainTarget::DeltaDelay(id, pair)),
                ("Net gain", ExplainTarget::NetGain(id, pair)),
                ("Net delay", ExplainTarget::NetDelay(id, pair)),
                ("J before", ExplainTarget::CostBefore(id, pair)),
                ("J after", ExplainTarget::CostAfter(id, pair)),
            ];
            question_menu_ui(
                ui,
                values.map(|(name, asked)| (name.to_owned(), asked)).into(),
                commands,
            );
        }
    }

    /// Draws four aligned rows; the rest is available through
    /// [`QUESTION`](crate::gui::widgets::controls::QUESTION) in the menu.
    fn tooltip_ui(&self, ui: &mut Ui, palette: &Palette) {
        let held = if self.constrained { "held" } else { "free" };
        let ignored = if self.fitted {
            ""
        } else {
            ", ignored in the objective"
        };
        ui.label(RichText::new(format!("{}, {held}{ignored}", self.name)).font(medium(BODY_SIZE)));
        if let Some(why) = self.undefined() {
            ui.label(format!("No G, no D and no J: {}", undefined_text(why)));
            return;
        }
        card_grid_ui(ui, self.state, self.pair, palette);
    }
}

/// Paints the part of J before the correction, pale, and after it; orange if it did not decrease. A
/// tip at the end marks a value beyond the available length.
fn underline(ui: &Ui, half: Rect, (before, after): (f64, f64), palette: &Palette) {
    let y = half.bottom() - 2.5;
    let left = half.left() + 4.0;
    let room = half.width() - 8.0;
    let bar = |cost: f64, color: Color32| {
        let part = (cost / FULL_COST).clamp(0.0, 1.0) as f32;
        let place = Rect::from_min_size(pos2(left, y), vec2(part * room, 2.5));
        ui.painter().rect_filled(place, 1.0, color);
        if cost > FULL_COST {
            let tip = pos2(place.right(), y + 1.25);
            let points = vec![
                tip + vec2(0.0, -2.8),
                tip + vec2(3.0, 0.0),
                tip + vec2(0.0, 2.8),
            ];
            ui.painter()
                .add(egui::Shape::convex_polygon(points, color, Stroke::NONE));
        }
    };
    bar(before, palette.quiet_mark);
    bar(
        after,
        if is_not_reduced(before, after) {
            palette.warning
        } else {
            palette.text
        },
    );
}

/// Height of the card \[pt\].
pub const CARD_HEIGHT: f32 = 104.0;
/// Height of a row \[pt\].
const ROW: f32 = 18.0;

/// Row of the card.
#[derive(Clone, Debug, PartialEq)]
pub struct CardRow {
    pub name: &'static str,
    /// Requested value, with its unit.
    pub wants: String,
    /// Remainder after the correction.
    pub left: String,
    /// Half-width of the error bar.
    pub half: String,
    /// Whether the remainder is not reduced.
    pub is_missed: bool,
}

/// Returns gain, delay and both parts of J of a response: requested values, and remainders after
/// the correction.
pub fn card_rows(state: &State, shown: &ConditionAnalysis, pair: Pair) -> Vec<CardRow> {
    let sureness = state.sureness();
    let mut rows = Vec::new();
    if let Some(gain) = shown.wanted_gain(pair) {
        let left = gain / shown.correction.net_gain(pair);
        let half = sureness
            .half(Scalar::Gain(pair))
            .map(|half| format!("{} %", decimals(100.0 * half, 1)));
        let wants = decimals(gain, 3);
        let left = decimals(left, 3);
        let half = half.unwrap_or_default();
        rows.push(CardRow {
            name: "gain G",
            wants,
            left,
            half,
            is_missed: false,
        });
    }
    if let Some(delay_s) = shown.wanted_delay_s(pair) {
        let left_ms = s_to_ms(delay_s - shown.correction.net_delay_s(pair));
        let ms = |value: f64| format!("{} ms", decimals(value, 1));
        let half = sureness
            .half(shown.wanted_delay(pair))
            .map_or(String::new(), |half| ms(s_to_ms(half)));
        let is_missed = left_ms.abs() > 0.5 && left_ms.abs() >= 0.99 * s_to_ms(delay_s).abs();
        rows.push(CardRow {
            name: "delay D",
            wants: ms(s_to_ms(delay_s)),
            left: ms(left_ms),
            half,
            is_missed,
        });
    }
    if let Some(change) = shown.cost[pair] {
        let before = change.uncorrected;
        let after = change.corrected;
        for (name, before, after) in [
            ("J magnitude", before.magnitude, after.magnitude),
            ("J phase", before.phase, after.phase),
        ] {
            let wants = decimals(before, 1);
            let left = decimals(after, 1);
            let is_missed = is_not_reduced(before, after);
            rows.push(CardRow {
                name,
                wants,
                left,
                half: String::new(),
                is_missed,
            });
        }
    }
    rows
}

/// Returns whether a noticeable part of J has not decreased; a tenth of J is not noticeable.
pub fn is_not_reduced(before: f64, after: f64) -> bool {
    after > 1.0 && after > before - 0.1
}

/// Draws the card of the response in focus.
pub fn card_ui(ui: &mut Ui, state: &State, palette: &Palette) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), CARD_HEIGHT), Sense::hover());
    ui.painter().rect_stroke(
        rect,
        8.0,
        Stroke::new(1.0, palette.line),
        StrokeKind::Inside,
    );
    let inner = rect.shrink2(vec2(11.0, 9.0));
    let pair = state.display.selection.pair;
    let held = if state.study.settings.constrained[pair] {
        "held"
    } else {
        "free"
    };
    let title = format!("{}, {held}", state.dataset().pair_name(pair));
    let line = |row: usize| {
        Rect::from_min_size(
            inner.min + vec2(0.0, ROW * row as f32),
            vec2(inner.width(), ROW),
        )
    };
    painted_text(ui, line(0), 0.0, &title, medium(BODY_SIZE), palette.text);
    let places = [inner.width() * 0.54, inner.width() * 0.78, inner.width()];
    let right = |at: f32| at - inner.width() - 0.01;
    let level = state
        .sureness()
        .level()
        .map(|level| format!("± {:.0} %", 100.0 * level))
        .unwrap_or_default();
    for (at, head) in places.into_iter().zip(["wants", "left", level.as_str()]) {
        painted_text(ui, line(0), right(at), head, small(), palette.dim_text);
    }
    let Some(shown) = state.shown() else { return };
    for (place, row) in card_rows(state, shown, pair).iter().enumerate() {
        let line = line(place + 1);
        painted_text(ui, line, 0.0, row.name, body(), palette.dim_text);
        painted_text(ui, line, right(places[0]), &row.wants, body(), palette.text);
        let color = if row.is_missed {
            palette.warning
        } else {
            palette.text
        };
        painted_text(ui, line, right(places[1]), &row.left, body(), color);
        painted_text(
            ui,
            line,
            right(places[2]),
            &row.half,
            body(),
            palette.dim_text,
        );
    }
}

/// Draws the same rows in a tooltip if there is no room for the card.
pub fn card_grid_ui(ui: &mut Ui, state: &State, pair: Pair, palette: &Palette) {
    let Some(shown) = state.shown() else { return };
    Grid::new("card")
        .num_columns(4)
        .spacing([16.0, 2.0])
        .show(ui, |ui| {
            for head in ["", "wants", "left", "±"] {
                ui.label(palette.small(head));
            }
            ui.end_row();
            for row in card_rows(state, shown, pair) {
                ui.label(palette.dim(row.name));
                ui.label(row.wants);
                let left = RichText::new(row.left);
                ui.label(if row.is_missed {
                    left.color(palette.warning)
                } else {
                    left
                });
                ui.label(palette.dim(row.half));
                ui.end_row();
            }
        });
}
