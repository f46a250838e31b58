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

/// Row in the card: a quantity, its required or initial value, the remaining value, and the error
/// bar.
#[derive(Clone, Debug, PartialEq)]
pub struct CardRow {
    pub name: &'static str,
    /// Required gain or delay with its unit, or J before the correction.
    pub wants: String,
    /// Gain error, delay error or J that remains after the correction.
    pub left: String,
    /// Error bar's half-width with its unit; empty without an error bar, as for J.
    pub half: String,
    /// Whether the correction has hardly reduced the value: a delay of which more than 0.5 ms and
    /// at least 99 % remain, a part of J as in `is_not_reduced`; always false for the gain.
    pub is_missed: bool,
}

/// Returns the rows for a response: gain, delay, and both parts of J.
pub fn card_rows(state: &State, shown: &ConditionAnalysis, pair: Pair) -> Vec<CardRow> {
    let value_uncertainty = state.painted_uncertainty();
    let mut rows = Vec::new();
    if let Some(gain) = shown.wanted_gain(pair) {
        let half = value_uncertainty
            .half_width(Scalar::Gain(pair))
            .map(|half| format!("{} %", decimals(100.0 * half, 1)));
        rows.push(CardRow {
            name: "gain G",
            wants: decimals(gain, 3),
            left: decimals(gain / shown.correction.net_gain(pair), 3),
            half: half.unwrap_or_default(),
            is_missed: false,
        });
    }
    if let Some(delay_s) = shown.wanted_delay_s(pair) {
        let left_ms = s_to_ms(delay_s - shown.correction.net_delay_s(pair));
        let half = value_uncertainty
            .half_width(shown.wanted_delay(pair))
            .map(|half_s| milliseconds(s_to_ms(half_s)));
        rows.push(CardRow {
            name: "delay D",
            wants: milliseconds(s_to_ms(delay_s)),
            left: milliseconds(left_ms),
            half: half.unwrap_or_default(),
            is_missed: left_ms.abs() > 0.5 && left_ms.abs() >= 0.99 * s_to_ms(delay_s).abs(),
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
        wants: decimals(before, 1),
        left: decimals(after, 1),
        half: String::new(),
        is_missed: is_not_reduced(before, after),
    }
}

/// Formats a time \[ms\] with its unit, such as "56.3 ms".
fn milliseconds(value: f64) -> String {
    format!("{} ms", decimals(value, 1))
}

/// Returns whether a part of J remains above 1 and has decreased by less than 0.1.
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
        painted_text(ui, line, ends[0], &row.wants, body(), palette.text);
        let color = if row.is_missed {
            palette.warning
        } else {
            palette.text
        };
        painted_text(ui, line, ends[1], &row.left, body(), color);
        let half_color = if state.older_uncertainty().is_some() {
            palette.dim_text.gamma_multiply(OLDER)
        } else {
            palette.dim_text
        };
        painted_text(ui, line, ends[2], &row.half, body(), half_color);
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
