//! The response in focus in four rows: what it wants, what is left, and how sure that is.

use egui::{FontId, Sense, Stroke, StrokeKind, Ui, vec2};

use gdcm_core::study::ConditionAnalysis;
use gdcm_core::uncertainty::Scalar;
use gdcm_core::units::s_to_ms;
use gdcm_files::figure::decimals;

use super::palette::medium;
use super::{BODY_SIZE, Palette, SMALL_SIZE, State, painted_text};
use gdcm_core::dataset::Pair;

/// Height of the card \[pt\].
pub const HEIGHT: f32 = 104.0;
/// Height of a row \[pt\].
const ROW: f32 = 18.0;

/// One row: its name, what the response wants, what the correction leaves, half the width of the bar, and whether too much is left.
#[derive(Clone, Debug, PartialEq)]
pub struct CardRow {
    /// "gain G".
    pub name: &'static str,
    /// What the response wants, with its unit.
    pub wants: String,
    /// What is left of it.
    pub left: String,
    /// Half the width of its bar.
    pub half: String,
    /// Whether what is left is not reduced.
    pub is_missed: bool,
}

/// Gain, delay and both parts of J of a response: what it wants, and what is left after the correction.
pub fn card_rows(state: &State, shown: &ConditionAnalysis, pair: Pair) -> Vec<CardRow> {
    let sureness = state.sureness();
    let row = |name, wants: String, left: String, half: Option<String>, is_missed| CardRow {
        name,
        wants,
        left,
        half: half.unwrap_or_default(),
        is_missed,
    };
    let mut rows = Vec::new();
    if let Some(gain) = shown.wanted_gain(pair) {
        let left = gain / shown.correction.net_gain(pair);
        let half = sureness.half(Scalar::Gain(pair)).map(|half| format!("{} %", decimals(100.0 * half, 1)));
        rows.push(row("gain G", decimals(gain, 3), decimals(left, 3), half, false));
    }
    if let Some(delay_s) = shown.wanted_delay_s(pair) {
        let left_ms = s_to_ms(delay_s - shown.correction.net_delay_s(pair));
        let ms = |value: f64| format!("{} ms", decimals(value, 1));
        let half = sureness.half(shown.wanted_delay(pair)).map(|half| ms(s_to_ms(half)));
        let is_missed = left_ms.abs() > 0.5 && left_ms.abs() >= 0.99 * s_to_ms(delay_s).abs();
        rows.push(row("delay D", ms(s_to_ms(delay_s)), ms(left_ms), half, is_missed));
    }
    if let Some(change) = shown.cost[pair] {
        let (before, after) = (change.uncorrected, change.corrected);
        for (name, before, after) in
            [("J magnitude", before.magnitude, after.magnitude), ("J phase", before.phase, after.phase)]
        {
            rows.push(row(name, decimals(before, 1), decimals(after, 1), None, is_not_reduced(before, after)));
        }
    }
    rows
}

/// Whether a part of J is worth reading and was not made less: a tenth of J is seen by nobody.
pub fn is_not_reduced(before: f64, after: f64) -> bool {
    after > 1.0 && after > before - 0.1
}

/// The card of the response in focus.
pub fn card_ui(ui: &mut Ui, state: &State, palette: &Palette) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    ui.painter().rect_stroke(rect, 8.0, Stroke::new(1.0, palette.line), StrokeKind::Inside);
    let inner = rect.shrink2(vec2(11.0, 9.0));
    let pair = state.display.pair;
    let held = if state.study.settings.constrained[pair] { "held" } else { "free" };
    let title = format!("{}, {held}", state.dataset().pair_name(pair));
    let line =
        |row: usize| egui::Rect::from_min_size(inner.min + vec2(0.0, ROW * row as f32), vec2(inner.width(), ROW));
    painted_text(ui, line(0), 0.0, &title, medium(BODY_SIZE), palette.text);
    let places = [inner.width() * 0.54, inner.width() * 0.78, inner.width()];
    let right = |at: f32| at - inner.width() - 0.01;
    let small = FontId::proportional(SMALL_SIZE);
    let level = state.sureness().level().map(|level| format!("± {:.0} %", 100.0 * level)).unwrap_or_default();
    for (at, head) in places.into_iter().zip(["wants", "left", level.as_str()]) {
        painted_text(ui, line(0), right(at), head, small.clone(), palette.dim_text);
    }
    let Some(shown) = state.shown() else { return };
    for (place, row) in card_rows(state, shown, pair).iter().enumerate() {
        let line = line(place + 1);
        let body = FontId::proportional(BODY_SIZE);
        painted_text(ui, line, 0.0, row.name, body.clone(), palette.dim_text);
        painted_text(ui, line, right(places[0]), &row.wants, body.clone(), palette.text);
        let color = if row.is_missed { palette.warning } else { palette.text };
        painted_text(ui, line, right(places[1]), &row.left, body.clone(), color);
        painted_text(ui, line, right(places[2]), &row.half, body, palette.dim_text);
    }
}

/// The same rows in a tooltip, where the card has no room.
pub fn card_grid_ui(ui: &mut Ui, state: &State, pair: Pair, palette: &Palette) {
    let Some(shown) = state.shown() else { return };
    egui::Grid::new("card").num_columns(4).spacing([16.0, 2.0]).show(ui, |ui| {
        for head in ["", "wants", "left", "±"] {
            ui.label(palette.small(head));
        }
        ui.end_row();
        for row in card_rows(state, shown, pair) {
            ui.label(palette.dim(row.name));
            ui.label(row.wants);
            let left = egui::RichText::new(row.left);
            ui.label(if row.is_missed { left.color(palette.warning) } else { left });
            ui.label(palette.dim(row.half));
            ui.end_row();
        }
    });
}
