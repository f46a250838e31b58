//! Card about the focused response: required corrections, remaining errors, error bars.
//!
//! G and D are the gain and the delay that would match the response (M6: docs/method.md), J is the
//! cost of its mismatch (M4).

use egui::{Grid, Rect, RichText, Sense, Stroke, StrokeKind, Ui, vec2};

use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::Pair;
use gdcm_model::number_format::decimals;
use gdcm_model::units::s_to_ms;
use gdcm_study::ConditionAnalysis;

use super::result_panel::OLDER;
use crate::gui::state::window_state::State;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium, small};

/// Card height \[pt\].
pub const CARD_HEIGHT: f32 = 104.0;
/// Row height \[pt\].
const ROW: f32 = 18.0;

/// Row in the card: a quantity before and after the correction, and its error bar.
#[derive(Clone, Debug, PartialEq)]
pub struct CardRow {
    pub name: &'static str,
    /// Gain or delay that would match the response, with its unit, or J before the correction.
    pub before: String,
    /// Gain, delay or J that remains after the correction.
    pub after: String,
    /// Error bar's half-width with its unit; empty without an error bar, as for J.
    pub half_width: String,
    /// Whether the correction has hardly reduced the value (`is_delay_not_reduced`,
    /// `is_not_reduced`); always false for the gain.
    pub is_not_reduced: bool,
}

/// Returns the rows for a response: gain, delay, and both parts of J.
pub fn card_rows(state: &State, shown: &ConditionAnalysis, pair: Pair) -> Vec<CardRow> {
    let value_uncertainty = state.painted_uncertainty();
    let mut rows = Vec::new();
    if let Some(gain) = shown.delta_gain(pair) {
        let half = value_uncertainty
            .half_width(Scalar::Gain(pair))
            .map(|half| format!("{} %", decimals(100.0 * half, 1)));
        rows.push(CardRow {
            name: "gain G",
            before: decimals(gain, 3),
            after: decimals(gain / shown.correction.net_gain(pair), 3),
            half_width: half.unwrap_or_default(),
            is_not_reduced: false,
        });
    }
    if let Some(delay_s) = shown.delta_delay_s(pair) {
        let before_ms = s_to_ms(delay_s);
        let after_ms = s_to_ms(delay_s - shown.correction.net_delay_s(pair));
        let half = value_uncertainty
            .half_width(shown.delta_delay_scalar(pair))
            .map(|half_s| milliseconds(s_to_ms(half_s)));
        rows.push(CardRow {
            name: "delay D",
            before: milliseconds(before_ms),
            after: milliseconds(after_ms),
            half_width: half.unwrap_or_default(),
            is_not_reduced: is_delay_not_reduced(before_ms, after_ms),
        });
    }
    if let Some(change) = shown.cost[pair] {
        let before = change.uncorrected;
        let after = change.corrected;
        rows.push(cost_row("J magnitude", before.magnitude, after.magnitude));
        rows.push(cost_row("J phase", before.phase, after.phase));
    }
    rows
}

fn cost_row(name: &'static str, before: f64, after: f64) -> CardRow {
    CardRow {
        name,
        before: decimals(before, 1),
        after: decimals(after, 1),
        half_width: String::new(),
        is_not_reduced: is_not_reduced(before, after),
    }
}

/// Formats a time \[ms\] with its unit, such as "56.3 ms".
fn milliseconds(value: f64) -> String {
    format!("{} ms", decimals(value, 1))
}

/// Returns whether at least 99 % of a delay \[ms\] remain after the correction; false for a
/// remainder up to 0.5 ms, half a unit of the last digit in the matrix.
fn is_delay_not_reduced(before_ms: f64, after_ms: f64) -> bool {
    after_ms.abs() > 0.5 && after_ms.abs() >= 0.99 * before_ms.abs()
}

/// Returns whether a part of J has decreased by less than 0.1, the last displayed digit; false for
/// a remainder up to 1: a total J of 50 is already next to indistinguishable.
pub(super) fn is_not_reduced(before: f64, after: f64) -> bool {
    after > 1.0 && after > before - 0.1
}

/// Draws the focused response's card.
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
    let title_line = card_line(inner, 0);
    painted_text(ui, title_line, 0.0, &title, medium(BODY_SIZE), palette.text);
    // Distances from the right edge to the text ends; negative, because the text is right-aligned.
    let ends = [inner.width() * 0.54, inner.width() * 0.78, inner.width()]
        .map(|end| end - inner.width() + AT_RIGHT_END);
    let level = state
        .painted_uncertainty()
        .level()
        .map(|level| format!("± {:.0} %", 100.0 * level))
        .unwrap_or_default();
    for (end, head) in ends.into_iter().zip(["before", "after", level.as_str()]) {
        painted_text(ui, title_line, end, head, small(), palette.dim_text);
    }
    let Some(shown) = state.shown() else { return };
    for (place, row) in card_rows(state, shown, pair).iter().enumerate() {
        let line = card_line(inner, place + 1);
        painted_text(ui, line, 0.0, row.name, body(), palette.dim_text);
        painted_text(ui, line, ends[0], &row.before, body(), palette.text);
        let color = if row.is_not_reduced {
            palette.warning
        } else {
            palette.text
        };
        painted_text(ui, line, ends[1], &row.after, body(), color);
        let half_color = if state.older_uncertainty().is_some() {
            palette.dim_text.gamma_multiply(OLDER)
        } else {
            palette.dim_text
        };
        painted_text(ui, line, ends[2], &row.half_width, body(), half_color);
    }
}

/// Returns a row's rectangle; row 0 is the title.
fn card_line(inner: Rect, row: usize) -> Rect {
    Rect::from_min_size(
        inner.min + vec2(0.0, ROW * row as f32),
        vec2(inner.width(), ROW),
    )
}

/// Draws the card's rows in a tooltip.
pub fn card_grid_ui(ui: &mut Ui, state: &State, pair: Pair, palette: &Palette) {
    let Some(shown) = state.shown() else { return };
    Grid::new("card")
        .num_columns(4)
        .spacing([16.0, 2.0])
        .show(ui, |ui| {
            for head in ["", "before", "after", "±"] {
                ui.label(palette.small(head));
            }
            ui.end_row();
            for row in card_rows(state, shown, pair) {
                ui.label(palette.dim(row.name));
                ui.label(row.before);
                let after = RichText::new(row.after);
                ui.label(if row.is_not_reduced {
                    after.color(palette.warning)
                } else {
                    after
                });
                ui.label(palette.dim(row.half_width));
                ui.end_row();
            }
        });
}
