//! Roles of the models drawn in a figure across several conditions: one model in each condition.
//!
//! A *bundle* contains a condition's physics models, or its identified models; its *representative*
//! is the model closest to the others, or the engineer's choice (M5).

use gdcm_model::dataset::{BundleKind, Condition, ModelId, Pair};
use gdcm_model::response::GainDelay;

use crate::results::analysis::Analysis;

/// A model's role when one model is drawn for each condition in an overlay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum AcrossRole {
    /// The identified model that represents its bundle.
    Identified,
    /// The physics representative under the schedule, at the condition's airspeed.
    Scheduled,
    /// The physics representative under the condition's own correction.
    Corrected,
    /// The physics model that represents its bundle.
    Representative,
    /// The physics model at the condition's own trim.
    Nominal,
}

impl AcrossRole {
    /// Every role, in list order.
    pub const ALL: [Self; 5] = [
        Self::Identified,
        Self::Scheduled,
        Self::Corrected,
        Self::Representative,
        Self::Nominal,
    ];

    /// Roles drawn initially: their difference shows how good the schedule is.
    pub const SHOWN_AT_FIRST: [Self; 2] = [Self::Identified, Self::Scheduled];

    /// Returns the role's name in lists and captions, such as "corrected".
    pub fn name(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::Scheduled => "scheduled",
            Self::Corrected => "corrected",
            Self::Representative => "representative",
            Self::Nominal => "nominal",
        }
    }

    /// Returns whether a correction, and before it the couplings, are applied to the model.
    pub fn is_corrected(self) -> bool {
        matches!(self, Self::Scheduled | Self::Corrected)
    }

    /// Returns the model with this role in a condition; `None` where the role needs a result that
    /// does not exist.
    pub fn model(self, condition: &Condition, analysis: Option<&Analysis>) -> Option<ModelId> {
        let id = condition.id();
        let kind = match self {
            Self::Identified => BundleKind::Identified,
            Self::Representative | Self::Corrected | Self::Scheduled => BundleKind::Physics,
            Self::Nominal => {
                let nominal = &condition.bundle(BundleKind::Physics)[condition.nominal()];
                return Some(ModelId::new(id, BundleKind::Physics, &nominal.name));
            }
        };
        let result = analysis?.condition(id)?;
        Some(ModelId::new(id, kind, result.representative_name(kind)))
    }

    /// Returns the correction applied to the model's response before drawing; `None` where its net
    /// gain is not positive, or there is no result or no schedule.
    pub fn correction(
        self,
        condition: &Condition,
        pair: Pair,
        analysis: Option<&Analysis>,
    ) -> Option<GainDelay> {
        match self {
            Self::Corrected => analysis?.condition(condition.id())?.correction.on(pair),
            Self::Scheduled => {
                let schedule = analysis?.schedule.as_ref().ok()?;
                schedule.at_state(condition.flight_state()).on(pair)
            }
            _ => Some(GainDelay::NONE),
        }
    }
}
