//! Which channel of a file is which of the dataset, and what its numbers are multiplied by.

use std::collections::BTreeMap;

use super::{
    ChannelLabel, ChannelRule, ProblemKind, SignedName, UnitRule, conversion_factor, same_channel, sign_between,
};

/// A channel of the file that becomes one of the dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelUse {
    /// Index in the file.
    pub index: usize,
    /// How many of the dataset's units one of the file's is; below zero where the file has the other sign.
    pub factor: f64,
    /// The conversion in words, where there is one: "rad/s → deg/s"; or that the unit was said for all files.
    pub words: Option<String>,
}

/// The channels of one side of a model, in the dataset's order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChannelMatch {
    /// One for each channel of the dataset; none where it is missing.
    pub uses: Vec<Option<ChannelUse>>,
    /// What is missing or not clear.
    pub problems: Vec<ProblemKind>,
    /// What was taken without a word in the file, such as the order of channels without names.
    pub notes: Vec<String>,
}

impl ChannelMatch {
    /// Matches the channels of one side; `side` is "input" or "output", `said` the signs that are said of channels, `partial` lets
    /// channels be missing.
    pub fn of(
        side: &'static str,
        labels: &[ChannelLabel],
        rules: &[ChannelRule],
        (units, said): (&[UnitRule], &BTreeMap<String, f64>),
        partial: bool,
    ) -> Self {
        let mut found = Self::default();
        let unnamed = !labels.is_empty() && labels.iter().all(|label| label.name.is_none());
        if unnamed && labels.len() != rules.len() {
            let (expected, count) = (rules.len(), labels.len());
            found.problems.push(ProblemKind::Unnamed { side, expected, found: count });
            found.uses = vec![None; rules.len()];
            return found;
        }
        if unnamed {
            found.notes.push(format!("{side}s have no names in the file: taken in the order of the dataset"));
        }
        for (place, rule) in rules.iter().enumerate() {
            let index = if unnamed { Some(place) } else { found.find(side, labels, rule, partial) };
            let used = index.map(|index| {
                let used = found.used(index, &labels[index], rule, units);
                found.signed(used, labels[index].name.as_deref(), rule, said.get(&rule.name).copied())
            });
            found.uses.push(used);
        }
        found
    }

    /// The channel of the file that is `rule`'s: of its very name, or else one that the field, or the rule, calls the same.
    fn find(
        &mut self,
        side: &'static str,
        labels: &[ChannelLabel],
        rule: &ChannelRule,
        partial: bool,
    ) -> Option<usize> {
        let named = |is_it: &dyn Fn(&str) -> bool| -> Vec<usize> {
            let indices = labels.iter().enumerate();
            indices.filter(|(_, label)| label.name.as_deref().is_some_and(is_it)).map(|(index, _)| index).collect()
        };
        let is_alias = |is_it: &dyn Fn(&str) -> bool| rule.aliases.iter().any(|alias| is_it(alias));
        let plain = |name: &str| SignedName::of(name).name;
        // The very name goes before one with marks of a sign, and that before what the field calls the same.
        let ways: [&dyn Fn(&str) -> bool; 4] = [
            &|name| name == rule.name,
            &|name| is_alias(&|alias| alias == name),
            &|name| plain(name) == plain(&rule.name) || is_alias(&|alias| plain(alias) == plain(name)),
            &|name| {
                same_channel(&plain(name), &plain(&rule.name))
                    || is_alias(&|alias| same_channel(&plain(name), &plain(alias)))
            },
        ];
        let candidates = ways.into_iter().map(named).find(|found| !found.is_empty()).unwrap_or_default();
        let names = |indices: &mut dyn Iterator<Item = usize>| {
            let names: Vec<&str> = indices.filter_map(|index| labels[index].name.as_deref()).collect();
            if names.is_empty() { "none".to_owned() } else { names.join(", ") }
        };
        let channel = rule.name.clone();
        match candidates.as_slice() {
            [index] => Some(*index),
            [] => {
                if !partial {
                    self.problems.push(ProblemKind::NoChannel { side, channel, found: names(&mut (0..labels.len())) });
                }
                None
            }
            several => {
                let found = names(&mut several.iter().copied());
                self.problems.push(ProblemKind::AmbiguousChannel { side, channel, found });
                None
            }
        }
    }

    /// The channel with the sign that is said, or that its name says; where neither says it, it is asked.
    fn signed(&mut self, used: ChannelUse, name: Option<&str>, rule: &ChannelRule, said: Option<f64>) -> ChannelUse {
        let of_name = || {
            let Some(name) = name else { return Some(1.0) };
            let plain = |name: &str| SignedName::of(name).name;
            let alias = rule.aliases.iter().find(|alias| *alias == name);
            let alias = alias.or_else(|| rule.aliases.iter().find(|alias| plain(alias) == plain(name)));
            sign_between(name, alias.filter(|_| name != rule.name).map_or(&rule.name, |alias| alias))
        };
        let Some(sign) = said.or_else(of_name) else {
            let (channel, found) = (rule.name.clone(), name.unwrap_or_default().to_owned());
            self.problems.push(ProblemKind::Sign { channel, found });
            return used;
        };
        if sign > 0.0 {
            return used;
        }
        let why = match (said, name) {
            (None, Some(name)) => format!("{}: turned, as its name in the file, \"{name}\", says", rule.name),
            _ => format!("{}: turned (× -1), as is said", rule.name),
        };
        let words = used.words.into_iter().chain([why]).collect::<Vec<_>>().join("; ");
        ChannelUse { factor: -used.factor, words: Some(words), ..used }
    }

    fn used(&mut self, index: usize, label: &ChannelLabel, rule: &ChannelRule, units: &[UnitRule]) -> ChannelUse {
        let said = label.unit.as_deref().filter(|unit| !unit.trim().is_empty());
        let from = said.or(rule.unit_in_files.as_deref());
        let Some(from) = from else {
            self.problems.push(ProblemKind::UnitOfFile { channel: rule.name.clone() });
            return ChannelUse { index, factor: 1.0, words: None };
        };
        let by_rule =
            units.iter().find(|of| of.channel == rule.name && of.from.trim() == from.trim()).map(|of| of.factor);
        let Some(factor) = by_rule.or_else(|| conversion_factor(from, &rule.unit)) else {
            let (channel, to) = (rule.name.clone(), rule.unit.clone());
            self.problems.push(ProblemKind::Conversion { channel, from: from.to_owned(), to });
            return ChannelUse { index, factor: 1.0, words: None };
        };
        let words = match (factor == 1.0, said) {
            (true, Some(_)) => None,
            (true, None) => Some(format!("{} taken to be in {from}", rule.name)),
            (false, _) => Some(format!("{} {from} → {} (× {factor})", rule.name, rule.unit)),
        };
        ChannelUse { index, factor, words }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn none() -> BTreeMap<String, f64> {
        BTreeMap::new()
    }

    fn rule(name: &str, unit: &str) -> ChannelRule {
        ChannelRule { unit: unit.to_owned(), ..ChannelRule::named(name) }
    }

    fn label(name: &str, unit: &str) -> ChannelLabel {
        ChannelLabel { name: Some(name.to_owned()), unit: Some(unit.to_owned()).filter(|unit| !unit.is_empty()) }
    }

    #[test]
    fn channels_are_found_by_name_in_whatever_order_and_converted() {
        let rules = [rule("P", "deg/s"), rule("NZ", "m/s^2")];
        let labels = [label("nz", "g"), label("roll rate", "rad/s"), label("q", "rad/s")];
        let found = ChannelMatch::of("output", &labels, &rules, (&[], &none()), false);
        assert!(found.problems.is_empty(), "{:?}", found.problems);
        let uses: Vec<(usize, f64)> = found.uses.iter().flatten().map(|used| (used.index, used.factor)).collect();
        assert_eq!(uses, [(1, 180.0 / std::f64::consts::PI), (0, 9.806_65)]);
    }

    #[test]
    fn a_unit_that_is_not_said_is_asked_for_and_never_guessed() {
        let rules = [rule("LON", "%")];
        let found = ChannelMatch::of("input", &[label("lon", "")], &rules, (&[], &none()), false);
        assert_eq!(found.problems, [ProblemKind::UnitOfFile { channel: "LON".into() }]);
        let said = [ChannelRule { unit_in_files: Some("in".into()), ..rule("LON", "%") }];
        let found = ChannelMatch::of("input", &[label("lon", "")], &said, (&[], &none()), false);
        assert!(matches!(&found.problems[..], [ProblemKind::Conversion { .. }]));
        let factor = UnitRule { channel: "LON".into(), from: "in".into(), factor: 8.5 };
        let found = ChannelMatch::of("input", &[label("lon", "")], &said, (&[factor], &none()), false);
        assert_eq!(found.uses[0].as_ref().map(|used| used.factor), Some(8.5));
    }

    #[test]
    fn channels_without_names_are_taken_in_order_only_if_there_are_as_many() {
        let rules = [rule("LON", "%"), rule("LAT", "%")];
        let unnamed = |count| vec![ChannelLabel { name: None, unit: Some("%".into()) }; count];
        let found = ChannelMatch::of("input", &unnamed(2), &rules, (&[], &none()), false);
        assert!(found.problems.is_empty() && found.notes.len() == 1);
        let found = ChannelMatch::of("input", &unnamed(3), &rules, (&[], &none()), false);
        assert_eq!(found.problems, [ProblemKind::Unnamed { side: "input", expected: 2, found: 3 }]);
    }

    #[test]
    fn two_channels_that_can_be_the_same_are_asked_about_unless_one_has_the_very_name() {
        let rules = [rule("P", "deg/s")];
        let both = [label("p", "deg/s"), label("roll rate", "deg/s")];
        let found = ChannelMatch::of("output", &both, &rules, (&[], &none()), false);
        assert!(matches!(&found.problems[..], [ProblemKind::AmbiguousChannel { .. }]));
        let exact = [label("P", "deg/s"), label("roll rate", "deg/s")];
        assert!(ChannelMatch::of("output", &exact, &rules, (&[], &none()), false).problems.is_empty());
    }

    #[test]
    fn the_sign_is_that_of_the_mark_or_is_said_or_asked_for() {
        let rules = [rule("NZ", "m/s2"), ChannelRule { aliases: vec!["-yaw".into()], ..rule("R", "deg/s") }];
        let factors = |name: &str, said: &[(&str, f64)]| {
            let labels = [label(name, "m/s2"), label("yaw", "deg/s")];
            let said = said.iter().map(|(name, sign)| ((*name).to_owned(), *sign)).collect();
            let found = ChannelMatch::of("output", &labels, &rules, (&[], &said), false);
            (found.uses.iter().flatten().map(|used| used.factor).collect::<Vec<_>>(), found.problems)
        };
        let asked = ProblemKind::Sign { channel: "NZ".into(), found: "az".into() };
        assert_eq!(factors("az", &[]), (vec![1.0, -1.0], vec![asked]));
        assert_eq!(factors("az", &[("NZ", -1.0), ("R", 1.0)]), (vec![-1.0, 1.0], vec![]));
        assert_eq!(factors("-az", &[]), (vec![-1.0, -1.0], vec![]));
        assert_eq!(factors("nz (down)", &[]), (vec![-1.0, -1.0], vec![]));
        assert_eq!(factors("NZ", &[]), (vec![1.0, -1.0], vec![]));
    }
}
