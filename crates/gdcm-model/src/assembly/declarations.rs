//! Units, factors and signs that the engineer declares for channels.
//!
//! [`ChannelDeclarations`] are declared for the models in a scope ([`ScopedDeclarations`]); those
//! that apply to a single model are merged into its [`ModelDeclarations`].

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::file_scope::FileScope;
use super::found_model::FoundModel;
use crate::names::RowRole;

/// A factor between units without a fixed ratio, such as stick travel in inches and in percent.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct UnitRule {
    pub channel: String,
    pub from: String,
    /// Dataset units per unit `from`.
    pub factor: f64,
}

/// Channel sign factors, 1 or -1, by dataset name.
pub type Signs = BTreeMap<String, f64>;

/// Channel units, factors and signs, by dataset name; they override the files.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(default)]
pub struct ChannelDeclarations {
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub units: BTreeMap<String, String>,
    /// Dataset units per file unit; negative for the opposite sign.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub factors: BTreeMap<String, f64>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub signs: Signs,
}

impl ChannelDeclarations {
    /// Adds the declarations in `other`, which override existing ones. A unit replaces an earlier
    /// factor for the same channel, and a factor an earlier unit.
    pub fn override_by(&mut self, other: &Self) {
        for (channel, unit) in &other.units {
            self.factors.remove(channel);
            self.units.insert(channel.clone(), unit.clone());
        }
        for (channel, factor) in &other.factors {
            self.units.remove(channel);
            self.factors.insert(channel.clone(), *factor);
        }
        for (channel, sign) in &other.signs {
            self.signs.insert(channel.clone(), *sign);
        }
    }

    pub(super) fn rename(&mut self, old: &str, new: &str) {
        rename_key(&mut self.units, old, new);
        rename_key(&mut self.factors, old, new);
        rename_key(&mut self.signs, old, new);
    }
}

/// Moves the entry under the key `old` to the key `new`; does nothing without such an entry.
pub(super) fn rename_key<T>(map: &mut BTreeMap<String, T>, old: &str, new: &str) {
    if let Some(value) = map.remove(old) {
        map.insert(new.to_owned(), value);
    }
}

/// Declarations and the models to which they apply.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct ScopedDeclarations {
    #[serde(rename = "of")]
    pub scope: FileScope,
    #[serde(flatten)]
    pub channels: ChannelDeclarations,
}

/// Returns the declarations that apply to a model, in ascending precedence: from wide to narrow
/// scopes, and in declaration order within equal scopes. Later entries override earlier ones.
pub(super) fn applicable_declarations<'d>(
    declarations: &'d [ScopedDeclarations],
    found: &FoundModel,
    role: Option<RowRole>,
) -> Vec<&'d ScopedDeclarations> {
    let mut applicable: Vec<&ScopedDeclarations> = declarations
        .iter()
        .filter(|declared| declared.scope.holds(found, role))
        .collect();
    applicable.sort_by_key(|declared| declared.scope.rank(found));
    applicable
}

/// All units, factors and signs declared for a single model's channels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelDeclarations<'r> {
    /// Factors between units without a fixed ratio.
    pub conversions: &'r [UnitRule],
    /// Merged declarations from all scopes that include the model.
    pub channels: ChannelDeclarations,
}

impl ModelDeclarations<'_> {
    /// Returns the declared sign. Without a sign but with a declared factor, returns 1, because the
    /// factor includes the sign; `None` without either.
    pub fn sign_of(&self, channel: &str) -> Option<f64> {
        match self.channels.signs.get(channel) {
            Some(sign) => Some(*sign),
            None if self.channels.factors.contains_key(channel) => Some(1.0),
            None => None,
        }
    }

    /// Returns the declared factor from the unit `from` to the dataset's unit; `None` if there is
    /// none.
    pub(super) fn conversion(&self, channel: &str, from: &str) -> Option<f64> {
        self.conversions
            .iter()
            .find(|rule| rule.channel == channel && rule.from.trim() == from.trim())
            .map(|rule| rule.factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_replaces_a_factor_and_a_factor_a_unit() {
        let unit = ChannelDeclarations {
            units: [("LON".to_owned(), "in".to_owned())].into(),
            ..ChannelDeclarations::default()
        };
        let factor = ChannelDeclarations {
            factors: [("LON".to_owned(), 8.0)].into(),
            ..ChannelDeclarations::default()
        };
        let mut both = unit.clone();
        both.override_by(&factor);
        assert_eq!(both, factor);
        both.override_by(&unit);
        assert_eq!(both, unit);
    }
}
