//! A study's couplings, and their effect on a condition (M16).

use std::sync::Arc;

use gdcm_method::couplings::fit::CouplingFit;
use gdcm_method::couplings::{CouplingMatrices, CouplingProblem};
use gdcm_model::dataset::ConditionId;

use super::comparison::Comparison;

/// A study's couplings: the fit problem and its solution.
#[derive(Clone, Debug)]
pub struct FittedCouplings {
    /// Fit problem, built from the representatives in the conditions that are analysed and not held
    /// out.
    pub problem: CouplingProblem,
    pub fit: CouplingFit,
}

impl PartialEq for FittedCouplings {
    /// Compares the fits only: equal fits have the same effect on every model, whatever data they
    /// are based on.
    fn eq(&self, other: &Self) -> bool {
        self.fit == other.fit
    }
}

impl FittedCouplings {
    /// Returns the mixing and feedback matrices.
    pub fn matrices(&self) -> &CouplingMatrices {
        &self.fit.matrices
    }

    /// Returns whether the couplings were fitted to a condition.
    pub fn is_fitted_to(&self, condition: ConditionId) -> bool {
        self.problem
            .conditions
            .iter()
            .any(|fitted| fitted.id == condition)
    }
}

/// A condition's couplings, and its comparison without them.
#[derive(Clone, Debug, PartialEq)]
pub struct CoupledCondition {
    /// Comparison of the models without couplings, which selects the representatives.
    pub before: Arc<Comparison>,
    pub fitted: Arc<FittedCouplings>,
}
