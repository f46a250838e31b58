//! What a condition's models differ in: distances within each bundle, the two representatives and
//! their differences, which do not depend on constraints, alpha or bounds.

use gdcm_method::correction::delta::Delta;
use gdcm_method::fidelity::distance::{BundleDistance, DiscontinuityError, Representative};
use gdcm_method::fidelity::{Cost, Discontinuity, Mismatch};
use gdcm_model::dataset::{BundleKind, PairTable};

use super::caution::{Caution, Undefined};

/// How two models differ in every response that both have.
pub type Mismatches = PairTable<Option<Mismatch>>;

/// Distances within each bundle and the physics bundle's discontinuity ratios, independent from
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

/// Mismatch between a physics model and the identified representative, with the resulting J.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelMismatch {
    /// How the models differ in every response that both have.
    pub mismatch: Mismatches,
    /// The uncorrected physics model's J.
    pub cost: PairTable<Option<Cost>>,
}

/// The two representatives and their differences.
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
    /// Why a response has no G and no D, where it has none.
    pub undefined: PairTable<Option<Undefined>>,
    /// Cautions about the models, whatever the constraints.
    pub cautions: Vec<Caution>,
}
