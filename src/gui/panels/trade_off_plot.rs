//! Trade-off plot below the slider for α: the output gains' deviation from 1, and J, over α. The
//! horizontal axis is the slider's.
//!
//! α is the weight of the output gains' deviation from 1 in the objective of the gains (M8:
//! docs/method.md); J is the cost of the mismatch (M4). A larger α keeps the output gains closer to
//! 1, and the plot shows what that costs in J.

use egui::{Align2, FontId, Pos2, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};

use gdcm_model::number_format::decimals;
use gdcm_study::decisions::setting_table;
use gdcm_study::decisions::setting_value::Value;
use gdcm_study::jobs::trade_off_job::{TradeOff, TradeOffPoint};

use crate::gui::state::window_state::State;
use crate::gui::views::captioned_settings::slider_place;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE, small};

/// Plot height, with caption and tick labels \[pt\].
pub const TRADE_OFF_HEIGHT: f32 = 88.0;
/// Caption height \[pt\].
const CAPTION: f32 = 16.0;
/// Tick label height \[pt\].
const TICKS: f32 = 14.0;
/// Values of α with a tick label.
const TICK_ALPHAS: [f64; 5] = [1e-2, 0.1, 1.0, 10.0, 100.0];
const HELP: &str = "Solid: root mean square of ln k of the outputs, scale at the left. Dashed: mean J of \
    the responses in the objective, scale at the right. Both for the displayed condition";

/// Draws the trade-off into `place`, below the slider rail:
///
/// 1. the caption, and the frame with its ticks along α;
/// 2. the curves ([`TradeOffPlot`]); while they are missing, the reason;
/// 3. the accessible name, with the values at the chosen α.
pub(super) fn trade_off_ui(
    ui: &Ui,
    place: Rect,
    rail: Rect,
    state: &State,
    palette: &Palette,
    help: &mut Option<&'static str>,
) {
    let response = ui.interact(place, ui.scope_id().with("trade-off"), Sense::hover());
    if response.contains_pointer() {
        *help = Some(HELP);
    }
    // Step 1.
    let caption = place.with_max_y(place.top() + CAPTION);
    paint_caption(ui, caption, palette);
    let frame = Rect::from_min_max(
        pos2(rail.left(), caption.bottom()),
        pos2(rail.right(), place.bottom() - TICKS),
    );
    paint_frame(ui, frame, rail, palette);
    // Step 2.
    let Some(trade_off) = state.trade_off() else {
        let words = match state.shown() {
            Some(_) => state.results.absence(),
            None => "no result",
        };
        let font = FontId::proportional(SMALL_SIZE);
        ui.painter().text(
            frame.center(),
            Align2::CENTER_CENTER,
            words,
            font,
            palette.dim_text,
        );
        named(
            response,
            egui::Role::Label,
            format!("Trade-off of α: {words}"),
        );
        return;
    };
    let plot = TradeOffPlot {
        frame,
        rail,
        trade_off,
        palette,
    };
    plot.paint(ui, state);
    // Step 3.
    let alpha = state.study.settings.alpha_gain;
    let name = match point_at(trade_off, alpha) {
        Some(point) => format!(
            "Trade-off of α: deviation of the output gains {} %, mean J {}",
            decimals(100.0 * point.output_deviation, 1),
            decimals(point.mean_cost, 1)
        ),
        None => "Trade-off of α".to_owned(),
    };
    named(response, egui::Role::Label, name);
}

/// Paints which line belongs to which scale.
fn paint_caption(ui: &Ui, caption: Rect, palette: &Palette) {
    let words = "deviation of output k, %";
    painted_text(ui, caption, 0.0, words, small(), palette.dim_text);
    painted_text(
        ui,
        caption,
        AT_RIGHT_END,
        "dashed: J",
        small(),
        palette.dim_text,
    );
}

/// Paints the frame's ground and lower edge, and the ticks along α.
fn paint_frame(ui: &Ui, frame: Rect, rail: Rect, palette: &Palette) {
    ui.painter().rect_filled(frame, 0.0, palette.background);
    ui.painter().hline(
        frame.x_range(),
        frame.bottom(),
        Stroke::new(1.0, palette.line),
    );
    for alpha in TICK_ALPHAS {
        let x = slider_place(rail, alpha);
        ui.painter()
            .vline(x, frame.y_range(), Stroke::new(1.0, palette.grid));
        let at = pos2(x, frame.bottom() + 0.5 * TICKS);
        let font = FontId::proportional(SMALL_SIZE);
        let text = format!("{alpha}");
        ui.painter()
            .text(at, Align2::CENTER_CENTER, text, font, palette.dim_text);
    }
}

/// Trade-off with its area on the screen.
struct TradeOffPlot<'a> {
    frame: Rect,
    rail: Rect,
    trade_off: &'a TradeOff,
    palette: &'a Palette,
}

impl TradeOffPlot<'_> {
    /// Paints J dashed and the deviation solid, each with the maximum of its scale; vertical lines
    /// at the α from when the settings were opened and at the chosen α, with a dot on the deviation
    /// there.
    fn paint(&self, ui: &Ui, state: &State) {
        let palette = self.palette;
        let painter = ui.painter().with_clip_rect(self.frame.expand(3.0));
        let top_deviation = rounded_up(self.greatest(|point| 100.0 * point.output_deviation));
        let top_cost = rounded_up(self.greatest(|point| point.mean_cost));
        let costs = self.path(top_cost, |point| point.mean_cost);
        let dashed = Stroke::new(1.2, palette.dim_text);
        painter.extend(Shape::dashed_line(&costs, dashed, 4.0, 3.0));
        let deviations = self.path(top_deviation, |point| 100.0 * point.output_deviation);
        painter.line(deviations, Stroke::new(1.5, palette.text));
        if let Some(Value::Number(previous)) = state.previous_setting(&setting_table::ALPHA_GAIN) {
            let x = slider_place(self.rail, previous);
            painter.vline(
                x,
                self.frame.y_range(),
                Stroke::new(1.2, palette.quiet_mark),
            );
        }
        let alpha = state.study.settings.alpha_gain;
        let x = slider_place(self.rail, alpha);
        painter.vline(x, self.frame.y_range(), Stroke::new(1.2, palette.accent));
        if let Some(point) = point_at(self.trade_off, alpha) {
            let y = self.height(100.0 * point.output_deviation, top_deviation);
            painter.circle_filled(pos2(x, y), 3.0, palette.text);
        }
        for (top, align, x) in [
            (top_deviation, Align2::LEFT_TOP, self.frame.left() + 3.0),
            (top_cost, Align2::RIGHT_TOP, self.frame.right() - 3.0),
        ] {
            let font = FontId::proportional(SMALL_SIZE);
            let at = pos2(x, self.frame.top() + 1.0);
            let text = format!("{top}");
            painter.text(at, align, text, font, palette.dim_text);
        }
    }

    fn greatest(&self, value: fn(&TradeOffPoint) -> f64) -> f64 {
        let values = self.trade_off.points.iter().map(value);
        values.fold(0.0, f64::max)
    }

    fn path(&self, top: f64, value: fn(&TradeOffPoint) -> f64) -> Vec<Pos2> {
        let points = self.trade_off.points.iter();
        points
            .map(|point| {
                let x = slider_place(self.rail, point.alpha);
                pos2(x, self.height(value(point), top))
            })
            .collect()
    }

    fn height(&self, value: f64, top: f64) -> f32 {
        let room = self.frame.shrink2(vec2(0.0, 3.0));
        room.bottom() - (value / top) as f32 * room.height()
    }
}

/// Returns a value rounded up to 1, 2 or 5 times a power of ten; 1 unless it is positive and
/// finite.
fn rounded_up(value: f64) -> f64 {
    if value <= 0.0 || !value.is_finite() {
        return 1.0;
    }
    let decade = 10f64.powf(value.log10().floor());
    for factor in [1.0, 2.0, 5.0] {
        if value <= factor * decade {
            return factor * decade;
        }
    }
    10.0 * decade
}

/// Returns the point at α, interpolated linearly in `log α`, beyond the outer points with their
/// values; `None` without points.
fn point_at(trade_off: &TradeOff, alpha: f64) -> Option<TradeOffPoint> {
    let points = &trade_off.points;
    let after = points.partition_point(|point| point.alpha < alpha);
    let (Some(before), Some(after)) = (
        points.get(after.saturating_sub(1)),
        points.get(after).or(points.last()),
    ) else {
        return None;
    };
    let width = (after.alpha / before.alpha).ln();
    let part = if width > 0.0 {
        ((alpha / before.alpha).ln() / width).clamp(0.0, 1.0)
    } else {
        0.0
    };
    Some(TradeOffPoint {
        alpha,
        output_deviation: before.output_deviation
            + part * (after.output_deviation - before.output_deviation),
        mean_cost: before.mean_cost + part * (after.mean_cost - before.mean_cost),
    })
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::ConditionId;

    use super::*;

    #[test]
    fn values_between_points_follow_the_logarithm_of_alpha() {
        let point = |alpha: f64, deviation: f64| TradeOffPoint {
            alpha,
            output_deviation: deviation,
            mean_cost: 2.0 * deviation,
        };
        let trade_off = TradeOff {
            condition: ConditionId(1),
            points: vec![point(0.1, 4.0), point(10.0, 2.0)],
        };
        for (alpha, expected) in [(0.1, 4.0), (1.0, 3.0), (10.0, 2.0), (1e-9, 4.0), (1e9, 2.0)] {
            let found = point_at(&trade_off, alpha).unwrap();
            assert!((found.output_deviation - expected).abs() < 1e-12, "{alpha}");
            assert!((found.mean_cost - 2.0 * expected).abs() < 1e-12, "{alpha}");
        }
        assert_eq!(rounded_up(4.1), 5.0);
        assert_eq!(rounded_up(0.019), 0.02);
    }
}
