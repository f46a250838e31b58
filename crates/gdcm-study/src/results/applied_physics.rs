//! Physics models with a study's parameters moved: the only source of such models for the stages
//! after the fit and for exports (M18.5).
//!
//! ```text
//! A(z) = A + sum_k (z_k L_k + z_k^2 Q_k);   B, C and D likewise
//! z_k        change of parameter k in plausible standard deviations
//! L_k, Q_k   linear and quadratic increments of the matrix, from the runs of parameter k
//! ```
//!
//! A *run* is a physics model linearised again with one parameter moved; a *rerun* has all applied
//! changes at once and checks the prediction from the runs (M18.6). A *plausible* standard deviation
//! says how far the parameter may reasonably be from its value in the physics model.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::physics::{OfferedParameter, PhysicsDiagnosis};
use gdcm_model::dataset::physics_parameter::ParameterChange;
use gdcm_model::dataset::{Condition, ConditionId, Dataset};

use super::comparison::Comparison;
use super::moved_models::MovedModels;
use super::physics_findings::PhysicsFindings;
use crate::decisions::physics_settings::PhysicsCorrection;

/// A study's physics parameter values, and the physics models moved by them.
#[derive(Clone, Debug)]
pub struct AppliedPhysics {
    pub correction: PhysicsCorrection,
    /// Diagnosis with all parameters that are on; `None` for values set by hand.
    pub findings: Option<Arc<PhysicsFindings>>,
    /// Fit with the named parameters only, the others off; `None` if all are applied, if none is
    /// named or set by hand, and if the values set by hand alone are applied.
    pub refit: Option<Arc<PhysicsDiagnosis>>,
    /// The moved parameters, in dataset order; empty if none is moved.
    pub values: Vec<AppliedValue>,
    /// Parameters with a value set by hand that the dataset does not have, by name.
    pub unknown: Vec<String>,
    /// Outcome for each condition's physics models; empty if no parameter is moved.
    pub conditions: BTreeMap<ConditionId, MovedModels>,
    /// The dataset with the moved physics models.
    pub dataset: Arc<Dataset>,
}

impl PartialEq for AppliedPhysics {
    /// Compares values and outcomes: the models follow from them and from the study's dataset.
    fn eq(&self, other: &Self) -> bool {
        self.correction == other.correction
            && self.values == other.values
            && self.unknown == other.unknown
            && self.conditions == other.conditions
            && self.findings == other.findings
            && self.refit == other.refit
    }
}

/// A moved parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct AppliedValue {
    pub parameter: OfferedParameter,
    /// Its change, in plausible standard deviations.
    pub z: f64,
    /// Interval half-width, in plausible standard deviations; `None` for a value set by hand, and
    /// with fewer than four conditions.
    pub half_width_sd: Option<f64>,
    /// Whether the value was set by hand.
    pub is_by_hand: bool,
}

impl AppliedValue {
    /// Returns the change in the parameter's unit.
    pub fn change(&self) -> f64 {
        self.z * self.parameter.plausible_sd
    }

    /// Returns the interval half-width in the parameter's unit.
    pub fn half_width(&self) -> Option<f64> {
        Some(self.half_width_sd? * self.parameter.plausible_sd)
    }

    /// Returns the change in the form of a rerun's changes, in the parameter's unit.
    pub fn parameter_change(&self) -> ParameterChange {
        ParameterChange {
            name: self.parameter.name.clone(),
            delta: self.change(),
            unit: self.parameter.unit.clone(),
        }
    }
}

/// A condition with moved physics models.
#[derive(Clone, Debug, PartialEq)]
pub struct MovedCondition {
    /// The condition as in the dataset.
    pub file: Arc<Condition>,
    /// Comparison of the unmoved dataset models, which selects the representatives.
    pub before: Arc<Comparison>,
    pub applied: Arc<AppliedPhysics>,
}

impl AppliedPhysics {
    /// Returns a condition with its moved physics models; `None` if it keeps the dataset's models.
    pub fn moved(&self, id: ConditionId) -> Option<&Arc<Condition>> {
        match self.conditions.get(&id)? {
            MovedModels::Moved { .. } => self.dataset.condition(id),
            MovedModels::NotMoved(_) => None,
        }
    }

    /// Returns the moved parameters' changes in the form in which a rerun states them.
    pub fn changes(&self) -> Vec<ParameterChange> {
        self.values
            .iter()
            .map(AppliedValue::parameter_change)
            .collect()
    }

    /// Returns the moved parameters' values fitted without a condition, in plausible standard
    /// deviations; the values fitted to all conditions if the condition takes no part in the fit.
    pub fn values_without(&self, condition: ConditionId) -> Vec<AppliedValue> {
        let mut values = self.values.clone();
        let (Some(diagnosis), Some(findings)) = (self.diagnosis(), &self.findings) else {
            return values;
        };
        let left_out = diagnosis
            .conditions
            .iter()
            .find(|diagnosed| diagnosed.id == condition);
        if let Some(left_out) = left_out {
            for value in &mut values {
                let place = findings
                    .parameters
                    .iter()
                    .position(|parameter| parameter.name == value.parameter.name);
                if let Some(z) = place.and_then(|place| left_out.z_without.get(place)) {
                    value.z = *z;
                }
            }
        }
        values
    }

    /// Returns the diagnosis behind the applied values: with the named parameters, or with all;
    /// `None` for values set by hand.
    pub fn diagnosis(&self) -> Option<&PhysicsDiagnosis> {
        match (&self.refit, &self.findings) {
            (Some(refit), _) => Some(refit),
            (None, Some(findings)) => Some(&findings.diagnosis),
            (None, None) => None,
        }
    }
}
