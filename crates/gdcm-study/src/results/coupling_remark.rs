//! Remarks on couplings as typed facts (diagnosis, benefit and cost, M16.4), each with a stable
//! code. The sentences are in the crate `gdcm-words`. Couplings are a mixing of the inputs and a
//! feedback from outputs to inputs (M16); J is the cost of a response's mismatch (M4); an entry's
//! *share* is the fraction of the stick's movement that it adds to an input.

use nalgebra::Complex;

use gdcm_method::couplings::coupling_shares::{FeedbackShare, MixingShare};
use gdcm_method::couplings::problem::CouplingError;
use gdcm_method::couplings::{LoopMargin, PoleShiftError, Unknown};
use gdcm_model::dataset::{ConditionId, Pair};

use super::correction_costs::{AxisCost, CorrectionCost};
use super::couplings_assessment::{NoPoles, UnstablePole};
use super::remark_kind::RemarkKind;
use crate::decisions::settings::CouplingCorrection;

/// A remark on couplings; `coupling_remark_search` finds them.
#[derive(Clone, Debug, PartialEq)]
pub enum CouplingRemark {
    /// The requested couplings are unavailable; all results are computed without couplings.
    Unavailable(CouplingError),
    /// A significant mixing entry.
    Mixing(MixingShare),
    /// A significant feedback entry.
    Feedback {
        share: FeedbackShare,
        meaning: FeedbackMeaning,
    },
    /// J without and with the couplings.
    Costs(OffAxisBenefit),
    /// The couplings reduce the off-axis J by less than a tenth.
    NotWorthwhile {
        couplings: CouplingCorrection,
        source: CostSource,
    },
    /// Off-axis J without and with worthwhile couplings, which are not in use.
    Offered {
        couplings: CouplingCorrection,
        without: f64,
        with: f64,
    },
    /// The largest relative change \[dB\] in an on-axis response above the band.
    ChangeAboveBand {
        condition: ConditionId,
        pair: Pair,
        change_db: f64,
        omega_rad_s: f64,
    },
    /// The largest pole shift within the band \[rad/s\].
    PolesMoved {
        condition: ConditionId,
        before: Complex<f64>,
        after: Complex<f64>,
        distance_rad_s: f64,
    },
    /// The error bars are computed with fixed couplings, which are not fitted again for each model
    /// swap.
    BarsKeepCouplings,
    /// Newly unstable poles in the representatives, or in the other kept physics models.
    NewlyUnstable {
        is_representative: bool,
        poles: Vec<UnstablePole>,
    },
    /// The minimum singular value of the loop over all conditions is small.
    CloseToRinging {
        condition: ConditionId,
        margin: LoopMargin,
    },
    /// Number of conditions in which the feedback compensates for a missing lead.
    FeedbackAsLead { conditions: usize },
    /// The couplings are fitted to too few conditions for error bars.
    FewConditions { conditions: usize },
    /// Outputs (by index) that cannot be fed back, because their response to some input is missing
    /// in every condition.
    NotFedBack { outputs: Vec<usize> },
    /// Entries that the data do not determine.
    EntriesUndetermined(Vec<Unknown>),
    /// A condition's poles are unavailable.
    PolesUnknown {
        condition: ConditionId,
        why: NoPoles,
    },
    /// The poles of a kept physics model with the couplings are unavailable.
    ModelRefused {
        condition: ConditionId,
        model: String,
        why: PoleShiftError,
    },
    /// Only `fits` of the `conditions` can be left out of the fit.
    PartlyLeftOut { fits: usize, conditions: usize },
}

/// Physical meaning of a feedback entry, derived from the channel units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedbackMeaning {
    DirectionalStiffness,
    Damping,
    Coupling,
}

/// Source of the J that measures the benefit from couplings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CostSource {
    /// Conditions left out of the fit.
    LeftOut,
    Schedule,
}

/// Off-axis J without and with couplings, and the on-axis J if it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffAxisBenefit {
    pub couplings: CouplingCorrection,
    pub source: CostSource,
    pub without: f64,
    pub with: f64,
    /// On-axis J without and with couplings, if both are known.
    pub on_axis: Option<OnAxisCosts>,
}

/// On-axis J without and with couplings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnAxisCosts {
    pub without: f64,
    pub with: f64,
}

impl OffAxisBenefit {
    /// Returns the benefit according to J from a source; `None` where off-axis J is unknown.
    pub(super) fn new(
        couplings: CouplingCorrection,
        source: CostSource,
        cost: CorrectionCost,
    ) -> Option<Self> {
        let AxisCost { on_axis, others } = cost.with;
        let on_axis = match (cost.without.on_axis, on_axis) {
            (Some(without), Some(with)) => Some(OnAxisCosts { without, with }),
            _ => None,
        };
        Some(Self {
            couplings,
            source,
            without: cost.without.others?,
            with: others?,
            on_axis,
        })
    }
}

impl CouplingRemark {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Unavailable(_) => "no-couplings",
            Self::Mixing(_) | Self::Feedback { .. } => "coupling-entry",
            Self::Costs(_) => "coupling-costs",
            Self::NotWorthwhile { .. } => "couplings-not-worthwhile",
            Self::Offered { .. } => "couplings-offered",
            Self::ChangeAboveBand { .. } => "change-above-band",
            Self::PolesMoved { .. } => "poles-moved",
            Self::BarsKeepCouplings => "bars-under-couplings",
            Self::NewlyUnstable { .. } => "newly-unstable",
            Self::CloseToRinging { .. } => "close-to-ringing",
            Self::FeedbackAsLead { .. } => "feedback-as-lead",
            Self::FewConditions { .. } => "few-conditions",
            Self::NotFedBack { .. } => "not-fed-back",
            Self::EntriesUndetermined(_) => "entries-undetermined",
            Self::PolesUnknown { .. } => "poles-unknown",
            Self::ModelRefused { .. } => "model-refused",
            Self::PartlyLeftOut { .. } => "partly-left-out",
        }
    }

    /// Returns whether the remark reports a success, a caution or a failure.
    pub fn kind(&self) -> RemarkKind {
        match self {
            Self::Mixing(_)
            | Self::Feedback { .. }
            | Self::Costs(_)
            | Self::Offered { .. }
            | Self::ChangeAboveBand { .. }
            | Self::PolesMoved { .. }
            | Self::BarsKeepCouplings => RemarkKind::Good,
            Self::Unavailable(_) => RemarkKind::Trouble,
            Self::NewlyUnstable { poles, .. } => {
                if poles.iter().any(|pole| pole.is_in_band) {
                    RemarkKind::Trouble
                } else {
                    RemarkKind::Caution
                }
            }
            Self::NotWorthwhile { .. }
            | Self::CloseToRinging { .. }
            | Self::FeedbackAsLead { .. }
            | Self::FewConditions { .. }
            | Self::NotFedBack { .. }
            | Self::EntriesUndetermined(_)
            | Self::PolesUnknown { .. }
            | Self::ModelRefused { .. }
            | Self::PartlyLeftOut { .. } => RemarkKind::Caution,
        }
    }
}
