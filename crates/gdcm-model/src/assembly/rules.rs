//! The engineer's rules for the files of a folder: everything that assembly depends on besides the
//! files.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use regex::{Regex, RegexBuilder};
use serde::{Deserialize, Serialize};

use super::declarations::{
    ChannelDeclarations, DeclaredChannels, FileScope, ScopedDeclarations, declared_of, rename_key,
};
use super::found_model::{FoundModel, Row, RowRole, standard_on_axis};
use crate::dataset::channel::ChannelSide;
use crate::message_text::{quoted, sanitized, shortened};
use crate::whole_number::whole_or_none;

/// A channel of the dataset, with its unit in files that give none.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub struct ChannelRule {
    pub name: String,
    /// Its unit in the dataset; empty while unknown.
    #[serde(default)]
    pub unit: String,
    /// Further names in files; a leading minus marks the opposite sign.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub aliases: Vec<String>,
    /// Unit in files that give none; `None` while unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit_in_files: Option<String>,
}

impl ChannelRule {
    /// Creates a channel with an unknown unit.
    pub fn named(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..Self::default()
        }
    }
}

/// A conversion that units alone do not determine, such as inches of stick to percent of travel.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct UnitRule {
    pub channel: String,
    pub from: String,
    /// Dataset units per unit `from`.
    pub factor: f64,
}

/// Sign factors of channels, 1 or -1, by dataset name.
pub type Signs = BTreeMap<String, f64>;

/// The engineer's overrides of the proposals for one model.
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
    /// True airspeed of the condition \[kt\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub airspeed_kt: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub altitude: Option<String>,
    /// Altitude \[ft\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub altitude_ft: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weight: Option<String>,
    /// Mass \[kg\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_kg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<String>,
    /// Trim offsets; replaces all proposed ones where any is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub perturbation: Option<BTreeMap<String, f64>>,
    /// Names of its inputs in the file's order, where the file has none or wrong ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inputs: Option<Vec<String>>,
    /// Names of its outputs in the file's order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outputs: Option<Vec<String>>,
    /// By dataset name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub signs: Option<Signs>,
    /// By dataset name; overrides the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub units: Option<BTreeMap<String, String>>,
    /// Dataset units per file unit, by dataset name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factors: Option<BTreeMap<String, f64>>,
    /// Sample time \[s\] where the file has none; 0 for a continuous-time model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_time_s: Option<f64>,
}

impl RowRule {
    /// Returns whether the rule gives a value for a field on which a file and its names disagree.
    pub(super) fn settles(&self, field: &str) -> bool {
        match field {
            "condition" => self.condition.is_some(),
            "airspeed_kt" => self.airspeed_kt.is_some(),
            "altitude_ft" => self.altitude_ft.is_some(),
            "mass_kg" => self.mass_kg.is_some(),
            _ => self.perturbation.is_some(),
        }
    }

    /// Overrides the proposals in `row` with the values given here.
    pub fn apply(&self, row: &mut Row) {
        fn put<T: Clone>(said: &Option<T>, place: &mut Option<T>) {
            if said.is_some() {
                place.clone_from(said);
            }
        }
        row.left_out = self.left_out.unwrap_or(row.left_out);
        put(&self.condition, &mut row.condition);
        put(&self.role, &mut row.role);
        row.name = self
            .name
            .clone()
            .unwrap_or_else(|| std::mem::take(&mut row.name));
        put(&self.airspeed_kt, &mut row.airspeed_kt);
        put(&self.altitude, &mut row.altitude);
        put(&self.altitude_ft, &mut row.altitude_ft);
        put(&self.weight, &mut row.weight);
        put(&self.mass_kg, &mut row.mass_kg);
        put(&self.method, &mut row.method);
        if let Some(perturbation) = &self.perturbation {
            row.perturbation.clone_from(perturbation);
        }
    }

    /// Returns the units, factors and signs of its channels.
    pub fn declarations(&self) -> ChannelDeclarations {
        ChannelDeclarations {
            units: self.units.clone().unwrap_or_default(),
            factors: self.factors.clone().unwrap_or_default(),
            signs: self.signs.clone().unwrap_or_default(),
        }
    }

    /// Overrides earlier declarations of the same channels.
    pub fn declare(&mut self, declared: &ChannelDeclarations) {
        let mut all = self.declarations();
        all.override_by(declared);
        self.units = Some(all.units).filter(|units| !units.is_empty());
        self.factors = Some(all.factors).filter(|factors| !factors.is_empty());
        self.signs = Some(all.signs).filter(|signs| !signs.is_empty());
    }
}

/// Column headings of tables, by file: "omega \[rad/s\]", "mag P/LAT \[dB\]".
pub type Headings = BTreeMap<String, Vec<String>>;

/// The engineer's rules for the files of a folder.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    pub name: String,
    /// Content and source of the data.
    pub description: String,
    /// Inputs of the dataset, in its order.
    pub inputs: Vec<ChannelRule>,
    /// Outputs of the dataset, in its order.
    pub outputs: Vec<ChannelRule>,
    /// On-axis responses: output, input.
    pub on_axis: Vec<(String, String)>,
    /// Lower and upper end of the band of comparison \[rad/s\].
    pub band: (f64, f64),
    /// Patterns for the names of folders, files and variables; earlier ones take precedence.
    pub patterns: Vec<NamePattern>,
    /// Conversions that units alone do not determine.
    pub units: Vec<UnitRule>,
    /// Signs of channels in all files; override the channel names.
    pub signs: Signs,
    /// Signs of channels in the models of a role, "identified" or "physics"; override the signs for
    /// all files.
    pub role_signs: BTreeMap<String, Signs>,
    /// Units, factors and signs of channels for a role, a folder or a file.
    pub declarations: Vec<ScopedDeclarations>,
    /// Sample time \[s\] of models without one, 0 for continuous-time models; `None` asks for it.
    pub sample_time_s: Option<f64>,
    /// Column headings of tables; replace the headings in the files.
    pub headings: Headings,
    /// Overrides for single models, by [`super::found_model::FoundModel::key`].
    pub rows: BTreeMap<String, RowRule>,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            name: String::new(),
            description: String::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            on_axis: Vec::new(),
            // Usual band of comparison for the rigid-body responses of helicopters.
            band: (0.5, 12.0),
            patterns: standard_patterns().to_vec(),
            units: Vec::new(),
            signs: Signs::new(),
            role_signs: BTreeMap::new(),
            declarations: Vec::new(),
            sample_time_s: None,
            headings: Headings::new(),
            rows: BTreeMap::new(),
        }
    }
}

impl Rules {
    /// Returns the inputs or the outputs of the dataset.
    pub fn channels_mut(&mut self, side: ChannelSide) -> &mut Vec<ChannelRule> {
        side.of(&mut self.inputs, &mut self.outputs)
    }

    /// Renames a channel of the dataset. The old name becomes an alias for files; on-axis
    /// responses, conversions and signs move to the new name, and a response that is on-axis for a
    /// helicopter under its new name is marked.
    pub fn rename(&mut self, side: ChannelSide, index: usize, name: String) {
        let Some(channel) = self.channels_mut(side).get_mut(index) else {
            return;
        };
        let old = std::mem::replace(&mut channel.name, name.clone());
        if old == name {
            return;
        }
        channel.aliases.retain(|alias| *alias != name);
        if !old.is_empty() && !channel.aliases.contains(&old) {
            channel.aliases.push(old.clone());
        }
        for (output, input) in &mut self.on_axis {
            let of_side = side.of(input, output);
            if *of_side == old {
                of_side.clone_from(&name);
            }
        }
        let of_new = |other: &ChannelRule| {
            let other = other.name.clone();
            let name = name.clone();
            if side == ChannelSide::Input {
                (other, name)
            } else {
                (name, other)
            }
        };
        for pair in side.of(&self.outputs, &self.inputs).iter().map(of_new) {
            if standard_on_axis(&pair.0, &pair.1) && !self.on_axis.contains(&pair) {
                self.on_axis.push(pair);
            }
        }
        self.units
            .iter_mut()
            .filter(|unit| unit.channel == old)
            .for_each(|unit| unit.channel.clone_from(&name));
        for row in self.rows.values_mut() {
            if let Some(signs) = &mut row.signs {
                rename_key(signs, &old, &name);
            }
            if let Some(units) = &mut row.units {
                rename_key(units, &old, &name);
            }
            if let Some(factors) = &mut row.factors {
                rename_key(factors, &old, &name);
            }
        }
        for signs in self.role_signs.values_mut().chain([&mut self.signs]) {
            rename_key(signs, &old, &name);
        }
        for declared in &mut self.declarations {
            declared.channels.rename(&old, &name);
        }
    }

    /// Returns the units, factors and signs that apply to the channels of a model: a file takes
    /// precedence over a folder, a folder over a role, and a role over all models.
    pub fn declared(&self, found: &FoundModel, role: Option<RowRole>) -> DeclaredChannels<'_> {
        let with_signs = |of: FileScope, signs: &Signs| ScopedDeclarations {
            of,
            channels: ChannelDeclarations {
                signs: signs.clone(),
                ..ChannelDeclarations::default()
            },
        };
        let mut declarations = vec![with_signs(FileScope::All, &self.signs)];
        for (role, signs) in &self.role_signs {
            declarations.push(with_signs(FileScope::from(role.clone()), signs));
        }
        declarations.extend(self.declarations.iter().cloned());
        let mut channels = ChannelDeclarations::default();
        for declared in declared_of(&declarations, found, role) {
            channels.override_by(&declared.channels);
        }
        if let Some(row) = self.rows.get(&found.key()) {
            channels.override_by(&row.declarations());
        }
        DeclaredChannels {
            conversions: &self.units,
            channels,
        }
    }

    /// Declares units, factors and signs, overriding earlier declarations of the same channels and
    /// models. Signs for all models and for a role are kept in [`Self::signs`] and
    /// [`Self::role_signs`].
    pub fn declare(&mut self, of: FileScope, declared: &ChannelDeclarations) {
        let signs = declared
            .signs
            .iter()
            .map(|(channel, sign)| (channel.clone(), *sign));
        match &of {
            FileScope::Files(_) => return self.declarations_mut(of).override_by(declared),
            FileScope::All => self.signs.extend(signs),
            FileScope::Physics | FileScope::Identified if declared.signs.is_empty() => {}
            FileScope::Physics | FileScope::Identified => {
                self.role_signs
                    .entry(of.to_string())
                    .or_default()
                    .extend(signs);
            }
        }
        let conversions = ChannelDeclarations {
            signs: Signs::new(),
            ..declared.clone()
        };
        if conversions != ChannelDeclarations::default() {
            self.declarations_mut(of).override_by(&conversions);
        }
    }

    /// Returns the declarations for a scope for modification, and adds them where missing.
    pub fn declarations_mut(&mut self, of: FileScope) -> &mut ChannelDeclarations {
        let index = match self
            .declarations
            .iter()
            .position(|declared| declared.of == of)
        {
            Some(index) => index,
            None => {
                self.declarations.push(ScopedDeclarations {
                    of,
                    channels: ChannelDeclarations::default(),
                });
                self.declarations.len() - 1
            }
        };
        &mut self.declarations[index].channels
    }
}

/// Maximum length of a pattern, and maximum memory of a compiled pattern \[bytes\].
const LONGEST: usize = 1000;
const MOST_MEMORY: usize = 1 << 20;

/// Pattern for names: a regular expression whose named groups identify the values.
///
/// | group | holds |
/// |---|---|
/// | `condition`, `airspeed_kt`, `altitude`, `altitude_ft` | the value of this name |
/// | `weight`, `mass_kg`, `method`, `name` | the value of this name |
/// | `by_roll_deg`, `by_...` | trim offset in `roll_deg`, ... (`+5`, `-5`, `p5`, `m5`) |
/// | `nominal`, `perturbed`, `identified` | any text; sets this role |
#[derive(Clone, Debug)]
pub struct NamePattern {
    regex: Regex,
}

/// Why a text is not a valid pattern.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PatternError {
    /// Not a regular expression.
    #[error("{} is no regular expression: {}", quoted(pattern), shortened(&sanitized(reason)))]
    Syntax {
        pattern: String,
        /// The parser's message.
        reason: String,
    },
    /// A group has an unknown name.
    #[error(
        "{}: a group is named {}; groups are condition, airspeed_kt, altitude, altitude_ft, weight, mass_kg, method, name, nominal, \
         perturbed, identified, or by_ and a coordinate such as roll_deg",
        quoted(pattern),
        quoted(group)
    )]
    Group {
        pattern: String,
        /// The unknown name.
        group: String,
    },
}

/// Group names, besides those of offsets.
const GROUPS: &str = "condition airspeed_kt altitude altitude_ft weight mass_kg method name nominal perturbed identified";
/// Prefix of the group names of offsets.
const OFFSET: &str = "by_";

impl NamePattern {
    /// Compiles a pattern; case-insensitive.
    pub fn new(pattern: &str) -> Result<Self, PatternError> {
        let wrong = |reason: String| PatternError::Syntax {
            pattern: pattern.to_owned(),
            reason,
        };
        if pattern.len() > LONGEST {
            return Err(wrong(format!("it is longer than {LONGEST} letters")));
        }
        let built = RegexBuilder::new(pattern)
            .case_insensitive(true)
            .size_limit(MOST_MEMORY)
            .build();
        let regex = built.map_err(|error| {
            wrong(
                error
                    .to_string()
                    .lines()
                    .last()
                    .unwrap_or_default()
                    .trim()
                    .to_owned(),
            )
        })?;
        let is_known =
            |name: &&str| name.starts_with(OFFSET) || GROUPS.split(' ').any(|group| group == *name);
        let unknown = regex.capture_names().flatten().find(|name| !is_known(name));
        match unknown {
            Some(group) => Err(PatternError::Group {
                pattern: pattern.to_owned(),
                group: group.to_owned(),
            }),
            None => Ok(Self { regex }),
        }
    }

    /// Returns the source text.
    pub fn as_str(&self) -> &str {
        self.regex.as_str()
    }

    /// Fills the empty fields of a row with the values found in a name.
    pub fn read(&self, name: &str, row: &mut Row) {
        for found in self.regex.captures_iter(name) {
            for group in self.regex.capture_names().flatten() {
                if let Some(text) = found.name(group) {
                    put(group, text.as_str(), row);
                }
            }
        }
    }
}

/// Returns the parts of a name that look like a trim offset ("dPHI+5") and that no pattern reads.
pub fn unread_offsets(name: &str, patterns: &[NamePattern]) -> Vec<String> {
    // A word, a sign and a number; ends at a unit or at the next part.
    let Ok(offset) = Regex::new(r"[A-Za-z]+[_ ]?[+-]\d+(?:\.\d+)?") else {
        return Vec::new();
    };
    let read: Vec<std::ops::Range<usize>> = patterns
        .iter()
        .flat_map(|pattern| {
            pattern
                .regex
                .captures_iter(name)
                .map(|found| found.get_match().range())
        })
        .collect();
    let is_read = |part: &regex::Match<'_>| {
        read.iter()
            .any(|range| range.start < part.end() && part.start() < range.end)
    };
    offset
        .find_iter(name)
        .filter(|part| !is_read(part))
        .map(|part| part.as_str().to_owned())
        .collect()
}

fn put(group: &str, text: &str, row: &mut Row) {
    let number = || {
        text.replace(',', ".")
            .parse::<f64>()
            .ok()
            .filter(|value| value.is_finite())
    };
    let word = || Some(text.to_lowercase());
    match group {
        "condition" => row.condition = row.condition.or_else(|| text.parse().ok()),
        "airspeed_kt" => row.airspeed_kt = row.airspeed_kt.or_else(number),
        "altitude_ft" => row.altitude_ft = row.altitude_ft.or_else(number),
        "mass_kg" => row.mass_kg = row.mass_kg.or_else(number),
        "altitude" => row.altitude = row.altitude.take().or_else(word),
        "weight" => row.weight = row.weight.take().or_else(word),
        "method" => row.method = row.method.take().or_else(|| Some(text.to_owned())),
        "name" if row.name.is_empty() => text.clone_into(&mut row.name),
        "nominal" | "perturbed" | "identified" => row.role = row.role.or(RowRole::of(group)),
        _ => {
            if let (Some(coordinate), Some(offset)) = (group.strip_prefix(OFFSET), offset(text)) {
                row.perturbation
                    .entry(coordinate.to_owned())
                    .or_insert(offset);
            }
        }
    }
}

/// Parses a signed offset: `+5`, `-5`, `p5`, `m5`, `plus5`, `minus2.5`.
fn offset(text: &str) -> Option<f64> {
    let text = text.to_lowercase();
    let signs = [
        ("minus", -1.0),
        ("plus", 1.0),
        ("-", -1.0),
        ("+", 1.0),
        ("m", -1.0),
        ("p", 1.0),
    ];
    let signed = signs
        .iter()
        .find_map(|(mark, sign)| Some((text.strip_prefix(mark)?, *sign)));
    let (digits, sign) = signed.unwrap_or((&text, 1.0));
    let value: f64 = digits.trim_start_matches(['_', ' ']).parse().ok()?;
    value.is_finite().then_some(sign * value)
}

impl PartialEq for NamePattern {
    fn eq(&self, other: &Self) -> bool {
        self.as_str() == other.as_str()
    }
}

/// Returns the patterns for common names: `c03_045kt_high/roll+5`, `cond 3/V-10kt`,
/// `120kt_low_heavy/flight`.
pub fn standard_patterns() -> &'static [NamePattern] {
    &STANDARD
}

/// Compiled once, because every record needs them.
static STANDARD: LazyLock<Vec<NamePattern>> = LazyLock::new(|| {
    const SIGNED: &str = r"(?:[+-]|p|m|plus|minus)[_ ]?\d+(?:\.\d+)?";
    let offset = |words: &str, coordinate: &str| {
        format!(r"(?:^|[/_#, -])(?:d|delta_?)?(?:{words})[_ ]?(?<by_{coordinate}>{SIGNED})")
    };
    let texts = [
        r"(?:^|[/_ #.-])(?:c|cond|condition|fc|case|point)[_ -]?0*(?<condition>\d+)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ ])v?0*(?<airspeed_kt>\d+(?:\.\d+)?)[_ ]?(?:kt|kts|ktas|kcas|kias|knots)(?:[/_ .#-]|$)".to_owned(),
        r"-(?<airspeed_kt>\d{3})[_ ]?(?:kt|kts|ktas|kcas|kias|knots)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<altitude_ft>\d{3,5})[_ ]?ft(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<mass_kg>\d{3,6})[_ ]?kg(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<weight>light|heavy)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<weight>low|high)[_ ]?(?:w|weight|gw|mass)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<altitude>low|high)[_ ]?(?:alt|altitude)?[/_ -](?<weight>low|high)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<altitude>low|high)[_ ]?(?:alt|altitude)?(?:[/_ .#-]|$)".to_owned(),
        offset("roll|phi|bank", "roll_deg"),
        offset("v|speed|airspeed|tas|ias", "airspeed_kt"),
        offset("roc|climb|rateofclimb|hdot", "rate_of_climb_fpm"),
        offset("pitch|theta", "pitch_deg"),
        offset("beta|slip|sideslip", "sideslip_deg"),
        r"(?:^|[/_ #.-])(?<nominal>nominal|nom|trim|baseline)(?:[/_ .#(-]|$)".to_owned(),
        r"(?:^|[/_ #.-])(?<identified>identified|ident|id|sysid|sid|(?:ct-?)?pbsid|n4sid|cifer|flight|flt|measured|frf)\d*(?:[/_ .#(-]|$)"
            .to_owned(),
        r"(?:^|[/_ #.-])(?<perturbed>perturbed|pert)\d*(?:[/_ .#(-]|$)".to_owned(),
    ];
    // A test compiles each pattern: none is skipped here.
    texts
        .iter()
        .filter_map(|text| NamePattern::new(text).ok())
        .collect()
});

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str) -> Row {
        let mut row = Row::default();
        for pattern in standard_patterns() {
            pattern.read(name, &mut row);
        }
        row
    }

    #[test]
    fn what_was_said_of_a_channel_follows_its_name() {
        let mut rules = Rules {
            inputs: vec![ChannelRule::named("xb"), ChannelRule::named("COL")],
            outputs: vec![ChannelRule::named("Q"), ChannelRule::named("az")],
            on_axis: vec![("az".into(), "COL".into())],
            units: vec![UnitRule {
                channel: "xb".into(),
                from: "in".into(),
                factor: 8.0,
            }],
            signs: Signs::from([("az".into(), -1.0)]),
            role_signs: BTreeMap::from([("identified".into(), Signs::from([("xb".into(), -1.0)]))]),
            ..Rules::default()
        };
        rules
            .declarations_mut(FileScope::Physics)
            .units
            .insert("xb".into(), "in".into());
        rules.rows.entry("a.mat".into()).or_default().factors =
            Some([("xb".to_owned(), 8.0)].into());
        rules.rename(ChannelSide::Input, 0, "LON".into());
        rules.rename(ChannelSide::Output, 1, "NZ".into());
        let pair = |output: &str, input: &str| (output.to_owned(), input.to_owned());
        assert_eq!(rules.on_axis, [pair("NZ", "COL"), pair("Q", "LON")]);
        assert_eq!(rules.inputs[0].aliases, ["xb"], "files call it as before");
        assert_eq!(rules.units[0].channel, "LON");
        assert_eq!(rules.signs, Signs::from([("NZ".into(), -1.0)]));
        assert_eq!(
            rules.role_signs["identified"],
            Signs::from([("LON".into(), -1.0)])
        );
        assert_eq!(
            rules.declarations[0]
                .channels
                .units
                .keys()
                .collect::<Vec<_>>(),
            ["LON"]
        );
        assert_eq!(
            rules.rows["a.mat"]
                .declarations()
                .factors
                .keys()
                .collect::<Vec<_>>(),
            ["LON"]
        );
        let before = rules.clone();
        rules.rename(ChannelSide::Input, 0, "LON".into());
        rules.rename(ChannelSide::Input, 7, "none".into());
        assert_eq!(rules, before);
        rules.rename(ChannelSide::Input, 0, "xb".into());
        assert_eq!(rules.inputs[0].aliases, ["LON"]);
    }

    #[test]
    fn a_name_says_condition_airspeed_altitude_and_perturbation() {
        assert_eq!(standard_patterns().len(), 17);
        let row = read("c03_045kt_high/roll+5");
        assert_eq!(
            (row.condition, row.airspeed_kt, row.altitude.as_deref()),
            (Some(3), Some(45.0), Some("high"))
        );
        assert_eq!(
            row.perturbation.into_iter().collect::<Vec<_>>(),
            [("roll_deg".to_owned(), 5.0)]
        );
        let offsets: Vec<f64> = read("dV+5_dROC+150_dPHI-5")
            .perturbation
            .into_values()
            .collect();
        assert_eq!(
            offsets,
            [5.0, 150.0, -5.0],
            "airspeed_kt, rate_of_climb_fpm, roll_deg"
        );
        let row = read("fc-12/120kt_low_heavy/V-10kt roc+150fpm");
        assert_eq!(
            (row.condition, row.airspeed_kt, row.weight.as_deref()),
            (Some(12), Some(120.0), Some("heavy"))
        );
        let offsets: Vec<f64> = row.perturbation.values().copied().collect();
        assert_eq!(offsets, [-10.0, 150.0], "airspeed_kt, rate_of_climb_fpm");
    }

    #[test]
    fn a_trim_of_which_a_part_is_not_understood_is_told() {
        let unread = |name: &str| unread_offsets(name, standard_patterns());
        let row = read("c3/dV+5_dROC+150_dPHI+5");
        assert_eq!(
            row.perturbation.into_values().collect::<Vec<_>>(),
            [5.0, 150.0, 5.0]
        );
        assert!(
            unread("dV+5_dROC+150_dPHI+5").is_empty() && unread("V-10kt roc+150fpm").is_empty()
        );
        assert_eq!(unread("dV+5_flap-10"), ["flap-10"]);
    }

    #[test]
    fn low_and_high_are_altitude_first_and_weight_then() {
        let row = read("60kt_low_high/nominal");
        assert_eq!(
            (row.altitude.as_deref(), row.weight.as_deref(), row.role),
            (Some("low"), Some("high"), Some(RowRole::Nominal))
        );
        let row = read("V090kt_2000ft_6600kg/CT-PBSID 2");
        assert_eq!(
            (row.airspeed_kt, row.altitude_ft, row.mass_kg),
            (Some(90.0), Some(2000.0), Some(6600.0))
        );
        assert_eq!(read("x/flight_1").role, Some(RowRole::Identified));
        let row = read("study#study.c3.identified(2)");
        assert_eq!(
            (row.condition, row.role),
            (Some(3), Some(RowRole::Identified)),
            "fields of a struct"
        );
    }

    #[test]
    fn a_perturbed_airspeed_is_no_airspeed() {
        for name in ["V+10kt", "a/V-10kt", "c1/v_m10kt"] {
            let row = read(name);
            assert_eq!(row.airspeed_kt, None, "{name}");
            assert_eq!(
                row.perturbation.get("airspeed_kt").map(|by| by.abs()),
                Some(10.0),
                "{name}"
            );
        }
    }

    #[test]
    fn what_a_pattern_of_the_engineer_finds_first_stands() {
        let mut row = Row::default();
        NamePattern::new("case(?<condition>\\d)")
            .unwrap()
            .read("case7/c03", &mut row);
        standard_patterns()
            .iter()
            .for_each(|pattern| pattern.read("case7/c03", &mut row));
        assert_eq!(row.condition, Some(7));
        let unknown = NamePattern::new("(?<speed>\\d+)").unwrap_err();
        assert!(unknown.to_string().contains("\"speed\""), "{unknown}");
        // However long the text and whatever it contains, the message is a single line.
        for wrong in [
            "(".to_owned(),
            "(?<cond\u{7f}ition>a)".to_owned(),
            "(th".repeat(40_000),
            format!("(?<{}>a)", "g".repeat(900)),
        ] {
            let message = NamePattern::new(&wrong).unwrap_err().to_string();
            assert!(
                message.len() < 500 && !message.contains(char::is_control),
                "{message:?}"
            );
        }
    }
}
