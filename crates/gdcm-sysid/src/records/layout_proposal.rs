//! Proposed columns for the time and the channels of a record.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::channel_alias::{folded_name, same_channel};
use gdcm_model::names::signed_name::sign_between;
use gdcm_model::names::{ChannelRule, SignedName};
use gdcm_model::units::number;
use gdcm_model::units::physical_unit::conversion_factor;

use super::layout_problem::{LayoutCaution, LayoutProblem};
use super::record_channels::{RecordChannels, SaidConversion};
use super::record_layout::{ColumnUse, RecordLayout, possible_units};
use super::record_table::{RecordColumn, RecordTable, TimeBase};
use super::resampling::Resampling;

/// User settings for the time of records.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimeWish {
    /// The time column; `None` selects the most likely one.
    pub column: Option<String>,
    /// Sample time \[s\], used instead of a column.
    pub sample_time_s: Option<f64>,
}

/// A layout proposed for a record, with a note for each choice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LayoutProposal {
    /// The layout, as far as it is known.
    pub layout: RecordLayout,
    /// The choices and their reasons, one note each.
    pub notes: Vec<String>,
    /// Problems that prevent the use of the layout.
    pub problems: Vec<LayoutProblem>,
    /// Unusual features that may be correct.
    pub cautions: Vec<LayoutCaution>,
}

impl RecordLayout {
    /// Proposes columns for the time and for each channel.
    ///
    /// ```text
    /// time     as wished, else the column of that name, else the file's sample time
    /// channel  the column of its very name, or of one of its other names where it has some, else one that the field calls the
    ///          same; among several the one whose unit can be converted
    /// else     columns that the file says are inputs or outputs, in order, if there are as many; columns without names are said
    /// sign     as a mark says that stands in the name, or in the one that is asked for: -R, az (down); az onto NZ is asked
    /// factor   from the file's unit to the channel's; of a file that says none, from what is said of the channel, else from the only
    ///          unit that its samples can be in, else it is asked for
    /// ```
    pub fn proposed(
        table: &RecordTable,
        channels: &RecordChannels,
        time: &TimeWish,
    ) -> LayoutProposal {
        let mut proposer = Proposer {
            table,
            channels,
            notes: Vec::new(),
            problems: Vec::new(),
        };
        let time = proposer.time(time);
        let time_column = match time {
            Some(TimeBase::Column { column, .. }) => Some(column),
            _ => None,
        };
        let mut rules = channels.inputs.iter().chain(&channels.outputs);
        let (inputs, outputs) = if table.named || rules.clone().any(|rule| !rule.aliases.is_empty())
        {
            let inputs = proposer.named(ChannelSide::Input, time_column);
            (inputs, proposer.named(ChannelSide::Output, time_column))
        } else {
            let channel = rules
                .next()
                .map(|rule| rule.name.clone())
                .unwrap_or_default();
            proposer.problems.push(LayoutProblem::Unnamed {
                channel,
                found: table.columns.len(),
            });
            (
                vec![None; channels.inputs.len()],
                vec![None; channels.outputs.len()],
            )
        };
        let layout = RecordLayout {
            time,
            inputs,
            outputs,
        };
        let Proposer {
            mut notes,
            problems: told,
            ..
        } = proposer;
        // Missing columns are not reported again if the proposal already reported problems.
        let rest = layout
            .problems(table, channels)
            .into_iter()
            .filter(|problem| match problem {
                LayoutProblem::NoColumn { .. } | LayoutProblem::NoTime(_) => told.is_empty(),
                _ => true,
            });
        let problems = told.iter().cloned().chain(rest).collect();
        if let Some(Ok(resampling)) = Resampling::of(&layout, table, channels) {
            notes.extend(resampling.words());
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

/// Proposes columns of a table for channels, and collects the notes.
struct Proposer<'r> {
    table: &'r RecordTable,
    channels: &'r RecordChannels,
    notes: Vec<String>,
    problems: Vec<LayoutProblem>,
}

impl Proposer<'_> {
    fn time(&mut self, wish: &TimeWish) -> Option<TimeBase> {
        let table = self.table;
        if table.columns.iter().any(|column| column.topic.is_some()) {
            self.notes
                .push("time from the stamps of each topic".to_owned());
            return Some(TimeBase::Topics);
        }
        if let Some(step_s) = wish.sample_time_s {
            self.notes
                .push(format!("one sample each {} s, as asked", number(step_s)));
            return Some(TimeBase::SampleTime(step_s));
        }
        let column = match &wish.column {
            Some(name) => match table.find(name) {
                Some(column) => Some(column),
                None => {
                    let name = name.clone();
                    let found = table.column_names();
                    self.problems
                        .push(LayoutProblem::NoSuchColumn { name, found });
                    return None;
                }
            },
            None => TimeBase::find(table),
        };
        if let Some(column) = column {
            let (base, words) = TimeBase::of_column(table, column);
            self.notes.push(words);
            return Some(base);
        }
        if let Some(step_s) = table.sample_time_s {
            self.notes.push(format!(
                "one sample each {} s, as the file says",
                number(step_s)
            ));
            return Some(TimeBase::SampleTime(step_s));
        }
        self.problems
            .push(LayoutProblem::NoTime(table.column_names()));
        None
    }

    /// Returns the columns of one side, by name.
    fn named(&mut self, side: ChannelSide, time: Option<usize>) -> Vec<Option<ColumnUse>> {
        let table = self.table;
        let rules = side.of(&self.channels.inputs, &self.channels.outputs);
        let free = |column: &usize| Some(*column) != time;
        let candidates: Vec<Vec<usize>> = rules
            .iter()
            .map(|rule| {
                candidates(table, rule, side)
                    .into_iter()
                    .filter(free)
                    .collect()
            })
            .collect();
        let of_side: Vec<usize> = (0..table.columns.len())
            .filter(|&column| table.columns[column].side == Some(side))
            .collect();
        if candidates.iter().all(Vec::is_empty) && of_side.len() == rules.len() && !rules.is_empty()
        {
            self.notes.push(format!(
                "the file has as many {side}s under other names ({}): taken in order",
                rules.len()
            ));
            return rules
                .iter()
                .zip(of_side)
                .map(|(rule, column)| self.used(rule, column))
                .collect();
        }
        let mut uses = Vec::with_capacity(rules.len());
        for (rule, candidates) in rules.iter().zip(candidates) {
            let channel = rule.name.clone();
            uses.push(match candidates.as_slice() {
                [column] => self.used(rule, *column),
                [] => {
                    self.problems.push(LayoutProblem::NoColumn {
                        side,
                        channel,
                        found: table.column_names(),
                    });
                    None
                }
                several => {
                    let found = several
                        .iter()
                        .map(|&column| table.quoted(column))
                        .collect::<Vec<_>>()
                        .join(", ");
                    self.problems.push(LayoutProblem::SeveralColumns {
                        side,
                        channel,
                        found,
                    });
                    None
                }
            });
        }
        uses
    }

    /// Returns the column with its factor, negated if a sign mark in its name or in the requested
    /// name requires it; adds a note.
    fn used(&mut self, rule: &ChannelRule, column: usize) -> Option<ColumnUse> {
        let used = self.converted(rule, column)?;
        let said = matches!(
            self.channels.said.get(&rule.name),
            Some(SaidConversion::Factor(_))
        );
        let name = self.table.columns[column].name.as_str();
        let quoted = self.table.quoted(column);
        let has_mark = |text: &&str| SignedName::parse(text).name != text.trim();
        let of_alias = rule.aliases.iter().map(String::as_str).find(has_mark);
        let sign = match of_alias {
            Some(alias) => sign_between(alias, &rule.name),
            None if said || !rule.aliases.is_empty() && !has_mark(&name) => Some(1.0),
            None => sign_between(name, &rule.name),
        };
        let Some(sign) = sign else {
            let channel = rule.name.clone();
            let column = name.to_owned();
            let plain = plain(name);
            self.problems.push(LayoutProblem::Sign {
                channel,
                column,
                plain,
            });
            return None;
        };
        if sign > 0.0 {
            return Some(used);
        }
        let why = if of_alias.is_some() {
            "as asked"
        } else {
            "as its name says"
        };
        self.notes.push(format!(
            "{}: the sign of column {quoted} is turned, {why}",
            rule.name
        ));
        Some(ColumnUse {
            factor: -used.factor,
            ..used
        })
    }

    /// Returns the column with the factor from the file's unit to the channel's, and adds a note.
    fn converted(&mut self, rule: &ChannelRule, column: usize) -> Option<ColumnUse> {
        let table = self.table;
        let quoted = table.quoted(column);
        let said = match self.channels.said.get(&rule.name) {
            Some(SaidConversion::Factor(factor)) => {
                self.notes.push(format!(
                    "{}: column {quoted}, × {} as asked",
                    rule.name,
                    number(*factor)
                ));
                return Some(ColumnUse::times(column, *factor));
            }
            Some(SaidConversion::Unit(unit)) => Some(unit.as_str()),
            None => table.columns[column].said_unit(),
        };
        if rule.unit.is_empty() {
            let unit = said.map_or_else(String::new, |unit| format!(", in {unit}"));
            self.notes
                .push(format!("{}: column {quoted} as it is{unit}", rule.name));
            return Some(ColumnUse::as_it_is(column));
        }
        let Some(from) = said.or(rule.unit_in_files.as_deref()) else {
            return Some(self.by_samples(rule, column));
        };
        let Some(factor) = conversion_factor(from, &rule.unit) else {
            let channel = rule.name.clone();
            let from = from.to_owned();
            let to = rule.unit.clone();
            self.problems.push(LayoutProblem::Conversion {
                channel,
                column: quoted,
                from,
                to,
            });
            return None;
        };
        self.notes.push(match (factor == 1.0, said) {
            (true, Some(unit)) => format!("{}: column {quoted}, in {unit}", rule.name),
            (true, None) => format!(
                "{}: column {quoted}, in {from} as is said of the channel",
                rule.name
            ),
            (false, _) => format!(
                "{}: column {quoted}, {from} → {} (× {})",
                rule.name,
                rule.unit,
                number(factor)
            ),
        });
        Some(ColumnUse::times(column, factor))
    }

    /// Returns the column of a file without a unit; adds a note if the samples leave only one.
    fn by_samples(&mut self, rule: &ChannelRule, column: usize) -> ColumnUse {
        let table = self.table;
        let used = ColumnUse::by_unit(table, column, &rule.unit);
        let name = &rule.name;
        let quoted = table.quoted(column);
        match possible_units(&table.columns[column], &rule.unit).as_slice() {
            _ if used.is_unit_open => {}
            [only] => self.notes.push(format!(
                "{name}: column {quoted}, taken to be in {only}: the file does not say, and no other unit is possible{}",
                if used.factor == 1.0 { String::new() } else { format!(" (× {})", number(used.factor)) }
            )),
            _ => self.notes.push(format!("{name}: column {quoted} as it is, for the file does not say its unit")),
        }
        used
    }
}

/// Returns a name without its sign marks: "-az" and "az (down)" become "az".
fn plain(name: &str) -> String {
    SignedName::parse(name).name
}

/// Returns the columns that can be a channel.
fn candidates(table: &RecordTable, rule: &ChannelRule, side: ChannelSide) -> Vec<usize> {
    let mut found: Vec<usize>;
    let named = |is_it: &dyn Fn(&str) -> bool| -> Vec<usize> {
        let other_side = |column: usize| {
            table.columns[column]
                .side
                .is_some_and(|of_file| of_file != side)
        };
        (0..table.columns.len())
            .filter(|&column| !other_side(column) && is_it(&table.columns[column].name))
            .collect()
    };
    // User-defined names in any spelling: "elev_yoke1" is "elev,yoke1", and other names of the
    // stick do not apply. The exact name precedes a name with a sign mark, which precedes synonyms.
    let aliases: Vec<String> = rule
        .aliases
        .iter()
        .flat_map(|alias| [alias.clone(), plain(alias)])
        .collect();
    if aliases.is_empty() {
        let wanted = plain(&rule.name);
        let ways: [&dyn Fn(&str) -> bool; 3] = [
            &|name| name == rule.name,
            &|name| plain(name) == wanted,
            &|name| same_channel(&plain(name), &wanted),
        ];
        found = ways
            .into_iter()
            .map(named)
            .find(|found| !found.is_empty())
            .unwrap_or_default();
    } else {
        let find = |alias: &String| table.find(alias);
        let ways: [&dyn Fn(&str) -> bool; 3] = [
            &|name| {
                aliases
                    .iter()
                    .any(|alias| folded_name(name) == folded_name(alias))
            },
            &|name| {
                aliases
                    .iter()
                    .any(|alias| folded_name(&plain(name)) == folded_name(alias))
            },
            &|name| {
                aliases
                    .iter()
                    .any(|alias| same_channel(&plain(name), alias))
            },
        ];
        found = named(&|name| rule.aliases.iter().any(|alias| alias == name));
        if found.is_empty() {
            found = aliases.iter().find_map(find).into_iter().collect();
        }
        let is_number = aliases.iter().any(|alias| alias.starts_with('#'));
        if found.is_empty() && !is_number {
            found = ways
                .into_iter()
                .map(named)
                .find(|found| !found.is_empty())
                .unwrap_or_default();
        }
    }
    let names = if aliases.is_empty() {
        vec![rule.name.clone()]
    } else {
        aliases
    };
    let of_columns = |is_it: &dyn Fn(&RecordColumn) -> bool| -> Vec<usize> {
        (0..table.columns.len())
            .filter(|&column| is_it(&table.columns[column]))
            .collect()
    };
    if found.is_empty() {
        found = of_columns(&|column| {
            column
                .meaning
                .is_some_and(|meaning| names.iter().any(|wanted| same_channel(meaning, wanted)))
        });
    }
    // In logs with documented columns a field of the same letter is something else: "PIDR.P" is not
    // a roll rate.
    let is_known = || table.columns.iter().any(|column| column.meaning.is_some());
    if found.is_empty() && (!rule.aliases.is_empty() || !is_known()) {
        found = of_columns(&|column| names.iter().any(|wanted| column.field() == *wanted));
    }
    if rule.aliases.is_empty() {
        found.retain(|&column| !is_position(table, column, rule));
    }
    if found.len() > 1 {
        let fits = |column: &usize| {
            let unit = table.columns[*column].unit.as_deref();
            unit.is_some_and(|unit| conversion_factor(unit, &rule.unit).is_some())
        };
        let fitting: Vec<usize> = found.iter().copied().filter(fits).collect();
        if fitting.len() == 1 {
            return fitting;
        }
    }
    found
}

/// Whether a column is a latitude or a longitude, whose names resemble those of inputs: an angle
/// that hardly changes, judged by its unit; without a unit in the file, by a latitude and a
/// longitude column that are both nearly constant.
fn is_position(table: &RecordTable, column: usize, rule: &ChannelRule) -> bool {
    /// One minute at 140 kt is 0.04 degrees.
    const MOST_DEG: f64 = 0.5;
    /// Range relative to the largest value. The second limit applies to a column with the exact
    /// name of the channel: smaller than the motion of any stick in flight.
    const MOST_CHANGE: [f64; 2] = [0.02, 0.002];
    let is_called =
        |column: &RecordColumn, names: &[&str]| names.contains(&folded_name(&column.name).as_str());
    let stands = |column: &RecordColumn, factor: f64| {
        column.range().is_some_and(|(least, most)| {
            (most - least) * factor < MOST_DEG && least.abs().max(most.abs()) * factor <= 180.0
        })
    };
    let own = &table.columns[column];
    let latitude = ["lat"];
    let longitude = ["lon", "long", "lng"];
    if !is_called(own, &latitude) && !is_called(own, &longitude) {
        return false;
    }
    match own.unit.as_deref().filter(|unit| !unit.trim().is_empty()) {
        Some(unit) => conversion_factor(unit, "deg").is_some_and(|factor| stands(own, factor)),
        None => {
            let most_change = MOST_CHANGE[usize::from(own.name == rule.name)];
            let hardly = |names: &[&str]| {
                table.columns.iter().any(|column| {
                    let change = column
                        .range()
                        .map(|(least, most)| (most - least) / least.abs().max(most.abs()));
                    is_called(column, names)
                        && stands(column, 1.0)
                        && change.is_some_and(|of| 0.0 < of && of < most_change)
                })
            };
            hardly(&latitude) && hardly(&longitude)
        }
    }
}
