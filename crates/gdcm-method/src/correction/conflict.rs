//! Conflicts: constrained entries and bounds that exclude one another.

use gdcm_model::dataset::Pair;

use super::channels::Channel;
use super::problem::Bounds;
use super::quantity::Quantity;

/// A minimal infeasible set of constrained entries and bounds: if any single member is released,
/// the others are feasible.
#[derive(Clone, Debug, PartialEq)]
pub struct Conflict {
    /// Constrained quantity: gains, or delays or signed delays in seconds.
    pub quantity: Quantity,
    /// The constrained entries: releasing any single entry resolves the conflict.
    pub entries: Vec<Pair>,
    /// Bounds of the problem.
    pub bounds: Bounds,
    pub kind: ConflictKind,
}

/// Kind of conflict between constrained entries and bounds. Suggested bounds are rounded to three
/// digits so that they still suffice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConflictKind {
    /// The entries prescribe a net value for two channels above the maximum that the upper bound
    /// allows.
    AboveUpper {
        channels: (Channel, Channel),
        /// Product of gains or sum of delays prescribed by the entries.
        asked: f64,
        /// Minimum sufficient upper bound.
        upper: f64,
    },
    /// The entries prescribe a net value for two channels below the minimum that the lower bound
    /// allows: for delays, phase lead.
    BelowLower {
        channels: (Channel, Channel),
        /// Product of gains or (negative) sum of delays prescribed by the entries.
        asked: f64,
        /// Maximum sufficient lower bound; `None` for delays.
        lower: Option<f64>,
    },
    /// The entries prescribe a ratio between two gains, or a difference between two delays, above
    /// the range that the bounds allow.
    TooFarApart {
        /// The channel with the greater value.
        greater: Channel,
        /// The channel with the smaller value.
        lesser: Channel,
        /// Ratio or difference prescribed by the entries.
        asked: f64,
        /// Minimum sufficient upper bound if the lower bound stays.
        upper: f64,
        /// Maximum sufficient lower bound if the upper bound stays; `None` for delays.
        lower: Option<f64>,
    },
    /// The entries form a loop with contradictory targets: no bound helps.
    Loop {
        /// The loop's deviation: its product from 1 in dB, or its sum from 0 in seconds.
        mismatch: f64,
    },
    /// The entries are infeasible together; rounding hides the cause.
    Unclear,
}

impl Conflict {
    /// Lists the channels whose bounds take part in the conflict; none for a loop.
    pub fn channels(&self) -> Vec<Channel> {
        match self.kind {
            ConflictKind::AboveUpper { channels, .. }
            | ConflictKind::BelowLower { channels, .. } => {
                vec![channels.0, channels.1]
            }
            ConflictKind::TooFarApart {
                greater, lesser, ..
            } => vec![greater, lesser],
            ConflictKind::Loop { .. } | ConflictKind::Unclear => Vec::new(),
        }
    }

    /// Whether the conflict is a loop, which no bound resolves.
    pub(crate) fn is_loop(&self) -> bool {
        matches!(self.kind, ConflictKind::Loop { .. })
    }

    /// Whether the conflict is a single entry that asks for phase lead.
    pub fn is_lone_lead(&self) -> bool {
        self.quantity == Quantity::Delay
            && self.entries.len() == 1
            && matches!(self.kind, ConflictKind::BelowLower { .. })
    }

    /// Whether the conflict is a loop that disagrees by no more than `tolerance`, in dB or in
    /// seconds.
    pub(crate) fn agrees_within(&self, tolerance: f64) -> bool {
        match self.kind {
            ConflictKind::Loop { mismatch } => mismatch.abs() <= tolerance,
            _ => false,
        }
    }

    /// Whether two conflicts have the same entries, in any order.
    pub(crate) fn has_entries_of(&self, other: &Self) -> bool {
        self.entries.len() == other.entries.len()
            && self.entries.iter().all(|pair| other.entries.contains(pair))
    }
}
