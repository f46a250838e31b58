//! Matches file channels to dataset channels, and determines the factors between them.
//!
//! A *file channel* has the name and the unit given in a model file ([`ChannelLabel`]); a *dataset
//! channel* has a name, aliases and a unit, from the engineer's rules ([`ChannelRule`]). *Declared*
//! units, factors and signs are entered by the engineer too; they override the file.

use super::channel_note::ChannelNote;
use super::declarations::ModelDeclarations;
use super::found_model::ChannelLabel;
use super::name_likeness::{Likeness, matched_name};
use super::problem::ProblemKind;
use crate::dataset::channel::ChannelSide;
use crate::names::ChannelRule;
use crate::names::signed_name::sign_between;
use crate::number_format::number;
use crate::units::physical_unit::conversion_factor;

/// A file channel matched to a dataset channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelUse {
    /// The channel's index in the file.
    pub index: usize,
    /// Dataset units per file unit; negative if the file has the opposite sign.
    pub factor: f64,
    /// Conversion ("rad/s → deg/s"), declared factor, assumed unit and reversed sign in words, as
    /// far as they apply; `None` if none does.
    pub words: Option<String>,
}

/// A model's matched inputs or outputs, in the dataset's order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChannelMatch {
    /// One entry per dataset channel; `None` if the model lacks the channel.
    pub uses: Vec<Option<ChannelUse>>,
    pub problems: Vec<ProblemKind>,
    /// Remarks for the engineer to review: overridden units, and file channels that match no
    /// dataset channel.
    pub notes: Vec<ChannelNote>,
    /// Whether no channel has a name (from the file, its name or the rules), so that the channels
    /// were matched by position.
    pub by_position: bool,
}

/// Data for matching one side of a model, its inputs or its outputs.
#[derive(Clone, Copy)]
pub(super) struct ChannelMatcher<'a> {
    pub side: ChannelSide,
    /// The model's channels on this side, in the file's order.
    pub labels: &'a [ChannelLabel],
    /// The dataset's channels on this side.
    pub rules: &'a [ChannelRule],
    pub declared: &'a ModelDeclarations<'a>,
    /// Whether channels may be missing, as in a measured response; at least one must be found.
    pub partial: bool,
}

impl ChannelMatcher<'_> {
    /// Matches the channels on one side.
    ///
    /// 1. If the file names no channel, match by position; exit with a problem if the counts
    ///    differ.
    /// 2. Otherwise, find the file channel for each dataset channel by name: the same name first,
    ///    then an alias, then either of them apart from sign marks, then any known alias.
    /// 3. Determine its unit factor from declarations and units.
    /// 4. Determine its sign from declarations and names.
    /// 5. Note the named file channels that no dataset channel uses.
    /// 6. Report a problem if a measured response has none of the dataset's channels.
    ///
    /// Two dataset channels that match the same file channel both use it.
    pub(super) fn run(self) -> ChannelMatch {
        let mut matched = ChannelMatch {
            by_position: !self.labels.is_empty()
                && self.labels.iter().all(|label| label.name.is_none()),
            ..ChannelMatch::default()
        };
        // Step 1.
        if matched.by_position && self.labels.len() != self.rules.len() {
            return self.wrong_count();
        }
        for (position, rule) in self.rules.iter().enumerate() {
            // Steps 1 and 2.
            let index = if matched.by_position {
                Some(position)
            } else {
                self.find(rule, &mut matched.problems)
            };
            // Steps 3 and 4.
            let used = index.map(|index| {
                let used = self.converted(index, rule, &mut matched);
                self.signed(used, rule, &mut matched.problems)
            });
            matched.uses.push(used);
        }
        // Step 5.
        self.note_unused(&mut matched);
        // Step 6.
        if self.partial && matched.problems.is_empty() && matched.uses.iter().all(Option::is_none) {
            matched.problems.push(self.unmatched());
        }
        matched
    }

    /// Returns the result for unnamed channels whose count differs from the dataset's.
    fn wrong_count(&self) -> ChannelMatch {
        let problem = if self.partial {
            self.unmatched()
        } else {
            ProblemKind::Unnamed {
                side: self.side,
                expected: self.rules.len(),
                found: self.labels.len(),
            }
        };
        ChannelMatch {
            uses: vec![None; self.rules.len()],
            problems: vec![problem],
            ..ChannelMatch::default()
        }
    }

    /// Returns the index of the file channel for a dataset channel; `None` with a problem if it is
    /// ambiguous, or missing although it is required.
    fn find(&self, rule: &ChannelRule, problems: &mut Vec<ProblemKind>) -> Option<usize> {
        let candidates = self.candidates(rule);
        match candidates.as_slice() {
            [index] => Some(*index),
            [] => {
                if !self.partial {
                    let every: Vec<usize> = (0..self.labels.len()).collect();
                    problems.push(ProblemKind::NoChannel {
                        side: self.side,
                        channel: rule.name.clone(),
                        found: self.list_names(&every),
                    });
                }
                None
            }
            several => {
                problems.push(ProblemKind::AmbiguousChannel {
                    side: self.side,
                    channel: rule.name.clone(),
                    found: self.list_names(several),
                });
                None
            }
        }
    }

    /// Returns the file channels with the closest likeness in name; empty if no name is like the
    /// channel's.
    fn candidates(&self, rule: &ChannelRule) -> Vec<usize> {
        for likeness in Likeness::CLOSEST_FIRST {
            let mut candidates = Vec::new();
            for (index, label) in self.labels.iter().enumerate() {
                if let Some(name) = &label.name
                    && likeness.holds(name, rule)
                {
                    candidates.push(index);
                }
            }
            if !candidates.is_empty() {
                return candidates;
            }
        }
        Vec::new()
    }

    /// Lists file channel names; "none" if they have no names.
    fn list_names(&self, indices: &[usize]) -> String {
        let names: Vec<&str> = indices
            .iter()
            .filter_map(|index| self.labels[*index].name.as_deref())
            .collect();
        if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        }
    }

    /// Returns the channel with its unit factor.
    ///
    /// 1. The declared factor, if there is one; no unit is then read.
    /// 2. Otherwise, the unit: declared, or else in the file (with a note if both exist and
    ///    differ), or else the rule's unit for files; a problem without any.
    /// 3. The factor from this unit to the dataset's: the declared conversion for these units, or
    ///    else the factor between physical units; a problem without any.
    fn converted(
        &self,
        index: usize,
        rule: &ChannelRule,
        matched: &mut ChannelMatch,
    ) -> ChannelUse {
        let mut used = ChannelUse {
            index,
            factor: 1.0,
            words: None,
        };
        if let Some(factor) = self.declared.channels.factors.get(&rule.name) {
            used.factor = *factor;
            used.words = Some(format!("{} × {}, as declared", rule.name, number(*factor)));
            return used;
        }
        let declared_unit = self.declared.channels.units.get(&rule.name);
        let file_unit = self.labels[index]
            .unit
            .as_ref()
            .filter(|unit| !unit.trim().is_empty());
        if let Some(declared_unit) = declared_unit
            && let Some(file_unit) = file_unit
            && declared_unit != file_unit
        {
            matched.notes.push(ChannelNote::UnitReplaced {
                channel: rule.name.clone(),
                declared: declared_unit.clone(),
                found: file_unit.clone(),
            });
        }
        let unit = declared_unit.or(file_unit).or(rule.unit_in_files.as_ref());
        let Some(unit) = unit else {
            matched
                .problems
                .push(ProblemKind::UnitOfFile(rule.name.clone()));
            return used;
        };
        let factor = match self.declared.conversion(&rule.name, unit) {
            Some(factor) => Some(factor),
            None => conversion_factor(unit, &rule.unit),
        };
        let Some(factor) = factor else {
            matched.problems.push(ProblemKind::Conversion {
                channel: rule.name.clone(),
                from: unit.clone(),
                to: rule.unit.clone(),
            });
            return used;
        };
        used.factor = factor;
        if factor != 1.0 {
            used.words = Some(format!("{} {unit} → {} (× {factor})", rule.name, rule.unit));
        } else if file_unit.is_none() {
            used.words = Some(format!(
                "{}: unit {unit}, since the file gives none",
                rule.name
            ));
        }
        used
    }

    /// Returns the channel with its sign: first the declared sign, or 1 with a declared factor,
    /// which includes the sign; else the sign implied by the name in the file; else, for an unnamed
    /// channel, 1. Adds a problem if the name leaves the sign open.
    fn signed(
        &self,
        used: ChannelUse,
        rule: &ChannelRule,
        problems: &mut Vec<ProblemKind>,
    ) -> ChannelUse {
        let declared = self.declared.sign_of(&rule.name);
        let name = self.labels[used.index].name.as_deref();
        let sign = match (declared, name) {
            (Some(sign), _) => Some(sign),
            (None, Some(name)) => sign_between(name, matched_name(name, rule)),
            (None, None) => Some(1.0),
        };
        let Some(sign) = sign else {
            problems.push(ProblemKind::Sign {
                channel: rule.name.clone(),
                found: name.unwrap_or_default().to_owned(),
            });
            return used;
        };
        if sign > 0.0 {
            return used;
        }
        let note = match (declared, name) {
            (None, Some(name)) => {
                format!(
                    "{}: sign reversed, because of its name \"{name}\"",
                    rule.name
                )
            }
            _ => format!("{}: sign reversed (× -1), as declared", rule.name),
        };
        let words = match used.words {
            Some(words) => format!("{words}; {note}"),
            None => note,
        };
        ChannelUse {
            index: used.index,
            factor: -used.factor,
            words: Some(words),
        }
    }

    /// Adds a note about the named file channels that no dataset channel uses; none if there are
    /// problems, since these channels may then be the missing ones.
    fn note_unused(&self, matched: &mut ChannelMatch) {
        let mut unused: Vec<String> = Vec::new();
        for (index, label) in self.labels.iter().enumerate() {
            let is_used = matched
                .uses
                .iter()
                .flatten()
                .any(|used| used.index == index);
            if let Some(name) = &label.name
                && !is_used
            {
                unused.push(name.clone());
            }
        }
        if matched.problems.is_empty() && !unused.is_empty() {
            matched.notes.push(ChannelNote::NotInDataset {
                side: self.side,
                names: unused,
            });
        }
    }

    /// Returns the problem for a measured response without a dataset channel on this side.
    fn unmatched(&self) -> ProblemKind {
        let found: Vec<&str> = self
            .labels
            .iter()
            .filter_map(|label| label.name.as_deref())
            .collect();
        let known: Vec<&str> = self.rules.iter().map(|rule| rule.name.as_str()).collect();
        ProblemKind::ResponseUnmatched {
            side: self.side,
            found: found.join(", "),
            known: known.join(", "),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::declarations::{ChannelDeclarations, UnitRule};

    /// Matches the channels of one side without declarations.
    fn matched(
        side: ChannelSide,
        labels: &[ChannelLabel],
        rules: &[ChannelRule],
        partial: bool,
    ) -> ChannelMatch {
        ChannelMatcher {
            side,
            labels,
            rules,
            declared: &ModelDeclarations::default(),
            partial,
        }
        .run()
    }

    /// Matches all channels of one side under these declarations.
    fn matched_as_declared(
        side: ChannelSide,
        labels: &[ChannelLabel],
        rules: &[ChannelRule],
        declared: &ModelDeclarations<'_>,
    ) -> ChannelMatch {
        ChannelMatcher {
            side,
            labels,
            rules,
            declared,
            partial: false,
        }
        .run()
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
    fn channels_are_found_by_name_in_any_order_and_converted() {
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
    fn a_missing_unit_is_a_problem() {
        let rules = [rule("LON", "%")];
        let found = matched(ChannelSide::Input, &[label("lon", "")], &rules, false);
        assert_eq!(found.problems, [ProblemKind::UnitOfFile("LON".into())]);
        let with_unit = [ChannelRule {
            unit_in_files: Some("in".into()),
            ..rule("LON", "%")
        }];
        let found = matched(ChannelSide::Input, &[label("lon", "")], &with_unit, false);
        assert!(matches!(
            &found.problems[..],
            [ProblemKind::Conversion { .. }]
        ));
        let factor = UnitRule {
            channel: "LON".into(),
            from: "in".into(),
            factor: 8.5,
        };
        let declared = ModelDeclarations {
            conversions: &[factor],
            ..ModelDeclarations::default()
        };
        let found = matched_as_declared(
            ChannelSide::Input,
            &[label("lon", "")],
            &with_unit,
            &declared,
        );
        assert_eq!(found.uses[0].as_ref().map(|used| used.factor), Some(8.5));
    }

    #[test]
    fn unnamed_channels_are_matched_by_position_if_the_counts_agree() {
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
    fn two_candidates_are_a_problem_unless_one_has_the_exact_name() {
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
    fn the_sign_is_declared_or_marked_or_a_problem() {
        let rules = [
            rule("NZ", "m/s2"),
            ChannelRule {
                aliases: vec!["-yaw".into()],
                ..rule("R", "deg/s")
            },
        ];
        let factors = |name: &str, declared: &[(&str, f64)]| {
            let labels = [label(name, "m/s2"), label("yaw", "deg/s")];
            let signs = declared
                .iter()
                .map(|(name, sign)| ((*name).to_owned(), *sign))
                .collect();
            let channels = ChannelDeclarations {
                signs,
                ..ChannelDeclarations::default()
            };
            let declared = ModelDeclarations {
                channels,
                ..ModelDeclarations::default()
            };
            let found = matched_as_declared(ChannelSide::Output, &labels, &rules, &declared);
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
    fn declared_units_and_factors_override_the_file() {
        let rules = [ChannelRule {
            unit_in_files: Some("deg/s".into()),
            ..rule("R", "deg/s")
        }];
        let factor_of = |label: ChannelLabel, channels: ChannelDeclarations| {
            let declared = ModelDeclarations {
                channels,
                ..ModelDeclarations::default()
            };
            let found = matched_as_declared(ChannelSide::Output, &[label], &rules, &declared);
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
    fn a_measured_response_may_lack_some_channels_but_not_all() {
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
            [ChannelNote::NotInDataset {
                side: ChannelSide::Input,
                names: vec!["latt".to_owned()]
            }]
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
}
