//! Columns proposed for the time and the channels of a record.

use super::*;
use crate::assembly::{ChannelRule, SignedName, conversion_factor, folded_name, same_channel, sign_between};
use crate::units::number;

/// What the engineer says about the time of records.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimeWish {
    /// The column; none for the one that looks like it.
    pub column: Option<String>,
    /// Sample time \[s\], which stands in place of a column.
    pub sample_time_s: Option<f64>,
}

/// A layout proposed for a record, every choice in words.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LayoutProposal {
    /// The layout, as far as there is one.
    pub layout: RecordLayout,
    /// What was chosen and why, a line a choice.
    pub notes: Vec<String>,
    /// What keeps the layout from being used.
    pub problems: Vec<LayoutProblem>,
    /// What is odd, and can be right.
    pub cautions: Vec<LayoutCaution>,
}

impl RecordLayout {
    /// Columns for the time and for each channel.
    ///
    /// ```text
    /// time     as wished, else the column of that name, else the file's sample time
    /// channel  the column of its very name, or of one of its other names where it has some, else one that the field calls the
    ///          same; among several the one whose unit can be converted
    /// else     columns that the file says are inputs or outputs, or columns without names, in order, if there are as many
    /// factor   from the file's unit to the channel's; a file that says none is taken as the channel's rule says
    /// ```
    pub fn proposed(table: &RecordTable, channels: &RecordChannels, time: &TimeWish) -> LayoutProposal {
        let mut proposal = LayoutProposal::default();
        let time = proposal.time(table, time);
        let time_column = match time {
            Some(TimeBase::Column { column, .. }) => Some(column),
            _ => None,
        };
        let is_said = channels.inputs.iter().chain(&channels.outputs).any(|rule| !rule.aliases.is_empty());
        let (inputs, outputs) = if table.named || is_said {
            (
                proposal.named(table, ("input", ChannelSide::Input), &channels.inputs, time_column),
                proposal.named(table, ("output", ChannelSide::Output), &channels.outputs, time_column),
            )
        } else {
            proposal.in_order(table, channels, time_column)
        };
        proposal.layout = RecordLayout { time, inputs, outputs };
        let told = std::mem::take(&mut proposal.problems);
        // Where something was said of a channel already, that it has no column is no news.
        let rest = proposal.layout.problems(table, channels).into_iter().filter(|problem| match problem {
            LayoutProblem::NoColumn { .. } | LayoutProblem::NoTime { .. } => told.is_empty(),
            _ => true,
        });
        proposal.problems = told.iter().cloned().chain(rest).collect();
        proposal.cautions = proposal.layout.cautions(table, channels);
        proposal
    }
}

impl LayoutProposal {
    fn time(&mut self, table: &RecordTable, wish: &TimeWish) -> Option<TimeBase> {
        if let Some(step_s) = wish.sample_time_s {
            self.notes.push(format!("one sample each {} s, as asked", number(step_s)));
            return Some(TimeBase::SampleTime(step_s));
        }
        let column = match &wish.column {
            Some(name) => match table.find(name) {
                Some(column) => Some(column),
                None => {
                    let (name, found) = (name.clone(), table.column_names());
                    self.problems.push(LayoutProblem::NoSuchColumn { name, found });
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
            self.notes.push(format!("one sample each {} s, as the file says", number(step_s)));
            return Some(TimeBase::SampleTime(step_s));
        }
        self.problems.push(LayoutProblem::NoTime { found: table.column_names() });
        None
    }

    /// Columns of one side, by name.
    fn named(
        &mut self,
        table: &RecordTable,
        (side, of_file): (&'static str, ChannelSide),
        rules: &[ChannelRule],
        time: Option<usize>,
    ) -> Vec<Option<ColumnUse>> {
        let free = |column: &usize| Some(*column) != time;
        let candidates: Vec<Vec<usize>> =
            rules.iter().map(|rule| candidates(table, rule, of_file).into_iter().filter(free).collect()).collect();
        let of_side: Vec<usize> =
            (0..table.columns.len()).filter(|&column| table.columns[column].side == Some(of_file)).collect();
        if candidates.iter().all(Vec::is_empty) && of_side.len() == rules.len() && !rules.is_empty() {
            self.notes
                .push(format!("the file has as many {side}s under other names ({}): taken in order", rules.len()));
            return rules.iter().zip(of_side).map(|(rule, column)| self.used(table, rule, column)).collect();
        }
        let mut uses = Vec::with_capacity(rules.len());
        for (rule, candidates) in rules.iter().zip(candidates) {
            let channel = rule.name.clone();
            uses.push(match candidates.as_slice() {
                [column] => self.used(table, rule, *column),
                [] => {
                    self.problems.push(LayoutProblem::NoColumn { side, channel, found: table.column_names() });
                    None
                }
                several => {
                    let found = several.iter().map(|&column| table.quoted(column)).collect::<Vec<_>>().join(", ");
                    self.problems.push(LayoutProblem::SeveralColumns { side, channel, found });
                    None
                }
            });
        }
        uses
    }

    /// Columns without names: the time, the inputs, the outputs.
    fn in_order(
        &mut self,
        table: &RecordTable,
        channels: &RecordChannels,
        time: Option<usize>,
    ) -> (Vec<Option<ColumnUse>>, Vec<Option<ColumnUse>>) {
        let rest: Vec<usize> = (0..table.columns.len()).filter(|column| Some(*column) != time).collect();
        let (m, l) = (channels.inputs.len(), channels.outputs.len());
        if rest.len() != m + l {
            let (expected, found) = (1 + m + l, table.columns.len());
            self.problems.push(LayoutProblem::Unnamed { expected, found });
            return (vec![None; m], vec![None; l]);
        }
        self.notes.push("columns without names: taken in order, inputs before outputs".to_owned());
        let (inputs, outputs) = rest.split_at(m);
        let mut of = |rules: &[ChannelRule], columns: &[usize]| -> Vec<Option<ColumnUse>> {
            rules.iter().zip(columns).map(|(rule, column)| self.used(table, rule, *column)).collect()
        };
        (of(&channels.inputs, inputs), of(&channels.outputs, outputs))
    }

    /// The column with the factor from the file's unit to the channel's, and in words.
    fn used(&mut self, table: &RecordTable, rule: &ChannelRule, column: usize) -> Option<ColumnUse> {
        let quoted = table.quoted(column);
        let Some(sign) = sign_of(table, rule, column) else {
            self.problems.push(LayoutProblem::Sign { channel: rule.name.clone(), column: quoted });
            return None;
        };
        if sign < 0.0 {
            self.notes.push(format!("{}: column {quoted} turned (× -1)", rule.name));
        }
        let said = table.columns[column].unit.as_deref().filter(|unit| !unit.trim().is_empty());
        let Some(from) = said.or(rule.unit_in_files.as_deref()).filter(|_| !rule.unit.is_empty()) else {
            let unit = said.map(|unit| format!(", in {unit}")).unwrap_or_default();
            self.notes.push(format!("{}: column {quoted} as it is{unit}", rule.name));
            return Some(ColumnUse { column, factor: sign });
        };
        let Some(factor) = conversion_factor(from, &rule.unit) else {
            let (channel, from, to) = (rule.name.clone(), from.to_owned(), rule.unit.clone());
            self.problems.push(LayoutProblem::Conversion { channel, column: quoted, from, to });
            return None;
        };
        self.notes.push(match (factor == 1.0, said) {
            (true, Some(unit)) => format!("{}: column {quoted}, in {unit}", rule.name),
            (true, None) => format!("{}: column {quoted}, taken to be in {from} as the file does not say", rule.name),
            (false, _) => format!("{}: column {quoted}, {from} → {} (× {})", rule.name, rule.unit, number(factor)),
        });
        Some(ColumnUse { column, factor: sign * factor })
    }
}

/// The column that an address says where none has it as its name: `#30` is the thirtieth, `xyz[0]` the first of the matrix `xyz`; a
/// minus before it turns the sign.
fn addressed(table: &RecordTable, address: &str) -> Option<usize> {
    let address = address.trim_start_matches('-').trim();
    if let Some(number) = address.strip_prefix('#') {
        return number.parse::<usize>().ok()?.checked_sub(1).filter(|&column| column < table.columns.len());
    }
    let (name, index) = address.strip_suffix(']')?.rsplit_once('[')?;
    let number = index.parse::<usize>().ok()?.checked_add(1)?;
    let wanted = folded_name(&format!("{name}_{number}"));
    table.columns.iter().position(|column| folded_name(&column.name) == wanted)
}

/// What a column is multiplied by to have the sign of the channel, as the marks in what is said, or in the names, have it; none where
/// they leave it open.
fn sign_of(table: &RecordTable, rule: &ChannelRule, column: usize) -> Option<f64> {
    let name = &table.columns[column].name;
    match rule.aliases.first() {
        Some(said) if said != name && addressed(table, said) == Some(column) => {
            Some(if said.starts_with('-') { -1.0 } else { 1.0 })
        }
        Some(said) => sign_between(name, said).or_else(|| sign_between(name, &rule.name)),
        None => sign_between(name, &rule.name),
    }
}

/// The columns that can be a channel.
fn candidates(table: &RecordTable, rule: &ChannelRule, side: ChannelSide) -> Vec<usize> {
    let named = |is_it: &dyn Fn(&str) -> bool| -> Vec<usize> {
        let other_side = |column: usize| table.columns[column].side.is_some_and(|of_file| of_file != side);
        (0..table.columns.len()).filter(|&column| !other_side(column) && is_it(&table.columns[column].name)).collect()
    };
    let own = std::slice::from_ref(&rule.name);
    let names = if rule.aliases.is_empty() { own } else { &rule.aliases };
    let mut found = named(&|name| names.iter().any(|wanted| wanted == name));
    if found.is_empty() {
        found = rule.aliases.iter().filter_map(|address| addressed(table, address)).collect();
    }
    // The marks of a sign are no part of a name.
    let plain = |name: &str| SignedName::of(name).name;
    if found.is_empty() {
        // What the engineer says, however it is typed: "elev_yoke1" is "elev,yoke1", and no other name of the stick.
        let is_it = |name: &str, wanted: &str| folded_name(&plain(name)) == folded_name(&plain(wanted));
        found = named(&|name| rule.aliases.iter().any(|wanted| is_it(name, wanted)));
    }
    if found.is_empty() {
        found = named(&|name| names.iter().any(|wanted| same_channel(&plain(name), &plain(wanted))));
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
