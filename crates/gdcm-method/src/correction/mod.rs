//! Computes a gain and a delay or lead for each channel from two models (M6 to M10, M15).
//!
//! [`Delta`](delta::Delta) holds the gain and delay needed by each response; [`solve`] minimises
//! eq. (7) or the convex eq. (11), in gain logarithms or in seconds, and proves the global minimum.
//! The signed delays (M15) solve a convex program that resembles eq. (11);
//! [`LeadDesign`](lead_design::LeadDesign) converts negative delays to filters. `solve` also
//! explains infeasible constraints and finds remedies;
//! [`sensitivities`](sensitivity::sensitivities) and [`toggles`](toggles::toggles) compute the cost
//! of constraining each entry. Tables are `[output, input]`, gains are ratios, delays are in
//! seconds.
//!
//! ```text
//! delta, channel_bounds                            G and D from two models; bounds on the channels
//! problem, solve, solution                         eq. (7) and (11): problem, entry point, result
//!     constraints, components, reachable_targets       stage 1
//!     scaled_objective, branch_and_bound, alpha_limit  stage 2 and the proof
//!     infeasible_entries, conflict_search, pull_flow,  explanation of infeasible entries
//!         conflict
//!     remedy                                           single changes that make all feasible
//! sensitivity, multipliers, toggles                cost of each constrained entry
//! lead_design, channel_leads, lead_price           lead filters for negative delays
//! channel_correction                               the correction of a response
//! corrected_model, channel_model, pade,            the corrected model as matrices
//!     series_connection
//! ```

mod alpha_limit;
pub mod branch_and_bound;
pub mod channel_bounds;
pub mod channel_correction;
pub mod channel_leads;
pub mod channel_model;
pub mod channels;
mod components;
pub mod conflict;
mod conflict_search;
mod connected_pieces;
mod constraints;
pub mod corrected_model;
pub mod delta;
mod infeasible_entries;
mod interior_point;
mod interval;
pub mod lead_design;
pub mod lead_price;
mod multipliers;
pub mod pade;
pub mod problem;
mod problem_error;
mod pull_flow;
pub mod quantity;
mod reachable_targets;
pub mod remedy;
mod scaled_objective;
pub mod sensitivity;
mod series_connection;
pub mod solution;
pub mod solve;
mod three_digits;
pub mod toggles;

pub use branch_and_bound::proof_budget::ProofBudget;
pub use channel_bounds::Bounds;
pub use channel_correction::ChannelCorrection;
pub use channels::{Channel, Channels};
pub use lead_price::LeadPrice;
pub use pade::Pade;
pub use problem::Problem;
pub use quantity::{GainObjective, Quantity};
pub use solution::{Outcome, Solution};

/// Bounds on the channel gains; ratios, not in dB.
pub type GainBounds = Bounds;
