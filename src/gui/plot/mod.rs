//! Plots: each takes a scene and its state of the last frame, and returns the engineer's actions.

mod axes;
mod axis_strip;
pub mod bode;
pub mod bode_pane;
pub mod bode_view;
mod cached_raster;
pub mod canvas;
pub mod chart;
pub mod curve_menu;
pub mod curve_style;
pub mod drawn_curves;
pub mod figure_view;
pub mod legend;
pub mod navigation;
pub mod overview;
pub mod quantity;
pub mod readout;
mod tiles;

pub use gdcm_plot::figure::Range;
pub use gdcm_plot::figure::axis::FrequencyUnit;
pub use gdcm_plot::figure::gains::{Across, Measure};

#[cfg(test)]
mod tests;

pub use bode::{BodeScene, bode_ui};
pub use bode_view::BodeView;
pub use curve_style::Role;
pub use drawn_curves::{BodeCurve, CurveId, Pane};
pub use figure_view::{FigureEvent, FigureScene, FigureView, FigureWords, figure_ui};
