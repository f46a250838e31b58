//! Plots: each is drawn from a scene and its state from the last frame, and returns the engineer's
//! actions.
//!
//! Every panel with axes is drawn by `panel_painter`, which also paints the frames for plots
//! without axes in the overview. A scene (`bode_scene`, `figure_scene`, `chart`, `overview_scene`)
//! describes what a plot shows; the parts below serve several plots:
//!
//! ```text
//! panel_painter               frame, axes, grid and gestures; each scene adds its layers
//! panel_axis, ticks           numbers and grid lines
//! viewed_range, zoom_limit    visible ranges, and how far they may be zoomed out
//! zoom_gesture, drawn_box     wheel and pinching; boxes drawn by dragging
//! nearest_curve, nearest_dot  curve or dot under the pointer
//! pointed_curve_text          status text for the curve under the pointer
//! derivation_menu             menu of the values under the pointer, to show their derivations
//! thinning                    visible points, no finer than the pixels; drawn_curves keeps them
//! curve_layer                 order and styles of curves; cached_raster holds the image of many
//! layers, canvas              areas, lines across a panel; shapes from printed figures
//! chips, readout_strip        chips above a plot, values at the pointer
//! ```

mod axis_strip;
mod band_handles;
pub mod bode;
mod bode_axis;
pub mod bode_event;
mod bode_headings;
mod bode_keys;
mod bode_layout;
mod bode_pane;
mod bode_pointer;
pub mod bode_scene;
pub mod bode_view;
mod cached_raster;
mod canvas;
pub mod chart;
mod chart_layers;
pub mod chart_view;
pub mod chip_row;
pub mod chips;
mod coherence_strip;
pub mod curve_command;
mod curve_layer;
mod curve_menu;
pub mod curve_style;
pub mod derivation_menu;
mod drawn_box;
pub mod drawn_curves;
mod drawn_pane;
mod end_labels;
pub mod figure_legend;
mod figure_marks;
mod figure_panel;
pub mod figure_scene;
pub mod figure_view;
mod figure_zoom;
mod invalid_region;
mod layers;
mod limits_form;
pub mod nearest_curve;
mod nearest_dot;
pub mod overview;
mod overview_axes;
mod overview_cell;
mod overview_ranges;
pub mod overview_response;
pub mod overview_scene;
mod pane_scene;
mod panel_axis;
mod panel_painter;
mod panel_text;
pub mod pointed_curve_text;
pub mod quantity;
pub mod readout_strip;
mod reference_lines;
mod sketch;
pub mod steady_range;
mod thinning;
mod ticks;
mod tiles;
pub mod value_unit;
mod viewed_range;
mod zoom_gesture;
mod zoom_limit;

#[cfg(test)]
mod tests;

pub use bode::bode_ui;
pub use bode_scene::BodeScene;
pub use bode_view::BodeView;
pub use curve_style::Role;
pub use drawn_curves::{BodeCurve, CurveId, Pane};
pub use figure_scene::{FigureEvent, FigureScene, FigureWords};
pub use figure_view::{FigureView, figure_ui};
