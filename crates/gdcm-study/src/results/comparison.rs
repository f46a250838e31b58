//! Differences between a condition's models: distances within each bundle, the two representatives,
//! and the differences between these. None depends on constraints, alpha or bounds.

use gdcm_method::correction::delta::Delta;
use gdcm_method::fidelity::discontinuity::DiscontinuityError;
use gdcm_method::fidelity::distance::BundleDistance;
use gdcm_method::fidelity::representative::Representative;
use gdcm_method::fidelity::{Cost, Discontinuity, Mismatch};
use gdcm_model::dataset::{BundleKind, PairTable};

use super::caution::{Caution, Undefined};

/// Difference between two models in every response that both have.
pub type Mismatches = PairTable<Option<Mismatch>>;

/// Distances within each bundle, and discontinuity ratios for the physics bundle; independent of
/// rejections.
#[derive(Clone, Debug, PartialEq)]
pub struct BundleMetrics {
    pub physics: BundleDistance,
    pub identified: BundleDistance,
    /// The physics models' discontinuity ratios, or why there are none.
    pub discontinuity: Result<Discontinuity, DiscontinuityError>,
}

impl BundleMetrics {
    /// Returns the distances within a bundle.
    pub fn bundle(&self, kind: BundleKind) -> &BundleDistance {
        kind.pick(&self.physics, &self.identified)
    }
}

/// Mismatch between a physics model and the identified representative, and the resulting J.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelMismatch {
    /// Difference between the models in every response that both have.
    pub mismatch: Mismatches,
    /// The uncorrected physics model's J.
    pub cost: PairTable<Option<Cost>>,
}

/// The two representatives, with the differences between them, and of the nominal physics model
/// from flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    pub physics: Representative,
    pub identified: Representative,
    /// The physics representative against the identified one.
    pub representative: ModelMismatch,
    /// The nominal physics model against the identified representative.
    pub nominal: ModelMismatch,
    /// The representatives' G and D.
    pub delta: Delta,
    /// Why a response has no G and D; `None` where they are defined.
    pub undefined: PairTable<Option<Undefined>>,
    /// Cautions about the models, whatever the constraints.
    pub cautions: Vec<Caution>,
}
