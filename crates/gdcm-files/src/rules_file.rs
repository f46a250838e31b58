//! Rules files, `*.gdcm-rules.json`: what the engineer says about the files of a folder, for next week's folder too.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gdcm_core::assembly::{ChannelRule, NamePattern, RowRole, RowRule, Rules, UnitRule, standard_patterns};
use gdcm_core::dataset::Location;
use gdcm_core::dataset::limits::{MOST_CHANNELS, MOST_PAIRS};
use gdcm_core::whole_number::{whole, whole_or_none};
use serde::{Deserialize, Serialize};

use crate::file_error::{ContentError, ContentFault, FileError};
use crate::json_text::{Format, list};
use crate::output_set::OutputSet;
use crate::source::Source;

/// How the name of a rules file ends.
const RULES_EXTENSION: &str = "gdcm-rules.json";

/// The place of the rules beside a dataset: "week.gdcm-rules.json" beside "week.json.gz".
pub fn rules_path(dataset: &Path) -> PathBuf {
    let name = dataset.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = name.trim_end_matches(".gz").trim_end_matches(".json");
    dataset.with_file_name(format!("{stem}.{RULES_EXTENSION}"))
}

/// Reads a rules file; whole, or not at all. Keys that are not known are cautions.
pub fn load_rules(path: &Path) -> Result<(Rules, Vec<String>), FileError> {
    let source = Source::read(path)?;
    let (text, cautions) = FORMAT.decode::<RulesText>(source.text(), path)?;
    FORMAT.check_read(&text.format, text.version, path)?;
    let rules = rules_of(text).map_err(|flaw| FileError::content(path, flaw))?;
    Ok((rules, cautions))
}

/// Writes a rules file beside others of `outputs`.
pub fn add_rules(rules: &Rules, path: &Path, outputs: &mut OutputSet) -> Result<(), FileError> {
    let text = text_of(rules);
    outputs.add(path, |file| {
        serde_json::to_writer_pretty(&mut *file, &text)?;
        file.write_all(b"\n")
    })
}

fn rules_of(text: RulesText) -> Result<Rules, ContentError> {
    let pattern = |(index, text): (usize, &String)| {
        NamePattern::new(text).map_err(|error| {
            let fault = ContentFault::Word { expected: error.to_string(), found: text.clone() };
            ContentError::new(Location::entry(format!("patterns, entry {}", index + 1)), fault)
        })
    };
    let patterns = text.patterns.iter().enumerate().map(pattern).collect::<Result<_, _>>()?;
    let rows = text.models.into_iter().map(|(key, row)| Ok((key.clone(), row_of(&key, row)?)));
    Ok(Rules {
        name: text.name,
        description: text.description,
        inputs: text.inputs.into_iter().map(channel_of).collect(),
        outputs: text.outputs.into_iter().map(channel_of).collect(),
        on_axis: text.on_axis,
        band: (text.band_rad_s[0], text.band_rad_s[1]),
        patterns,
        units: text
            .conversions
            .into_iter()
            .map(|text| UnitRule { channel: text.channel, from: text.from, factor: text.factor })
            .collect(),
        headings: text.headings,
        rows: rows.collect::<Result<_, ContentError>>()?,
    })
}

fn channel_of(text: ChannelText) -> ChannelRule {
    ChannelRule { name: text.name, unit: text.unit, aliases: text.aliases, unit_in_files: text.unit_in_files }
}

fn row_of(key: &str, text: RowText) -> Result<RowRule, ContentError> {
    let role = match &text.role {
        None => None,
        Some(word) => Some(RowRole::of(word).ok_or_else(|| {
            let expected = "\"nominal\", \"perturbed\" or \"identified\"".to_owned();
            ContentError::new(
                Location::entry(format!("models, {key}, role")),
                ContentFault::Word { expected, found: word.clone() },
            )
        })?),
    };
    Ok(RowRule {
        left_out: text.left_out,
        condition: text.condition,
        role,
        name: text.name,
        airspeed_kt: text.airspeed_kt,
        altitude: text.altitude,
        altitude_ft: text.altitude_ft,
        weight: text.weight,
        mass_kg: text.mass_kg,
        method: text.method,
        perturbation: text.perturbation,
        inputs: text.inputs,
        outputs: text.outputs,
    })
}

fn text_of(rules: &Rules) -> RulesText {
    let channel = |rule: &ChannelRule| ChannelText {
        name: rule.name.clone(),
        unit: rule.unit.clone(),
        aliases: rule.aliases.clone(),
        unit_in_files: rule.unit_in_files.clone(),
    };
    let conversion =
        |rule: &UnitRule| UnitText { channel: rule.channel.clone(), from: rule.from.clone(), factor: rule.factor };
    RulesText {
        format: FORMAT.name.to_owned(),
        version: FORMAT.version,
        name: rules.name.clone(),
        description: rules.description.clone(),
        inputs: rules.inputs.iter().map(channel).collect(),
        outputs: rules.outputs.iter().map(channel).collect(),
        on_axis: rules.on_axis.clone(),
        band_rad_s: [rules.band.0, rules.band.1],
        conversions: rules.units.iter().map(conversion).collect(),
        patterns: rules.patterns.iter().map(|pattern| pattern.as_str().to_owned()).collect(),
        headings: rules.headings.clone(),
        models: rules.rows.iter().map(|(key, row)| (key.clone(), row_text(row))).collect(),
    }
}

fn row_text(row: &RowRule) -> RowText {
    RowText {
        left_out: row.left_out,
        condition: row.condition,
        role: row.role.map(|role| role.word().to_owned()),
        name: row.name.clone(),
        airspeed_kt: row.airspeed_kt,
        altitude: row.altitude.clone(),
        altitude_ft: row.altitude_ft,
        weight: row.weight.clone(),
        mass_kg: row.mass_kg,
        method: row.method.clone(),
        perturbation: row.perturbation.clone(),
        inputs: row.inputs.clone(),
        outputs: row.outputs.clone(),
    }
}

// A rules file, key by key.

/// What a rules file calls itself.
pub(super) const FORMAT: Format = Format { name: "gdcm-rules", version: 1 };

/// Most patterns, and conversions, of a rules file.
const MOST_PATTERNS: usize = 200;

#[derive(Deserialize, Serialize)]
pub(super) struct RulesText {
    pub(super) format: String,
    #[serde(deserialize_with = "whole")]
    pub(super) version: u64,
    pub(super) name: String,
    #[serde(default)]
    pub(super) description: String,
    #[serde(deserialize_with = "list::<MOST_CHANNELS, _, _>")]
    pub(super) inputs: Vec<ChannelText>,
    #[serde(deserialize_with = "list::<MOST_CHANNELS, _, _>")]
    pub(super) outputs: Vec<ChannelText>,
    #[serde(default, deserialize_with = "list::<MOST_PAIRS, _, _>")]
    pub(super) on_axis: Vec<(String, String)>,
    pub(super) band_rad_s: [f64; 2],
    #[serde(default, deserialize_with = "list::<MOST_PATTERNS, _, _>")]
    pub(super) conversions: Vec<UnitText>,
    #[serde(default = "standard", deserialize_with = "list::<MOST_PATTERNS, _, _>")]
    pub(super) patterns: Vec<String>,
    /// What the columns of tables hold, by file.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) headings: BTreeMap<String, Vec<String>>,
    /// What is said of single models, by file and variable.
    #[serde(default)]
    pub(super) models: BTreeMap<String, RowText>,
}

/// The patterns of a file that names none.
fn standard() -> Vec<String> {
    standard_patterns().iter().map(|pattern| pattern.as_str().to_owned()).collect()
}

#[derive(Deserialize, Serialize)]
pub(super) struct ChannelText {
    pub(super) name: String,
    #[serde(default)]
    pub(super) unit: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) aliases: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) unit_in_files: Option<String>,
}

#[derive(Deserialize, Serialize)]
pub(super) struct UnitText {
    pub(super) channel: String,
    pub(super) from: String,
    pub(super) factor: f64,
}

#[derive(Default, Deserialize, Serialize)]
#[serde(default)]
pub(super) struct RowText {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) left_out: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "whole_or_none")]
    pub(super) condition: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) role: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) airspeed_kt: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) altitude: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) altitude_ft: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) weight: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mass_kg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) method: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) perturbation: Option<BTreeMap<String, f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) inputs: Option<Vec<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) outputs: Option<Vec<String>>,
}

#[cfg(test)]
mod tests {
    use crate::output_set::Existing;

    use super::*;

    #[test]
    fn rules_come_back_as_they_were_written() {
        let mut rules = Rules { name: "week 12".into(), ..Rules::default() };
        rules.inputs.push(ChannelRule {
            unit: "%".into(),
            unit_in_files: Some("in".into()),
            ..ChannelRule::named("LON")
        });
        rules.units.push(UnitRule { channel: "LON".into(), from: "in".into(), factor: 8.5 });
        let row = RowRule {
            role: Some(RowRole::Nominal),
            airspeed_kt: Some(45.0),
            left_out: Some(false),
            ..RowRule::default()
        };
        rules.rows.insert("c03/nom.mat".into(), row);
        rules.headings.insert("frf.csv".into(), vec!["omega [Hz]".into(), "re".into(), "im".into()]);
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
        let start =
            r#"{"format": "gdcm-rules", "version": 1, "name": "", "inputs": [], "outputs": [], "band_rad_s": [1, 2], "#;
        for (rest, expected) in [
            (r#""patterns": ["("]}"#, "patterns, entry 1"),
            (r#""models": {"a.mat": {"role": "trim"}}}"#, "models, a.mat, role"),
        ] {
            std::fs::write(&path, format!("{start}{rest}")).unwrap();
            let error = load_rules(&path).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
