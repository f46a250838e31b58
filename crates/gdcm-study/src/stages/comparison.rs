//! Compares a condition's representatives (M5, M6), whatever the constraints, alpha and bounds.
//!
//! ```text
//! 1  cautions about the kept models of both bundles                            (`model_cautions`)
//! 2  representatives: the medoid of the kept models, or the pinned model       (M5)
//! 3  mismatch of the physics representative, and of the nominal model, against the identified one
//! 4  G and D of the representatives; where they are undefined, why             (M6)
//! 5  cautions about the representatives: gains outside the computable range, frequencies without
//!    coherence, numerically zero responses                                     (`comparison_cautions`)
//! 6  where requested, G as the mean over all pairs of kept models               (`mean_gains`)
//! ```
//!
//! Step 6 is requested by the caller, `ConditionStages`.
//!
//! *Kept* models are those that the engineer has not rejected. G is the gain and D the delay that
//! would match a response; alpha is the weight in the later optimisation, which uses G and D.

use gdcm_method::correction::delta::Delta;
use gdcm_model::dataset::{BundleKind, Dynamics};

use super::compared_model::why_undefined;
use super::comparison_cautions::ComparedPair;
use super::comparison_input::ComparisonInput;
use crate::results::analysis::ConditionFailure;
use crate::results::caution::Undefined;
use crate::results::comparison::Comparison;

impl Comparison {
    /// Selects the representatives among the kept models and compares them, with the identified
    /// representative's coherence weights if a minimum coherence is set (M4a).
    ///
    /// # Errors
    /// [`ConditionFailure`] where the condition has no reference, or a bundle has no model to
    /// represent it.
    pub(crate) fn compute(input: &ComparisonInput<'_>) -> Result<Self, ConditionFailure> {
        let condition = input.condition;
        if !condition.has_reference() {
            return Err(ConditionFailure::NoReference);
        }
        // Step 1.
        let mut cautions = input.model_cautions();
        // Step 2.
        let physics = input.representative(BundleKind::Physics)?;
        let identified = input.representative(BundleKind::Identified)?;
        // Step 3.
        let compared_physics = input.compared(BundleKind::Physics, physics.model);
        let compared_identified = input.compared(BundleKind::Identified, identified.model);
        let representative = input.mismatch(&compared_physics, &compared_identified);
        let nominal = if physics.model == condition.nominal() {
            representative.clone()
        } else {
            let nominal = input.compared(BundleKind::Physics, condition.nominal());
            input.mismatch(&nominal, &compared_identified)
        };
        // Step 4.
        let delta = Delta::new(&representative.mismatch, input.grid.grid.omega());
        let identified_model = input.model(BundleKind::Identified, identified.model);
        let undefined = delta
            .gain
            .map(|pair, gain| match (gain, &identified_model.dynamics) {
                (Some(_), _) => None,
                (None, Dynamics::Measured(response)) if !response.is_measured(pair) => {
                    Some(Undefined::NotMeasured)
                }
                (None, _) => Some(why_undefined(&compared_physics, &compared_identified, pair)),
            });
        // Step 5.
        let compared = ComparedPair {
            physics: &compared_physics,
            physics_index: physics.model,
            identified: &compared_identified,
            identified_index: identified.model,
        };
        cautions.extend(input.out_of_range(&compared, &delta));
        cautions.extend(input.coherence_caution(&compared_identified, identified_model));
        cautions.extend(input.numerically_zero_cautions(&compared));
        Ok(Self {
            physics,
            identified,
            representative,
            nominal,
            delta,
            undefined,
            cautions,
        })
    }
}
