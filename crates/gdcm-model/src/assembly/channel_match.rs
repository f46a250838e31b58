//! Matching of file channels to dataset channels, and the factors between them.

use super::declarations::DeclaredChannels;
use super::found_model::ChannelLabel;
use super::physical_unit::{Dimension, PhysicalUnit, conversion_factor};
use super::problem::ProblemKind;
use super::rules::ChannelRule;
use crate::dataset::channel::ChannelSide;
use crate::units::number;

/// A file channel that maps to a dataset channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelUse {
    /// Index in the file.
    pub index: usize,
    /// Dataset units per file unit; negative where the file has the opposite sign.
    pub factor: f64,
    /// Description of the conversion, if any ("rad/s → deg/s"), or a note that the unit was
    /// declared for all files.
    pub words: Option<String>,
}

/// The channels on one side of a model, in the dataset's order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChannelMatch {
    /// One entry per channel of the dataset; `None` where it is missing.
    pub uses: Vec<Option<ChannelUse>>,
    pub problems: Vec<ProblemKind>,
    /// Assumptions made where the file is silent.
    pub notes: Vec<String>,
    /// Whether the channels have no names in the file and were matched in the dataset's order.
    pub by_position: bool,
}

impl ChannelMatch {
    /// Matches the channels of one side; with `partial`, some channels may be missing, but not all.
    pub fn of(
        side: ChannelSide,
        labels: &[ChannelLabel],
        rules: &[ChannelRule],
        declared: &DeclaredChannels<'_>,
        partial: bool,
    ) -> Self {
        let mut found = Self::default();
        let unnamed = !labels.is_empty() && labels.iter().all(|label| label.name.is_none());
        if unnamed && labels.len() != rules.len() {
            found.problems.push(match partial {
                true => unmatched(side, labels, rules),
                false => ProblemKind::Unnamed {
                    side,
                    expected: rules.len(),
                    found: labels.len(),
                },
            });
            found.uses = vec![None; rules.len()];
            return found;
        }
        if unnamed {
            found.by_position = true;
        }
        for (place, rule) in rules.iter().enumerate() {
            let index = if unnamed {
                Some(place)
            } else {
                found.find(side, labels, rule, partial)
            };
            let used = index.map(|index| {
                let used = found.used(index, &labels[index], rule, declared);
                found.signed(
                    used,
                    labels[index].name.as_deref(),
                    rule,
                    declared.sign_of(&rule.name),
                )
            });
            found.uses.push(used);
        }
        let is_used = |index: usize| found.uses.iter().flatten().any(|used| used.index == index);
        let unused: Vec<&str> = labels
            .iter()
            .enumerate()
            .filter(|(index, _)| !is_used(*index))
            .filter_map(|(_, label)| label.name.as_deref())
            .collect();
        if found.problems.is_empty() && !unused.is_empty() {
            found.notes.push(format!(
                "{side}s of the file that the dataset does not have: {}",
                unused.join(", ")
            ));
        }
        if partial && found.problems.is_empty() && found.uses.iter().all(Option::is_none) {
            found.problems.push(unmatched(side, labels, rules));
        }
        found
    }

    /// Finds the file channel for `rule`: an exact name match, or a synonym from the field or the
    /// rule.
    fn find(
        &mut self,
        side: ChannelSide,
        labels: &[ChannelLabel],
        rule: &ChannelRule,
        partial: bool,
    ) -> Option<usize> {
        let named = |is_it: &dyn Fn(&str) -> bool| -> Vec<usize> {
            let indices = labels.iter().enumerate();
            indices
                .filter(|(_, label)| label.name.as_deref().is_some_and(is_it))
                .map(|(index, _)| index)
                .collect()
        };
        let is_alias = |is_it: &dyn Fn(&str) -> bool| rule.aliases.iter().any(|alias| is_it(alias));
        let plain = |name: &str| SignedName::of(name).name;
        // Order of preference: exact name, name with sign marks, synonym from the field.
        let ways: [&dyn Fn(&str) -> bool; 4] = [
            &|name| name == rule.name,
            &|name| is_alias(&|alias| alias == name),
            &|name| {
                plain(name) == plain(&rule.name) || is_alias(&|alias| plain(alias) == plain(name))
            },
            &|name| {
                same_channel(&plain(name), &plain(&rule.name))
                    || is_alias(&|alias| same_channel(&plain(name), &plain(alias)))
            },
        ];
        let candidates = ways
            .into_iter()
            .map(named)
            .find(|found| !found.is_empty())
            .unwrap_or_default();
        let names = |indices: &mut dyn Iterator<Item = usize>| {
            let names: Vec<&str> = indices
                .filter_map(|index| labels[index].name.as_deref())
                .collect();
            if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            }
        };
        let channel = rule.name.clone();
        match candidates.as_slice() {
            [index] => Some(*index),
            [] => {
                if !partial {
                    self.problems.push(ProblemKind::NoChannel {
                        side,
                        channel,
                        found: names(&mut (0..labels.len())),
                    });
                }
                None
            }
            several => {
                let found = names(&mut several.iter().copied());
                self.problems.push(ProblemKind::AmbiguousChannel {
                    side,
                    channel,
                    found,
                });
                None
            }
        }
    }

    /// Returns the channel with its declared sign, or the sign implied by its name; reports a
    /// problem where neither gives one.
    fn signed(
        &mut self,
        used: ChannelUse,
        name: Option<&str>,
        rule: &ChannelRule,
        said: Option<f64>,
    ) -> ChannelUse {
        let of_name = || {
            let Some(name) = name else { return Some(1.0) };
            let plain = |name: &str| SignedName::of(name).name;
            let alias = rule.aliases.iter().find(|alias| *alias == name);
            let alias = alias.or_else(|| {
                rule.aliases
                    .iter()
                    .find(|alias| plain(alias) == plain(name))
            });
            sign_between(
                name,
                alias
                    .filter(|_| name != rule.name)
                    .map_or(&rule.name, |alias| alias),
            )
        };
        let Some(sign) = said.or_else(of_name) else {
            let channel = rule.name.clone();
            let found = name.unwrap_or_default().to_owned();
            self.problems.push(ProblemKind::Sign { channel, found });
            return used;
        };
        if sign > 0.0 {
            return used;
        }
        let why = match (said, name) {
            (None, Some(name)) => format!(
                "{}: turned, as its name in the file, \"{name}\", says",
                rule.name
            ),
            _ => format!("{}: turned (× -1), as is said", rule.name),
        };
        let words = used
            .words
            .into_iter()
            .chain([why])
            .collect::<Vec<_>>()
            .join("; ");
        ChannelUse {
            factor: -used.factor,
            words: Some(words),
            ..used
        }
    }

    fn used(
        &mut self,
        index: usize,
        label: &ChannelLabel,
        rule: &ChannelRule,
        declared: &DeclaredChannels<'_>,
    ) -> ChannelUse {
        if let Some(factor) = declared.channels.factors.get(&rule.name) {
            let words = Some(format!("{} × {}, as declared", rule.name, number(*factor)));
            return ChannelUse {
                index,
                factor: *factor,
                words,
            };
        }
        let of_file = label.unit.as_deref().filter(|unit| !unit.trim().is_empty());
        let of_rules = declared.channels.units.get(&rule.name).map(String::as_str);
        if let (Some(of_rules), Some(of_file)) = (of_rules, of_file)
            && of_rules != of_file
        {
            self.notes.push(format!(
                "{}: declared to be in {of_rules}, although the file says {of_file}",
                rule.name
            ));
        }
        let said = of_rules.or(of_file);
        let from = said.or(rule.unit_in_files.as_deref());
        let Some(from) = from else {
            self.problems
                .push(ProblemKind::UnitOfFile(rule.name.clone()));
            return ChannelUse {
                index,
                factor: 1.0,
                words: None,
            };
        };
        let mut conversions = declared.conversions.iter();
        let by_rule = conversions
            .find(|of| of.channel == rule.name && of.from.trim() == from.trim())
            .map(|of| of.factor);
        let Some(factor) = by_rule.or_else(|| conversion_factor(from, &rule.unit)) else {
            let channel = rule.name.clone();
            let to = rule.unit.clone();
            self.problems.push(ProblemKind::Conversion {
                channel,
                from: from.to_owned(),
                to,
            });
            return ChannelUse {
                index,
                factor: 1.0,
                words: None,
            };
        };
        let words = match (factor == 1.0, of_file) {
            (true, Some(_)) => None,
            (true, None) => Some(format!("{} taken to be in {from}", rule.name)),
            (false, _) => Some(format!("{} {from} → {} (× {factor})", rule.name, rule.unit)),
        };
        ChannelUse {
            index,
            factor,
            words,
        }
    }
}

/// Builds the problem of a measured response with no dataset channel on one side.
fn unmatched(side: ChannelSide, labels: &[ChannelLabel], rules: &[ChannelRule]) -> ProblemKind {
    let found: Vec<&str> = labels
        .iter()
        .filter_map(|label| label.name.as_deref())
        .collect();
    let known: Vec<&str> = rules.iter().map(|rule| rule.name.as_str()).collect();
    ProblemKind::ResponseUnmatched {
        side,
        found: found.join(", "),
        known: known.join(", "),
    }
}

// Names of channels, time and sample time in the spellings that files use.

/// Synonyms of each channel, folded (see [`folded_name`]); the first name of a row is canonical.
/// Names such as "elevyoke1" come from a flight simulator. A name appears in one row only.
const ALIASES: [&str; 16] = [
    "lon long longitudinal longcyc cyclong dlon deltalon dlong deltalong db deltab de deltae xb xlon b1s theta1s \
     pitchstick elevator loncyc lonstick longstick loncyclic cycliclon longitudinalcyclic longitudinalstick elevyoke1",
    "lat lateral latcyc cyclat dlat deltalat da deltaa xa xlat a1s theta1c rollstick aileron latstick latcyclic cycliclat \
     lateralcyclic lateralstick ailrnyoke1",
    "ped pedal pedals dped deltaped dp deltap dr deltar xp xped thetatr thetat rudder tailrotor yawpedal ruddryoke1",
    "col coll collective dcol deltacol dcoll dc deltac xc xcol theta0 theta0m",
    "p rollrate pb pbody omegax",
    "q pitchrate qb qbody omegay",
    "r yawrate rb rbody omegaz",
    "nx ax axb longitudinalacceleration longaccel accx gloadaxial",
    "ny ay ayb lateralacceleration lataccel accy gloadside",
    "nz az azb verticalacceleration vertaccel normalacceleration loadfactor accz gloadnorml",
    "u ub ubody forwardspeed",
    "v vb vbody sidewardspeed sidespeed",
    "w wb wbody heave verticalspeed heavevelocity",
    "phi roll rollangle rollattitude bank bankangle",
    "theta pitch pitchangle pitchattitude",
    "psi yaw heading yawangle",
];

/// Number of leading rows with names of inputs.
pub(super) const FIELD_INPUTS: usize = 4;

/// Returns the folded names of each channel known in the field.
pub(super) fn field_names() -> impl Iterator<Item = std::str::Split<'static, char>> {
    ALIASES.iter().map(|row| row.split(' '))
}

/// Folds a name: no case, marks or blanks, Greek letters spelt out. "δ_a" becomes "deltaa",
/// "Sample_Time" becomes "sampletime".
pub fn folded_name(name: &str) -> String {
    let mut words = String::with_capacity(name.len());
    for letter in name.chars().flat_map(char::to_lowercase) {
        match letter {
            'δ' | 'Δ' => words.push_str("delta"),
            'θ' | 'ϑ' => words.push_str("theta"),
            'φ' | 'ϕ' => words.push_str("phi"),
            'ψ' => words.push_str("psi"),
            'ω' => words.push_str("omega"),
            letter if letter.is_alphanumeric() => words.push(letter),
            _ => {}
        }
    }
    words
}

/// Returns the canonical name of a channel.
pub(super) fn canonical(name: &str) -> String {
    let name = folded_name(name);
    let first = field_names()
        .find(|row| row.clone().any(|other| other == name))
        .and_then(|mut row| row.next());
    first.map_or_else(|| name.clone(), str::to_owned)
}

/// Returns whether two names denote the same channel: equal but for case and marks, or synonyms in
/// the field.
pub fn same_channel(a: &str, b: &str) -> bool {
    a == b || canonical(a) == canonical(b)
}

/// Names of the acceleration along the z axis, which points down in some programs and up in others;
/// and names of the load factor, which is positive up.
const ALONG_Z: [&str; 5] = ["az", "azb", "accz", "verticalacceleration", "vertaccel"];
const LOAD_FACTOR: [&str; 4] = ["nz", "loadfactor", "normalacceleration", "gloadnorml"];

/// A name and its sign marks: `-az`, `az (down)`, `az[+down]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SignedName {
    pub name: String,
    /// Whether a minus precedes it.
    pub minus: bool,
    /// 1 where declared positive up, right or forward, -1 for the opposite direction.
    pub direction: Option<f64>,
}

impl SignedName {
    /// Parses the sign marks of a name.
    pub fn of(text: &str) -> Self {
        let text = text.trim();
        let begins_name = |rest: &str| {
            rest.trim_start()
                .starts_with(|letter: char| letter.is_alphabetic() || letter == '#')
        };
        let (minus, rest) = match text
            .strip_prefix(['-', '\u{2212}'])
            .filter(|rest| begins_name(rest))
        {
            Some(rest) => (true, rest.trim_start()),
            None => (
                false,
                text.strip_prefix('+')
                    .filter(|rest| begins_name(rest))
                    .unwrap_or(text),
            ),
        };
        let marked = [('(', ')'), ('[', ']'), ('{', '}')]
            .into_iter()
            .find_map(|(open, close)| {
                let (name, mark) = rest.strip_suffix(close)?.rsplit_once(open)?;
                Some((name.trim(), direction_of(mark)?))
            });
        let (name, direction) = match marked.filter(|(name, _)| !name.is_empty()) {
            Some((name, direction)) => (name, Some(direction)),
            None => (rest, None),
        };
        Self {
            name: name.to_owned(),
            minus,
            direction,
        }
    }

    /// Returns the declared direction, or the one implied by the name.
    fn known_direction(&self) -> Option<f64> {
        self.direction.or(LOAD_FACTOR
            .contains(&folded_name(&self.name).as_str())
            .then_some(1.0))
    }
}

/// Parses a direction mark such as "down", "+down", "positive down", "-up": 1 where positive up,
/// right or forward, -1 for the opposite direction.
pub fn direction_of(mark: &str) -> Option<f64> {
    let mark = mark.trim().to_lowercase();
    let (sign, word) = match mark.strip_prefix(['-', '\u{2212}']) {
        Some(word) => (-1.0, word),
        None => (1.0, mark.trim_start_matches('+')),
    };
    let word = word
        .trim()
        .trim_start_matches("positive")
        .trim_start_matches("pos")
        .trim_start_matches(['.', ' ']);
    let word = word
        .trim_end_matches("positive")
        .trim_end_matches('+')
        .trim();
    match word {
        "up" | "right" | "forward" | "fwd" => Some(sign),
        "down" | "dn" | "left" | "aft" | "rearward" => Some(-sign),
        _ => None,
    }
}

/// Returns the factor, 1 or -1, from a file channel `label` to a dataset channel `channel`; `None`
/// where the names leave it open.
///
/// A minus is the sign. Where one direction is given, the other must be known too: a load factor is
/// positive up. `az` and `NZ` are the same but for a sign that neither gives.
pub fn sign_between(label: &str, channel: &str) -> Option<f64> {
    if label.trim() == channel.trim() {
        return Some(1.0);
    }
    let of_label = SignedName::of(label);
    let of_channel = SignedName::of(channel);
    let minus = if of_label.minus == of_channel.minus {
        1.0
    } else {
        -1.0
    };
    match (of_label.direction, of_channel.direction) {
        (None, None) => {
            let family = |name: &SignedName| {
                let name = folded_name(&name.name);
                (
                    ALONG_Z.contains(&name.as_str()),
                    LOAD_FACTOR.contains(&name.as_str()),
                )
            };
            let is_open = matches!(
                (family(&of_label), family(&of_channel)),
                ((true, _), (_, true)) | ((_, true), (true, _))
            );
            (!is_open || of_label.minus || of_channel.minus).then_some(minus)
        }
        _ => Some(minus * of_label.known_direction()? * of_channel.known_direction()?),
    }
}

/// Usual names of the sample time \[s\].
pub const SAMPLE_TIME_NAMES: [&str; 7] = [
    "Ts",
    "dt",
    "tsam",
    "sample_time_s",
    "sample_time",
    "sampling_time",
    "Tsample",
];

/// Ranks how likely a name denotes the time of samples, 0 the most likely; `None` where it does
/// not. A trailing unit of time does not change the rank: `time_s`, `t [ms]`.
pub fn time_name_rank(name: &str) -> Option<u8> {
    let words: Vec<String> = name
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect();
    let mut words: Vec<&str> = words.iter().map(String::as_str).collect();
    let is_time = |unit: PhysicalUnit| unit.dimension == Dimension::Time;
    if words.len() > 1
        && words
            .last()
            .is_some_and(|word| PhysicalUnit::of(word).is_some_and(is_time))
    {
        words.pop();
    }
    match words.concat().as_str() {
        "time" | "t" | "times" => Some(0),
        "tout" | "timestamp" | "timestamps" | "elapsed" | "seconds" | "tsec" | "timesec"
        | "zeit" | "temps" | "tempo" => Some(1),
        _ => words
            .iter()
            .any(|word| matches!(*word, "time" | "timestamp"))
            .then_some(2),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::assembly::declarations::ChannelDeclarations;
    use crate::assembly::rules::UnitRule;

    /// Matches the channels of one side under rules without other declarations.
    fn matched(
        side: ChannelSide,
        labels: &[ChannelLabel],
        rules: &[ChannelRule],
        partial: bool,
    ) -> ChannelMatch {
        ChannelMatch::of(side, labels, rules, &DeclaredChannels::default(), partial)
    }

    fn rule(name: &str, unit: &str) -> ChannelRule {
        ChannelRule {
            unit: unit.to_owned(),
            ..ChannelRule::named(name)
        }
    }

    fn label(name: &str, unit: &str) -> ChannelLabel {
        ChannelLabel {
            name: Some(name.to_owned()),
            unit: Some(unit.to_owned()).filter(|unit| !unit.is_empty()),
        }
    }

    #[test]
    fn channels_are_found_by_name_in_whatever_order_and_converted() {
        let rules = [rule("P", "deg/s"), rule("NZ", "m/s^2")];
        let labels = [
            label("nz", "g"),
            label("roll rate", "rad/s"),
            label("q", "rad/s"),
        ];
        let found = matched(ChannelSide::Output, &labels, &rules, false);
        assert!(found.problems.is_empty(), "{:?}", found.problems);
        let uses: Vec<(usize, f64)> = found
            .uses
            .iter()
            .flatten()
            .map(|used| (used.index, used.factor))
            .collect();
        assert_eq!(uses, [(1, 180.0 / std::f64::consts::PI), (0, 9.806_65)]);
    }

    #[test]
    fn a_unit_that_is_not_said_is_asked_for_and_never_guessed() {
        let rules = [rule("LON", "%")];
        let found = matched(ChannelSide::Input, &[label("lon", "")], &rules, false);
        assert_eq!(found.problems, [ProblemKind::UnitOfFile("LON".into())]);
        let said = [ChannelRule {
            unit_in_files: Some("in".into()),
            ..rule("LON", "%")
        }];
        let found = matched(ChannelSide::Input, &[label("lon", "")], &said, false);
        assert!(matches!(
            &found.problems[..],
            [ProblemKind::Conversion { .. }]
        ));
        let factor = UnitRule {
            channel: "LON".into(),
            from: "in".into(),
            factor: 8.5,
        };
        let declared = DeclaredChannels {
            conversions: &[factor],
            ..DeclaredChannels::default()
        };
        let found = ChannelMatch::of(
            ChannelSide::Input,
            &[label("lon", "")],
            &said,
            &declared,
            false,
        );
        assert_eq!(found.uses[0].as_ref().map(|used| used.factor), Some(8.5));
    }

    #[test]
    fn channels_without_names_are_taken_in_order_only_if_there_are_as_many() {
        let rules = [rule("LON", "%"), rule("LAT", "%")];
        let unnamed = |count| {
            vec![
                ChannelLabel {
                    name: None,
                    unit: Some("%".into())
                };
                count
            ]
        };
        let found = matched(ChannelSide::Input, &unnamed(2), &rules, false);
        assert!(found.problems.is_empty() && found.by_position);
        let found = matched(ChannelSide::Input, &unnamed(3), &rules, false);
        assert_eq!(
            found.problems,
            [ProblemKind::Unnamed {
                side: ChannelSide::Input,
                expected: 2,
                found: 3
            }]
        );
    }

    #[test]
    fn two_channels_that_can_be_the_same_are_asked_about_unless_one_has_the_very_name() {
        let rules = [rule("P", "deg/s")];
        let both = [label("p", "deg/s"), label("roll rate", "deg/s")];
        let found = matched(ChannelSide::Output, &both, &rules, false);
        assert!(matches!(
            &found.problems[..],
            [ProblemKind::AmbiguousChannel { .. }]
        ));
        let exact = [label("P", "deg/s"), label("roll rate", "deg/s")];
        assert!(
            matched(ChannelSide::Output, &exact, &rules, false)
                .problems
                .is_empty()
        );
    }

    #[test]
    fn the_sign_is_that_of_the_mark_or_is_said_or_asked_for() {
        let rules = [
            rule("NZ", "m/s2"),
            ChannelRule {
                aliases: vec!["-yaw".into()],
                ..rule("R", "deg/s")
            },
        ];
        let factors = |name: &str, said: &[(&str, f64)]| {
            let labels = [label(name, "m/s2"), label("yaw", "deg/s")];
            let signs = said
                .iter()
                .map(|(name, sign)| ((*name).to_owned(), *sign))
                .collect();
            let channels = ChannelDeclarations {
                signs,
                ..ChannelDeclarations::default()
            };
            let declared = DeclaredChannels {
                channels,
                ..DeclaredChannels::default()
            };
            let found = ChannelMatch::of(ChannelSide::Output, &labels, &rules, &declared, false);
            (
                found
                    .uses
                    .iter()
                    .flatten()
                    .map(|used| used.factor)
                    .collect::<Vec<_>>(),
                found.problems,
            )
        };
        let asked = ProblemKind::Sign {
            channel: "NZ".into(),
            found: "az".into(),
        };
        assert_eq!(factors("az", &[]), (vec![1.0, -1.0], vec![asked]));
        assert_eq!(
            factors("az", &[("NZ", -1.0), ("R", 1.0)]),
            (vec![-1.0, 1.0], vec![])
        );
        assert_eq!(factors("-az", &[]), (vec![-1.0, -1.0], vec![]));
        assert_eq!(factors("nz (down)", &[]), (vec![-1.0, -1.0], vec![]));
        assert_eq!(factors("NZ", &[]), (vec![1.0, -1.0], vec![]));
    }

    #[test]
    fn a_declared_unit_or_factor_goes_before_the_file_s_and_a_factor_is_all_that_is_done() {
        let rules = [ChannelRule {
            unit_in_files: Some("deg/s".into()),
            ..rule("R", "deg/s")
        }];
        let factor_of = |label: ChannelLabel, channels: ChannelDeclarations| {
            let declared = DeclaredChannels {
                channels,
                ..DeclaredChannels::default()
            };
            let found = ChannelMatch::of(ChannelSide::Output, &[label], &rules, &declared, false);
            assert!(found.problems.is_empty(), "{:?}", found.problems);
            found.uses[0].as_ref().map(|used| used.factor)
        };
        let unit = |unit: &str| ChannelDeclarations {
            units: [("R".to_owned(), unit.to_owned())].into(),
            ..ChannelDeclarations::default()
        };
        let factor = |factor: f64, sign: Option<f64>| ChannelDeclarations {
            factors: [("R".to_owned(), factor)].into(),
            signs: sign
                .map(|sign| ("R".to_owned(), sign))
                .into_iter()
                .collect(),
            ..ChannelDeclarations::default()
        };
        let per_radian = Some(180.0 / std::f64::consts::PI);
        assert_eq!(
            factor_of(label("r", ""), ChannelDeclarations::default()),
            Some(1.0)
        );
        assert_eq!(factor_of(label("r", ""), unit("rad/s")), per_radian);
        assert_eq!(factor_of(label("r", "deg/s"), unit("rad/s")), per_radian);
        assert_eq!(
            factor_of(label("-r", "rad/s"), factor(25.0, None)),
            Some(25.0),
            "the factor has the sign"
        );
        assert_eq!(
            factor_of(label("r", "rad/s"), factor(25.0, Some(-1.0))),
            Some(-25.0)
        );
    }

    #[test]
    fn a_response_whose_channels_match_nothing_is_a_problem_and_one_that_lacks_some_is_none() {
        let rules = [rule("LON", "%"), rule("LAT", "%")];
        let part = matched(
            ChannelSide::Input,
            &[label("lat", "%"), label("latt", "%")],
            &rules,
            true,
        );
        assert!(part.problems.is_empty(), "{:?}", part.problems);
        assert_eq!(
            part.notes,
            ["inputs of the file that the dataset does not have: latt"]
        );
        for labels in [
            vec![label("delta", "%"), label("run2", "%")],
            vec![ChannelLabel::default()],
        ] {
            let nothing = matched(ChannelSide::Input, &labels, &rules, true);
            assert!(
                matches!(
                    &nothing.problems[..],
                    [ProblemKind::ResponseUnmatched { .. }]
                ),
                "{labels:?}"
            );
        }
    }

    #[test]
    fn the_time_is_known_by_its_name_with_or_without_marks_and_unit() {
        let ranks = [
            ("t [ms]", 0),
            ("Time_s", 0),
            ("time_stamps", 1),
            ("t_out", 1),
            ("real,_time", 2),
        ];
        for (name, rank) in ranks {
            assert_eq!(time_name_rank(name), Some(rank), "{name}");
        }
        assert!(
            ["theta", "Ts", "tail rotor"]
                .iter()
                .all(|name| time_name_rank(name).is_none())
        );
    }

    #[test]
    fn the_names_of_the_field_are_one_another() {
        for (a, b) in [
            ("LAT", "δ_a"),
            ("lat", "Xa"),
            ("P", "roll rate"),
            ("q", "Pitch_Rate"),
            ("PED", "pedals"),
            ("NZ", "az"),
        ] {
            assert!(same_channel(a, b), "{a} {b}");
        }
        for (a, b) in [
            ("LON", "LAT"),
            ("P", "PED"),
            ("roll", "roll rate"),
            ("P", "Q"),
        ] {
            assert!(!same_channel(a, b), "{a} {b}");
        }
    }

    #[test]
    fn a_mark_in_a_name_is_the_sign_and_is_never_dropped() {
        for (label, channel, sign) in [
            ("R", "R", Some(1.0)),
            ("-R", "R", Some(-1.0)),
            ("\u{2212}yaw rate", "R", Some(-1.0)),
            ("-az", "NZ", Some(-1.0)),
            ("az (down)", "NZ", Some(-1.0)),
            ("az[+down]", "NZ", Some(-1.0)),
            ("az (positive up)", "NZ", Some(1.0)),
            ("az [-up]", "NZ", Some(-1.0)),
            ("NZ", "nz", Some(1.0)),
            ("az", "NZ", None),
            ("w (down)", "W", None),
            ("w (down)", "W (up)", Some(-1.0)),
        ] {
            assert_eq!(sign_between(label, channel), sign, "{label} as {channel}");
        }
        assert_eq!(SignedName::of("-az").name, "az");
        assert_eq!(
            SignedName::of("az (g)").name,
            "az (g)",
            "a unit is no direction"
        );
    }

    #[test]
    fn no_name_stands_for_two_channels() {
        let names: Vec<&str> = ALIASES.iter().flat_map(|row| row.split(' ')).collect();
        let unique: BTreeSet<&str> = names.iter().copied().collect();
        assert_eq!(unique.len(), names.len());
        assert!(
            names.iter().all(|name| folded_name(name) == **name),
            "they are folded"
        );
    }
}
