//! Agreement between models: the cost J, distances, a bundle's representative, outliers (M4, M5);
//! mode tracks across models, and unnoticeable added dynamics.

pub mod absolute_deviations;
pub(crate) mod assignment;
pub mod coherence_weights;
pub mod cost;
pub mod discontinuity;
pub mod distance;
pub mod mismatch;
pub mod mode_tracks;
pub mod muad;
mod pure_delay;
pub mod representative;

pub use coherence_weights::CoherenceWeights;
pub use cost::{ACCEPTABLE, Cost, CostAverage, summand};
pub use discontinuity::{Discontinuity, SUGGESTION_RATIO};
pub use mismatch::Mismatch;
pub use mode_tracks::{ModeTrack, mode_tracks};
pub use muad::{Muad, ranges_outside};
