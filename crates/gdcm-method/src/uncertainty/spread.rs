//! Changes in a condition's values if its models are substituted (M13.1).
//!
//! ```text
//! s_phys^2 <- mean of (q - q_0)^2 over the other accepted physics models, each instead of the representative
//! s_own^2  <- the same over the other accepted identified models
//! ```
//!
//! `q` is one of the condition's scalars, `q_0` its value with both representatives.

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
    /// Computes the mean squares about the representatives' scalars. `trim` has an entry for each
    /// other accepted physics model, `own` for each other accepted identified model; `None` if the
    /// analysis with that model failed.
    pub fn new(
        representatives: &Figures,
        trim: &[Option<&Figures>],
        own: &[Option<&Figures>],
    ) -> Self {
        let changes = representatives.map(|scalar, base| {
            let Some(base) = base else {
                return Changes::default();
            };
            let by_trim = changes_from(*base, scalar, trim);
            let by_own = changes_from(*base, scalar, own);
            let left_out = trim.len() + own.len() - by_trim.len() - by_own.len();
            Changes {
                trim: VarianceComponent::from_changes(&by_trim),
                own: VarianceComponent::from_changes(&by_own),
                left_out,
            }
        });
        Self { changes }
    }
}

/// Returns a scalar's changes from `base` in the substitutions for which it exists.
fn changes_from(base: f64, scalar: Scalar, swaps: &[Option<&Figures>]) -> Vec<f64> {
    let mut changes = Vec::new();
    for figures in swaps.iter().flatten() {
        if let Some(value) = figures[scalar] {
            changes.push(value - base);
        }
    }
    changes
}
