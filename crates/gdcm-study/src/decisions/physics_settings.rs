//! Decisions about named physics parameters (M18): which of them move the physics models, values
//! set by hand, plausible changes. A *plausible* change is one standard deviation of what the
//! engineer holds possible; the fit keeps the values near nominal by it.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use gdcm_method::physics::OfferedParameter;
use gdcm_method::physics::problem::PhysicsOptions;
use gdcm_model::dataset::Dataset;
use gdcm_model::whole_number::whole;

use super::edit_refusal::EditRefusal;

/// Number of frequencies in the fit's grid in a new study.
const DEFAULT_POINTS: usize = 40;
/// Permitted range for the number of frequencies in the fit's grid.
const POINTS: [usize; 2] = [3, 1000];

/// Which physics parameters move the physics models, before any other correction (M18.5).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PhysicsCorrection {
    /// None: the physics models are unchanged.
    #[default]
    Off,
    /// The parameters that the diagnosis names, fitted again with the others off.
    Named,
    /// All parameters that are switched on.
    All,
    /// The values set by hand; nothing is fitted.
    ByHand,
}

impl PhysicsCorrection {
    /// Returns the name in sentences, such as "the named parameters".
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "no parameters",
            Self::Named => "the named parameters",
            Self::All => "all parameters",
            Self::ByHand => "values set by hand",
        }
    }
}

/// Decisions about the parameters, by name, and settings for their fit (M18.1, M18.2). Entries for
/// parameters that the dataset lacks have no effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PhysicsSettings {
    /// Changes set by hand, in the parameter's unit.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub by_hand: BTreeMap<String, f64>,
    /// The parameters that are off: they take no part in the fit, and their changes set by hand
    /// have no effect.
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    pub off: BTreeSet<String>,
    /// Plausible standard deviations that replace the dataset's, in the parameter's unit.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub plausible_sd: BTreeMap<String, f64>,
    /// Prior standard deviation of each channel's ln gain in a condition; 0: no gains.
    pub gain_sd: f64,
    /// Prior standard deviation of each channel's delay \[s\]; 0: no delays.
    pub delay_sd_s: f64,
    /// Number of logarithmically spaced frequencies in the band, for the fit.
    #[serde(deserialize_with = "whole")]
    pub points: usize,
}

impl Default for PhysicsSettings {
    fn default() -> Self {
        let options = PhysicsOptions::default();
        Self {
            by_hand: BTreeMap::new(),
            off: BTreeSet::new(),
            plausible_sd: BTreeMap::new(),
            gain_sd: options.gain_sd,
            delay_sd_s: options.delay_sd_s,
            points: DEFAULT_POINTS,
        }
    }
}

/// A decision about a single parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterDecision {
    /// Sets the parameter's change by hand, in the parameter's unit; `None` lets the fit find it.
    Value(Option<f64>),
    /// Switches the parameter on or off.
    On(bool),
    /// Sets the parameter's plausible standard deviation, in the parameter's unit; `None` takes the
    /// dataset's.
    PlausibleSd(Option<f64>),
}

impl ParameterDecision {
    /// Returns whether two decisions concern the same property.
    pub(super) fn is_same_kind(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

impl PhysicsSettings {
    /// Lists the dataset's parameters that have runs, with the study's plausible standard
    /// deviations; includes parameters that are off.
    pub fn parameters(&self, dataset: &Dataset) -> Vec<OfferedParameter> {
        let mut parameters = OfferedParameter::list(dataset);
        for parameter in &mut parameters {
            if let Some(plausible_sd) = self.plausible_sd.get(&parameter.name) {
                parameter.plausible_sd = *plausible_sd;
            }
        }
        parameters
    }

    /// Lists the parameters that are switched on.
    pub fn parameters_on(&self, dataset: &Dataset) -> Vec<OfferedParameter> {
        let mut parameters = self.parameters(dataset);
        parameters.retain(|parameter| !self.off.contains(&parameter.name));
        parameters
    }

    /// Applies a decision about the named parameter.
    ///
    /// # Errors
    /// [`EditRefusal::NoParameter`] and [`EditRefusal::OutOfRange`]; the settings are unchanged.
    pub(super) fn decide(
        &mut self,
        dataset: &Dataset,
        name: &str,
        decision: ParameterDecision,
    ) -> Result<(), EditRefusal> {
        let is_known = OfferedParameter::list(dataset)
            .iter()
            .any(|parameter| parameter.name == name);
        if !is_known {
            return Err(EditRefusal::NoParameter {
                name: name.to_owned(),
            });
        }
        match decision {
            ParameterDecision::Value(Some(change)) => {
                check_finite(change)?;
                self.by_hand.insert(name.to_owned(), change);
            }
            ParameterDecision::Value(None) => {
                self.by_hand.remove(name);
            }
            ParameterDecision::On(true) => {
                self.off.remove(name);
            }
            ParameterDecision::On(false) => {
                self.off.insert(name.to_owned());
            }
            ParameterDecision::PlausibleSd(Some(plausible_sd)) => {
                check_positive(plausible_sd)?;
                self.plausible_sd.insert(name.to_owned(), plausible_sd);
            }
            ParameterDecision::PlausibleSd(None) => {
                self.plausible_sd.remove(name);
            }
        }
        Ok(())
    }

    /// Checks every value, as read from a file.
    ///
    /// # Errors
    /// The first value out of range.
    pub fn check(&self) -> Result<(), EditRefusal> {
        for change in self.by_hand.values() {
            check_finite(*change)?;
        }
        for plausible_sd in self.plausible_sd.values() {
            check_positive(*plausible_sd)?;
        }
        for (setting, found) in [
            (
                "prior standard deviation of the channel gains",
                self.gain_sd,
            ),
            (
                "prior standard deviation of the channel delays",
                self.delay_sd_s,
            ),
        ] {
            if !found.is_finite() || found < 0.0 {
                return Err(EditRefusal::OutOfRange {
                    setting,
                    expected: "a finite number not below 0".to_owned(),
                    found,
                });
            }
        }
        let [least, most] = POINTS;
        if !(least..=most).contains(&self.points) {
            return Err(EditRefusal::OutOfRange {
                setting: "frequencies of the fit of parameters",
                expected: format!("a whole number from {least} to {most}"),
                found: self.points as f64,
            });
        }
        Ok(())
    }
}

fn check_finite(change: f64) -> Result<(), EditRefusal> {
    if change.is_finite() {
        Ok(())
    } else {
        Err(EditRefusal::OutOfRange {
            setting: "change of a physics parameter",
            expected: "a finite number".to_owned(),
            found: change,
        })
    }
}

fn check_positive(plausible_sd: f64) -> Result<(), EditRefusal> {
    if plausible_sd.is_finite() && plausible_sd > 0.0 {
        Ok(())
    } else {
        Err(EditRefusal::OutOfRange {
            setting: "plausible change of a physics parameter",
            expected: "a positive finite number".to_owned(),
            found: plausible_sd,
        })
    }
}
