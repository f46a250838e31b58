//! From two models to one gain and one delay or lead for each channel (M6 to M10, M15).
//!
//! [`Delta`] says what each response would want; [`solve`] minimises eq. (7) or the convex eq. (11), in logarithms of gains or in
//! seconds, with a proof of the global minimum; signed delays of M15 are
//! a convex program of the same kind, whose negative ones [`LeadDesign`] makes into filters. It explains what cannot be held and what would help; [`sensitivities`] and
//! [`toggles`] tell what each held entry costs. Tables are `[output, input]`, gains are ratios, delays are seconds.

mod branch_and_bound;
mod channels;
mod components;
mod conflict;
mod corrected_model;
mod delta;
mod leads;
mod problem;
mod sensitivity;
mod solve;

pub use branch_and_bound::*;
pub use channels::*;
use components::*;
pub use conflict::*;
pub use corrected_model::*;
pub use delta::*;
pub use leads::*;
pub use problem::*;
pub use sensitivity::*;
pub use solve::*;

/// Bounds of the channel gains.
pub type GainBounds = Bounds;
