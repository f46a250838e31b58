//! Proposed columns for a record's time and channels.
//!
//! A *rule* ([`ChannelRule`]) describes a channel to read: its name, its unit, its names in files
//! (*aliases*; for records at most one), and its unit in files that give none. A *topic* is a group
//! of columns that share stamps of their own.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::channel_rule::ChannelRule;
use gdcm_model::names::signed_name::sign_between;
use gdcm_model::units::physical_unit::conversion_factor;

use super::column_candidates::{candidates, without_sign_mark};
use super::column_use::{ColumnUse, UnitBasis};
use super::layout_note::{ColumnConversion, LayoutNote};
use super::layout_problem::{LayoutCaution, LayoutProblem};
use super::plausible_units::possible_units;
use super::record_channels::{DeclaredConversion, RecordChannels};
use super::record_layout::RecordLayout;
use super::record_table::RecordTable;
use super::resampling::Resampling;
use super::time_base::TimeBase;

/// User settings for the time in records; ignored if the record's topics have their own stamps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimeSettings {
    /// Time column; `None` selects the most likely column.
    pub column: Option<String>,
    /// Sample time \[s\]; replaces a column.
    pub sample_time_s: Option<f64>,
}

/// A layout proposed for a record, with a note for each choice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LayoutProposal {
    /// The layout; its time and columns are `None` where they could not be determined.
    pub layout: RecordLayout,
    /// Choices with their reasons.
    pub notes: Vec<LayoutNote>,
    /// Problems that make the layout unusable.
    pub problems: Vec<LayoutProblem>,
    /// Unusual features that may be correct.
    pub cautions: Vec<LayoutCaution>,
}

impl RecordLayout {
    /// Proposes columns for the time and for each channel.
    ///
    /// ```text
    /// 1  time     the first of: the topics' stamps, if columns have their own clocks (M14.11); the
    ///             user's sample time; the user's column; the column named like a time; the file's
    ///             sample time; else none, with a problem
    /// 2  channel  by name, or by aliases if it has some (column_candidates). If no input has a
    ///             candidate, but the file marks as many columns as inputs (such as those of u):
    ///             these in order; the same for outputs
    /// 3  factor   the first of: the user's; 1 if the channel has no unit; from the user's or the
    ///             file's unit; from the rule's unit for files without units; from the only unit in
    ///             which the samples are plausible; open if there are several, 1 if there is none
    /// 4  sign     by the mark in the alias or in the column name: -R, az (down); a channel NZ from
    ///             a column az needs the user's decision
    /// 5  checks   problems and cautions of the layout (layout_checks); a missing column or time is
    ///             not reported again
    /// ```
    pub fn proposed(
        table: &RecordTable,
        channels: &RecordChannels,
        time: &TimeSettings,
    ) -> LayoutProposal {
        let mut proposer = Proposer {
            table,
            channels,
            notes: Vec::new(),
            problems: Vec::new(),
        };
        let layout = proposer.layout(time);
        let Proposer {
            mut notes,
            mut problems,
            ..
        } = proposer;
        // Step 5.
        let is_incomplete = !problems.is_empty();
        for problem in layout.problems(table, channels) {
            let is_missing = matches!(
                problem,
                LayoutProblem::NoColumn { .. } | LayoutProblem::NoTime(_)
            );
            // The proposer has added a problem, with the reason, for each column and for the time
            // that it left open.
            if !(is_missing && is_incomplete) {
                problems.push(problem);
            }
        }
        if let Some(Ok(resampling)) = Resampling::new(&layout, table, channels) {
            notes.extend(resampling.notes());
        }
        let cautions = layout.cautions(table, channels);
        LayoutProposal {
            layout,
            notes,
            problems,
            cautions,
        }
    }
}

/// Proposes columns for channels, and collects the notes.
struct Proposer<'r> {
    table: &'r RecordTable,
    channels: &'r RecordChannels,
    notes: Vec<LayoutNote>,
    problems: Vec<LayoutProblem>,
}

/// Where a column's unit comes from.
enum UnitSource {
    /// The file or the user.
    Known,
    /// The rule for files without units.
    Rule,
}

impl Proposer<'_> {
    /// Proposes the time, then inputs and outputs. Without column names and aliases, columns cannot
    /// be assigned.
    fn layout(&mut self, time: &TimeSettings) -> RecordLayout {
        let mut layout = RecordLayout {
            time: self.time(time),
            inputs: vec![None; self.channels.inputs.len()],
            outputs: vec![None; self.channels.outputs.len()],
        };
        let mut rules = self.channels.inputs.iter().chain(&self.channels.outputs);
        let has_aliases = rules.clone().any(|rule| !rule.aliases.is_empty());
        if self.table.named || has_aliases {
            let time_column = layout.time_column();
            layout.inputs = self.columns_of_side(ChannelSide::Input, time_column);
            layout.outputs = self.columns_of_side(ChannelSide::Output, time_column);
        } else {
            let first = rules.next();
            self.problems.push(LayoutProblem::Unnamed {
                channel: first.map_or_else(String::new, |rule| rule.name.clone()),
                found: self.table.columns.len(),
            });
        }
        layout
    }

    /// Proposes the time base (step 1: a sample time from the user replaces the user's column);
    /// `None`, with a problem, if there is none.
    fn time(&mut self, settings: &TimeSettings) -> Option<TimeBase> {
        let table = self.table;
        if table.has_topics() {
            self.notes.push(LayoutNote::TopicStamps);
            return Some(TimeBase::Topics);
        }
        if let Some(step_s) = settings.sample_time_s {
            self.notes.push(LayoutNote::RequestedStep { step_s });
            return Some(TimeBase::SampleTime(step_s));
        }
        let column = match &settings.column {
            Some(name) => {
                let column = table.find(name);
                if column.is_none() {
                    self.problems.push(LayoutProblem::NoSuchColumn {
                        name: name.clone(),
                        found: table.column_names(),
                    });
                    return None;
                }
                column
            }
            None => TimeBase::find(table),
        };
        if let Some(column) = column {
            self.notes.push(TimeBase::column_note(table, column));
            return Some(TimeBase::from_column(table, column));
        }
        if let Some(step_s) = table.sample_time_s {
            self.notes.push(LayoutNote::StepOfFile { step_s });
            return Some(TimeBase::SampleTime(step_s));
        }
        self.problems
            .push(LayoutProblem::NoTime(table.column_names()));
        None
    }

    /// Proposes columns for the inputs or the outputs (step 2).
    fn columns_of_side(
        &mut self,
        side: ChannelSide,
        time: Option<usize>,
    ) -> Vec<Option<ColumnUse>> {
        let table = self.table;
        let rules = side.pick(&self.channels.inputs, &self.channels.outputs);
        let mut candidates_of_rules = Vec::with_capacity(rules.len());
        for rule in rules {
            let mut columns = candidates(table, rule, side);
            columns.retain(|column| Some(*column) != time);
            candidates_of_rules.push(columns);
        }
        let marked: Vec<usize> = (0..table.columns.len())
            .filter(|&column| table.columns[column].side == Some(side))
            .collect();
        let is_unmatched = candidates_of_rules.iter().all(Vec::is_empty);
        let mut uses = Vec::with_capacity(rules.len());
        if is_unmatched && marked.len() == rules.len() && !rules.is_empty() {
            self.notes.push(LayoutNote::MarkedInOrder {
                side,
                count: rules.len(),
            });
            for (rule, column) in rules.iter().zip(marked) {
                uses.push(self.column_use(rule, column));
            }
        } else {
            for (rule, columns) in rules.iter().zip(&candidates_of_rules) {
                uses.push(self.only_candidate(side, rule, columns));
            }
        }
        uses
    }

    /// Returns the only candidate; adds a problem if there is no candidate, or more than one.
    fn only_candidate(
        &mut self,
        side: ChannelSide,
        rule: &ChannelRule,
        columns: &[usize],
    ) -> Option<ColumnUse> {
        let table = self.table;
        let channel = rule.name.clone();
        match columns {
            [column] => return self.column_use(rule, *column),
            [] => self.problems.push(LayoutProblem::NoColumn {
                side,
                channel,
                found: table.column_names(),
            }),
            several => {
                let names: Vec<String> =
                    several.iter().map(|column| table.quoted(*column)).collect();
                self.problems.push(LayoutProblem::SeveralColumns {
                    side,
                    channel,
                    found: names,
                });
            }
        }
        None
    }

    /// Returns the column with its factor and sign (steps 3 and 4), and adds notes; `None`, with a
    /// problem, if the unit cannot be converted or the sign is unknown.
    fn column_use(&mut self, rule: &ChannelRule, column: usize) -> Option<ColumnUse> {
        let used = self.converted(rule, column)?;
        let name = self.table.columns[column].name.as_str();
        // Aliases come from users, who give a channel at most one, the column's name: if it is
        // marked, it is the one that matched.
        let marked_alias = rule.aliases.iter().find(|alias| has_sign_mark(alias));
        let Some(sign) = self.sign(rule, name, marked_alias.map(String::as_str)) else {
            self.problems.push(LayoutProblem::Sign {
                channel: rule.name.clone(),
                column: name.to_owned(),
                plain: without_sign_mark(name),
            });
            return None;
        };
        if sign > 0.0 {
            return Some(used);
        }
        self.notes.push(LayoutNote::SignReversed {
            channel: rule.name.clone(),
            column: self.table.quoted(column),
            is_requested: marked_alias.is_some(),
        });
        Some(ColumnUse {
            factor: -used.factor,
            ..used
        })
    }

    /// Returns the sign by which a column's factor is multiplied (step 4):
    ///
    /// 1. with a user-defined factor, which includes the column's sign: 1; but -1 if the user also
    ///    put a minus before the name of a column that has none: it applies beside the factor
    /// 2. with a marked alias ("-az"): by its mark
    /// 3. with an unmarked alias, and a column without a mark: 1, because the user who named the
    ///    column asked for no other sign
    /// 4. otherwise, without an alias or with a marked column: by the column's name; `None` if it
    ///    leaves the sign open
    fn sign(&self, rule: &ChannelRule, column: &str, marked_alias: Option<&str>) -> Option<f64> {
        let has_factor = matches!(
            self.channels.declared.get(&rule.name),
            Some(DeclaredConversion::Factor(_))
        );
        if has_factor {
            let is_reversed = marked_alias.is_some_and(|alias| {
                alias.trim_start().starts_with('-') && !column.trim_start().starts_with('-')
            });
            return Some(if is_reversed { -1.0 } else { 1.0 });
        }
        if let Some(alias) = marked_alias {
            return sign_between(alias, &rule.name);
        }
        if !rule.aliases.is_empty() && !has_sign_mark(column) {
            return Some(1.0);
        }
        sign_between(column, &rule.name)
    }

    /// Returns the column with the factor to the channel's unit (step 3), and adds a note; `None`,
    /// with a problem, if the unit cannot be converted.
    fn converted(&mut self, rule: &ChannelRule, column: usize) -> Option<ColumnUse> {
        let table = self.table;
        let unit = match self.channels.declared.get(&rule.name) {
            Some(DeclaredConversion::Factor(factor)) => {
                self.note(rule, column, ColumnConversion::RequestedFactor(*factor));
                return Some(ColumnUse::times(column, *factor));
            }
            Some(DeclaredConversion::Unit(unit)) => Some(unit.as_str()),
            None => table.columns[column].unit_in_file(),
        };
        if rule.unit.is_empty() {
            let unit = unit.map(str::to_owned);
            self.note(rule, column, ColumnConversion::NoUnitOfChannel(unit));
            return Some(ColumnUse::as_it_is(column));
        }
        if let Some(unit) = unit {
            return self.converted_from(rule, column, unit, UnitSource::Known);
        }
        if let Some(unit) = &rule.unit_in_files {
            return self.converted_from(rule, column, unit, UnitSource::Rule);
        }
        Some(self.by_samples(rule, column))
    }

    /// Converts a column from `unit` to the channel's unit, and adds a note; `None`, with a
    /// problem, if that is not possible.
    fn converted_from(
        &mut self,
        rule: &ChannelRule,
        column: usize,
        unit: &str,
        source: UnitSource,
    ) -> Option<ColumnUse> {
        let to = &rule.unit;
        let Some(factor) = conversion_factor(unit, to) else {
            self.problems.push(LayoutProblem::Conversion {
                channel: rule.name.clone(),
                column: self.table.quoted(column),
                from: unit.to_owned(),
                to: to.clone(),
            });
            return None;
        };
        let conversion = if factor != 1.0 {
            ColumnConversion::Converted {
                from: unit.to_owned(),
                to: to.clone(),
                factor,
            }
        } else {
            match source {
                UnitSource::Known => ColumnConversion::SameUnit(unit.to_owned()),
                UnitSource::Rule => ColumnConversion::UnitOfRule(unit.to_owned()),
            }
        };
        self.note(rule, column, conversion);
        Some(ColumnUse::times(column, factor))
    }

    /// Returns a column for which neither file nor rule gives a unit: with one plausible unit, in
    /// this unit; with several, with an open unit and without a note; with none, in the channel's
    /// unit.
    fn by_samples(&mut self, rule: &ChannelRule, column: usize) -> ColumnUse {
        let table = self.table;
        let used = ColumnUse::by_unit(table, column, &rule.unit);
        if used.unit == UnitBasis::Open {
            return used;
        }
        // At most one, because the unit is not open.
        let plausible = possible_units(&table.columns[column], &rule.unit);
        let conversion = match plausible.as_slice() {
            [only] => ColumnConversion::OnlyPlausibleUnit {
                unit: only.to_string(),
                factor: used.factor,
            },
            _ => ColumnConversion::NoUnitOfFile,
        };
        self.note(rule, column, conversion);
        used
    }

    /// Adds a note about a channel's column.
    fn note(&mut self, rule: &ChannelRule, column: usize, conversion: ColumnConversion) {
        self.notes.push(LayoutNote::Column {
            channel: rule.name.clone(),
            column: self.table.quoted(column),
            conversion,
        });
    }
}

/// Returns whether a name has a sign mark: "-az", "az (down)".
pub(super) fn has_sign_mark(name: &str) -> bool {
    without_sign_mark(name) != name.trim()
}
