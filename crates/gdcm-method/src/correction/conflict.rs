//! Conflicts: constrained entries and bounds that cannot all be met. A *constrained entry* is a
//! response whose net gain (the product of its two channels' gains) or net delay (their sum) must
//! equal its delta, the gain or delay that it needs.

use gdcm_model::dataset::Pair;

use super::channel_bounds::Bounds;
use super::channels::Channel;
use super::quantity::Quantity;

/// Minimal infeasible set of constrained entries and bounds: releasing any one makes the others
/// feasible. A conflict of kind [`ConflictKind::Unclear`] is not minimal: it has all constrained
/// entries.
#[derive(Clone, Debug, PartialEq)]
pub struct Conflict {
    /// Constrained quantity: gains, delays \[s\], or signed delays \[s\].
    pub quantity: Quantity,
    /// Constrained entries; releasing any one resolves the conflict, unless it is unclear.
    pub entries: Vec<Pair>,
    /// Bounds in force, in the unit of `quantity`.
    pub bounds: Bounds,
    pub kind: ConflictKind,
}

/// How constrained entries and bounds conflict. Suggested bounds are rounded to three digits in the
/// sufficient direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConflictKind {
    /// The net value prescribed for two channels exceeds the maximum that the upper bound permits.
    AboveUpper {
        channels: [Channel; 2],
        /// Gain product, or delay sum \[s\], prescribed by the entries.
        asked: f64,
        /// Minimum sufficient upper bound.
        upper: f64,
    },
    /// The net value prescribed for two channels is below the minimum that the lower bound permits;
    /// for delays, it is a phase lead.
    BelowLower {
        channels: [Channel; 2],
        /// Gain product, or (negative) delay sum \[s\], prescribed by the entries.
        asked: f64,
        /// Maximum sufficient lower bound; `None` for delays, whose lower bound is fixed.
        lower: Option<f64>,
    },
    /// The entries prescribe a ratio between two gains, or a difference between two delays, that
    /// exceeds the range between the bounds.
    TooFarApart {
        greater: Channel,
        lesser: Channel,
        /// Ratio, or difference \[s\], prescribed by the entries.
        asked: f64,
        /// Minimum sufficient upper bound if the lower bound is unchanged.
        upper: f64,
        /// Maximum sufficient lower bound if the upper bound is unchanged; `None` for delays.
        lower: Option<f64>,
    },
    /// The entries form a loop with contradictory targets, which no other bounds resolve.
    Loop {
        /// The loop's product \[dB\] or sum \[s\], which would be 0 without a contradiction.
        mismatch: f64,
    },
    /// The entries are infeasible together, but rounding obscures the cause.
    Unclear,
}

impl ConflictKind {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::AboveUpper { .. } => "above-upper-bound",
            Self::BelowLower { .. } => "below-lower-bound",
            Self::TooFarApart { .. } => "too-far-apart",
            Self::Loop { .. } => "loop",
            Self::Unclear => "unclear",
        }
    }
}

impl Conflict {
    /// Lists the channels whose bounds take part in the conflict; empty for a loop or an unclear
    /// conflict.
    pub fn channels(&self) -> Vec<Channel> {
        match self.kind {
            ConflictKind::AboveUpper { channels, .. }
            | ConflictKind::BelowLower { channels, .. } => channels.to_vec(),
            ConflictKind::TooFarApart {
                greater, lesser, ..
            } => vec![greater, lesser],
            ConflictKind::Loop { .. } | ConflictKind::Unclear => Vec::new(),
        }
    }

    /// Returns whether the conflict is a loop, which no other bounds resolve.
    pub(crate) fn is_loop(&self) -> bool {
        matches!(self.kind, ConflictKind::Loop { .. })
    }

    /// Returns whether the conflict is a single entry that requires phase lead although only delays
    /// are permitted.
    pub fn is_lone_lead(&self) -> bool {
        self.quantity == Quantity::Delay
            && self.entries.len() == 1
            && matches!(self.kind, ConflictKind::BelowLower { .. })
    }

    /// Returns whether the conflict is a loop whose deviation is at most `tolerance`, in dB or in
    /// seconds.
    pub(crate) fn agrees_within(&self, tolerance: f64) -> bool {
        match self.kind {
            ConflictKind::Loop { mismatch } => mismatch.abs() <= tolerance,
            _ => false,
        }
    }

    /// Returns whether both conflicts have the same entries, in any order.
    pub(crate) fn has_entries_of(&self, other: &Self) -> bool {
        self.entries.len() == other.entries.len()
            && self.entries.iter().all(|pair| other.entries.contains(pair))
    }
}
