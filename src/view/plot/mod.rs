//! The plots: each takes a scene and what it remembers of the last frame, and gives back what the engineer did.

mod axes;
mod axis_strip;
mod bode;
mod bode_pane;
mod bode_view;
mod cached_raster;
mod canvas;
mod chart;
mod curve_menu;
mod curve_style;
mod drawn_curves;
mod figure_view;
mod legend;
mod navigation;
mod overview;
mod quantity;
mod readout;
mod tiles;

pub use gdcm_plot::figure::{Across, FrequencyUnit, Measure, Range, decimals};

pub use bode::*;
pub use bode_pane::*;
pub use bode_view::*;
pub use canvas::*;
pub use chart::*;
pub use curve_menu::*;
pub use curve_style::*;
pub use drawn_curves::*;
pub use figure_view::*;
pub use legend::*;
pub use navigation::PICK_RADIUS;
pub use overview::*;
pub use quantity::*;
pub use readout::*;

#[cfg(test)]
mod tests;
