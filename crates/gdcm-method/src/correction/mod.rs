//! From two models to one gain and one delay or lead for each channel (M6 to M10, M15).
//!
//! [`Delta`](delta::Delta) says what each response would want; [`solve`] minimises eq. (7) or the convex eq. (11), in logarithms of gains or in
//! seconds, with a proof of the global minimum; signed delays of M15 are
//! a convex program of the same kind, whose negative ones [`LeadDesign`](leads::LeadDesign) makes into filters. It explains what cannot be held and what would help; [`sensitivities`](sensitivity::sensitivities) and
//! [`toggles`](sensitivity::toggles) tell what each held entry costs. Tables are `[output, input]`, gains are ratios, delays are seconds.

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
