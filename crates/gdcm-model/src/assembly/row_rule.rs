//! Values that the engineer sets for a single model.
//!
//! A *run* is a physics model with a single named parameter moved (M18.1, docs/physics.md); it
//! belongs to no *bundle*, as a condition's physics models and its identified models are called.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::declarations::{ChannelDeclarations, Signs, rename_key};
use super::row::Row;
use crate::dataset::physics_parameter::ParameterChange;
use crate::names::RowRole;
use crate::whole_number::whole_or_none;

/// Values set by the engineer for a single model; `None` keeps the proposal.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(default)]
pub struct RowRule {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<bool>,
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "whole_or_none"
    )]
    pub condition: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub role: Option<RowRole>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// True airspeed \[kt\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub airspeed_kt: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub altitude: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub altitude_ft: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weight: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_kg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<String>,
    /// Trim offsets by coordinate; they replace all proposed offsets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub perturbation: Option<BTreeMap<String, f64>>,
    /// Named parameter moved in a physics run (M18.1).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parameter: Option<ParameterChange>,
    /// Input names in the file's order; for a file without names, or with wrong names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inputs: Option<Vec<String>>,
    /// Output names in the file's order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outputs: Option<Vec<String>>,
    /// Sign factors, 1 or -1, by dataset name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub signs: Option<Signs>,
    /// Units, by dataset name; they override the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub units: Option<BTreeMap<String, String>>,
    /// Dataset units per file unit, by dataset name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factors: Option<BTreeMap<String, f64>>,
    /// Sample time \[s\] for a file that gives none; 0 for a continuous-time model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_time_s: Option<f64>,
}

impl RowRule {
    /// Returns whether the rule gives a value for a field on which a file and its name disagree;
    /// `field` is [`NameContradiction::field`](super::row::NameContradiction::field).
    pub(super) fn settles(&self, field: &str) -> bool {
        match field {
            "condition" => self.condition.is_some(),
            "airspeed_kt" => self.airspeed_kt.is_some(),
            "altitude_ft" => self.altitude_ft.is_some(),
            "mass_kg" => self.mass_kg.is_some(),
            // "perturbation, " and a coordinate.
            _ => self.perturbation.is_some(),
        }
    }

    /// Overrides the proposals in `row` with the values given here. A moved parameter without a
    /// role makes the model perturbed.
    pub fn apply(&self, row: &mut Row) {
        if let Some(left_out) = self.left_out {
            row.left_out = left_out;
        }
        if let Some(name) = &self.name {
            row.name.clone_from(name);
        }
        if let Some(perturbation) = &self.perturbation {
            row.perturbation.clone_from(perturbation);
        }
        override_with(&mut row.condition, &self.condition);
        override_with(&mut row.role, &self.role);
        override_with(&mut row.airspeed_kt, &self.airspeed_kt);
        override_with(&mut row.altitude, &self.altitude);
        override_with(&mut row.altitude_ft, &self.altitude_ft);
        override_with(&mut row.weight, &self.weight);
        override_with(&mut row.mass_kg, &self.mass_kg);
        override_with(&mut row.method, &self.method);
        override_with(&mut row.parameter, &self.parameter);
        // A run does not belong to the bundle, whatever was proposed.
        if self.parameter.is_some() && self.role.is_none() {
            row.role = Some(RowRole::Perturbed);
        }
    }

    /// Returns the units, factors and signs set here.
    pub fn declarations(&self) -> ChannelDeclarations {
        ChannelDeclarations {
            units: self.units.clone().unwrap_or_default(),
            factors: self.factors.clone().unwrap_or_default(),
            signs: self.signs.clone().unwrap_or_default(),
        }
    }

    /// Adds declarations; they override earlier declarations for the same channels.
    pub fn declare(&mut self, declared: &ChannelDeclarations) {
        let mut merged = self.declarations();
        merged.override_by(declared);
        self.units = none_if_empty(merged.units);
        self.factors = none_if_empty(merged.factors);
        self.signs = none_if_empty(merged.signs);
    }

    /// Renames a channel in all declarations.
    pub(super) fn rename_channel(&mut self, old: &str, new: &str) {
        if let Some(signs) = &mut self.signs {
            rename_key(signs, old, new);
        }
        if let Some(units) = &mut self.units {
            rename_key(units, old, new);
        }
        if let Some(factors) = &mut self.factors {
            rename_key(factors, old, new);
        }
    }
}

/// Replaces a value if the rule gives one.
fn override_with<T: Clone>(value: &mut Option<T>, rule: &Option<T>) {
    if rule.is_some() {
        value.clone_from(rule);
    }
}

fn none_if_empty<T>(map: BTreeMap<String, T>) -> Option<BTreeMap<String, T>> {
    if map.is_empty() { None } else { Some(map) }
}
