//! How well models agree: the cost J, the distance of two models, the representative of a bundle, outliers (M4, M5); modes from
//! model to model, and what a pilot does not notice.

mod absolute_deviations;
mod cost;
mod distance;
mod mismatch;
mod mode_tracks;
mod muad;

pub use absolute_deviations::*;
pub use cost::*;
pub use distance::*;
pub use mismatch::*;
pub use mode_tracks::*;
pub use muad::*;
