//! Remarks on a condition's result as typed facts: each with a stable code, its kind and the
//! decision that it suggests. The sentences are in the crate `gdcm-words`.
//!
//! In names, *held* responses are the constrained ones, *free* the others; a *turned* channel has a
//! reversed sign. G is the gain and D the delay that would match a response (M6); J is the mismatch
//! cost (M4).

use gdcm_method::correction::Channel;
use gdcm_method::correction::conflict::Conflict;
use gdcm_method::correction::remedy::Remedy;
use gdcm_method::correction::solution::{Solution, Unmatched};
use gdcm_method::schedule::{CostChange, ScheduleCaution};
use gdcm_model::dataset::{Band, Pair};

use super::caution::Caution;
use super::convention_doubt::ConventionDoubt;
use super::coupling_remark::CouplingRemark;
use super::lead_offer::LeadOffer;
use super::remark_kind::RemarkKind;
use crate::decisions::settings::PhaseCorrection;
use crate::decisions::signs::SignRole;

/// A remark on a result.
#[derive(Clone, Debug, PartialEq)]
pub enum Remark {
    /// A suspected difference in sign or unit between the two bundles.
    ConventionDoubt(ConventionDoubt),
    /// A channel's sign is reversed relative to the file.
    ChannelReversed { channel: Channel, role: SignRole },
    /// All `held` constrained gains are matched: exactly if there is no tolerance \[dB\].
    GainsMatched {
        held: usize,
        tolerance_db: Option<f64>,
    },
    /// Constrained gains are not matched.
    GainsMissed(MissedTargets),
    /// Single changes, each of which would match every constrained gain.
    GainsRemedy(Remedy),
    /// All `held` constrained delays are matched: exactly, or within the loop tolerance.
    DelaysMatched { held: usize, is_exact: bool },
    /// Some constrained responses (`held` in total) have a negative D, which no delay can match.
    NeedsLead {
        needed: Vec<NeededLead>,
        held: usize,
    },
    /// A constrained response has a delay other than its D, which is not negative.
    DelayMissed {
        miss: Unmatched,
        band_top_rad_s: f64,
    },
    /// All constrained responses need about this lead \[s\].
    CommonLead { lead_s: f64 },
    /// Leads are requested, and every delay or lead is negligible.
    LeadsNegligible,
    /// All `held` constrained responses get the delay or lead that they need.
    LeadsMatched { held: usize },
    /// Constrained responses do not get the delay or lead that they need.
    LeadsMissed(MissedTargets),
    /// Largest change in G \[dB\] that the lead filters cause among the constrained responses, and
    /// the response in which it occurs.
    GainRaised { rise_db: f64, pair: Pair },
    /// Constrained responses for which D by eq. (9) and D over the band differ so much that the
    /// missing phase is not due to a delay. `by_leads`: whether leads are requested.
    NotADelay {
        responses: Vec<DelaysApart>,
        by_leads: bool,
    },
    /// All constrained responses need lead, which is not requested.
    LeadsOffered(LeadOffer),
    /// Constrained responses that form a loop and contradict each other by no more than the
    /// tolerance; they are constrained to the nearest consistent values.
    LoopAgrees(Conflict),
    /// In this many responses, J, G and D are weighted by coherence, which excludes no frequency.
    CoherenceUsed { responses: usize },
    /// Constrained responses that the correction moves away from flight.
    HeldFarther(Vec<FartherResponse>),
    /// Number of unconstrained responses that a correction with leads moves away from flight, among
    /// those `compared`.
    FreeFarther { farther: usize, compared: usize },
    /// The engineer has excluded the condition from the schedule.
    LeftOutOfSchedule,
    /// A caution about the condition.
    Caution(Caution),
    /// A caution about the schedule that concerns the condition.
    Schedule(ScheduleCaution),
    /// A remark on the couplings.
    Coupling(CouplingRemark),
}

/// Constrained responses that miss their targets, or a conflict that causes this.
#[derive(Clone, Debug, PartialEq)]
pub enum MissedTargets {
    /// All responses that miss their targets; phase errors are reported at the band's upper end
    /// \[rad/s\].
    Responses {
        misses: Vec<Unmatched>,
        band_top_rad_s: f64,
    },
    Conflict(Conflict),
}

impl MissedTargets {
    /// Returns the constrained responses that miss their targets in a solution, then each conflict
    /// among the constraints that causes this.
    pub(super) fn find(solution: &Solution, band: Band) -> Vec<Self> {
        let mut missed = vec![Self::Responses {
            misses: solution.unmatched.clone(),
            band_top_rad_s: band.max(),
        }];
        missed.extend(solution.conflicts.iter().cloned().map(Self::Conflict));
        missed
    }
}

/// A response with the lead \[s\] that it needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeededLead {
    pub pair: Pair,
    pub lead_s: f64,
}

/// A response with its D \[s\] by eq. (9) and over the band (M15.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelaysApart {
    pub pair: Pair,
    pub median_s: f64,
    pub band_s: f64,
}

/// A response that the correction moves away from flight, with its J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FartherResponse {
    pub pair: Pair,
    pub cost: CostChange,
}

/// A channel whose sign the user may reverse in one role's models or, without a role, restore.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SuggestedSign {
    pub channel: Channel,
    pub role: Option<SignRole>,
}

impl Remark {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::ConventionDoubt(_) => "convention-doubt",
            Self::ChannelReversed { .. } => "channel-turned",
            Self::GainsMatched { .. } => "gains-matched",
            Self::GainsMissed(_) | Self::GainsRemedy(_) => "gains-missed",
            Self::DelaysMatched { .. } => "delays-matched",
            Self::NeedsLead { .. } => "needs-lead",
            Self::DelayMissed { .. } => "delay-missed",
            Self::CommonLead { .. } => "common-lead",
            Self::LeadsNegligible => "leads-negligible",
            Self::LeadsMatched { .. } => "leads-matched",
            Self::LeadsMissed(_) => "leads-missed",
            Self::GainRaised { .. } => "gain-raised",
            Self::NotADelay { .. } => "not-a-delay",
            Self::LeadsOffered(_) => "leads-offered",
            Self::LoopAgrees(_) => "loop-agrees",
            Self::CoherenceUsed { .. } => "coherence-used",
            Self::HeldFarther(_) => "held-farther",
            Self::FreeFarther { .. } => "free-farther",
            Self::LeftOutOfSchedule => "left-out-of-schedule",
            Self::Caution(caution) => caution.code(),
            Self::Schedule(_) => "schedule-caution",
            Self::Coupling(remark) => remark.code(),
        }
    }

    /// Returns whether the remark reports a success, a caution or a failure.
    pub fn kind(&self) -> RemarkKind {
        match self {
            Self::ChannelReversed { .. }
            | Self::GainsMatched { .. }
            | Self::DelaysMatched { .. }
            | Self::LeadsNegligible
            | Self::LeadsMatched { .. }
            | Self::LoopAgrees(_)
            | Self::CoherenceUsed { .. } => RemarkKind::Good,
            Self::GainsMissed(_) | Self::GainsRemedy(_) => RemarkKind::Trouble,
            Self::ConventionDoubt(_)
            | Self::NeedsLead { .. }
            | Self::DelayMissed { .. }
            | Self::CommonLead { .. }
            | Self::LeadsMissed(_)
            | Self::GainRaised { .. }
            | Self::NotADelay { .. }
            | Self::LeadsOffered(_)
            | Self::HeldFarther(_)
            | Self::FreeFarther { .. }
            | Self::LeftOutOfSchedule
            | Self::Caution(_)
            | Self::Schedule(_) => RemarkKind::Caution,
            Self::Coupling(remark) => remark.kind(),
        }
    }

    /// Returns the response that the remark suggests excluding from the objective, if any.
    pub fn suggested_exclusion(&self) -> Option<Pair> {
        match self {
            Self::Caution(caution) => caution.offers_to_ignore(),
            _ => None,
        }
    }

    /// Returns the phase correction that the remark suggests, if any.
    pub fn suggested_phase(&self) -> Option<PhaseCorrection> {
        match self {
            Self::LeadsOffered(_) => Some(PhaseCorrection::Lead),
            _ => None,
        }
    }

    /// Returns the sign change that the remark suggests, if any.
    pub fn suggested_sign(&self) -> Option<SuggestedSign> {
        match self {
            Self::ConventionDoubt(doubt) => {
                doubt.channel_to_reverse().map(|channel| SuggestedSign {
                    channel,
                    role: Some(SignRole::Identified),
                })
            }
            Self::ChannelReversed { channel, .. } => Some(SuggestedSign {
                channel: *channel,
                role: None,
            }),
            _ => None,
        }
    }

    /// Returns whether the remark typically recurs in many conditions, so that a table lists it
    /// better than sentences.
    pub fn is_recurring(&self) -> bool {
        matches!(
            self,
            Self::NeedsLead { .. }
                | Self::CommonLead { .. }
                | Self::HeldFarther(_)
                | Self::GainRaised { .. }
                | Self::LeadsOffered(_)
        )
    }
}
