//! Rules files, `*.gdcm-rules.json`: the engineer's rules for the files of a folder, reusable for
//! later folders.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use gdcm_model::assembly::declarations::{ScopedDeclarations, Signs};
use gdcm_model::assembly::{RowRule, Rules, UnitRule};
use gdcm_model::dataset::limits::{MOST_CHANNELS, MOST_PAIRS};
use gdcm_model::dataset::location::Location;
use gdcm_model::names::{ChannelRule, NamePattern, standard_patterns};
use gdcm_model::whole_number::whole;

use crate::file_error::{ContentError, ContentFault, FileError};
use crate::json_text::{Format, list, write_pretty};
use crate::output_set::OutputSet;
use crate::reading_budget::ReadingBudget;
use crate::source::Source;

/// Extension of a rules file.
const RULES_EXTENSION: &str = "gdcm-rules.json";

/// Returns the path of the rules beside a dataset: "week.gdcm-rules.json" beside "week.json.gz".
pub fn rules_path(dataset: &Path) -> PathBuf {
    let name = dataset
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    let stem = name.trim_end_matches(".gz").trim_end_matches(".json");
    dataset.with_file_name(format!("{stem}.{RULES_EXTENSION}"))
}

/// Reads a rules file; whole, or not at all. Unknown keys are cautions.
pub fn load_rules(path: &Path) -> Result<(Rules, Vec<String>), FileError> {
    let budget = ReadingBudget::default();
    let source = Source::read(path, &budget)?;
    let (text, cautions) = FORMAT.decode::<RulesText>(source.text(), path, &budget)?;
    let rules = rules_of(text).map_err(|flaw| FileError::content(path, flaw))?;
    Ok((rules, cautions))
}

/// Adds a rules file to `outputs`.
pub fn add_rules(rules: &Rules, path: &Path, outputs: &mut OutputSet) -> Result<(), FileError> {
    let text = text_of(rules);
    outputs.add(path, |file| write_pretty(&text, file))
}

fn rules_of(text: RulesText) -> Result<Rules, ContentError> {
    let pattern = |(index, text): (usize, &String)| {
        NamePattern::new(text).map_err(|error| {
            let fault = ContentFault::Word {
                expected: error.to_string(),
                found: text.clone(),
            };
            ContentError::new(
                Location::entry(format!("patterns, entry {}", index + 1)),
                fault,
            )
        })
    };
    let patterns = text
        .patterns
        .iter()
        .enumerate()
        .map(pattern)
        .collect::<Result<_, _>>()?;
    check_declarations(&text)?;
    let of_roles = text
        .role_signs
        .iter()
        .map(|(role, signs)| (format!("role_signs, {role}"), signs));
    let of_models = text
        .models
        .iter()
        .filter_map(|(key, row)| Some((format!("models, {key}, signs"), row.signs.as_ref()?)));
    for (place, signs) in std::iter::once(("signs".to_owned(), &text.signs))
        .chain(of_roles)
        .chain(of_models)
    {
        if let Some((channel, sign)) = signs.iter().find(|(_, sign)| sign.abs() != 1.0) {
            let fault = ContentFault::Word {
                expected: "1 or -1".to_owned(),
                found: sign.to_string(),
            };
            return Err(ContentError::new(
                Location::entry(format!("{place}, {channel}")),
                fault,
            ));
        }
    }
    if let Some(role) = text
        .role_signs
        .keys()
        .find(|role| !matches!(role.as_str(), "identified" | "physics"))
    {
        let fault = ContentFault::Word {
            expected: "\"identified\" or \"physics\"".to_owned(),
            found: role.clone(),
        };
        return Err(ContentError::new(
            Location::entry("role_signs".to_owned()),
            fault,
        ));
    }
    let mut rules = Rules {
        name: text.name,
        description: text.description,
        inputs: text.inputs,
        outputs: text.outputs,
        on_axis: text.on_axis,
        band: (text.band_rad_s[0], text.band_rad_s[1]),
        patterns,
        units: text.conversions,
        signs: text.signs,
        role_signs: text.role_signs,
        declarations: Vec::new(),
        sample_time_s: text.sample_time_s,
        headings: text.headings,
        rows: text.models,
    };
    for ScopedDeclarations { of, channels } in text.declarations {
        rules.declare(of, &channels);
    }
    Ok(rules)
}

/// Rejects a factor that converts nothing, an empty unit, an invalid sign, and a unit beside a
/// factor of the same channel.
fn check_declarations(text: &RulesText) -> Result<(), ContentError> {
    let of_scopes = text.declarations.iter().map(|declared| {
        let place = format!("declarations, {}", declared.of);
        (place, declared.channels.clone())
    });
    let of_models = text
        .models
        .iter()
        .map(|(key, row)| (format!("models, {key}"), row.declarations()));
    for (place, declared) in of_scopes.chain(of_models) {
        let wrong = |key: &str, channel: &str, expected: &str, found: String| {
            let fault = ContentFault::Word {
                expected: expected.to_owned(),
                found,
            };
            Err(ContentError::new(
                Location::entry(format!("{place}, {key}, {channel}")),
                fault,
            ))
        };
        for (channel, factor) in &declared.factors {
            if !factor.is_finite() || *factor == 0.0 {
                return wrong(
                    "factors",
                    channel,
                    "a number other than 0",
                    factor.to_string(),
                );
            }
            if let Some(unit) = declared.units.get(channel) {
                return wrong(
                    "factors",
                    channel,
                    "a unit or a factor, not both",
                    format!("{unit} and {factor}"),
                );
            }
        }
        if let Some((channel, unit)) = declared
            .units
            .iter()
            .find(|(_, unit)| unit.trim().is_empty())
        {
            return wrong("units", channel, "a unit", unit.clone());
        }
        if let Some((channel, sign)) = declared.signs.iter().find(|(_, sign)| sign.abs() != 1.0) {
            return wrong("signs", channel, "1 or -1", sign.to_string());
        }
    }
    Ok(())
}

fn text_of(rules: &Rules) -> RulesText {
    RulesText {
        format: FORMAT.name.to_owned(),
        version: FORMAT.version,
        name: rules.name.clone(),
        description: rules.description.clone(),
        inputs: rules.inputs.clone(),
        outputs: rules.outputs.clone(),
        on_axis: rules.on_axis.clone(),
        band_rad_s: [rules.band.0, rules.band.1],
        conversions: rules.units.clone(),
        patterns: rules
            .patterns
            .iter()
            .map(|pattern| pattern.as_str().to_owned())
            .collect(),
        signs: rules.signs.clone(),
        role_signs: rules.role_signs.clone(),
        declarations: rules.declarations.clone(),
        sample_time_s: rules.sample_time_s,
        headings: rules.headings.clone(),
        models: rules.rows.clone(),
    }
}

/// Format and version of a rules file.
pub(crate) const FORMAT: Format = Format {
    name: "gdcm-rules",
    version: 1,
};

/// Maximum number of patterns, and of conversions, in a rules file.
const MOST_PATTERNS: usize = 200;

/// Maximum number of declarations in a rules file, each for a role, for folders or for a file.
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
    #[serde(default, deserialize_with = "list::<MOST_PATTERNS, _, _>")]
    pub(crate) conversions: Vec<UnitRule>,
    #[serde(default = "standard", deserialize_with = "list::<MOST_PATTERNS, _, _>")]
    pub(crate) patterns: Vec<String>,
    /// Signs of channels in all files.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) signs: Signs,
    /// Signs of channels in the models of a role, "identified" or "physics".
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) role_signs: BTreeMap<String, Signs>,
    /// Units, factors and signs of channels in the models of a role, of folders, or of a file.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "list::<MOST_DECLARATIONS, _, _>"
    )]
    pub(crate) declarations: Vec<ScopedDeclarations>,
    /// Sample time of models without one \[s\], 0 for continuous-time models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) sample_time_s: Option<f64>,
    /// Column headings of tables, by file.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) headings: BTreeMap<String, Vec<String>>,
    /// Rules for single models, by file and variable.
    #[serde(default)]
    pub(crate) models: BTreeMap<String, RowRule>,
}

/// Returns the patterns of a file without any.
fn standard() -> Vec<String> {
    standard_patterns()
        .iter()
        .map(|pattern| pattern.as_str().to_owned())
        .collect()
}

#[cfg(test)]
mod tests {
    use gdcm_model::assembly::FileScope;
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
            ..RowRule::default()
        };
        rules.rows.insert("c03/nom.mat".into(), row);
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
        for (rest, expected) in [
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
            let error = load_rules(&path).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
