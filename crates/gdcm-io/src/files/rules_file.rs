//! Rules files, `*.gdcm-rules.json`: rules for reading the models in a folder, which can be reused
//! for other folders.
//!
//! A *pattern* is a regular expression that reads flight condition, role and the like from names; a
//! *conversion* is a factor between units without a fixed ratio; a *declaration* gives channel
//! units, factors or signs for a role, a folder or a file, and overrides the files.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use gdcm_model::assembly::declarations::{ChannelDeclarations, ScopedDeclarations, Signs};
use gdcm_model::assembly::{RowRule, Rules, UnitRule};
use gdcm_model::dataset::PhysicsParameter;
use gdcm_model::dataset::limits::{MOST_CHANNELS, MOST_PAIRS, MOST_PARAMETERS};
use gdcm_model::dataset::location::Location;
use gdcm_model::names::channel_rule::ChannelRule;
use gdcm_model::names::{NamePattern, standard_patterns};
use gdcm_model::whole_number::whole;

use crate::content_fault::{ContentError, ContentFault};
use crate::file_caution::FileCaution;
use crate::file_error::FileError;
use crate::file_reading::Source;
use crate::json_reading::{Format, list};
use crate::json_writing::write_pretty;
use crate::output_set::OutputSet;
use crate::reading_budget::ReadingBudget;

const RULES_EXTENSION: &str = "gdcm-rules.json";

/// Returns the rules file path beside a dataset: "week.gdcm-rules.json" beside "week.json.gz".
pub fn rules_path(dataset: &Path) -> PathBuf {
    let name = match dataset.file_name() {
        Some(name) => name.to_string_lossy().into_owned(),
        None => String::new(),
    };
    let stem = name.trim_end_matches(".gz").trim_end_matches(".json");
    dataset.with_file_name(format!("{stem}.{RULES_EXTENSION}"))
}

/// Reads a rules file, with cautions about unknown keys.
///
/// # Errors
/// [`FileError`] if the file cannot be read, or anything in it is invalid.
pub fn load_rules(path: &Path) -> Result<(Rules, Vec<FileCaution>), FileError> {
    let budget = ReadingBudget::default();
    let source = Source::read(path, &budget)?;
    let (text, cautions) = FORMAT.decode::<RulesText>(source.text(), path, &budget)?;
    let rules = text
        .into_rules()
        .map_err(|error| FileError::content(path, error))?;
    Ok((rules, cautions))
}

/// Adds a file with the rules to `outputs`.
pub fn add_rules(rules: &Rules, path: &Path, outputs: &mut OutputSet) -> Result<(), FileError> {
    let text = RulesText::from_rules(rules);
    outputs.add(path, |file| write_pretty(&text, file))
}

/// Returns the rules as text for a rules file.
///
/// # Errors
/// Errors from the JSON writer; no value is known to cause one.
pub fn rules_json(rules: &Rules) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_pretty(&RulesText::from_rules(rules), &mut bytes)?;
    Ok(bytes)
}

pub(crate) const FORMAT: Format = Format {
    name: "gdcm-rules",
    version: 1,
};

/// Maximum number of patterns, and of conversions, in a rules file.
const MOST_PATTERNS: usize = 200;

/// Maximum number of declarations in a rules file.
const MOST_DECLARATIONS: usize = 1000;

#[derive(Deserialize, Serialize)]
pub(crate) struct RulesText {
    pub(crate) format: String,
    #[serde(deserialize_with = "whole")]
    pub(crate) version: u64,
    pub(crate) name: String,
    #[serde(default)]
    pub(crate) description: String,
    #[serde(deserialize_with = "list::<MOST_CHANNELS, _, _>")]
    pub(crate) inputs: Vec<ChannelRule>,
    #[serde(deserialize_with = "list::<MOST_CHANNELS, _, _>")]
    pub(crate) outputs: Vec<ChannelRule>,
    #[serde(default, deserialize_with = "list::<MOST_PAIRS, _, _>")]
    pub(crate) on_axis: Vec<(String, String)>,
    pub(crate) band_rad_s: [f64; 2],
    /// Named parameters of the physics models.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "list::<MOST_PARAMETERS, _, _>"
    )]
    pub(crate) parameters: Vec<PhysicsParameter>,
    #[serde(default, deserialize_with = "list::<MOST_PATTERNS, _, _>")]
    pub(crate) conversions: Vec<UnitRule>,
    #[serde(default = "standard", deserialize_with = "list::<MOST_PATTERNS, _, _>")]
    pub(crate) patterns: Vec<String>,
    /// Channel signs that apply to all files.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) signs: Signs,
    /// Channel signs that apply to models with a role, "identified" or "physics".
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) role_signs: BTreeMap<String, Signs>,
    /// Channel units, factors and signs that apply to a role, a folder or a file.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "list::<MOST_DECLARATIONS, _, _>"
    )]
    pub(crate) declarations: Vec<ScopedDeclarations>,
    /// Sample time \[s\] for models without a sample time; 0 for continuous time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) sample_time_s: Option<f64>,
    /// Column headings for tables, by file name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) headings: BTreeMap<String, Vec<String>>,
    /// Rules for single models, by file and variable.
    #[serde(default)]
    pub(crate) models: BTreeMap<String, RowRule>,
}

/// Returns the patterns used for a file without the key `patterns`.
fn standard() -> Vec<String> {
    pattern_texts(standard_patterns())
}

impl RulesText {
    fn into_rules(self) -> Result<Rules, ContentError> {
        let mut patterns = Vec::with_capacity(self.patterns.len());
        for (index, text) in self.patterns.iter().enumerate() {
            patterns.push(NamePattern::new(text).map_err(|error| {
                let entry = format!("patterns, entry {}", index + 1);
                word_error(entry, &error.to_string(), text.clone())
            })?);
        }
        self.check_declarations()?;
        self.check_signs()?;
        for role in self.role_signs.keys() {
            if !matches!(role.as_str(), "identified" | "physics") {
                return Err(word_error(
                    "role_signs".to_owned(),
                    "\"identified\" or \"physics\"",
                    role.clone(),
                ));
            }
        }
        let mut rules = Rules {
            name: self.name,
            description: self.description,
            inputs: self.inputs,
            outputs: self.outputs,
            on_axis: self.on_axis,
            band: (self.band_rad_s[0], self.band_rad_s[1]),
            parameters: self.parameters,
            patterns,
            units: self.conversions,
            signs: self.signs,
            role_signs: self.role_signs,
            declarations: Vec::new(),
            sample_time_s: self.sample_time_s,
            headings: self.headings,
            rows: self.models,
        };
        for ScopedDeclarations { scope, channels } in self.declarations {
            rules.declare(scope, &channels);
        }
        Ok(rules)
    }

    /// Rejects signs other than 1 and -1 in the rules for all files, for roles and for single
    /// models.
    fn check_signs(&self) -> Result<(), ContentError> {
        check_signs("signs", &self.signs)?;
        for (role, signs) in &self.role_signs {
            check_signs(&format!("role_signs, {role}"), signs)?;
        }
        for (key, row) in &self.models {
            if let Some(signs) = &row.signs {
                check_signs(&format!("models, {key}, signs"), signs)?;
            }
        }
        Ok(())
    }

    /// Rejects invalid declarations for roles, folders, files and single models.
    fn check_declarations(&self) -> Result<(), ContentError> {
        for scoped in &self.declarations {
            check_declarations(&format!("declarations, {}", scoped.scope), &scoped.channels)?;
        }
        for (key, row) in &self.models {
            check_declarations(&format!("models, {key}"), &row.declarations())?;
        }
        Ok(())
    }

    fn from_rules(rules: &Rules) -> Self {
        Self {
            format: FORMAT.name.to_owned(),
            version: FORMAT.version,
            name: rules.name.clone(),
            description: rules.description.clone(),
            inputs: rules.inputs.clone(),
            outputs: rules.outputs.clone(),
            on_axis: rules.on_axis.clone(),
            band_rad_s: [rules.band.0, rules.band.1],
            parameters: rules.parameters.clone(),
            conversions: rules.units.clone(),
            patterns: pattern_texts(&rules.patterns),
            signs: rules.signs.clone(),
            role_signs: rules.role_signs.clone(),
            declarations: rules.declarations.clone(),
            sample_time_s: rules.sample_time_s,
            headings: rules.headings.clone(),
            models: rules.rows.clone(),
        }
    }
}

/// Rejects signs other than 1 and -1.
fn check_signs(place: &str, signs: &Signs) -> Result<(), ContentError> {
    for (channel, sign) in signs {
        if sign.abs() != 1.0 {
            return Err(word_error(
                format!("{place}, {channel}"),
                "1 or -1",
                sign.to_string(),
            ));
        }
    }
    Ok(())
}

/// Rejects a factor that is zero or not finite, an empty unit, a channel with both a unit and a
/// factor, and an invalid sign.
fn check_declarations(place: &str, declared: &ChannelDeclarations) -> Result<(), ContentError> {
    for (channel, factor) in &declared.factors {
        let entry = format!("{place}, factors, {channel}");
        if !factor.is_finite() || *factor == 0.0 {
            return Err(word_error(
                entry,
                "a number other than 0",
                factor.to_string(),
            ));
        }
        if let Some(unit) = declared.units.get(channel) {
            return Err(word_error(
                entry,
                "a unit or a factor, not both",
                format!("{unit} and {factor}"),
            ));
        }
    }
    for (channel, unit) in &declared.units {
        if unit.trim().is_empty() {
            return Err(word_error(
                format!("{place}, units, {channel}"),
                "a unit",
                unit.clone(),
            ));
        }
    }
    check_signs(&format!("{place}, signs"), &declared.signs)
}

fn pattern_texts(patterns: &[NamePattern]) -> Vec<String> {
    patterns
        .iter()
        .map(|pattern| pattern.as_str().to_owned())
        .collect()
}

/// Returns the error for an entry with an unexpected word or value.
fn word_error(entry: String, expected: &str, found: String) -> ContentError {
    let fault = ContentFault::Word {
        expected: expected.to_owned(),
        found,
    };
    ContentError::new(Location::entry(entry), fault)
}

#[cfg(test)]
mod tests {
    use gdcm_model::assembly::FileScope;
    use gdcm_model::dataset::physics_parameter::ParameterChange;
    use gdcm_model::names::RowRole;

    use super::*;
    use crate::output_set::Existing;

    #[test]
    fn rules_come_back_as_they_were_written() {
        let mut rules = Rules {
            name: "week 12".into(),
            ..Rules::default()
        };
        rules.inputs.push(ChannelRule {
            unit: "%".into(),
            unit_in_files: Some("in".into()),
            ..ChannelRule::named("LON")
        });
        rules.units.push(UnitRule {
            channel: "LON".into(),
            from: "in".into(),
            factor: 8.5,
        });
        let row = RowRule {
            role: Some(RowRole::Nominal),
            airspeed_kt: Some(45.0),
            left_out: Some(false),
            signs: Some([("R".to_owned(), -1.0)].into()),
            sample_time_s: Some(0.02),
            units: Some([("Q".to_owned(), "rad/s".to_owned())].into()),
            factors: Some([("LON".to_owned(), 2.0)].into()),
            parameter: Some(ParameterChange {
                name: "Ixx".into(),
                delta: 5.0,
                unit: "%".into(),
            }),
            ..RowRule::default()
        };
        rules.rows.insert("c03/nom.mat".into(), row);
        rules.parameters.push(PhysicsParameter {
            name: "Ixx".into(),
            unit: "%".into(),
            plausible_sd: Some(5.0),
            description: "roll inertia".into(),
        });
        rules.headings.insert(
            "frf.csv".into(),
            vec!["omega [Hz]".into(), "re".into(), "im".into()],
        );
        rules.signs.insert("NZ".into(), -1.0);
        rules
            .role_signs
            .insert("identified".into(), [("NZ".to_owned(), 1.0)].into());
        rules
            .declarations_mut(FileScope::Identified)
            .units
            .insert("LON".into(), "in".into());
        let of_folder = rules.declarations_mut(FileScope::from("flight_*".to_owned()));
        of_folder.factors.insert("LON".into(), -8.0);
        of_folder.signs.insert("NZ".into(), -1.0);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("week.gdcm-rules.json");
        let mut outputs = OutputSet::new(Existing::Keep, Vec::new());
        add_rules(&rules, &path, &mut outputs).unwrap();
        outputs.persist().unwrap();
        assert_eq!(load_rules(&path).unwrap(), (rules, Vec::new()));
    }

    #[test]
    fn a_wrong_pattern_and_a_wrong_role_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.json");
        let start = r#"{"format": "gdcm-rules", "version": 1, "name": "", "inputs": [], "outputs": [], "band_rad_s": [1, 2], "#;
        for (rest, place) in [
            (r#""patterns": ["("]}"#, "patterns, entry 1"),
            (r#""models": {"a.mat": {"role": "trim"}}}"#, "a.mat"),
            (r#""signs": {"NZ": -2}}"#, "signs, NZ"),
            (
                r#""declarations": [{"of": "flight_*", "factors": {"LON": 0}}]}"#,
                "declarations, flight_*, factors, LON",
            ),
            (
                r#""declarations": [{"of": "all", "factors": {"LON": 2}, "units": {"LON": "in"}}]}"#,
                "factors, LON",
            ),
            (
                r#""declarations": [{"of": "physics", "units": {"LON": " "}}]}"#,
                "declarations, physics, units, LON",
            ),
            (
                r#""models": {"a.mat": {"factors": {"Q": 0}}}}"#,
                "models, a.mat, factors, Q",
            ),
            (r#""role_signs": {"nominal": {"NZ": -1}}}"#, "role_signs"),
        ] {
            std::fs::write(&path, format!("{start}{rest}")).unwrap();
            let error = load_rules(&path).unwrap_err();
            let found = error.place().map(ToString::to_string).unwrap_or_default();
            assert!(found.contains(place), "{error}");
        }
    }
}
