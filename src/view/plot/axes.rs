//! What every plot has in common: its frame, the look of its axes, and no interaction of its own.

use std::ops::RangeInclusive;

use egui::{Color32, FontId, Id, RichText, Ui};
use egui_plot::{Axis, AxisHints, GridMark, Plot};

use super::grid_strength::{GRID_SPACING, LABEL_SPACING};
use crate::view::palette::{Palette, SMALL_SIZE};

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
