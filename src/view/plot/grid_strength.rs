//! How a grid mark says to egui_plot how strongly to draw its line, and whether to label it.
//!
//! egui_plot derives both from the distance between marks and fades what is close. Here the tick steps are chosen so that
//! every label is readable, so a mark is either labelled (full strength) or minor (faint), and nothing fades.

use egui::Rangef;
use egui_plot::GridMark;

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
