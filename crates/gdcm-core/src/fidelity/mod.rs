//! How well models agree: the cost J, the distance of two models, the representative of a bundle, outliers (M4, M5); modes from
//! model to model, and what a pilot does not notice.

mod absolute_deviations;
mod assignment;
mod cost;
mod counted;
mod discontinuity;
mod distance;
mod mean_cost;
mod mismatch;
mod mode_tracks;
mod muad;
mod vertex;

pub use absolute_deviations::FitError;
pub use cost::{ACCEPTABLE, Cost, CostAverage, INDISTINGUISHABLE, PHASE_WEIGHT};
pub use counted::{CountedFrequencies, coherence_weight};
pub use discontinuity::{CoordinateWeight, Discontinuity, DiscontinuityError, SUGGESTION_RATIO};
pub use distance::{BundleDistance, ComparedModel, MeasuredPairs, Representative, distances_from};
pub use mismatch::Mismatch;
pub use mode_tracks::{ModeTrack, mode_tracks};
pub use muad::{Muad, leaves};
