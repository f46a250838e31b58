//! The plots: each takes a scene and what it remembers of the last frame, and gives back what the engineer did.

mod assessment;
mod axes;
mod axis_strip;
mod bode;
mod bode_pane;
mod bode_view;
mod cached_raster;
mod chart;
mod curve;
mod curve_menu;
mod curve_style;
mod dot;
mod drawn_curves;
mod gain_group;
mod gain_panel;
mod legend;
mod log_axis;
mod navigation;
mod overview;
mod picking;
mod poles;
mod quantity;
mod readout;
mod rule;
mod s_plane;
mod sketch;
#[cfg(test)]
mod tests;
mod tiles;

pub use gdcm_files::figure::{Range, decimals};

pub use assessment::*;
pub use bode::*;
pub use bode_view::*;
pub use chart::*;
pub use curve::*;
pub use curve_menu::*;
pub use curve_style::*;
pub use dot::*;
pub use gain_group::*;
pub use gain_panel::*;
pub use legend::*;
pub use log_axis::*;
pub use overview::*;
pub use poles::*;
pub use quantity::*;
pub use readout::*;
pub use rule::*;
pub use s_plane::*;
