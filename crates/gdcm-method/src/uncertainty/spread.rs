//! Changes in a condition's values if its models are substituted (M13.1).
//!
//! ```text
//! s_phys^2 <- mean of (q - q_0)^2 over the other accepted physics models
//! s_own^2  <- the same over the other accepted identified models
//! ```
//!
//! `q_0` is a scalar's value with the physics and the identified representative, `q` its value with
//! another model instead of a representative: a *substitution*.

use super::scalar::{Figures, Scalar, ScalarTable};
use super::variance_component::VarianceComponent;

/// Mean square changes in a scalar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Changes {
    /// `s_phys^2`: changes due to other physics models.
    pub(super) trim: Option<VarianceComponent>,
    /// `s_own^2`: changes due to other identified models.
    pub(super) own: Option<VarianceComponent>,
    /// Count of substitutions for which the scalar does not exist.
    pub(super) left_out: usize,
}

/// Changes in a condition's scalars if other models in its bundles replace the representatives
/// (M13.1).
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionSpread {
    pub(super) changes: ScalarTable<Changes>,
}

impl ConditionSpread {
    /// Computes the mean squares about the values with both representatives. `with_other_physics`
    /// has the values with each other accepted physics model, `with_other_identified` with each
    /// other accepted identified model; `None` if the analysis with that model failed.
    pub fn new(
        representatives: &Figures,
        with_other_physics: &[Option<&Figures>],
        with_other_identified: &[Option<&Figures>],
    ) -> Self {
        let substitutions = with_other_physics.len() + with_other_identified.len();
        let changes = representatives.map(|scalar, q_0| {
            let Some(q_0) = q_0 else {
                return Changes::default();
            };
            let physics_changes = changes_from(*q_0, scalar, with_other_physics);
            let identified_changes = changes_from(*q_0, scalar, with_other_identified);
            Changes {
                trim: VarianceComponent::from_changes(&physics_changes),
                own: VarianceComponent::from_changes(&identified_changes),
                left_out: substitutions - physics_changes.len() - identified_changes.len(),
            }
        });
        Self { changes }
    }
}

/// Returns `q - q_0` for a scalar in the substitutions for which it exists.
fn changes_from(q_0: f64, scalar: Scalar, substitutions: &[Option<&Figures>]) -> Vec<f64> {
    let mut changes = Vec::new();
    for values in substitutions.iter().flatten() {
        if let Some(q) = values[scalar] {
            changes.push(q - q_0);
        }
    }
    changes
}
