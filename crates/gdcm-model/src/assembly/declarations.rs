//! Units, factors and signs that the engineer declares for channels, and the models to which a
//! declaration applies.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::found_model::{FoundModel, RowRole};
use super::rules::{Signs, UnitRule};

/// Units, factors and signs of channels, by dataset name. They take precedence over the files.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(default)]
pub struct ChannelDeclarations {
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub units: BTreeMap<String, String>,
    /// Dataset units per file unit; negative for the opposite sign.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub factors: BTreeMap<String, f64>,
    /// 1 or -1.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub signs: Signs,
}

impl ChannelDeclarations {
    /// Overrides the declarations of the same channels with those of `other`: a unit replaces a
    /// factor, a factor a unit.
    pub fn override_by(&mut self, other: &Self) {
        for (channel, unit) in &other.units {
            self.factors.remove(channel);
            self.units.insert(channel.clone(), unit.clone());
        }
        for (channel, factor) in &other.factors {
            self.units.remove(channel);
            self.factors.insert(channel.clone(), *factor);
        }
        self.signs.extend(
            other
                .signs
                .iter()
                .map(|(channel, sign)| (channel.clone(), *sign)),
        );
    }

    /// Renames a channel.
    pub(super) fn rename(&mut self, old: &str, new: &str) {
        rename_key(&mut self.units, old, new);
        rename_key(&mut self.factors, old, new);
        rename_key(&mut self.signs, old, new);
    }
}

/// Moves the entry of one key to another.
pub(super) fn rename_key<T>(map: &mut BTreeMap<String, T>, old: &str, new: &str) {
    if let Some(value) = map.remove(old) {
        map.insert(new.to_owned(), value);
    }
}

/// The models to which a declaration applies, in the syntax of rules and command line.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(from = "String", into = "String")]
pub enum FileScope {
    /// `all`: every model.
    All,
    /// `physics`: nominal and perturbed models.
    Physics,
    /// `identified`: identified models and measured responses.
    Identified,
    /// One file, one model of a file (`file#variable`), or a pattern: `flight_*`, `c03/*`.
    Files(String),
}

impl From<String> for FileScope {
    fn from(text: String) -> Self {
        match text.as_str() {
            "all" => Self::All,
            "physics" => Self::Physics,
            "identified" => Self::Identified,
            _ => Self::Files(text),
        }
    }
}

impl From<FileScope> for String {
    fn from(scope: FileScope) -> Self {
        scope.to_string()
    }
}

impl fmt::Display for FileScope {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::All => "all",
            Self::Physics => "physics",
            Self::Identified => "identified",
            Self::Files(pattern) => pattern,
        })
    }
}

impl FileScope {
    /// Returns the scope of a role.
    pub fn of_role(role: RowRole) -> Self {
        match role {
            RowRole::Nominal | RowRole::Perturbed => Self::Physics,
            RowRole::Identified => Self::Identified,
        }
    }

    /// Returns the specificity of the scope: a narrower scope takes precedence over a wider one.
    fn rank(&self, found: &FoundModel) -> u8 {
        match self {
            Self::All => 0,
            Self::Physics | Self::Identified => 1,
            Self::Files(pattern) if *pattern == found.key() || *pattern == found.file() => 3,
            Self::Files(_) => 2,
        }
    }

    /// Returns whether a model, in a role, is within the scope.
    pub fn holds(&self, found: &FoundModel, role: Option<RowRole>) -> bool {
        match self {
            Self::All => true,
            Self::Physics | Self::Identified => {
                role.is_some_and(|role| Self::of_role(role) == *self)
            }
            Self::Files(pattern) => *pattern == found.key() || matches_path(pattern, found.file()),
        }
    }
}

/// Declarations with the models to which they apply.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct ScopedDeclarations {
    /// The models: `all`, `physics`, `identified`, a file, or a pattern of folders.
    pub of: FileScope,
    #[serde(flatten)]
    pub channels: ChannelDeclarations,
}

/// Returns the declarations that apply to a model, wide scopes first; for the same width, later
/// declarations after earlier ones.
pub(super) fn declared_of<'d>(
    declarations: &'d [ScopedDeclarations],
    found: &FoundModel,
    role: Option<RowRole>,
) -> Vec<&'d ScopedDeclarations> {
    let mut holding: Vec<&ScopedDeclarations> = declarations
        .iter()
        .filter(|of| of.of.holds(found, role))
        .collect();
    holding.sort_by_key(|of| of.of.rank(found));
    holding
}

/// All declarations of units and signs for the channels of one model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeclaredChannels<'r> {
    /// Conversions that units alone do not determine.
    pub conversions: &'r [UnitRule],
    pub channels: ChannelDeclarations,
}

impl DeclaredChannels<'_> {
    /// Returns the declared sign of a channel; 1 where a factor is declared, which includes its
    /// sign.
    pub fn sign_of(&self, channel: &str) -> Option<f64> {
        let of_factor = self.channels.factors.get(channel).map(|_| 1.0);
        self.channels.signs.get(channel).copied().or(of_factor)
    }
}

/// Returns whether a pattern matches a file or one of its parent folders. `*` matches any
/// characters within a name, `?` exactly one; a pattern without a slash is tried on every name of
/// the path, any other on the path from its beginning.
fn matches_path(pattern: &str, file: &str) -> bool {
    let pattern = pattern.trim_end_matches('/');
    let mut names = file.split('/');
    if !pattern.contains('/') {
        return names.any(|name| matches_name(pattern, name));
    }
    pattern
        .split('/')
        .all(|part| names.next().is_some_and(|name| matches_name(part, name)))
}

/// Returns whether a pattern matches a whole name. Backtracks to the last star only, so the time
/// grows with the product of the lengths.
fn matches_name(pattern: &str, name: &str) -> bool {
    let pattern: Vec<char> = pattern.chars().collect();
    let name: Vec<char> = name.chars().collect();
    let mut at_pattern = 0;
    let mut at_name = 0;
    let mut last_star: Option<(usize, usize)> = None;
    while at_name < name.len() {
        match pattern.get(at_pattern) {
            Some('*') => {
                last_star = Some((at_pattern, at_name));
                at_pattern += 1;
            }
            Some(letter) if *letter == '?' || *letter == name[at_name] => {
                at_pattern += 1;
                at_name += 1;
            }
            _ => {
                let Some((star, taken)) = last_star else {
                    return false;
                };
                last_star = Some((star, taken + 1));
                at_pattern = star + 1;
                at_name = taken + 1;
            }
        }
    }
    pattern[at_pattern..].iter().all(|letter| *letter == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_matches_names_of_folders_and_files() {
        for (pattern, matches) in [
            ("flight_*", true),
            ("flight_*/", true),
            ("c03", true),
            ("c03/*", true),
            ("c0?/flight_1", true),
            ("*.mat", true),
            ("c03/flight_1/m*.mat", true),
            ("*", true),
            ("flight", false),
            ("flight_1/c03", false),
            ("c03/m.mat", false),
            ("c03/flight_1/model.mat/more", false),
            ("*a*b*c", false),
        ] {
            assert_eq!(
                matches_path(pattern, "c03/flight_1/model.mat"),
                matches,
                "{pattern}"
            );
        }
        let long = "*a".repeat(500);
        assert!(!matches_path(&long, &"a".repeat(499)));
    }

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
