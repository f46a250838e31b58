//! From two models to one gain and one delay or lead for each channel (M6 to M10, M15).
//!
//! [`Delta`] says what each response would want; [`solve`] minimises eq. (7) or the convex eq. (11), in logarithms of gains or in
//! seconds, with a proof of the global minimum; signed delays of M15 are
//! a convex program of the same kind, whose negative ones [`LeadDesign`] makes into filters. It explains what cannot be held and what would help; [`sensitivities`] and
//! [`toggles`] tell what each held entry costs. Tables are `[output, input]`, gains are ratios, delays are seconds.

mod branch_and_bound;
mod channel;
mod channel_correction;
mod channel_leads;
mod channel_model;
mod clash;
mod components;
mod conflict;
mod corrected_model;
mod delta;
mod interior_point;
mod lead_design;
mod objective;
mod pade;
mod problem;
mod quantity;
mod reach;
mod remedy;
mod sensitivity;
mod solution;
mod solve;
mod toggle;

pub use branch_and_bound::{Limit, ProofBudget};
pub use channel::Channel;
pub use channel_correction::{ChannelCorrection, NetDelay, NetGain};
pub use channel_leads::{ChannelLeads, LeadCurve, LeadCurves};
pub use channel_model::ChannelModel;
pub use conflict::{Conflict, ConflictKind};
pub use corrected_model::{CorrectedModel, CorrectedModelError};
pub use delta::{Delta, GainSource, delay_upper_s, delta_gains, gain_bounds, mismatch_table};
pub use lead_design::{LeadDesign, LeadSettings};
pub use pade::{HIGHEST_PADE_ORDER, Pade};
pub use problem::{Bounds, DELAY_AGREEMENT_S, Problem, ProblemError};
pub use quantity::{GainObjective, Quantity};
pub use remedy::Remedy;
pub use sensitivity::{ActiveConstraint, Sensitivity, kkt_residual, sensitivities};
pub use solution::{LocalMinimum, Outcome, Proof, Solution, Unmatched};
pub use solve::solve;
pub use toggle::{Toggle, toggles};

/// Bounds of the channel gains.
pub type GainBounds = Bounds;
