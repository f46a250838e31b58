//! What every plot has in common: its frame, the look of its axes, and no interaction of its own.

use std::ops::RangeInclusive;

use egui::{Align2, Color32, FontId, Id, Rangef, Rect, RichText, Sense, Ui, WidgetInfo};
use egui_plot::{Axis, AxisHints, GridInput, GridMark, Plot};
use gdcm_files::figure::{compact, degree_step, step_above};

use crate::view::palette::{BODY_SIZE, Palette, SMALL_SIZE};

/// Size of tick labels \[pt\].
pub const TICK_SIZE: f32 = 11.0;
/// Least distance between the ticks of a vertical axis \[pt\].
pub const VERTICAL_TICK_GAP: f64 = 27.0;
/// Height of an axis with tick labels only \[pt\].
pub const TICKS_HEIGHT: f32 = 15.0;
/// Height of an axis with tick labels and a label \[pt\].
pub const LABELLED_HEIGHT: f32 = 33.0;

/// The font of tick labels.
pub fn tick_font() -> FontId {
    FontId::proportional(TICK_SIZE)
}

/// The font of captions in plots: titles, axis labels, legends, labels of dots.
pub fn caption_font() -> FontId {
    FontId::proportional(SMALL_SIZE)
}

/// A plot that shows what it is told to and answers to nothing: callers own ranges, hovering and clicks.
pub fn quiet_plot<'a>(id: Id, palette: &Palette) -> Plot<'a> {
    Plot::new(id)
        .id(id)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .allow_double_click_reset(false)
        .show_x(false)
        .show_y(false)
        .grid_spacing(GRID_SPACING)
        .grid_color(palette.grid)
        .auto_bounds(false)
}

/// Leaves the ground of the plots in `ui` as it is: theirs has its very colour, and without a graphics processor every pixel that is
/// filled twice counts.
pub(super) fn keep_ground(ui: &mut Ui) {
    ui.visuals_mut().extreme_bg_color = Color32::TRANSPARENT;
}

/// The look of one axis: tick texts from `text`, and `label` beside it (none where empty), `thickness` points in all.
pub fn axis_hints<'a>(
    axis: Axis,
    label: &str,
    thickness: f32,
    palette: &Palette,
    text: impl Fn(GridMark) -> String + 'a,
) -> AxisHints<'a> {
    let hints = AxisHints::new(axis)
        .formatter(move |mark, _: &RangeInclusive<f64>| text(mark))
        .min_thickness(thickness)
        .label_spacing(LABEL_SPACING)
        .tick_label_color(palette.text)
        .tick_label_font(tick_font());
    if label.is_empty() { hints } else { hints.label(RichText::new(label).size(SMALL_SIZE).color(palette.dim_text)) }
}

/// Makes the frame of the plots drawn in `ui` that of the palette, whatever the style around says.
pub fn use_frame_colors(ui: &mut Ui, palette: &Palette) {
    let visuals = ui.visuals_mut();
    visuals.extreme_bg_color = palette.background;
    visuals.widgets.noninteractive.bg_stroke.color = palette.line;
}

/// Distance \[pt\] a labelled mark pretends to have from the next.
const LABELLED: f64 = 100.0;
/// Distance \[pt\] a minor mark pretends to have from the next.
const MINOR: f64 = 25.0;

/// The `grid_spacing` under which the pretended distances mean full strength and half of it.
pub const GRID_SPACING: Rangef = Rangef { min: 1.0, max: 100.0 };
/// The `label_spacing` under which labelled marks are labelled in full strength, and minor ones not at all.
pub const LABEL_SPACING: Rangef = Rangef { min: 50.0, max: 51.0 };

/// A mark with a label at `value`, on an axis of `units_per_point`.
pub fn labelled_mark(value: f64, units_per_point: f64) -> GridMark {
    GridMark { value, step_size: LABELLED * units_per_point }
}

/// A faint mark without a label at `value`, on an axis of `units_per_point`.
pub fn minor_mark(value: f64, units_per_point: f64) -> GridMark {
    GridMark { value, step_size: MINOR * units_per_point }
}

/// Whether a mark of an axis of `units_per_point` has a label.
pub fn is_labelled(mark: GridMark, units_per_point: f64) -> bool {
    mark.step_size / units_per_point > f64::from(LABEL_SPACING.min)
}

/// The steps that ticks may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ladder {
    /// 1, 2, 5 times a power of ten: decibels, knots, gains.
    Decimal,
    /// Parts of a turn: 1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360 degrees and multiples of a turn.
    Degrees,
}

impl Ladder {
    /// The least step of this ladder that is not below `least`.
    pub fn step(self, least: f64) -> f64 {
        match self {
            Self::Degrees => degree_step(least),
            Self::Decimal => step_above(least),
        }
    }

    /// Labelled ticks between `bounds`, at least `gap` points apart on an axis of `units_per_point`.
    pub fn marks(self, bounds: (f64, f64), units_per_point: f64, gap: f64) -> Vec<GridMark> {
        if !(units_per_point > 0.0 && units_per_point.is_finite() && bounds.0 < bounds.1) {
            return Vec::new();
        }
        let step = self.step(gap * units_per_point);
        let slack = 1e-6;
        let indices = (bounds.0 / step - slack).ceil() as i64..=(bounds.1 / step + slack).floor() as i64;
        indices.map(|k| labelled_mark(k as f64 * step, units_per_point)).collect()
    }

    /// [`Self::marks`] as egui_plot asks for them, where the base step is one point.
    pub fn spacer(self, gap: f64) -> impl Fn(GridInput) -> Vec<GridMark> {
        move |input| self.marks(input.bounds, input.base_step_size, gap)
    }
}

/// The text of a tick of a linear axis.
pub fn tick_text(mark: GridMark) -> String {
    compact(mark.value)
}

/// Shows `message` in the middle of `rect`, which it takes from `ui`.
pub(super) fn message_ui(ui: &mut Ui, rect: Rect, message: &str, palette: &Palette) {
    let response = ui.allocate_rect(rect, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, message));
    let font = egui::FontId::proportional(BODY_SIZE);
    let galley = ui.painter().layout(message.to_owned(), font, palette.dim_text, (rect.width() - 32.0).max(40.0));
    let place = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), rect);
    ui.painter().galley(place.min, galley, palette.dim_text);
}

#[cfg(test)]
mod tests {
    use super::super::axes::*;

    fn values(ladder: Ladder, bounds: (f64, f64), points: f64) -> Vec<f64> {
        let marks = ladder.marks(bounds, (bounds.1 - bounds.0) / points, 28.0);
        marks.into_iter().map(|mark| mark.value).collect()
    }

    #[test]
    fn magnitudes_are_labelled_at_five_ten_or_twenty_decibels() {
        assert_eq!(values(Ladder::Decimal, (-26.0, 10.0), 290.0), [-25.0, -20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0]);
        assert_eq!(
            values(Ladder::Decimal, (-80.0, 20.0), 290.0),
            [-80.0, -70.0, -60.0, -50.0, -40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 20.0]
        );
    }

    #[test]
    fn phases_are_labelled_at_parts_of_a_turn() {
        assert_eq!(values(Ladder::Degrees, (-330.0, 60.0), 200.0), [-300.0, -240.0, -180.0, -120.0, -60.0, 0.0, 60.0]);
        assert_eq!(values(Ladder::Degrees, (-200.0, 10.0), 250.0), [-180.0, -150.0, -120.0, -90.0, -60.0, -30.0, 0.0]);
        assert_eq!(values(Ladder::Degrees, (-900.0, 0.0), 200.0), [-900.0, -720.0, -540.0, -360.0, -180.0, 0.0]);
    }

    #[test]
    fn a_step_is_the_next_round_number() {
        for (least, step) in [(0.011, 0.02), (0.2, 0.2), (3.0, 5.0), (6.0, 10.0), (1e-7, 1e-7)] {
            assert!((step_above(least) / step - 1.0).abs() < 1e-9, "{least}: {}", step_above(least));
        }
    }

    #[test]
    fn bounds_that_are_no_range_give_no_ticks() {
        assert!(Ladder::Decimal.marks((1.0, 1.0), 0.0, 28.0).is_empty());
        assert!(Ladder::Degrees.marks((0.0, f64::NAN), f64::NAN, 28.0).is_empty());
    }
}
