//! Which model of each condition is laid over the others'.

use crate::dataset::{BundleKind, Condition, ConditionId, ModelId, Pair};
use crate::response::GainDelay;

use super::analysis::Analysis;

/// Which model of each condition is laid over the others'.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AcrossRole {
    /// The physics model at the condition's own trim.
    #[default]
    Nominal,
    /// The physics model that represents its bundle.
    Representative,
    /// The same under the condition's own correction.
    Corrected,
    /// The identified model that represents its bundle.
    Identified,
}

impl AcrossRole {
    /// Every role, in the order of its list.
    pub const ALL: [Self; 4] = [Self::Nominal, Self::Representative, Self::Corrected, Self::Identified];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Representative => "representative",
            Self::Corrected => "corrected",
            Self::Identified => "identified",
        }
    }

    /// The model that has this role in a condition; none where that takes a result and there is none.
    pub fn model(self, condition: &Condition, analysis: Option<&Analysis>) -> Option<ModelId> {
        let of = |kind: BundleKind, name: &str| ModelId::new(condition.id(), kind, name);
        if self == Self::Nominal {
            return Some(of(BundleKind::Physics, &condition.bundle(BundleKind::Physics)[condition.nominal()].name));
        }
        let result = analysis?.condition(condition.id())?;
        let kind = if self == Self::Identified { BundleKind::Identified } else { BundleKind::Physics };
        Some(of(kind, result.representative_name(kind)))
    }

    /// What is done to its response before it is drawn; none where the response has no correction.
    pub fn correction(self, condition: ConditionId, pair: Pair, analysis: Option<&Analysis>) -> Option<GainDelay> {
        match self {
            Self::Corrected => analysis?.condition(condition)?.correction.on(pair),
            _ => Some(GainDelay::NONE),
        }
    }
}
