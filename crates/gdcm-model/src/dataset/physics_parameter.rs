//! Named physics model parameters, and models with such parameters moved (M18.1).

use serde::{Deserialize, Serialize};

use super::model::Model;
use crate::number_format::number;

/// A named physics model parameter, such as the roll inertia.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhysicsParameter {
    /// Name, unique in the dataset ("Ixx", "swashplate_phase").
    pub name: String,
    /// Unit for its changes ("%", "deg", "1").
    pub unit: String,
    /// Standard deviation of the changes that the engineer considers plausible, in the unit; `None`
    /// if the dataset does not state it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plausible_sd: Option<f64>,
    /// Meaning of the parameter; empty if unknown.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
}

/// A named parameter's change from its nominal value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterChange {
    pub name: String,
    /// Change, in `unit`; not zero.
    pub delta: f64,
    pub unit: String,
}

/// Parameters moved in a physics model, and the model's purpose.
#[derive(Clone, Debug, PartialEq)]
pub enum MovedParameters {
    /// A run: a single parameter is moved, to learn its effect on the matrices.
    Run(ParameterChange),
    /// A rerun: parameters are moved together, to check the model family at proposed values
    /// (M18.6).
    Rerun(Vec<ParameterChange>),
}

/// A physics model linearised with named parameters moved.
///
/// It belongs to a condition, but to no bundle: it takes no part in representatives, outliers,
/// bounds and error bars (M18.1).
#[derive(Clone, Debug, PartialEq)]
pub struct MovedModel {
    /// The model; its name differs from those of the condition's physics models.
    pub model: Model,
    pub moved: MovedParameters,
}

/// Reason why a physics parameter, or a model's parameter change, is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParameterError {
    #[error("parameter number {position}: the name is empty; give it one")]
    EmptyName {
        /// Position in the list, counted from 1.
        position: usize,
    },
    #[error(
        "parameter \"{name}\": duplicate name (entries {first} and {second}); names must differ"
    )]
    DuplicateName {
        name: String,
        /// First entry, counted from 1.
        first: usize,
        /// Second entry, counted from 1.
        second: usize,
    },
    #[error(
        "parameter \"{name}\", delta: expected a finite number other than 0, found {}",
        number(*delta)
    )]
    Delta { name: String, delta: f64 },
    #[error(
        "parameter \"{name}\", plausible_sd: expected a positive finite number, found {}",
        number(*plausible_sd)
    )]
    PlausibleSd { name: String, plausible_sd: f64 },
    /// A rerun without any change.
    #[error("parameters: expected at least one change, found none; add one")]
    NoChange,
    #[error("both \"parameter\" and \"parameters\" are given; keep one of them")]
    RunAndRerun,
}

impl ParameterError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::EmptyName { .. } => "parameter-without-name",
            Self::DuplicateName { .. } => "duplicate-parameter",
            Self::Delta { .. } => "parameter-delta",
            Self::PlausibleSd { .. } => "parameter-plausible-sd",
            Self::NoChange => "rerun-without-change",
            Self::RunAndRerun => "run-and-rerun",
        }
    }
}

impl MovedParameters {
    /// Returns the changes: one for a run.
    pub fn changes(&self) -> &[ParameterChange] {
        match self {
            Self::Run(change) => std::slice::from_ref(change),
            Self::Rerun(changes) => changes,
        }
    }

    /// Checks that there are changes, that each moves a different named parameter, and that all are
    /// finite and nonzero.
    ///
    /// # Errors
    /// The first [`ParameterError`].
    pub fn check(&self) -> Result<(), ParameterError> {
        let changes = self.changes();
        if changes.is_empty() {
            return Err(ParameterError::NoChange);
        }
        check_names(changes.iter().map(|change| change.name.as_str()))?;
        for ParameterChange { name, delta, .. } in changes {
            if !delta.is_finite() || *delta == 0.0 {
                return Err(ParameterError::Delta {
                    name: name.clone(),
                    delta: *delta,
                });
            }
        }
        Ok(())
    }
}

impl MovedModel {
    /// Returns a run's change; `None` for a rerun.
    pub fn run(&self) -> Option<&ParameterChange> {
        match &self.moved {
            MovedParameters::Run(change) => Some(change),
            MovedParameters::Rerun(_) => None,
        }
    }
}

/// Checks a dataset's parameters: names that differ, positive plausible standard deviations.
///
/// # Errors
/// The first [`ParameterError`].
pub(super) fn check_parameters(parameters: &[PhysicsParameter]) -> Result<(), ParameterError> {
    check_names(parameters.iter().map(|parameter| parameter.name.as_str()))?;
    for parameter in parameters {
        if let Some(plausible_sd) = parameter.plausible_sd
            && !(plausible_sd.is_finite() && plausible_sd > 0.0)
        {
            return Err(ParameterError::PlausibleSd {
                name: parameter.name.clone(),
                plausible_sd,
            });
        }
    }
    Ok(())
}

/// Checks that no name is empty and no two names are equal.
fn check_names<'a>(names: impl Iterator<Item = &'a str>) -> Result<(), ParameterError> {
    let mut earlier: Vec<&str> = Vec::new();
    for name in names {
        let position = earlier.len() + 1;
        if name.is_empty() {
            return Err(ParameterError::EmptyName { position });
        }
        if let Some(first) = earlier.iter().position(|other| *other == name) {
            return Err(ParameterError::DuplicateName {
                name: name.to_owned(),
                first: first + 1,
                second: position,
            });
        }
        earlier.push(name);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(name: &str, delta: f64) -> ParameterChange {
        ParameterChange {
            name: name.to_owned(),
            delta,
            unit: "%".to_owned(),
        }
    }

    #[test]
    fn a_change_of_zero_or_not_finite_is_refused() {
        for delta in [0.0, f64::NAN, f64::INFINITY] {
            let error = MovedParameters::Run(change("Ixx", delta))
                .check()
                .unwrap_err();
            assert_eq!(error.code(), "parameter-delta");
        }
        assert_eq!(MovedParameters::Run(change("Ixx", -5.0)).check(), Ok(()));
    }

    #[test]
    fn a_rerun_moves_different_parameters() {
        let code = |changes| {
            let error = MovedParameters::Rerun(changes).check().unwrap_err();
            error.code()
        };
        assert_eq!(code(vec![]), "rerun-without-change");
        assert_eq!(
            code(vec![change("Ixx", 1.0), change("Ixx", 2.0)]),
            "duplicate-parameter"
        );
        assert_eq!(code(vec![change("", 1.0)]), "parameter-without-name");
    }

    #[test]
    fn a_plausible_deviation_is_positive() {
        let parameter = |plausible_sd| PhysicsParameter {
            name: "Ixx".to_owned(),
            unit: "%".to_owned(),
            plausible_sd,
            description: String::new(),
        };
        for plausible_sd in [0.0, -1.0, f64::NAN] {
            let error = check_parameters(&[parameter(Some(plausible_sd))]).unwrap_err();
            assert_eq!(error.code(), "parameter-plausible-sd");
        }
        assert_eq!(check_parameters(&[parameter(None)]), Ok(()));
    }
}
