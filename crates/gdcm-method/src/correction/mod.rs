//! From two models to one gain and one delay or lead for each channel (M6 to M10, M15).
//!
//! [`Delta`](delta::Delta) gives the gain and delay that each response needs; [`solve`] minimises
//! eq. (7) or the convex eq. (11), in logarithms of gains or in seconds, with a proof of the global
//! minimum. The signed delays of M15 are a convex program of the same kind;
//! [`LeadDesign`](leads::LeadDesign) turns the negative ones into filters. `solve` also explains
//! infeasible constraints and their remedies; [`sensitivities`](sensitivity::sensitivities) and
//! [`toggles`](sensitivity::toggles) give the cost of each constrained entry. Tables are `[output,
//! input]`, gains are ratios, delays are seconds.

pub mod branch_and_bound;
pub mod channels;
mod components;
pub mod conflict;
pub mod corrected_model;
pub mod delta;
pub mod leads;
pub mod problem;
pub mod sensitivity;
pub mod solve;

pub use branch_and_bound::search::ProofBudget;
pub use channels::{Channel, ChannelCorrection, Channels};
pub use corrected_model::Pade;
pub use leads::LeadPrice;
pub use problem::{Bounds, GainObjective, Problem, Quantity};
pub use solve::{Outcome, Solution};

/// Bounds of the channel gains.
pub type GainBounds = Bounds;
