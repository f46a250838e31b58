//! Diagnosis of a study's physics parameters, with the runs and conditions that take no part (M18).
//!
//! A *parameter* is a named quantity of the physics model, such as an inertia. A *run* is a physics
//! model linearised again with one parameter moved. The fit uses the runs to find the parameter
//! values with which the physics models match the identified models of all conditions best.
//!
//! *Stepwise order* begins with the parameter that lowers the misfit of conditions left out most. A
//! parameter is *named* if its interval excludes zero and it helps to predict these conditions
//! (M18.4). `z` is a parameter's change over its *plausible* standard deviation, which says how far
//! the parameter may reasonably be from its value in the physics model.

use gdcm_method::physics::diagnosis::ParameterDiagnosis;
use gdcm_method::physics::{
    ConditionOmission, OfferedParameter, PhysicsDiagnosis, PhysicsError, PhysicsProblem, RefusedRun,
};
use gdcm_model::dataset::ConditionId;

/// Diagnosis of the parameters that are switched on.
#[derive(Clone, Debug)]
pub struct PhysicsFindings {
    /// The parameters that are switched on, in dataset order.
    pub parameters: Vec<OfferedParameter>,
    /// The parameters that are switched off.
    pub off: Vec<OfferedParameter>,
    pub problem: PhysicsProblem,
    pub diagnosis: PhysicsDiagnosis,
    pub left_out: LeftOutData,
}

/// Runs and conditions that take no part in the fit, with the reasons.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LeftOutData {
    pub runs: Vec<RefusedConditionRun>,
    pub conditions: Vec<OmittedCondition>,
}

/// A run that is not used in the fit, with its condition and the reason.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusedConditionRun {
    pub condition: ConditionId,
    pub run: RefusedRun,
}

/// A condition that takes no part in the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct OmittedCondition {
    pub condition: ConditionId,
    pub why: NotFitted,
}

/// Why a condition takes no part in the fit.
#[derive(Clone, Debug, PartialEq)]
pub enum NotFitted {
    /// It is held out.
    HeldOut,
    /// Its representatives cannot be compared; the reason's stable code.
    NotCompared { code: &'static str },
    /// Its runs do not suffice.
    Runs(ConditionOmission),
}

impl NotFitted {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::HeldOut => "held-out",
            Self::NotCompared { code } => code,
            Self::Runs(omission) => omission.code(),
        }
    }
}

/// Why requested physics parameters are unavailable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PhysicsFailure {
    /// The dataset has no run with a moved parameter.
    #[error(
        "no physics parameters: the dataset has no physics models linearised with one parameter \
        changed; add them"
    )]
    NoRuns,
    /// Every parameter is switched off.
    #[error("no physics parameters: every parameter is switched off; switch one on")]
    AllOff,
    /// No condition takes part in the fit.
    #[error(
        "no physics parameters: no condition has comparable models and, for every parameter that \
        is switched on, a physics model linearised with it changed"
    )]
    NoConditions(Box<LeftOutData>),
    #[error(transparent)]
    Fit(PhysicsError),
}

impl PhysicsFailure {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoRuns => "physics-without-runs",
            Self::AllOff => "physics-all-off",
            Self::NoConditions(_) => "physics-without-conditions",
            Self::Fit(error) => error.code(),
        }
    }

    /// Returns the unused runs and conditions if no condition takes part in the fit; `None` for
    /// other reasons.
    pub fn left_out(&self) -> Option<&LeftOutData> {
        match self {
            Self::NoConditions(left_out) => Some(left_out),
            _ => None,
        }
    }
}

impl PartialEq for PhysicsFindings {
    /// Compares the results, not the fit data (`problem`).
    fn eq(&self, other: &Self) -> bool {
        self.parameters == other.parameters
            && self.off == other.off
            && self.diagnosis == other.diagnosis
            && self.left_out == other.left_out
    }
}

/// A parameter with its diagnosis.
#[derive(Clone, Copy, Debug)]
pub struct DiagnosedParameter<'a> {
    pub parameter: &'a OfferedParameter,
    pub diagnosis: &'a ParameterDiagnosis,
}

impl DiagnosedParameter<'_> {
    /// Returns the change in the parameter's unit.
    pub fn change(&self) -> f64 {
        self.diagnosis.z * self.parameter.plausible_sd
    }

    /// Returns the interval half-width in the parameter's unit.
    pub fn half_width(&self) -> Option<f64> {
        Some(self.diagnosis.half_width? * self.parameter.plausible_sd)
    }

    /// Returns the interval ends in the parameter's unit.
    pub fn interval(&self) -> Option<[f64; 2]> {
        let half_width = self.half_width()?;
        Some([self.change() - half_width, self.change() + half_width])
    }
}

/// How much a condition pulls a parameter's fitted value: the change if it is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConditionPull {
    pub condition: ConditionId,
    /// Index among the parameters that are switched on.
    pub parameter: usize,
    /// Value without the condition minus the value with it, in plausible standard deviations.
    pub change: f64,
}

impl PhysicsFindings {
    /// Returns the parameters that are switched on, with their diagnosis.
    pub fn diagnosed(&self) -> impl Iterator<Item = DiagnosedParameter<'_>> {
        self.parameters
            .iter()
            .zip(&self.diagnosis.parameters)
            .map(|(parameter, diagnosis)| DiagnosedParameter {
                parameter,
                diagnosis,
            })
    }

    /// Lists the parameters that are switched on, by index: the fitted ones in stepwise order, then
    /// the others.
    pub fn ranked(&self) -> Vec<usize> {
        let mut ranked: Vec<usize> = (0..self.parameters.len()).collect();
        ranked.sort_by_key(|parameter| {
            let step = self.diagnosis.parameters[*parameter].step;
            (step.is_none(), step)
        });
        ranked
    }

    /// Returns the index of the parameter with this name among those that are switched on; without
    /// a name, or if no such parameter is on, the index of the first in the ranking. `None` if no
    /// parameter is on.
    pub fn selected(&self, name: Option<&str>) -> Option<usize> {
        let found = self
            .parameters
            .iter()
            .position(|parameter| Some(parameter.name.as_str()) == name);
        found.or_else(|| self.ranked().first().copied())
    }

    /// Returns the parameters that the diagnosis names (M18.4).
    pub fn named(&self) -> Vec<DiagnosedParameter<'_>> {
        self.diagnosed()
            .filter(|diagnosed| diagnosed.diagnosis.is_named())
            .collect()
    }

    /// Lists how much each value changes without each condition, the largest change first.
    pub fn pulls(&self) -> Vec<ConditionPull> {
        let mut pulls = Vec::new();
        for condition in &self.diagnosis.conditions {
            for (parameter, z_without) in condition.z_without.iter().enumerate() {
                pulls.push(ConditionPull {
                    condition: condition.id,
                    parameter,
                    change: z_without - self.diagnosis.fit.z[parameter],
                });
            }
        }
        pulls.sort_by(|a, b| b.change.abs().total_cmp(&a.change.abs()));
        pulls
    }
}
