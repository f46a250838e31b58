//! Cell in the constraint matrix: a response's G and D, each above its part of J; the box that
//! constrains the response; tooltip and menu.
//!
//! G and D are the gain and the delay that would match the response (M6: docs/method.md), J is the
//! cost of its mismatch (M4). A held (constrained) response has its net gain matched exactly, its
//! delay as far as possible; others are free. The card, below the matrix, lists the values of the
//! response in focus.

use egui::{
    Align2, Color32, FontId, Key, Rect, Response, RichText, Role, Sense, Stroke, StrokeKind, Ui,
    WidgetInfo, pos2, vec2,
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

use super::derivation_sheet::question_menu_ui;
use super::response_card::{card_grid_ui, is_not_reduced};
use super::result_panel::OLDER;
use super::sign_reversal::sign_reversal_entry;
use crate::gui::commands::command::Command;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::value_uncertainty::ValueUncertainty;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::check_ui;
use crate::gui::widgets::controls::{entries_ui, named_switch, tooltip_left_of};
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium, small};

/// Side of the box that constrains or releases a response \[pt\].
const HOLD_BOX_SIZE: f32 = 13.0;
/// Margin around the box that also reacts to the pointer \[pt\].
const HOLD_BOX_MARGIN: f32 = 2.0;

/// Part of J (magnitude or phase) at which an underline spans its cell: a larger value would
/// shorten the underlines of small costs, a smaller one would give more costs the same full length.
const FULL_COST: f64 = 60.0;

/// The matrix's area in the panel.
#[derive(Clone, Copy)]
pub(super) struct MatrixPlace {
    pub(super) visible: Rect,
    /// Whether the focused response's card is below the matrix.
    pub(super) has_card: bool,
}

/// Matrix cell for a response, with the facts that determine its look.
pub(super) struct Cell<'a> {
    pair: Pair,
    name: String,
    /// Whether the large plot shows the response.
    focused: bool,
    constrained: bool,
    /// Whether the response has weight in the objective; the engineer may ignore it there.
    fitted: bool,
    /// Whether the response's gain constraint conflicts with others.
    in_conflict: bool,
    shown: Option<&'a ConditionAnalysis>,
    state: &'a State,
    value_uncertainty: ValueUncertainty<'a>,
    /// Whether the focused response's card is visible.
    has_card: bool,
    /// Matrix area, which the tooltip does not cover.
    matrix: Rect,
}

impl<'a> Cell<'a> {
    pub(super) fn new(
        state: &'a State,
        pair: Pair,
        in_conflict: bool,
        matrix: MatrixPlace,
    ) -> Self {
        Self {
            has_card: matrix.has_card,
            matrix: matrix.visible,
            pair,
            name: state.dataset().pair_name(pair),
            focused: state.display.selection.pair == pair,
            constrained: state.study.settings.constrained[pair],
            fitted: !state.study.settings.ignored[pair],
            in_conflict,
            shown: state.shown(),
            state,
            value_uncertainty: state.painted_uncertainty(),
        }
    }

    /// Returns the reason why G is undefined; `None` if it is defined, or without a result.
    fn undefined(&self) -> Option<Undefined> {
        self.shown?.comparison.undefined[self.pair]
    }

    /// Draws the cell and its box. A click on the box, a double click or the space bar constrains
    /// or releases the response (an undefined response can only be released); any other click
    /// brings it into focus.
    pub(super) fn ui(
        &self,
        ui: &mut Ui,
        rect: Rect,
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
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
        let hold_box = self.hold_box_ui(ui, rect, is_pointed, palette);
        let space = response.has_focus() && ui.input(|input| input.key_pressed(Key::Space));
        if hold_box.clicked() || response.double_clicked() || space {
            if self.constrained || self.undefined().is_none() {
                commands.push(Edit::Hold(self.pair, !self.constrained).into());
            }
        } else if response.clicked() {
            commands.push(SelectionCommand::FocusPair(self.pair).into());
        }
        response.context_menu(|ui| self.menu_ui(ui, commands));
        // The card below the matrix shows the same rows for the focused response.
        if !(self.focused && self.has_card) {
            tooltip_left_of(&response, self.matrix, |ui| self.tooltip_ui(ui, palette));
        }
    }

    /// Draws the box that constrains or releases the response, at the end of the G line; it is
    /// visible while the cell has the pointer or the focus.
    fn hold_box_ui(
        &self,
        ui: &mut Ui,
        rect: Rect,
        is_pointed: bool,
        palette: &Palette,
    ) -> Response {
        let corner = rect.right_top() + vec2(-HOLD_BOX_SIZE, 1.0);
        let place = Rect::from_min_size(corner, vec2(HOLD_BOX_SIZE, HOLD_BOX_SIZE));
        let response = ui.interact(
            place.expand(HOLD_BOX_MARGIN),
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
        let hint = if let Some(why) = self.undefined() {
            format!("{} cannot be held: {}", self.name, undefined_text(why))
        } else if self.constrained {
            "Held: net gain exact, delay as far as possible; click to release".to_owned()
        } else {
            "Free; click to hold the net gain exactly, the delay as far as possible".to_owned()
        };
        response.on_hover_text(hint)
    }

    /// Paints background, outline and values. The outline shows the focus, or else a conflict; a
    /// constrained response needs none, because its background shows the constraint.
    fn paint(&self, ui: &Ui, rect: Rect, is_pointed: bool, palette: &Palette) {
        let painter = ui.painter();
        let fill = if self.constrained {
            palette.selected
        } else if is_pointed {
            palette.raised
        } else {
            Color32::TRANSPARENT
        };
        let outline = if self.focused {
            Stroke::new(2.0, palette.accent)
        } else if self.in_conflict {
            Stroke::new(2.0, palette.warning)
        } else if self.constrained {
            Stroke::new(1.0, Color32::TRANSPARENT)
        } else {
            Stroke::new(1.0, palette.line)
        };
        painter.rect(rect, 4.0, fill, outline, StrokeKind::Inside);
        self.paint_values(ui, rect, is_pointed, palette);
    }

    /// Paints G above D \[ms\], each with the half-width of its error bar and its part of J as an
    /// underline; for a response without G, only "no G", or "zero" if it is numerically zero.
    fn paint_values(&self, ui: &Ui, rect: Rect, is_pointed: bool, palette: &Palette) {
        let Some(shown) = self.shown else { return };
        let gain = shown.delta_gain(self.pair);
        let delay_s = shown.delta_delay_s(self.pair);
        let (Some(gain), Some(delay_s)) = (gain, delay_s) else {
            let nothing = matches!(self.undefined(), Some(Undefined::NumericallyZero(_)));
            let words = if nothing { "zero" } else { "no G" };
            ui.painter().text(
                rect.center(),
                Align2::CENTER_CENTER,
                words,
                small(),
                palette.dim_text,
            );
            return;
        };
        let change = shown.cost[self.pair];
        let gain_half = self.value_uncertainty.half_width(Scalar::Gain(self.pair));
        let delay_half = self
            .value_uncertainty
            .half_width(shown.delta_delay_scalar(self.pair));
        let gain_bar = gain_half.map(|half| format!("±{:.0}", 100.0 * half));
        let middle = rect.top() + 0.5 * rect.height();
        let bar_color = if self.state.older_uncertainty().is_some() {
            palette.dim_text.gamma_multiply(OLDER)
        } else {
            palette.dim_text
        };
        let upper = CellValue {
            half: rect.with_max_y(middle),
            text: decimals(gain, 2),
            font: medium(BODY_SIZE),
            bar: gain_bar,
            bar_color,
            underline: change.map(|change| CostParts {
                before: change.uncorrected.magnitude,
                after: change.corrected.magnitude,
            }),
            // Under the pointer, the box that constrains the response takes the error bar's place.
            end_room: if is_pointed {
                HOLD_BOX_SIZE + 2.0 * HOLD_BOX_MARGIN
            } else {
                6.0
            },
        };
        let lower = CellValue {
            half: rect.with_min_y(middle - 1.0),
            text: decimals(s_to_ms(delay_s), 0),
            font: small(),
            bar: delay_half.map(|half| format!("±{:.0}", s_to_ms(half))),
            bar_color,
            underline: change.map(|change| CostParts {
                before: change.uncorrected.phase,
                after: change.corrected.phase,
            }),
            end_room: 6.0,
        };
        let color = if self.fitted {
            palette.text
        } else {
            palette.quiet_text
        };
        upper.paint(ui, color, palette);
        lower.paint(ui, color, palette);
    }

    fn menu_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let hold = format!("Hold {} exactly", self.name);
        if let Some(is_on) = check_ui(ui, self.constrained, hold, "") {
            commands.push(Edit::Hold(self.pair, is_on).into());
            ui.close();
        }
        let fit = format!("Include {} in the objective", self.name);
        if let Some(is_on) = check_ui(ui, self.fitted, fit, "") {
            commands.push(Edit::Fit(self.pair, is_on).into());
            ui.close();
        }
        entries_ui(
            ui,
            [(
                "Hold only the on-axis responses",
                Edit::ConstrainOnAxis.into(),
            )],
            commands,
        );
        let sign_entries = Channel::of_pair(self.pair).map(|channel| self.sign_entry(channel));
        entries_ui(ui, sign_entries, commands);
        if let Some(shown) = self.shown
            && self.undefined().is_none()
        {
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

    /// Returns the menu entry that reverses the identified sign of a channel, or restores it.
    fn sign_entry(&self, channel: Channel) -> (String, Command) {
        let is_reversed = self.state.study.signs.contains_key(&channel);
        let role = if is_reversed {
            None
        } else {
            Some(SignRole::Identified)
        };
        sign_reversal_entry(self.state, channel, role)
    }

    /// Draws the rows of the response's card, or why G is undefined. The submenu
    /// [`QUESTION`](crate::gui::plot::derivation_menu::QUESTION) in the cell's menu leads to the
    /// derivation of every value.
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

/// Magnitude or phase part of J, before and after the correction.
struct CostParts {
    before: f64,
    after: f64,
}

/// Value in the upper or lower half of a cell.
struct CellValue {
    half: Rect,
    text: String,
    font: FontId,
    /// Error bar's half-width, such as "±12": for G relative \[%\], for D \[ms\].
    bar: Option<String>,
    bar_color: Color32,
    underline: Option<CostParts>,
    /// Space reserved at the right end \[pt\].
    end_room: f32,
}

impl CellValue {
    fn paint(self, ui: &Ui, color: Color32, palette: &Palette) {
        let mut line = self.half.shrink2(vec2(6.0, 0.0));
        line.max.x = self.half.right() - self.end_room;
        let line = line.translate(vec2(0.0, -1.5));
        let value = painted_text(ui, line, 0.0, &self.text, self.font, color);
        if let Some(bar) = self.bar {
            let galley = ui.painter().layout_no_wrap(bar, small(), self.bar_color);
            // A three-digit half-width does not fit beside a three-digit value; both are in the
            // tooltip and in the card.
            let place = pos2(
                line.right() - galley.size().x,
                line.center().y - 0.5 * galley.size().y,
            );
            if place.x > value.right() {
                ui.painter().galley(place, galley, self.bar_color);
            }
        }
        if let Some(parts) = self.underline {
            underline(ui, self.half, parts, palette);
        }
    }
}

/// Paints a part of J before the correction (pale) and after it (orange if it remains above 1 and
/// has decreased by less than 0.1).
fn underline(ui: &Ui, half: Rect, parts: CostParts, palette: &Palette) {
    paint_cost_bar(ui, half, parts.before, palette.quiet_mark);
    let after_color = if is_not_reduced(parts.before, parts.after) {
        palette.warning
    } else {
        palette.text
    };
    paint_cost_bar(ui, half, parts.after, after_color);
}

/// Paints a bar whose length is proportional to the cost; a tip at its end marks a cost beyond
/// [`FULL_COST`].
fn paint_cost_bar(ui: &Ui, half: Rect, cost: f64, color: Color32) {
    let y = half.bottom() - 2.5;
    let room = half.width() - 8.0;
    let part = (cost / FULL_COST).clamp(0.0, 1.0) as f32;
    let place = Rect::from_min_size(pos2(half.left() + 4.0, y), vec2(part * room, 2.5));
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
}
